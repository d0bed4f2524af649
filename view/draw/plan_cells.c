#include "view/draw/plan_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "view/draw/viridis.h"

double gz_plan_cells_value(const struct gz_plan *plan, const struct gz_tile *tile,
			   enum gz_view_overlay overlay)
{
	if (overlay == GZ_OVERLAY_STEP)
		return (double)plan->steps[tile->step];
	const double spacing = plan->layers[tile->layer].spacing;
	return tile->pattern == GZ_TILE_QUINCUNX ? spacing * sqrt(2) : spacing;
}

double gz_plan_cells_share(double value, double end)
{
	return fmin(1, fmax(0, log2(value) / log2(end)));
}

static void fill(struct gz_plan_cells *cells, int column, int row, const int size[2],
		 const uint8_t colour[4])
{
	const int right = column + size[0] < cells->columns ? column + size[0] : cells->columns;
	const int bottom = row + size[1] < cells->rows ? row + size[1] : cells->rows;
	for (int y = row; y < bottom; y++) {
		uint8_t *at = cells->rgba + 4 * ((size_t)y * (size_t)cells->columns);
		for (int x = column; x < right; x++)
			memcpy(at + 4 * (size_t)x, colour, 4);
	}
}

static void fill_tile(struct gz_plan_cells *cells, const struct gz_plan *plan,
		      const struct gz_tile *tile, enum gz_view_overlay overlay)
{
	const int spacing = plan->layers[tile->layer].spacing;
	/* Every second point of a row, so that it reaches twice as far. */
	const int size[2] = { tile->pattern == GZ_TILE_QUINCUNX ? 2 * spacing : spacing, spacing };
	uint8_t colour[4] = { 0, 0, 0, 255 };
	gz_viridis(gz_plan_cells_share(gz_plan_cells_value(plan, tile, overlay), cells->end),
		   colour);
	fill(cells, tile->x / GZ_TILE_EDGE, tile->y / GZ_TILE_EDGE, size, colour);
}

static enum gz_result resize(struct gz_plan_cells *cells, const struct gz_plan *plan)
{
	const int columns = (plan->width + GZ_TILE_EDGE - 1) / GZ_TILE_EDGE;
	const int rows = (plan->height + GZ_TILE_EDGE - 1) / GZ_TILE_EDGE;
	const size_t size = 4 * (size_t)columns * (size_t)rows;
	if (size > cells->capacity) {
		uint8_t *grown = realloc(cells->rgba, size);
		if (!grown)
			return GZ_ERR_NO_MEM;
		cells->rgba = grown;
		cells->capacity = size;
	}
	cells->columns = columns;
	cells->rows = rows;
	for (size_t i = 0; i < size; i++)
		cells->rgba[i] = i % 4 == 3 ? 255 : 0;
	return GZ_OK;
}

static void find_span(struct gz_plan_cells *cells, const struct gz_plan *plan,
		      enum gz_view_overlay overlay)
{
	cells->least = INFINITY;
	cells->most = 0;
	for (size_t i = 0; i < plan->tile_count; i++) {
		const double value = gz_plan_cells_value(plan, &plan->tiles[i], overlay);
		cells->least = fmin(cells->least, value);
		cells->most = fmax(cells->most, value);
	}
	cells->end = GZ_PLAN_CELLS_SCALE_LEAST;
	while (cells->end < cells->most)
		cells->end *= 2;
}

/* Of tiles over one another the first layer's shows, and of one layer's the square one, which is
 * the finer: those go last. */
enum gz_result gz_plan_cells_make(struct gz_plan_cells *cells, const struct gz_plan *plan,
				  enum gz_view_overlay overlay)
{
	const enum gz_result r = resize(cells, plan);
	if (r != GZ_OK)
		return r;
	find_span(cells, plan, overlay);
	for (int layer = plan->layer_count - 1; layer >= 0; layer--)
		for (int pattern = GZ_TILE_PATTERN_COUNT - 1; pattern >= 0; pattern--)
			for (size_t i = 0; i < plan->tile_count; i++)
				if (plan->tiles[i].layer == layer &&
				    plan->tiles[i].pattern == pattern)
					fill_tile(cells, plan, &plan->tiles[i], overlay);
	return GZ_OK;
}

void gz_plan_cells_free(struct gz_plan_cells *cells)
{
	free(cells->rgba);
	*cells = (struct gz_plan_cells) { 0 };
}
