/* The part that asks who takes part before an experiment begins, if the command line does not say
 * so. It has the window to itself until then. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "view/experiment/sitting.h"
#include "view/panels/widgets.h"
#include "view/window/experiment.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "experiment"

/* Unscaled (chosen: a path and a question). */
#define WIDTH 460.0f

struct gz_window_experiment_start {
	struct gz_sitting_options options; /**< those of the command line, completed */
	struct gz_experiment experiment;   /**< checked; the sitting reads it again */
	bool present;                      /**< there are answers of these labels already */
	bool focused;                      /**< the first field was given the keyboard */
	char path[GZ_PATH_SIZE];           /**< of the answers */
	char message[128];                 /**< what is wrong; empty: nothing */
	char place[GZ_PATH_SIZE + 32];     /**< says where answers go */
};

/* The folder or the file, from the root if it is there. */
static void say_place(struct gz_window_experiment_start *self)
{
	const char *place = self->options.answers[0] ? self->options.answers : ".";
	char *whole = realpath(place, NULL);
	snprintf(self->place, sizeof self->place, "Answers go to %s", whole ? whole : place);
	free(whole);
}

static enum gz_result open_start(struct gz_window *window)
{
	struct gz_window_experiment_start *self = window->experiment_start;
	const struct gz_sitting_options *options = &window->options->sitting;
	if (!options->file[0] || options->participant[0])
		return GZ_OK;
	self->options = *options;
	say_place(self);
	window->alone = &gz_window_experiment_start_part;
	window->picture_hidden = true;
	const enum gz_result r = gz_experiment_load(options->file, window->log, &self->experiment);
	return r == GZ_OK ? gz_experiment_check(&self->experiment, window->log) : r;
}

/* Say what is wrong with the labels; false: nothing. */
static bool refuse_labels(struct gz_window_experiment_start *self)
{
	const struct gz_sitting_options *options = &self->options;
	const char *what = NULL;
	if (!gz_answers_label_valid(options->participant))
		what = "Participant: letters and digits are needed, such as 07.";
	else if (options->session[0] && !gz_answers_label_valid(options->session))
		what = "Session: only letters and digits are allowed, or nothing.";
	snprintf(self->message, sizeof self->message, "%s", what ? what : "");
	return what;
}

static bool answers_are_there(struct gz_window_experiment_start *self)
{
	const struct gz_answers_request request = {
		.place = self->options.answers,
		.participant = self->options.participant,
		.session = self->options.session,
	};
	return gz_answers_path(&self->experiment, &request, self->path, sizeof self->path) ==
		       GZ_OK &&
	       access(self->path, F_OK) == 0;
}

/* Hand the window over to the experiment. */
static void begin_experiment(struct gz_window *window)
{
	struct gz_window_experiment_start *self = window->experiment_start;
	self->present = false;
	if (gz_window_experiment_begin(window, &self->options) == GZ_OK)
		return;
	window->alone = &gz_window_experiment_start_part;
	self->options.resume = window->options->sitting.resume;
	snprintf(self->message, sizeof self->message,
		 "It cannot begin; the messages in the terminal say why.");
}

static void try_to_begin(struct gz_window *window)
{
	struct gz_window_experiment_start *self = window->experiment_start;
	if (refuse_labels(self)) {
		self->focused = false;
		return;
	}
	self->present = answers_are_there(self) && !self->options.resume;
	if (!self->present)
		begin_experiment(window);
}

/* @return whether Enter was pressed in it */
static bool draw_field(const char *name, const char *id, char *text, size_t size)
{
	gz_widget_label(gz_paint_plain, name);
	gz_widgets_same_line(0.28F);
	gz_widgets_next_width(0);
	gz_widget_text_field(id, text, size, false);
	return gz_widget_entered();
}

static void draw_form(struct gz_window *window)
{
	struct gz_window_experiment_start *self = window->experiment_start;
	struct gz_sitting_options *options = &self->options;
	if (!self->focused)
		gz_widgets_focus_next();
	self->focused = true;
	bool entered = draw_field("Participant", "##participant", options->participant,
				  sizeof options->participant);
	entered = draw_field("Session", "##session", options->session, sizeof options->session) ||
		  entered;
	entered = draw_field("Notes", "##notes", options->notes, sizeof options->notes) || entered;
	if (self->message[0])
		gz_widget_text(gz_paint_amber, self->message);
	gz_widget_text(gz_paint_plain, self->place);
	gz_widget_separator();
	if (gz_widget_button("Begin") || entered)
		try_to_begin(window);
	gz_widgets_same_line(0);
	if (gz_widget_button("Cancel"))
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

/* There are answers of these labels. */
static void draw_question(struct gz_window *window)
{
	struct gz_window_experiment_start *self = window->experiment_start;
	char text[GZ_PATH_SIZE + 96];
	snprintf(text, sizeof text, "%s has answers of this participant and session already.",
		 self->path);
	gz_widget_text(gz_paint_amber, text);
	gz_widget_separator();
	if (gz_widget_button("Continue that session")) {
		self->options.resume = true;
		begin_experiment(window);
	}
	gz_widgets_same_line(0);
	if (gz_widget_button("Other labels")) {
		self->present = false;
		self->focused = false;
	}
}

static void draw_start(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	if (window->alone != &gz_window_experiment_start_part)
		return;
	struct gz_window_experiment_start *self = window->experiment_start;
	const struct gz_panel_place place = {
		.at = GZ_PANEL_MIDDLE,
		.width = WIDTH,
		.takes_keyboard = true,
	};
	if (gz_panel_begin("Who takes part?##experiment_start", &place, NULL)) {
		if (self->present)
			draw_question(window);
		else
			draw_form(window);
		if (gz_dialog_escaped())
			glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
	}
	gz_panel_end();
}

static void close_start(struct gz_window *window)
{
	gz_experiment_free(&window->experiment_start->experiment);
}

const struct gz_window_part gz_window_experiment_start_part = {
	.name = "experiment_start",
	GZ_PART_STATE(experiment_start),
	.open = open_start,
	.panels = draw_start,
	.close = close_start,
};
