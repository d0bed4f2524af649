/**
 * @file
 * Gaze data from the SDK's thread to the one that reads. Neither locks nor allocates; the reader
 * can wait.
 */
#ifndef GZ_DRIVERS_TOBII_RING_H
#define GZ_DRIVERS_TOBII_RING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/tobii/tobii_abi.h"

/** Gaze data that wait to be read, a power of two. Chosen: 0.85 s at 1200 Hz. */
#define GZ_TOBII_RING_SIZE 1024

/** One delivery. */
struct gz_tobii_delivery {
	struct gz_tobii_gaze gaze;
	int64_t arrival_ns;   /**< host time of the callback */
	uint32_t lost_before; /**< deliveries that found no room just before this one */
};

/** The ring. */
struct gz_tobii_ring;

/** Make an empty ring. @retval GZ_ERR_NO_MEM  no room or no event */
enum gz_result gz_tobii_ring_create(struct gz_tobii_ring **out_ring);

/** Put a delivery in and wake the reader; where there is no room it is counted. Only from the SDK's
 * thread. */
void gz_tobii_ring_put(struct gz_tobii_ring *ring, const struct gz_tobii_gaze *gaze,
		       int64_t arrival_ns);

/** Wake the reader though there is nothing new. Threads: any. */
void gz_tobii_ring_wake(struct gz_tobii_ring *ring);

/** Take the oldest delivery; false if there is none. Only from the reading thread. */
bool gz_tobii_ring_take(struct gz_tobii_ring *ring, struct gz_tobii_delivery *out_delivery);

/** Wait until there is one, somebody wakes, or host time is @p deadline_ns. Only from the reading
 * thread. */
void gz_tobii_ring_wait(struct gz_tobii_ring *ring, int64_t deadline_ns);

/** Free and set to NULL, once neither thread uses it. Accepts a pointer to NULL. */
void gz_tobii_ring_destroy(struct gz_tobii_ring **ring);

#endif
