#include "drivers/tobii/tobii_gaze.h"

#include <math.h>
#include <poll.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"

/* Distance that keeps the two counters in different cache lines, bytes; threads that share a line
 * slow each other down. */
enum { CACHE_LINE = 64 };

struct gz_tobii_ring {
	alignas(CACHE_LINE) atomic_size_t put; /* deliveries written */
	uint32_t lost; /* deliveries without room since the last one written; used by the thread of
			  the SDK */
	alignas(CACHE_LINE) atomic_size_t taken; /* deliveries read */
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
	(void)n; /* fails only if the counter is full; then the reader is awake already */
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
	if (gz_device_poll(ring->event_fd, POLLIN, deadline_ns) == GZ_OK) {
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

bool gz_tobii_time_read(struct gz_tobii_time *time, int64_t before_ns, int64_t system_us,
			int64_t after_ns)
{
	int64_t system_ns, offset_ns;
	int64_t middle_ns = before_ns + (after_ns - before_ns) / 2;
	if (__builtin_mul_overflow(system_us, GZ_NS_PER_US, &system_ns) ||
	    __builtin_sub_overflow(middle_ns, system_ns, &offset_ns))
		return false;
	*time = (struct gz_tobii_time) {
		.known = true,
		.offset_ns = offset_ns,
		.error_ns = (after_ns - before_ns) / 2 + GZ_NS_PER_US,
	};
	return true;
}

int64_t gz_tobii_time_of(const struct gz_tobii_time *time, int64_t system_us, int64_t arrival_ns)
{
	int64_t system_ns, taken_ns, age_ns;
	if (!time->known || __builtin_mul_overflow(system_us, GZ_NS_PER_US, &system_ns) ||
	    __builtin_add_overflow(system_ns, time->offset_ns, &taken_ns) ||
	    __builtin_sub_overflow(arrival_ns, taken_ns, &age_ns))
		return arrival_ns;
	if (age_ns > GZ_TOBII_AGE_MAX_NS || age_ns < -GZ_TOBII_EARLY_MAX_NS - time->error_ns)
		return arrival_ns;
	return age_ns < 0 ? arrival_ns : taken_ns;
}

int64_t gz_tobii_device_ns(int64_t device_us)
{
	int64_t ns;
	return __builtin_mul_overflow(device_us, GZ_NS_PER_US, &ns) ? GZ_NO_DEVICE_TIME : ns;
}

/* Unit vector from the eye to the gaze point; stays NaN if they coincide. */
static void set_gaze_direction(const float from_mm[3], const float to_mm[3], float out_direction[3])
{
	double step[3], length = 0;
	for (int i = 0; i < 3; i++) {
		step[i] = (double)to_mm[i] - (double)from_mm[i];
		length += step[i] * step[i];
	}
	length = sqrt(length);
	for (int i = 0; i < 3 && length > 0 && isfinite(length); i++)
		out_direction[i] = (float)(step[i] / length);
}

static void tobii_eye_to_sample(const struct gz_tobii_eye *eye, struct gz_eye_sample *out_eye)
{
	bool has_point = eye->point.validity == GZ_TOBII_VALID;
	bool has_origin = eye->origin.validity == GZ_TOBII_VALID;
	out_eye->point = (struct gz_point) { eye->point.on_display[0], eye->point.on_display[1] };
	out_eye->valid = has_point;
	if (eye->pupil.validity == GZ_TOBII_VALID)
		out_eye->pupil_mm = eye->pupil.diameter_mm;
	for (int i = 0; i < 3 && has_origin; i++)
		out_eye->origin_mm[i] = eye->origin.user_mm[i];
	if (has_point && has_origin)
		set_gaze_direction(eye->origin.user_mm, eye->point.user_mm, out_eye->direction);
}

struct gz_sample gz_tobii_sample(const struct gz_tobii_gaze *gaze)
{
	struct gz_sample sample = gz_sample_unmeasured();
	tobii_eye_to_sample(&gaze->right, &sample.eye[GZ_EYE_RIGHT]);
	tobii_eye_to_sample(&gaze->left, &sample.eye[GZ_EYE_LEFT]);
	return sample;
}
