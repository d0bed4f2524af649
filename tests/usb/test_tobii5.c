/* A Tobii Eye Tracker 5 and the daemon: the protocol of the public description, from plugging in to
 * unplugging. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/frame_bytes.h"
#include "guest.h"
#include "lab.h"

/* A calibration of a related tracker has this length; that of this one comes in several transfers.
 */
enum { CALIBRATION = 0x44c, SHORT_CALIBRATION_SIZE = 1480, CALIBRATION_SIZE = 414844 };

static const double screen_mm[3][3] = { { -250, 300, 0 }, { 250, 300, 0 }, { -250, 0, 0 } };

/* What a tracker states after a loss of power. */
static const double lost_mm[3][3] = { { -2, 2, 0 }, { 2, 2, 0 }, { -2, -2, 0 } };

static void plug_desk(void)
{
	tobii5_gadget_plug(&lab.desk, "IS5-1", screen_mm);
	made_stream_start(&lab.desk.stream);
}

static void unplug_desk(void)
{
	tobii5_gadget_unplug(&lab.desk);
}

static void gaze_and_eyes_are_delivered_and_the_session_is_closed(void **state)
{
	(void)state;
	plug_desk();
	LAB_START("--driver", "tobii5");
	lab_compare(&lab.desk.stream, 2 * MADE_RATE_HZ);
	lab_wait_state(GZ_TRACKER_RUNNING);
	const struct gz_status *status = &lab.reader.status;
	assert_string_equal(status->tracker.name, "Tobii Eye Tracker 5");
	assert_string_equal(status->tracker.serial, "IS5-1");
	assert_string_equal(status->tracker.reason, "");
	assert_int_equal(status->clock.tick, GZ_CLOCK_DECLARED);
	const struct gz_gaze_eye *left = &lab.gaze.eye[GZ_EYE_LEFT];
	assert_true(left->valid && left->pupil_mm == 3.25f && left->origin_mm[0] == -32);
	lab.desk.blinking = true;
	while (lab.gaze.event != GZ_EVENT_BLINK && lab.gaze.event != GZ_EVENT_LOST)
		lab_next_gaze();
	lab.desk.blinking = false;
	while (!lab.gaze.eye[GZ_EYE_LEFT].valid)
		lab_next_gaze();
	const char *text = lab_devices(false);
	assert_non_null(strstr(text, "Tobii Eye Tracker 5"));
	assert_non_null(strstr(text, "IS5-1"));
	assert_int_equal(lab.desk.opened, 1);
	lab_stop();
	guest_wait_for_count(&lab.desk.closed, 1);
	assert_int_equal(lab.desk.played.unknown, 0);
}

static void tracker_may_be_plugged_and_unplugged_at_any_time(void **state)
{
	(void)state;
	LAB_START("--driver", "tobii5");
	lab_check_replug(&(struct lab_replug) { .stream = &lab.desk.stream,
						.plug = plug_desk,
						.unplug = unplug_desk,
						.replug = plug_desk,
						.times = 1,
						.count = 100 });
}

/* Send a response of this length, in transfers of 16 KiB. */
static void send_calibration(size_t size)
{
	static unsigned char payload[CALIBRATION_SIZE], bytes[CALIBRATION_SIZE + 32];
	size_t total = tobii5_made_frame(0x52, 77, CALIBRATION, payload, size, bytes);
	for (size_t sent = 0; sent < total;) {
		size_t count = total - sent < 16384 ? total - sent : 16384;
		assert_true(tobii5_gadget_send(&lab.desk, bytes + sent, count));
		sent += count;
	}
}

static void calibrations_and_garbage_pass_and_the_stream_continues(void **state)
{
	(void)state;
	static const unsigned char garbage[100] = { 9 };
	plug_desk();
	LAB_START("--driver", "tobii5");
	lab_compare(&lab.desk.stream, 50);
	made_stream_stop(&lab.desk.stream);
	send_calibration(SHORT_CALIBRATION_SIZE);
	send_calibration(CALIBRATION_SIZE);
	for (int i = 0; i < 3; i++)
		assert_true(tobii5_gadget_send(&lab.desk, garbage, sizeof garbage));
	made_stream_start(&lab.desk.stream);
	lab_wait_malformed(GZ_MALFORMED_SYNTAX, 3);
	lab_compare(&lab.desk.stream, 100);
	lab_stop();
}

static void ordinary_user_sets_a_lost_display_area_with_the_udev_rule(void **state)
{
	(void)state;
	const char *const arguments[] = { "--driver", "tobii5", "--tobii5.screen_mm", "500 300",
					  NULL };
	guest_install_udev_rules();
	tobii5_gadget_plug(&lab.desk, "IS5-1", lost_mm);
	made_stream_start(&lab.desk.stream);
	lab_start(true, arguments);
	lab_compare(&lab.desk.stream, 100);
	assert_int_equal(lab.desk.played.area_sets, 1);
	assert_memory_equal(lab.desk.played.corner_mm, screen_mm, sizeof screen_mm);
	lab_stop();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		LAB_TEST(gaze_and_eyes_are_delivered_and_the_session_is_closed),
		LAB_TEST(tracker_may_be_plugged_and_unplugged_at_any_time),
		LAB_TEST(calibrations_and_garbage_pass_and_the_stream_continues),
		LAB_TEST(ordinary_user_sets_a_lost_display_area_with_the_udev_rule),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
