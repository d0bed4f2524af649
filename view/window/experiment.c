#include "view/window/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/experiment/experiment.h"
#include "view/panels/experiment_screen.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/gaze.h"
#include "view/window/glfw.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "experiment"

/* For displays that do not tell their refresh rate. */
#define USUAL_REFRESH_HZ 60

/* Older gaze counts as missing. Chosen: a few samples of a slow tracker. */
#define GAZE_AGE_NS (100 * GZ_NS_PER_MS)

/* Interval of drawing the bar of a loading, s (chosen). */
#define BAR_PATIENCE_S 0.1

static void mark_in_log(void *user, const char *label, int64_t time_ns)
{
	const struct gz_window *window = user;
	struct gz_viewer_link *link = window->link ? window->link : window->experiment->link;
	if (link)
		gz_viewer_link_annotate(link, label, time_ns);
}

static enum gz_result write_answer(void *user, const struct gz_trial_result *result)
{
	const struct gz_window *window = user;
	const struct gz_status *status =
		window->source ? gz_gaze_source_status(window->source) : NULL;
	const struct gz_trial_equipment equipment = {
		.tracker = status ? status->tracker.name : NULL,
		.tracker_serial = status ? status->tracker.serial : NULL,
		.daemon_version = status ? status->version : NULL,
		.backend = window->record.backend,
		.display = window->shown_display,
	};
	return gz_answers_write(window->experiment->sitting->answers, result,
				window->experiment->start_ns, &equipment);
}

/* What the file of answers calls the source of the gaze. */
static const char *source_name(enum gz_gaze_kind kind)
{
	static const char *const names[] = {
		[GZ_GAZE_CENTRE] = "fixed",  [GZ_GAZE_FIXED] = "fixed",
		[GZ_GAZE_MOUSE] = "mouse",   [GZ_GAZE_POINTER] = "pointer",
		[GZ_GAZE_LATEST] = "daemon", [GZ_GAZE_LOG] = "log",
	};
	return names[kind];
}

static enum gz_result check_gaze_kind(const struct gz_window *window,
				      const struct gz_experiment *experiment)
{
	const enum gz_gaze_kind kind = window->options->gaze.kind;
	const bool moves = kind != GZ_GAZE_CENTRE && kind != GZ_GAZE_FIXED;
	if (moves || experiment->params.gaze != GZ_GAZE_REQUIRED)
		return GZ_OK;
	gz_err(window->log,
	       "--gaze %s: %s has gaze = required; use a tracker, as with --gaze daemon, or the "
	       "mouse, with --gaze mouse",
	       window->options->gaze_text, experiment->path);
	return GZ_ERR_INVAL;
}

/* Scenes' settings for a window with panels are ignored; the command line's are used. */
static enum gz_result set_experiment_view(struct gz_window *window)
{
	struct gz_scene_settings settings = { 0 };
	const struct gz_option_binding binding = { gz_view_setting_options,
						   gz_view_setting_option_count, &settings.view,
						   NULL };
	enum gz_result r = gz_options_preset(&binding);
	if (r == GZ_OK)
		r = gz_view_options_apply(window->options, &settings);
	window->settings.view = settings.view;
	window->experiment->view = settings.view;
	return r;
}

static void begin_trials(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_sitting *sitting = state->sitting;
	const struct gz_run_start start = {
		.experiment = &sitting->experiment,
		.sequence = &sitting->sequence,
		.participant = sitting->options->participant,
		.session = sitting->options->session,
		.first = gz_answers_next(sitting->answers),
		.sink = { .user = window, .mark = mark_in_log, .over = write_answer },
	};
	gz_run_begin(&state->run, &start);
}

static enum gz_result open_sitting(struct gz_window *window,
				   const struct gz_sitting_options *options)
{
	struct gz_window_experiment *state = window->experiment;
	window->alone = &gz_window_experiment_part;
	window->picture_hidden = true;
	const struct gz_sitting_program program = {
		.version = GAZECAST_VERSION,
		.gaze_source = source_name(window->options->gaze.kind),
	};
	enum gz_result r = gz_sitting_open(options, &program, window->log, &state->sitting);
	if (r == GZ_OK)
		r = check_gaze_kind(window, &state->sitting->experiment);
	if (r == GZ_OK)
		r = set_experiment_view(window);
	/* A daemon may record even if the gaze comes from elsewhere. */
	if (r == GZ_OK && !window->link)
		r = gz_viewer_link_open(NULL, window->log, &state->link);
	if (r == GZ_OK)
		begin_trials(window);
	return r;
}

/* Without a participant the part experiment_start asks for one first. */
static enum gz_result open_experiment(struct gz_window *window)
{
	const struct gz_sitting_options *options = &window->options->sitting;
	if (!options->file[0] || !options->participant[0])
		return GZ_OK;
	window->experiment = calloc(1, sizeof *window->experiment);
	return window->experiment ? open_sitting(window, options) : GZ_ERR_NO_MEM;
}

/* Full screen, also when the window loses the focus. */
static enum gz_result open_experiment_window(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return GZ_OK;
	gz_widgets_leave_cursor();
	glfwSetInputMode(window->glfw, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	state->pointer_hidden = true;
	glfwSetDropCallback(window->glfw, NULL); /* files cannot be dropped */
	glfwSetWindowAttrib(window->glfw, GLFW_AUTO_ICONIFY, GLFW_FALSE);
	if (!state->placed && !window->options->target.windowed)
		gz_window_toggle_fullscreen(window);
	state->placed = true;
	GLFWmonitor *monitor = gz_glfw_monitor_of(window->glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	const int hz = mode && mode->refreshRate > 0 ? mode->refreshRate : USUAL_REFRESH_HZ;
	state->refresh_ns = GZ_NS_PER_S / hz;
	return GZ_OK;
}

/* The tracker's display is known once the daemon has described it. */
static void follow_display(struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	struct GLFWmonitor *wanted = gz_window_tracker_handle(window);
	struct GLFWmonitor *there = glfwGetWindowMonitor(window->glfw);
	if (!state->run.begun && wanted && there && wanted != there)
		gz_window_fill_monitor(window, wanted);
}

static void finish_experiment(struct gz_window *window, enum gz_result result)
{
	gz_run_stop(&window->experiment->run, result, gz_clock_now_ns());
	glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

/* Before the first interval make each picture of the trial once, unseen, so that nothing has to be
 * prepared later; that of the first interval last, as it is shown next. @return whether that is
 * done */
static bool warm_trial_up(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_presentation *presentation = state->run.trial.presentation;
	if (state->run.phase != GZ_RUN_PREPARE || !state->run.shown_ns ||
	    !gz_experiment_scenes_ready(state))
		return false;
	if (state->warm_index != state->run.index + 1) {
		state->warm_index = state->run.index + 1;
		state->warm_left = presentation->condition->params.intervals;
		state->warming = false;
	}
	if (state->warming && !state->frame_made)
		return false;
	state->warm_left -= state->warming;
	state->warming = state->warm_left > 0;
	if (!state->warming)
		return true;
	const int which = gz_presentation_alternative(presentation, state->warm_left - 1);
	state->shown =
		state->shown == &presentation->condition->alternatives[which] ? NULL : state->shown;
	const enum gz_result r =
		gz_experiment_show(window, &presentation->condition->alternatives[which]);
	if (r != GZ_OK)
		finish_experiment(window, r);
	return false;
}

/* Make the picture that the phase shows or will show next, if there is one. */
static void choose_trial_picture(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_run *run = &state->run;
	const struct gz_presentation *presentation = run->trial.presentation;
	const bool seen = run->phase == GZ_RUN_INTERVAL;
	const bool next = (run->phase == GZ_RUN_FIXATION || run->phase == GZ_RUN_BLANK) &&
			  run->shown_ns; /* the screen in between is shown first */
	window->picture_hidden =
		!seen && !next && !(run->phase == GZ_RUN_PREPARE && state->warming);
	if (!seen && !next)
		return;
	const int interval = run->phase == GZ_RUN_BLANK ? run->interval + 1 : run->interval;
	const int which = gz_presentation_alternative(presentation, interval);
	const enum gz_result r =
		gz_experiment_show(window, &presentation->condition->alternatives[which]);
	if (r != GZ_OK)
		finish_experiment(window, r);
}

static void tell_missing_gaze(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const bool shown = state->run.phase == GZ_RUN_INTERVAL;
	if (state->absence_told || !state->gaze_told || state->gaze_there ||
	    (!shown && !state->run.gaze_missing))
		return;
	state->absence_told = true;
	if (shown)
		gz_warn(window->log,
			"no gaze from the tracker: pictures are sharp at the last gaze or at "
			"the mouse; is gazed running, and does it see the eye?");
	else
		gz_warn(window->log,
			"no gaze from the tracker: the experiment waits for it; is gazed "
			"running, and does it see the eye?");
}

/* Duration of a frame: the display's refresh or, if it is longer, the shorter of the last two turns
 * in this phase, which leaves out the first picture. */
static int64_t frame_duration_ns(struct gz_window_experiment *state, int64_t now_ns)
{
	const bool same = state->turn_phase == state->run.phase && state->run.shown_ns;
	const int64_t spent_ns = same ? now_ns - state->turn_ns : 0;
	const int64_t before_ns = same ? state->turn_spent_ns : 0;
	const int64_t usual_ns = spent_ns < before_ns ? spent_ns : before_ns;
	state->turn_ns = now_ns;
	state->turn_spent_ns = spent_ns;
	state->turn_phase = state->run.phase;
	return usual_ns > state->refresh_ns ? usual_ns : state->refresh_ns;
}

static struct gz_place pointer_of(const struct gz_window *window)
{
	return (struct gz_place) { (float)window->cursor[0], (float)window->cursor[1] };
}

/* The button of the present screen below the mouse; -1: none. */
static int button_below(const struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	return state->button_phase == state->run.phase
		       ? gz_experiment_button_at(state->buttons, state->button_count,
						 pointer_of(window))
		       : -1;
}

/* Show the mouse cursor where there is something to click, never over a picture. */
static void follow_pointer(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	struct gz_run_screen screen;
	gz_run_screen(&state->run, &screen);
	const bool hidden = screen.choice_count == 0;
	if (hidden != state->pointer_hidden)
		glfwSetInputMode(window->glfw, GLFW_CURSOR,
				 hidden ? GLFW_CURSOR_HIDDEN : GLFW_CURSOR_NORMAL);
	state->pointer_hidden = hidden;
	const int bright = button_below(window);
	if (bright != state->button_bright)
		window->present_needed = true;
	state->button_bright = bright;
}

static void step_experiment(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	const int64_t now_ns = gz_clock_now_ns();
	const struct gz_run_input input = {
		.now_ns = now_ns,
		.refresh_ns = frame_duration_ns(state, now_ns),
		.ready = warm_trial_up(window),
		.gaze_there = state->gaze_there,
	};
	if (gz_run_step(&state->run, &input))
		window->present_needed = true;
	choose_trial_picture(window);
	follow_pointer(window);
	tell_missing_gaze(window);
	/* In an interval every refresh is a frame, so that missed ones are seen in the times
	 * between frames. */
	if (state->run.phase == GZ_RUN_INTERVAL || gz_experiment_loaded_share(state) < 1)
		window->present_needed = true;
}

/* A picture that could not be made has closed its scene; why is logged. */
static enum gz_result check_trial_picture(const struct gz_window *window)
{
	const struct gz_alternative *shown = window->experiment->shown;
	if (!shown || window->maker)
		return GZ_OK;
	gz_err(window->log,
	       "%s: its picture cannot be made; the experiment ends, and answers so far are kept",
	       shown->scene);
	return GZ_ERR_UNSUPPORTED;
}

static void turn_experiment(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	follow_display(window);
	enum gz_result r = state->run.phase == GZ_RUN_ENDED ? GZ_OK : check_trial_picture(window);
	if (r == GZ_OK)
		r = gz_experiment_load_ahead(window);
	if (r != GZ_OK)
		finish_experiment(window, r);
	else if (state->run.phase != GZ_RUN_ENDED)
		step_experiment(window);
	if (state->run.phase == GZ_RUN_ENDED)
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

static void note_gaze(struct gz_window *window, struct gz_window_gaze *gaze)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	const enum gz_gaze_kind kind = window->options->gaze.kind;
	const struct gz_gaze_reading *reading = &gaze->reading;
	const bool closed = reading->has_event &&
			    (reading->event == GZ_EVENT_BLINK || reading->event == GZ_EVENT_LOST);
	state->gaze_told = kind == GZ_GAZE_LATEST || kind == GZ_GAZE_POINTER || kind == GZ_GAZE_LOG;
	state->gaze_there = !gaze->missing && reading->known && reading->connected && !closed &&
			    !(reading->has_age && reading->age_ns > GAZE_AGE_NS);
	state->px_per_deg = gz_display_px_per_deg(&gaze->display);
}

static void note_frame(struct gz_window *window)
{
	if (window->experiment && window->record.bricks_coming == 0)
		window->experiment->frame_made = true;
}

static void paint_ground(struct gz_window *window, int width, int height)
{
	const struct gz_window_experiment *state = window->experiment;
	if (!state || (state->run.phase == GZ_RUN_INTERVAL && window->any_shown))
		return;
	const double *ground = state->sitting->experiment.params.ground;
	glViewport(0, 0, width, height);
	glClearColor((float)ground[0], (float)ground[1], (float)ground[2], 1);
	glClear(GL_COLOR_BUFFER_BIT);
}

/* The cross's width in the window's screen coordinates. */
static float cross_width(const struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	int width = 1, height = 1;
	glfwGetFramebufferSize(window->glfw, &width, &height);
	const double px = state->px_per_deg * state->sitting->experiment.params.fixation_deg;
	return (float)(px * gz_widgets_room().x / fmax(1, width));
}

static void draw_buttons(struct gz_window *window, const struct gz_experiment_look *look,
			 const struct gz_run_screen *screen)
{
	struct gz_window_experiment *state = window->experiment;
	const struct gz_place mouse = pointer_of(window);
	state->button_phase = screen->phase;
	state->button_count = screen->choice_count;
	for (size_t i = 0; i < screen->choice_count; i++) {
		state->buttons[i].name = screen->choices[i].name;
		state->buttons[i].key = screen->choices[i].key_name;
		state->button_keys[i] = screen->choices[i].key;
	}
	gz_experiment_screen_buttons(look, state->buttons, state->button_count,
				     window->cursor_inside ? &mouse : NULL);
}

static void draw_experiment_screen(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_window_experiment *state = window->experiment;
	(void)gaze;
	if (!state)
		return;
	struct gz_run_screen screen;
	gz_run_screen(&state->run, &screen);
	const struct gz_experiment_params *params = &state->sitting->experiment.params;
	const struct gz_experiment_look look = {
		.ground = { params->ground[0], params->ground[1], params->ground[2] },
		.text_size = params->text_size,
	};
	if (screen.phase == GZ_RUN_FIXATION && screen.gaze_missing)
		gz_experiment_screen_text(
			&look, window->options->gaze.kind == GZ_GAZE_MOUSE
				       ? "Move the mouse to go on."
				       : "The eye tracker does not see your eyes.\nSit as "
					 "you did before; it goes on by itself.");
	else if (screen.phase == GZ_RUN_FIXATION)
		gz_experiment_screen_cross(&look, cross_width(window));
	else if (screen.text)
		gz_experiment_screen_text(&look, screen.text);
	if (screen.phase == GZ_RUN_TEXT && screen.done > 0 && screen.done < screen.count) {
		char note[64];
		snprintf(note, sizeof note, "%zu of %zu", screen.done, screen.count);
		gz_experiment_screen_note(&look, note);
	}
	draw_buttons(window, &look, &screen);
	const double share = gz_experiment_loaded_share(state);
	if (share < 1 && (screen.phase == GZ_RUN_TEXT || screen.phase == GZ_RUN_PREPARE))
		gz_experiment_screen_bar(&look, share);
}

/* The frame is shown once the driver has finished. */
static void note_presented(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	glFinish();
	const int64_t now_ns = gz_clock_now_ns();
	gz_run_shown(&state->run, now_ns);
	gz_run_frame(&state->run, &(struct gz_run_frame) {
					  .shown_ns = now_ns,
					  .refresh_ns = state->refresh_ns,
					  .gaze_told = state->gaze_told,
					  .gaze_there = state->gaze_there,
				  });
	if (!state->start_ns)
		state->start_ns = state->run.trial.begin_ns;
}

static double experiment_patience_s(const struct gz_window *window)
{
	const struct gz_window_experiment *state = window->experiment;
	if (!state)
		return INFINITY;
	/* With V-sync the swap waits for the display; less than a refresh is left. */
	const double refresh_s = gz_ns_to_s(state->refresh_ns) / 2;
	const struct gz_presentation *presentation = state->run.trial.presentation;
	switch (state->run.phase) {
	case GZ_RUN_TEXT:
	case GZ_RUN_LEAVING:
		return gz_experiment_loaded_share(state) < 1 ? BAR_PATIENCE_S : INFINITY;
	case GZ_RUN_PREPARE:
		return state->warming || gz_experiment_scenes_ready(state) ? 0 : BAR_PATIENCE_S / 2;
	case GZ_RUN_QUESTION:
		return presentation->condition->params.timeout_s > 0 ? refresh_s : INFINITY;
	default:
		return refresh_s;
	}
}

/* Letters by the user's layout; digits by their position, as some layouts need Shift for them. */
static int answer_key(int key, int scancode)
{
	static const struct {
		int glfw, key;
	} keys[] = {
		{ GLFW_KEY_SPACE, GZ_KEY_SPACE },   { GLFW_KEY_LEFT, GZ_KEY_LEFT },
		{ GLFW_KEY_RIGHT, GZ_KEY_RIGHT },   { GLFW_KEY_UP, GZ_KEY_UP },
		{ GLFW_KEY_DOWN, GZ_KEY_DOWN },     { GLFW_KEY_ENTER, GZ_KEY_RETURN },
		{ GLFW_KEY_ESCAPE, GZ_KEY_ESCAPE }, { GLFW_KEY_KP_ENTER, GZ_KEY_RETURN },
	};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (keys[i].glfw == key)
			return keys[i].key;
	if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
		return '0' + key - GLFW_KEY_0;
	if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
		return '0' + key - GLFW_KEY_KP_0;
	const char *name = glfwGetKeyName(key, scancode);
	return name ? gz_answer_key_of(name) : GZ_KEY_NONE;
}

static bool answer_by_key(struct gz_window *window, int key, int scancode, bool repeated)
{
	struct gz_window_experiment *state = window->experiment;
	const int answer = repeated ? GZ_KEY_NONE : answer_key(key, scancode);
	if (answer != GZ_KEY_NONE && gz_run_key(&state->run, answer, gz_clock_now_ns()))
		window->present_needed = true;
	return true;
}

static void answer_by_mouse(struct gz_window *window, int button)
{
	struct gz_window_experiment *state = window->experiment;
	const int pressed = button == GLFW_MOUSE_BUTTON_LEFT ? button_below(window) : -1;
	if (pressed >= 0 &&
	    gz_run_click(&state->run, state->button_keys[pressed], gz_clock_now_ns()))
		window->present_needed = true;
}

enum gz_result gz_window_experiment_outcome(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return window->options->sitting.file[0] ? GZ_ERR_CANCELLED : GZ_OK;
	const struct gz_answers *answers = state->sitting->answers;
	gz_run_stop(&state->run, GZ_ERR_CANCELLED, gz_clock_now_ns());
	gz_sitting_log_thresholds(state->sitting, window->log);
	const size_t done = gz_answers_done(answers), count = state->sitting->sequence.count;
	if (gz_answers_next(answers) == count)
		gz_info(window->log, "%s: all %zu trials are answered", gz_answers_file(answers),
			done);
	else if (done > 0)
		gz_info(window->log, "%s: %zu of %zu trials are answered; --resume continues",
			gz_answers_file(answers), done, count);
	else
		gz_info(window->log, "left before the first answer; nothing is kept");
	return state->run.result;
}

static void close_experiment(struct gz_window *window)
{
	struct gz_window_experiment *state = window->experiment;
	if (!state)
		return;
	gz_experiment_release_scenes(window);
	gz_viewer_link_close(&state->link);
	gz_sitting_close(&state->sitting);
	free(state);
	window->experiment = NULL;
	window->alone = NULL;
}

enum gz_result gz_window_experiment_begin(struct gz_window *window,
					  const struct gz_sitting_options *options)
{
	window->experiment = calloc(1, sizeof *window->experiment);
	if (!window->experiment)
		return GZ_ERR_NO_MEM;
	enum gz_result r = open_sitting(window, options);
	if (r == GZ_OK)
		r = open_experiment_window(window);
	if (r != GZ_OK)
		close_experiment(window);
	return r;
}

const struct gz_window_part gz_window_experiment_part = {
	.name = "experiment",
	.open = open_experiment,
	.gl_open = open_experiment_window,
	.turn = turn_experiment,
	.gaze = note_gaze,
	.frame_made = note_frame,
	.paint = paint_ground,
	.panels = draw_experiment_screen,
	.presented = note_presented,
	.patience_s = experiment_patience_s,
	.key = answer_by_key,
	.press = answer_by_mouse,
	.close = close_experiment,
};
