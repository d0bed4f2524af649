/**
 * @file
 * One scene in loading, on a thread of its own. The part of loading.h has them. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_LOAD_JOB_H
#define GZ_VIEW_WINDOW_LOAD_JOB_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "view/frame/frame.h"
#include "view/options/options.h"
#include "view/window/loading.h"

enum { GZ_LOAD_WHAT_SIZE = 256 };

/** How far a job is. */
struct gz_load_progress {
	double share;                 /**< 0 to 1 */
	char what[GZ_LOAD_WHAT_SIZE]; /**< a path or the name of a formula */
};

/** See above. What is not marked otherwise stays as it is while the thread runs. */
struct gz_load_job {
	struct gz_load_job *next; /**< for its owner's list */
	const struct gz_view_options *options;
	const struct gz_log *log;
	struct gz_window_load_request request;
	bool keep;
	struct gz_scene_settings kept; /**< only with keep */
	bool cpu;                      /**< the cpu backend will cast, and is made ready too */
	int64_t begin_ns;
	pthread_t thread;
	pthread_mutex_t lock;
	struct gz_load_progress progress; /**< under the lock */
	atomic_bool cancelled;            /**< somebody wants it to stop */
	atomic_bool finished;             /**< the thread has nothing more to do */
	/* Once it has finished: */
	enum gz_result result;        /**< of the loading; logged but for GZ_ERR_CANCELLED */
	struct gz_frame_maker *maker; /**< only with GZ_OK; the owner of the job may take it */
};

/**
 * Begin to load. Wakes the window's loop when it has finished.
 *
 * @param kept  settings that stay; NULL: none
 * @param cpu   gz_window_takes_cpu()
 * @retval GZ_ERR_NO_MEM  neither memory nor a thread; logged
 */
enum gz_result gz_load_job_begin(const struct gz_window_load_request *request,
				 const struct gz_scene_settings *kept, bool cpu,
				 const struct gz_view_options *options, const struct gz_log *log,
				 struct gz_load_job **out_job);

/** Ask it to stop. Waits for nothing. */
void gz_load_job_cancel(struct gz_load_job *job);

/** Whether it is over, one way or the other. */
bool gz_load_job_finished(const struct gz_load_job *job);

/** How far it is. */
struct gz_load_progress gz_load_job_progress(struct gz_load_job *job);

/** Wait for its end, free it with the maker that it still has, and set to NULL. Accepts a pointer
 *  to NULL. */
void gz_load_job_destroy(struct gz_load_job **job);

#endif
