/* Scenes that are kept ready. */
#include <stdio.h>
#include <stdlib.h>

#include "view/window/loading_state.h"

#define GZ_LOG_MODULE "window"

enum gz_result gz_window_preload(struct gz_window *window,
				 const struct gz_window_load_request *request,
				 struct gz_window_held **out_held)
{
	struct gz_window_held *held = calloc(1, sizeof *held);
	if (!held) {
		gz_err(window->log, "no memory to load %s", request->path);
		return GZ_ERR_NO_MEM;
	}
	snprintf(held->path, sizeof held->path, "%s", request->path);
	const bool cpu = gz_window_takes_cpu(window);
	const enum gz_result r =
		gz_load_job_begin(request, NULL, cpu, window->options, window->log, &held->job);
	if (r != GZ_OK) {
		free(held);
		return r;
	}
	held->next = window->loading->held;
	window->loading->held = held;
	*out_held = held;
	return GZ_OK;
}

/* With gl the volume goes to the device now, not when it is to be shown. */
static void finish(struct gz_window *window, struct gz_window_held *held)
{
	held->maker = held->job->maker;
	held->job->maker = NULL;
	gz_load_job_destroy(&held->job);
	if (held->maker && !gz_frame_maker_started(held->maker) &&
	    gz_window_start_maker(window, held->maker) != GZ_OK)
		gz_frame_maker_destroy(&held->maker);
}

void gz_window_turn_held(struct gz_window *window)
{
	for (struct gz_window_held *held = window->loading->held; held; held = held->next)
		if (held->job && gz_load_job_finished(held->job))
			finish(window, held);
}

void gz_window_stop_held(struct gz_window *window)
{
	for (struct gz_window_held *held = window->loading->held; held; held = held->next)
		if (held->maker && held != window->loading->shown)
			gz_frame_maker_stop(held->maker);
}

enum gz_window_held_state gz_window_held_state(const struct gz_window_held *held, double *out_share)
{
	const double share = held->job ? gz_load_job_progress(held->job).share : 1;
	if (out_share)
		*out_share = share;
	return held->job ? GZ_HELD_COMING : held->maker ? GZ_HELD_READY : GZ_HELD_FAILED;
}

void gz_window_release(struct gz_window *window, struct gz_window_held **held)
{
	struct gz_window_loading_state *state = window->loading;
	if (!*held)
		return;
	if (state && state->shown == *held)
		gz_window_leave_maker(window);
	for (struct gz_window_held **at = state ? &state->held : NULL; at && *at; at = &(*at)->next)
		if (*at == *held) {
			*at = (*held)->next;
			break;
		}
	gz_load_job_destroy(&(*held)->job);
	gz_frame_maker_destroy(&(*held)->maker);
	free(*held);
	*held = NULL;
}
