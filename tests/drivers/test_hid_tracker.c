/* Numbers in a report, and the reports of an eye tracker. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "drivers/hid/hid_tracker.h"
#include "hid_made.h"

static struct gz_hid_descriptor descriptor;

static void expect_near(double value, double expected, double tolerance)
{
	if (!(fabs(value - expected) <= tolerance))
		fail_msg("%.9g, expected %.9g", value, expected);
}

static struct gz_hid_tracker find(const struct hid_made *made, size_t index)
{
	struct gz_hid_tracker tracker;
	const char *reason = "";
	assert_int_equal(gz_hid_descriptor_parse(made->bytes, made->size, &descriptor, NULL),
			 GZ_OK);
	if (gz_hid_tracker_find(&descriptor, index, &tracker, &reason) != GZ_OK)
		fail_msg("%s", reason);
	return tracker;
}

static struct gz_hid_tracker made_tracker(enum hid_layout layout)
{
	struct hid_made made = { 0 };
	hid_made_tracker(&made, layout);
	return find(&made, 0);
}

static void expect_refusal(const struct hid_made *made, enum gz_result expected)
{
	struct gz_hid_tracker tracker;
	const char *reason = NULL;
	assert_int_equal(gz_hid_descriptor_parse(made->bytes, made->size, &descriptor, NULL),
			 GZ_OK);
	assert_int_equal(gz_hid_tracker_find(&descriptor, 0, &tracker, &reason), expected);
	assert_non_null(reason);
	assert_int_equal(gz_hid_tracker_find(&descriptor, 0, &tracker, NULL), expected);
}

/* A tracker whose gaze point is described by these items. */
static struct hid_made gaze_of(const int64_t *items)
{
	struct hid_made made = { 0 };
	HID_ITEMS(&made, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 1, HID_USAGE, 0x10,
		  HID_COLLECTION, 2, HID_USAGE, 0x24, HID_COLLECTION, 0, HID_COUNT, 2, HID_SIZE, 16,
		  HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 1000, HID_USAGE, 0x21, HID_USAGE, 0x22);
	hid_made_items(&made, items);
	HID_ITEMS(&made, HID_END, 0, HID_END, 0, HID_END, 0);
	return made;
}

static void bits_are_read_at_any_place_and_of_any_number(void **state)
{
	(void)state;
	unsigned char bytes[12];
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (unsigned char)(0x9d * (i + 1) + 7);
	for (size_t at = 0; at <= 8 * sizeof bytes; at++) {
		for (unsigned count = 0; count <= 64; count++) {
			uint64_t expected = 0;
			bool inside = at + count <= 8 * sizeof bytes;
			for (unsigned i = 0; inside && i < count; i++)
				expected |= (uint64_t)(bytes[(at + i) / 8] >> (at + i) % 8 & 1)
					    << i;
			uint64_t got = gz_hid_bits(bytes, sizeof bytes, at, count);
			if (got != expected)
				fail_msg("%u bits at %zu: %llx, expected %llx", count, at,
					 (unsigned long long)got, (unsigned long long)expected);
		}
	}
	assert_int_equal(gz_hid_bits(bytes, sizeof bytes, 0, 65), 0);
	assert_int_equal(gz_hid_bits(bytes, sizeof bytes, SIZE_MAX, 8), 0);
}

static void units_of_each_system_are_converted_and_others_are_refused(void **state)
{
	(void)state;
	static const struct {
		uint32_t unit;
		int exponent;
		enum gz_hid_dimension dimension;
		enum gz_result result;
		double factor;
	} cases[] = {
		{ 0x11, -4, GZ_HID_LENGTH, GZ_OK, 1e-3 },
		{ 0x11, 0, GZ_HID_LENGTH, GZ_OK, 10 },
		{ 0x13, 0, GZ_HID_LENGTH, GZ_OK, 25.4 },
		{ 0x13, -3, GZ_HID_LENGTH, GZ_OK, 0.0254 },
		{ 0x12, 0, GZ_HID_LENGTH, GZ_ERR_FORMAT, 0 },  /* radians */
		{ 0x21, 0, GZ_HID_LENGTH, GZ_ERR_FORMAT, 0 },  /* cm^2 */
		{ 0x111, 0, GZ_HID_LENGTH, GZ_ERR_FORMAT, 0 }, /* g cm */
		{ 0x1001, 0, GZ_HID_LENGTH, GZ_ERR_FORMAT, 0 },
		{ 0, 0, GZ_HID_LENGTH, GZ_ERR_NOT_FOUND, 0 },
		{ 0x1, 0, GZ_HID_LENGTH, GZ_ERR_NOT_FOUND, 0 },
		{ 0x1001, -6, GZ_HID_TIME, GZ_OK, 1e3 },
		{ 0x1003, -7, GZ_HID_TIME, GZ_OK, 100 },
		{ 0x1005, -6, GZ_HID_TIME, GZ_ERR_FORMAT, 0 }, /* an undefined system of units */
		{ 0xf001, -6, GZ_HID_TIME, GZ_ERR_FORMAT, 0 },
		{ 0xf001, 0, GZ_HID_FREQUENCY, GZ_OK, 1 },
		{ 0xf001, 3, GZ_HID_FREQUENCY, GZ_OK, 1000 },
		{ 0x11, 0, GZ_HID_NUMBER, GZ_OK, 1 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double factor = -1;
		enum gz_result result = gz_hid_unit_factor(cases[i].unit, cases[i].exponent,
							   cases[i].dimension, &factor);
		if (result != cases[i].result)
			fail_msg("unit %x: %s", cases[i].unit, gz_result_text(result));
		if (result == GZ_OK)
			expect_near(factor, cases[i].factor, 1e-9 * cases[i].factor);
	}
}

static void value_is_scaled_from_its_logical_to_its_physical_range(void **state)
{
	(void)state;
	struct gz_hid_field field = { .bit_size = 12,
				      .count = 2,
				      .logical_min = -2048,
				      .logical_max = 2047,
				      .physical_min = -2048 * 3 + 5,
				      .physical_max = 2047 * 3 + 5,
				      .unit = 0x11,
				      .unit_exponent = -1 };
	struct gz_hid_value value;
	double number;
	assert_int_equal(gz_hid_value_from_field(&field, 1, GZ_HID_LENGTH, &value), GZ_OK);
	/* The second element is -2: 0xffe. */
	assert_int_equal(
		gz_hid_value_read(&value, (const unsigned char[]) { 0, 0xe0, 0xff }, 3, &number),
		GZ_HID_READ);
	expect_near(number, -2 * 3 + 5, 1e-9);
	/* Beyond the report. */
	assert_int_equal(gz_hid_value_read(&value, (const unsigned char[]) { 0, 0xe0 }, 2, &number),
			 GZ_HID_READ_WRONG);
	assert_int_equal(gz_hid_value_from_field(&field, 2, GZ_HID_LENGTH, &value),
			 GZ_ERR_UNSUPPORTED);
	field.bit_size = 65;
	assert_int_equal(gz_hid_value_from_field(&field, 0, GZ_HID_LENGTH, &value),
			 GZ_ERR_UNSUPPORTED);
	field.bit_size = 8;
	field.physical_min = field.physical_max = 7;
	assert_int_equal(gz_hid_value_from_field(&field, 0, GZ_HID_LENGTH, &value), GZ_ERR_FORMAT);
}

static void value_outside_its_range_is_nothing_or_wrong(void **state)
{
	(void)state;
	struct gz_hid_field field = {
		.bit_size = 8, .count = 1, .logical_min = 1, .logical_max = 100
	};
	struct gz_hid_value value;
	int64_t raw = 0;
	field.physical_min = 1;
	field.physical_max = 100;
	for (int nullable = 0; nullable < 2; nullable++) {
		field.flags = nullable ? GZ_HID_FLAG_NULL : 0;
		enum gz_hid_reading outside = nullable ? GZ_HID_READ_NULL : GZ_HID_READ_WRONG;
		assert_int_equal(gz_hid_value_from_field(&field, 0, GZ_HID_NUMBER, &value), GZ_OK);
		for (unsigned byte = 0; byte < 256; byte++) {
			unsigned char bytes[] = { (unsigned char)byte };
			assert_int_equal(gz_hid_value_raw(&value, bytes, 1, &raw),
					 byte >= 1 && byte <= 100 ? GZ_HID_READ : outside);
		}
	}
}

static const struct hid_made_sample looked = {
	.time_us = 0x123456789a,
	.gaze = { 250000, 120000 },
	.left = { 220000, 100000, 610000 },
	.right = { 280000, 101000, -620000 },
};

static void expect_looked(const struct gz_hid_input_report *report, bool eyes, double tolerance_mm)
{
	assert_int_equal(report->kind, GZ_HID_INPUT_TRACKING);
	assert_true(report->has_gaze);
	expect_near(report->gaze_mm[0], 250, tolerance_mm);
	expect_near(report->gaze_mm[1], 120, tolerance_mm);
	assert_int_equal(report->has_eye[GZ_EYE_LEFT], eyes);
	assert_int_equal(report->has_eye[GZ_EYE_RIGHT], eyes);
	if (!eyes)
		return;
	expect_near(report->eye_mm[GZ_EYE_LEFT][0], 220, 1e-6);
	expect_near(report->eye_mm[GZ_EYE_LEFT][2], 610, 1e-6);
	expect_near(report->eye_mm[GZ_EYE_RIGHT][1], 101, 1e-6);
	expect_near(report->eye_mm[GZ_EYE_RIGHT][2], -620, 1e-6);
}

static void tracker_of_every_layout_is_read(void **state)
{
	(void)state;
	static const uint64_t ticks[HID_LAYOUT_COUNT] = {
		0x123456789a, 0x123456789a,      0x123456789a * 10,
		0x3456789a,   0x123456789a * 10, 0x123456789a / 1000,
	};
	for (int layout = 0; layout < HID_LAYOUT_COUNT; layout++) {
		unsigned char bytes[HID_REPORT_MAX];
		struct gz_hid_input_report report;
		struct gz_hid_tracker tracker = made_tracker(layout);
		size_t size = hid_made_report(layout, &looked, bytes);
		gz_hid_tracker_read(&tracker, bytes, size, &report);
		expect_looked(&report, hid_layout_has_eyes(layout),
			      layout == HID_LAYOUT_POINT ? 0.0127 : 1e-6);
		assert_int_equal(report.has_ticks, layout != HID_LAYOUT_POINT);
		if (report.ticks != ticks[layout])
			fail_msg("layout %d: %llx", layout, (unsigned long long)report.ticks);
		expect_near(tracker.values[GZ_HID_TICKS].scale, hid_layout_tick_us(layout) * 1000,
			    1e-6);
		assert_int_equal(tracker.has_eyes, hid_layout_has_eyes(layout));
	}
}

static void tracker_report_of_a_wrong_length_is_malformed(void **state)
{
	(void)state;
	for (int layout = 0; layout < HID_LAYOUT_COUNT; layout++) {
		unsigned char bytes[160] = { 0 };
		struct gz_hid_input_report report;
		struct gz_hid_tracker tracker = made_tracker(layout);
		size_t whole = hid_made_report(layout, &looked, bytes);
		for (size_t size = 0; size < whole; size++) {
			gz_hid_tracker_read(&tracker, bytes, size, &report);
			assert_int_equal(report.kind, GZ_HID_INPUT_MALFORMED);
			assert_int_equal(report.malformed, GZ_MALFORMED_SHORT);
		}
		gz_hid_tracker_read(&tracker, bytes, whole + 1, &report);
		assert_int_equal(report.kind, GZ_HID_INPUT_MALFORMED);
		assert_int_equal(report.malformed, GZ_MALFORMED_LONG);
	}
}

static void tracker_report_padded_to_the_longest_one_is_read(void **state)
{
	(void)state;
	unsigned char bytes[160] = { 0 };
	struct gz_hid_input_report report;
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_REFERENCE);
	hid_made_status(HID_LAYOUT_REFERENCE, GZ_HID_STATE_READY, 250, bytes);
	gz_hid_tracker_read(&tracker, bytes, 65, &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_STATUS);
	assert_true(report.has_state && report.has_rate);
	assert_int_equal(report.state, GZ_HID_STATE_READY);
	expect_near(report.rate_hz, 250, 0);
}

static void tracker_report_with_an_unknown_id_is_malformed_and_of_another_application_ignored(
	void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	unsigned char bytes[16] = { 9 };
	struct gz_hid_input_report report;
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	/* Add a head tracker. */
	HID_ITEMS(&made, HID_USAGE, 2, HID_COLLECTION, 1, HID_USAGE, 0x10, HID_COLLECTION, 2,
		  HID_ID, 9, HID_SIZE, 8, HID_COUNT, 2, HID_USAGE, 0x24, HID_COLLECTION, 0,
		  HID_USAGE, 0x21, HID_USAGE, 0x22, HID_INPUT, 2, HID_END, 0, HID_END, 0, HID_END,
		  0);
	struct gz_hid_tracker tracker = find(&made, 0);
	assert_int_equal(gz_hid_tracker_count(&descriptor), 1);
	assert_int_equal(tracker.values[GZ_HID_GAZE_X].report_id, 0x10);
	gz_hid_tracker_read(&tracker, bytes, 3, &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_OTHER);
	bytes[0] = 77;
	gz_hid_tracker_read(&tracker, bytes, 3, &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_MALFORMED);
	assert_int_equal(report.malformed, GZ_MALFORMED_SYNTAX);
}

static void tracker_gaze_outside_its_range_is_malformed(void **state)
{
	(void)state;
	unsigned char bytes[128];
	struct gz_hid_input_report report;
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_REFERENCE);
	struct hid_made_sample sample = looked;
	sample.gaze[1] = 2000001;
	gz_hid_tracker_read(&tracker, bytes, hid_made_report(HID_LAYOUT_REFERENCE, &sample, bytes),
			    &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_MALFORMED);
	assert_int_equal(report.malformed, GZ_MALFORMED_VALUE);
	sample.gaze[1] = -2000000;
	gz_hid_tracker_read(&tracker, bytes, hid_made_report(HID_LAYOUT_REFERENCE, &sample, bytes),
			    &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_TRACKING);
	expect_near(report.gaze_mm[1], -2000, 1e-6);
}

static void tracker_with_null_values_is_understood(void **state)
{
	(void)state;
	static const int64_t items[] = { HID_UNIT, 0x11, HID_EXPONENT, 0xe, HID_INPUT, 0x42, -1 };
	struct hid_made made = gaze_of(items);
	struct gz_hid_tracker tracker = find(&made, 0);
	struct gz_hid_input_report report;
	gz_hid_tracker_read(&tracker, (const unsigned char[]) { 0xff, 0xff, 1, 0 }, 4, &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_TRACKING);
	assert_false(report.has_gaze || report.has_ticks);
	gz_hid_tracker_read(&tracker, (const unsigned char[]) { 0xe8, 3, 1, 0 }, 4, &report);
	assert_true(report.has_gaze);
	expect_near(report.gaze_mm[0], 100, 1e-9);
}

static void tracker_eyes_without_a_position_are_not_measured(void **state)
{
	(void)state;
	static const int32_t positions[][3] = { { 0, 0, 0 },
						{ 100000, 100000, 49000 },
						{ 100000, 2000001, 600000 } };
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_REFERENCE);
	for (size_t i = 0; i < sizeof positions / sizeof *positions; i++) {
		unsigned char bytes[128];
		struct gz_hid_input_report report;
		struct hid_made_sample sample = looked;
		memcpy(sample.left, positions[i], sizeof sample.left);
		gz_hid_tracker_read(&tracker, bytes,
				    hid_made_report(HID_LAYOUT_REFERENCE, &sample, bytes), &report);
		assert_int_equal(report.kind, GZ_HID_INPUT_TRACKING);
		assert_true(report.has_gaze && report.has_eye[GZ_EYE_RIGHT]);
		assert_false(report.has_eye[GZ_EYE_LEFT]);
	}
}

static void tracker_without_a_gaze_point_in_millimetres_is_refused(void **state)
{
	(void)state;
	struct hid_made none = { 0 };
	HID_ITEMS(&none, HID_PAGE, 1, HID_USAGE, 2, HID_COLLECTION, 1, HID_END, 0);
	expect_refusal(&none, GZ_ERR_NOT_FOUND);
	struct hid_made physical = { 0 };
	HID_ITEMS(&physical, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 0, HID_END, 0);
	expect_refusal(&physical, GZ_ERR_NOT_FOUND);
	struct hid_made empty = { 0 };
	HID_ITEMS(&empty, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 1, HID_END, 0);
	expect_refusal(&empty, GZ_ERR_FORMAT);
	static const int64_t radians[] = { HID_UNIT, 0x12, HID_INPUT, 2, -1 };
	static const int64_t array[] = { HID_UNIT, 0x11, HID_INPUT, 0, -1 };
	static const int64_t feature[] = { HID_UNIT, 0x11, HID_FEATURE, 2, -1 };
	static const int64_t one[] = { HID_UNIT, 0x11, HID_COUNT, 1, HID_INPUT, 2, -1 };
	static const int64_t long_ones[] = { HID_UNIT, 0x11, HID_SIZE, 65, HID_INPUT, 2, -1 };
	const int64_t *const cases[] = { radians, array, feature, one, long_ones };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct hid_made made = gaze_of(cases[i]);
		expect_refusal(&made, GZ_ERR_FORMAT);
	}
	/* X and Y in different reports are not a point. */
	struct hid_made split = { 0 };
	HID_ITEMS(&split, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 1, HID_USAGE, 0x10,
		  HID_COLLECTION, 2, HID_USAGE, 0x24, HID_COLLECTION, 0, HID_COUNT, 1, HID_SIZE, 16,
		  HID_LOGICAL_MAX, 1000, HID_ID, 1, HID_USAGE, 0x21, HID_INPUT, 2, HID_ID, 2,
		  HID_USAGE, 0x22, HID_INPUT, 2, HID_END, 0, HID_END, 0, HID_END, 0);
	expect_refusal(&split, GZ_ERR_FORMAT);
}

static void tracker_coordinates_as_a_range_of_usages_or_without_a_unit_are_found(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	HID_ITEMS(&made, HID_PAGE, 0x12, HID_USAGE, 1, HID_COLLECTION, 1, HID_USAGE, 0x10,
		  HID_COLLECTION, 2, HID_USAGE, 0x24, HID_COLLECTION, 0, HID_COUNT, 2, HID_SIZE, 24,
		  HID_LOGICAL_MIN, 0, HID_LOGICAL_MAX, 1000000, HID_USAGE_MIN, 0x21, HID_USAGE_MAX,
		  0x22, HID_INPUT, 2, HID_END, 0, HID_END, 0, HID_END, 0);
	struct gz_hid_tracker tracker = find(&made, 0);
	struct gz_hid_input_report report;
	gz_hid_tracker_read(&tracker, (const unsigned char[]) { 1, 0, 0, 0xe8, 3, 0 }, 6, &report);
	assert_false(tracker.values[GZ_HID_GAZE_X].has_unit);
	expect_near(report.gaze_mm[0], 0.001, 1e-9);
	expect_near(report.gaze_mm[1], 1, 1e-9);
}

static void tracker_time_too_long_or_of_another_unit_is_ignored(void **state)
{
	(void)state;
	static const struct {
		int64_t items[14];
		bool present, refused;
		unsigned bits;
	} cases[] = {
		{ { HID_SIZE, 8, HID_COUNT, 9, HID_UNIT, 0x1001, -1 }, false, true, 0 },
		{ { HID_SIZE, 65, HID_COUNT, 1, HID_UNIT, 0x1001, -1 }, false, true, 0 },
		{ { HID_SIZE, 8, HID_COUNT, 8, HID_UNIT, 0x11, -1 }, false, true, 0 },
		{ { HID_SIZE, 16, HID_COUNT, 4, HID_UNIT, 0x1001, -1 }, true, false, 64 },
		{ { HID_SIZE, 5, HID_COUNT, 1, -1 }, true, false, 5 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		static const int64_t none[] = { HID_UNIT, 0x11, HID_INPUT, 2, -1 };
		struct hid_made made = gaze_of(none);
		made.size -= 2; /* reopen the tracking data */
		HID_ITEMS(&made, HID_UNIT, 0, HID_LOGICAL_MAX, 255, HID_USAGE, 0x20);
		hid_made_items(&made, cases[i].items);
		HID_ITEMS(&made, HID_INPUT, 2, HID_END, 0, HID_END, 0);
		struct gz_hid_tracker tracker = find(&made, 0);
		assert_int_equal(tracker.values[GZ_HID_TICKS].present, cases[i].present);
		assert_int_equal(tracker.time_refused, cases[i].refused);
		assert_int_equal(tracker.values[GZ_HID_TICKS].bits, cases[i].bits);
		if (cases[i].bits == 5) /* without a unit the tick is unknown */
			expect_near(tracker.values[GZ_HID_TICKS].scale, 0, 0);
	}
}

static void tracker_time_in_eight_separate_items_is_one_number(void **state)
{
	(void)state;
	static const int64_t none[] = { HID_UNIT, 0x11, HID_INPUT, 2, -1 };
	struct hid_made made = gaze_of(none);
	struct gz_hid_input_report report;
	unsigned char bytes[12] = { 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8 };
	made.size -= 2;
	HID_ITEMS(&made, HID_UNIT, 0x1001, HID_EXPONENT, 0xa, HID_SIZE, 8, HID_COUNT, 1);
	for (int i = 0; i < 8; i++)
		HID_ITEMS(&made, HID_USAGE, 0x20, HID_INPUT, 2);
	HID_ITEMS(&made, HID_END, 0, HID_END, 0);
	struct gz_hid_tracker tracker = find(&made, 0);
	gz_hid_tracker_read(&tracker, bytes, sizeof bytes, &report);
	assert_true(report.has_ticks && report.ticks == 0x0807060504030201);
}

static void device_with_two_eye_trackers_has_both(void **state)
{
	(void)state;
	struct hid_made made = { 0 };
	unsigned char bytes[128];
	struct gz_hid_input_report report;
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	hid_made_tracker(&made, HID_LAYOUT_TIME64);
	struct gz_hid_tracker first = find(&made, 0), second = find(&made, 1);
	assert_int_equal(gz_hid_tracker_count(&descriptor), 2);
	size_t size = hid_made_report(HID_LAYOUT_TIME64, &looked, bytes);
	gz_hid_tracker_read(&second, bytes, size, &report);
	expect_looked(&report, true, 1e-6);
	gz_hid_tracker_read(&first, bytes, size, &report);
	assert_int_equal(report.kind, GZ_HID_INPUT_OTHER);
	assert_int_equal(gz_hid_tracker_find(&descriptor, 2, &first, NULL), GZ_ERR_NOT_FOUND);
}

static void impossible_screen_is_not_believed(void **state)
{
	(void)state;
	static const struct {
		int32_t width, height;
		bool believed;
	} cases[] = {
		{ 527000, 296000, true }, { 296000, 527000, true },      { 0, 0, false },
		{ 527, 296, false },      { 52700000, 29600000, false }, { 527000, 0, false },
		{ 527000, 60000, false }, { -527000, -296000, false },   { 60000, 110000, true },
	};
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_REFERENCE);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		unsigned char bytes[64];
		size_t size = hid_made_configuration(HID_LAYOUT_REFERENCE, cases[i].width,
						     cases[i].height, bytes);
		struct gz_hid_screen screen = gz_hid_tracker_screen(&tracker, bytes + 1, size - 1);
		if (screen.believed != cases[i].believed)
			fail_msg("%g by %g mm: %d", screen.mm[0], screen.mm[1], screen.believed);
		if (screen.believed)
			expect_near(screen.mm[0], cases[i].width / 1e3, 1e-6);
		assert_false(gz_hid_tracker_screen(&tracker, bytes + 1, size - 2).stated);
	}
}

static void distances_that_are_a_tenth_of_the_true_ones_are_corrected(void **state)
{
	(void)state;
	static const struct {
		int32_t nearest, optimum, farthest;
		bool believed, corrected;
		double optimum_mm;
	} cases[] = {
		{ 500000, 650000, 900000, true, false, 650 },
		{ 50000, 65000, 90000, true, true, 650 }, /* presets of the reference drivers */
		{ 0, 0, 0, false, false, 0 },
		{ 900000, 650000, 500000, false, false, 650 },
		{ 500, 650, 900, false, false, 0.65 },
		{ 50000, 650000, 900000, false, false, 650 },
	};
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_PADDED);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		unsigned char bytes[64];
		size_t size = hid_made_capabilities(HID_LAYOUT_PADDED, cases[i].nearest,
						    cases[i].optimum, cases[i].farthest, bytes);
		struct gz_hid_distances distances =
			gz_hid_tracker_distances(&tracker, bytes + 1, size - 1);
		assert_true(distances.stated);
		assert_int_equal(distances.believed, cases[i].believed);
		assert_int_equal(distances.corrected, cases[i].corrected);
		expect_near(distances.optimum_mm, cases[i].optimum_mm, 1e-6);
	}
}

static void mode_is_written_where_the_descriptor_says(void **state)
{
	(void)state;
	unsigned char bytes[2] = { 0xff, 0xff };
	struct gz_hid_tracker tracker = made_tracker(HID_LAYOUT_REFERENCE);
	assert_int_equal(gz_hid_tracker_set_mode(&tracker, bytes, 1, 3), GZ_OK);
	assert_int_equal(bytes[0], 3);
	assert_int_equal(bytes[1], 0xff);
	assert_int_equal(gz_hid_tracker_set_mode(&tracker, bytes, 0, 3), GZ_ERR_NOT_FOUND);
	/* Three bits in the middle of a byte: the other bits do not change. */
	tracker.values[GZ_HID_MODE].at = 2;
	tracker.values[GZ_HID_MODE].bits = 3;
	bytes[0] = 0xe3;
	assert_int_equal(gz_hid_tracker_set_mode(&tracker, bytes, 1, 5), GZ_OK);
	assert_int_equal(bytes[0], 0xe3 | 5 << 2);
	tracker = made_tracker(HID_LAYOUT_GAZE_ONLY);
	assert_int_equal(gz_hid_tracker_set_mode(&tracker, bytes, 2, 3), GZ_ERR_NOT_FOUND);
}

static void impossible_rate_is_unknown(void **state)
{
	(void)state;
	expect_near(gz_hid_believed_rate(100), 100, 0);
	expect_near(gz_hid_believed_rate(0), 0, 0);
	expect_near(gz_hid_believed_rate(65535), 0, 0);
	expect_near(gz_hid_believed_rate((double)NAN), 0, 0);
}

TEST_SUITE(hid_tracker)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bits_are_read_at_any_place_and_of_any_number),
		cmocka_unit_test(units_of_each_system_are_converted_and_others_are_refused),
		cmocka_unit_test(value_is_scaled_from_its_logical_to_its_physical_range),
		cmocka_unit_test(value_outside_its_range_is_nothing_or_wrong),
		cmocka_unit_test(tracker_of_every_layout_is_read),
		cmocka_unit_test(tracker_report_of_a_wrong_length_is_malformed),
		cmocka_unit_test(tracker_report_padded_to_the_longest_one_is_read),
		cmocka_unit_test(
			tracker_report_with_an_unknown_id_is_malformed_and_of_another_application_ignored),
		cmocka_unit_test(tracker_gaze_outside_its_range_is_malformed),
		cmocka_unit_test(tracker_with_null_values_is_understood),
		cmocka_unit_test(tracker_eyes_without_a_position_are_not_measured),
		cmocka_unit_test(tracker_without_a_gaze_point_in_millimetres_is_refused),
		cmocka_unit_test(
			tracker_coordinates_as_a_range_of_usages_or_without_a_unit_are_found),
		cmocka_unit_test(tracker_time_too_long_or_of_another_unit_is_ignored),
		cmocka_unit_test(tracker_time_in_eight_separate_items_is_one_number),
		cmocka_unit_test(device_with_two_eye_trackers_has_both),
		cmocka_unit_test(impossible_screen_is_not_believed),
		cmocka_unit_test(distances_that_are_a_tenth_of_the_true_ones_are_corrected),
		cmocka_unit_test(mode_is_written_where_the_descriptor_says),
		cmocka_unit_test(impossible_rate_is_unknown),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
