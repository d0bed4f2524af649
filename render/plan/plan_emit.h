/**
 * @file
 * Inside the plan: what the methods share. Not for users of render/.
 */
#ifndef GZ_RENDER_PLAN_EMIT_H
#define GZ_RENDER_PLAN_EMIT_H

#include "render/plan/plan.h"

/** What a method needs to know of a frame. */
struct gz_plan_context {
	const struct gz_foveation *foveation;
	int width, height;
	double gaze_px[2];           /**< where pixel centres are whole numbers; may lie outside */
	enum gz_step_rule step_rule; /**< resolved: never GZ_STEP_METHOD */
	double gaze_mm[3];           /**< unit vector from the eye to the gaze */
	double px_mm[2];             /**< size of a pixel */
	double centre_px[2];         /**< foot of the eye on the picture */
	double distance_mm;
};

/** Prepare the context of a frame; a gaze that is NaN or infinite becomes the centre. */
struct gz_plan_context gz_plan_context_make(const struct gz_foveation *foveation,
					    const struct gz_display *display, struct gz_point gaze,
					    int width, int height);

/** Spacing in px that the eye resolves at pixel position (x, y), which need not be whole. */
double gz_plan_spacing_at(const struct gz_plan_context *context, double x, double y);

/** Append a tile. GZ_ERR_NO_MEM. */
enum gz_result gz_plan_add(struct gz_plan *plan, struct gz_tile tile);

/** Rungs of the acuity ladder: spacings 1, 2, 2 sqrt 2, 4, 4 sqrt 2, 8, 8 sqrt 2, 16, each with its
 * step. */
#define GZ_ACUITY_RUNGS 8

/** The coarsest rung whose spacing is at most @p spacing_px; 0 below 2 px, where the display limits
 * the eye. */
int gz_acuity_rung(double spacing_px);

/** Set ray_count from the tiles. */
void gz_plan_count_rays(struct gz_plan *plan);

/** Set the step multipliers that the context's rule asks for. */
void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan);

/** A layer whose lattice spans the picture. */
struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing,
					struct gz_region region);

/** Index of the step multiplier for the block of @p edge pixels at (x, y), by its point nearest to
 * the gaze, so that no ray of it is coarser than its own distance allows. */
int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge);

/* One method each; they fill layers, reconstruction and tiles. */
enum gz_result gz_plan_standard(const struct gz_plan_context *context, struct gz_plan *plan);
enum gz_result gz_plan_mdc(const struct gz_plan_context *context, struct gz_plan *plan);
enum gz_result gz_plan_ddc(const struct gz_plan_context *context, struct gz_plan *plan);
enum gz_result gz_plan_acuity(const struct gz_plan_context *context, struct gz_plan *plan);

#endif
