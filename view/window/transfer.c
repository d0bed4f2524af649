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

/* The plot is no wider. */
#define BINS GZ_HISTOGRAM_BINS_MAX

/* A histogram that is counted on a thread. */
struct histogram_job {
	const struct gz_volume *volume;
	const struct gz_log *log;
	pthread_t thread;
	bool running;
	atomic_bool cancelled, done;
	int time_point; /* of the volume, from 0 */
	enum gz_result result;
	struct gz_histogram histogram;
};

struct gz_window_transfer {
	struct gz_transfer_edit *edit;
	struct gz_transfer_panel panel;
	char file[GZ_PATH_SIZE]; /* file that was loaded or saved last */
	uint64_t shown;          /* number of changes that the renderer has */
	struct histogram_job count;
	bool counted; /* or the attempt failed */
	bool focus_due;
};

static void *count_histogram(void *user)
{
	struct histogram_job *count = user;
	count->result = gz_histogram_count(count->volume, BINS, 0, &count->cancelled, count->log,
					   &count->histogram);
	atomic_store(&count->done, true);
	glfwPostEmptyEvent();
	return NULL;
}

static void start_counting(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	struct histogram_job *count = &transfer->count;
	transfer->counted = true;
	count->volume = &gz_frame_maker_scene(window->maker)->volume;
	count->time_point = count->volume->time_point;
	count->log = window->log;
	atomic_store(&count->cancelled, false);
	atomic_store(&count->done, false);
	count->running = pthread_create(&count->thread, NULL, count_histogram, count) == 0;
	if (!count->running)
		gz_err(window->log, "no thread for the histogram; the editor has none");
}

static void stop_histogram(struct gz_window_transfer *transfer)
{
	struct histogram_job *count = &transfer->count;
	transfer->panel.histogram = NULL;
	transfer->counted = false;
	if (!count->running)
		return;
	atomic_store(&count->cancelled, true);
	pthread_join(count->thread, NULL);
	count->running = false;
}

static void take_histogram(struct gz_window *window)
{
	struct histogram_job *count = &window->transfer->count;
	if (!count->running || !atomic_load(&count->done))
		return;
	pthread_join(count->thread, NULL);
	count->running = false;
	if (count->result == GZ_OK) {
		window->transfer->panel.histogram = &count->histogram;
		window->transfer->panel.histogram_point = count->time_point;
	}
	gz_window_wake_panels(window);
}

static void toggle_transfer_panel(struct gz_window *window, int number)
{
	(void)number;
	struct gz_window_transfer *transfer = window->transfer;
	transfer->panel.open = !transfer->panel.open;
	transfer->focus_due = transfer->panel.open;
	gz_window_wake_panels(window);
}

static bool is_transfer_panel_open(const struct gz_window *window)
{
	return window->transfer->panel.open;
}

static bool is_transfer_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->transfer->panel.open;
}

static const struct gz_window_action transfer_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_transfer_panel_open, .run = toggle_transfer_panel },
	{ .letter = 'e',
	  .keys = "E",
	  .help = "edit the transfer function",
	  .name = "Transfer function",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .on_picture = true,
	  .words = "colour color opacity histogram preset shading tf curve",
	  .is_on = is_transfer_on,
	  .run = toggle_transfer_panel },
};

/* Look up the file that the settings name. */
static void name_transfer_file(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	const char *name = window->settings.transfer_file;
	char path[GZ_PATH_SIZE] = "";
	if (name[0] && gz_scene_find_file(gz_window_scene_path(window), name, path) != GZ_OK)
		path[0] = '\0';
	memcpy(transfer->file, path, sizeof path);
	memcpy(transfer->panel.file, path, sizeof path);
}

/* Name a file in the settings, by a path that is valid from anywhere. */
static void use_transfer_file(struct gz_window *window, const char *file)
{
	char *real = realpath(file, NULL);
	if (real && strlen(real) < GZ_PATH_SIZE) {
		memcpy(window->settings.transfer_file, real, strlen(real) + 1);
	}
	free(real);
	gz_window_transfer_saved(window);
}

static void edit_scene_transfer(struct gz_window *window)
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
	name_transfer_file(window);
}

static void leave_counted_scene(struct gz_window *window)
{
	stop_histogram(window->transfer);
}

/* All time points have one range of values, so a histogram that is counted stays useful. The panel
 * says which of them it counts. */
static bool leave_counted_data(struct gz_window *window)
{
	if (window->transfer->count.running)
		stop_histogram(window->transfer);
	return true;
}

/* Edit a transfer function that another part has set, such as a replay. */
static void follow_other_parts(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	const struct gz_transfer *shown = &gz_frame_maker_scene(window->maker)->transfer;
	if (gz_transfer_edit_is(transfer->edit, shown))
		return;
	gz_transfer_edit_restart(transfer->edit, shown);
	transfer->shown = gz_transfer_edit_changes(transfer->edit);
	gz_window_wake_panels(window);
}

/* The renderer gets changes before the next frame. */
static void turn_transfer(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	take_histogram(window);
	if (!window->maker || !transfer->edit)
		return;
	const uint64_t changes = gz_transfer_edit_changes(transfer->edit);
	if (changes == transfer->shown) {
		follow_other_parts(window);
		return;
	}
	transfer->shown = changes;
	gz_frame_set_transfer(window->maker, gz_transfer_edit_now(transfer->edit));
	window->cast_needed = true;
}

static void save_transfer(struct gz_window *window)
{
	struct gz_window_transfer *transfer = window->transfer;
	if (gz_transfer_write(gz_transfer_edit_now(transfer->edit), transfer->panel.file,
			      window->log) != GZ_OK)
		return;
	gz_info(window->log, "%s: transfer function written", transfer->panel.file);
	use_transfer_file(window, transfer->panel.file);
}

static void light_surfaces(struct gz_window *window, bool light)
{
	const struct gz_scene_settings before = window->settings;
	window->settings.rays.shading = light ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
	gz_window_take_changes(window, &before);
}

static void draw_transfer_editor(struct gz_window *window, const struct gz_window_gaze *gaze)
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
		save_transfer(window);
	else if (wish == GZ_TRANSFER_WISH_LIGHT || wish == GZ_TRANSFER_WISH_NO_LIGHT)
		light_surfaces(window, wish == GZ_TRANSFER_WISH_LIGHT);
	/* turn_transfer() shows changes in the next turn. */
	if (gz_transfer_edit_changes(transfer->edit) != transfer->shown)
		gz_window_wake_panels(window);
}

static double transfer_patience_s(const struct gz_window *window)
{
	const struct gz_window_transfer *transfer = window->transfer;
	const bool due = transfer->edit && window->maker &&
			 gz_transfer_edit_changes(transfer->edit) != transfer->shown;
	return due ? 0 : INFINITY;
}

static void close_transfer(struct gz_window *window)
{
	stop_histogram(window->transfer);
	gz_transfer_edit_destroy(&window->transfer->edit);
}

int gz_window_transfer_steps(const struct gz_window *window)
{
	return window->transfer->edit ? gz_transfer_edit_steps(window->transfer->edit) : 0;
}

const char *gz_window_transfer_step(struct gz_window *window, bool again)
{
	struct gz_transfer_edit *edit = window->transfer->edit;
	const char *name = edit ? gz_transfer_edit_step_name(edit, again) : NULL;
	if (name)
		(void)(again ? gz_transfer_edit_redo(edit) : gz_transfer_edit_undo(edit));
	return name;
}

bool gz_window_transfer_changed(const struct gz_window *window)
{
	return window->transfer->edit && gz_transfer_edit_differs(window->transfer->edit);
}

void gz_window_transfer_saved(struct gz_window *window)
{
	if (!window->transfer->edit)
		return;
	gz_transfer_edit_saved(window->transfer->edit);
	name_transfer_file(window);
	gz_window_wake_panels(window);
}

enum gz_result gz_window_transfer_load(struct gz_window *window, const char *file)
{
	struct gz_transfer_edit *edit = window->transfer->edit;
	struct gz_transfer loaded;
	if (!window->maker || !edit) {
		gz_err(window->log,
		       "%s: a transfer function needs a volume; open a scene or a volume first",
		       file);
		return GZ_ERR_INVAL;
	}
	const enum gz_result r = gz_transfer_load(file, window->log, &loaded);
	if (r != GZ_OK)
		return r;
	gz_transfer_edit_end(edit);
	gz_transfer_edit_replace(edit, &loaded);
	use_transfer_file(window, file);
	return GZ_OK;
}

const struct gz_window_part gz_window_transfer_part = {
	.name = "transfer",
	.title = "transfer function",
	GZ_PART_ACTIONS(transfer_actions),
	GZ_PART_STATE(transfer),
	.scene_shown = edit_scene_transfer,
	.scene_leaving = leave_counted_scene,
	.data_leaving = leave_counted_data,
	.turn = turn_transfer,
	.panels = draw_transfer_editor,
	.patience_s = transfer_patience_s,
	.close = close_transfer,
};
