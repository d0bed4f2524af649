/* The Pupil driver with a fake Pupil Capture. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "pupil_capture.h"

static struct pupil_capture capture;
static struct gz_device *device;
static struct driver_stage stage;

static int begin(void **state)
{
	(void)state;
	stage_reset(&stage, "pupil");
	memset(&capture, 0, sizeof capture);
	return 0;
}

static int end(void **state)
{
	(void)state;
	gz_device_destroy(&device);
	pupil_capture_stop(&capture);
	return 0;
}

static enum gz_result open_device(void)
{
	return stage_create(&stage, NULL, &device);
}

/* On a busy machine the first answer may take longer than the driver waits. */
static void connect_device(const char *surface)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	enum gz_result result;
	pupil_capture_start(&capture);
	stage_set(&stage, "pupil.address", capture.address);
	stage_set(&stage, "pupil.surface", surface);
	do
		result = open_device();
	while (result == GZ_ERR_NO_DEVICE && gz_clock_now_ns() < deadline_ns);
	assert_int_equal(result, GZ_OK);
	assert_int_equal(gz_device_start(device), GZ_OK);
}

static void read_one(struct gz_sample *sample)
{
	*sample = device_read_sample(device);
}

/* The number, modulo 64, of the sample with this point. */
static int number_at(struct gz_point point, double scale)
{
	for (uint64_t i = 0; i < 64; i++) {
		double xy[2];
		pupil_capture_point(i, xy);
		if (fabs(xy[0] * scale - (double)point.x) < 1e-6 &&
		    fabs(xy[1] * scale - (double)point.y) < 1e-6)
			return (int)i;
	}
	fail_msg("nobody looks at %g, %g", (double)point.x, (double)point.y);
	return -1;
}

static struct gz_device_counters counters(void)
{
	return device_counters(device);
}

static void assert_near(float value, double expected)
{
	if (!(fabs((double)value - expected) < 1e-6))
		fail_msg("%g, expected %g", (double)value, expected);
}

static void gaze_of_two_eyes_becomes_samples(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("");
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	assert_false(info.has_display);
	for (uint64_t i = 0; i < 20; i++) {
		read_one(&sample);
		assert_int_equal(sample.seq, i);
		number_at(sample.point, 1);
		assert_true(sample.valid);
		for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
			assert_true(sample.eye[eye].valid);
			assert_near(sample.eye[eye].point.x, (double)sample.point.x);
			assert_near(sample.eye[eye].point.y, (double)sample.point.y);
			assert_near(sample.eye[eye].pupil_mm, 3.5 + eye);
			assert_near(sample.eye[eye].confidence, (double)0.9f);
			assert_near(sample.eye[eye].origin_mm[0], eye == GZ_EYE_RIGHT ? 30 : -30);
		}
		/* Directions have unit length even if those sent do not. */
		assert_near(sample.eye[GZ_EYE_RIGHT].direction[2], 1);
		assert_near(sample.eye[GZ_EYE_LEFT].direction[1], 1);
	}
}

static void gaze_of_one_eye_leaves_the_other_unmeasured(void **state)
{
	(void)state;
	struct gz_sample sample;
	atomic_store(&capture.monocular, true);
	connect_device("");
	read_one(&sample);
	assert_true(sample.eye[GZ_EYE_RIGHT].valid);
	assert_near(sample.eye[GZ_EYE_RIGHT].origin_mm[1], 15);
	assert_near(sample.eye[GZ_EYE_RIGHT].direction[2], 1);
	assert_false(sample.eye[GZ_EYE_LEFT].valid);
	assert_true(isnan(sample.eye[GZ_EYE_LEFT].point.x));
	assert_true(isnan(sample.eye[GZ_EYE_LEFT].pupil_mm));
}

static void surface_gives_the_point_and_its_gaze_the_pupils(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("screen");
	/* The gaze messages for the first surface message may have come before the subscription. */
	for (int i = 0; i < PUPIL_CAPTURE_ENTRIES; i++)
		read_one(&sample);
	int last = number_at(sample.point, 0.5);
	for (int i = 0; i < 40; i++) {
		read_one(&sample);
		int number = number_at(sample.point, 0.5);
		assert_int_equal(number, (last + 1) % 64);
		last = number;
		assert_true(sample.valid);
		assert_near(sample.eye[GZ_EYE_LEFT].pupil_mm, 4.5);
		assert_near(sample.eye[GZ_EYE_LEFT].point.x, (double)sample.point.x);
	}
}

static void confidence_below_the_limit_is_invalid(void **state)
{
	(void)state;
	struct gz_sample sample;
	stage_set(&stage, "pupil.confidence", "0.89");
	connect_device("");
	read_one(&sample);
	assert_false(sample.valid);                  /* 0.875 */
	assert_true(sample.eye[GZ_EYE_RIGHT].valid); /* 0.9 */
}

static void pupil_clock_is_mapped_to_ours(void **state)
{
	(void)state;
	static const int64_t ahead_ns[] = { -1000 * GZ_NS_PER_S, 1700000000 * GZ_NS_PER_S };
	for (size_t i = 0; i < 2; i++) {
		struct gz_sample sample;
		double sum_ms = 0;
		begin(NULL);
		capture.skew = 50e-6;
		atomic_store(&capture.ahead_ns, ahead_ns[i]);
		connect_device("");
		for (int k = 0; k < 100; k++)
			read_one(&sample);
		for (int k = 0; k < 50; k++) {
			read_one(&sample);
			int64_t shows_ns = pupil_capture_time_ns(&capture, sample.host_ns);
			sum_ms += gz_ns_to_ms(shows_ns - sample.device_ns) / 50;
		}
		/* Error of host time relative to the exposure. On a busy machine answers are
		 * delayed one way. */
		if (fabs(sum_ms) > 2)
			fail_msg("%g ms off", sum_ms);
		struct gz_clock_status clock = counters().clock;
		assert_int_equal(clock.tick, GZ_CLOCK_DECLARED);
		assert_true(llabs(clock.offset_ns + ahead_ns[i]) < 10 * GZ_NS_PER_MS);
		end(NULL);
	}
}

static void clock_that_is_set_is_noticed_and_time_continues(void **state)
{
	(void)state;
	struct gz_sample sample;
	int64_t last_ns = 0, begin_ns = gz_clock_now_ns();
	bool settled = false;
	connect_device("");
	read_one(&sample);
	atomic_fetch_sub(&capture.ahead_ns, 100 * GZ_NS_PER_S);
	while (!settled && gz_clock_now_ns() - begin_ns < PATIENCE_NS) {
		read_one(&sample);
		assert_true(sample.host_ns > last_ns);
		assert_true(sample.host_ns <= gz_clock_now_ns());
		last_ns = sample.host_ns;
		settled = llabs(counters().clock.offset_ns - 100 * GZ_NS_PER_S) < 10 * GZ_NS_PER_MS;
	}
	assert_true(settled);
}

static void garbage_is_counted_by_reason_and_the_stream_continues(void **state)
{
	(void)state;
	struct gz_sample sample;
	atomic_store(&capture.garbage, true);
	connect_device("screen");
	for (uint64_t i = 0; i < 60; i++) {
		read_one(&sample);
		assert_int_equal(sample.seq, i);
		number_at(sample.point, 0.5);
	}
	struct gz_device_counters now = counters();
	assert_true(now.malformed[GZ_MALFORMED_SYNTAX] >= 10);
	assert_true(now.malformed[GZ_MALFORMED_VALUE] >= 10);
	assert_true(now.malformed[GZ_MALFORMED_SHORT] >= 10);
	assert_true(now.malformed[GZ_MALFORMED_LONG] >= 10);
	assert_int_equal(now.malformed[GZ_MALFORMED_STALE], 0);
}

static void duplicates_are_stale_and_missing_samples_lost(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("");
	for (int i = 0; i < 100; i++)
		read_one(&sample);
	uint64_t lost = counters().lost;
	atomic_store(&capture.skip, 20);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do
		read_one(&sample);
	while (sample.lost_before == 0 && gz_clock_now_ns() < deadline_ns);
	/* The period is estimated, so it may be a little off. */
	assert_in_range(sample.lost_before, 15, 21);
	assert_int_equal(counters().lost, lost + sample.lost_before);
	atomic_store(&capture.twice, true);
	while (counters().malformed[GZ_MALFORMED_STALE] < 5)
		read_one(&sample);
}

static void silence_is_a_timeout_and_the_stream_may_return(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("");
	read_one(&sample);
	atomic_store(&capture.mute, true);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	enum gz_result result;
	do
		result = gz_device_read(device, 50, &sample);
	while (result == GZ_OK && gz_clock_now_ns() < deadline_ns);
	assert_int_equal(result, GZ_ERR_TIMEOUT);
	atomic_store(&capture.mute, false);
	read_one(&sample);
}

static void pupil_that_dies_is_gone_and_may_return_at_another_port(void **state)
{
	(void)state;
	struct gz_sample sample;
	enum gz_result result;
	connect_device("");
	read_one(&sample);
	pupil_capture_stop(&capture);
	int64_t begin_ns = gz_clock_now_ns();
	do
		result = gz_device_read(device, 100, &sample);
	while (result != GZ_ERR_NO_DEVICE && gz_clock_now_ns() - begin_ns < PATIENCE_NS);
	assert_int_equal(result, GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
	assert_null(device);
	connect_device("");
	read_one(&sample);
	assert_int_equal(sample.seq, 0);
}

static void pupil_that_restarts_at_once_is_followed_to_its_new_port(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("");
	read_one(&sample);
	pupil_capture_stop(&capture);
	pupil_capture_start(&capture);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	uint64_t old = sample.seq;
	/* Messages that were already sent may still come. */
	while (sample.seq < old + 20 && gz_clock_now_ns() < deadline_ns)
		if (gz_device_read(device, 100, &sample) == GZ_ERR_NO_DEVICE)
			fail_msg("was given up");
	assert_true(sample.seq >= old + 20);
}

static void pupil_with_bad_answers_is_refused(void **state)
{
	(void)state;
	static const char *const answers[] = { "", "0", "65536", "x", "TCP is off; use ipc" };
	for (size_t i = 0; i < sizeof answers / sizeof *answers; i++) {
		begin(NULL);
		capture.port_answer = answers[i];
		pupil_capture_start(&capture);
		stage_set(&stage, "pupil.address", capture.address);
		assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
		assert_null(device);
		pupil_capture_stop(&capture);
	}
	begin(NULL);
	atomic_store(&capture.deaf, true);
	pupil_capture_start(&capture);
	stage_set(&stage, "pupil.address", capture.address);
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
	assert_true(gz_clock_now_ns() - begin_ns < 2 * GZ_NS_PER_S);
}

/* It is asked again later: without an answer its display would be taken for the preset one. */
static void gazed_that_is_too_busy_to_tell_its_display_is_refused(void **state)
{
	(void)state;
	begin(NULL);
	capture.latest_answer = "50022";
	pupil_capture_start(&capture);
	stage_set(&stage, "pupil.address", capture.address);
	assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
	assert_null(device);
}

static void malformed_addresses_are_refused(void **state)
{
	(void)state;
	static const char *const addresses[] = { "",
						 "127.0.0.1:50020",
						 "tcp://",
						 "tcp://127.0.0.1",
						 "tcp://127.0.0.1:",
						 "tcp://127.0.0.1:0",
						 "tcp://127.0.0.1:65536",
						 "tcp://:50020",
						 "ipc:///tmp/x:1" };
	for (size_t i = 0; i < sizeof addresses / sizeof *addresses; i++) {
		stage_set(&stage, "pupil.address", addresses[i]);
		if (open_device() != GZ_ERR_INVAL)
			fail_msg("\"%s\" was taken", addresses[i]);
		assert_null(device);
	}
}

static void running_pupil_is_listed(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	pupil_capture_start(&capture);
	stage_set(&stage, "pupil.address", capture.address);
	size_t count = 0;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count == 0 && gz_clock_now_ns() < deadline_ns)
		count = stage_list(&stage, entries);
	assert_int_equal(count, 1);
	assert_string_equal(entries[0].name, "Pupil Capture 3.5.1");
	assert_string_equal(entries[0].place, capture.address);
	assert_true(entries[0].usable);
	pupil_capture_stop(&capture);
	assert_int_equal(stage_list(&stage, entries), 0);
}

TEST_SUITE(pupil)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(gaze_of_two_eyes_becomes_samples, begin, end),
		cmocka_unit_test_setup_teardown(gaze_of_one_eye_leaves_the_other_unmeasured, begin,
						end),
		cmocka_unit_test_setup_teardown(surface_gives_the_point_and_its_gaze_the_pupils,
						begin, end),
		cmocka_unit_test_setup_teardown(confidence_below_the_limit_is_invalid, begin, end),
		cmocka_unit_test_setup_teardown(pupil_clock_is_mapped_to_ours, begin, end),
		cmocka_unit_test_setup_teardown(clock_that_is_set_is_noticed_and_time_continues,
						begin, end),
		cmocka_unit_test_setup_teardown(
			garbage_is_counted_by_reason_and_the_stream_continues, begin, end),
		cmocka_unit_test_setup_teardown(duplicates_are_stale_and_missing_samples_lost,
						begin, end),
		cmocka_unit_test_setup_teardown(silence_is_a_timeout_and_the_stream_may_return,
						begin, end),
		cmocka_unit_test_setup_teardown(
			pupil_that_dies_is_gone_and_may_return_at_another_port, begin, end),
		cmocka_unit_test_setup_teardown(
			pupil_that_restarts_at_once_is_followed_to_its_new_port, begin, end),
		cmocka_unit_test_setup_teardown(pupil_with_bad_answers_is_refused, begin, end),
		cmocka_unit_test_setup_teardown(
			gazed_that_is_too_busy_to_tell_its_display_is_refused, begin, end),
		cmocka_unit_test_setup_teardown(malformed_addresses_are_refused, begin, end),
		cmocka_unit_test_setup_teardown(running_pupil_is_listed, begin, end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
