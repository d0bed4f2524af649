/**
 * @file
 * Internal to render/plan/: what the methods share about one frame.
 */
#ifndef GZ_RENDER_PLAN_PLAN_CONTEXT_H
#define GZ_RENDER_PLAN_PLAN_CONTEXT_H

#include "render/plan/method.h"
#include "render/plan/plan.h"

/** A function of eccentricity: linear between knots, constant before the first and after the last.
 */
struct gz_plan_curve {
	int count;
	double at_rad[GZ_SPACING_TABLE_MAX], value[GZ_SPACING_TABLE_MAX];
	double slope[GZ_SPACING_TABLE_MAX]; /**< from knot i to i + 1 */
};

/** What tiles are made for. */
enum gz_plan_round {
	GZ_ROUND_ONLY,    /**< nothing is known of the picture, and nothing follows */
	GZ_ROUND_FIRST,   /**< to find out where there is contrast */
	GZ_ROUND_FURTHER, /**< the contrast of a block is known */
};

/** How much the rays of a block differ: struct gz_node_contrast. */
struct gz_plan_contrast {
	double luminance, colour;
};

/** What a method needs to know about a frame. */
struct gz_plan_context {
	const struct gz_foveation *foveation;
	int width, height;
	double diagonal_px; /**< of the picture, in rays */
	double rays_per_px;
	double gaze_px[2]; /**< in rays, whose centres are whole numbers; may lie outside the
			      picture */
	enum gz_plan_steps steps;
	double gaze_unit[3]; /**< unit vector from the eye to the gaze */
	double px_mm[2];     /**< distance between neighbouring rays */
	double centre_px[2]; /**< point of the picture straight in front of the eye */
	double distance_mm;
	double rays_per_mm;           /**< along the axis with fewer */
	struct gz_plan_curve spacing; /**< rad, or px with spacing_in_px */
	bool spacing_in_px;
	double full_rad;                 /**< spacings are at most 1 px nearer to the gaze */
	struct gz_plan_curve step;       /**< of a table */
	double scale_all, scale_outside; /**< factors of spacings: everywhere, outside the fovea */
	double steps_per_px;             /**< of the request */
	double step_growth;              /**< power of the acuity rule's multipliers of steps */
	double finer, widen;             /**< of the request */
	enum gz_plan_round round;
	struct gz_plan_contrast contrast; /**< GZ_ROUND_FURTHER: of the block that is looked at */
	double uniform_px; /**< spacing of the uniform plan that widen leads to, once known */
};

/** Prepare the context of a frame. A gaze that is NaN or infinite is replaced by the centre. */
void gz_plan_context_make(const struct gz_plan_request *request,
			  struct gz_plan_context *out_context);

/** Set the spacing curve to what the eye resolves. */
void gz_plan_set_acuity_curve(struct gz_plan_context *context);

/** Set it to where acuity casts rays: what the eye resolves up to acuity_far_deg, and rays that
 *  are nearer to each other beyond. Set full_rad to the setting. */
void gz_plan_set_ray_curve(struct gz_plan_context *context);

/** Set the spacing and step curves from the user's table. */
void gz_plan_set_table_curves(struct gz_plan_context *context);

/** Spacing in px that the curve asks for at position (x, y), after scaling and widening. Positions
 *  are in rays and need not be whole. The spacing grows with the distance from the gaze. */
double gz_plan_spacing_at(const struct gz_plan_context *context, double x, double y);

/** Rungs of the ladder of spacings: 1, sqrt 2, 2, 2 sqrt 2, ... 16 sqrt 2, 32, each with its step.
 */
#define GZ_LADDER_RUNGS 11

/** Spacings of the rungs, px. Rung 2k is the square lattice of layer k, rung 2k + 1 its quincunx.
 */
extern const double gz_ladder_px[GZ_LADDER_RUNGS];

/** The coarsest rung whose spacing is at most @p spacing_px. 0 below
 *  sqrt 2 px. */
int gz_ladder_rung(double spacing_px);

/** Set the plan's step multipliers by the context's step rule. */
void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan);

/** Index of the step multiplier for the block of @p edge pixels at (x, y). The block's point
 * nearest to the gaze decides, so no ray of the block has a longer step than its own distance
 * allows. */
int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge);

/** Make room for @p count more tiles. GZ_ERR_NO_MEM. */
enum gz_result gz_plan_reserve(struct gz_plan *plan, size_t count);

/** Append a tile unless it casts no ray. There must be room for it. */
void gz_plan_append(struct gz_plan *plan, struct gz_tile tile);

/** gz_plan_append() for a tile all of whose points lie on its lattice. */
static inline void gz_plan_append_whole(struct gz_plan *plan, struct gz_tile tile)
{
	plan->ray_count += (uint64_t)GZ_TILE_EDGE * GZ_TILE_EDGE;
	plan->tiles[plan->tile_count++] = tile;
}

/** A layer whose lattice spans the picture. */
struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing,
					struct gz_region region);

/** Fill layers, reconstruction and tiles for a method with gz_method.add_regions. */
enum gz_result gz_plan_regions(const struct gz_plan_context *context, struct gz_plan *plan);

/** Fill layers, reconstruction and tiles for a method with gz_method.set_curves. */
enum gz_result gz_plan_ladder(struct gz_plan_context *context, struct gz_plan *plan);

/** See gz_plan_refine(). Changes the context's contrast. */
enum gz_result gz_plan_ladder_refine(struct gz_plan_context *context, struct gz_plan *plan,
				     size_t from, const struct gz_node_contrast *contrasts);

#endif
