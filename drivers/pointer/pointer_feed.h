/**
 * @file
 * Where the viewer's pointer is, from the thread that hears of it to the one that reads the pointer
 * driver. Neither waits, locks or allocates.
 */
#ifndef GZ_DRIVERS_POINTER_FEED_H
#define GZ_DRIVERS_POINTER_FEED_H

#include <stdbool.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Reports that wait to be taken, a power of two. Chosen: a quarter of a second of a 1000 Hz mouse.
 * More are dropped: a feed that nobody reads costs nothing. */
#define GZ_POINTER_FEED_SIZE 256

/** The pointer at one moment. */
struct gz_pointer_report {
	int64_t host_ns;
	bool known; /**< false: it is nowhere */
	struct gz_point point;
};

/** The feed: one thread puts in, one takes out. */
struct gz_pointer_feed;

/** Make an empty feed. @retval GZ_ERR_NO_MEM  no room */
enum gz_result gz_pointer_feed_create(struct gz_pointer_feed **out_feed);

/** Put a report in; false if the feed is full. Only from the thread that puts in. */
bool gz_pointer_feed_put(struct gz_pointer_feed *feed, const struct gz_pointer_report *report);

/**
 * Take the oldest report that is not later than @p until_ns.
 *
 * @param[out] out_report  written only on true
 * @return false if there is none, or the oldest is later
 *
 * Only from the thread that takes out.
 */
bool gz_pointer_feed_take(struct gz_pointer_feed *feed, int64_t until_ns,
			  struct gz_pointer_report *out_report);

/** Free and set to NULL, once neither thread uses it. Accepts a pointer to NULL. */
void gz_pointer_feed_destroy(struct gz_pointer_feed **feed);

#endif
