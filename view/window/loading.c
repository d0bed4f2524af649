#include "view/window/loading.h"

#include <math.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/file_dialogs.h"
#include "view/panels/marks.h"
#include "view/window/loading_state.h"

#define GZ_LOG_MODULE "window"

/* Chosen: what is over within a moment needs no panel, which would only flicker over a picture; ten
 * times a second is enough. */
#define PANEL_AFTER_NS (200 * GZ_NS_PER_MS)
#define PANEL_EVERY_S  0.1

static enum gz_result open_state(struct gz_window *window)
{
	window->loading = calloc(1, sizeof *window->loading);
	return window->loading ? GZ_OK : GZ_ERR_NO_MEM;
}

bool gz_window_is_loading(const struct gz_window *window)
{
	return window->loading && window->loading->job;
}

/* It stops when it next looks, and is waited for by nobody. */
static void end_job(struct gz_window *window)
{
	struct gz_window_loading_state *state = window->loading;
	if (!state->job)
		return;
	gz_load_job_cancel(state->job);
	state->job->next = state->ended;
	state->ended = state->job;
	state->job = NULL;
	window->present_needed = true;
}

void gz_window_cancel_loading(struct gz_window *window)
{
	if (!gz_window_is_loading(window))
		return;
	gz_info(window->log, "%s: the loading was cancelled", window->loading->job->request.path);
	end_job(window);
}

enum gz_result gz_window_load(struct gz_window *window,
			      const struct gz_window_load_request *request)
{
	struct gz_load_job *job;
	const bool cpu = gz_window_takes_cpu(window);
	/* Without a scene there is nothing to be kept. */
	const struct gz_scene_settings *kept =
		request->keep && window->maker ? &window->settings : NULL;
	const enum gz_result r =
		gz_load_job_begin(request, kept, cpu, window->options, window->log, &job);
	if (r != GZ_OK)
		return r;
	end_job(window);
	window->loading->job = job;
	window->loading->again = false;
	gz_window_wake_panels(window);
	return GZ_OK;
}

/* The scene shown makes room, and the loading begins again. */
static bool try_again(struct gz_window *window, struct gz_load_job *job)
{
	struct gz_window_loading_state *state = window->loading;
	if (job->result != GZ_ERR_NO_MEM || !window->maker || state->again)
		return false;
	gz_warn(window->log,
		"%s: no memory for it beside the scene shown, which is closed; loading it again",
		job->request.path);
	gz_window_close_scene(window);
	if (gz_load_job_begin(&job->request, job->keep ? &job->kept : NULL, job->cpu,
			      window->options, window->log, &state->job) != GZ_OK)
		return false;
	state->again = true;
	return true;
}

static void finish(struct gz_window *window, struct gz_load_job *job)
{
	struct gz_window_loading_state *state = window->loading;
	enum gz_result r = job->result;
	gz_debug(window->log, "%s: loaded in %.0f ms", job->request.path,
		 gz_ns_to_ms(gz_clock_now_ns() - job->begin_ns));
	state->asked_ns = job->begin_ns;
	if (r == GZ_OK)
		r = gz_window_swap_to_job(window, job);
	else if (try_again(window, job))
		return;
	if (r != GZ_OK && !state->any_shown)
		state->outcome = r;
	window->present_needed = true;
	gz_window_wake_panels(window);
}

static void free_ended(struct gz_window_loading_state *state, bool wait)
{
	for (struct gz_load_job **at = &state->ended; *at;) {
		struct gz_load_job *job = *at;
		if (!wait && !gz_load_job_finished(job)) {
			at = &job->next;
			continue;
		}
		*at = job->next;
		gz_load_job_destroy(&job);
	}
}

static bool panel_due(const struct gz_load_job *job, bool over_picture)
{
	return !over_picture || gz_clock_now_ns() - job->begin_ns > PANEL_AFTER_NS;
}

static void turn(struct gz_window *window)
{
	struct gz_window_loading_state *state = window->loading;
	struct gz_load_job *job = state->job;
	if (job && gz_load_job_finished(job)) {
		state->job = NULL;
		finish(window, job);
		gz_load_job_destroy(&job);
	}
	if (state->job && panel_due(state->job, window->maker != NULL))
		window->present_needed = true;
	gz_window_turn_held(window);
	free_ended(state, false);
}

static void draw_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_load_job *job = window->loading->job;
	(void)gaze;
	if (!window->maker && !job)
		gz_marks_draw_welcome();
	if (!job || !panel_due(job, window->maker != NULL))
		return;
	const struct gz_load_progress progress = gz_load_job_progress(job);
	const double spent_s = gz_ns_to_s(gz_clock_now_ns() - job->begin_ns);
	if (gz_progress_panel_draw("Loading", progress.what, progress.share, spent_s))
		gz_window_cancel_loading(window);
}

static void tell_first(struct gz_window *window)
{
	struct gz_window_loading_state *state = window->loading;
	if (state->asked_ns)
		gz_debug(window->log,
			 "%s: first picture %.0f ms after it was asked for, %.0f ms of it the "
			 "frame's",
			 state->path, gz_ns_to_ms(gz_clock_now_ns() - state->asked_ns),
			 window->record.total_ms);
	state->asked_ns = 0;
}

static double patience_s(const struct gz_window *window)
{
	return window->loading->job ? PANEL_EVERY_S : INFINITY;
}

static void cancel_by_key(struct gz_window *window, int number)
{
	(void)number;
	gz_window_cancel_loading(window);
}

enum gz_result gz_window_loading_outcome(const struct gz_window *window)
{
	return window->loading ? window->loading->outcome : GZ_OK;
}

static void close_state(struct gz_window *window)
{
	if (!window->loading)
		return;
	end_job(window);
	free_ended(window->loading, true);
	free(window->loading);
	window->loading = NULL;
}

static const struct gz_window_action actions[] = {
	{ .key = GLFW_KEY_ESCAPE,
	  .keys = "Esc",
	  .help = "cancel the loading, while there is one",
	  .applies = gz_window_is_loading,
	  .run = cancel_by_key },
};

const struct gz_window_part gz_window_loading = {
	.name = "loading",
	.title = "window",
	.actions = actions,
	.action_count = sizeof actions / sizeof actions[0],
	.open = open_state,
	.turn = turn,
	.frame_made = tell_first,
	.panels = draw_panels,
	.patience_s = patience_s,
	.gl_close = gz_window_stop_held,
	.close = close_state,
};
