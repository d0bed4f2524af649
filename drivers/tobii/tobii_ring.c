#include "drivers/tobii/tobii_ring.h"

#include <poll.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

/* Bytes that two threads must not share, lest they slow each other down. */
enum { CACHE_LINE = 64 };

struct gz_tobii_ring {
	alignas(CACHE_LINE) atomic_size_t put;   /* so many were put in, */
	uint32_t lost;                           /* the SDK's thread's: since the last one put in */
	alignas(CACHE_LINE) atomic_size_t taken; /* and so many taken out */
	int event_fd;
	struct gz_tobii_delivery deliveries[GZ_TOBII_RING_SIZE];
};

enum gz_result gz_tobii_ring_create(struct gz_tobii_ring **out_ring)
{
	struct gz_tobii_ring *ring = aligned_alloc(CACHE_LINE, sizeof *ring);
	if (!ring)
		return GZ_ERR_NO_MEM;
	atomic_init(&ring->put, 0);
	atomic_init(&ring->taken, 0);
	ring->lost = 0;
	ring->event_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (ring->event_fd < 0) {
		free(ring);
		return GZ_ERR_NO_MEM;
	}
	*out_ring = ring;
	return GZ_OK;
}

void gz_tobii_ring_wake(struct gz_tobii_ring *ring)
{
	const uint64_t one = 1;
	ssize_t n = write(ring->event_fd, &one, sizeof one);
	(void)n; /* full is awake */
}

void gz_tobii_ring_put(struct gz_tobii_ring *ring, const struct gz_tobii_gaze *gaze,
		       int64_t arrival_ns)
{
	size_t put = atomic_load_explicit(&ring->put, memory_order_relaxed);
	size_t taken = atomic_load_explicit(&ring->taken, memory_order_acquire);
	if (put - taken == GZ_TOBII_RING_SIZE) {
		if (ring->lost < UINT32_MAX)
			ring->lost++;
		return;
	}
	ring->deliveries[put % GZ_TOBII_RING_SIZE] = (struct gz_tobii_delivery) {
		.gaze = *gaze, .arrival_ns = arrival_ns, .lost_before = ring->lost
	};
	ring->lost = 0;
	atomic_store_explicit(&ring->put, put + 1, memory_order_release);
	gz_tobii_ring_wake(ring);
}

bool gz_tobii_ring_take(struct gz_tobii_ring *ring, struct gz_tobii_delivery *out_delivery)
{
	size_t taken = atomic_load_explicit(&ring->taken, memory_order_relaxed);
	if (atomic_load_explicit(&ring->put, memory_order_acquire) == taken)
		return false;
	*out_delivery = ring->deliveries[taken % GZ_TOBII_RING_SIZE];
	atomic_store_explicit(&ring->taken, taken + 1, memory_order_release);
	return true;
}

void gz_tobii_ring_wait(struct gz_tobii_ring *ring, int64_t deadline_ns)
{
	uint64_t count;
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns < 0)
		left_ns = 0;
	struct pollfd poll_fd = { .fd = ring->event_fd, .events = POLLIN };
	struct timespec timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				    .tv_nsec = (long)(left_ns % GZ_NS_PER_S) };
	if (ppoll(&poll_fd, 1, &timeout, NULL) > 0) {
		ssize_t n = read(ring->event_fd, &count, sizeof count);
		(void)n;
	}
}

void gz_tobii_ring_destroy(struct gz_tobii_ring **ring)
{
	if (!ring || !*ring)
		return;
	close((*ring)->event_fd);
	free(*ring);
	*ring = NULL;
}
