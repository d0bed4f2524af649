/*
 * Pyramids: methods that give a spacing at each eccentricity. A quadtree of tiles is split wherever
 * the method asks for a finer spacing than a tile has.
 */
#include <math.h>

#include "render/plan/plan_context.h"

enum { LEVELS = 6 };

_Static_assert(1 << (LEVELS - 1) == GZ_PYRAMID_SPACING_MAX, "one level a power of two");

static double nearest_to(double place, int from, int edge)
{
	return place < from ? from : place > from + edge ? from + edge : place;
}

/* A node and how much its rays differ. */
struct known_node {
	int x, y, level;
	const struct gz_node_contrast *contrast;
};

/* The greatest contrasts of a node's cells that a block of it covers or lies in. */
static struct gz_plan_contrast contrast_of_block(const struct known_node *node, int x, int y,
						 int edge)
{
	struct gz_plan_contrast most = { 0 };
	const int from_x = (x - node->x) >> node->level, from_y = (y - node->y) >> node->level;
	const int cells = edge >> node->level > 1 ? edge >> node->level : 1;
	for (int row = from_y; row < from_y + cells; row++)
		for (int column = from_x; column < from_x + cells; column++) {
			const double luminance = (double)node->contrast->luminance[row][column];
			const double colour = (double)node->contrast->colour[row][column];
			most.luminance = luminance > most.luminance ? luminance : most.luminance;
			most.colour = colour > most.colour ? colour : most.colour;
		}
	return most;
}

/* The spacing that a block needs: that of its point nearest to the gaze. */
static double block_spacing(struct gz_plan_context *context, const struct known_node *node, int x,
			    int y, int edge)
{
	if (node)
		context->contrast = contrast_of_block(node, x, y, edge);
	const double near_x = nearest_to(context->gaze_px[0], x, edge);
	const double near_y = nearest_to(context->gaze_px[1], y, edge);
	return gz_plan_spacing_at(context, near_x, near_y);
}

static int rung_of(int layer, int pattern)
{
	return 2 * layer + (pattern == GZ_TILE_QUINCUNX);
}

static void append_node(const struct gz_plan_context *context, struct gz_plan *plan, int x, int y,
			int layer, enum gz_tile_pattern pattern)
{
	const int rung = rung_of(layer, pattern);
	/* With the acuity rule each rung has its own step. */
	const int step = context->steps == GZ_STEPS_RUNG
				 ? rung
				 : gz_plan_step_for(context, plan, x, y, GZ_TILE_EDGE << layer);
	const struct gz_tile tile = {
		.x = (uint16_t)x,
		.y = (uint16_t)y,
		.layer = (uint8_t)layer,
		.step = (uint8_t)step,
		.pattern = (uint8_t)pattern,
	};
	/* A quincunx tile is twice as wide as high. */
	const struct gz_plan_layer *lattice = &plan->layers[layer];
	const int points = pattern == GZ_TILE_SQUARE ? GZ_TILE_EDGE : 2 * GZ_TILE_EDGE;
	if (x + (points - 1) * lattice->spacing < lattice->columns * lattice->spacing &&
	    y + (GZ_TILE_EDGE - 1) * lattice->spacing < lattice->rows * lattice->spacing)
		gz_plan_append_whole(plan, tile);
	else
		gz_plan_append(plan, tile);
}

/* A node becomes one square tile of its own level's lattice, or two quincunx tiles of the next
 * finer level, one above the other; or it is split. known: the node of the last round that this one
 * lies in; NULL in the first round. */
static void subdivide(struct gz_plan_context *context, struct gz_plan *plan,
		      const struct known_node *known, int x, int y, int level)
{
	const struct gz_plan_layer *coarsest = &plan->layers[LEVELS - 1];
	const int edge = GZ_TILE_EDGE << level;
	if (x > (coarsest->columns - 1) * coarsest->spacing ||
	    y > (coarsest->rows - 1) * coarsest->spacing)
		return; /* no lattice point of any level lies there */
	if (level == 0) {
		append_node(context, plan, x, y, 0, GZ_TILE_SQUARE);
		return;
	}
	const int half = edge / 2;
	const double spacing = block_spacing(context, known, x, y, edge);
	if (spacing >= gz_ladder_px[2 * level]) {
		append_node(context, plan, x, y, level, GZ_TILE_SQUARE);
	} else if (spacing >= gz_ladder_px[2 * level - 1]) {
		append_node(context, plan, x, y, level - 1, GZ_TILE_QUINCUNX);
		append_node(context, plan, x, y + half, level - 1, GZ_TILE_QUINCUNX);
	} else {
		for (int quarter = 0; quarter < 4; quarter++)
			subdivide(context, plan, known, x + (quarter & 1) * half,
				  y + (quarter >> 1) * half, level - 1);
	}
}

static void make_pyramid(const struct gz_plan_context *context, struct gz_plan *plan)
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
}

/* Mean rays per pixel of the rungs, sampled on a grid of places. */
static double mean_density(const struct gz_plan_context *context)
{
	enum { GRID = 24 }; /* chosen: within 2 % of the plan's own count at 1920 x 1080 */
	double sum = 0;
	for (int i = 0; i < GRID * GRID; i++) {
		const double x = (i % GRID + 0.5) / GRID * context->width;
		const double y = (i / GRID + 0.5) / GRID * context->height;
		const double rung = gz_ladder_px[gz_ladder_rung(gz_plan_spacing_at(context, x, y))];
		sum += 1 / (rung * rung);
	}
	return sum / (GRID * GRID);
}

/* The finest rung that, used everywhere, costs no more than the plan that trusts the gaze. */
static void find_uniform(struct gz_plan_context *context)
{
	const double widen = context->widen;
	context->widen = 0;
	const double spacing = 1 / sqrt(mean_density(context));
	context->widen = widen;
	int rung = 0;
	while (rung + 1 < GZ_LADDER_RUNGS && gz_ladder_px[rung] < spacing * (1 - 1e-9))
		rung++;
	context->uniform_px = gz_ladder_px[rung];
}

enum gz_result gz_plan_ladder(struct gz_plan_context *context, struct gz_plan *plan)
{
	make_pyramid(context, plan);
	if (context->widen > 0)
		find_uniform(context);
	const int root = GZ_TILE_EDGE << (LEVELS - 1);
	const int right = plan->layers[LEVELS - 1].columns * GZ_PYRAMID_SPACING_MAX;
	const int bottom = plan->layers[LEVELS - 1].rows * GZ_PYRAMID_SPACING_MAX;
	for (int y = 0; y < bottom; y += root)
		for (int x = 0; x < right; x += root) {
			/* room for a root that is split all the way down */
			const enum gz_result result =
				gz_plan_reserve(plan, (size_t)1 << (2 * (LEVELS - 1)));
			if (result != GZ_OK)
				return result;
			subdivide(context, plan, NULL, x, y, LEVELS - 1);
		}
	return GZ_OK;
}

bool gz_plan_node_of(const struct gz_tile *tile, int *out_level)
{
	const bool pair = tile->pattern == GZ_TILE_QUINCUNX;
	*out_level = tile->layer + pair;
	return !pair || tile->y % (GZ_TILE_EDGE << *out_level) == 0;
}

/* A pair of quincunx tiles follow each other, unless the lower one lies outside the picture. */
static void replace_node(struct gz_plan *plan, size_t first)
{
	struct gz_tile *tile = &plan->tiles[first], *next = tile + 1;
	tile->replaced = true;
	if (tile->pattern == GZ_TILE_QUINCUNX && first + 1 < plan->tile_count &&
	    next->pattern == GZ_TILE_QUINCUNX && next->layer == tile->layer && next->x == tile->x &&
	    next->y == tile->y + (GZ_TILE_EDGE << tile->layer))
		next->replaced = true;
}

enum gz_result gz_plan_ladder_refine(struct gz_plan_context *context, struct gz_plan *plan,
				     size_t from, const struct gz_node_contrast *contrasts)
{
	const size_t to = plan->tile_count;
	for (size_t i = from; i < to; i++) {
		const struct gz_tile tile = plan->tiles[i];
		int level;
		if (tile.layer == 0 || !gz_plan_node_of(&tile, &level))
			continue;
		const struct known_node node = { tile.x, tile.y, level, &contrasts[i - from] };
		const double spacing =
			block_spacing(context, &node, tile.x, tile.y, GZ_TILE_EDGE << level);
		if (gz_ladder_rung(spacing) >= rung_of(tile.layer, tile.pattern))
			continue;
		/* room for a node that is split all the way down */
		const enum gz_result result = gz_plan_reserve(plan, (size_t)1 << (2 * level));
		if (result != GZ_OK)
			return result;
		replace_node(plan, i);
		subdivide(context, plan, &node, tile.x, tile.y, level);
	}
	return GZ_OK;
}
