#include "view/window/transfer.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "render/scene/scene_files.h"
#include "render/transfer/histogram.h"
#include "view/panels/transfer_panel.h"
#include "view/panels/widgets.h"
#include "view/window/loading.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Of what is counted; the plot is no wider. */
#define BINS GZ_HISTOGRAM_BINS_MAX

/* A histogram that a thread counts. */
struct count {
	const struct gz_volume *volume;
	const struct gz_log *log;
	pthread_t thread;
	bool running;
	atomic_bool cancelled, done;
	enum gz_result result;
	struct gz_histogram histogram;
};

/* State of the part. */
struct gz_window_transfer {
	struct gz_transfer_edit *edit;
	struct gz_transfer_panel panel;
	char file[GZ_PATH_SIZE]; /* that has what was loaded or saved last */
	uint64_t shown;          /* changes that the renderer has */
	struct count count;
	bool counted; /* or tried */
	bool focus_due;
};

static void *count_voxels(void *user)
{
	struct count *count = user;
	count->result = gz_histogram_count(count->volume, BINS, 0, &count->cancelled, count->log,
					   &count->histogram);
	atomic_store(&count->done, true);
	glfwPostEmptyEvent();
	return NULL;
}

static void start_counting(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	struct count *count = &transfer->count;
	transfer->counted = true;
	count->volume = &gz_frame_maker_scene(window->maker)->volume;
	count->log = window->log;
	atomic_store(&count->cancelled, false);
	atomic_store(&count->done, false);
	count->running = pthread_create(&count->thread, NULL, count_voxels, count) == 0;
	if (!count->running)
		gz_err(window->log, "no thread for the histogram; the editor goes without");
}

static void stop_counting(struct gz_window_transfer *transfer)
{
	struct count *count = &transfer->count;
	transfer->panel.histogram = NULL;
	transfer->counted = false;
	if (!count->running)
		return;
	atomic_store(&count->cancelled, true);
	pthread_join(count->thread, NULL);
	count->running = false;
}

static void take_count(struct gz_window *window)
{
	struct count *count = &window->transfer->count;
	if (!count->running || !atomic_load(&count->done))
		return;
	pthread_join(count->thread, NULL);
	count->running = false;
	if (count->result == GZ_OK)
		window->transfer->panel.histogram = &count->histogram;
	gz_window_wake_panels(window);
}

static void toggle(struct gz_window *window, int number)
{
	(void)number;
	struct gz_window_transfer *transfer = window->transfer;
	transfer->panel.open = !transfer->panel.open;
	transfer->focus_due = transfer->panel.open;
	gz_window_wake_panels(window);
}

static void undo(struct gz_window *window, int again)
{
	struct gz_window_transfer *transfer = window->transfer;
	if (!transfer->panel.open || !transfer->edit)
		return;
	if (again)
		gz_transfer_edit_redo(transfer->edit);
	else
		gz_transfer_edit_undo(transfer->edit);
	gz_window_wake_panels(window);
}

static bool is_open(const struct gz_window *window)
{
	return window->transfer && window->transfer->panel.open;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_open, .run = toggle },
	{ .letter = 'e', .keys = "E", .help = "edit the transfer function", .run = toggle },
	{ .letter = 'z',
	  .modifiers = GZ_KEY_CONTROL,
	  .repeats = true,
	  .keys = "Ctrl+Z",
	  .help = "take back the last step there; with Shift: again",
	  .run = undo },
	{ .letter = 'z',
	  .modifiers = GZ_KEY_CONTROL | GZ_KEY_SHIFT,
	  .repeats = true,
	  .number = 1,
	  .run = undo },
};

static enum gz_result open_part(struct gz_window *window)
{
	window->transfer = calloc(1, sizeof *window->transfer);
	if (window->transfer)
		return GZ_OK;
	gz_err(window->log, "no memory for the window; close other programs");
	return GZ_ERR_NO_MEM;
}

/* The file that the settings name, as it is found from here. */
static void name_file(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	const char *name = window->settings.transfer_file;
	char path[GZ_PATH_SIZE] = "";
	if (name[0] && gz_scene_find_file(gz_window_scene_path(window), name, path) != GZ_OK)
		path[0] = '\0';
	memcpy(transfer->file, path, sizeof path);
	memcpy(transfer->panel.file, path, sizeof path);
}

/* The settings name a file from now on, from wherever they are saved to. */
static void use_file(struct gz_window *window, const char *file)
{
	char *real = realpath(file, NULL);
	if (real && strlen(real) < GZ_PATH_SIZE) {
		memset(window->settings.transfer_file, 0, GZ_PATH_SIZE);
		memcpy(window->settings.transfer_file, real, strlen(real));
	}
	free(real);
	gz_window_transfer_saved(window);
}

static void scene_shown(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	if (transfer->edit)
		gz_transfer_edit_restart(transfer->edit, &scene->transfer);
	else if (gz_transfer_edit_create(&scene->transfer, &transfer->edit) != GZ_OK)
		gz_err(window->log, "no memory to edit the transfer function; close other "
				    "programs");
	if (!transfer->edit)
		return;
	transfer->shown = gz_transfer_edit_changes(transfer->edit);
	transfer->panel.selected = 0;
	transfer->panel.whole_lost = false;
	name_file(window);
}

static void scene_leaving(struct gz_window *window)
{
	stop_counting(window->transfer);
}

/* Another part, as a session that is replayed, has set one: it is what is edited from now on. */
static void follow_others(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	const struct gz_transfer *shown = &gz_frame_maker_scene(window->maker)->transfer;
	if (gz_transfer_edit_is(transfer->edit, shown))
		return;
	gz_transfer_edit_restart(transfer->edit, shown);
	transfer->shown = gz_transfer_edit_changes(transfer->edit);
	gz_window_wake_panels(window);
}

/* Before the next frame, the renderer has what is edited. */
static void turn(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	take_count(window);
	if (!window->maker || !transfer->edit)
		return;
	const uint64_t changes = gz_transfer_edit_changes(transfer->edit);
	if (changes == transfer->shown) {
		follow_others(window);
		return;
	}
	transfer->shown = changes;
	gz_frame_set_transfer(window->maker, gz_transfer_edit_now(transfer->edit));
	window->cast_needed = true;
}

static void save(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	if (gz_transfer_write(gz_transfer_edit_now(transfer->edit), transfer->panel.file,
			      window->log) != GZ_OK)
		return;
	gz_info(window->log, "%s: transfer function written", transfer->panel.file);
	use_file(window, transfer->panel.file);
}

static void panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	(void)gaze;
	struct gz_window_transfer *transfer = window->transfer;
	struct gz_transfer_panel *panel = &transfer->panel;
	if (!panel->open || !window->maker || !transfer->edit)
		return;
	if (!transfer->counted)
		start_counting(window);
	panel->edit = transfer->edit;
	panel->volume = &gz_frame_maker_scene(window->maker)->volume;
	panel->margin_top = window->panels_top;
	panel->margin_bottom = window->panels_bottom;
	panel->focus = transfer->focus_due;
	transfer->focus_due = false;
	const enum gz_transfer_wish wish = gz_transfer_panel_draw(panel);
	if (wish == GZ_TRANSFER_WISH_LOAD)
		gz_window_transfer_load(window, panel->file);
	else if (wish == GZ_TRANSFER_WISH_SAVE)
		save(window);
	/* A changed function is shown at once: turn() looks after it. */
	if (gz_transfer_edit_changes(transfer->edit) != transfer->shown)
		gz_window_wake_panels(window);
}

static double patience_s(const struct gz_window *window)
{
	const struct gz_window_transfer *transfer = window->transfer;
	const bool due = transfer && transfer->edit && window->maker &&
			 gz_transfer_edit_changes(transfer->edit) != transfer->shown;
	return due ? 0 : INFINITY;
}

static void close_part(struct gz_window *window)
{
	if (!window->transfer)
		return;
	stop_counting(window->transfer);
	gz_transfer_edit_destroy(&window->transfer->edit);
	free(window->transfer);
	window->transfer = NULL;
}

const struct gz_transfer *gz_window_transfer(const struct gz_window *window, bool *out_differs,
					     const char **out_file)
{
	const struct gz_window_transfer *transfer = window->transfer;
	if (!window->maker || !transfer || !transfer->edit)
		return NULL;
	*out_differs = gz_transfer_edit_differs(transfer->edit);
	if (out_file)
		*out_file = transfer->file;
	return gz_transfer_edit_now(transfer->edit);
}

void gz_window_transfer_saved(struct gz_window *window)
{
	if (!window->transfer || !window->transfer->edit)
		return;
	gz_transfer_edit_saved(window->transfer->edit);
	name_file(window);
	gz_window_wake_panels(window);
}

enum gz_result gz_window_transfer_load(struct gz_window *window, const char *file)
{
	struct gz_transfer_edit *edit = window->transfer ? window->transfer->edit : NULL;
	struct gz_transfer loaded;
	if (!window->maker || !edit) {
		gz_err(window->log,
		       "%s: a transfer function shows nothing by itself; open a scene or a volume "
		       "first",
		       file);
		return GZ_ERR_INVAL;
	}
	const enum gz_result r = gz_transfer_load(file, window->log, &loaded);
	if (r != GZ_OK)
		return r;
	gz_transfer_edit_end(edit);
	gz_transfer_edit_replace(edit, &loaded);
	use_file(window, file);
	return GZ_OK;
}

const struct gz_window_part gz_window_transfer_part = {
	.name = "transfer",
	.title = "transfer function",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_part,
	.scene_shown = scene_shown,
	.scene_leaving = scene_leaving,
	.turn = turn,
	.panels = panels,
	.patience_s = patience_s,
	.close = close_part,
};
