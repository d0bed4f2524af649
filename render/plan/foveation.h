/**
 * @file
 * Settings of a plan: section [foveation] of a scene, and tables of spacings.
 */
#ifndef GZ_RENDER_PLAN_FOVEATION_H
#define GZ_RENDER_PLAN_FOVEATION_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "base/sizes.h"

#define GZ_SPACING_MAX 16 /**< largest spacing of a region's lattice, px */
#define GZ_PYRAMID_SPACING_MAX \
	32 /**< spacing of a pyramid's coarsest lattice, px: a power of two */

/** When steps along a ray grow with the distance from the gaze. */
enum gz_step_rule {
	GZ_STEP_METHOD, /**< by gz_method.own_steps */
	GZ_STEP_NONE,   /**< never */
	/** Bauer 2018, section 3.2.3: the sampling rate is max(sf * sr, floor) with
	 *  sf = 1 - d / diagonal. It is unchanged within 10 px of the gaze. */
	GZ_STEP_DISTANCE,
	/** By the spacing that the eye resolves: docs/foveation.md. */
	GZ_STEP_ACUITY,
};

/** "method", "none", "distance", "acuity"; NULL-terminated. */
extern const char *const gz_step_rule_names[];

/** Where samples lie along neighbouring rays whose steps are longer than the scene's. */
enum gz_step_phase {
	GZ_STEP_PHASE_LIT,         /**< interleaved if surfaces are lit, else aligned */
	GZ_STEP_PHASE_ALIGNED,     /**< at equal distances from where the rays enter the box */
	GZ_STEP_PHASE_INTERLEAVED, /**< gz_tile_phases apart */
};

/** "lit", "aligned", "interleaved"; NULL-terminated. */
extern const char *const gz_step_phase_names[];

/** How a pyramid fills the points between cast rays: docs/foveation.md has the formulas. */
enum gz_filter {
	GZ_FILTER_CATMULL_ROM, /**< from four points along an axis, clamped to the nearer two */
	GZ_FILTER_BILINEAR,
};

/** "catmull_rom", "bilinear"; NULL-terminated. */
extern const char *const gz_filter_names[];

#define GZ_SPACING_TABLE_MAX 64 /**< rows. Chosen: more than a curve needs */

/** One row of a user's table of spacings. */
struct gz_spacing_row {
	double eccentricity_deg; /**< 0 to 180 */
	double spacing;          /**< px or degrees, above 0 */
	double step;             /**< multiplier of the scene's step, 1 to 16 */
};

/** Spacing and step by eccentricity: linear between rows, constant before the first and after the
 *  last. Eccentricities rise from row to row; spacings and steps never fall. */
struct gz_spacing_table {
	bool in_deg; /**< spacings are degrees of visual angle, else pixels of the picture */
	int count;   /**< rows; 0 = no table */
	struct gz_spacing_row rows[GZ_SPACING_TABLE_MAX];
};

/** All settings of the methods; the option keys are "foveation.<name>". */
struct gz_foveation {
	int method;               /**< index into gz_methods (method.h) */
	int step_rule;            /**< enum gz_step_rule */
	int step_phase;           /**< enum gz_step_phase */
	int filter;               /**< enum gz_filter; pyramids only, regions are bilinear */
	double acuity_slope;      /**< m: degrees per cycle and degree of eccentricity */
	double acuity_foveal_deg; /**< omega0: degrees per cycle at the gaze */
	double acuity_full_deg;   /**< acuity, contrast: every pixel has a ray up to here */
	double acuity_far_deg;   /**< acuity, contrast: from here on spacings grow less, (0, 180) */
	double acuity_far_share; /**< by this share of acuity_slope, [0, 1] */
	double acuity_step_growth; /**< power of the acuity rule's step multipliers, [0, 1] */
	double acuity_step_error;  /**< most that longer steps may change, (0, 1]; 1: anything */
	double still_growth;  /**< rays that each further picture adds while nothing but the gaze
				 changes, as a share of the method's own, [0, 4] */
	double edge_contrast; /**< acuity: least contrast of an edge, (0, 1]; 1: none is one */
	double edge_finest;   /**< acuity: spacing at edges, times what the eye resolves */
	double contrast_threshold; /**< least contrast that is seen at the gaze, [0, 1] */
	double contrast_first; /**< spacing of the first rays beyond, times what the eye resolves */
	double contrast_finest;  /**< finest spacing, times what the eye resolves, (0, 1] */
	int contrast_rounds;     /**< most rounds of rays */
	double mdc_square_px;    /**< edge of the fine square, px of the picture */
	int mdc_spacing;         /**< outside the square */
	double mdc3_square_px;   /**< edge of the square around which mdc3's third region lies */
	int mdc3_spacing;        /**< in the third region */
	double ddc_inner_px[2];  /**< semi-axes of the inner ellipse, px of the picture */
	double ddc_middle_px[2]; /**< semi-axes of the middle ellipse */
	int ddc_spacing[3];      /**< inner, middle, outer */
	double blend_px;         /**< band at the borders of regions; 0 = a hard border */
	int uniform_spacing;
	double step_floor; /**< least sampling rate as a share of the full one, (0, 1] */
	char table_file[GZ_PATH_SIZE]; /**< path of the user's table; empty: none */
	struct gz_spacing_table table; /**< contents of that file: gz_spacing_table_load() */
};

/** Table over struct gz_foveation: "foveation.…". */
extern const struct gz_option gz_foveation_options[];
extern const size_t gz_foveation_option_count;

/** The presets of the option table. */
struct gz_foveation gz_foveation_default(void);

/** The presets with the method that casts a ray for every pixel: the reference for comparisons. */
struct gz_foveation gz_foveation_full(void);

/** Whether every option is within its range and, if the method needs one, the table of spacings is
 *  valid. */
bool gz_foveation_valid(const struct gz_foveation *foveation);

/** Whether all options have equal values and the tables of spacings are the same. */
bool gz_foveation_same(const struct gz_foveation *a, const struct gz_foveation *b);

/** Whether the plan depends on where someone looks: by the method's spacings or by the step rule.
 */
bool gz_foveation_follows_gaze(const struct gz_foveation *foveation);

/** Whether a table keeps the rules of struct gz_spacing_table. */
bool gz_spacing_table_valid(const struct gz_spacing_table *table);

/** Whether two tables have equal rows in the same unit. */
bool gz_spacing_table_same(const struct gz_spacing_table *a, const struct gz_spacing_table *b);

/**
 * Read a table of spacings from text. docs/scenes.md has the grammar.
 *
 * @param name  stands for the file in messages
 * @param[out] out_table  1 row or more; written on success only
 * @retval GZ_ERR_FORMAT  refused; logged with the line and the remedy
 */
enum gz_result gz_spacing_table_parse(const char *name, const char *text, size_t size,
				      const struct gz_log *log, struct gz_spacing_table *out_table);

/**
 * Read a table of spacings from a file.
 *
 * @param[out] out_table  as for gz_spacing_table_parse()
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     refused; logged with the line and the remedy
 * @retval GZ_ERR_NO_MEM     logged
 */
enum gz_result gz_spacing_table_load(const char *path, const struct gz_log *log,
				     struct gz_spacing_table *out_table);

#endif
