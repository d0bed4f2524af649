/* What another program sends to the driver pupil: messages one behind the other, each two bytes of
 * length, of which the highest bit says surface, and that many bytes; a length of 0 is an answer to
 * "t" of the eight bytes that follow. Whatever the bytes, samples keep the promises of gaze.h. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/pupil/pupil_clock.h"
#include "drivers/pupil/pupil_message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Large: one for all runs, begun anew each time. */
static struct {
	struct gz_pupil_memory memory;
	struct gz_pupil_entries entries;
	struct gz_pupil_order order;
	struct gz_pupil_clock clock;
	int64_t now_ns;
	int64_t host_ns;
	int64_t pupil_ns;
	bool begun;
} link;

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_eye(const struct gz_eye_sample *eye)
{
	require(isnan(eye->pupil_mm) || (eye->pupil_mm > 0 && isfinite(eye->pupil_mm)));
	require(isnan(eye->confidence) || (eye->confidence >= 0 && eye->confidence <= 1));
	require(!eye->valid || (isfinite(eye->point.x) && isfinite(eye->point.y)));
	if (!isnan(eye->direction[0])) {
		double length = sqrt((double)eye->direction[0] * eye->direction[0] +
				     (double)eye->direction[1] * eye->direction[1] +
				     (double)eye->direction[2] * eye->direction[2]);
		require(fabs(length - 1) < 1e-5);
	}
}

/* As the driver finishes a sample. */
static void take_sample(const struct gz_pupil_gaze *gaze)
{
	uint32_t missing = 77;
	bool believed;
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		check_eye(&gaze->sample.eye[i]);
	require(!isinf(gaze->sample.point.x) && !isinf(gaze->sample.point.y));
	if (gz_pupil_order_step(&link.order, gaze, &missing) != GZ_OK)
		return;
	require(!link.begun || gaze->sample.device_ns > link.pupil_ns);
	require(missing <= 1000000);
	link.now_ns += 1000; /* time goes on while a message is read */
	int64_t host_ns =
		gz_pupil_clock_map(&link.clock, gaze->sample.device_ns, link.now_ns, &believed);
	require(!link.begun || host_ns > link.host_ns);
	require(host_ns <= link.now_ns);
	link.begun = true;
	link.pupil_ns = gaze->sample.device_ns;
	link.host_ns = host_ns;
}

static void take_gaze(const uint8_t *bytes, size_t size)
{
	struct gz_pupil_gaze gaze;
	enum gz_malformed reason = GZ_MALFORMED_COUNT;
	if (gz_pupil_read_gaze(bytes, size, 0.6, &gaze, &reason) != GZ_OK) {
		require(reason < GZ_MALFORMED_COUNT);
		return;
	}
	gz_pupil_remember(&link.memory, &gaze);
	take_sample(&gaze);
}

static void take_surface(const uint8_t *bytes, size_t size)
{
	struct gz_pupil_gaze gaze;
	enum gz_malformed reason = GZ_MALFORMED_COUNT;
	if (gz_pupil_read_surface(bytes, size, &link.entries, &reason) != GZ_OK) {
		require(reason < GZ_MALFORMED_COUNT);
		require(link.entries.count == 0);
	}
	while (gz_pupil_next_entry(&link.entries, &link.memory, 0.6, &gaze) == GZ_OK)
		take_sample(&gaze);
}

static void take_time(const uint8_t *bytes)
{
	int64_t pupil_ns;
	memcpy(&pupil_ns, bytes, sizeof pupil_ns);
	if (gz_pupil_clock_exchange(&link.clock, link.now_ns, pupil_ns, link.now_ns + 1000) ==
	    GZ_PUPIL_SYNC_JUMPED) {
		gz_pupil_order_restart(&link.order);
		link.pupil_ns = INT64_MIN;
	}
	struct gz_clock_status status = gz_pupil_clock_status(&link.clock);
	require(isfinite(status.skew_ppm) && fabs(status.skew_ppm) < 1100);
	require(isfinite(status.sigma_ns) && status.sigma_ns >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	memset(&link, 0, sizeof link);
	link.now_ns = INT64_C(1000000000000);
	while (size >= 2) {
		size_t length = (size_t)(data[0] & 0x7f) << 8 | data[1];
		bool surface = data[0] & 0x80;
		data += 2;
		size -= 2;
		link.now_ns += 2000000;
		if (length == 0) {
			if (size < 8)
				return 0;
			take_time(data);
			length = 8;
		} else {
			length = length < size ? length : size;
			if (surface)
				take_surface(data, length);
			else
				take_gaze(data, length);
		}
		data += length;
		size -= length;
	}
	return 0;
}
