#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/pupil/pupil_message.h"

#define CONFIDENCE 0.6

static struct gz_pupil_memory memory; /* large */
static struct gz_pupil_entries entries;

static int begin(void **state)
{
	(void)state;
	memset(&memory, 0, sizeof memory);
	memset(&entries, 0, sizeof entries);
	return 0;
}

/* A message of another gazed. */
static struct gz_gaze daemon_gaze(void)
{
	static const struct gz_gaze_eye eye = {
		.point = { 0.3f, 0.4f },
		.pupil_mm = 3,
		.valid = true,
		.confidence = 0.9f,
		.origin_mm = { NAN, NAN, NAN },
		.direction = { NAN, NAN, NAN },
	};
	return (struct gz_gaze) {
		.seq = 7,
		.device_ns = GZ_NO_DEVICE_TIME,
		.host_ns = 5 * GZ_NS_PER_S + 1,
		.publish_ns = 6 * GZ_NS_PER_S,
		.point = { 0.5f, 0.6f },
		.raw = { 0.51f, 0.61f },
		.confidence = 0.9f,
		.eye = { eye, eye },
	};
}

static struct gz_pupil_gaze read_gaze(const struct gz_gaze *gaze)
{
	const struct gz_display display = gz_display_default(1920, 1080);
	struct gz_wire_message message;
	struct gz_pupil_gaze read;
	enum gz_malformed reason;
	assert_int_equal(gz_wire_encode_gaze(gaze, &display, &message), GZ_OK);
	assert_int_equal(
		gz_pupil_read_gaze(message.bytes, message.size, CONFIDENCE, &read, &reason), GZ_OK);
	return read;
}

static void gaze_of_another_daemon_is_used_unsmoothed(void **state)
{
	(void)state;
	struct gz_gaze gaze = daemon_gaze();
	struct gz_pupil_gaze read = read_gaze(&gaze);
	assert_int_equal(read.number, 7);
	assert_true(read.own_points);
	assert_true(read.sample.valid);
	assert_true(read.sample.point.x == 0.51f && read.sample.point.y == 0.61f);
	assert_true(read.sample.eye[GZ_EYE_LEFT].point.x == 0.3f);
	assert_int_equal(read.sample.device_ns, gaze.host_ns);
}

static void gaze_of_another_daemon_in_a_blink_is_invalid(void **state)
{
	(void)state;
	struct gz_gaze gaze = daemon_gaze();
	gaze.event = GZ_EVENT_BLINK;
	gaze.raw = (struct gz_point) { NAN, NAN };
	gaze.confidence = 0;
	gaze.eye[0].valid = gaze.eye[1].valid = false;
	struct gz_pupil_gaze read = read_gaze(&gaze);
	assert_false(read.sample.valid);
	assert_false(read.sample.eye[GZ_EYE_RIGHT].valid);
	assert_false(read.sample.eye[GZ_EYE_LEFT].valid);
}

static void gaze_with_a_single_point_leaves_the_eyes_unmeasured(void **state)
{
	(void)state;
	struct gz_gaze gaze = daemon_gaze();
	gaze.combined = true;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		gaze.eye[i].valid = false;
		gaze.eye[i].point = (struct gz_point) { NAN, NAN };
	}
	struct gz_pupil_gaze read = read_gaze(&gaze);
	assert_true(gz_sample_combined_only(&read.sample));
	assert_true(read.sample.valid);
}

static void bad_gaze_has_a_reason_and_writes_nothing(void **state)
{
	(void)state;
	struct gz_pupil_gaze read = { .number = 77 };
	enum gz_malformed reason;
	assert_int_equal(gz_pupil_read_gaze("\xc1", 1, CONFIDENCE, &read, &reason),
			 GZ_ERR_PROTOCOL);
	assert_int_equal(reason, GZ_MALFORMED_SYNTAX);
	assert_int_equal(gz_pupil_read_gaze("\x80", 1, CONFIDENCE, &read, &reason),
			 GZ_ERR_PROTOCOL);
	assert_int_equal(reason, GZ_MALFORMED_VALUE);
	assert_int_equal(read.number, 77);
}

/* A surface entry without its gaze message, and one whose gaze message is remembered. */
static void entry_without_its_gaze_is_only_a_point(void **state)
{
	(void)state;
	struct gz_gaze gaze = daemon_gaze();
	struct gz_wire_message message;
	struct gz_pupil_gaze read;
	enum gz_malformed reason;
	assert_int_equal(gz_wire_encode_surface(&gaze, NULL, 0, "screen", &message), GZ_OK);
	assert_int_equal(gz_pupil_read_surface(message.bytes, message.size, &entries, &reason),
			 GZ_OK);
	assert_int_equal(gz_pupil_next_entry(&entries, &memory, CONFIDENCE, &read), GZ_OK);
	assert_true(gz_sample_combined_only(&read.sample));
	assert_true(read.sample.point.x == 0.5f);
	assert_int_equal(gz_pupil_next_entry(&entries, &memory, CONFIDENCE, &read), GZ_ERR_END);

	struct gz_pupil_gaze base = read_gaze(&gaze);
	gz_pupil_remember(&memory, &base);
	assert_int_equal(gz_pupil_read_surface(message.bytes, message.size, &entries, &reason),
			 GZ_OK);
	assert_int_equal(gz_pupil_next_entry(&entries, &memory, CONFIDENCE, &read), GZ_OK);
	assert_true(read.sample.eye[GZ_EYE_RIGHT].valid);
	assert_int_equal(read.sample.device_ns, gaze.host_ns);
	/* After so many others it is forgotten. */
	base.sample.device_ns += GZ_NS_PER_S;
	for (int i = 0; i < GZ_PUPIL_MEMORY; i++)
		gz_pupil_remember(&memory, &base);
	assert_int_equal(gz_pupil_read_surface(message.bytes, message.size, &entries, &reason),
			 GZ_OK);
	assert_int_equal(gz_pupil_next_entry(&entries, &memory, CONFIDENCE, &read), GZ_OK);
	assert_true(gz_sample_combined_only(&read.sample));
}

static void surface_with_too_many_entries_is_long(void **state)
{
	(void)state;
	/* 600 nils: their number alone is too large. */
	static unsigned char bytes[1 + 17 + 3 + 600];
	enum gz_malformed reason;
	memcpy(bytes, "\x81\xb0gaze_on_surfaces\xdc\x02\x58", 21);
	memset(bytes + 21, 0xc0, 600);
	assert_int_equal(gz_pupil_read_surface(bytes, sizeof bytes, &entries, &reason),
			 GZ_ERR_PROTOCOL);
	assert_int_equal(reason, GZ_MALFORMED_LONG);
	assert_int_equal(entries.count, 0);
}

static struct gz_pupil_gaze at(int64_t pupil_ns, uint64_t number)
{
	struct gz_pupil_gaze gaze = { .sample = gz_sample_unmeasured(), .number = number };
	gaze.sample.device_ns = pupil_ns;
	return gaze;
}

static void order_refuses_what_is_not_newer(void **state)
{
	(void)state;
	struct gz_pupil_order order = { 0 };
	uint32_t missing = 77;
	struct gz_pupil_gaze gaze = at(1000, 0);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
	assert_int_equal(missing, 0);
	missing = 77;
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_ERR_PROTOCOL);
	gaze = at(999, 0);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_ERR_PROTOCOL);
	gaze = at(INT64_MIN, 0);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_ERR_PROTOCOL);
	assert_int_equal(missing, 77);
	gz_pupil_order_restart(&order);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
}

static void order_counts_by_numbers_if_there_are_any(void **state)
{
	(void)state;
	static const uint64_t numbers[][3] = {
		{ 5, 6, 0 },
		{ 6, 10, 3 },
		{ 10, 4, 0 },      /* restarted */
		{ 4, 5000000, 0 }, /* jumped */
	};
	struct gz_pupil_order order = { 0 };
	int64_t pupil_ns = 0;
	uint32_t missing;
	struct gz_pupil_gaze gaze = at(pupil_ns, numbers[0][0]);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
		gaze = at(pupil_ns += GZ_NS_PER_MS, numbers[i][1]);
		assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
		assert_int_equal(missing, numbers[i][2]);
	}
}

static void order_counts_by_time_and_tolerates_uneven_steps(void **state)
{
	(void)state;
	struct gz_pupil_order order = { 0 };
	int64_t pupil_ns = 0;
	uint32_t missing, sum = 0;
	/* Two cameras at 200 Hz, one a quarter of a period after the other. */
	for (int i = 0; i < 1000; i++) {
		pupil_ns += i % 2 ? 1250000 : 3750000;
		struct gz_pupil_gaze gaze = at(pupil_ns, 0);
		assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
		sum += missing;
	}
	assert_int_equal(sum, 0);
	struct gz_pupil_gaze gaze = at(pupil_ns += 40 * GZ_NS_PER_MS, 0);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
	assert_in_range(missing, 8, 11);
	/* A pause is not a loss, and neither is a slower rate once it is known. */
	gaze = at(pupil_ns += 10 * GZ_NS_PER_S, 0);
	assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
	assert_int_equal(missing, 0);
	for (int i = 0; i < 200; i++) {
		gaze = at(pupil_ns += 30 * GZ_NS_PER_MS, 0);
		assert_int_equal(gz_pupil_order_step(&order, &gaze, &missing), GZ_OK);
	}
	assert_int_equal(missing, 0);
}

TEST_SUITE(pupil_message)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(gaze_of_another_daemon_is_used_unsmoothed, begin),
		cmocka_unit_test_setup(gaze_of_another_daemon_in_a_blink_is_invalid, begin),
		cmocka_unit_test_setup(gaze_with_a_single_point_leaves_the_eyes_unmeasured, begin),
		cmocka_unit_test_setup(bad_gaze_has_a_reason_and_writes_nothing, begin),
		cmocka_unit_test_setup(entry_without_its_gaze_is_only_a_point, begin),
		cmocka_unit_test_setup(surface_with_too_many_entries_is_long, begin),
		cmocka_unit_test_setup(order_refuses_what_is_not_newer, begin),
		cmocka_unit_test_setup(order_counts_by_numbers_if_there_are_any, begin),
		cmocka_unit_test_setup(order_counts_by_time_and_tolerates_uneven_steps, begin),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
