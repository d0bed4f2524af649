/**
 * @file
 * gazeview's command line: one table, the scene's own keys beside it, and the small texts that need
 * a parser of their own (--gaze, --out).
 */
#ifndef GZ_VIEW_OPTIONS_OPTIONS_H
#define GZ_VIEW_OPTIONS_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene.h"
#include "view/experiment/sitting.h"
#include "view/options/target_options.h"
#include "view/settings/scene_keys.h"

/** Most options of gz_view_option_table. */
#define GZ_VIEW_OPTIONS_MAX 64

/** Where the gaze comes from. */
enum gz_gaze_kind {
	GZ_GAZE_CENTRE, /**< where the camera's look_at appears */
	GZ_GAZE_FIXED,
	GZ_GAZE_MOUSE,   /**< window only */
	GZ_GAZE_POINTER, /**< the mouse, through the local daemon's pointer driver; window only */
	GZ_GAZE_LATEST,  /**< a daemon's latest channel */
	GZ_GAZE_LOG,     /**< a gaze log, through the daemon's pipeline in process */
};

/** What a picture of a volume shown by bricks does about those that are not there yet. */
enum gz_bricks_rule {
	GZ_BRICKS_AUTO, /**< wait without a window, else stream */
	GZ_BRICKS_WAIT,
	GZ_BRICKS_STREAM, /**< show coarser ones meanwhile */
};

/** --gaze, understood. */
struct gz_gaze_choice {
	enum gz_gaze_kind kind;
	struct gz_point point;   /**< FIXED */
	char text[GZ_PATH_SIZE]; /**< LATEST: endpoint, empty for the local daemon's; LOG: path */
};

/** Everything the command line says. */
struct gz_view_options {
	bool help;
	bool version;
	bool headless;
	char scene[GZ_PATH_SIZE];
	int size_px[2];
	char gaze_text[GZ_PATH_SIZE];
	struct gz_gaze_choice gaze;
	double fps;
	int method; /**< enum gz_method; -1: as the scene says */
	char backend[GZ_NAME_SIZE];
	int threads;
	char simd[GZ_NAME_SIZE];
	int gl_memory_mib; /**< 0: what the device has */
	int frames;
	char out[GZ_PATH_SIZE];          /**< empty: no pictures are written */
	char video[GZ_PATH_SIZE];        /**< empty: none */
	char record[GZ_PATH_SIZE];       /**< folder of a session; empty: none */
	char replay[GZ_PATH_SIZE];       /**< folder of a session; empty: none */
	char pictures[GZ_PATH_SIZE];     /**< folder for what a window writes */
	char stats[GZ_PATH_SIZE];        /**< empty: none */
	char write_volume[GZ_PATH_SIZE]; /**< empty: none */
	int bricks;                      /**< enum gz_bricks_rule */
	double turn_deg;
	bool cross;
	bool letters;
	bool fullscreen;
	bool vsync;
	double interface_scale; /**< 0: what the display says */
	int measure_window;     /**< frames of each kind; 0: nothing is measured */
	bool gaze_fills_window;
	char tracker_display[GZ_NAME_SIZE]; /**< empty: as the scene says */
	int display_px[2];                  /**< 0: not given */
	double display_mm[2];               /**< 0: not given */
	double display_distance_mm;         /**< 0: not given */

	int volume_dims[3];               /**< of a raw file; 0: not given */
	int volume_type;                  /**< enum gz_raw_type; -1: not given */
	int volume_endian;                /**< 0 little, 1 big; -1: not given */
	double volume_spacing[3];         /**< 0: not given */
	char transfer_file[GZ_PATH_SIZE]; /**< in place of the scene's; empty: not given */

	struct gz_target_options target; /**< targets instead of a scene, where any are named */

	struct gz_sitting_options
		sitting; /**< an experiment instead of a scene, where one is named */

	bool given[GZ_VIEW_OPTIONS_MAX]; /**< of gz_view_option_table, in its order */

	/** Scene keys given on the command line, to be copied over what the scene file says. */
	struct gz_scene_settings scene_settings;
	bool scene_given[GZ_VIEW_SCENE_KEYS_MAX]; /**< table by table */
};

/** Table over struct gz_view_options. */
extern const struct gz_option gz_view_option_table[];
extern const size_t gz_view_option_count;

/**
 * Read the command line, and check what needs no file.
 *
 * @param[out] out_options  filled also on failure, as far as it went
 * @retval GZ_ERR_INVAL  refused; logged, one line with the remedy
 */
enum gz_result gz_view_options_read(int argc, char *const *argv, const struct gz_log *log,
				    struct gz_view_options *out_options);

/** Print how gazeview is called, every option, and the scene keys that may be given too. */
void gz_view_options_print_help(FILE *out);

/** The layout of a raw file that the options tell. @return false: they tell none */
bool gz_view_options_raw(const struct gz_view_options *options, struct gz_raw_layout *out_raw);

/** Copy the scene keys of the command line, --method and --transfer.file over the scene's own. */
enum gz_result gz_view_options_apply(const struct gz_view_options *options,
				     struct gz_scene_settings *settings);

/**
 * Understand a --gaze text: "centre", "mouse", "pointer", "daemon", "X,Y", an endpoint (ipc://,
 * tcp://) or the name of a .gzl file.
 *
 * @retval GZ_ERR_INVAL  none of these, or a number that is not finite; logged
 */
enum gz_result gz_gaze_choice_parse(const char *text, const struct gz_log *log,
				    struct gz_gaze_choice *out_choice);

/**
 * Check a PATTERN for @p frames pictures: at most one conversion, %d with an optional 0 and width
 * (1 to 9), "%%" for a percent sign; exactly one where there are several pictures.
 *
 * @retval GZ_ERR_INVAL  refused; logged
 */
enum gz_result gz_pattern_check(const char *pattern, int frames, const struct gz_log *log);

/**
 * The name of picture @p number by a checked pattern.
 *
 * @retval GZ_ERR_FULL   @p size is too small
 * @retval GZ_ERR_INVAL  a pattern that gz_pattern_check() refuses
 */
enum gz_result gz_pattern_format(const char *pattern, int number, char *path, size_t size);

/**
 * The geometry of the picture's display: the command line over @p known, field by field, over the
 * default at the picture's size.
 *
 * @param known  from the scene, the log or the daemon, the first that knows; NULL if none does
 */
struct gz_display gz_view_display(const struct gz_view_options *options,
				  const struct gz_display *known, int width, int height);

#endif
