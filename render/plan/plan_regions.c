/*
 * Methods of nested regions: the full picture, and those of Bauer 2018. A layer's tiles are emitted
 * where a pixel that shows the layer has one of its four lattice points.
 */
#include <math.h>

#include "render/plan/plan_emit.h"

/* A block of pixels, corners included. */
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

static bool region_touches(const struct gz_region *region, const struct block *block)
{
	const double x = fmin(fmax(region->centre_px[0], block->x0), block->x1);
	const double y = fmin(fmax(region->centre_px[1], block->y0), block->y1);
	return gz_region_holds(region, x, y);
}

/* Every shape is convex: a block is inside if its corners are. */
static bool region_holds_block(const struct gz_region *region, const struct block *block)
{
	return gz_region_holds(region, block->x0, block->y0) &&
	       gz_region_holds(region, block->x1, block->y0) &&
	       gz_region_holds(region, block->x0, block->y1) &&
	       gz_region_holds(region, block->x1, block->y1);
}

/* Whether a pixel that one of the tile's lattice points reaches shows this layer. */
static bool tile_shows(const struct gz_plan *plan, int layer, int x, int y)
{
	const int reach = plan->layers[layer].spacing - 1;
	const int span = (GZ_TILE_EDGE - 1) * plan->layers[layer].spacing + reach;
	const struct block block = {
		fmax(x - reach, 0),
		fmax(y - reach, 0),
		fmin(x + span, plan->width - 1),
		fmin(y + span, plan->height - 1),
	};
	if (!region_touches(&plan->layers[layer].region, &block))
		return false;
	for (int earlier = 0; earlier < layer; earlier++)
		if (region_holds_block(&plan->layers[earlier].region, &block))
			return false;
	return true;
}

/* Tiles in blocks of 16 x 16, so that neighbours on the screen are neighbours in time and share the
 * cache. */
static enum gz_result emit_layer(const struct gz_plan_context *context, struct gz_plan *plan,
				 int layer)
{
	enum { TILES_A_BLOCK = 16 };
	const struct gz_plan_layer *lattice = &plan->layers[layer];
	const int edge = GZ_TILE_EDGE * lattice->spacing;
	const int right = (lattice->columns - 1) * lattice->spacing;
	const int bottom = (lattice->rows - 1) * lattice->spacing;
	const int block = TILES_A_BLOCK * edge;
	for (int i = 0, blocks_x = right / block + 1; i < blocks_x * (bottom / block + 1); i++) {
		const int x0 = i % blocks_x * block, y0 = i / blocks_x * block;
		for (int y = y0; y <= bottom && y < y0 + block; y += edge)
			for (int x = x0; x <= right && x < x0 + block; x += edge) {
				if (!tile_shows(plan, layer, x, y))
					continue;
				const struct gz_tile tile = {
					.x = (uint16_t)x,
					.y = (uint16_t)y,
					.layer = (uint8_t)layer,
					.step = (uint8_t)gz_plan_step_for(context, plan, x, y,
									  edge),
				};
				enum gz_result result = gz_plan_add(plan, tile);
				if (result != GZ_OK)
					return result;
			}
	}
	return GZ_OK;
}

static enum gz_result emit_layers(const struct gz_plan_context *context, struct gz_plan *plan)
{
	enum gz_result result = GZ_OK;
	for (int layer = 0; layer < plan->layer_count && result == GZ_OK; layer++)
		result = emit_layer(context, plan, layer);
	return result;
}

static void add_layer(const struct gz_plan_context *context, struct gz_plan *plan, int spacing,
		      enum gz_region_shape shape, const double half_px[2])
{
	const struct gz_region region = {
		.shape = shape,
		.centre_px = { context->gaze_px[0], context->gaze_px[1] },
		.half_px = { half_px[0], half_px[1] },
	};
	plan->layers[plan->layer_count++] =
		gz_plan_layer_make(context->width, context->height, spacing, region);
}

static const double everywhere[2] = { 1, 1 };

enum gz_result gz_plan_standard(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->reconstruction = GZ_RECONSTRUCT_DIRECT;
	add_layer(context, plan, 1, GZ_REGION_ALL, everywhere);
	return emit_layers(context, plan);
}

enum gz_result gz_plan_mdc(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const double half = context->foveation->mdc_square_px / 2;
	plan->reconstruction = GZ_RECONSTRUCT_REGIONS;
	add_layer(context, plan, 1, GZ_REGION_RECTANGLE, (const double[2]) { half, half });
	add_layer(context, plan, context->foveation->mdc_spacing, GZ_REGION_ALL, everywhere);
	return emit_layers(context, plan);
}

enum gz_result gz_plan_ddc(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_foveation *foveation = context->foveation;
	plan->reconstruction = GZ_RECONSTRUCT_REGIONS;
	add_layer(context, plan, foveation->ddc_spacing[0], GZ_REGION_ELLIPSE,
		  foveation->ddc_inner_px);
	add_layer(context, plan, foveation->ddc_spacing[1], GZ_REGION_ELLIPSE,
		  foveation->ddc_middle_px);
	add_layer(context, plan, foveation->ddc_spacing[2], GZ_REGION_ALL, everywhere);
	return emit_layers(context, plan);
}
