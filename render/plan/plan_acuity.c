/*
 * The acuity method: a quadtree of tiles, split while the eye resolves more than a tile would show.
 */
#include "render/plan/plan_emit.h"

enum { LEVELS = 5 };

static double nearest_to(double place, int from, int edge)
{
	return place < from ? from : place > from + edge ? from + edge : place;
}

/* What a block asks for: the spacing at its point nearest to the gaze. */
static double block_spacing(const struct gz_plan_context *context, int x, int y, int edge)
{
	const double near_x = nearest_to(context->gaze_px[0], x, edge);
	const double near_y = nearest_to(context->gaze_px[1], y, edge);
	return gz_plan_spacing_at(context, near_x, near_y);
}

/* Lattice and pattern of each rung. */
static const struct rung {
	uint8_t layer, pattern;
} rungs[GZ_ACUITY_RUNGS] = {
	{ 0, GZ_TILE_SQUARE },   { 1, GZ_TILE_SQUARE },   { 1, GZ_TILE_QUINCUNX },
	{ 2, GZ_TILE_SQUARE },   { 2, GZ_TILE_QUINCUNX }, { 3, GZ_TILE_SQUARE },
	{ 3, GZ_TILE_QUINCUNX }, { 4, GZ_TILE_SQUARE },
};

/* Cast a node: one square tile of its own level's lattice or, one above the other, two quincunx
 * tiles of the level below. */
static enum gz_result cast_node(const struct gz_plan_context *context, struct gz_plan *plan, int x,
				int y, int rung, int edge)
{
	/* A step of this rung's own, or one that serves whatever is cast. */
	const int step = context->step_rule == GZ_STEP_ACUITY
				 ? rung
				 : gz_plan_step_for(context, plan, x, y, edge);
	const struct gz_tile tile = {
		.x = (uint16_t)x,
		.y = (uint16_t)y,
		.layer = rungs[rung].layer,
		.step = (uint8_t)step,
		.pattern = rungs[rung].pattern,
	};
	enum gz_result result = gz_plan_add(plan, tile);
	if (result != GZ_OK || tile.pattern == GZ_TILE_SQUARE)
		return result;
	struct gz_tile lower = tile;
	lower.y = (uint16_t)(y + edge / 2);
	return gz_plan_add(plan, lower);
}

static enum gz_result subdivide(const struct gz_plan_context *context, struct gz_plan *plan, int x,
				int y, int level)
{
	const struct gz_plan_layer *coarsest = &plan->layers[LEVELS - 1];
	const int edge = GZ_TILE_EDGE << level;
	if (x > (coarsest->columns - 1) * coarsest->spacing ||
	    y > (coarsest->rows - 1) * coarsest->spacing)
		return GZ_OK; /* no lattice point of any level lies there */
	const int rung = gz_acuity_rung(block_spacing(context, x, y, edge));
	if (rungs[rung].layer >= level)
		/* A coarser rung would have been taken by the parent: this is the level's own. */
		return cast_node(context, plan, x, y, 2 * level - (level > 0), edge);
	if (rungs[rung].layer == level - 1 && rungs[rung].pattern == GZ_TILE_QUINCUNX)
		return cast_node(context, plan, x, y, rung, edge);
	const int half = edge / 2;
	for (int quarter = 0; quarter < 4; quarter++) {
		enum gz_result result = subdivide(context, plan, x + (quarter & 1) * half,
						  y + (quarter >> 1) * half, level - 1);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

enum gz_result gz_plan_acuity(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->reconstruction = GZ_RECONSTRUCT_PYRAMID;
	plan->layer_count = LEVELS;
	plan->layers[0] = (struct gz_plan_layer) {
		.spacing = 1,
		.columns = context->width,
		.rows = context->height,
	};
	/* Each level spans the next finer one: point i of level k is point 2i of level k - 1. */
	for (int level = 1; level < LEVELS; level++)
		plan->layers[level] = (struct gz_plan_layer) {
			.spacing = 1 << level,
			.columns = plan->layers[level - 1].columns / 2 + 1,
			.rows = plan->layers[level - 1].rows / 2 + 1,
		};
	const int root = GZ_TILE_EDGE << (LEVELS - 1);
	const int right = plan->layers[LEVELS - 1].columns * GZ_SPACING_MAX;
	const int bottom = plan->layers[LEVELS - 1].rows * GZ_SPACING_MAX;
	for (int y = 0; y < bottom; y += root)
		for (int x = 0; x < right; x += root) {
			enum gz_result result = subdivide(context, plan, x, y, LEVELS - 1);
			if (result != GZ_OK)
				return result;
		}
	return GZ_OK;
}
