/**
 * @file
 * A fixed set of threads that divide the parts of a job among themselves, one job at a time.
 */
#ifndef GZ_BASE_WORKERS_H
#define GZ_BASE_WORKERS_H

#include <stddef.h>

#include "base/result.h"

/** Most threads of a set. */
#define GZ_WORKERS_MAX 256

/** A set of threads. */
struct gz_workers;

/**
 * Do one part of a job.
 *
 * @param user    as given to gz_workers_run()
 * @param part    0 to parts - 1; each part is done once, by any thread, in any order
 * @param worker  the thread that does it, 0 to threads - 1; for sums per thread
 */
typedef void gz_workers_part(void *user, size_t part, int worker);

/**
 * Start the threads.
 *
 * @param threads  1 to GZ_WORKERS_MAX, including the caller's; 0: one per processor that this
 *                 process may use
 * @param[out] out_workers  owned by the caller; gz_workers_destroy()
 * @retval GZ_ERR_INVAL   @p threads is out of range
 * @retval GZ_ERR_NO_MEM  out of memory, or a thread cannot be started
 */
enum gz_result gz_workers_create(int threads, struct gz_workers **out_workers);

/** How many threads work on a job, including the caller's. */
int gz_workers_count(const struct gz_workers *workers);

/** Do all parts and return when the last is done. The calling thread works too. One caller at a
 * time.
 */
void gz_workers_run(struct gz_workers *workers, gz_workers_part *part, void *user, size_t parts);

/** End the threads, free the set and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_workers_destroy(struct gz_workers **workers);

#endif
