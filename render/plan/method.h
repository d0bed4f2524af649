/**
 * @file
 * The foveation methods. A method decides where rays go and how long their steps are. Its row in
 * gz_methods[] answers every question that other code has about it.
 */
#ifndef GZ_RENDER_PLAN_METHOD_H
#define GZ_RENDER_PLAN_METHOD_H

#include <stdbool.h>

#include "render/plan/foveation.h"

struct gz_plan;
struct gz_plan_context;

/** Rows of gz_methods, in the order of the option's values. Only method.c and tests name them;
 * other code asks the row. */
enum gz_method_index {
	GZ_METHOD_STANDARD,
	GZ_METHOD_MDC,
	GZ_METHOD_DDC,
	GZ_METHOD_ACUITY,
	GZ_METHOD_MDC3,
	GZ_METHOD_UNIFORM,
	GZ_METHOD_TABLE,
	GZ_METHOD_CONTRAST,
	GZ_METHOD_COUNT,
};

/** Where the steps of a plan come from. */
enum gz_plan_steps {
	GZ_STEPS_ONE,      /**< 1 everywhere */
	GZ_STEPS_DISTANCE, /**< by distance from the gaze (GZ_STEP_DISTANCE) */
	GZ_STEPS_RUNG,     /**< from the rung of a tile, which is what the eye resolves */
	GZ_STEPS_PLACE,    /**< from the spacing that the eye resolves at a tile's place */
	GZ_STEPS_TABLE,    /**< from the user's table */
};

/** One method. Every row is const and has static storage. */
struct gz_method {
	const char *help;    /**< one line for lists */
	bool follows_gaze;   /**< spacings depend on where someone looks */
	bool sharp_at_gaze;  /**< with its presets, each pixel of the fovea has a ray */
	bool can_be_coarser; /**< a time budget and a lost gaze can make it coarser */
	bool needs_table;    /**< a table of spacings must be given */
	bool has_borders;    /**< its regions meet at borders, which foveation.blend_px softens */
	bool refines;        /**< its first tiles show where further ones go: gz_plan_refine() */
	bool refines_edges;  /**< so do those of its tiles that lie at edges: foveation.edge_… */
	bool is_pyramid; /**< its lattices form a pyramid, which foveation.reconstruction fills */
	enum gz_plan_steps own_steps; /**< what GZ_STEP_METHOD means */
	/** Pyramids: set the context's spacing by eccentricity, and its step if own_steps is
	 *  GZ_STEPS_TABLE. NULL for methods of regions. */
	void (*set_curves)(struct gz_plan_context *context);
	/** Methods of regions: add the plan's layers, nearest to the gaze first. NULL for
	 *  pyramids. */
	void (*add_regions)(const struct gz_plan_context *context, struct gz_plan *plan);
};

/** All methods; GZ_METHOD_COUNT rows. */
extern const struct gz_method gz_methods[];

/** Their names, in the order of the rows: "standard", "mdc", "ddc", "acuity", "mdc3", "uniform",
 *  "table", "contrast"; NULL-terminated. */
extern const char *const gz_method_names[];

/** The row of a foveation's method. */
const struct gz_method *gz_method_of(const struct gz_foveation *foveation);

/** The name of a foveation's method; static text. */
const char *gz_method_name(const struct gz_foveation *foveation);

/** Index of the method with this name; -1 if there is none. */
int gz_method_find(const char *name);

/** Index of the method that casts a ray for every pixel. */
int gz_method_full(void);

#endif
