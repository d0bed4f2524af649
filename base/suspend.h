/**
 * @file
 * Whether the machine slept.
 */
#ifndef GZ_BASE_SUSPEND_H
#define GZ_BASE_SUSPEND_H

#include <stdint.h>

/** How long the machine has slept since it started, ns: CLOCK_MONOTONIC stands still then. Threads:
 *  any. */
int64_t gz_suspended_ns(void);

#endif
