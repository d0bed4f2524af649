/**
 * @file
 * What a viewer tells of itself on the inlet, on its way to the pointer driver and into the log.
 * Pure: no clock, no I/O.
 */
#ifndef GZ_DAEMON_VIEWER_H
#define GZ_DAEMON_VIEWER_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/pointer/pointer_feed.h"
#include "protocol/gaze_log.h"
#include "protocol/wire_viewer.h"

/** A message that says to be older than this, ns, or of later than now, is believed to have come
 * from another clock: its arrival counts. Chosen: no queue on one machine holds it so long. */
#define GZ_VIEWER_AGE_MAX_NS INT64_C(1000000000)

/** A window that was not spoken of for so long, ns, is no longer known: its viewer is gone. Chosen:
 * three of gazeview's messages, which come each second. */
#define GZ_VIEWER_WINDOW_NS INT64_C(3000000000)

/** When what a message tells was so: its own time where that is believable, else @p now_ns. */
int64_t gz_viewer_time_ns(bool has_time, int64_t time_ns, int64_t now_ns);

/** What the pointer driver is told by a message that arrived at @p now_ns. */
struct gz_pointer_report gz_viewer_report(const struct gz_viewer_pointer *pointer, int64_t now_ns);

/** What is known of the viewer's window. Zero-initialised is nothing. */
struct gz_viewer_place {
	bool known;
	int rect_px[4];
	int64_t heard_ns; /**< host time of the newest message */
};

/**
 * Follow a message of @p host_ns, as gz_viewer_time_ns() has it.
 *
 * @param rect_px  x y w h; NULL where the window is closed
 * @param[out] out_record  written only on true
 * @return whether the log is to be told
 */
bool gz_viewer_place_step(struct gz_viewer_place *place, const int *rect_px, int64_t host_ns,
			  struct gz_gaze_log_record *out_record);

/**
 * For a recording that begins at @p now_ns.
 *
 * @param[out] out_record  written only on true
 * @return whether the window is known, and a record of it is to come first
 */
bool gz_viewer_place_at_start(const struct gz_viewer_place *place, int64_t now_ns,
			      struct gz_gaze_log_record *out_record);

#endif
