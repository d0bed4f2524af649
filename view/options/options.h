/**
 * @file
 * gazeview's command line: its option table, the scene keys it accepts, and the texts with a parser
 * of their own (--gaze, --out).
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

/** Upper limit of gz_view_option_count. */
#define GZ_VIEW_OPTIONS_MAX 80

/** Kind of gaze source. */
enum gz_gaze_kind {
	GZ_GAZE_CENTRE,  /**< the projection of the camera's look_at */
	GZ_GAZE_FIXED,   /**< a point */
	GZ_GAZE_MOUSE,   /**< window only */
	GZ_GAZE_POINTER, /**< the mouse through the local daemon's pointer driver; window only */
	GZ_GAZE_LATEST,  /**< a daemon's latest channel */
	GZ_GAZE_LOG,     /**< a gaze log, through the daemon's pipeline in process */
};

/** What to do about bricks of the volume that are not loaded yet. */
enum gz_bricks_rule {
	GZ_BRICKS_AUTO,   /**< wait if headless, otherwise stream */
	GZ_BRICKS_WAIT,   /**< wait for all visible bricks */
	GZ_BRICKS_STREAM, /**< show coarser bricks meanwhile */
};

/** The parsed --gaze. */
struct gz_gaze_choice {
	enum gz_gaze_kind kind;
	struct gz_point point;   /**< FIXED */
	char text[GZ_PATH_SIZE]; /**< LATEST: endpoint, empty: the local daemon's; LOG: path */
};

/** Everything on the command line. */
struct gz_view_options {
	bool help;
	bool version;
	bool formats;
	bool headless;
	char scene[GZ_PATH_SIZE];
	int size_px[2];
	char gaze_text[GZ_PATH_SIZE];
	struct gz_gaze_choice gaze;
	double fps;
	int method;    /**< enum gz_method; -1: the scene's */
	int technique; /**< as in struct gz_scene_settings; -1: the scene's */
	char backend[GZ_NAME_SIZE];
	int threads;
	char simd[GZ_NAME_SIZE];
	int gl_memory_mib; /**< 0: all that is free */
	int frames;
	char out[GZ_PATH_SIZE];          /**< empty: write no pictures */
	char video[GZ_PATH_SIZE];        /**< empty: none */
	char print[GZ_PATH_SIZE];        /**< a drawing for print; empty: none */
	double print_mm, print_dpi;      /**< its width, mm, and resolution */
	char record[GZ_PATH_SIZE];       /**< folder of a session; empty: none */
	char replay[GZ_PATH_SIZE];       /**< folder of a session; empty: none */
	char pictures[GZ_PATH_SIZE];     /**< folder for the files a window writes */
	char stats[GZ_PATH_SIZE];        /**< empty: none */
	char write_volume[GZ_PATH_SIZE]; /**< empty: none */
	char write_mesh[GZ_PATH_SIZE];   /**< empty: none */
	double isovalue;                 /**< of that mesh, or of the surface shown; see given */
	bool list_objects;               /**< of the scene, and exit */
	bool list_series;                /**< of the folder or file in scene, and exit */
	int bricks;                      /**< enum gz_bricks_rule */
	int time_point;                  /**< of a series, from 1; 0: the scene's */
	double play; /**< rate of its time points, steps per second; 0: the picture stays */
	double turn_deg;
	bool cross;
	bool letters;
	bool fullscreen;
	bool menu; /**< the menu bar is shown */
	bool vsync;
	double interface_scale; /**< 0: from the display */
	int measure_window;     /**< frames of each kind; 0: do not measure */
	bool gaze_fills_window;
	char tracker_display[GZ_NAME_SIZE]; /**< empty: the scene's */
	int display_px[2];                  /**< 0: not given */
	double display_mm[2];               /**< 0: not given */
	double display_distance_mm;         /**< 0: not given */

	int volume_dims[3];                 /**< of a raw file; 0: not given */
	int volume_type;                    /**< enum gz_raw_type; -1: not given */
	int volume_endian;                  /**< 0 little, 1 big; -1: not given */
	int volume_channels;                /**< of a raw file; 0: not given */
	int volume_opacity;                 /**< enum gz_opacity_source; -1: not given */
	char volume_series[GZ_SERIES_SIZE]; /**< empty: not given */
	int volume_resample;                /**< enum gz_resampling; -1: not given */
	bool resample;                      /**< short for volume_resample GZ_RESAMPLING_LINEAR */
	struct gz_particle_grid particles;  /**< those that are given replace the scene's */
	bool particles_given[GZ_PARTICLE_GRID_OPTIONS];
	double volume_spacing[3];         /**< 0: not given */
	int transfer_preset;              /**< of gz_transfer_preset_choices; -1: not given */
	char transfer_file[GZ_PATH_SIZE]; /**< replaces the scene's; empty: not given */

	struct gz_target_options target; /**< targets instead of a scene, if any are named */

	struct gz_sitting_options sitting; /**< an experiment instead of a scene, if one is named */

	bool given[GZ_VIEW_OPTIONS_MAX]; /**< for each row of gz_view_option_table */

	/** Scene keys given on the command line; gz_view_options_apply() copies them. */
	struct gz_scene_settings scene_settings;
	bool scene_given[GZ_VIEW_SCENE_KEYS_MAX]; /**< for each key, table by table */
};

/** Table over struct gz_view_options. */
extern const struct gz_option gz_view_option_table[];
extern const size_t gz_view_option_count;

/**
 * Read the command line and check everything that needs no file: for instance that headless output
 * is not asked for in a window, and the mouse not without one.
 *
 * @param[out] out_options  on failure filled up to the error
 * @retval GZ_ERR_INVAL  refused; one line is logged, with the remedy
 */
enum gz_result gz_view_options_read(int argc, char *const *argv, const struct gz_log *log,
				    struct gz_view_options *out_options);

/** Whether the command line gave an option, by its key; false for unknown ones. */
bool gz_view_option_given(const struct gz_view_options *options, const char *key);

/** Print --help: usage, all options, and the scene keys that are accepted. */
void gz_view_options_print_help(FILE *out);

/** Get the layout of a raw file from the options. @return false if they give none */
bool gz_view_options_raw(const struct gz_view_options *options, struct gz_raw_layout *out_raw);

/**
 * Replace the scene's settings by the command line's scene keys, --method, --transfer.file and the
 * short names of view keys.
 *
 * @return GZ_OK; an error of gz_option_format() or gz_option_parse() would be a bug
 */
enum gz_result gz_view_options_apply(const struct gz_view_options *options,
				     struct gz_scene_settings *settings);

/** What options set in section view for one run; saved scenes do not get it. */
enum gz_view_run {
	GZ_VIEW_RUN_GAZE = 1,            /**< --gaze */
	GZ_VIEW_RUN_TRACKER_DISPLAY = 2, /**< --tracker-display */
	GZ_VIEW_RUN_CROSS = 4,           /**< --cross */
	GZ_VIEW_RUN_LETTERS = 8,         /**< --letters */
	GZ_VIEW_RUN_VSYNC = 16,          /**< --vsync */
};

/** Which settings of @p view are as such an option has set them. @return bits of enum gz_view_run
 */
unsigned gz_view_options_run(const struct gz_view_options *options,
			     const struct gz_view_settings *view);

/** Copy the settings of @p which, bits of enum gz_view_run. */
void gz_view_run_copy(unsigned which, const struct gz_view_settings *from,
		      struct gz_view_settings *to);

/**
 * Parse --gaze: "centre", "mouse", "pointer", "daemon", "X,Y", an endpoint (ipc://, tcp://) or the
 * name of a .gzl file.
 *
 * @retval GZ_ERR_INVAL  none of these, a number that is not finite, or too long; logged
 */
enum gz_result gz_gaze_choice_parse(const char *text, const struct gz_log *log,
				    struct gz_gaze_choice *out_choice);

/**
 * Check a pattern for the names of @p frames pictures. It has at most one conversion, %d with an
 * optional 0 and width (1 to 9), and exactly one if there are several pictures. "%%" is a percent
 * sign.
 *
 * @retval GZ_ERR_INVAL  refused; logged
 */
enum gz_result gz_pattern_check(const char *pattern, int frames, const struct gz_log *log);

/**
 * Print the name of picture @p number.
 *
 * @retval GZ_ERR_FULL   @p size is too small
 * @retval GZ_ERR_INVAL  gz_pattern_check() refuses the pattern
 */
enum gz_result gz_pattern_format(const char *pattern, int number, char *path, size_t size);

/**
 * The geometry of the picture's display. Each field comes from the command line, otherwise from
 * @p known, otherwise from the default display of the picture's size.
 *
 * @param known          from the scene, the log or the daemon, the first that has one; NULL: none
 * @param width, height  of the picture, px
 */
struct gz_display gz_view_display(const struct gz_view_options *options,
				  const struct gz_display *known, int width, int height);

#endif
