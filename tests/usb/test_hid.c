/* HID eye trackers of several makers and the daemon: whatever their descriptors look like, what
 * they see arrives, and whatever they do, the stream goes on. */
#include "check.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "guest.h"
#include "hid_function.h"
#include "hid_gadget.h"
#include "lab.h"
#include "recorded.h"

static struct lab lab;
static struct hid_gadget tracker;
static struct hid_function function;

static const struct lab_truth truth = {
	.stream = &tracker.stream,
	.has_clock = true,
	.tolerance = 1e-4,
};

static const struct lab_truth function_truth = {
	.stream = &function.stream,
	.has_clock = true,
	.tolerance = 1e-4,
};

static int set_up(void **state)
{
	(void)state;
	lab_open(&lab);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	lab_close(&lab);
	hid_gadget_remove(&tracker);
	hid_function_remove(&function);
	return 0;
}

static void plug_in(const struct hid_layout *layout)
{
	hid_gadget_plug(&tracker, 0, layout, "GazeLab 200", "GL-7");
	made_stream_start(&tracker.stream);
}

static void start_daemon(void)
{
	LAB_START(&lab, "--driver", "hid", LAB_SCREEN);
}

static bool clock_is_judged(const struct lab *now)
{
	return now->reader.status.clock.tick != GZ_CLOCK_NONE;
}

static void check_eye(const struct gz_gaze_eye *eye, const double expected_mm[3])
{
	assert_true(eye->valid);
	for (size_t i = 0; i < 3; i++) {
		if (!(fabs(eye->origin_mm[i] - expected_mm[i]) < 0.1))
			fail_msg("an eye's coordinate %zu is %f mm, was sent as %f", i,
				 (double)eye->origin_mm[i], expected_mm[i]);
	}
}

static void tracker_of_this_layout_is_understood(void **state)
{
	const struct hid_layout *layout = *state;
	const double left_mm[3] = HID_LEFT_EYE_MM, right_mm[3] = HID_RIGHT_EYE_MM;
	struct lab_truth what = truth;
	what.has_clock = layout->device_tick_us > 0;
	what.tolerance = layout->device_tick_us > 1 ? 4e-4 : 1e-4; /* 0.1 mm, or less */
	plug_in(layout);
	start_daemon();
	lab_compare(&lab, &what, 200);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "GazeLab 200");
	assert_string_equal(lab.reader.status.tracker.serial, "GL-7");
	assert_int_equal(lab.gaze.combined, !layout->has_eyes);
	if (layout->has_eyes) {
		check_eye(&lab.gaze.eye[GZ_EYE_LEFT], left_mm);
		check_eye(&lab.gaze.eye[GZ_EYE_RIGHT], right_mm);
	}
	if (what.has_clock) {
		lab_wait(&lab, clock_is_judged, "judgement of its clock");
		assert_int_equal(lab.reader.status.clock.tick, GZ_CLOCK_DECLARED);
	}
	assert_int_equal(lab.reader.status.malformed[GZ_MALFORMED_VALUE], 0);
	lab_stop(&lab);
}

static void tracker_tells_its_screen_and_rate_and_is_told_what_to_send(void **state)
{
	(void)state;
	function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	hid_function_plug(&function, 0, "GazeLab Pro", "GP-1");
	made_stream_start(&function.stream);
	LAB_START(&lab, "--driver", "hid");
	lab_compare(&lab, &function_truth, 100);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	const struct gz_status *status = &lab.reader.status;
	assert_true(fabs(status->display.mm[0] - 500) < 0.01);
	assert_true(fabs(status->display.mm[1] - 300) < 0.01);
	assert_true(status->rate_hz_nominal == MADE_RATE_HZ);
	assert_int_equal(function.mode, 3); /* gaze point and eye positions */
	assert_true(function.feature_reads >= 3);
	lab_stop(&lab);
	guest_wait_for_count(&function.mode_requests, 2);
	assert_int_equal(function.mode, 4); /* as it was */
}

static void tracker_that_answers_no_feature_request_streams_all_the_same(void **state)
{
	(void)state;
	function = (struct hid_function) { .refuses_features = true };
	hid_function_plug(&function, 0, "GazeLab Mute", "GM-1");
	made_stream_start(&function.stream);
	start_daemon();
	lab_compare(&lab, &function_truth, 100);
	lab_expect_said(&lab, "does not take the request");
	lab_stop(&lab);
}

static void tracker_may_come_go_and_come_again_at_any_time(void **state)
{
	(void)state;
	start_daemon();
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	print_message("           without: %s\n", lab.reader.status.tracker.reason);
	int64_t plugged_ns = gz_clock_now_ns();
	plug_in(&hid_layout_reference);
	lab_compare(&lab, &truth, 1);
	print_message("           first gaze %.1f s after the plug\n",
		      gz_ns_to_s(gz_clock_now_ns() - plugged_ns));
	assert_string_equal(gazed_request(&lab.place, "R replug", NULL), "OK");
	lab_compare(&lab, &truth, 50);
	for (int i = 0; i < 2; i++) {
		uint64_t last_seq = lab.gaze.seq;
		gadget_unplug(&tracker.gadget);
		lab_wait_state(&lab, GZ_TRACKER_LOST);
		gadget_plug(&tracker.gadget);
		lab_wait_state(&lab, GZ_TRACKER_RUNNING);
		lab_compare(&lab, &truth, 50);
		assert_true(lab.gaze.seq > last_seq);
	}
	assert_string_equal(gazed_request(&lab.place, "r", NULL), "OK");
	lab_stop(&lab);
	struct recorded found = recorded_read(lab.place.recordings, "replug.gzl");
	print_message("           recorded %d samples; %d outages, and %d samples lost otherwise\n",
		      (int)found.samples, (int)found.outages, (int)found.missing);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.backwards, 0);
	assert_true(found.outages >= 2); /* more, where the machine held it up for a second */
}

/* Noise may be well formed: its times and points are what it is, and a clock that leapt is found to
 * have leapt back only after a while. */
static void wait_for_truth(void)
{
	int good = 0;
	while (good < 50) {
		lab_next_gaze(&lab);
		struct made_sample sample = made_gaze_at(lab.gaze.device_ns);
		if (fabs(lab.gaze.raw.x - sample.x) < 1e-3)
			good++;
		else if (lab.gaze.device_ns != GZ_NO_DEVICE_TIME)
			good = 0;
	}
}

static void reports_that_cannot_be_are_counted_and_the_stream_goes_on(void **state)
{
	(void)state;
	uint8_t report[HID_REPORT_MAX] = { 0 };
	struct made_sample sample = made_gaze(1);
	plug_in(&hid_layout_reference);
	start_daemon();
	lab_compare(&lab, &truth, 50);
	made_stream_stop(&tracker.stream);
	/* Of the three, newer kernels hand on the second one alone. */
	for (uint8_t i = 0; i < 3; i++) {
		hid_layout_reference.encode(&sample, report);
		hid_gadget_send(&tracker, report, 10);
		report[1] = i;
		memset(report + 9, 0x7F, 8); /* kilometres away */
		hid_gadget_send(&tracker, report, hid_layout_reference.report_size);
		report[0] = 0x77; /* an ID that it does not describe */
		hid_gadget_send(&tracker, report, hid_layout_reference.report_size);
	}
	made_stream_start(&tracker.stream);
	lab_wait_malformed(&lab, GZ_MALFORMED_VALUE, 3);
	lab_compare(&lab, &truth, 100);
	made_stream_stop(&tracker.stream);
	for (int i = 0; i < 200; i++) {
		for (size_t byte = 0; byte < hid_layout_reference.report_size; byte++)
			report[byte] = (uint8_t)rand();
		report[0] = i % 2 ? 0x10 : report[0];
		hid_gadget_send(&tracker, report, hid_layout_reference.report_size);
	}
	made_stream_start(&tracker.stream);
	wait_for_truth();
	lab_compare(&lab, &truth, 100);
	lab_stop(&lab);
}

static void report_longer_than_described_does_no_harm(void **state)
{
	(void)state;
	uint8_t report[HID_REPORT_MAX] = { 0 };
	struct made_sample sample = made_gaze(1);
	function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	hid_function_plug(&function, 0, "GazeLab Long", "GO-1");
	made_stream_start(&function.stream);
	start_daemon();
	lab_compare(&lab, &function_truth, 50);
	made_stream_stop(&function.stream);
	hid_layout_reference.encode(&sample, report);
	functionfs_send(&function.function, report, sizeof report);
	made_stream_start(&function.stream);
	lab_compare(&lab, &function_truth, 100);
	lab_stop(&lab);
}

static void stalled_endpoint_is_brought_back(void **state)
{
	(void)state;
	function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	hid_function_plug(&function, 0, "GazeLab Stall", "GS-1");
	made_stream_start(&function.stream);
	start_daemon();
	lab_compare(&lab, &function_truth, 50);
	made_stream_stop(&function.stream);
	functionfs_stall(&function.function);
	made_stream_start(&function.stream);
	int64_t begin_ns = gz_clock_now_ns();
	lab_compare(&lab, &function_truth, 50);
	print_message("           50 samples %.2f s after the stall\n",
		      gz_ns_to_s(gz_clock_now_ns() - begin_ns));
	lab_stop(&lab);
}

static bool is_blink(const struct lab *now)
{
	return now->gaze.event == GZ_EVENT_BLINK;
}

static bool is_lost(const struct lab *now)
{
	return now->gaze.event == GZ_EVENT_LOST;
}

static bool is_seen(const struct lab *now)
{
	return now->gaze.confidence > 0;
}

/* The class sends nothing while it sees no eye. */
static void tracker_that_falls_silent_blinks_and_is_lost_until_it_goes_on(void **state)
{
	(void)state;
	plug_in(&hid_layout_reference);
	start_daemon();
	lab_compare(&lab, &truth, 100);
	made_stream_stop(&tracker.stream);
	lab_wait(&lab, is_blink, "a blink");
	lab_wait(&lab, is_lost, "loss of the eyes");
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	assert_int_equal(lab.gaze.device_ns, GZ_NO_DEVICE_TIME);
	made_stream_start(&tracker.stream);
	lab_wait(&lab, is_seen, "its gaze");
	lab_compare(&lab, &truth, 50);
	assert_int_equal(lab.reader.status.lost, 0);
	lab_stop(&lab);
}

static bool is_uncalibrated(const struct lab *now)
{
	return strstr(now->reader.status.tracker.reason, "calibrated for the user") != NULL;
}

static bool is_well(const struct lab *now)
{
	return now->reader.status.tracker.reason[0] == '\0';
}

static void tracker_that_tells_its_trouble_is_told_in_the_status(void **state)
{
	(void)state;
	static const unsigned char uncalibrated[] = { 0x13, 4, 100, 0 },
				   ready[] = { 0x13, 1, 100, 0 };
	plug_in(&hid_layout_reference);
	start_daemon();
	lab_compare(&lab, &truth, 20);
	lab_wait(&lab, is_well, "a status without trouble");
	made_stream_stop(&tracker.stream);
	hid_gadget_send(&tracker, uncalibrated, sizeof uncalibrated);
	lab_wait(&lab, is_uncalibrated, "a status that names the trouble");
	hid_gadget_send(&tracker, ready, sizeof ready);
	lab_wait(&lab, is_well, "a status without trouble");
	made_stream_start(&tracker.stream);
	lab_wait(&lab, is_seen, "its gaze");
	lab_compare(&lab, &truth, 20);
	lab_stop(&lab);
}

static void tracker_whose_clock_runs_on_in_suspend_is_timed_right_afterwards(void **state)
{
	(void)state;
	plug_in(&hid_layout_reference);
	start_daemon();
	assert_string_equal(gazed_request(&lab.place, "R nap", NULL), "OK");
	lab_compare(&lab, &truth, 300);
	uint64_t last_seq = lab.gaze.seq;
	int64_t offset_ns = lab.gaze.host_ns - lab.gaze.device_ns;
	int64_t slept_ns = guest_suspend();
	/* What was on its way then is compared with a clock that has stood still since. */
	for (int i = 0; i < 50; i++)
		lab_next_gaze(&lab);
	lab_compare(&lab, &truth, 100);
	int64_t moved_ns = lab.gaze.host_ns - lab.gaze.device_ns - offset_ns;
	print_message("           asleep for %.3f s, the clocks moved by %.3f s\n",
		      gz_ns_to_s(slept_ns), gz_ns_to_s(moved_ns));
	assert_true(lab.gaze.seq > last_seq);
	assert_true(llabs(moved_ns + slept_ns) < 500 * GZ_NS_PER_MS);
	/* Its fit begins again, by the sleep or by the jump, whichever is seen first. */
	lab_expect_said(&lab, "the machine slept");
	assert_string_equal(gazed_request(&lab.place, "r", NULL), "OK");
	lab_stop(&lab);
	struct recorded found = recorded_read(lab.place.recordings, "nap.gzl");
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.backwards, 0);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)
#define LAYOUT(layout)                                                                        \
	{                                                                                     \
		"tracker_of_" #layout "_is_understood", tracker_of_this_layout_is_understood, \
			set_up, tear_down, (void *)&layout                                    \
	}

int main(void)
{
	const struct CMUnitTest tests[] = {
		LAYOUT(hid_layout_reference),
		LAYOUT(hid_layout_padded),
		LAYOUT(hid_layout_wide),
		LAYOUT(hid_layout_coarse),
		LAYOUT(hid_layout_point),
		TEST(tracker_tells_its_screen_and_rate_and_is_told_what_to_send),
		TEST(tracker_that_answers_no_feature_request_streams_all_the_same),
		TEST(tracker_may_come_go_and_come_again_at_any_time),
		TEST(reports_that_cannot_be_are_counted_and_the_stream_goes_on),
		TEST(report_longer_than_described_does_no_harm),
		TEST(stalled_endpoint_is_brought_back),
		TEST(tracker_that_falls_silent_blinks_and_is_lost_until_it_goes_on),
		TEST(tracker_that_tells_its_trouble_is_told_in_the_status),
		TEST(tracker_whose_clock_runs_on_in_suspend_is_timed_right_afterwards),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
