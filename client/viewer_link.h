/**
 * @file
 * What a viewer tells the daemon: where its pointer is, where its window is, what it shows. Sent to
 * the inlet beside the daemon's latest channel; nothing is sent while no daemon runs, and nobody is
 * waited for.
 */
#ifndef GZ_CLIENT_VIEWER_LINK_H
#define GZ_CLIENT_VIEWER_LINK_H

#include "base/log.h"
#include "base/result.h"
#include "protocol/wire_viewer.h"

/** How often a pointer that rests is told of, ns. Chosen: several times within the second after
 * which the daemon gives it up. */
#define GZ_VIEWER_LINK_POINTER_NS INT64_C(250000000)

/** How often a window that rests is told of, ns. Chosen: as above, of three seconds. */
#define GZ_VIEWER_LINK_WINDOW_NS INT64_C(1000000000)

/** The link. One thread at a time. */
struct gz_viewer_link;

/**
 * Connect to the inlet.
 *
 * @param latest  endpoint of the latest channel that the inlet is beside, "ipc://…/latest"; NULL or
 *                empty for the local daemon's
 * @param log     borrowed; may be NULL
 * @retval GZ_ERR_UNSUPPORTED  @p latest is no such endpoint: where its inlet is cannot be told
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM, GZ_ERR_FULL  logged
 */
enum gz_result gz_viewer_link_open(const char *latest, const struct gz_log *log,
				   struct gz_viewer_link **out_link);

/**
 * The pointer is at @p point of the normalised display area at @p now_ns, host time. Sent where it
 * has moved, or has not been sent for GZ_VIEWER_LINK_POINTER_NS.
 *
 * @param point  NULL while it is not in the window: sent once
 */
void gz_viewer_link_pointer(struct gz_viewer_link *link, const struct gz_point *point,
			    int64_t now_ns);

/** The window's content is at @p rect_px, x y w h on the display. Sent where it has changed, or has
 * not been sent for GZ_VIEWER_LINK_WINDOW_NS. */
void gz_viewer_link_window(struct gz_viewer_link *link, const int rect_px[4], int64_t now_ns);

/** Say something of a moment to all readers; it becomes a mark in a recording that runs.
 *
 * @param label    up to GZ_ANNOTATION_LABEL_SIZE - 1 bytes; longer ones are not sent
 * @param time_ns  host time */
void gz_viewer_link_annotate(struct gz_viewer_link *link, const char *label, int64_t time_ns);

/** Tell that the window is closed, close and set to NULL. Waits 100 ms at most, and only where a
 * daemon is connected that does not read. Accepts a pointer to NULL. */
void gz_viewer_link_close(struct gz_viewer_link **link);

#endif
