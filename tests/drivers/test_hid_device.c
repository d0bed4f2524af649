/* The HID driver with fake devices in place of the interface to the system. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/hid/hid_device.h"
#include "hid_made.h"
#include "hid_played.h"

static struct driver_stage stage;

static int set_up(void **state)
{
	(void)state;
	hid_played_reset();
	stage_reset(&stage, "hid");
	return 0;
}

static struct gz_hid_settings *settings(void)
{
	return (struct gz_hid_settings *)(void *)stage.settings;
}

/* Plug in a tracker that answers all requests. */
static int plug(enum hid_layout layout, const char *name, const char *serial)
{
	struct hid_made made = { 0 };
	unsigned char bytes[64];
	hid_made_tracker(&made, layout);
	int number = hid_played_plug(name, serial, made.bytes, made.size);
	if (layout == HID_LAYOUT_GAZE_ONLY)
		return number;
	size_t size = hid_made_configuration(layout, 500000, 300000, bytes);
	hid_played_set_feature(number, bytes[0], bytes, size);
	size = hid_made_capabilities(layout, 50000, 65000, 90000, bytes);
	hid_played_set_feature(number, bytes[0], bytes, size);
	size = hid_made_status(layout, GZ_HID_STATE_READY, 120, bytes);
	hid_played_set_feature(number, bytes[0], bytes, size);
	size = hid_made_control(layout, 0, bytes);
	hid_played_set_feature(number, bytes[0], bytes, size);
	return number;
}

static enum gz_result create_chosen(const char *choice, const double display_mm[2],
				    struct gz_device **out_device)
{
	if (display_mm)
		memcpy(stage.host.display_mm, display_mm, sizeof stage.host.display_mm);
	return stage_create(&stage, choice, out_device);
}

static struct gz_device *open_device(void)
{
	return stage_start(&stage);
}

static void expect_told(const char *text)
{
	stage_expect_logged(&stage, text);
}

static void send_sample(int number, enum hid_layout layout, const struct hid_made_sample *sample)
{
	unsigned char bytes[128];
	size_t size = hid_made_report(layout, sample, bytes);
	assert_true(hid_played_send(number, bytes, size));
}

static void expect_near(double value, double expected, double tolerance)
{
	if (!(fabs(value - expected) <= tolerance))
		fail_msg("%.9g, expected %.9g", value, expected);
}

static const struct hid_made_sample looked = {
	.time_us = 5000000,
	.gaze = { 125000, 225000 },
	.left = { 220000, 100000, 600000 },
	.right = { 280000, 100000, 600000 },
};

static void hid_sample_holds_the_gaze_and_both_eyes_in_every_layout(void **state)
{
	(void)state;
	for (int layout = HID_LAYOUT_REFERENCE; layout <= HID_LAYOUT_TIME64; layout++) {
		hid_played_reset();
		int number = plug(layout, "Made", "7");
		struct gz_device *device = open_device();
		send_sample(number, layout, &looked);
		struct gz_sample sample = device_read_sample(device);
		assert_true(sample.valid);
		assert_int_equal(sample.device_ns, INT64_C(5000000000));
		expect_near(sample.point.x, 0.25, 1e-6);
		expect_near(sample.point.y, 0.75, 1e-6);
		const struct gz_eye_sample *left = &sample.eye[GZ_EYE_LEFT];
		assert_true(left->valid && sample.eye[GZ_EYE_RIGHT].valid);
		expect_near(left->point.x, 0.25, 1e-6);
		expect_near(left->origin_mm[0], 220, 1e-4);
		expect_near(left->origin_mm[2], 600, 1e-4);
		expect_near(sample.eye[GZ_EYE_RIGHT].origin_mm[0], 280, 1e-4);
		/* From the eye towards the screen: down and to the left here. */
		double length = sqrt(95.0 * 95 + 125.0 * 125 + 600.0 * 600);
		expect_near(left->direction[0], -95 / length, 1e-6);
		expect_near(left->direction[1], 125 / length, 1e-6);
		expect_near(left->direction[2], -600 / length, 1e-6);
		assert_true(isnan(left->pupil_mm) && isnan(left->confidence));
		gz_device_destroy(&device);
	}
}

static void hid_tracker_with_only_a_gaze_point_measures_no_eye(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_GAZE_ONLY, "Plain", "");
	struct gz_device *device = NULL;
	const double display_mm[2] = { 250, 450 };
	assert_int_equal(create_chosen(NULL, display_mm, &device), GZ_OK);
	assert_int_equal(gz_device_start(device), GZ_OK);
	send_sample(number, HID_LAYOUT_GAZE_ONLY, &looked);
	struct gz_sample sample = device_read_sample(device);
	assert_true(sample.valid && gz_sample_combined_only(&sample));
	expect_near(sample.point.x, 0.5, 1e-6);
	expect_near(sample.point.y, 0.5, 1e-6);
	assert_int_equal(hid_played_times_set(number), 0);
	gz_device_destroy(&device);
}

static void hid_eye_that_is_not_seen_is_not_measured(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct hid_made_sample sent = looked;
	memset(sent.right, 0, sizeof sent.right);
	send_sample(number, HID_LAYOUT_REFERENCE, &sent);
	struct gz_sample sample = device_read_sample(device);
	assert_true(sample.valid && sample.eye[GZ_EYE_LEFT].valid);
	assert_false(sample.eye[GZ_EYE_RIGHT].valid);
	assert_true(isnan(sample.eye[GZ_EYE_RIGHT].point.x) &&
		    isnan(sample.eye[GZ_EYE_RIGHT].origin_mm[0]));
	gz_device_destroy(&device);
}

static void hid_device_is_identified(void **state)
{
	(void)state;
	plug(HID_LAYOUT_PADDED, "Made Eyes", "A12");
	struct gz_device *device = open_device();
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "Made Eyes");
	assert_string_equal(info.serial, "A12");
	expect_near(info.rate_hz, 120, 0);
	assert_true(info.has_display && gz_display_valid(&info.display));
	expect_near(info.display.mm[0], 500, 1e-6);
	expect_near(info.display.mm[1], 300, 1e-6);
	/* It reports 65 mm, but means 650. */
	expect_near(info.display.distance_mm, 650, 1e-6);
	expect_told("a tenth of its viewing distance");
	gz_device_destroy(&device);
}

static void hid_mode_is_requested_at_start_and_restored_at_the_end(void **state)
{
	(void)state;
	unsigned char bytes[HID_PLAYED_FEATURE_SIZE];
	const bool wants_eyes[] = { true, false };
	for (int i = 0; i < 2; i++) {
		hid_played_reset();
		int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
		hid_played_set_feature(number, 0x14, (const unsigned char[]) { 0x14, 4 }, 2);
		settings()->eye_positions = wants_eyes[i];
		struct gz_device *device = open_device();
		assert_int_equal(hid_played_get_feature(number, 0x14, bytes), 2);
		assert_int_equal(bytes[1], wants_eyes[i] ? 3 : 1);
		gz_device_destroy(&device);
		assert_int_equal(hid_played_get_feature(number, 0x14, bytes), 2);
		assert_int_equal(bytes[1], 4);
		assert_int_equal(hid_played_times_set(number), 2);
	}
}

static void hid_mode_is_set_again_after_a_suspend(void **state)
{
	(void)state;
	unsigned char bytes[HID_PLAYED_FEATURE_SIZE];
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct gz_sample sample;
	gz_device_read(device, 0, &sample);
	assert_int_equal(hid_played_times_set(number), 1);
	/* The device has lost power during a second of sleep that has not been noticed yet. */
	struct gz_hid_device *hid = (struct gz_hid_device *)device;
	hid_played_set_feature(number, 0x14, (const unsigned char[]) { 0x14, 0 }, 2);
	hid->suspended_ns -= GZ_NS_PER_S;
	hid->look_after_ns = 0;
	gz_device_read(device, 0, &sample);
	hid_played_get_feature(number, 0x14, bytes);
	assert_int_equal(bytes[1], 3);
	expect_told("suspended");
	gz_device_destroy(&device);
	hid_played_get_feature(number, 0x14, bytes);
	assert_int_equal(bytes[1], 0);
}

static void hid_device_that_refuses_its_mode_is_still_read(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	hid_played_set_feature(number, 0x14, (const unsigned char[]) { 0 }, 0);
	struct gz_device *device = open_device();
	expect_told("rejects the request");
	send_sample(number, HID_LAYOUT_REFERENCE, &looked);
	assert_true(device_read_sample(device).valid);
	gz_device_destroy(&device);
}

static void hid_screen_comes_from_the_user_then_the_device_then_the_display(void **state)
{
	(void)state;
	static const struct {
		int32_t stated_um; /* width; the height is 0.6 of it */
		double set_mm, display_mm, expected_mm;
		const char *told;
	} cases[] = {
		{ 500000, 0, 0, 500, "" },
		{ 500000, 400, 0, 400, "" },
		{ 500000, 0, 400, 500, "calibrated to a screen of" },
		{ 0, 0, 400, 400, "impossible screen size" },
		{ 50000000, 0, 400, 400, "impossible screen size" },
		{ 0, 0, 0, 0, "is unknown" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		unsigned char bytes[64];
		struct gz_device *device = NULL;
		struct gz_device_info info;
		const double display_mm[2] = { cases[i].display_mm, cases[i].display_mm * 0.6 };
		set_up(NULL);
		settings()->screen_mm[0] = cases[i].set_mm;
		settings()->screen_mm[1] = cases[i].set_mm * 0.6;
		int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
		size_t size = hid_made_configuration(HID_LAYOUT_REFERENCE, cases[i].stated_um,
						     cases[i].stated_um * 3 / 5, bytes);
		hid_played_set_feature(number, bytes[0], bytes, size);
		assert_int_equal(create_chosen(NULL, display_mm, &device), GZ_OK);
		gz_device_get_info(device, &info);
		assert_int_equal(info.has_display, cases[i].expected_mm > 0);
		if (info.has_display)
			expect_near(info.display.mm[0], cases[i].expected_mm, 1e-6);
		expect_told(cases[i].told);
		gz_device_destroy(&device);
	}
}

static void hid_gaze_on_a_screen_of_unknown_size_is_not_valid(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	hid_played_set_feature(number, 0x12, (const unsigned char[]) { 0 }, 0);
	struct gz_device *device = open_device();
	send_sample(number, HID_LAYOUT_REFERENCE, &looked);
	struct gz_sample sample = device_read_sample(device);
	assert_false(sample.valid || sample.eye[GZ_EYE_LEFT].valid);
	assert_true(isnan(sample.point.x));
	expect_near(sample.eye[GZ_EYE_LEFT].origin_mm[0], 220, 1e-4);
	assert_non_null(strstr(device_counters(device).trouble, "display.mm"));
	gz_device_destroy(&device);
}

static void hid_trouble_follows_the_status_report(void **state)
{
	(void)state;
	static const struct {
		unsigned status;
		const char *trouble; /* NULL: no trouble */
	} cases[] = {
		{ GZ_HID_STATE_CONFIGURING, "configured" },
		{ GZ_HID_STATE_SCREEN_SETUP, "set it up for its screen" },
		{ GZ_HID_STATE_USER_CALIBRATION, "calibrate it for the user" },
		{ GZ_HID_STATE_READY, NULL },
	};
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct gz_sample sample;
	assert_non_null(strstr(device_counters(device).trouble, "sent nothing"));
	send_sample(number, HID_LAYOUT_REFERENCE, &looked);
	device_read_sample(device);
	assert_null(device_counters(device).trouble);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		unsigned char bytes[64];
		size_t size = hid_made_status(HID_LAYOUT_REFERENCE, cases[i].status, 240, bytes);
		assert_true(hid_played_send(number, bytes, size));
		/* A status report brings no sample; a filler may come. */
		assert_int_not_equal(gz_device_read(device, 20, &sample), GZ_ERR_NO_DEVICE);
		const char *trouble = device_counters(device).trouble;
		if (cases[i].trouble)
			assert_true(trouble && strstr(trouble, cases[i].trouble));
		else
			assert_null(trouble);
	}
	struct gz_device_info info;
	gz_device_get_info(device, &info);
	expect_near(info.rate_hz, 240, 0);
	gz_device_destroy(&device);
}

static void hid_device_set_up_for_another_screen_is_reopened(void **state)
{
	(void)state;
	unsigned char bytes[64];
	struct gz_sample sample;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	size_t size = hid_made_status(HID_LAYOUT_REFERENCE, GZ_HID_STATE_CONFIGURING, 120, bytes);
	hid_played_send(number, bytes, size);
	assert_int_equal(gz_device_read(device, 20, &sample), GZ_ERR_TIMEOUT);
	size = hid_made_configuration(HID_LAYOUT_REFERENCE, 600000, 340000, bytes);
	hid_played_set_feature(number, bytes[0], bytes, size);
	size = hid_made_status(HID_LAYOUT_REFERENCE, GZ_HID_STATE_READY, 120, bytes);
	hid_played_send(number, bytes, size);
	assert_int_equal(gz_device_read(device, 20, &sample), GZ_ERR_TIMEOUT);
	((struct gz_hid_device *)device)->look_after_ns = 0; /* half a second later */
	assert_int_equal(gz_device_read(device, 20, &sample), GZ_ERR_NO_DEVICE);
	expect_told("reopening it");
	gz_device_destroy(&device);
	struct gz_device_info info;
	device = open_device();
	gz_device_get_info(device, &info);
	expect_near(info.display.mm[0], 600, 1e-6);
	gz_device_destroy(&device);
}

static void hid_bad_reports_are_counted_by_their_reason(void **state)
{
	(void)state;
	unsigned char bytes[160];
	struct gz_sample sample;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct hid_made_sample sent = looked;
	size_t size = hid_made_report(HID_LAYOUT_REFERENCE, &sent, bytes);
	assert_true(hid_played_send(number, bytes, size));
	device_read_sample(device);
	((struct gz_hid_device *)device)->clock.settled = true;
	assert_true(hid_played_send(number, bytes, size));     /* the same again */
	assert_true(hid_played_send(number, bytes, size - 1)); /* short */
	assert_true(hid_played_send(number, bytes, size + 1)); /* long */
	assert_true(hid_played_send(number, bytes, sizeof bytes));
	bytes[0] = 0x77; /* an undeclared ID */
	assert_true(hid_played_send(number, bytes, size));
	sent.gaze[0] = 2000001;
	send_sample(number, HID_LAYOUT_REFERENCE, &sent);
	sent.gaze[0] = 0;
	sent.time_us++;
	send_sample(number, HID_LAYOUT_REFERENCE, &sent);
	do
		sample = device_read_sample(device);
	while (!sample.valid);
	expect_near(sample.point.x, 0, 0);
	struct gz_device_counters counters = device_counters(device);
	assert_int_equal(counters.malformed[GZ_MALFORMED_STALE], 1);
	assert_int_equal(counters.malformed[GZ_MALFORMED_SHORT], 1);
	assert_int_equal(counters.malformed[GZ_MALFORMED_LONG], 2);
	assert_int_equal(counters.malformed[GZ_MALFORMED_SYNTAX], 1);
	assert_int_equal(counters.malformed[GZ_MALFORMED_VALUE], 1);
	expect_told("device bug");
	gz_device_destroy(&device);
}

static void hid_tracker_that_never_sets_its_time_is_still_read(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct hid_made_sample sent = looked;
	sent.time_us = 0;
	int64_t last_ns = 0;
	for (int i = 0; i < 50; i++) {
		send_sample(number, HID_LAYOUT_REFERENCE, &sent);
		struct gz_sample sample = device_read_sample(device);
		assert_true(sample.valid && sample.host_ns > last_ns);
		last_ns = sample.host_ns;
	}
	assert_int_equal(device_counters(device).malformed[GZ_MALFORMED_STALE], 0);
	gz_device_destroy(&device);
}

static void hid_endless_garbage_keeps_to_the_timeout(void **state)
{
	(void)state;
	struct gz_sample sample;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	for (int i = 0; i < 100; i++)
		assert_true(hid_played_send(number, (const unsigned char *)"garbage", 7));
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_TIMEOUT);
	for (int i = 0; i < 100; i++)
		assert_int_equal(gz_device_read(device, 1, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(device_counters(device).malformed[GZ_MALFORMED_SYNTAX], 100);
	gz_device_destroy(&device);
}

static void hid_silence_is_filled_in_and_time_continues(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct hid_made_sample sent = looked;
	struct gz_sample sample, last = { 0 };
	/* A burst, as after a stall, is read before silence is filled in. */
	for (int i = 0; i < 20; i++, sent.time_us += 8333)
		send_sample(number, HID_LAYOUT_REFERENCE, &sent);
	for (uint64_t i = 0; i < 20; i++) {
		sample = device_read_sample(device);
		assert_true(sample.valid && sample.seq == i);
		assert_true(i == 0 || sample.host_ns > last.host_ns);
		last = sample;
	}
	for (uint64_t i = 20; i < 30; i++) {
		sample = device_read_sample(device);
		assert_false(sample.valid || sample.eye[0].valid || sample.eye[1].valid);
		assert_true(isnan(sample.point.x) && sample.device_ns == GZ_NO_DEVICE_TIME);
		assert_true(sample.seq == i && sample.host_ns > last.host_ns &&
			    sample.host_ns <= gz_clock_now_ns());
		last = sample;
	}
	send_sample(number, HID_LAYOUT_REFERENCE, &sent);
	do
		sample = device_read_sample(device);
	while (!sample.valid);
	assert_true(sample.host_ns > last.host_ns && sample.seq > last.seq);
	gz_device_destroy(&device);
}

static void hid_unplugged_is_gone(void **state)
{
	(void)state;
	int number = plug(HID_LAYOUT_REFERENCE, "Made", "");
	struct gz_device *device = open_device();
	struct gz_sample sample;
	send_sample(number, HID_LAYOUT_REFERENCE, &looked);
	device_read_sample(device);
	hid_played_unplug(number);
	enum gz_result result;
	do
		result = gz_device_read(device, 1000, &sample);
	while (result == GZ_OK);
	assert_int_equal(result, GZ_ERR_NO_DEVICE);
	gz_device_destroy(&device);
	assert_int_equal(create_chosen(NULL, NULL, &device), GZ_ERR_NO_DEVICE);
	plug(HID_LAYOUT_REFERENCE, "Made", "");
	device = open_device();
	gz_device_destroy(&device);
}

static void hid_devices_are_listed_with_the_reason_if_not_usable(void **state)
{
	(void)state;
	struct hid_made mouse = { 0 }, malformed = { 0 }, two = { 0 };
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	assert_int_equal(stage_list(&stage, entries), 0);
	HID_ITEMS(&mouse, HID_PAGE, 1, HID_USAGE, 2, HID_COLLECTION, 1, HID_END, 0);
	hid_played_plug("Mouse", "", mouse.bytes, mouse.size);
	hid_made_tracker(&malformed, HID_LAYOUT_REFERENCE);
	hid_played_plug("Broken", "", malformed.bytes, malformed.size - 1);
	hid_made_tracker(&two, HID_LAYOUT_REFERENCE);
	hid_made_tracker(&two, HID_LAYOUT_TIME64);
	hid_played_plug("Two", "2", two.bytes, two.size);
	int locked = plug(HID_LAYOUT_PADDED, "Locked", "9");
	hid_played_set_access(locked, GZ_ERR_ACCESS);
	assert_int_equal(stage_list(&stage, entries), 4);
	assert_string_equal(entries[0].name, "Broken");
	assert_false(entries[0].usable);
	assert_non_null(strstr(entries[0].reason, "not closed"));
	assert_string_equal(entries[1].name, "Two");
	assert_true(entries[1].usable);
	assert_string_equal(entries[1].reason, "");
	assert_string_equal(entries[2].name, "Two #2");
	assert_true(entries[2].usable);
	assert_string_equal(entries[3].name, "Locked");
	assert_string_equal(entries[3].serial, "9");
	assert_string_equal(entries[3].place, "/played/3");
	assert_false(entries[3].usable);
	assert_non_null(strstr(entries[3].reason, "71-gazecast.rules"));
}

static void hid_device_is_chosen_by_name_serial_or_place(void **state)
{
	(void)state;
	struct hid_made two = { 0 };
	struct gz_device *device = NULL;
	struct gz_device_info info;
	hid_made_tracker(&two, HID_LAYOUT_REFERENCE);
	hid_made_tracker(&two, HID_LAYOUT_TIME64);
	plug(HID_LAYOUT_REFERENCE, "One", "11");
	hid_played_plug("Two", "22", two.bytes, two.size);
	plug(HID_LAYOUT_PADDED, "Locked", "33");
	hid_played_set_access(2, GZ_ERR_ACCESS);
	static const struct {
		const char *choice, *name;
	} cases[] = { { NULL, "One" },       { "", "One" },   { "Two", "Two" },
		      { "22", "Two" },       { "11", "One" }, { "Two #2", "Two #2" },
		      { "/played/1", "Two" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		assert_int_equal(create_chosen(cases[i].choice, NULL, &device), GZ_OK);
		gz_device_get_info(device, &info);
		assert_string_equal(info.name, cases[i].name);
		gz_device_destroy(&device);
	}
	assert_int_equal(create_chosen("Locked", NULL, &device), GZ_ERR_ACCESS);
	expect_told("71-gazecast.rules");
	assert_int_equal(create_chosen("44", NULL, &device), GZ_ERR_NO_DEVICE);
	expect_told("44");
	assert_null(device);
	/* A locked device does not prevent the use of another one. */
	hid_played_set_access(0, GZ_ERR_ACCESS);
	assert_int_equal(create_chosen(NULL, NULL, &device), GZ_OK);
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "Two");
	gz_device_destroy(&device);
}

static void hid_second_tracker_of_a_device_is_read_alone(void **state)
{
	(void)state;
	struct hid_made two = { 0 };
	struct gz_device *device = NULL;
	struct gz_sample sample;
	const double display_mm[2] = { 500, 300 };
	hid_made_tracker(&two, HID_LAYOUT_REFERENCE);
	hid_made_tracker(&two, HID_LAYOUT_TIME64);
	int number = hid_played_plug("Two", "22", two.bytes, two.size);
	assert_int_equal(create_chosen("Two #2", display_mm, &device), GZ_OK);
	send_sample(number, HID_LAYOUT_REFERENCE, &looked);
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_TIMEOUT);
	send_sample(number, HID_LAYOUT_TIME64, &looked);
	sample = device_read_sample(device);
	assert_true(sample.valid);
	expect_near(sample.point.y, 0.75, 1e-6);
	gz_device_destroy(&device);
}

TEST_SUITE(hid_device)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(hid_sample_holds_the_gaze_and_both_eyes_in_every_layout,
				       set_up),
		cmocka_unit_test_setup(hid_tracker_with_only_a_gaze_point_measures_no_eye, set_up),
		cmocka_unit_test_setup(hid_eye_that_is_not_seen_is_not_measured, set_up),
		cmocka_unit_test_setup(hid_device_is_identified, set_up),
		cmocka_unit_test_setup(hid_mode_is_requested_at_start_and_restored_at_the_end,
				       set_up),
		cmocka_unit_test_setup(hid_mode_is_set_again_after_a_suspend, set_up),
		cmocka_unit_test_setup(hid_device_that_refuses_its_mode_is_still_read, set_up),
		cmocka_unit_test_setup(
			hid_screen_comes_from_the_user_then_the_device_then_the_display, set_up),
		cmocka_unit_test_setup(hid_gaze_on_a_screen_of_unknown_size_is_not_valid, set_up),
		cmocka_unit_test_setup(hid_trouble_follows_the_status_report, set_up),
		cmocka_unit_test_setup(hid_device_set_up_for_another_screen_is_reopened, set_up),
		cmocka_unit_test_setup(hid_bad_reports_are_counted_by_their_reason, set_up),
		cmocka_unit_test_setup(hid_tracker_that_never_sets_its_time_is_still_read, set_up),
		cmocka_unit_test_setup(hid_endless_garbage_keeps_to_the_timeout, set_up),
		cmocka_unit_test_setup(hid_silence_is_filled_in_and_time_continues, set_up),
		cmocka_unit_test_setup(hid_unplugged_is_gone, set_up),
		cmocka_unit_test_setup(hid_devices_are_listed_with_the_reason_if_not_usable,
				       set_up),
		cmocka_unit_test_setup(hid_device_is_chosen_by_name_serial_or_place, set_up),
		cmocka_unit_test_setup(hid_second_tracker_of_a_device_is_read_alone, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
