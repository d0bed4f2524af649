/* HID eye trackers of several makers and the daemon: whatever their descriptors look like, their
 * samples arrive, and whatever they do, the stream continues. */
#include "suite.h"

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

static void start_daemon(void)
{
	LAB_START("--driver", "hid", LAB_SCREEN);
}

static bool clock_is_judged(void)
{
	return lab.reader.status.clock.tick != GZ_CLOCK_NONE;
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
	const enum hid_layout layout = *(const enum hid_layout *)*state;
	const double left_mm[3] = HID_LEFT_EYE_MM, right_mm[3] = HID_RIGHT_EYE_MM;
	lab_plug_tracker(layout);
	start_daemon();
	lab_compare(&lab.tracker.stream, 200);
	lab_wait_state(GZ_TRACKER_RUNNING);
	assert_string_equal(lab.reader.status.tracker.name, "GazeLab 200");
	assert_string_equal(lab.reader.status.tracker.serial, "GL-7");
	assert_int_equal(lab.gaze.combined, !hid_layout_has_eyes(layout));
	if (hid_layout_has_eyes(layout)) {
		check_eye(&lab.gaze.eye[GZ_EYE_LEFT], left_mm);
		check_eye(&lab.gaze.eye[GZ_EYE_RIGHT], right_mm);
	}
	if (lab.tracker.stream.has_clock) {
		lab_wait(clock_is_judged, "judgement of its clock");
		assert_int_equal(lab.reader.status.clock.tick, GZ_CLOCK_DECLARED);
	}
	assert_int_equal(lab.reader.status.malformed[GZ_MALFORMED_VALUE], 0);
	lab_stop();
}

static void tracker_states_its_screen_and_rate_and_accepts_a_mode(void **state)
{
	(void)state;
	lab.function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	lab_plug_function("GazeLab Pro", "GP-1");
	LAB_START("--driver", "hid");
	lab_compare(&lab.function.stream, 100);
	lab_wait_state(GZ_TRACKER_RUNNING);
	const struct gz_status *status = &lab.reader.status;
	assert_true(fabs(status->display.mm[0] - 500) < 0.01);
	assert_true(fabs(status->display.mm[1] - 300) < 0.01);
	assert_true(status->rate_hz_nominal == MADE_RATE_HZ);
	assert_int_equal(lab.function.mode, 3); /* gaze point and eye positions */
	assert_true(lab.function.feature_reads >= 3);
	lab_stop();
	guest_wait_for_count(&lab.function.mode_requests, 2);
	assert_int_equal(lab.function.mode, 4); /* restored */
}

static void tracker_without_feature_reports_still_streams(void **state)
{
	(void)state;
	lab.function = (struct hid_function) { .refuses_features = true };
	lab_plug_function("GazeLab Mute", "GM-1");
	start_daemon();
	lab_compare(&lab.function.stream, 100);
	lab_expect_said("rejects the request");
	lab_stop();
}

static void plug_reference(void)
{
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
}

static void unplug_tracker(void)
{
	gadget_unplug(&lab.tracker.gadget);
}

static void replug_tracker(void)
{
	gadget_plug(&lab.tracker.gadget);
}

static void tracker_may_be_plugged_and_unplugged_at_any_time(void **state)
{
	(void)state;
	start_daemon();
	lab_check_replug(&(struct lab_replug) { .stream = &lab.tracker.stream,
						.plug = plug_reference,
						.unplug = unplug_tracker,
						.replug = replug_tracker,
						.times = 2,
						.count = 50 });
}

/* Random reports may be well formed, with random times and points, and it takes a while to find
 * that the clock has jumped back. */
static void wait_for_truth(void)
{
	int good = 0;
	while (good < 50) {
		lab_next_gaze();
		struct made_sample sample = made_gaze_at(lab.gaze.device_ns);
		if (fabs(lab.gaze.raw.x - sample.x) < 1e-3)
			good++;
		else if (lab.gaze.device_ns != GZ_NO_DEVICE_TIME)
			good = 0;
	}
}

static void impossible_reports_are_counted_and_the_stream_continues(void **state)
{
	(void)state;
	uint8_t report[HID_REPORT_MAX];
	struct made_sample sample = made_gaze(1);
	size_t size = hid_gadget_report(HID_LAYOUT_REFERENCE, &sample, report);
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	start_daemon();
	lab_compare(&lab.tracker.stream, 50);
	made_stream_stop(&lab.tracker.stream);
	/* Newer kernels pass on only the second of these three. */
	for (uint8_t i = 0; i < 3; i++) {
		hid_gadget_report(HID_LAYOUT_REFERENCE, &sample, report);
		hid_gadget_send(&lab.tracker, report, 10);
		report[1] = i;
		memset(report + 9, 0x7F, 8); /* kilometres away */
		hid_gadget_send(&lab.tracker, report, size);
		report[0] = 0x77; /* an undeclared ID */
		hid_gadget_send(&lab.tracker, report, size);
	}
	made_stream_start(&lab.tracker.stream);
	lab_wait_malformed(GZ_MALFORMED_VALUE, 3);
	lab_compare(&lab.tracker.stream, 100);
	made_stream_stop(&lab.tracker.stream);
	for (int i = 0; i < 200; i++) {
		for (size_t byte = 0; byte < size; byte++)
			report[byte] = (uint8_t)rand();
		report[0] = i % 2 ? 0x10 : report[0];
		hid_gadget_send(&lab.tracker, report, size);
	}
	made_stream_start(&lab.tracker.stream);
	wait_for_truth();
	lab_compare(&lab.tracker.stream, 100);
	lab_stop();
}

static void report_longer_than_declared_does_no_harm(void **state)
{
	(void)state;
	uint8_t report[HID_REPORT_MAX] = { 0 };
	struct made_sample sample = made_gaze(1);
	lab.function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	lab_plug_function("GazeLab Long", "GO-1");
	start_daemon();
	lab_compare(&lab.function.stream, 50);
	made_stream_stop(&lab.function.stream);
	hid_gadget_report(HID_LAYOUT_REFERENCE, &sample, report);
	functionfs_send(&lab.function.function, report, sizeof report);
	made_stream_start(&lab.function.stream);
	lab_compare(&lab.function.stream, 100);
	lab_stop();
}

static void stream_continues_after_a_stall(void **state)
{
	(void)state;
	lab.function = (struct hid_function) { .screen_um = { 500000, 300000 } };
	lab_plug_function("GazeLab Stall", "GS-1");
	start_daemon();
	lab_check_stall(&lab.function.stream, lab.function.function.endpoint, 50);
	lab_stop();
}

static bool is_blink(void)
{
	return lab.gaze.event == GZ_EVENT_BLINK;
}

static bool is_lost(void)
{
	return lab.gaze.event == GZ_EVENT_LOST;
}

static bool is_seen(void)
{
	return lab.gaze.confidence > 0;
}

/* A HID tracker sends nothing while it sees no eye. */
static void silent_tracker_is_a_blink_then_a_loss_until_it_continues(void **state)
{
	(void)state;
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	start_daemon();
	lab_compare(&lab.tracker.stream, 100);
	made_stream_stop(&lab.tracker.stream);
	lab_wait(is_blink, "a blink");
	lab_wait(is_lost, "loss of the eyes");
	lab_wait_state(GZ_TRACKER_RUNNING);
	assert_int_equal(lab.gaze.device_ns, GZ_NO_DEVICE_TIME);
	made_stream_start(&lab.tracker.stream);
	lab_wait(is_seen, "its gaze");
	lab_compare(&lab.tracker.stream, 50);
	assert_int_equal(lab.reader.status.lost, 0);
	lab_stop();
}

static bool is_uncalibrated(void)
{
	return strstr(lab.reader.status.tracker.reason, "calibrate it for the user") != NULL;
}

static bool is_well(void)
{
	return lab.reader.status.tracker.reason[0] == '\0';
}

static void trouble_of_the_tracker_is_reported_in_the_status(void **state)
{
	(void)state;
	static const unsigned char uncalibrated[] = { 0x13, 4, 100, 0 },
				   ready[] = { 0x13, 1, 100, 0 };
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	start_daemon();
	lab_compare(&lab.tracker.stream, 20);
	lab_wait(is_well, "a status without trouble");
	made_stream_stop(&lab.tracker.stream);
	hid_gadget_send(&lab.tracker, uncalibrated, sizeof uncalibrated);
	lab_wait(is_uncalibrated, "a status that names the trouble");
	hid_gadget_send(&lab.tracker, ready, sizeof ready);
	lab_wait(is_well, "a status without trouble");
	made_stream_start(&lab.tracker.stream);
	lab_wait(is_seen, "its gaze");
	lab_compare(&lab.tracker.stream, 20);
	lab_stop();
}

static void times_are_right_after_a_suspend_during_which_the_device_clock_ran(void **state)
{
	(void)state;
	lab_plug_tracker(HID_LAYOUT_REFERENCE);
	start_daemon();
	assert_string_equal(gazed_request(&lab.place, "R nap", NULL), "OK");
	lab_compare(&lab.tracker.stream, 300);
	uint64_t last_seq = lab.gaze.seq;
	int64_t offset_ns = lab.gaze.host_ns - lab.gaze.device_ns;
	int64_t slept_ns = guest_suspend();
	/* Samples sent before the suspend are compared with a clock that has stood still since. */
	for (int i = 0; i < 50; i++)
		lab_next_gaze();
	lab_compare(&lab.tracker.stream, 100);
	int64_t moved_ns = lab.gaze.host_ns - lab.gaze.device_ns - offset_ns;
	print_message("           asleep for %.3f s, the clocks moved by %.3f s\n",
		      gz_ns_to_s(slept_ns), gz_ns_to_s(moved_ns));
	assert_true(lab.gaze.seq > last_seq);
	assert_true(llabs(moved_ns + slept_ns) < 500 * GZ_NS_PER_MS);
	/* The clock fit starts again, because of the suspend or the jump, whichever is noticed
	 * first. */
	lab_expect_said("the machine was suspended");
	assert_string_equal(gazed_request(&lab.place, "r", NULL), "OK");
	lab_stop();
	struct recorded found = recorded_read(lab.place.recordings, "nap.gzl");
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.backwards, 0);
}

static enum hid_layout layouts[] = {
	HID_LAYOUT_REFERENCE, HID_LAYOUT_PADDED, HID_LAYOUT_TIME64,
	HID_LAYOUT_WIDE,      HID_LAYOUT_COARSE, HID_LAYOUT_POINT,
};

#define LAYOUT(index, name)                                                                       \
	{                                                                                         \
		"tracker_of_" name "_layout_is_understood", tracker_of_this_layout_is_understood, \
			lab_set_up, lab_tear_down, &layouts[index]                                \
	}

int main(void)
{
	const struct CMUnitTest tests[] = {
		LAYOUT(0, "reference"),
		LAYOUT(1, "padded"),
		LAYOUT(2, "time64"),
		LAYOUT(3, "wide"),
		LAYOUT(4, "coarse"),
		LAYOUT(5, "point"),
		LAB_TEST(tracker_states_its_screen_and_rate_and_accepts_a_mode),
		LAB_TEST(tracker_without_feature_reports_still_streams),
		LAB_TEST(tracker_may_be_plugged_and_unplugged_at_any_time),
		LAB_TEST(impossible_reports_are_counted_and_the_stream_continues),
		LAB_TEST(report_longer_than_declared_does_no_harm),
		LAB_TEST(stream_continues_after_a_stall),
		LAB_TEST(silent_tracker_is_a_blink_then_a_loss_until_it_continues),
		LAB_TEST(trouble_of_the_tracker_is_reported_in_the_status),
		LAB_TEST(times_are_right_after_a_suspend_during_which_the_device_clock_ran),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
