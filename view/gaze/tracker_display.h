/**
 * @file
 * Which monitor a tracker's gaze is on, and which part of it a window is. A tracker's points are on
 * its own display; with several monitors the window's place there is an offset to them (Bauer 2018,
 * section 2.4). Pure: monitors come in as a list.
 */
#ifndef GZ_VIEW_GAZE_TRACKER_DISPLAY_H
#define GZ_VIEW_GAZE_TRACKER_DISPLAY_H

#include <stdbool.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Monitors that are told apart; further ones are not seen (chosen: more than a desk bears). */
enum { GZ_MONITORS_MAX = 16 };

/** A monitor. */
struct gz_monitor {
	char name[GZ_NAME_SIZE]; /**< as the display server has it: "DP-1" */
	int rect_px[4];          /**< x y w h among all monitors; w and h above 0 */
	double mm[2];            /**< its size; 0 where it does not tell */
	double refresh_hz;       /**< 0 where it does not tell */
};

/** All that there are, the primary one first. */
struct gz_monitor_list {
	struct gz_monitor monitors[GZ_MONITORS_MAX];
	int count;
};

/** Why a monitor is the tracker's. */
enum gz_tracker_display_reason {
	GZ_TRACKER_DISPLAY_ALONE,     /**< there is no other */
	GZ_TRACKER_DISPLAY_NAMED,     /**< the user says so */
	GZ_TRACKER_DISPLAY_DESCRIBED, /**< it has the size that the daemon tells */
	GZ_TRACKER_DISPLAY_WINDOW,    /**< the window is there, and nothing else is known */
};

/** What came of the choice. */
struct gz_tracker_display {
	int monitor; /**< index in the list; -1: there is no monitor */
	enum gz_tracker_display_reason reason;
	bool named_is_absent; /**< the one that the user named is not there */
};

/** A window's content as a part of a monitor: corner and size, in sides of the monitor. */
struct gz_window_share {
	double x, y, width, height;
};

/** The monitor that holds the middle of @p rect_px, x y w h; the first one where none does; -1 if
 * there is none. */
int gz_monitor_at(const struct gz_monitor_list *list, const int rect_px[4]);

/** The monitor of a name, or of a number from 1 on. @return its index; -1: there is none such */
int gz_monitor_named(const struct gz_monitor_list *list, const char *text);

/**
 * Choose.
 *
 * @param named      by the user, as gz_monitor_named() takes it; empty: nothing
 * @param described  as the daemon tells it; NULL: not at all. One that is gz_display_default()'s is
 *                   an assumption, and tells nothing
 * @param window_px  the window, x y w h
 *
 * A description is met by a monitor of the same pixels or, where none has them, as under desktops
 * that scale, of the same millimetres, to 5 % (chosen: what monitors tell of themselves is rounded
 * to centimetres). Of several the one whose millimetres agree too, then the window's.
 */
struct gz_tracker_display gz_tracker_display_choose(const struct gz_monitor_list *list,
						    const char *named,
						    const struct gz_display *described,
						    const int window_px[4]);

/** The part of @p monitor that a window is; beyond 0 to 1 where it is on another one. The whole
 * where @p monitor is NULL or the window has no size. */
struct gz_window_share gz_window_share_of(const struct gz_monitor *monitor, const int window_px[4]);

/** Whether no pixel of the window is on that monitor. */
bool gz_window_share_is_elsewhere(const struct gz_window_share *share);

/** A point of the monitor as one of the window. */
struct gz_point gz_window_share_point(const struct gz_window_share *share, struct gz_point point);

#ifdef __cplusplus
}
#endif

#endif
