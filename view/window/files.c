/* The part that opens and saves: dialogs, dropped files, recent files. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <GLFW/glfw3.h>

#include "render/data/dicom_name.h"
#include "render/scene/scene_open.h"
#include "view/files/scene_save.h"
#include "view/panels/file_dialogs.h"
#include "view/window/gaze.h"
#include "view/window/history.h"
#include "view/window/loading.h"
#include "view/window/transfer.h"
#include "view/window/unsaved.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

static const struct gz_save_words scene_words = {
	.title = "Save the scene",
	.what = "The scene with its present settings is saved as:",
	.verb = "Save",
};

struct gz_window_files {
	struct gz_open_panel open_panel;
	struct gz_raw_panel raw_panel;
	struct gz_save_panel save_panel;
	struct gz_recent recent;
	char recent_file[GZ_PATH_SIZE];   /* empty: there is no folder for it */
	char opening[GZ_PATH_SIZE];       /* what the user asked for and is not shown yet */
	bool first;                       /* the raw dialog is about the file of the command line */
	bool made;                        /* the scene has no transfer function of its own … */
	struct gz_transfer made_transfer; /* … and was given this one */
	char made_for[GZ_PATH_SIZE];      /* path of that scene */
	bool has_run;                     /* the scene is shown with options for this run … */
	struct gz_view_settings own_view; /* … in place of some of these, which its file has */
	struct gz_scene_settings to_save; /* as shown, without those options */
	/* A log whose last error is also shown in a dialog. */
	struct gz_log log;
	const struct gz_log *outer;
	char last[GZ_PANEL_MESSAGE_SIZE];
};

/* Sink of that log. */
static void keep_last_error(void *user, enum gz_log_level level, const char *module,
			    const char *message)
{
	struct gz_window_files *state = user;
	if (level == GZ_LOG_ERROR)
		snprintf(state->last, sizeof state->last, "%s", message);
	state->outer->sink(state->outer->user, level, module, message);
}

static enum gz_result open_files(struct gz_window *window)
{
	struct gz_window_files *state = window->files;
	state->outer = window->log;
	gz_log_init(&state->log, keep_last_error, state, window->log->rules);
	if (gz_recent_file(state->recent_file) == GZ_OK)
		gz_recent_read(state->recent_file, &state->recent);
	else
		state->recent_file[0] = '\0';
	return GZ_OK;
}

static void close_files(struct gz_window *window)
{
	gz_open_panel_close(&window->files->open_panel);
}

/* ---- opening ---- */

static void load_file(struct gz_window *window, const char *path, const struct gz_raw_layout *raw)
{
	struct gz_window_load_request *request = calloc(1, sizeof *request);
	if (!request) {
		gz_err(window->log, "%s: no memory to open it", path);
		return;
	}
	snprintf(request->path, sizeof request->path, "%s", path);
	request->has_raw = raw != NULL;
	if (raw)
		request->raw = *raw;
	const enum gz_file_kind kind = gz_file_kind_of(path);
	request->keep = kind != GZ_FILE_SCENE && kind != GZ_FILE_PICTURE;
	request->by_options = window->files->first;
	window->files->first = false;
	snprintf(window->files->opening, sizeof window->files->opening, "%s", path);
	gz_window_load(window, request);
	free(request);
}

void gz_window_open_file(struct gz_window *window, const char *path)
{
	if (strlen(path) >= GZ_PATH_SIZE) {
		gz_err(window->log, "%.60s...: the path is longer than %d bytes; move the file",
		       path, GZ_PATH_SIZE - 1);
		return;
	}
	switch (gz_file_kind_of(path)) {
	case GZ_FILE_SCENE:
	case GZ_FILE_VOLUME:
	case GZ_FILE_PICTURE:
	case GZ_FILE_OTHER:
		load_file(window, path, NULL);
		return;
	case GZ_FILE_RAW:
		gz_raw_panel_show(&window->files->raw_panel, path);
		break;
	case GZ_FILE_TRANSFER:
		gz_window_transfer_load(window, path);
		break;
	case GZ_FILE_GAZE_LOG:
		gz_window_ask_for_gaze(window, path);
		break;
	}
	gz_window_wake_panels(window);
}

/* Whether a file takes the place of the scene. */
static bool replaces_scene(const char *path)
{
	const enum gz_file_kind kind = gz_file_kind_of(path);
	return kind != GZ_FILE_TRANSFER && kind != GZ_FILE_GAZE_LOG;
}

static void open_or_ask(struct gz_window *window, const char *path)
{
	if (!replaces_scene(path) || !gz_window_ask_before_opening(window, path))
		gz_window_open_file(window, path);
}

bool gz_window_ask_layout(struct gz_window *window)
{
	const char *path = window->options->scene;
	struct gz_raw_layout told;
	struct gz_raw_guess guess;
	snprintf(window->files->opening, sizeof window->files->opening, "%s", path);
	if (gz_file_kind_of(path) != GZ_FILE_RAW || access(path, R_OK) != 0 ||
	    gz_view_options_raw(window->options, &told) ||
	    (gz_raw_guess(path, gz_raw_file_bytes(path), &guess, 1) > 0 && guess.certain))
		return false;
	window->files->first = true;
	gz_raw_panel_show(&window->files->raw_panel, path);
	gz_window_wake_panels(window);
	return true;
}

static void folder_of_path(const char *path, char out_folder[GZ_PATH_SIZE])
{
	const char *slash = strrchr(path, '/');
	if (!slash)
		snprintf(out_folder, GZ_PATH_SIZE, ".");
	else
		snprintf(out_folder, GZ_PATH_SIZE, "%.*s", slash > path ? (int)(slash - path) : 1,
			 path);
}

static void show_open_panel(struct gz_window *window, int number)
{
	char folder[GZ_PATH_SIZE];
	(void)number;
	folder_of_path(gz_window_scene_path(window), folder);
	gz_open_panel_show(&window->files->open_panel, folder, &window->files->recent);
	gz_window_wake_panels(window);
}

static void load_again_resampled(struct gz_window *window, int number)
{
	(void)number;
	gz_window_load_resampled(window);
}

static bool may_open_files(const struct gz_window *window)
{
	return !window->alone; /* an experiment shows its own scenes */
}

void gz_window_ask_for_file(struct gz_window *window)
{
	show_open_panel(window, 0);
}

const struct gz_recent *gz_window_recent(const struct gz_window *window)
{
	return &window->files->recent;
}

/* Of several files the first is opened; a DICOM slice stands for its series. */
static void on_drop(GLFWwindow *glfw, int count, const char *paths[])
{
	struct gz_window *window = glfwGetWindowUserPointer(glfw);
	if (count < 1 || window->alone) /* an experiment shows its own scenes */
		return;
	if (count > 1)
		gz_info(window->log, "%d files were dropped: opening %s%s", count, paths[0],
			gz_dicom_is(paths[0]) ? " with its series" : " only");
	open_or_ask(window, paths[0]);
}

static enum gz_result attach_drop_callback(struct gz_window *window)
{
	glfwSetDropCallback(window->glfw, on_drop);
	return GZ_OK;
}

/* ---- saving ---- */

void gz_window_drop_run_settings(const struct gz_window *window, struct gz_view_settings *view)
{
	const struct gz_window_files *state = window->files;
	if (state->has_run)
		gz_view_run_copy(gz_view_options_run(window->options, view), &state->own_view,
				 view);
}

static struct gz_scene_save scene_to_save(const struct gz_window *window)
{
	struct gz_window_files *state = window->files;
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	state->to_save = window->settings;
	gz_window_drop_run_settings(window, &state->to_save.view);
	return (struct gz_scene_save) {
		.scene = { &state->to_save, scene->has_display, gz_window_scene_path(window) },
		.transfer = &scene->transfer,
		.made = window->files->made ? &window->files->made_transfer : NULL,
	};
}

/* The file has these now. What options set for this run goes on. */
static void take_saved_settings(struct gz_window *window, const struct gz_scene_settings *saved)
{
	struct gz_window_files *state = window->files;
	const struct gz_view_settings run = window->settings.view;
	const unsigned which = state->has_run ? gz_view_options_run(window->options, &run) : 0;
	state->own_view = saved->view;
	window->settings = *saved;
	gz_view_run_copy(which, &run, &window->settings.view);
}

static enum gz_result save_scene_to(struct gz_window *window, const char *path)
{
	const struct gz_scene_save save = scene_to_save(window);
	struct gz_window_files *state = window->files;
	state->last[0] = '\0';
	const enum gz_result r = gz_scene_save(&save, path, &state->log, &state->to_save);
	if (r != GZ_OK)
		return r;
	take_saved_settings(window, &state->to_save);
	gz_info(window->log, "saved as %s", path);
	if (strcmp(state->made_for, gz_window_scene_path(window)) == 0)
		snprintf(state->made_for, sizeof state->made_for, "%s", path);
	gz_window_rename_scene(window, path);
	gz_window_transfer_saved(window);
	gz_window_scene_saved(window);
	gz_recent_add(&state->recent, path);
	if (state->recent_file[0])
		gz_recent_write(&state->recent, state->recent_file, window->log);
	return GZ_OK;
}

static void show_save_panel(struct gz_window *window, int number)
{
	char path[GZ_PATH_SIZE];
	(void)number;
	if (!window->maker) {
		gz_warn(window->log, "nothing to save: no scene is shown");
		return;
	}
	gz_scene_save_suggest(gz_window_scene_path(window), path);
	gz_save_panel_show(&window->files->save_panel, &scene_words, path);
	gz_window_wake_panels(window);
}

/* Ask before files are replaced that are not the scene's own. @return whether there are any */
static bool print_replace_question(struct gz_window *window, const char *path, bool own, char *text,
				   size_t size)
{
	const struct gz_scene_save save = scene_to_save(window);
	char transfer[GZ_PATH_SIZE];
	const bool scene = !own && access(path, F_OK) == 0;
	const bool function =
		gz_scene_save_writes_transfer(&save, path, transfer) && access(transfer, F_OK) == 0;
	if (scene)
		snprintf(text, size, "%.150s exists%s. Replace?", path,
			 function ? ", and so does its .tf" : "");
	else if (function)
		snprintf(text, size, "%.200s exists. Replace?", transfer);
	return scene || function;
}

/* The scene's own file is replaced without a question, unless a transfer function would be lost. */
static void save_scene(struct gz_window *window, int number)
{
	char question[GZ_PANEL_MESSAGE_SIZE];
	const char *path = window->maker ? gz_window_scene_path(window) : "";
	const bool own = gz_file_kind_by_name(path) == GZ_FILE_SCENE && access(path, F_OK) == 0;
	struct gz_save_panel *panel = &window->files->save_panel;
	if (own && !print_replace_question(window, path, true, question, sizeof question)) {
		if (save_scene_to(window, path) == GZ_OK)
			return;
		show_save_panel(window, number);
		snprintf(panel->message, sizeof panel->message, "%s", window->files->last);
		return;
	}
	show_save_panel(window, number);
	if (own)
		gz_save_panel_ask(panel, question);
}

void gz_window_save_scene(struct gz_window *window)
{
	save_scene(window, 0);
}

bool gz_window_is_saving(const struct gz_window *window)
{
	return window->files->save_panel.open;
}

static void draw_save_dialog(struct gz_window *window)
{
	struct gz_save_panel *panel = &window->files->save_panel;
	char path[GZ_PATH_SIZE], question[GZ_PANEL_MESSAGE_SIZE];
	bool sure = false;
	if (!window->maker || !gz_save_panel_draw(panel, &sure))
		return;
	if (gz_scene_save_path(panel->path, path) != GZ_OK) {
		snprintf(panel->message, sizeof panel->message, "the path is too long");
	} else if (!sure &&
		   print_replace_question(window, path, false, question, sizeof question)) {
		gz_save_panel_ask(panel, question);
	} else if (save_scene_to(window, path) == GZ_OK) {
		panel->open = false;
	} else {
		snprintf(panel->message, sizeof panel->message, "%s", window->files->last);
	}
	gz_window_wake_panels(window);
}

/* ---- what is shown ---- */

static void draw_file_dialogs(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_files *state = window->files;
	char path[GZ_PATH_SIZE];
	(void)gaze;
	if (gz_open_panel_draw(&state->open_panel, path)) {
		gz_open_panel_close(&state->open_panel);
		open_or_ask(window, path);
	}
	if (gz_raw_panel_draw(&state->raw_panel)) {
		const struct gz_raw_layout layout = state->raw_panel.layout;
		load_file(window, state->raw_panel.path, &layout);
	}
	draw_save_dialog(window);
}

static void note_scene_shown(struct gz_window *window)
{
	struct gz_window_files *state = window->files;
	const char *path = gz_window_scene_path(window);
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	const struct gz_view_settings *own = gz_frame_maker_own_view(window->maker);
	state->has_run = own != NULL;
	if (own)
		state->own_view = *own;
	/* A scene that is shown again, as after a failed loading, may have been edited. */
	if (strcmp(path, state->made_for) != 0 || path[0] == '\0' ||
	    strcmp(path, state->opening) == 0) {
		state->made = !gz_scene_transfer_name(&scene->settings)[0] &&
			      gz_file_kind_by_name(path) != GZ_FILE_PICTURE;
		state->made_transfer = scene->transfer;
		snprintf(state->made_for, sizeof state->made_for, "%s", path);
	}
	/* Scenes of an experiment are not recent files. */
	if (!path[0] || strcmp(path, state->opening) != 0)
		return;
	state->opening[0] = '\0';
	gz_recent_add(&state->recent, path);
	if (state->recent_file[0])
		gz_recent_write(&state->recent, state->recent_file, window->log);
}

static const struct gz_window_action files_actions[] = {
	{ .letter = 'o',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+O",
	  .help = "open a scene, a volume or a picture",
	  .name = "Open...",
	  .menu = GZ_MENU_FILE,
	  .on_picture = true,
	  .words = "load import dicom nifti file browse",
	  .run = show_open_panel },
	{ .letter = 'o',
	  .modifiers = GZ_KEY_CONTROL | GZ_KEY_SHIFT,
	  .keys = "Ctrl+Shift+O",
	  .help = "open it again, resample uneven slices",
	  .name = "Open again, resampled",
	  .menu = GZ_MENU_FILE,
	  .words = "reload dicom",
	  .applies = may_open_files,
	  .run = load_again_resampled },
	{ .letter = 's',
	  .modifiers = GZ_KEY_CONTROL,
	  .keys = "Ctrl+S",
	  .help = "save the scene",
	  .name = "Save scene",
	  .menu = GZ_MENU_FILE,
	  .section = 1,
	  .words = "store keep write",
	  .run = save_scene },
	{ .letter = 's',
	  .modifiers = GZ_KEY_CONTROL | GZ_KEY_SHIFT,
	  .keys = "Ctrl+Shift+S",
	  .help = "save the scene as another file",
	  .name = "Save scene as...",
	  .menu = GZ_MENU_FILE,
	  .section = 1,
	  .run = show_save_panel },
};

const struct gz_window_part gz_window_files_part = {
	.name = "files",
	GZ_PART_ACTIONS(files_actions),
	GZ_PART_STATE(files),
	.open = open_files,
	.gl_open = attach_drop_callback,
	.scene_shown = note_scene_shown,
	.panels = draw_file_dialogs,
	.close = close_files,
};
