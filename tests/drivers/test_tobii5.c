/* The driver of the Tobii Eye Tracker 5 from USB to samples, with a fake libusb and a fake clock.
 */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/tobii5/tobii5_link.h"
#include "fake_libusb.h"
#include "tobii5_made.h"

static struct driver_stage stage;
static struct tobii5_played tracker;
static bool sends; /* gaze, once it is subscribed to */
static uint32_t number;
static bool goes_at_request; /* unplugged at the first request */

static size_t answer(void *user, const unsigned char *bytes, size_t size, unsigned char *reply,
		     size_t room)
{
	assert_true(room >= TOBII5_MADE_MAX);
	fake_usb.unplugged |= goes_at_request;
	goes_at_request = false;
	return tobii5_played_answer(user, bytes, size, reply);
}

static size_t play(void *user, unsigned char *bytes, size_t room)
{
	(void)user;
	assert_true(room >= TOBII5_MADE_MAX);
	if (!sends || !tracker.is_subscribed)
		return 0;
	const struct tobii5_made_gaze gaze = tobii5_made_looking(number++, 0.25, 0.75);
	return tobii5_made_gaze(&gaze, bytes);
}

static int set_up(void **state)
{
	(void)state;
	fake_usb_reset();
	stage_reset(&stage, "tobii5");
	tracker = (struct tobii5_played) { 0 };
	tobii5_played_set_screen(&tracker);
	sends = true;
	goes_at_request = false;
	number = 0;
	fake_usb.has_sessions = true;
	fake_usb.request = answer;
	fake_usb.request_user = &tracker;
	fake_usb.packet = play;
	fake_usb.period_ns = 30270 * GZ_NS_PER_US;
	fake_usb.due_ns = gz_clock_now_ns();
	return 0;
}

static struct gz_device *start_device(void)
{
	fake_usb_plug(0x2104, 0x0313);
	return stage_start(&stage);
}

static void expect_released(void)
{
	assert_int_equal(fake_usb.transfers, 0);
	assert_int_equal(fake_usb.in_flight, 0);
	assert_int_equal(fake_usb.claims, 0);
	assert_int_equal(fake_usb.handles, 0);
	assert_int_equal(fake_usb.contexts, 0);
}

/* Destroy the device and check that it has released everything. */
static void finish(struct gz_device **device)
{
	gz_device_destroy(device);
	expect_released();
}

static void deliver_frame(uint32_t kind, uint32_t operation, const void *payload, size_t size)
{
	unsigned char bytes[4096];
	assert_true(size + TOBII5_MADE_OVERHEAD <= sizeof bytes);
	fake_usb_deliver(bytes, tobii5_made_frame(kind, 1, operation, payload, size, bytes));
}

static void deliver_gaze(const struct tobii5_made_gaze *gaze)
{
	unsigned char bytes[TOBII5_MADE_MAX];
	fake_usb_deliver(bytes, tobii5_made_gaze(gaze, bytes));
}

static int count_logged(const char *text)
{
	int count = 0;
	for (const char *at = stage.logged; (at = strstr(at, text)); at++)
		count++;
	return count;
}

static void tobii5_is_greeted_and_its_gaze_becomes_samples(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_device_info info;
	for (uint32_t i = 0; i < 50; i++) {
		struct gz_sample sample = device_read_sample(device);
		assert_int_equal(sample.seq, i);
		assert_int_equal(sample.device_ns, (5000000 + i * INT64_C(30270)) * GZ_NS_PER_US);
		assert_true(sample.host_ns <= gz_clock_now_ns());
		assert_int_equal(sample.lost_before, 0);
		assert_true(sample.valid && sample.eye[0].valid && sample.eye[1].valid);
		assert_true(sample.point.x == 0.25f && sample.eye[GZ_EYE_LEFT].point.y == 0.75f);
		assert_true(sample.eye[GZ_EYE_LEFT].origin_mm[0] == -32);
	}
	assert_int_equal(fake_usb.opened, 1);
	assert_int_equal(tracker.hellos, 1);
	assert_int_equal(tracker.area_requests, 1);
	assert_int_equal(tracker.area_sets, 0);
	assert_int_equal(tracker.subscriptions, 1);
	assert_int_equal(tracker.unknown, 0);
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "Tobii Eye Tracker 5");
	assert_true(info.has_display && gz_display_valid(&info.display));
	assert_float_equal(info.display.mm[0], 500, 1e-6);
	assert_float_equal(info.display.mm[1], 300, 1e-6);
	struct gz_device_counters counters = device_counters(device);
	assert_null(counters.trouble);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_DECLARED);
	assert_string_equal(stage.logged, "");
	finish(&device);
	assert_int_equal(fake_usb.closed, 1);
}

/* Programs ask for the display when the device is open, before it is started. */
static void tobii5_display_is_known_when_it_is_open(void **state)
{
	(void)state;
	struct gz_device_info info;
	fake_usb_plug(0x2104, 0x0313);
	for (int late = 0; late < 2; late++) {
		if (late)
			stage_set(&stage, "tobii5.screen_mm", "600 340");
		tracker.late_answers = 3;
		struct gz_device *device = stage_open(&stage, NULL);
		gz_device_get_info(device, &info);
		assert_true(info.has_display);
		assert_float_equal(info.display.mm[0], late ? 600 : 500, 1e-6);
		assert_int_equal(tracker.subscriptions, 0);
		finish(&device);
	}
	assert_int_equal(fake_usb.opened, 2);
	assert_int_equal(fake_usb.closed, 2);
	/* One that does not answer holds nobody for long. */
	tracker.is_mute = true;
	int64_t begin_ns = gz_clock_now_ns();
	struct gz_device *device = stage_open(&stage, NULL);
	assert_in_range(gz_clock_now_ns() - begin_ns, 0, GZ_NS_PER_S + GZ_NS_PER_MS);
	gz_device_get_info(device, &info);
	assert_false(info.has_display);
	assert_int_equal(gz_device_start(device), GZ_OK);
	tracker.is_mute = false;
	assert_true(device_read_sample(device).valid);
	gz_device_get_info(device, &info);
	assert_true(info.has_display);
	finish(&device);
}

static void tobii5_lost_frames_are_counted_by_the_step_of_its_counter(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	for (int i = 0; i < 3; i++)
		device_read_sample(device);
	number += 2;
	assert_int_equal(device_read_sample(device).lost_before, 2);
	assert_int_equal(device_read_sample(device).lost_before, 0);
	number += 0x20000000; /* garbage, or a restart */
	assert_int_equal(device_read_sample(device).lost_before, 0);
	assert_int_equal(device_counters(device).lost, 2);
	finish(&device);
}

static void tobii5_bad_frames_are_counted_by_reason_and_the_stream_continues(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	unsigned char bytes[4096] = { 9 };
	static const unsigned char payload[2000];
	struct tobii5_made_gaze gaze = tobii5_made_looking(0, 0.5, 0.5);
	device_read_sample(device);
	fake_usb_deliver(bytes, 40);               /* no envelope */
	deliver_frame(0x53, 0x500, payload, 1);    /* cut off */
	deliver_frame(0x53, 0x500, payload, 100);  /* no row */
	deliver_frame(0x52, 0x44c, payload, 1480); /* a calibration that nobody asked for */
	fake_usb_fail(LIBUSB_TRANSFER_OVERFLOW);   /* too long */
	deliver_gaze(&gaze);                       /* that of before */
	gaze.time_us -= 1000;
	deliver_gaze(&gaze); /* an earlier one */
	assert_int_equal(device_read_sample(device).seq, 1);
	struct gz_device_counters counters = device_counters(device);
	static const uint64_t expected[GZ_MALFORMED_COUNT] = {
		[GZ_MALFORMED_SHORT] = 1,
		[GZ_MALFORMED_LONG] = 1,
		[GZ_MALFORMED_STALE] = 2,
		[GZ_MALFORMED_SYNTAX] = 2,
	};
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		if (counters.malformed[i] != expected[i])
			fail_msg("%s: %llu, expected %llu", gz_malformed_name(i),
				 (unsigned long long)counters.malformed[i],
				 (unsigned long long)expected[i]);
	finish(&device);
}

static void tobii5_clock_may_leap_by_any_time(void **state)
{
	(void)state;
	static const int64_t times_us[] = { INT64_MIN / 1000 + 1, INT64_MAX / 1000, 0,
					    INT64_MAX / 1000, INT64_MIN / 1000 + 1 };
	struct gz_device *device = start_device();
	int64_t host_ns = device_read_sample(device).host_ns;
	sends = false;
	for (size_t i = 0; i < sizeof times_us / sizeof *times_us; i++) {
		struct tobii5_made_gaze gaze = tobii5_made_looking(0, 0.5, 0.5);
		gaze.time_us = times_us[i];
		deliver_gaze(&gaze);
		struct gz_sample sample = device_read_sample(device);
		assert_int_equal(sample.device_ns, times_us[i] * 1000);
		assert_true(sample.host_ns > host_ns);
		host_ns = sample.host_ns;
	}
	finish(&device);
}

static void tobii5_message_that_is_not_described_is_said_once(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	static const unsigned char payload[40];
	device_read_sample(device);
	for (int i = 0; i < 5; i++) {
		deliver_frame(0x53, 0x50e, payload, sizeof payload);
		device_read_sample(device);
	}
	assert_int_equal(count_logged("not described"), 1);
	stage_expect_logged(&stage, "operation 0x50e");
	finish(&device);
}

static void tobii5_that_does_not_answer_is_in_trouble_and_said_once(void **state)
{
	(void)state;
	struct gz_sample sample;
	tracker.is_mute = true;
	struct gz_device *device = start_device();
	int64_t begin_ns = gz_clock_now_ns();
	while (gz_clock_now_ns() - begin_ns < 20 * GZ_NS_PER_S)
		assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_TIMEOUT);
	assert_non_null(strstr(device_counters(device).trouble, "does not answer"));
	assert_int_equal(count_logged("does not answer"), 1);
	/* It comes round. */
	tracker.is_mute = false;
	assert_true(device_read_sample(device).valid);
	assert_null(device_counters(device).trouble);
	finish(&device);
}

static void tobii5_without_a_display_area_gives_eyes_but_no_points(void **state)
{
	(void)state;
	struct gz_device_info info;
	static const double lost_mm[3][3] = { { -2, 2, 0 }, { 2, 2, 0 }, { -2, -2, 0 } };
	memcpy(tracker.corner_mm, lost_mm, sizeof lost_mm);
	struct gz_device *device = start_device();
	struct gz_sample sample = device_read_sample(device);
	assert_false(sample.valid || sample.eye[0].valid || sample.eye[1].valid);
	assert_true(isnan(sample.point.x) && isnan(sample.eye[GZ_EYE_LEFT].point.x));
	assert_true(sample.eye[GZ_EYE_LEFT].origin_mm[2] == 600);
	assert_non_null(strstr(device_counters(device).trouble, "tobii5.screen_mm"));
	assert_int_equal(count_logged("tobii5.screen_mm"), 1);
	gz_device_get_info(device, &info);
	assert_false(info.has_display);
	finish(&device);
	/* The same if it does not state one. */
	set_up(NULL);
	tracker.hides_area = true;
	device = start_device();
	assert_false(device_read_sample(device).valid);
	assert_non_null(strstr(device_counters(device).trouble, "does not state"));
	finish(&device);
}

static void tobii5_gets_the_configured_display_area(void **state)
{
	(void)state;
	for (int late = 0; late < 4; late++) {
		struct gz_device_info info;
		set_up(NULL);
		stage_set(&stage, "tobii5.screen_mm", "600 340");
		stage_set(&stage, "tobii5.screen_offset_mm", "5 10 -20");
		tracker.late_answers = late;
		struct gz_device *device = start_device();
		assert_true(device_read_sample(device).valid);
		assert_int_equal(tracker.area_sets, 1);
		assert_float_equal(tracker.corner_mm[0][0], -295, 1e-6);
		assert_float_equal(tracker.corner_mm[1][1], 350, 1e-6);
		assert_float_equal(tracker.corner_mm[2][1], 10, 1e-6);
		assert_float_equal(tracker.corner_mm[2][2], -20, 1e-6);
		assert_null(device_counters(device).trouble);
		gz_device_get_info(device, &info);
		assert_float_equal(info.display.mm[0], 600, 1e-6);
		finish(&device);
		/* It keeps it: the next time nothing needs to be set. */
		device = stage_start(&stage);
		device_read_sample(device);
		assert_int_equal(tracker.area_sets, 1);
		finish(&device);
	}
}

static void tobii5_that_keeps_its_display_area_is_in_trouble(void **state)
{
	(void)state;
	stage_set(&stage, "tobii5.screen_mm", "600 340");
	tracker.keeps_area = true;
	struct gz_device *device = start_device();
	device_read_sample(device);
	assert_int_equal(tracker.area_sets, 1);
	assert_int_equal(tracker.area_requests, 1 + GZ_TOBII5_TAKE_TRIES);
	assert_non_null(strstr(device_counters(device).trouble, "does not take"));
	assert_int_equal(count_logged("does not take"), 1);
	finish(&device);
}

static void tobii5_that_falls_silent_is_asked_again_and_then_opened_anew(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	struct gz_sample sample;
	device_read_sample(device);
	sends = false;
	for (int i = 0; i < 15; i++)
		assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(tracker.subscriptions, 2);
	stage_expect_logged(&stage, "silent");
	sends = true;
	device_read_sample(device);
	sends = false;
	int64_t begin_ns = gz_clock_now_ns();
	assert_int_equal(device_read_result(device, &sample), GZ_ERR_NO_DEVICE);
	assert_in_range(gz_clock_now_ns() - begin_ns, 3 * GZ_NS_PER_S, 5 * GZ_NS_PER_S);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	finish(&device);
	assert_int_equal(fake_usb.closed, 1);
}

static void tobii5_stalled_endpoint_is_cleared_even_within_a_frame(void **state)
{
	(void)state;
	struct gz_device *device = start_device();
	unsigned char bytes[TOBII5_MADE_MAX];
	struct tobii5_made_gaze gaze = tobii5_made_looking(1, 0.5, 0.5);
	device_read_sample(device);
	tobii5_made_gaze(&gaze, bytes);
	fake_usb_deliver(bytes, 700);
	fake_usb_fail(LIBUSB_TRANSFER_STALL);
	assert_int_equal(device_read_sample(device).seq, 1);
	assert_int_equal(fake_usb.halts_cleared, 1);
	assert_int_equal(fake_usb.in_flight, GZ_TOBII5_TRANSFERS);
	assert_int_equal(device_counters(device).malformed[GZ_MALFORMED_SHORT], 0);
	stage_expect_logged(&stage, "stalled");
	finish(&device);
}

static void tobii5_that_takes_no_requests_is_said_once(void **state)
{
	(void)state;
	struct gz_sample sample;
	fake_usb.request_status = LIBUSB_TRANSFER_STALL;
	struct gz_device *device = start_device();
	for (int i = 0; i < 50; i++)
		assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(count_logged("does not take requests"), 1);
	fake_usb.request_status = LIBUSB_TRANSFER_COMPLETED;
	device_read_sample(device);
	finish(&device);
}

static void tobii5_unplugged_is_reported_at_any_stage(void **state)
{
	(void)state;
	for (int samples = -1; samples < 3; samples++) {
		struct gz_sample sample;
		set_up(NULL);
		goes_at_request = samples < 0;
		struct gz_device *device = start_device();
		for (int i = 0; i < samples; i++)
			device_read_sample(device);
		fake_usb.unplugged = true;
		assert_int_equal(device_read_result(device, &sample), GZ_ERR_NO_DEVICE);
		finish(&device);
		assert_int_equal(fake_usb.closed, 0);
		fake_usb.unplugged = false;
		device = stage_start(&stage);
		assert_int_equal(device_read_sample(device).seq, 0);
		finish(&device);
	}
}

static void tobii5_that_opens_no_session_is_not_opened(void **state)
{
	(void)state;
	struct gz_device *device;
	fake_usb_plug(0x2104, 0x0313);
	fake_usb.control_error = LIBUSB_ERROR_PIPE;
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_IO);
	stage_expect_logged(&stage, "LIBUSB_ERROR_PIPE");
	expect_released();
	assert_int_equal(fake_usb.closed, 0);
}

static void tobii5_without_firmware_is_listed_and_refused(void **state)
{
	(void)state;
	struct gz_device *device;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	fake_usb_plug(0x2104, 0x0102);
	assert_int_equal(stage_list(&stage, entries), 1);
	assert_false(entries[0].usable);
	assert_non_null(strstr(entries[0].reason, "firmware"));
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_NO_DEVICE);
	assert_int_equal(count_logged("firmware"), 1);
	assert_int_equal(count_logged("plug one in"), 0);
	assert_int_equal(fake_usb.handles + fake_usb.contexts, 0);
}

static void tobii5_relatives_are_found(void **state)
{
	(void)state;
	static const struct {
		uint16_t product;
		const char *name;
	} relatives[] = { { 0x0127, "Tobii Eye Tracker 4C" }, { 0x031e, "Tobii IS5" } };
	struct gz_device *device;
	struct gz_device_info info;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	fake_usb_plug(0x2104, 0x0126);
	for (size_t i = 0; i < 2; i++)
		fake_usb_plug(0x2104, relatives[i].product);
	assert_int_equal(stage_list(&stage, entries), 2);
	for (size_t i = 0; i < 2; i++) {
		assert_string_equal(entries[i].name, relatives[i].name);
		assert_int_equal(stage_create(&stage, relatives[i].name, &device), GZ_OK);
		gz_device_get_info(device, &info);
		assert_string_equal(info.name, relatives[i].name);
		finish(&device);
	}
}

TEST_SUITE(tobii5)
{
#define TEST(name) cmocka_unit_test_setup(name, set_up)
	const struct CMUnitTest tests[] = {
		TEST(tobii5_is_greeted_and_its_gaze_becomes_samples),
		TEST(tobii5_display_is_known_when_it_is_open),
		TEST(tobii5_lost_frames_are_counted_by_the_step_of_its_counter),
		TEST(tobii5_bad_frames_are_counted_by_reason_and_the_stream_continues),
		TEST(tobii5_clock_may_leap_by_any_time),
		TEST(tobii5_message_that_is_not_described_is_said_once),
		TEST(tobii5_that_does_not_answer_is_in_trouble_and_said_once),
		TEST(tobii5_without_a_display_area_gives_eyes_but_no_points),
		TEST(tobii5_gets_the_configured_display_area),
		TEST(tobii5_that_keeps_its_display_area_is_in_trouble),
		TEST(tobii5_that_falls_silent_is_asked_again_and_then_opened_anew),
		TEST(tobii5_stalled_endpoint_is_cleared_even_within_a_frame),
		TEST(tobii5_that_takes_no_requests_is_said_once),
		TEST(tobii5_unplugged_is_reported_at_any_stage),
		TEST(tobii5_that_opens_no_session_is_not_opened),
		TEST(tobii5_without_firmware_is_listed_and_refused),
		TEST(tobii5_relatives_are_found),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
