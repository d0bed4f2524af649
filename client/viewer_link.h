/**
 * @file
 * What a viewer reports to the daemon: the position of its pointer, the position of its window, and
 * annotations. Everything goes to the inlet of the daemon whose latest channel the viewer reads.
 * Without a daemon nothing is sent; no call waits.
 */
#ifndef GZ_CLIENT_VIEWER_LINK_H
#define GZ_CLIENT_VIEWER_LINK_H

#include "base/log.h"
#include "base/result.h"
#include "protocol/wire.h"

/** How often the position of a resting pointer is sent, ns. Chosen: several times within the second
 * after which the daemon drops it. */
#define GZ_VIEWER_LINK_POINTER_NS INT64_C(250000000)

/** How often the position of a resting window is sent, ns. Chosen: several times within the three
 * seconds after which the daemon drops it. */
#define GZ_VIEWER_LINK_WINDOW_NS INT64_C(1000000000)

/** The link. One thread at a time. */
struct gz_viewer_link;

/**
 * Connect to the inlet. Succeeds even if no daemon is running.
 *
 * @param latest  endpoint of the daemon's latest channel, "ipc://…/latest": the inlet is in the
 * same directory; NULL or empty: the local daemon
 * @param log     borrowed; may be NULL
 * @param[out] out_link  owned by the caller: gz_viewer_link_close()
 * @retval GZ_ERR_UNSUPPORTED  @p latest is another endpoint, so that its inlet is not known; not
 *                             logged
 * @retval GZ_ERR_FULL    the path is too long; logged
 * @retval GZ_ERR_NO_MEM  no memory or no socket; if no socket, logged
 * @retval GZ_ERR_INVAL   the endpoint is refused; logged
 */
enum gz_result gz_viewer_link_open(const char *latest, const struct gz_log *log,
				   struct gz_viewer_link **out_link);

/**
 * Report the position of the pointer. Sent if it has moved, or was not sent for
 * GZ_VIEWER_LINK_POINTER_NS.
 *
 * @param point   in the normalised display area; NULL while it is outside the window: sent once
 * @param now_ns  host time
 */
void gz_viewer_link_pointer(struct gz_viewer_link *link, const struct gz_point *point,
			    int64_t now_ns);

/**
 * Report the position of the window's content. Sent if it, its monitor or whether its scene is
 * still has changed, or was not sent for
 * GZ_VIEWER_LINK_WINDOW_NS.
 *
 * @param rect_px  x y w h on the display, px
 * @param now_ns   host time
 */
void gz_viewer_link_window(struct gz_viewer_link *link, const int rect_px[4], int64_t now_ns);

/**
 * The monitor that is the tracker's display. It is reported with the window from then on, so that
 * the daemon can tell whether it has changed since the tracker was validated.
 *
 * @param monitor  copied; NULL: unknown
 */
void gz_viewer_link_monitor(struct gz_viewer_link *link, const struct gz_monitor_place *monitor);

/**
 * Whether the scene is still: nothing moves that the person looks at. It is reported with the
 * window from then on. Until the first call nothing is said about it.
 */
void gz_viewer_link_scene(struct gz_viewer_link *link, bool still);

/**
 * Send an annotation to all readers; in a running recording it becomes a mark.
 *
 * @param label    at most GZ_ANNOTATION_LABEL_SIZE - 1 bytes; a longer one is not sent
 * @param time_ns  host time
 */
void gz_viewer_link_annotate(struct gz_viewer_link *link, const char *label, int64_t time_ns);

/** Report that the window is closed, close the link and set *link to NULL. Waits at most 100 ms,
 * and only if a connected daemon does not read. Accepts a pointer to NULL. */
void gz_viewer_link_close(struct gz_viewer_link **link);

#endif
