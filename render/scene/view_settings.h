/**
 * @file
 * What a viewer lays over the picture or shows in its place: section "view" of a scene. The
 * renderer does not look at it.
 */
#ifndef GZ_RENDER_SCENE_VIEW_SETTINGS_H
#define GZ_RENDER_SCENE_VIEW_SETTINGS_H

#include <stdbool.h>

#include "base/option.h"
#include "protocol/gaze.h"
#include "render/scene/saved_view.h"

/** What the plan's tiles are tinted by. */
enum gz_view_overlay {
	GZ_OVERLAY_NONE,
	GZ_OVERLAY_SPACING, /**< between rays */
	GZ_OVERLAY_STEP,    /**< along rays */
	GZ_OVERLAY_COUNT,
};

/** "none", "spacing", "step"; NULL-terminated. */
extern const char *const gz_view_overlay_names[];

/** What a foveated picture is compared with. */
enum gz_view_compare {
	GZ_COMPARE_NONE,
	GZ_COMPARE_SPLIT,      /**< at its right the standard picture */
	GZ_COMPARE_DIFFERENCE, /**< what both differ by */
	GZ_COMPARE_COUNT,
};

/** "none", "split", "difference"; NULL-terminated. */
extern const char *const gz_view_compare_names[];

/** Greatest view.difference_gain: one grey level is a quarter of white. */
#define GZ_DIFFERENCE_GAIN_MAX 64.0

/** Settings of sections "view" and "views"; their table is gz_view_setting_options. */
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
	int compare;                        /**< enum gz_view_compare */
	double split;           /**< where the standard picture begins, as a share of the width */
	double difference_gain; /**< times, 1 to GZ_DIFFERENCE_GAIN_MAX */
	bool frame_times;       /**< the plot of what frames cost */
	char saved[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE]; /**< cameras to come back to, or empty */
};

/** Table over struct gz_view_settings. */
extern const struct gz_option gz_view_setting_options[];
extern const size_t gz_view_setting_option_count;

#endif
