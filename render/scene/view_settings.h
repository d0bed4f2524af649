/**
 * @file
 * What a viewer draws over the picture or shows in its place, and the views that keys bring back:
 * sections "view" and "views" of a scene. The renderer itself does not use them.
 */
#ifndef GZ_RENDER_SCENE_VIEW_SETTINGS_H
#define GZ_RENDER_SCENE_VIEW_SETTINGS_H

#include <stdbool.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "base/sizes.h"
#include "render/picture/camera.h"
#include "render/section/distances.h"

/** What the plan's tiles are tinted by. */
enum gz_view_overlay {
	GZ_OVERLAY_NONE,
	GZ_OVERLAY_SPACING, /**< between rays */
	GZ_OVERLAY_STEP,    /**< along rays */
	GZ_OVERLAY_COUNT,
};

/** "none", "spacing", "step"; NULL-terminated. */
extern const char *const gz_view_overlay_names[];

/** How a foveated picture is compared with the full one. */
enum gz_view_compare {
	GZ_COMPARE_NONE,
	GZ_COMPARE_SPLIT,      /**< the standard picture on the right */
	GZ_COMPARE_DIFFERENCE, /**< the difference of both */
	GZ_COMPARE_COUNT,
};

/** "none", "split", "difference"; NULL-terminated. */
extern const char *const gz_view_compare_names[];

/** What a picture is compared with. */
enum gz_view_compare_with {
	GZ_COMPARE_WITH_STANDARD,
	GZ_COMPARE_WITH_PLAIN, /**< of an illustration: the surfaces under a plain lamp */
	GZ_COMPARE_WITH_COUNT,
};

/** "standard", "plain"; NULL-terminated. */
extern const char *const gz_view_compare_with_names[];

/** What fills a window. */
enum gz_view_layout {
	GZ_LAYOUT_PICTURE,
	GZ_LAYOUT_SLICES, /**< axial, coronal and sagittal slice, and the picture: a quarter each */
	GZ_LAYOUT_COUNT,
};

/** "picture", "slices"; NULL-terminated. */
extern const char *const gz_view_layout_names[];

/** What moves the crosshair of slices besides clicks and drags. */
enum gz_view_follows {
	GZ_FOLLOWS_NONE,
	GZ_FOLLOWS_MOUSE, /**< the mouse over a slice */
	GZ_FOLLOWS_GAZE,  /**< a gaze that rests on a slice */
	GZ_FOLLOWS_COUNT,
};

/** "none", "mouse", "gaze"; NULL-terminated. */
extern const char *const gz_view_follows_names[];

/** Greatest view.slice_level and view.slice_width, data values. */
#define GZ_SLICE_VALUE_MAX 1e9

/** Greatest view.difference_gain: one grey level is shown as a quarter of white. */
#define GZ_DIFFERENCE_GAIN_MAX 64.0

/** Number of saved views in a scene. */
#define GZ_SAVED_VIEWS 8

/** Size of a saved view as text, with its NUL: ten numbers of up to 24 characters, and words. */
#define GZ_SAVED_VIEW_SIZE 320

/** Settings of sections "view" and "views"; their table is gz_view_setting_options. */
struct gz_view_settings {
	bool gaze_cursor;        /**< a cross at the gaze point */
	bool letters;            /**< letters at the picture's edges for the body's sides */
	int overlay;             /**< enum gz_view_overlay */
	bool trail;              /**< the gaze of the last second */
	bool vsync;              /**< the window waits for the display's refresh */
	char gaze[GZ_PATH_SIZE]; /**< source of the gaze in a window, as for --gaze; empty: the
				    source stays */
	char tracker_display[GZ_NAME_SIZE]; /**< monitor of the tracker's gaze, by name or number
					       from 1; empty: automatic */
	int compare;                        /**< enum gz_view_compare */
	int compare_with;                   /**< enum gz_view_compare_with */
	double split; /**< where the standard picture begins, as a fraction of the width */
	double difference_gain; /**< factor, 1 to GZ_DIFFERENCE_GAIN_MAX */
	bool frame_times;       /**< the plot of the frame times */
	bool gaze_mark;         /**< a circle at the gaze in comparisons */
	bool refine;            /**< the window shows full quality while camera and gaze rest */
	int layout;             /**< enum gz_view_layout */
	double crosshair[3];    /**< of slices: fractions of the box along x, y, z */
	int crosshair_follows;  /**< enum gz_view_follows */
	bool slice_colours;     /**< those of the transfer function, over grey */
	double slice_level;     /**< data value of middle grey, if slice_width is above 0 */
	double slice_width;     /**< data values from black to white; 0: those of the volume */
	char distances[GZ_DISTANCES_SIZE]; /**< measured in slices: gz_distances_parse() */
	char saved[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE]; /**< saved views; empty: none */
};

/** Table over struct gz_view_settings. */
extern const struct gz_option gz_view_setting_options[];
extern const size_t gz_view_setting_option_count;

/**
 * Print a camera as a saved view: keys "views.1" to "views.8". gz_saved_view_parse() reads it back
 * to the same bits. The words are the keys of section "camera"; the last one gives the projection.
 *
 *     eye 0 -2 0.5 look_at 0 0 0 up 0 0 1 fov_deg 40
 *     eye 0 -2 0.5 look_at 0 0 0 up 0 0 1 height 1.5
 */
void gz_saved_view_print(const struct gz_camera *camera, char out_text[GZ_SAVED_VIEW_SIZE]);

/**
 * Read a saved view.
 *
 * @param[in,out] camera  set on success; of fov_deg and height, the one that the text does not give
 *                        stays
 * @retval GZ_ERR_FORMAT  another form, or a camera that sees nothing (gz_camera_rays())
 */
enum gz_result gz_saved_view_parse(const char *text, struct gz_camera *camera);

/**
 * Check the saved views that are not empty.
 *
 * @param name  the views' source in messages
 * @param log   may be NULL
 * @retval GZ_ERR_FORMAT  one is not a view; logged with its key and the form
 */
enum gz_result gz_saved_views_check(const char views[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE],
				    const char *name, const struct gz_log *log);

#endif
