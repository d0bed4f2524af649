#include <stdlib.h>

#include "render/plan/plan_emit.h"

const uint8_t gz_tile_columns[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	[GZ_TILE_SQUARE] = { 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 },
	[GZ_TILE_QUINCUNX] = { 0, 2, 4, 6, 1, 3, 5, 7, 0, 2, 4, 6, 1, 3, 5, 7 },
};
const uint8_t gz_tile_rows[GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3,
};

enum gz_result gz_plan_reserve(struct gz_plan *plan, size_t count)
{
	const size_t needed = plan->tile_count + count;
	if (needed <= plan->tile_capacity)
		return GZ_OK;
	const size_t capacity = needed > 2 * plan->tile_capacity ? needed : 2 * plan->tile_capacity;
	struct gz_tile *tiles = realloc(plan->tiles, capacity * sizeof *tiles);
	if (!tiles)
		return GZ_ERR_NO_MEM;
	plan->tiles = tiles;
	plan->tile_capacity = capacity;
	return GZ_OK;
}

void gz_plan_append(struct gz_plan *plan, struct gz_tile tile)
{
	const uint32_t active = gz_plan_tile_active(plan, &tile);
	if (active == 0)
		return;
	plan->ray_count += (uint64_t)__builtin_popcount(active);
	plan->tiles[plan->tile_count++] = tile;
}

struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing, struct gz_region region)
{
	return (struct gz_plan_layer) {
		.spacing = spacing,
		.columns = (width - 1 + spacing - 1) / spacing + 1,
		.rows = (height - 1 + spacing - 1) / spacing + 1,
		.region = region,
	};
}

/* Whether a pixel position lies on the lattice of a layer or, in a pyramid, of a coarser one. */
static bool on_lattice(const struct gz_plan *plan, int layer, int x, int y)
{
	const int last =
		plan->reconstruction == GZ_RECONSTRUCT_PYRAMID ? plan->layer_count - 1 : layer;
	for (int i = layer; i <= last; i++) {
		const struct gz_plan_layer *lattice = &plan->layers[i];
		const int spacing = lattice->spacing;
		if (x % spacing == 0 && y % spacing == 0 && x / spacing < lattice->columns &&
		    y / spacing < lattice->rows)
			return true;
	}
	return false;
}

uint32_t gz_plan_tile_active(const struct gz_plan *plan, const struct gz_tile *tile)
{
	const struct gz_plan_layer *layer = &plan->layers[tile->layer];
	const uint8_t *columns = gz_tile_columns[tile->pattern];
	const int last = GZ_TILE_EDGE * GZ_TILE_EDGE - 1;
	if (tile->x + columns[last] * layer->spacing <= (layer->columns - 1) * layer->spacing &&
	    tile->y + gz_tile_rows[last] * layer->spacing <= (layer->rows - 1) * layer->spacing)
		return 0xFFFF; /* all of it inside: nearly always */
	uint32_t active = 0;
	for (int i = 0; i <= last; i++)
		if (on_lattice(plan, tile->layer, tile->x + columns[i] * layer->spacing,
			       tile->y + gz_tile_rows[i] * layer->spacing))
			active |= 1U << i;
	return active;
}
