/**
 * @file
 * A fixed set of threads that share out the parts of one job at a time.
 */
#ifndef GZ_RENDER_WORKERS_H
#define GZ_RENDER_WORKERS_H

#include <stddef.h>

#include "base/result.h"

#define GZ_WORKERS_MAX 256

struct gz_workers;

/**
 * One part of a job.
 *
 * @param user    as given to gz_workers_run()
 * @param part    which, 0 to parts - 1; each is done once, by any thread, in any order
 * @param worker  which thread does it, 0 to threads - 1: for sums of its own
 */
typedef void gz_workers_part(void *user, size_t part, int worker);

/**
 * Start the threads.
 *
 * @param threads  1 to GZ_WORKERS_MAX, the caller's counted in; 0 = one per processor this process
 * may use
 * @param[out] out_workers  owned by the caller: gz_workers_destroy()
 * @retval GZ_ERR_INVAL   @p threads out of range
 * @retval GZ_ERR_NO_MEM  no room, or no thread to be had
 */
enum gz_result gz_workers_create(int threads, struct gz_workers **out_workers);

/** How many threads work, the caller's counted in. */
int gz_workers_count(const struct gz_workers *workers);

/** Do all parts and return when the last is done. The calling thread works too. One caller at a
 * time. */
void gz_workers_run(struct gz_workers *workers, gz_workers_part *part, void *user, size_t parts);

/** End the threads, free, set to NULL. Accepts a pointer to NULL. */
void gz_workers_destroy(struct gz_workers **workers);

#endif
