/**
 * @file
 * A queue of log records between one thread that pushes and one that pops; neither ever waits,
 * locks or allocates.
 */
#ifndef GZ_DAEMON_RING_H
#define GZ_DAEMON_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze_log.h"

/** What lies in the ring: a record and the recording that it belongs to. */
struct gz_ring_slot {
	uint32_t session;
	struct gz_gaze_log_record record;
};

/** The queue. */
struct gz_ring;

/** @param capacity  slots; a power of two, at least 2 */
enum gz_result gz_ring_create(size_t capacity, struct gz_ring **out_ring);

/** Free slots, as the pushing thread sees it; there may be more. */
size_t gz_ring_room(const struct gz_ring *ring);

/** Append a copy; false if the ring is full. Only from the pushing thread. */
bool gz_ring_push(struct gz_ring *ring, uint32_t session, const struct gz_gaze_log_record *record);

/** The oldest slot, or NULL if the ring is empty; valid until gz_ring_pop(). Only from the popping
 *  thread. */
const struct gz_ring_slot *gz_ring_front(struct gz_ring *ring);

/** Drop the oldest slot; the ring must not be empty. Only from the popping thread. */
void gz_ring_pop(struct gz_ring *ring);

/** Free and set to NULL, once neither thread uses it. Accepts a pointer to NULL. */
void gz_ring_destroy(struct gz_ring **ring);

#endif
