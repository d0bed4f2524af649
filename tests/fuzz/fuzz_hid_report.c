/* Reports: a descriptor, then reports one behind the other. Two bytes hold the length of the
 * descriptor, one the length of each report; a feature report begins with 0xf0 to 0xf3. If the
 * first byte of all is not 0, it chooses one of the first four layouts of hid_made.h instead of a
 * descriptor. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/device/clock_ticks.h"
#include "drivers/hid/hid_device.h"
#include "drivers/hid/hid_tracker.h"
#include "tests/drivers/hid_made.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

struct stream {
	struct gz_hid_tracker tracker;
	struct gz_clock_ticks clock;
	struct gz_hid_silence silence;
	int64_t now_ns;
	int64_t host_ns;
	bool started;
};

static void check_tracking(struct stream *stream, const struct gz_hid_input_report *report)
{
	if (report->has_gaze)
		require(isfinite(report->gaze_mm[0]) && isfinite(report->gaze_mm[1]));
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		for (int axis = 0; report->has_eye[eye] && axis < 3; axis++)
			require(fabs(report->eye_mm[eye][axis]) <= 5000);
	}
	if (!report->has_ticks)
		return;
	struct gz_clock_stamp stamp =
		gz_clock_ticks_step(&stream->clock, report->ticks, stream->now_ns);
	require(!stream->started || stamp.host_ns > stream->host_ns);
	stream->host_ns = stamp.host_ns;
	stream->started = true;
	gz_hid_silence_sample(&stream->silence, stamp.host_ns, stream->now_ns);
	double period_ns = gz_hid_silence_period_ns(&stream->silence);
	require(period_ns > 0 && isfinite(period_ns));
	gz_clock_ticks_status(&stream->clock);
}

static void check_feature(const struct gz_hid_tracker *tracker, const uint8_t *bytes, size_t size)
{
	unsigned char copy[256];
	struct gz_hid_screen screen = gz_hid_tracker_screen(tracker, bytes, size);
	require(!screen.believed || (screen.mm[0] >= 50 && screen.mm[1] <= 5000));
	struct gz_hid_distances distances = gz_hid_tracker_distances(tracker, bytes, size);
	require(!distances.believed ||
		(distances.nearest_mm >= 100 && distances.farthest_mm <= 5000));
	memcpy(copy, bytes, size);
	gz_hid_tracker_set_mode(tracker, copy, size, 3);
}

/* @return the bytes used, 0 if there is no tracker */
static size_t choose_layout(const uint8_t *data, size_t size, struct gz_hid_tracker *out_tracker)
{
	static struct gz_hid_descriptor descriptor;
	struct hid_made made = { 0 };
	if (size < 3)
		return 0;
	size_t length = data[1] | (size_t)data[2] << 8;
	if (data[0] > 0) {
		hid_made_tracker(&made, data[0] % HID_LAYOUT_WIDE);
		require(gz_hid_descriptor_parse(made.bytes, made.size, &descriptor, NULL) == GZ_OK);
		length = 0;
	} else if (length > size - 3 ||
		   gz_hid_descriptor_parse(data + 3, length, &descriptor, NULL) != GZ_OK) {
		return 0;
	}
	return gz_hid_tracker_find(&descriptor, 0, out_tracker, NULL) == GZ_OK ? 3 + length : 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct stream stream;
	memset(&stream, 0, sizeof stream);
	size_t at = choose_layout(data, size, &stream.tracker);
	const struct gz_hid_value *ticks = &stream.tracker.values[GZ_HID_TICKS];
	if (at == 0)
		return 0;
	if (ticks->present)
		gz_clock_ticks_init(&stream.clock, ticks->bits, ticks->scale);
	while (at < size) {
		struct gz_hid_input_report report;
		size_t length = data[at++];
		if (length > size - at)
			length = size - at;
		/* An exact allocation, so that a byte read past its end is seen. */
		uint8_t *bytes = malloc(length + !length);
		require(bytes != NULL);
		memcpy(bytes, data + at, length);
		stream.now_ns += 4000000 + (length > 0 ? bytes[length - 1] * 1000 : 0);
		gz_hid_tracker_read(&stream.tracker, bytes, length, &report);
		if (report.kind == GZ_HID_INPUT_TRACKING)
			check_tracking(&stream, &report);
		else if (report.kind == GZ_HID_INPUT_MALFORMED)
			require(report.malformed < GZ_MALFORMED_COUNT);
		check_feature(&stream.tracker, bytes, length);
		free(bytes);
		at += length;
	}
	return 0;
}
