/**
 * @file
 * A daemon in the guest and somebody who reads what it says, and how that is compared with what a
 * played tracker sent.
 */
#ifndef GZ_TESTS_USB_LAB_H
#define GZ_TESTS_USB_LAB_H

#include <stdint.h>

#include "made_gaze.h"
#include "pipeline/gazed_process.h"
#include "protocol/gaze.h"

/** The ordinary user of the guest, and the group whose members may use trackers. */
#define LAB_USER  1000
#define LAB_GROUP 2000

/** A daemon and its reader. */
struct lab {
	struct gazed_place place;
	struct reader reader;
	struct gazed_process gazed;
	struct gz_gaze gaze; /**< the newest one received */
	uint64_t compared;   /**< gaze messages that were */
};

/** Make the daemon's folders and subscribe. */
void lab_open(struct lab *lab);

/** The screen of made_gaze.h, for trackers that do not know theirs. */
#define LAB_SCREEN "--display.mm", "500 300"

/** Start the daemon with these arguments, NULL at the end, as LAB_USER or as root, and wait until
 *  it answers. */
void lab_start(struct lab *lab, bool as_user, const char *const *arguments);

/** The same as root, arguments given one by one. */
#define LAB_START(lab, ...) lab_start(lab, false, (const char *const[]) { __VA_ARGS__, NULL })

/** End it by SIGTERM; fails the test where it does not end well. */
void lab_stop(struct lab *lab);

/** Take all away. For a teardown, too. */
void lab_close(struct lab *lab);

/** What the daemon logged in its life so far; static buffer. */
const char *lab_said(const struct lab *lab);

/** Fails the test, with all that was logged, unless @p text is in it. */
void lab_expect_said(const struct lab *lab, const char *text);

/** Receive the next gaze message into lab->gaze; fails the test after 20 s. */
void lab_next_gaze(struct lab *lab);

/** How @p stream is compared. */
struct lab_truth {
	const struct made_stream *stream;
	bool has_clock;   /**< the tracker stamps its samples */
	double tolerance; /**< of the point as measured, screen sides; by how it is stored */
};

/** Receive @p count gaze messages, and fail the test unless they are what the tracker sent: numbers
 *  that count up, times that advance, points as they were where the tracker's clock says. */
void lab_compare(struct lab *lab, const struct lab_truth *truth, uint64_t count);

/** Receive until @p done says so of the lab; fails the test, naming @p what, after 20 s. */
void lab_wait(struct lab *lab, bool (*done)(const struct lab *lab), const char *what);

/** Receive until status tells this state; fails the test after 20 s. */
void lab_wait_state(struct lab *lab, enum gz_tracker_state state);

/** Receive until status has counted @p count malformed reports of this kind; fails after 20 s, and
 *  where there are more. */
void lab_wait_malformed(struct lab *lab, enum gz_malformed kind, uint64_t count);

/** What `gazectl devices` prints; as LAB_USER or as root; static buffer. */
const char *lab_devices(bool as_user);

#endif
