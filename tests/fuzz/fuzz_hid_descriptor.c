/* Report descriptors of any device that is plugged in. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/hid/hid_tracker.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_field(const struct gz_hid_descriptor *descriptor,
			const struct gz_hid_field *field)
{
	uint64_t end = field->bit_offset + (uint64_t)field->bit_size * field->count;
	bool found = false;
	require(field->bit_size > 0 && field->count > 0);
	require(field->logical_min <= field->logical_max);
	require(field->collection >= 0 && (size_t)field->collection < descriptor->collection_count);
	require((field->report_id != 0) == descriptor->numbered);
	for (size_t i = 0; i < descriptor->report_count; i++) {
		const struct gz_hid_report *report = &descriptor->reports[i];
		if (report->type == field->type && report->id == field->report_id) {
			require(end <= report->bits);
			found = true;
		}
	}
	require(found);
}

static void check_tracker(const struct gz_hid_tracker *tracker)
{
	for (int i = 0; i < GZ_HID_QUANTITIES; i++) {
		const struct gz_hid_value *value = &tracker->values[i];
		if (!value->present)
			continue;
		require(value->bits >= 1 && value->bits <= 64);
		require(isfinite(value->scale) && isfinite(value->offset));
		require(((size_t)value->at + value->bits + 7) / 8 + tracker->numbered <=
			gz_hid_tracker_bytes(tracker, i));
	}
	/* A report of zeros of the right length is never too short. */
	static unsigned char zeros[GZ_HID_REPORT_BITS_MAX / 8 + 1];
	struct gz_hid_input_report report;
	size_t bytes = gz_hid_tracker_bytes(tracker, GZ_HID_GAZE_X);
	zeros[0] = tracker->values[GZ_HID_GAZE_X].report_id;
	gz_hid_tracker_read(tracker, zeros, bytes, &report);
	require(report.kind == GZ_HID_INPUT_TRACKING || report.malformed == GZ_MALFORMED_VALUE);
	zeros[0] = 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct gz_hid_descriptor descriptor;
	struct gz_hid_fault fault = { 0, NULL };
	gz_hid_descriptor_mentions(data, size, GZ_HID_PAGE_TRACKERS);
	if (gz_hid_descriptor_parse(data, size, &descriptor, &fault) != GZ_OK) {
		require(fault.text && fault.at <= size);
		return 0;
	}
	require(descriptor.field_count <= GZ_HID_FIELDS_MAX);
	for (size_t i = 0; i < descriptor.field_count; i++)
		check_field(&descriptor, &descriptor.fields[i]);
	for (size_t i = 0; i < descriptor.collection_count; i++)
		require(descriptor.collections[i].parent < (int)i);
	size_t count = gz_hid_tracker_count(&descriptor);
	for (size_t i = 0; i < count; i++) {
		struct gz_hid_tracker tracker;
		const char *reason = NULL;
		if (gz_hid_tracker_find(&descriptor, i, &tracker, &reason) == GZ_OK)
			check_tracker(&tracker);
		else
			require(reason != NULL);
	}
	return 0;
}
