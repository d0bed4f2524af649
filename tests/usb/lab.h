/**
 * @file
 * The lab of a test: the trackers that can be plugged in, a daemon in the guest with a reader of
 * its messages, and the comparison of these messages with what the trackers sent. Calls fail the
 * test, with the daemon's log, if what they wait for does not come within 20 s.
 */
#ifndef GZ_TESTS_USB_LAB_H
#define GZ_TESTS_USB_LAB_H

#include <stdint.h>

#include "hid_function.h"
#include "hid_gadget.h"
#include "made_gaze.h"
#include "pipeline/gazed_process.h"
#include "protocol/gaze.h"
#include "psvr2_gadget.h"
#include "tobii5_gadget.h"

/** The ordinary user of the guest, and the group whose members may use trackers. */
#define LAB_USER  1000
#define LAB_GROUP 2000

/** Trackers, a daemon and its reader. */
struct lab {
	struct hid_gadget tracker, second;
	struct hid_function function;
	struct psvr2_gadget headset;
	struct tobii5_gadget desk;

	struct gazed_place place;
	struct reader reader;
	struct gazed_process gazed;
	struct gz_gaze gaze; /**< the newest one received */
	uint64_t compared;   /**< gaze messages compared so far */
	int64_t pushed_ns;   /**< host time of the newest sample that came behind its fillers */
};

/** The lab of this program. */
extern struct lab lab;

/** Set-up and teardown of a test: the folders of the daemon and a subscribed reader, and afterwards
 * the removal of everything. */
int lab_set_up(void **state);
int lab_tear_down(void **state);

/** A test in the lab. */
#define LAB_TEST(function) cmocka_unit_test_setup_teardown(function, lab_set_up, lab_tear_down)

/** Make the folders of the daemon and subscribe; end the daemon and remove them. */
void lab_open(void);
void lab_close(void);

/** Plug in lab.tracker, "GazeLab 200" with the serial number "GL-7", and start its stream. */
void lab_plug_tracker(enum hid_layout layout);

/** Plug in lab.second, "EyeWorks Fine" with the serial number "EW-42", and start its stream. */
void lab_plug_second(void);

/** Plug in lab.function, whose flags are already set, and start its stream. */
void lab_plug_function(const char *name, const char *serial);

/** Plug in lab.headset, a PlayStation VR2 with the serial number "VR-123", and start its stream. */
void lab_plug_headset(void);

/** The screen of made_gaze.h, for trackers that do not know theirs. */
#define LAB_SCREEN       "--display.mm", "500 300"
#define LAB_PSVR2_SCREEN "--psvr2.screen_mm", "500 300"

/** Start the daemon with these arguments, NULL at the end, as LAB_USER or as root, and wait until
 * it answers. */
void lab_start(bool as_user, const char *const *arguments);

/** The same as root, with the arguments given one by one. */
#define LAB_START(...) lab_start(false, (const char *const[]) { __VA_ARGS__, NULL })

/** End it with SIGTERM; fails the test if its exit status is not 0. */
void lab_stop(void);

/** What the daemon has logged so far; static buffer. */
const char *lab_said(void);

/** Check that @p text was logged. */
void lab_expect_said(const char *text);

/** Receive the next gaze message into lab.gaze. */
void lab_next_gaze(void);

/** Receive @p count gaze messages and check that they are what the tracker sent: increasing numbers
 * and times, and the points at the times of the device clock. */
void lab_compare(const struct made_stream *stream, uint64_t count);

/** Receive until @p done returns true; @p what names the goal. */
void lab_wait(bool (*done)(void), const char *what);

/** Receive until the status reports this state. */
void lab_wait_state(enum gz_tracker_state state);

/** Receive until the status has counted @p count malformed reports of this kind; fails the test if
 * there are more. */
void lab_wait_malformed(enum gz_malformed kind, uint64_t count);

/** How a tracker comes and goes. */
struct lab_replug {
	const struct made_stream *stream;
	void (*plug)(void);
	void (*unplug)(void);
	void (*replug)(void);
	int times;      /**< how often it is unplugged and plugged in again */
	uint64_t count; /**< samples to compare each time */
};

/** Check, while a recording runs, that a tracker can be plugged in after the daemon has started,
 * unplugged and plugged in again: the stream and its numbers continue, and the recording has an
 * outage for each time. Ends the daemon. */
void lab_check_replug(const struct lab_replug *how);

/** Check that the stream continues after its endpoint has stalled. */
void lab_check_stall(struct made_stream *stream, int endpoint, uint64_t count);

/** Output of `gazectl devices`, as LAB_USER or as root; static buffer. */
const char *lab_devices(bool as_user);

#endif
