/**
 * @file
 * The SDK's gaze data as samples, and its clock on the host's. Pure: no clock, no I/O.
 */
#ifndef GZ_DRIVERS_TOBII_SAMPLE_H
#define GZ_DRIVERS_TOBII_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/tobii/tobii_abi.h"
#include "protocol/gaze.h"

/** A sample that is stamped this long before it arrives, ns, is believed no more: the library's
 * clock is not where it was. Chosen: above what any tracker takes to compute and send. */
#define GZ_TOBII_AGE_MAX_NS INT64_C(1000000000)

/** A sample that is stamped this long after its arrival, ns, likewise. Chosen: above what two
 * readings of clocks err by. */
#define GZ_TOBII_EARLY_MAX_NS INT64_C(1000000)

/** The library's clock on the host's. Zero-initialised knows nothing. */
struct gz_tobii_time {
	bool known;
	int64_t offset_ns; /**< host - library */
	int64_t error_ns;  /**< at most so much off */
};

/**
 * Take in one reading of the library's clock.
 *
 * @param before_ns, after_ns  host time just before and after the reading
 * @param system_us            the reading
 * @return whether the reading is one that can be used: no overflow
 */
bool gz_tobii_time_read(struct gz_tobii_time *time, int64_t before_ns, int64_t system_us,
			int64_t after_ns);

/**
 * When a sample was taken, host time, as its system time says: not after its arrival. Where that is
 * not believable, the arrival.
 */
int64_t gz_tobii_time_of(const struct gz_tobii_time *time, int64_t system_us, int64_t arrival_ns);

/** The tracker's clock, ns; GZ_NO_DEVICE_TIME where it overflows. */
int64_t gz_tobii_device_ns(int64_t device_us);

/** Everything of a sample but its number, times and losses. */
struct gz_sample gz_tobii_sample(const struct gz_tobii_gaze *gaze);

#endif
