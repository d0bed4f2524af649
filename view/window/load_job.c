#include "view/window/load_job.h"

#include <stdio.h>
#include <stdlib.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "window"

static bool report(void *user, double share, const char *what)
{
	struct gz_load_job *job = user;
	pthread_mutex_lock(&job->lock);
	job->progress.share = share;
	snprintf(job->progress.what, sizeof job->progress.what, "%s", what);
	pthread_mutex_unlock(&job->lock);
	return !atomic_load(&job->cancelled);
}

static enum gz_result load(struct gz_load_job *job)
{
	const struct gz_window_load_request *request = &job->request;
	const struct gz_frame_scene scene = {
		.path = request->path,
		.raw = request->has_raw ? &request->raw : NULL,
		.by_options = request->by_options,
		.kept = job->keep ? &job->kept : NULL,
	};
	const struct gz_loading loading = { .report = report, .user = job };
	enum gz_result r =
		gz_frame_maker_create(job->options, &scene, &loading, job->log, &job->maker);
	if (r == GZ_OK && job->cpu)
		r = gz_frame_maker_start_cpu(job->maker, job->options);
	if (r == GZ_OK && atomic_load(&job->cancelled))
		r = GZ_ERR_CANCELLED;
	if (r != GZ_OK)
		gz_frame_maker_destroy(&job->maker);
	return r;
}

static void *run(void *user)
{
	struct gz_load_job *job = user;
	job->result = load(job);
	atomic_store(&job->finished, true);
	glfwPostEmptyEvent();
	return NULL;
}

enum gz_result gz_load_job_begin(const struct gz_window_load_request *request,
				 const struct gz_scene_settings *kept, bool cpu,
				 const struct gz_view_options *options, const struct gz_log *log,
				 struct gz_load_job **out_job)
{
	struct gz_load_job *job = calloc(1, sizeof *job);
	if (!job) {
		gz_err(log, "no memory to load %s", request->path);
		return GZ_ERR_NO_MEM;
	}
	job->options = options;
	job->log = log;
	job->request = *request;
	job->keep = kept != NULL;
	if (kept)
		job->kept = *kept;
	job->cpu = cpu;
	job->begin_ns = gz_clock_now_ns();
	snprintf(job->progress.what, sizeof job->progress.what, "%.*s", GZ_LOAD_WHAT_SIZE - 1,
		 request->path);
	pthread_mutex_init(&job->lock, NULL);
	if (pthread_create(&job->thread, NULL, run, job) != 0) {
		gz_err(log, "no thread to load %s; end other programs", request->path);
		pthread_mutex_destroy(&job->lock);
		free(job);
		return GZ_ERR_NO_MEM;
	}
	*out_job = job;
	return GZ_OK;
}

void gz_load_job_cancel(struct gz_load_job *job)
{
	atomic_store(&job->cancelled, true);
}

bool gz_load_job_finished(const struct gz_load_job *job)
{
	return atomic_load(&job->finished);
}

struct gz_load_progress gz_load_job_progress(struct gz_load_job *job)
{
	pthread_mutex_lock(&job->lock);
	const struct gz_load_progress progress = job->progress;
	pthread_mutex_unlock(&job->lock);
	return progress;
}

void gz_load_job_destroy(struct gz_load_job **job)
{
	if (!*job)
		return;
	gz_load_job_cancel(*job);
	pthread_join((*job)->thread, NULL);
	gz_frame_maker_destroy(&(*job)->maker);
	pthread_mutex_destroy(&(*job)->lock);
	free(*job);
	*job = NULL;
}
