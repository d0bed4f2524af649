/* The part that asks before changes are lost, and names the scene in the window's title. */
#include "view/window/unsaved.h"

#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/history.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Unscaled (chosen: a name and a question). */
#define WIDTH 420.0f

enum { TITLE_SIZE = 512 };

/* What waits for an answer. */
enum waiting { NOTHING, QUIT, OPEN };

struct gz_window_unsaved {
	enum waiting waiting;
	bool saving;             /* the dialog for the name is open */
	char path[GZ_PATH_SIZE]; /* OPEN: the file */
	char title[TITLE_SIZE];  /* of the window */
};

static const char *scene_name(const struct gz_window *window)
{
	const char *path = gz_window_scene_path(window), *slash = strrchr(path, '/');
	return slash && slash[1] ? slash + 1 : path;
}

static void go_on(struct gz_window *window)
{
	struct gz_window_unsaved *self = window->unsaved;
	const enum waiting waiting = self->waiting;
	self->waiting = NOTHING;
	self->saving = false;
	if (waiting == QUIT)
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
	else if (waiting == OPEN)
		gz_window_open_file(window, self->path);
	gz_window_wake_panels(window);
}

static void stay(struct gz_window *window)
{
	window->unsaved->waiting = NOTHING;
	window->unsaved->saving = false;
	gz_window_wake_panels(window);
}

/* @return whether there is anything to ask about */
static bool ask_about(struct gz_window *window, enum waiting waiting)
{
	if (!gz_window_scene_changed(window))
		return false;
	window->unsaved->waiting = waiting;
	window->unsaved->saving = false;
	gz_window_wake_panels(window);
	return true;
}

void gz_window_quit(struct gz_window *window)
{
	if (!ask_about(window, QUIT))
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
}

bool gz_window_ask_before_opening(struct gz_window *window, const char *path)
{
	if (!ask_about(window, OPEN))
		return false;
	snprintf(window->unsaved->path, sizeof window->unsaved->path, "%s", path);
	return true;
}

static void on_close(GLFWwindow *glfw)
{
	struct gz_window *window = glfwGetWindowUserPointer(glfw);
	if (ask_about(window, QUIT))
		glfwSetWindowShouldClose(glfw, GLFW_FALSE);
}

/* A new window has no title. */
static enum gz_result attach_close_callback(struct gz_window *window)
{
	glfwSetWindowCloseCallback(window->glfw, on_close);
	window->unsaved->title[0] = '\0';
	return GZ_OK;
}

static void save_first(struct gz_window *window)
{
	gz_window_save_scene(window);
	if (!gz_window_scene_changed(window))
		go_on(window);
	else
		window->unsaved->saving = true;
}

/* While the name is asked for: it has been saved, or the dialog was cancelled. */
static void follow_saving(struct gz_window *window)
{
	if (!gz_window_scene_changed(window))
		go_on(window);
	else if (!gz_window_is_saving(window))
		stay(window);
}

static void follow_title(struct gz_window *window)
{
	struct gz_window_unsaved *self = window->unsaved;
	const char *name = window->alone ? "" : scene_name(window);
	char title[TITLE_SIZE];
	snprintf(title, sizeof title, "%s%.400s%sgazeview",
		 gz_window_scene_changed(window) ? "*" : "", name, name[0] ? " - " : "");
	if (strcmp(title, self->title) == 0)
		return;
	memcpy(self->title, title, sizeof title);
	glfwSetWindowTitle(window->glfw, title);
}

static void turn_unsaved(struct gz_window *window)
{
	if (window->unsaved->saving)
		follow_saving(window);
	follow_title(window);
}

static void draw_question(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	static const struct gz_panel_place place = { .at = GZ_PANEL_MIDDLE,
						     .width = WIDTH,
						     .takes_keyboard = true };
	const struct gz_window_unsaved *self = window->unsaved;
	char text[TITLE_SIZE + 64];
	bool open = true;
	(void)gaze;
	if (self->waiting == NOTHING || self->saving)
		return;
	snprintf(text, sizeof text, "%.400s has changes that are not saved.", scene_name(window));
	bool save = false, discard = false, cancel = false;
	if (gz_panel_begin("Save the changes?", &place, &open)) {
		gz_widget_text(gz_paint_plain, text);
		save = gz_widget_button("Save") || gz_dialog_entered();
		gz_widgets_same_line(0);
		discard = gz_widget_button("Discard");
		gz_widgets_same_line(0);
		cancel = gz_widget_button("Cancel") || gz_dialog_escaped();
	}
	gz_panel_end();
	if (save)
		save_first(window);
	else if (discard)
		go_on(window);
	else if (cancel || !open)
		stay(window);
}

static void forget_question(struct gz_window *window)
{
	stay(window);
}

static void quit_by_key(struct gz_window *window, int number)
{
	(void)number;
	gz_window_quit(window);
}

static const struct gz_window_action unsaved_actions[] = {
	{ .letter = 'q',
	  .keys = "Q or Esc",
	  .help = "quit; Esc first closes open panels",
	  .group = "window",
	  .name = "Quit",
	  .menu = GZ_MENU_FILE,
	  .section = 3,
	  .words = "exit close leave end",
	  .run = quit_by_key },
	{ .key = GLFW_KEY_ESCAPE, .run = quit_by_key },
};

const struct gz_window_part gz_window_unsaved_part = {
	.name = "unsaved",
	GZ_PART_ACTIONS(unsaved_actions),
	GZ_PART_STATE(unsaved),
	.gl_open = attach_close_callback,
	.scene_leaving = forget_question,
	.turn = turn_unsaved,
	.panels = draw_question,
};
