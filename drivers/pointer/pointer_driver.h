/**
 * @file
 * The pointer (mouse) of a viewer in place of an eye, so that a demonstration without a tracker
 * passes through the same pipeline.
 *
 * A viewer reports its pointer when it moves, and now and then while it rests (topic "pointer" of
 * the inlet). The feed carries these reports from the thread that receives them to the thread that
 * reads the driver. The driver samples them at pointer.rate_hz and repeats the last position in
 * between, because gaze is a stream: a pointer at rest is a fixation, not a loss. It repeats a
 * position for pointer.timeout_ms at most: a viewer that has exited looks nowhere.
 */
#ifndef GZ_DRIVERS_POINTER_DRIVER_H
#define GZ_DRIVERS_POINTER_DRIVER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Reports that the feed holds, a power of two. Chosen: a quarter of a second of a 1000 Hz mouse.
 * Further ones are dropped, so a feed that nobody reads costs nothing. */
#define GZ_POINTER_FEED_SIZE 256

/** The pointer at one moment. */
struct gz_pointer_report {
	int64_t host_ns;       /**< host time, ns */
	bool known;            /**< false: the pointer is outside the window */
	struct gz_point point; /**< normalised, origin top left */
};

/** A queue of reports: one thread writes, one thread reads. Neither waits, locks or allocates. */
struct gz_pointer_feed;

/** Make an empty feed. @retval GZ_ERR_NO_MEM  out of memory */
enum gz_result gz_pointer_feed_create(struct gz_pointer_feed **out_feed);

/** Write a report. @return false if the feed is full. Threads: the writing one. */
bool gz_pointer_feed_put(struct gz_pointer_feed *feed, const struct gz_pointer_report *report);

/**
 * Read the oldest report that is not later than @p until_ns.
 *
 * @param until_ns  host time, ns
 * @param[out] out_report  written only on true
 * @return false if there is none, or the oldest is later
 *
 * Threads: the reading one.
 */
bool gz_pointer_feed_take(struct gz_pointer_feed *feed, int64_t until_ns,
			  struct gz_pointer_report *out_report);

/** Free and set to NULL, when neither thread uses it any more. Accepts a pointer to NULL. */
void gz_pointer_feed_destroy(struct gz_pointer_feed **feed);

#endif
