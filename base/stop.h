/**
 * @file
 * Ending long work early, from another thread.
 */
#ifndef GZ_BASE_STOP_H
#define GZ_BASE_STOP_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/** Whether work is to end: then it fails with GZ_ERR_CANCELLED within a tenth of a second or so.
 *  @param stop  set by any thread; NULL: never */
static inline bool gz_stop_wanted(const atomic_bool *stop)
{
	return stop && atomic_load_explicit(stop, memory_order_relaxed);
}

#endif
