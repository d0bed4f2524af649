/* The driver against a Pupil Capture that the test plays. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/pupil/pupil_driver.h"
#include "pupil_capture.h"

/* Patience for what a busy machine may delay, ns. */
#define PATIENCE_NS (20 * GZ_NS_PER_S)

static struct pupil_capture capture;
static struct gz_device *device;
static _Alignas(max_align_t) unsigned char settings[GZ_DRIVER_SETTINGS_SIZE];

static void set_option(const char *key, const char *text)
{
	const struct gz_driver *driver = &gz_driver_pupil;
	struct gz_option_binding binding = { driver->options, *driver->option_count, settings,
					     NULL };
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	assert_non_null(option);
	assert_int_equal(gz_option_parse(option, text, settings, NULL, 0), GZ_OK);
}

static int begin(void **state)
{
	(void)state;
	const struct gz_driver *driver = &gz_driver_pupil;
	struct gz_option_binding binding = { driver->options, *driver->option_count, settings,
					     NULL };
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
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
	return gz_driver_pupil.create(settings, &(struct gz_driver_host) { 0 }, &device);
}

/* On a machine that is busy, the first answer may take longer than the driver waits. */
static void connect_device(const char *surface)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	enum gz_result result;
	pupil_capture_start(&capture);
	set_option("pupil.address", capture.address);
	set_option("pupil.surface", surface);
	do
		result = open_device();
	while (result == GZ_ERR_NO_DEVICE && gz_clock_now_ns() < deadline_ns);
	assert_int_equal(result, GZ_OK);
	assert_int_equal(gz_device_start(device), GZ_OK);
}

static void read_one(struct gz_sample *sample)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	enum gz_result result;
	do
		result = gz_device_read(device, 20, sample);
	while (result == GZ_ERR_TIMEOUT && gz_clock_now_ns() < deadline_ns);
	if (result != GZ_OK)
		fail_msg("no sample: %s", gz_result_text(result));
}

/* The number of the sample that is at @p point, of 64. */
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
	struct gz_device_counters now;
	gz_device_get_counters(device, &now);
	return now;
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
		/* Directions have unit length whatever came. */
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

static void surface_gives_the_place_and_its_gaze_the_pupils(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("screen");
	/* The gaze messages of the first surface message may have come before we listened. */
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
	set_option("pupil.confidence", "0.89");
	connect_device("");
	read_one(&sample);
	assert_false(sample.valid);                  /* 0.875 */
	assert_true(sample.eye[GZ_EYE_RIGHT].valid); /* 0.9 */
}

static void clock_of_pupil_is_told_from_ours(void **state)
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
		/* How far host time is from when the sample was exposed. On a busy machine answers
		 * are late one way. */
		if (fabs(sum_ms) > 2)
			fail_msg("%g ms off", sum_ms);
		struct gz_clock_status clock = counters().clock;
		assert_int_equal(clock.tick, GZ_CLOCK_DECLARED);
		assert_true(llabs(clock.offset_ns + ahead_ns[i]) < 10 * GZ_NS_PER_MS);
		end(NULL);
	}
}

static void clock_that_is_set_is_found_and_time_goes_on(void **state)
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

static void garbage_is_counted_by_reason_and_the_stream_goes_on(void **state)
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
	/* The period is followed, not told: it may be a little off. */
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

static void pupil_that_dies_is_no_device_and_may_return_at_another_port(void **state)
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

static void pupil_that_begins_anew_at_once_is_followed_to_its_new_port(void **state)
{
	(void)state;
	struct gz_sample sample;
	connect_device("");
	read_one(&sample);
	pupil_capture_stop(&capture);
	pupil_capture_start(&capture);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	uint64_t old = sample.seq;
	/* What was on its way may still come. */
	while (sample.seq < old + 20 && gz_clock_now_ns() < deadline_ns)
		if (gz_device_read(device, 100, &sample) == GZ_ERR_NO_DEVICE)
			fail_msg("was given up");
	assert_true(sample.seq >= old + 20);
}

static void pupil_that_does_not_answer_well_is_refused(void **state)
{
	(void)state;
	static const char *const answers[] = { "", "0", "65536", "x", "TCP is off; use ipc" };
	for (size_t i = 0; i < sizeof answers / sizeof *answers; i++) {
		begin(NULL);
		capture.port_answer = answers[i];
		pupil_capture_start(&capture);
		set_option("pupil.address", capture.address);
		assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
		assert_null(device);
		pupil_capture_stop(&capture);
	}
	begin(NULL);
	atomic_store(&capture.deaf, true);
	pupil_capture_start(&capture);
	set_option("pupil.address", capture.address);
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(open_device(), GZ_ERR_NO_DEVICE);
	assert_true(gz_clock_now_ns() - begin_ns < 2 * GZ_NS_PER_S);
}

static void addresses_that_are_none_are_refused(void **state)
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
		set_option("pupil.address", addresses[i]);
		if (open_device() != GZ_ERR_INVAL)
			fail_msg("\"%s\" was taken", addresses[i]);
		assert_null(device);
	}
}

static void pupil_that_is_there_is_listed(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	const struct gz_driver_host host = { 0 };
	pupil_capture_start(&capture);
	set_option("pupil.address", capture.address);
	size_t count = 0;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (count == 0 && gz_clock_now_ns() < deadline_ns)
		count = gz_driver_pupil.list(settings, &host, entries);
	assert_int_equal(count, 1);
	assert_string_equal(entries[0].name, "Pupil Capture 3.5.1");
	assert_string_equal(entries[0].place, capture.address);
	assert_true(entries[0].usable);
	pupil_capture_stop(&capture);
	assert_int_equal(gz_driver_pupil.list(settings, &host, entries), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(gaze_of_two_eyes_becomes_samples, begin, end),
		cmocka_unit_test_setup_teardown(gaze_of_one_eye_leaves_the_other_unmeasured, begin,
						end),
		cmocka_unit_test_setup_teardown(surface_gives_the_place_and_its_gaze_the_pupils,
						begin, end),
		cmocka_unit_test_setup_teardown(confidence_below_the_limit_is_invalid, begin, end),
		cmocka_unit_test_setup_teardown(clock_of_pupil_is_told_from_ours, begin, end),
		cmocka_unit_test_setup_teardown(clock_that_is_set_is_found_and_time_goes_on, begin,
						end),
		cmocka_unit_test_setup_teardown(garbage_is_counted_by_reason_and_the_stream_goes_on,
						begin, end),
		cmocka_unit_test_setup_teardown(duplicates_are_stale_and_missing_samples_lost,
						begin, end),
		cmocka_unit_test_setup_teardown(silence_is_a_timeout_and_the_stream_may_return,
						begin, end),
		cmocka_unit_test_setup_teardown(
			pupil_that_dies_is_no_device_and_may_return_at_another_port, begin, end),
		cmocka_unit_test_setup_teardown(
			pupil_that_begins_anew_at_once_is_followed_to_its_new_port, begin, end),
		cmocka_unit_test_setup_teardown(pupil_that_does_not_answer_well_is_refused, begin,
						end),
		cmocka_unit_test_setup_teardown(addresses_that_are_none_are_refused, begin, end),
		cmocka_unit_test_setup_teardown(pupil_that_is_there_is_listed, begin, end),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
