/**
 * @file
 * The panel of the gaze: where it comes from, how far a log has been gone through, on which display
 * a tracker's is, what is shown of it, how long it takes to the display. Inside a frame of
 * panels/widgets.h.
 */
#ifndef GZ_VIEW_GAZE_PANEL_H
#define GZ_VIEW_GAZE_PANEL_H

#include <stdbool.h>

#include "protocol/gaze.h"
#include "view/gaze/tracker_display.h"

/** Sources that can be chosen: a row each. */
enum gz_gaze_panel_source {
	GZ_GAZE_PANEL_DAEMON,
	GZ_GAZE_PANEL_MOUSE,
	GZ_GAZE_PANEL_POINTER,
	GZ_GAZE_PANEL_ENDPOINT,
	GZ_GAZE_PANEL_LOG,
	GZ_GAZE_PANEL_FIXED,
	GZ_GAZE_PANEL_SOURCE_COUNT,
};

/** What it shows and changes. */
struct gz_gaze_panel {
	bool open;                       /**< false once its cross was clicked */
	bool right;                      /**< it appears at the lower right: the left is taken */
	float margin_top, margin_bottom; /**< kept free, screen coordinates */
	int source;                      /**< enum gz_gaze_panel_source */
	bool pointer_refused;            /**< the daemon is known to read another tracker */
	char endpoint[GZ_PATH_SIZE];     /**< typed */
	char log[GZ_PATH_SIZE];          /**< typed */
	double point[2];                 /**< of the fixed source */
	bool has_log;                    /**< what follows holds something */
	bool log_paused;                 /**< its time stands still */
	double log_s, log_length_s;      /**< where it is; length 0: not known */
	const struct gz_monitor_list *monitors;
	int tracker_display;              /**< 0: found out; n: the n-th of them */
	const char *tracker_display_note; /**< which one that is, and why */
	bool cursor, trail, frozen, vsync;
	const char *latency; /**< lines; empty: nothing is measured yet */
};

/** What was done in it. */
struct gz_gaze_panel_answer {
	bool source;          /**< another source, or its text or point */
	bool log_paused;      /**< was changed */
	bool log_s;           /**< was changed */
	bool tracker_display; /**< was changed */
};

/** Draw it. Switches are changed in place. */
struct gz_gaze_panel_answer gz_gaze_panel_draw(struct gz_gaze_panel *panel);

#endif
