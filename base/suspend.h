/**
 * @file
 * How long the machine has been suspended.
 */
#ifndef GZ_BASE_SUSPEND_H
#define GZ_BASE_SUSPEND_H

#include <stdint.h>
#include <time.h>

#include "base/clock.h"

/**
 * How long the machine has been suspended since it started, ns: CLOCK_BOOTTIME goes on during a
 * suspend and CLOCK_MONOTONIC does not. Threads: any.
 */
static inline int64_t gz_suspended_ns(void)
{
	struct timespec boot;
	int64_t monotonic_ns = gz_clock_now_ns();
	clock_gettime(CLOCK_BOOTTIME, &boot);
	return (int64_t)boot.tv_sec * GZ_NS_PER_S + boot.tv_nsec - monotonic_ns;
}

#endif
