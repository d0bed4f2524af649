/**
 * @file
 * What a viewer lays over the picture or shows in its place: section "view" of a scene. The
 * renderer does not look at it.
 */
#ifndef GZ_RENDER_VIEW_SETTINGS_H
#define GZ_RENDER_VIEW_SETTINGS_H

#include <stdbool.h>

#include "base/option.h"

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
	bool gaze_cursor; /**< a cross at the gaze */
	bool letters;     /**< which side is where, at the picture's edges */
	int overlay;      /**< enum gz_view_overlay */
};

/** Table over struct gz_view_settings. */
extern const struct gz_option gz_view_setting_options[];
extern const size_t gz_view_setting_option_count;

#endif
