#include "daemon/ring.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

struct gz_ring {
	size_t mask;
	struct gz_ring_slot *slots;
	/* Counted up for ever; each written by one thread alone, on a cache line of its own. */
	_Alignas(64) atomic_size_t pushed;
	_Alignas(64) atomic_size_t popped;
};

enum gz_result gz_ring_create(size_t capacity, struct gz_ring **out_ring)
{
	if (capacity < 2 || (capacity & (capacity - 1)) != 0)
		return GZ_ERR_INVAL;
	struct gz_ring *ring = aligned_alloc(64, sizeof *ring);
	if (!ring)
		return GZ_ERR_NO_MEM;
	ring->mask = capacity - 1;
	ring->slots = calloc(capacity, sizeof *ring->slots);
	atomic_init(&ring->pushed, 0);
	atomic_init(&ring->popped, 0);
	if (!ring->slots) {
		free(ring);
		return GZ_ERR_NO_MEM;
	}
	*out_ring = ring;
	return GZ_OK;
}

size_t gz_ring_room(const struct gz_ring *ring)
{
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_relaxed);
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_acquire);
	return ring->mask + 1 - (pushed - popped);
}

/* Of a record only what its kind fills: most are samples, and the text is the larger part. */
static void copy_record(struct gz_gaze_log_record *to, const struct gz_gaze_log_record *from)
{
	if (from->kind != GZ_GAZE_LOG_SAMPLE) {
		*to = *from;
		return;
	}
	to->kind = from->kind;
	to->sample = from->sample;
}

bool gz_ring_push(struct gz_ring *ring, uint32_t session, const struct gz_gaze_log_record *record)
{
	if (gz_ring_room(ring) == 0)
		return false;
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_relaxed);
	struct gz_ring_slot *slot = &ring->slots[pushed & ring->mask];
	slot->session = session;
	copy_record(&slot->record, record);
	atomic_store_explicit(&ring->pushed, pushed + 1, memory_order_release);
	return true;
}

const struct gz_ring_slot *gz_ring_front(struct gz_ring *ring)
{
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_relaxed);
	size_t pushed = atomic_load_explicit(&ring->pushed, memory_order_acquire);
	return popped == pushed ? NULL : &ring->slots[popped & ring->mask];
}

void gz_ring_pop(struct gz_ring *ring)
{
	size_t popped = atomic_load_explicit(&ring->popped, memory_order_relaxed);
	atomic_store_explicit(&ring->popped, popped + 1, memory_order_release);
}

void gz_ring_destroy(struct gz_ring **ring)
{
	if (!ring || !*ring)
		return;
	free((*ring)->slots);
	free(*ring);
	*ring = NULL;
}
