/* A PlayStation VR2 and the daemon: the vendor's own USB protocol, from plugging in to unplugging.
 */
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "guest.h"
#include "lab.h"

static void start_daemon(void)
{
	LAB_START("--driver", "psvr2", "--psvr2.screen_distance_mm", "600", LAB_PSVR2_SCREEN);
}

static void headset_is_switched_on_every_second_and_off_at_the_end(void **state)
{
	(void)state;
	int64_t begin_ns = gz_clock_now_ns();
	lab_plug_headset();
	start_daemon();
	lab_compare(&lab.headset.stream, 2 * MADE_RATE_HZ);
	lab_wait_state(GZ_TRACKER_RUNNING);
	const struct gz_status *status = &lab.reader.status;
	assert_string_equal(status->tracker.name, "PlayStation VR2");
	assert_string_equal(status->tracker.serial, "VR-123");
	assert_string_equal(status->tracker.reason, "");
	assert_int_equal(status->clock.tick, GZ_CLOCK_DECLARED);
	print_message("           switched on %u times, %.2f s apart at most; %d malformed\n",
		      (unsigned int)lab.headset.on, gz_ns_to_s(lab.headset.longest_ns),
		      (int)status->malformed[GZ_MALFORMED_SYNTAX]);
	assert_true(lab.headset.on >= 2);
	/* On a busy machine the request may be late, but not early. */
	assert_true(lab.headset.longest_ns < 5 * GZ_NS_PER_S);
	assert_true(lab.headset.on <= gz_ns_to_s(gz_clock_now_ns() - begin_ns) / 0.9 + 1);
	assert_int_equal(lab.headset.off, 0);
	lab_stop();
	guest_wait_for_count(&lab.headset.off, 1);
	assert_int_equal(lab.headset.unknown, 0);
}

static void eyes_of_the_headset_are_delivered(void **state)
{
	(void)state;
	lab_plug_headset();
	start_daemon();
	lab_compare(&lab.headset.stream, 100);
	const struct gz_gaze_eye *left = &lab.gaze.eye[GZ_EYE_LEFT];
	const struct gz_gaze_eye *right = &lab.gaze.eye[GZ_EYE_RIGHT];
	assert_false(lab.gaze.combined);
	assert_true(left->valid && right->valid);
	assert_true(left->pupil_mm == 3.25f && right->pupil_mm == 3.5f);
	assert_true(left->origin_mm[0] == -31.5f && right->origin_mm[0] == 31.5f);
	lab.headset.blinking = true;
	while (lab.gaze.event != GZ_EVENT_BLINK && lab.gaze.event != GZ_EVENT_LOST)
		lab_next_gaze();
	assert_false(lab.gaze.eye[GZ_EYE_LEFT].valid);
	lab.headset.blinking = false;
	while (!lab.gaze.eye[GZ_EYE_LEFT].valid)
		lab_next_gaze();
	lab_stop();
}

static void unplug_headset(void)
{
	psvr2_gadget_unplug(&lab.headset);
}

static void headset_may_be_plugged_and_unplugged_at_any_time(void **state)
{
	(void)state;
	start_daemon();
	lab_check_replug(&(struct lab_replug) { .stream = &lab.headset.stream,
						.plug = lab_plug_headset,
						.unplug = unplug_headset,
						.replug = lab_plug_headset,
						.times = 1,
						.count = 100 });
}

static void malformed_packets_are_counted_and_the_stream_continues(void **state)
{
	(void)state;
	uint8_t packet[1000] = { 0 };
	struct made_sample sample = made_gaze(1);
	lab_plug_headset();
	start_daemon();
	lab_compare(&lab.headset.stream, 50);
	made_stream_stop(&lab.headset.stream);
	for (int i = 0; i < 3; i++) {
		psvr2_gadget_encode(&lab.headset, &sample, packet);
		assert_true(psvr2_gadget_send(&lab.headset, packet, 100));
		assert_true(psvr2_gadget_send(&lab.headset, packet, 700));
		packet[0] = 'X';
		assert_true(psvr2_gadget_send(&lab.headset, packet, GZ_PSVR2_PACKET_SIZE));
	}
	made_stream_start(&lab.headset.stream);
	lab_wait_malformed(GZ_MALFORMED_SHORT, 3);
	lab_wait_malformed(GZ_MALFORMED_LONG, 3);
	lab_wait_malformed(GZ_MALFORMED_SYNTAX, 3);
	lab_compare(&lab.headset.stream, 100);
	lab_stop();
}

static void stream_continues_after_a_stall(void **state)
{
	(void)state;
	lab_plug_headset();
	start_daemon();
	lab_compare(&lab.headset.stream, 1);
	lab_check_stall(&lab.headset.stream, lab.headset.endpoint, 100);
	lab_stop();
}

static void headset_is_listed(void **state)
{
	(void)state;
	assert_null(strstr(lab_devices(false), "VR-123"));
	lab_plug_headset();
	start_daemon();
	lab_compare(&lab.headset.stream, 20);
	const char *text = lab_devices(false);
	assert_non_null(strstr(text, "PlayStation VR2"));
	assert_non_null(strstr(text, "VR-123"));
	lab_compare(&lab.headset.stream, 20);
	lab_stop();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		LAB_TEST(headset_is_switched_on_every_second_and_off_at_the_end),
		LAB_TEST(eyes_of_the_headset_are_delivered),
		LAB_TEST(headset_may_be_plugged_and_unplugged_at_any_time),
		LAB_TEST(malformed_packets_are_counted_and_the_stream_continues),
		LAB_TEST(stream_continues_after_a_stall),
		LAB_TEST(headset_is_listed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
