#include "view/window/loading.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/file_dialogs.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Progress is shown over a picture after this time, and drawn this often (chosen: a short loading
 * needs no panel, which would flicker). */
#define PANEL_AFTER_NS (200 * GZ_NS_PER_MS)
#define PANEL_EVERY_S  0.1

enum { LOAD_WHAT_SIZE = 256 };

/* Progress of a job. */
struct load_progress {
	double share;              /* 0 to 1 */
	char what[LOAD_WHAT_SIZE]; /* a path or the name of a formula */
};

/* A scene that is loaded on a thread of its own. Fields without a note do not change meanwhile. */
struct load_job {
	struct load_job *next; /* in the list of its owner */
	const struct gz_view_options *options;
	const struct gz_log *log;
	struct gz_window_load_request request;
	bool keep;
	struct gz_scene_settings kept; /* only with keep */
	bool cpu;                      /* the cpu backend will cast rays, and is prepared too */
	int64_t begin_ns;
	pthread_t thread;
	pthread_mutex_t lock;
	struct load_progress progress; /* under the lock */
	atomic_bool cancelled;         /* it is to stop */
	atomic_bool finished;          /* the thread has ended its work */
	struct gz_series_list *series; /* to choose from; NULL: several are an error */
	/* Once it has finished: */
	enum gz_result result;        /* logged, except GZ_ERR_CANCELLED and GZ_ERR_CHOICE */
	struct gz_frame_maker *maker; /* only with GZ_OK; the owner may take it */
};

struct gz_window_held {
	struct gz_window_held *next;
	struct load_job *job;         /* until it has finished */
	struct gz_frame_maker *maker; /* afterwards; NULL: loading failed */
	char path[GZ_PATH_SIZE];
};

struct gz_window_loading {
	struct load_job *job;   /* its scene will be shown; NULL: none */
	bool again;             /* it was begun again after the scene shown was closed */
	struct load_job *ended; /* cancelled jobs that have not finished yet */
	int64_t asked_ns;       /* when the scene shown was asked for; 0: logged already */
	struct gz_window_held *held;
	/* Holds window->maker; NULL: the window owns the maker. */
	const struct gz_window_held *shown;
	char path[GZ_PATH_SIZE];             /* of the scene shown */
	struct gz_window_load_request asked; /* the latest; without a path: none */
	bool any_shown;
	enum gz_result outcome;
};

/* ---- jobs ---- */

static bool report_progress(void *user, double share, const char *what)
{
	struct load_job *job = user;
	pthread_mutex_lock(&job->lock);
	job->progress.share = share;
	snprintf(job->progress.what, sizeof job->progress.what, "%s", what);
	pthread_mutex_unlock(&job->lock);
	return !atomic_load(&job->cancelled);
}

static enum gz_result load_job_scene(struct load_job *job)
{
	const struct gz_window_load_request *request = &job->request;
	const struct gz_frame_scene scene = {
		.path = request->path,
		.raw = request->has_raw ? &request->raw : NULL,
		.series_uid = request->series_uid[0] ? request->series_uid : NULL,
		.resample = request->resample,
		.by_options = request->by_options,
		.kept = job->keep ? &job->kept : NULL,
	};
	const struct gz_loading loading = { .report = report_progress,
					    .user = job,
					    .series_list = job->series };
	enum gz_result r =
		gz_frame_maker_create(job->options, &scene, &loading, job->log, &job->maker);
	if (r == GZ_OK && job->cpu && gz_frame_cpu_suffices(job->maker))
		r = gz_frame_maker_start_cpu(job->maker, job->options);
	if (r == GZ_OK && atomic_load(&job->cancelled))
		r = GZ_ERR_CANCELLED;
	if (r != GZ_OK)
		gz_frame_maker_destroy(&job->maker);
	return r;
}

static void *run_load_job(void *user)
{
	struct load_job *job = user;
	job->result = load_job_scene(job);
	atomic_store(&job->finished, true);
	glfwPostEmptyEvent();
	return NULL;
}

/* How a job is begun. */
struct load_plan {
	const struct gz_scene_settings *kept; /* settings that stay; NULL: none */
	bool cpu;                             /* takes_cpu() */
	bool offers;                          /* series to choose from */
};

/* Begin to load; wakes the window's loop when it has finished. GZ_ERR_NO_MEM: no memory, or no
 * thread; logged. */
static enum gz_result load_job_begin(const struct gz_window_load_request *request,
				     const struct load_plan *plan,
				     const struct gz_view_options *options,
				     const struct gz_log *log, struct load_job **out_job)
{
	struct load_job *job = calloc(1, sizeof *job);
	if (!job ||
	    (plan->offers && gz_series_list_create(glfwPostEmptyEvent, &job->series) != GZ_OK)) {
		gz_err(log, "no memory to load %s", request->path);
		free(job);
		return GZ_ERR_NO_MEM;
	}
	job->options = options;
	job->log = log;
	job->request = *request;
	job->keep = plan->kept != NULL;
	if (plan->kept)
		job->kept = *plan->kept;
	job->cpu = plan->cpu;
	job->begin_ns = gz_clock_now_ns();
	snprintf(job->progress.what, sizeof job->progress.what, "%.*s", LOAD_WHAT_SIZE - 1,
		 request->path);
	pthread_mutex_init(&job->lock, NULL);
	if (pthread_create(&job->thread, NULL, run_load_job, job) != 0) {
		gz_err(log, "no thread to load %s; end other programs", request->path);
		pthread_mutex_destroy(&job->lock);
		gz_series_list_free(&job->series);
		free(job);
		return GZ_ERR_NO_MEM;
	}
	*out_job = job;
	return GZ_OK;
}

static void load_job_cancel(struct load_job *job)
{
	atomic_store(&job->cancelled, true);
}

static bool load_job_finished(const struct load_job *job)
{
	return atomic_load(&job->finished);
}

static struct load_progress load_job_progress(struct load_job *job)
{
	pthread_mutex_lock(&job->lock);
	const struct load_progress progress = job->progress;
	pthread_mutex_unlock(&job->lock);
	return progress;
}

/* Wait for the end of a job and free it, with its maker if it was not taken. Accepts a pointer to
 * NULL.
 */
static void load_job_destroy(struct load_job **job)
{
	if (!*job)
		return;
	load_job_cancel(*job);
	pthread_join((*job)->thread, NULL);
	gz_frame_maker_destroy(&(*job)->maker);
	gz_series_list_free(&(*job)->series);
	pthread_mutex_destroy(&(*job)->lock);
	free(*job);
	*job = NULL;
}

/* ---- the scene shown ---- */

/* Tell parts of the scene that is shown, or about to leave. */
static void tell_parts(struct gz_window *window, bool shown)
{
	GZ_FOR_EACH_PART (part) {
		void (*told)(struct gz_window *) =
			shown ? (*part)->scene_shown : (*part)->scene_leaving;
		if (told)
			told(window);
	}
}

/* Show the scene of a maker that has a renderer, with other settings than its own unless NULL.
 * There is no scene at present. */
static void take_maker(struct gz_window *window, struct gz_frame_maker *maker, const char *path,
		       const struct gz_scene_settings *settings)
{
	struct gz_window_loading *state = window->loading;
	if (window->losses < GZ_WINDOW_LOSSES_TO_CPU)
		gz_frame_maker_let_choose(maker, window->options, &window->context.base);
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

/* Stop showing the scene; nothing is freed. @return its maker; NULL: there was none */
static struct gz_frame_maker *leave_maker(struct gz_window *window)
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

/* Whether cpu casts the rays of the next scene. */
static bool takes_cpu(struct gz_window *window)
{
	return window->losses >= GZ_WINDOW_LOSSES_TO_CPU ||
	       gz_frame_takes_cpu(window->options, &window->context.base, window->log);
}

/* Give a maker its renderer. @return what gz_frame_maker_start() does; logged */
static enum gz_result start_maker(struct gz_window *window, struct gz_frame_maker *maker)
{
	return window->losses < GZ_WINDOW_LOSSES_TO_CPU
		       ? gz_frame_maker_start(maker, window->options, &window->context.base)
		       : gz_frame_maker_start_cpu(maker, window->options);
}

/* Free a maker, unless a held scene has it. */
static void free_unless_held(struct gz_frame_maker *maker, bool held)
{
	if (!held)
		gz_frame_maker_destroy(&maker);
}

/* Show the previous scene again. */
static void bring_scene_back(struct gz_window *window, struct gz_frame_maker *old, const char *path,
			     const struct gz_scene_settings *settings,
			     const struct gz_window_held *held)
{
	if (start_maker(window, old) != GZ_OK) {
		free_unless_held(old, held != NULL);
		return;
	}
	take_maker(window, old, path, settings);
	window->loading->shown = held;
}

/* Show the scene of a finished job. If that fails, the previous scene stays. @return what
 * gz_frame_maker_start() does; logged */
static enum gz_result swap_to_job(struct gz_window *window, struct load_job *job)
{
	const struct gz_window_held *held = window->loading->shown;
	const struct gz_scene_settings settings = window->settings;
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s", window->loading->path);
	struct gz_frame_maker *old = leave_maker(window);
	enum gz_result r = GZ_OK;
	if (!gz_frame_maker_started(job->maker)) {
		/* The graphics device may have no room for both. */
		if (old)
			gz_frame_maker_stop(old);
		r = start_maker(window, job->maker);
	}
	if (r != GZ_OK) {
		gz_frame_maker_destroy(&job->maker);
		if (old)
			bring_scene_back(window, old, path, &settings, held);
		return r;
	}
	take_maker(window, job->maker, job->request.path, NULL);
	job->maker = NULL;
	free_unless_held(old, held != NULL);
	return GZ_OK;
}

const char *gz_window_scene_path(const struct gz_window *window)
{
	return window->loading->path;
}

void gz_window_close_scene(struct gz_window *window)
{
	if (!window->loading)
		return;
	const bool held = window->loading->shown != NULL;
	free_unless_held(leave_maker(window), held);
}

enum gz_result gz_window_show(struct gz_window *window, struct gz_window_held *held)
{
	if (!held->maker)
		return GZ_ERR_INVAL;
	gz_window_cancel_loading(window);
	gz_window_close_scene(window);
	enum gz_result r = GZ_OK;
	if (!gz_frame_maker_started(held->maker))
		r = start_maker(window, held->maker);
	if (r != GZ_OK)
		return r;
	take_maker(window, held->maker, held->path, NULL);
	window->loading->shown = held;
	return GZ_OK;
}

void gz_window_rename_scene(struct gz_window *window, const char *path)
{
	/* path may be the scene's path itself. */
	memmove(window->loading->path, path, strlen(path) + 1);
}

/* ---- held scenes ---- */

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
	const struct load_plan plan = { .cpu = takes_cpu(window) };
	const enum gz_result r =
		load_job_begin(request, &plan, window->options, window->log, &held->job);
	if (r != GZ_OK) {
		free(held);
		return r;
	}
	held->next = window->loading->held;
	window->loading->held = held;
	*out_held = held;
	return GZ_OK;
}

/* With gl the volume goes to the device now, rather than when it is shown. */
static void finish_held(struct gz_window *window, struct gz_window_held *held)
{
	held->maker = held->job->maker;
	held->job->maker = NULL;
	load_job_destroy(&held->job);
	if (held->maker && !gz_frame_maker_started(held->maker) &&
	    start_maker(window, held->maker) != GZ_OK)
		gz_frame_maker_destroy(&held->maker);
}

static void look_after_held(struct gz_window *window)
{
	for (struct gz_window_held *held = window->loading->held; held; held = held->next)
		if (held->job && load_job_finished(held->job))
			finish_held(window, held);
}

/* Renderers of held scenes go with the context; they are made again when a scene is shown. */
static void stop_held(struct gz_window *window)
{
	for (struct gz_window_held *held = window->loading->held; held; held = held->next)
		if (held->maker && held != window->loading->shown)
			gz_frame_maker_stop(held->maker);
}

enum gz_window_held_state gz_window_held_state(const struct gz_window_held *held, double *out_share)
{
	const double share = held->job ? load_job_progress(held->job).share : 1;
	if (out_share)
		*out_share = share;
	return held->job ? GZ_HELD_COMING : held->maker ? GZ_HELD_READY : GZ_HELD_FAILED;
}

void gz_window_release(struct gz_window *window, struct gz_window_held **held)
{
	struct gz_window_loading *state = window->loading;
	if (!*held)
		return;
	if (state && state->shown == *held)
		leave_maker(window);
	for (struct gz_window_held **at = state ? &state->held : NULL; at && *at; at = &(*at)->next)
		if (*at == *held) {
			*at = (*held)->next;
			break;
		}
	load_job_destroy(&(*held)->job);
	gz_frame_maker_destroy(&(*held)->maker);
	free(*held);
	*held = NULL;
}

/* ---- loading ---- */

bool gz_window_is_loading(const struct gz_window *window)
{
	return window->loading->job != NULL;
}

/* The job's thread stops when it next reports progress; nobody waits for it. */
static void end_loading_job(struct gz_window *window)
{
	struct gz_window_loading *state = window->loading;
	if (!state->job)
		return;
	load_job_cancel(state->job);
	state->job->next = state->ended;
	state->ended = state->job;
	state->job = NULL;
	window->present_needed = true;
}

void gz_window_cancel_loading(struct gz_window *window)
{
	if (!gz_window_is_loading(window))
		return;
	if (!gz_window_offered_series(window))
		gz_info(window->log, "%s: loading was cancelled",
			window->loading->job->request.path);
	end_loading_job(window);
}

struct gz_series_list *gz_window_offered_series(const struct gz_window *window)
{
	const struct load_job *job = window->loading->job;
	return job && job->series && gz_series_list_count(job->series) > 0 ? job->series : NULL;
}

const char *gz_window_offering_path(const struct gz_window *window)
{
	return window->loading->job->request.path;
}

enum gz_result gz_window_choose_series(struct gz_window *window, const char *uid)
{
	struct gz_window_load_request *request = malloc(sizeof *request);
	if (!request) {
		gz_err(window->log, "no memory to load series %s", uid);
		return GZ_ERR_NO_MEM;
	}
	*request = window->loading->job->request;
	snprintf(request->series_uid, sizeof request->series_uid, "%s", uid);
	const enum gz_result r = gz_window_load(window, request);
	free(request);
	return r;
}

/* A measurement has nobody who could choose. */
static bool offers_series(const struct gz_window *window)
{
	return window->options->measure_window == 0 && !window->alone;
}

enum gz_result gz_window_load(struct gz_window *window,
			      const struct gz_window_load_request *request)
{
	struct load_job *job;
	const struct load_plan plan = {
		/* Without a scene there is nothing to keep. */
		.kept = request->keep && window->maker ? &window->settings : NULL,
		.cpu = takes_cpu(window),
		.offers = offers_series(window),
	};
	const enum gz_result r = load_job_begin(request, &plan, window->options, window->log, &job);
	if (r != GZ_OK)
		return r;
	end_loading_job(window);
	window->loading->job = job;
	window->loading->asked = job->request;
	window->loading->again = false;
	gz_window_wake_panels(window);
	return GZ_OK;
}

/* Close the scene shown to make room, and begin again. @return whether that was done */
static bool try_again(struct gz_window *window, struct load_job *job)
{
	struct gz_window_loading *state = window->loading;
	if (job->result != GZ_ERR_NO_MEM || !window->maker || state->again)
		return false;
	gz_warn(window->log,
		"%s: no memory for it beside the scene shown, which is closed; loading it again",
		job->request.path);
	gz_window_close_scene(window);
	const struct load_plan plan = { .kept = job->keep ? &job->kept : NULL,
					.cpu = job->cpu,
					.offers = job->series != NULL };
	if (load_job_begin(&job->request, &plan, window->options, window->log, &state->job) !=
	    GZ_OK)
		return false;
	state->again = true;
	return true;
}

static void finish_loading(struct gz_window *window, struct load_job *job)
{
	struct gz_window_loading *state = window->loading;
	enum gz_result r = job->result;
	gz_debug(window->log, "%s: loaded in %.0f ms", job->request.path,
		 gz_ns_to_ms(gz_clock_now_ns() - job->begin_ns));
	state->asked_ns = job->begin_ns;
	if (r == GZ_OK)
		r = swap_to_job(window, job);
	else if (try_again(window, job))
		return;
	if (r != GZ_OK && !state->any_shown)
		state->outcome = r;
	window->present_needed = true;
	gz_window_wake_panels(window);
}

static void free_ended(struct gz_window_loading *state, bool wait)
{
	for (struct load_job **at = &state->ended; *at;) {
		struct load_job *job = *at;
		if (!wait && !load_job_finished(job)) {
			at = &job->next;
			continue;
		}
		*at = job->next;
		load_job_destroy(&job);
	}
}

static bool progress_due(const struct load_job *job, bool over_picture)
{
	return !over_picture || gz_clock_now_ns() - job->begin_ns > PANEL_AFTER_NS;
}

static void turn_loading(struct gz_window *window)
{
	struct gz_window_loading *state = window->loading;
	struct load_job *job = state->job;
	if (job && load_job_finished(job) && job->result != GZ_ERR_CHOICE) {
		state->job = NULL;
		finish_loading(window, job);
		load_job_destroy(&job);
	}
	if (state->job && !load_job_finished(state->job) &&
	    progress_due(state->job, window->maker != NULL))
		window->present_needed = true;
	look_after_held(window);
	free_ended(state, false);
}

static void draw_loading_panels(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct load_job *job = window->loading->job;
	(void)gaze;
	if (!job || gz_window_offered_series(window) || !progress_due(job, window->maker != NULL))
		return;
	const struct load_progress progress = load_job_progress(job);
	const double spent_s = gz_ns_to_s(gz_clock_now_ns() - job->begin_ns);
	if (gz_progress_panel_draw("Loading", progress.what, progress.share, spent_s))
		gz_window_cancel_loading(window);
}

static void log_first_picture(struct gz_window *window)
{
	struct gz_window_loading *state = window->loading;
	if (state->asked_ns)
		gz_debug(window->log,
			 "%s: first picture %.0f ms after it was asked for, %.0f ms of it the "
			 "frame's",
			 state->path, gz_ns_to_ms(gz_clock_now_ns() - state->asked_ns),
			 window->record.total_ms);
	state->asked_ns = 0;
}

static double loading_patience_s(const struct gz_window *window)
{
	const struct load_job *job = window->loading->job;
	return job && !load_job_finished(job) ? PANEL_EVERY_S : INFINITY;
}

static void cancel_by_key(struct gz_window *window, int number)
{
	(void)number;
	gz_window_cancel_loading(window);
}

void gz_window_load_resampled(struct gz_window *window)
{
	struct gz_window_load_request *request = &window->loading->asked;
	if (!request->path[0]) {
		gz_warn(window->log, "nothing to resample: no file was opened");
		return;
	}
	request->resample = true;
	gz_window_load(window, request);
}

enum gz_result gz_window_loading_outcome(const struct gz_window *window)
{
	return window->loading->outcome;
}

static void close_loading(struct gz_window *window)
{
	end_loading_job(window);
	free_ended(window->loading, true);
}

static const struct gz_window_action loading_actions[] = {
	{ .key = GLFW_KEY_ESCAPE,
	  .keys = "Esc",
	  .help = "cancel loading",
	  .applies = gz_window_is_loading,
	  .run = cancel_by_key },
};

const struct gz_window_part gz_window_loading_part = {
	.name = "loading",
	.title = "window",
	GZ_PART_ACTIONS(loading_actions),
	GZ_PART_STATE(loading),
	.turn = turn_loading,
	.frame_made = log_first_picture,
	.panels = draw_loading_panels,
	.patience_s = loading_patience_s,
	.gl_close = stop_held,
	.close = close_loading,
};
