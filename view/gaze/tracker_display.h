/**
 * @file
 * Chooses the monitor that the tracker's gaze refers to, and converts its points to the window. A
 * tracker reports points on its own display; with several monitors the window's position on that
 * display is an offset (Bauer 2018, section 2.4). Pure: the caller passes the list of monitors.
 */
#ifndef GZ_VIEW_GAZE_TRACKER_DISPLAY_H
#define GZ_VIEW_GAZE_TRACKER_DISPLAY_H

#include <stdbool.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Largest number of monitors; further ones are ignored. Chosen: more than fit on a desk. */
enum { GZ_MONITORS_MAX = 16 };

/** A monitor. */
struct gz_monitor {
	char name[GZ_NAME_SIZE]; /**< the display server's name, such as "DP-1" */
	int rect_px[4];          /**< x y w h on the desktop; w and h above 0 */
	double mm[2];            /**< width and height; 0: unknown */
	double refresh_hz;       /**< 0: unknown */
	double scale;            /**< of the desktop on it; 0: unknown */
};

/** All monitors, the primary one first. */
struct gz_monitor_list {
	struct gz_monitor monitors[GZ_MONITORS_MAX];
	int count;
};

/** Why a monitor was chosen. */
enum gz_tracker_display_reason {
	GZ_TRACKER_DISPLAY_ALONE,     /**< it is the only one */
	GZ_TRACKER_DISPLAY_NAMED,     /**< the user named it */
	GZ_TRACKER_DISPLAY_DESCRIBED, /**< it has the size that the daemon reports */
	GZ_TRACKER_DISPLAY_WINDOW,    /**< the window is on it, and nothing else is known */
};

/** Where a monitor is, as the daemon is told of it. */
struct gz_monitor_place gz_monitor_place_of(const struct gz_monitor *monitor);

/** The choice. */
struct gz_tracker_display {
	int monitor; /**< index in the list; -1: the list is empty */
	enum gz_tracker_display_reason reason;
	bool named_is_absent; /**< the monitor that the user named does not exist */
};

/** The window's content as a part of a monitor: corner and size, as fractions of the monitor. */
struct gz_window_share {
	double x, y, width, height;
};

/** The index of the monitor that contains the centre of @p rect_px (x y w h), otherwise 0; -1 if
 * the list is empty. */
int gz_monitor_at(const struct gz_monitor_list *list, const int rect_px[4]);

/** The index of the monitor with a name, or with a number counted from 1; -1: no such monitor. */
int gz_monitor_named(const struct gz_monitor_list *list, const char *text);

/**
 * Choose the tracker's monitor: the named one, otherwise the only one, otherwise the one the daemon
 * describes, otherwise the window's.
 *
 * A monitor matches the description if it has the same pixels. If none has, as on desktops that
 * scale, it matches if it has the same size in mm within 5 % (chosen: monitors report sizes rounded
 * to centimetres). Among several, one that matches in both is taken, then the window's.
 *
 * @param named      the user's choice for gz_monitor_named(); empty: none
 * @param described  the display the daemon reports; NULL: none. The size of gz_display_default() is
 *                   an assumption of the daemon and is ignored
 * @param window_px  the window, x y w h
 */
struct gz_tracker_display gz_tracker_display_choose(const struct gz_monitor_list *list,
						    const char *named,
						    const struct gz_display *described,
						    const int window_px[4]);

/** The part of @p monitor that the window covers; outside 0 to 1 if the window is elsewhere. The
 * whole monitor if @p monitor is NULL or the window has no size. */
struct gz_window_share gz_window_share_of(const struct gz_monitor *monitor, const int window_px[4]);

/** Whether the window is entirely outside the monitor. */
bool gz_window_share_is_elsewhere(const struct gz_window_share *share);

/** Convert a point on the monitor to a point on the window. */
struct gz_point gz_window_share_point(const struct gz_window_share *share, struct gz_point point);

#ifdef __cplusplus
}
#endif

#endif
