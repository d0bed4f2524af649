#include "base/workers.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

struct gz_workers {
	pthread_mutex_t mutex;
	pthread_cond_t job_ready, job_done;
	int threads;  /* including the caller's */
	int busy;     /* started threads that still work on the job */
	unsigned job; /* its number, from 1 */
	bool ending;
	/* The present job. */
	gz_workers_part *part;
	void *user;
	size_t parts;
	atomic_size_t next;
	struct worker_thread {
		struct gz_workers *workers;
		int index;
		pthread_t thread;
	} started[GZ_WORKERS_MAX];
};

static void do_parts(struct gz_workers *workers, int worker)
{
	for (;;) {
		const size_t part =
			atomic_fetch_add_explicit(&workers->next, 1, memory_order_relaxed);
		if (part >= workers->parts)
			return;
		workers->part(workers->user, part, worker);
	}
}

static void *worker_main(void *argument)
{
	const struct worker_thread *self = argument;
	struct gz_workers *workers = self->workers;
	unsigned done = 0;
	pthread_mutex_lock(&workers->mutex);
	for (;;) {
		while (workers->job == done && !workers->ending)
			pthread_cond_wait(&workers->job_ready, &workers->mutex);
		if (workers->ending)
			break;
		done = workers->job;
		pthread_mutex_unlock(&workers->mutex);
		do_parts(workers, self->index);
		pthread_mutex_lock(&workers->mutex);
		if (--workers->busy == 0)
			pthread_cond_signal(&workers->job_done);
	}
	pthread_mutex_unlock(&workers->mutex);
	return NULL;
}

static int count_processors(void)
{
	cpu_set_t set;
	if (sched_getaffinity(0, sizeof set, &set) != 0)
		return 1;
	const int count = CPU_COUNT(&set);
	return count > GZ_WORKERS_MAX ? GZ_WORKERS_MAX : count;
}

enum gz_result gz_workers_create(int threads, struct gz_workers **out_workers)
{
	if (threads < 0 || threads > GZ_WORKERS_MAX)
		return GZ_ERR_INVAL;
	struct gz_workers *workers = calloc(1, sizeof *workers);
	if (!workers)
		return GZ_ERR_NO_MEM;
	pthread_mutex_init(&workers->mutex, NULL);
	pthread_cond_init(&workers->job_ready, NULL);
	pthread_cond_init(&workers->job_done, NULL);
	const int wanted = threads > 0 ? threads : count_processors();
	workers->threads = 1;
	for (int i = 1; i < wanted; i++) {
		struct worker_thread *worker = &workers->started[i];
		*worker = (struct worker_thread) { .workers = workers, .index = i };
		if (pthread_create(&worker->thread, NULL, worker_main, worker) != 0) {
			gz_workers_destroy(&workers);
			return GZ_ERR_NO_MEM;
		}
		workers->threads++;
	}
	*out_workers = workers;
	return GZ_OK;
}

int gz_workers_count(const struct gz_workers *workers)
{
	return workers->threads;
}

void gz_workers_run(struct gz_workers *workers, gz_workers_part *part, void *user, size_t parts)
{
	pthread_mutex_lock(&workers->mutex);
	workers->part = part;
	workers->user = user;
	workers->parts = parts;
	atomic_store_explicit(&workers->next, 0, memory_order_relaxed);
	workers->busy = workers->threads - 1;
	workers->job++;
	pthread_cond_broadcast(&workers->job_ready);
	pthread_mutex_unlock(&workers->mutex);

	do_parts(workers, 0);

	pthread_mutex_lock(&workers->mutex);
	while (workers->busy > 0)
		pthread_cond_wait(&workers->job_done, &workers->mutex);
	pthread_mutex_unlock(&workers->mutex);
}

void gz_workers_destroy(struct gz_workers **workers_pointer)
{
	struct gz_workers *workers = *workers_pointer;
	if (!workers)
		return;
	pthread_mutex_lock(&workers->mutex);
	workers->ending = true;
	pthread_cond_broadcast(&workers->job_ready);
	pthread_mutex_unlock(&workers->mutex);
	for (int i = 1; i < workers->threads; i++)
		pthread_join(workers->started[i].thread, NULL);
	pthread_cond_destroy(&workers->job_done);
	pthread_cond_destroy(&workers->job_ready);
	pthread_mutex_destroy(&workers->mutex);
	free(workers);
	*workers_pointer = NULL;
}
