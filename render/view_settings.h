/**
 * @file
 * What a viewer lays over the picture or shows in its place: section "view" of a scene. The
 * renderer does not look at it.
 */
#ifndef GZ_RENDER_VIEW_SETTINGS_H
#define GZ_RENDER_VIEW_SETTINGS_H

#include <stdbool.h>

#include "base/option.h"
#include "protocol/gaze.h"

/** What the plan's tiles are tinted by. */
enum gz_view_overlay {
	GZ_OVERLAY_NONE,
	GZ_OVERLAY_SPACING, /**< between rays */
	GZ_OVERLAY_STEP,    /**< along rays */
	GZ_OVERLAY_COUNT,
};

/** "none", "spacing", "step"; NULL-terminated. */
extern const char *const gz_view_overlay_names[];

/** Settings of section "view"; its table is gz_view_setting_options. */
struct gz_view_settings {
	bool gaze_cursor;        /**< a cross at the gaze */
	bool letters;            /**< which side is where, at the picture's edges */
	int overlay;             /**< enum gz_view_overlay */
	bool trail;              /**< the last second of the gaze */
	bool vsync;              /**< the window waits for the display's refresh */
	char gaze[GZ_PATH_SIZE]; /**< where the gaze comes from in a window, as --gaze has it;
				    empty: as it is */
	char tracker_display[GZ_NAME_SIZE]; /**< the monitor that a tracker means: its name or its
					       number from 1; empty: found out */
};

/** Table over struct gz_view_settings. */
extern const struct gz_option gz_view_setting_options[];
extern const size_t gz_view_setting_option_count;

#endif
