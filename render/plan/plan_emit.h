/**
 * @file
 * Inside the plan: what the methods share. Not for users of render/.
 */
#ifndef GZ_RENDER_PLAN_EMIT_H
#define GZ_RENDER_PLAN_EMIT_H

#include "render/plan/plan.h"

/** A function of eccentricity: linear between knots, constant beyond the first and last. */
struct gz_plan_curve {
	int count;
	double at_rad[GZ_SPACING_TABLE_MAX], value[GZ_SPACING_TABLE_MAX];
	double slope[GZ_SPACING_TABLE_MAX]; /**< from knot i to i + 1 */
};

/** Where steps come from, once GZ_STEP_METHOD is resolved. */
enum gz_plan_steps {
	GZ_STEPS_ONE,      /**< 1 everywhere */
	GZ_STEPS_DISTANCE, /**< Bauer's rule */
	GZ_STEPS_RUNG,     /**< by the rung of the spacing that context.spacing gives */
	GZ_STEPS_TABLE,    /**< the user's column */
};

/** What a method needs to know of a frame. */
struct gz_plan_context {
	const struct gz_foveation *foveation;
	int width, height;
	double diagonal_px; /**< of the picture, in rays */
	double rays_per_px;
	double gaze_px[2]; /**< in rays, where their centres are whole numbers; may lie outside */
	enum gz_plan_steps steps;
	double gaze_unit[3]; /**< from the eye to the gaze */
	double px_mm[2];     /**< from ray to ray */
	double centre_px[2]; /**< foot of the eye on the picture */
	double distance_mm;
	double rays_per_mm;           /**< along the axis where they are fewer */
	struct gz_plan_curve spacing; /**< angles, rad, or pixels */
	bool spacing_in_px;
	struct gz_plan_curve step;       /**< of a table */
	double scale_all, scale_outside; /**< factors of spacings: everywhere, past the fovea */
	double steps_per_px;             /**< as in the request */
	double widen;
	double uniform_px; /**< spacing of the uniform plan that widen goes to, once it is known */
};

/** Prepare the context of a frame; a gaze that is NaN or infinite becomes the centre. */
void gz_plan_context_make(const struct gz_plan_request *request,
			  struct gz_plan_context *out_context);

/** Spacing in px asked for at position (x, y), in rays and not necessarily whole: what the eye
 *  resolves, or the user's table, as scaled and widened. Grows with distance from the gaze. */
double gz_plan_spacing_at(const struct gz_plan_context *context, double x, double y);

/** Step multiplier by the user's table at a position. */
double gz_plan_table_step_at(const struct gz_plan_context *context, double x, double y);

/** Make room for @p count more tiles. GZ_ERR_NO_MEM. */
enum gz_result gz_plan_reserve(struct gz_plan *plan, size_t count);

/** Append a tile, for which there must be room, if it casts anything. */
void gz_plan_append(struct gz_plan *plan, struct gz_tile tile);

/** As gz_plan_append() for a tile all of whose points lie on its lattice. */
static inline void gz_plan_append_whole(struct gz_plan *plan, struct gz_tile tile)
{
	plan->ray_count += (uint64_t)GZ_TILE_EDGE * GZ_TILE_EDGE;
	plan->tiles[plan->tile_count++] = tile;
}

/** Rungs of the ladder of spacings: 1, 2, 2 sqrt 2, 4, ... 16 sqrt 2, 32, each with its step. */
#define GZ_LADDER_RUNGS 10

/** Spacings of the rungs, px. Rung 2k - 1 is the square lattice of layer k, rung 2k its quincunx;
 *  rung 0 is layer 0. */
extern const double gz_ladder_px[GZ_LADDER_RUNGS];

/** The coarsest rung whose spacing is at most @p spacing_px; 0 below 2 px, where the display limits
 * the eye. */
int gz_ladder_rung(double spacing_px);

/** Set the step multipliers that the context's rule asks for. */
void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan);

/** A layer whose lattice spans the picture. */
struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing,
					struct gz_region region);

/** Index of the step multiplier for the block of @p edge pixels at (x, y), by its point nearest to
 * the gaze, so that no ray of it is coarser than its own distance allows. */
int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge);

/* The methods; they fill layers, reconstruction and tiles. */

/** Nested regions: standard, uniform, mdc, mdc3, ddc. */
enum gz_result gz_plan_regions(const struct gz_plan_context *context, struct gz_plan *plan);

/** A spacing for each eccentricity: acuity, table. */
enum gz_result gz_plan_ladder(struct gz_plan_context *context, struct gz_plan *plan);

#endif
