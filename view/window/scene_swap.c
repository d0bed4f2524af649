/* One scene in place of another. */
#include <stdio.h>
#include <string.h>

#include "view/window/loading_state.h"
#include "view/window/part.h"

static void tell_parts(struct gz_window *window, bool shown)
{
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++) {
		void (*told)(struct gz_window *) =
			shown ? (*part)->scene_shown : (*part)->scene_leaving;
		if (told)
			told(window);
	}
}

void gz_window_take_maker(struct gz_window *window, struct gz_frame_maker *maker, const char *path,
			  const struct gz_scene_settings *settings)
{
	struct gz_window_loading_state *state = window->loading;
	window->maker = maker;
	window->settings = settings ? *settings : gz_frame_maker_scene(maker)->settings;
	snprintf(state->path, sizeof state->path, "%s", path);
	window->any_shown = false;
	window->taken_back = false;
	window->cast_needed = true;
	if (window->settings.view.letters)
		gz_frame_tell_unoriented(maker);
	state->any_shown = true;
	state->outcome = GZ_OK;
	tell_parts(window, true);
	gz_window_wake_panels(window);
}

struct gz_frame_maker *gz_window_leave_maker(struct gz_window *window)
{
	struct gz_frame_maker *maker = window->maker;
	if (!maker)
		return NULL;
	tell_parts(window, false);
	window->maker = NULL;
	window->loading->path[0] = '\0';
	window->loading->shown = NULL;
	window->record = (struct gz_frame_record) { 0 };
	window->present_needed = true;
	return maker;
}

bool gz_window_takes_cpu(struct gz_window *window)
{
	return window->losses >= GZ_WINDOW_LOSSES_TO_CPU ||
	       gz_frame_takes_cpu(window->options, &window->context.base, window->log);
}

enum gz_result gz_window_start_maker(struct gz_window *window, struct gz_frame_maker *maker)
{
	return window->losses < GZ_WINDOW_LOSSES_TO_CPU
		       ? gz_frame_maker_start(maker, window->options, &window->context.base)
		       : gz_frame_maker_start_cpu(maker, window->options);
}

/* Frees it unless it is held. */
static void drop(struct gz_frame_maker *maker, bool held)
{
	if (!held)
		gz_frame_maker_destroy(&maker);
}

/* What was shown before, once more. */
static void bring_back(struct gz_window *window, struct gz_frame_maker *old, const char *path,
		       const struct gz_scene_settings *settings, const struct gz_window_held *held)
{
	if (gz_window_start_maker(window, old) != GZ_OK) {
		drop(old, held != NULL);
		return;
	}
	gz_window_take_maker(window, old, path, settings);
	window->loading->shown = held;
}

enum gz_result gz_window_swap_to_job(struct gz_window *window, struct gz_load_job *job)
{
	const struct gz_window_held *held = window->loading->shown;
	const struct gz_scene_settings settings = window->settings;
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s", window->loading->path);
	struct gz_frame_maker *old = gz_window_leave_maker(window);
	enum gz_result r = GZ_OK;
	if (!gz_frame_maker_started(job->maker)) {
		/* The graphics device may have no room for both. */
		if (old)
			gz_frame_maker_stop(old);
		r = gz_window_start_maker(window, job->maker);
	}
	if (r != GZ_OK) {
		gz_frame_maker_destroy(&job->maker);
		if (old)
			bring_back(window, old, path, &settings, held);
		return r;
	}
	gz_window_take_maker(window, job->maker, job->request.path, NULL);
	job->maker = NULL;
	drop(old, held != NULL);
	return GZ_OK;
}

const char *gz_window_scene_path(const struct gz_window *window)
{
	return window->loading ? window->loading->path : "";
}

void gz_window_close_scene(struct gz_window *window)
{
	if (!window->loading)
		return;
	const bool held = window->loading->shown != NULL;
	drop(gz_window_leave_maker(window), held);
}

enum gz_result gz_window_show(struct gz_window *window, struct gz_window_held *held)
{
	if (!held->maker)
		return GZ_ERR_INVAL;
	gz_window_cancel_loading(window);
	gz_window_close_scene(window);
	enum gz_result r = GZ_OK;
	if (!gz_frame_maker_started(held->maker))
		r = gz_window_start_maker(window, held->maker);
	if (r != GZ_OK)
		return r;
	gz_window_take_maker(window, held->maker, held->path, NULL);
	window->loading->shown = held;
	return GZ_OK;
}

void gz_window_rename_scene(struct gz_window *window, const char *path)
{
	/* It may be what the scene is called already, in this very place. */
	memmove(window->loading->path, path, strlen(path) + 1);
}
