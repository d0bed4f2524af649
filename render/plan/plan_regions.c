/*
 * Methods of nested regions: the full picture, a uniform one, and those of Bauer 2018. A tile is
 * emitted if one of its points is among the four lattice points of a pixel that shows its layer.
 */
#include <math.h>

#include "render/plan/plan_context.h"

/* A block of pixels, including its corners. */
struct block {
	double x0, y0, x1, y1;
};

bool gz_region_holds(const struct gz_region *region, double x, double y)
{
	if (region->shape == GZ_REGION_ALL)
		return true;
	const double u = (x - region->centre_px[0]) / region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	if (region->shape == GZ_REGION_ELLIPSE)
		return u * u + v * v <= 1;
	return fmax(fabs(u), fabs(v)) <= 1;
}

/* Distance from the centre of a shape, where its rim is at 1. */
static double region_radius(const struct gz_region *region, double x, double y)
{
	const double u = (x - region->centre_px[0]) / region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	if (region->shape == GZ_REGION_ELLIPSE)
		return sqrt(u * u + v * v);
	return fmax(fabs(u), fabs(v));
}

double gz_region_weight(const struct gz_region *region, double x, double y)
{
	if (!gz_region_holds(region, x, y))
		return 0;
	if (region->shape == GZ_REGION_ALL || region->blend_px <= 0)
		return 1;
	const double least_px = fmin(region->half_px[0], region->half_px[1]);
	const double inside_px = (1 - region_radius(region, x, y)) * least_px;
	return fmin(fmax(inside_px / region->blend_px, 0), 1);
}

void gz_region_columns(const struct gz_region *region, int y, int width, int *out_from, int *out_to)
{
	double half = region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	*out_from = 0;
	*out_to = width;
	if (region->shape == GZ_REGION_ALL)
		return;
	if (fabs(v) > 1) {
		*out_to = 0;
		return;
	}
	if (region->shape == GZ_REGION_ELLIPSE)
		half *= sqrt(1 - v * v);
	int from = (int)fmin(fmax(ceil(region->centre_px[0] - half), 0), width);
	int to = (int)fmin(fmax(floor(region->centre_px[0] + half) + 1, 0), width);
	/* The formula rounds differently than gz_region_holds(), which decides at the rim. */
	while (from < to && !gz_region_holds(region, from, y))
		from++;
	while (from > 0 && gz_region_holds(region, from - 1, y))
		from--;
	while (to > from && !gz_region_holds(region, to - 1, y))
		to--;
	while (to < width && gz_region_holds(region, to, y))
		to++;
	*out_from = from;
	*out_to = to;
}

static bool region_touches(const struct gz_region *region, const struct block *block)
{
	const double x = fmin(fmax(region->centre_px[0], block->x0), block->x1);
	const double y = fmin(fmax(region->centre_px[1], block->y0), block->y1);
	return gz_region_holds(region, x, y);
}

/* Every shape is convex: a block is inside if its four corners are. */
static bool region_holds_block(const struct gz_region *region, const struct block *block)
{
	return gz_region_holds(region, block->x0, block->y0) &&
	       gz_region_holds(region, block->x1, block->y0) &&
	       gz_region_holds(region, block->x0, block->y1) &&
	       gz_region_holds(region, block->x1, block->y1);
}

static bool region_hides(const struct gz_region *region, double x, double y)
{
	return gz_region_weight(region, x, y) >= 1;
}

static bool region_hides_block(const struct gz_region *region, const struct block *block)
{
	return region_hides(region, block->x0, block->y0) &&
	       region_hides(region, block->x1, block->y0) &&
	       region_hides(region, block->x0, block->y1) &&
	       region_hides(region, block->x1, block->y1);
}

/* How much of a layer shows in a block of its tiles. */
enum shows { SHOWS_NOTHING, SHOWS_PARTLY, SHOWS_WHOLLY };

/* How much of a layer shows in the pixels that interpolate between points of this block of tiles.
 */
static enum shows tiles_show(const struct gz_plan *plan, int layer, int x, int y, int edge)
{
	const int reach = plan->layers[layer].spacing - 1;
	const struct gz_region *region = &plan->layers[layer].region;
	const struct block block = {
		fmax(x - reach, 0),
		fmax(y - reach, 0),
		fmin(x + edge - 1, plan->width - 1),
		fmin(y + edge - 1, plan->height - 1),
	};
	if (!region_touches(region, &block))
		return SHOWS_NOTHING;
	bool beside_others = true;
	for (int earlier = 0; earlier < layer; earlier++) {
		if (region_hides_block(&plan->layers[earlier].region, &block))
			return SHOWS_NOTHING;
		if (region_touches(&plan->layers[earlier].region, &block))
			beside_others = false;
	}
	return beside_others && region_holds_block(region, &block) ? SHOWS_WHOLLY : SHOWS_PARTLY;
}

/* Tiles along an edge of a block. Tiles are emitted block by block so that neighbours on the screen
 * are cast one after the other and share the cache. A block that shows in part is cut into CUTS x
 * CUTS parts. */
enum { TILES_A_BLOCK = 16, CUTS = 4 };

static uint8_t region_step(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
			   int y, int edge)
{
	if (context->steps == GZ_STEPS_ONE)
		return 0;
	return (uint8_t)gz_plan_step_for(context, plan, x, y, edge);
}

static void emit_all(const struct gz_plan_context *context, struct gz_plan *plan, int layer, int x0,
		     int y0, int tiles)
{
	const struct gz_plan_layer *lattice = &plan->layers[layer];
	const int edge = GZ_TILE_EDGE * lattice->spacing;
	const int last = edge - lattice->spacing; /* from a tile's first point to its last */
	const int right = (lattice->columns - 1) * lattice->spacing;
	const int bottom = (lattice->rows - 1) * lattice->spacing;
	const int end_x = x0 + tiles * edge, end_y = y0 + tiles * edge;
	for (int y = y0; y <= bottom && y < end_y; y += edge)
		for (int x = x0; x <= right && x < end_x; x += edge) {
			const struct gz_tile tile = {
				.x = (uint16_t)x,
				.y = (uint16_t)y,
				.layer = (uint8_t)layer,
				.step = region_step(context, plan, x, y, edge),
			};
			if (x + last <= right && y + last <= bottom)
				gz_plan_append_whole(plan, tile);
			else
				gz_plan_append(plan, tile);
		}
}

static void emit_block(const struct gz_plan_context *context, struct gz_plan *plan, int layer,
		       int x0, int y0, int tiles)
{
	const int edge = GZ_TILE_EDGE * plan->layers[layer].spacing;
	const enum shows shows = tiles_show(plan, layer, x0, y0, tiles * edge);
	if (shows == SHOWS_NOTHING)
		return;
	if (shows == SHOWS_WHOLLY || tiles == 1) {
		emit_all(context, plan, layer, x0, y0, tiles);
		return;
	}
	const int part = tiles / CUTS;
	for (int i = 0; i < CUTS * CUTS; i++)
		emit_block(context, plan, layer, x0 + i % CUTS * part * edge,
			   y0 + i / CUTS * part * edge, part);
}

static enum gz_result emit_layer(const struct gz_plan_context *context, struct gz_plan *plan,
				 int layer)
{
	const struct gz_plan_layer *lattice = &plan->layers[layer];
	const int block = TILES_A_BLOCK * GZ_TILE_EDGE * lattice->spacing;
	const int right = (lattice->columns - 1) * lattice->spacing;
	const int bottom = (lattice->rows - 1) * lattice->spacing;
	for (int y = 0; y <= bottom; y += block)
		for (int x = 0; x <= right; x += block) {
			const enum gz_result result =
				gz_plan_reserve(plan, (size_t)TILES_A_BLOCK * TILES_A_BLOCK);
			if (result != GZ_OK)
				return result;
			emit_block(context, plan, layer, x, y, TILES_A_BLOCK);
		}
	return GZ_OK;
}

static double whole_spacing(double spacing)
{
	return fmin(fmax(spacing, 1), GZ_SPACING_MAX);
}

/* A layer's spacing under a budget: the regions past the first become coarser first. */
static double scaled_spacing(const struct gz_plan_context *context, int layer, int layers,
			     int spacing)
{
	const double outside = layer > 0 || layers == 1 ? context->scale_outside : 1;
	return whole_spacing(round(spacing * outside * context->scale_all));
}

/* Spacing of the uniform plan that costs no more than the regions, sampled on a grid of places. */
static double uniform_spacing(const struct gz_plan *plan)
{
	enum { GRID = 32 };
	double density = 0;
	for (int i = 0; i < GRID * GRID; i++) {
		const double x = (i % GRID + 0.5) / GRID * plan->width;
		const double y = (i / GRID + 0.5) / GRID * plan->height;
		int layer = 0;
		while (layer + 1 < plan->layer_count &&
		       !gz_region_holds(&plan->layers[layer].region, x, y))
			layer++;
		const double spacing = plan->layers[layer].spacing;
		density += 1 / (spacing * spacing) / (GRID * GRID);
	}
	return whole_spacing(ceil(1 / sqrt(density) - 1e-9));
}

static void set_spacing(const struct gz_plan_context *context, struct gz_plan *plan, int layer,
			double spacing)
{
	plan->layers[layer] = gz_plan_layer_make(context->width, context->height, (int)spacing,
						 plan->layers[layer].region);
}

static void scale_and_widen(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const int layers = plan->layer_count;
	for (int i = 0; i < layers; i++)
		set_spacing(context, plan, i,
			    scaled_spacing(context, i, layers, plan->layers[i].spacing));
	if (context->widen <= 0 || layers == 1)
		return;
	const double uniform = uniform_spacing(plan);
	for (int i = 0; i < layers; i++) {
		const double own = plan->layers[i].spacing;
		set_spacing(context, plan, i, round(own + (uniform - own) * context->widen));
	}
}

enum gz_result gz_plan_regions(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_method *method = gz_method_of(context->foveation);
	method->add_regions(context, plan);
	if (method->can_be_coarser)
		scale_and_widen(context, plan);
	const bool whole = plan->layer_count == 1 && plan->layers[0].spacing == 1;
	plan->reconstruction = whole ? GZ_RECONSTRUCT_DIRECT : GZ_RECONSTRUCT_REGIONS;
	enum gz_result result = GZ_OK;
	for (int layer = 0; layer < plan->layer_count && result == GZ_OK; layer++)
		result = emit_layer(context, plan, layer);
	return result;
}
