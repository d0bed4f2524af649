/* A PlayStation VR2 and the daemon: the vendor's own USB protocol, from plug to unplug. */
#include "check.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "guest.h"
#include "lab.h"
#include "psvr2_gadget.h"
#include "recorded.h"

static struct lab lab;
static struct psvr2_gadget headset;

static const struct lab_truth truth = {
	.stream = &headset.stream,
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
	psvr2_gadget_remove(&headset);
	return 0;
}

static void start_daemon(void)
{
	LAB_START(&lab, "--driver", "psvr2", "--psvr2.screen_distance_mm", "600",
		  "--psvr2.screen_mm", "500 300");
}

static void plug_in(void)
{
	psvr2_gadget_plug(&headset, "VR-123");
	made_stream_start(&headset.stream);
}

static void headset_is_switched_on_again_each_second_and_off_at_the_end(void **state)
{
	(void)state;
	int64_t begin_ns = gz_clock_now_ns();
	plug_in();
	start_daemon();
	lab_compare(&lab, &truth, 2 * MADE_RATE_HZ);
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	const struct gz_status *status = &lab.reader.status;
	assert_string_equal(status->tracker.name, "PlayStation VR2");
	assert_string_equal(status->tracker.serial, "VR-123");
	assert_string_equal(status->tracker.reason, "");
	assert_int_equal(status->clock.tick, GZ_CLOCK_DECLARED);
	print_message("           switched on %u times, %.2f s apart at most; %d malformed\n",
		      (unsigned int)headset.on, gz_ns_to_s(headset.longest_ns),
		      (int)status->malformed[GZ_MALFORMED_SYNTAX]);
	assert_true(headset.on >= 2);
	/* On a busy machine it may be late, but not sooner. */
	assert_true(headset.longest_ns < 5 * GZ_NS_PER_S);
	assert_true(headset.on <= gz_ns_to_s(gz_clock_now_ns() - begin_ns) / 0.9 + 1);
	assert_int_equal(headset.off, 0);
	lab_stop(&lab);
	guest_wait_for_count(&headset.off, 1);
	assert_int_equal(headset.unknown, 0);
}

static void eyes_of_the_headset_are_told(void **state)
{
	(void)state;
	plug_in();
	start_daemon();
	lab_compare(&lab, &truth, 100);
	const struct gz_gaze_eye *left = &lab.gaze.eye[GZ_EYE_LEFT];
	const struct gz_gaze_eye *right = &lab.gaze.eye[GZ_EYE_RIGHT];
	assert_false(lab.gaze.combined);
	assert_true(left->valid && right->valid);
	assert_true(left->pupil_mm == 3.25f && right->pupil_mm == 3.5f);
	assert_true(left->origin_mm[0] == -31.5f && right->origin_mm[0] == 31.5f);
	headset.blinking = true;
	while (lab.gaze.event != GZ_EVENT_BLINK && lab.gaze.event != GZ_EVENT_LOST)
		lab_next_gaze(&lab);
	assert_false(lab.gaze.eye[GZ_EYE_LEFT].valid);
	headset.blinking = false;
	while (!lab.gaze.eye[GZ_EYE_LEFT].valid)
		lab_next_gaze(&lab);
	lab_stop(&lab);
}

static void headset_may_come_go_and_come_again_at_any_time(void **state)
{
	(void)state;
	start_daemon();
	lab_wait_state(&lab, GZ_TRACKER_ABSENT);
	print_message("           without: %s\n", lab.reader.status.tracker.reason);
	int64_t plugged_ns = gz_clock_now_ns();
	plug_in();
	lab_compare(&lab, &truth, 1);
	print_message("           first gaze %.1f s after the plug\n",
		      gz_ns_to_s(gz_clock_now_ns() - plugged_ns));
	assert_string_equal(gazed_request(&lab.place, "R replug", NULL), "OK");
	lab_compare(&lab, &truth, 100);
	uint64_t last_seq = lab.gaze.seq;
	psvr2_gadget_unplug(&headset);
	lab_wait_state(&lab, GZ_TRACKER_LOST);
	print_message("           unplugged: %s\n", lab.reader.status.tracker.reason);
	plug_in();
	lab_wait_state(&lab, GZ_TRACKER_RUNNING);
	lab_compare(&lab, &truth, 100);
	assert_true(lab.gaze.seq > last_seq);
	assert_string_equal(gazed_request(&lab.place, "r", NULL), "OK");
	lab_stop(&lab);
	struct recorded found = recorded_read(lab.place.recordings, "replug.gzl");
	print_message("           recorded %d samples; %d outages, and %d samples lost otherwise\n",
		      (int)found.samples, (int)found.outages, (int)found.missing);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.backwards, 0);
	assert_true(found.outages >= 1); /* more, where the machine held it up for a second */
}

static void packets_that_are_none_are_counted_and_the_stream_goes_on(void **state)
{
	(void)state;
	uint8_t packet[1000] = { 0 };
	struct made_sample sample = made_gaze(1);
	plug_in();
	start_daemon();
	lab_compare(&lab, &truth, 50);
	made_stream_stop(&headset.stream);
	for (int i = 0; i < 3; i++) {
		psvr2_gadget_encode(&headset, &sample, packet);
		assert_true(psvr2_gadget_send(&headset, packet, 100));
		assert_true(psvr2_gadget_send(&headset, packet, 700));
		packet[0] = 'X';
		assert_true(psvr2_gadget_send(&headset, packet, PSVR2_PACKET_SIZE));
	}
	made_stream_start(&headset.stream);
	lab_wait_malformed(&lab, GZ_MALFORMED_SHORT, 3);
	lab_wait_malformed(&lab, GZ_MALFORMED_LONG, 3);
	lab_wait_malformed(&lab, GZ_MALFORMED_SYNTAX, 3);
	lab_compare(&lab, &truth, 100);
	lab_stop(&lab);
}

static void stalled_endpoint_is_brought_back(void **state)
{
	(void)state;
	plug_in();
	start_daemon();
	lab_compare(&lab, &truth, 50);
	made_stream_stop(&headset.stream);
	psvr2_gadget_stall(&headset);
	made_stream_start(&headset.stream);
	int64_t begin_ns = gz_clock_now_ns();
	lab_compare(&lab, &truth, 100);
	print_message("           100 samples %.2f s after the stall\n",
		      gz_ns_to_s(gz_clock_now_ns() - begin_ns));
	lab_stop(&lab);
}

static void headset_is_listed(void **state)
{
	(void)state;
	assert_null(strstr(lab_devices(false), "VR-123"));
	plug_in();
	start_daemon();
	lab_compare(&lab, &truth, 20);
	const char *text = lab_devices(false);
	assert_non_null(strstr(text, "PlayStation VR2"));
	assert_non_null(strstr(text, "VR-123"));
	lab_compare(&lab, &truth, 20);
	lab_stop(&lab);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(headset_is_switched_on_again_each_second_and_off_at_the_end),
		TEST(eyes_of_the_headset_are_told),
		TEST(headset_may_come_go_and_come_again_at_any_time),
		TEST(packets_that_are_none_are_counted_and_the_stream_goes_on),
		TEST(stalled_endpoint_is_brought_back),
		TEST(headset_is_listed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
