/**
 * @file
 * Gaze data of the SDK: the ring in which they wait for the reading thread, their times on the host
 * clock, and samples made from them.
 */
#ifndef GZ_DRIVERS_TOBII_GAZE_H
#define GZ_DRIVERS_TOBII_GAZE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/tobii/tobii_library.h"
#include "protocol/gaze.h"

/** Deliveries that the ring holds, a power of two. Chosen: 0.85 s at 1200 Hz. */
#define GZ_TOBII_RING_SIZE 1024

/** Gaze data as they were delivered. */
struct gz_tobii_delivery {
	struct gz_tobii_gaze gaze;
	int64_t arrival_ns;   /**< host time of the callback */
	uint32_t lost_before; /**< deliveries just before this one for which there was no room */
};

/** A ring from the thread of the SDK to the reading thread. Neither thread locks or allocates; the
 * reading one can wait. */
struct gz_tobii_ring;

/** Make an empty ring. @retval GZ_ERR_NO_MEM  no memory or no eventfd */
enum gz_result gz_tobii_ring_create(struct gz_tobii_ring **out_ring);

/** Write a delivery and wake the reader. If there is no room, it is counted as lost. Threads: that
 * of the SDK. */
void gz_tobii_ring_put(struct gz_tobii_ring *ring, const struct gz_tobii_gaze *gaze,
		       int64_t arrival_ns);

/** Wake the reader without a delivery. Threads: any. */
void gz_tobii_ring_wake(struct gz_tobii_ring *ring);

/** Read the oldest delivery. @return false if there is none. Threads: the reading one. */
bool gz_tobii_ring_take(struct gz_tobii_ring *ring, struct gz_tobii_delivery *out_delivery);

/** Wait until there is a delivery, gz_tobii_ring_wake() is called, or host time is
 * @p deadline_ns. Threads: the reading one. */
void gz_tobii_ring_wait(struct gz_tobii_ring *ring, int64_t deadline_ns);

/** Free and set to NULL, when neither thread uses it any more. Accepts a pointer to NULL. */
void gz_tobii_ring_destroy(struct gz_tobii_ring **ring);

/** Oldest age at arrival of a sample whose stamp is believed, ns; an older one means that the clock
 * of the library has changed. Chosen: longer than any tracker takes to compute and send. */
#define GZ_TOBII_AGE_MAX_NS INT64_C(1000000000)

/** Longest time between arrival and a later stamp that is believed, ns. Chosen: larger than the
 * error of two clock readings. */
#define GZ_TOBII_EARLY_MAX_NS INT64_C(1000000)

/** The clock of the library relative to the host clock. Zero-initialised knows nothing. */
struct gz_tobii_time {
	bool known;
	int64_t offset_ns; /**< host - library */
	int64_t error_ns;  /**< largest error of the offset */
};

/**
 * Note one reading of the library's clock. Pure.
 *
 * @param before_ns, after_ns  host time just before and after the reading
 * @param system_us            the reading
 * @return whether the reading is usable: no overflow
 */
bool gz_tobii_time_read(struct gz_tobii_time *time, int64_t before_ns, int64_t system_us,
			int64_t after_ns);

/**
 * Host time at which a sample was taken, from its system time stamp; not after its arrival. The
 * time of arrival if the stamp is not believable. Pure.
 */
int64_t gz_tobii_time_of(const struct gz_tobii_time *time, int64_t system_us, int64_t arrival_ns);

/** The tracker's clock as ns; GZ_NO_DEVICE_TIME if that overflows. Pure. */
int64_t gz_tobii_device_ns(int64_t device_us);

/** A sample without number, times and losses. Pure. */
struct gz_sample gz_tobii_sample(const struct gz_tobii_gaze *gaze);

#endif
