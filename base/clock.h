/**
 * @file
 * Host time: CLOCK_MONOTONIC in int64_t nanoseconds, the unit of all times in the project.
 */
#ifndef GZ_BASE_CLOCK_H
#define GZ_BASE_CLOCK_H

#include <stdint.h>

#define GZ_NS_PER_S  INT64_C(1000000000)
#define GZ_NS_PER_MS INT64_C(1000000)
#define GZ_NS_PER_US INT64_C(1000)

/** The present time on CLOCK_MONOTONIC, ns. Threads: any. */
int64_t gz_clock_now_ns(void);

/**
 * Sleep until CLOCK_MONOTONIC reads at least @p deadline_ns; return at once if it already does. A
 * signal does not shorten the sleep. Threads: any.
 */
void gz_clock_sleep_until_ns(int64_t deadline_ns);

/** Nanoseconds as seconds. Exact to 0.1 µs for host times up to 25 years of uptime. */
static inline double gz_ns_to_s(int64_t ns)
{
	return (double)ns * 1e-9;
}

/** Nanoseconds as milliseconds. */
static inline double gz_ns_to_ms(int64_t ns)
{
	return (double)ns * 1e-6;
}

#endif
