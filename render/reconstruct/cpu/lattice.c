#include "render/reconstruct/cpu/lattice.h"

#include <stdlib.h>
#include <string.h>

/* Padding after each lattice, so that wide loads at its end stay inside. */
enum { PADDING_POINTS = 32 };

/* Whether a layer is the first of spacing 1. Unusual parameters give a second one, which has memory
 * of its own so that no two threads write one pixel. */
static bool lies_in_picture(const struct gz_plan *plan, int layer)
{
	for (int earlier = 0; earlier < layer; earlier++)
		if (plan->layers[earlier].spacing == 1)
			return false;
	return plan->layers[layer].spacing == 1;
}

static size_t points_outside_picture(const struct gz_plan *plan)
{
	size_t points = 0;
	for (int i = 0; i < plan->layer_count; i++)
		if (!lies_in_picture(plan, i))
			points += (size_t)plan->layers[i].columns * (size_t)plan->layers[i].rows +
				  PADDING_POINTS;
	return points;
}

/* Make room for the blocks of all roots of the plan's quadtree. */
static enum gz_result prepare_blocks(struct gz_lattices *lattices, const struct gz_plan *plan)
{
	const struct gz_plan_layer *coarsest = &plan->layers[plan->layer_count - 1];
	const int blocks_a_root =
		(GZ_TILE_EDGE * coarsest->spacing + GZ_BLOCK_EDGE - 1) / GZ_BLOCK_EDGE;
	const int columns = ((coarsest->columns - 1) / GZ_TILE_EDGE + 1) * blocks_a_root;
	const int rows = ((coarsest->rows - 1) / GZ_TILE_EDGE + 1) * blocks_a_root;
	const size_t needed = (size_t)columns * (size_t)rows;
	if (needed > lattices->block_capacity) {
		uint8_t *blocks = realloc(lattices->blocks, needed);
		if (!blocks)
			return GZ_ERR_NO_MEM;
		lattices->blocks = blocks;
		lattices->block_capacity = needed;
	}
	lattices->block_columns = columns;
	lattices->block_rows = rows;
	memset(lattices->blocks, 0, needed);
	return GZ_OK;
}

void gz_lattices_mark(struct gz_lattices *lattices, const struct gz_tile *tile)
{
	/* Two quincunx tiles of layer 0 share a block. */
	if (tile->layer == 0 && (tile->pattern == GZ_TILE_SQUARE || tile->y % GZ_BLOCK_EDGE != 0))
		return;
	const int down = GZ_TILE_EDGE * lattices->layers[tile->layer].spacing;
	const int across = tile->pattern == GZ_TILE_QUINCUNX ? 2 * down : down;
	const size_t width = (size_t)(across / GZ_BLOCK_EDGE);
	uint8_t *row = lattices->blocks +
		       (ptrdiff_t)(tile->y / GZ_BLOCK_EDGE) * lattices->block_columns +
		       tile->x / GZ_BLOCK_EDGE;
	for (int i = 0; i < down; i += GZ_BLOCK_EDGE, row += lattices->block_columns)
		memset(row, 2 * tile->layer + tile->pattern, width);
}

void gz_lattices_unmark(struct gz_lattices *lattices, const struct gz_plan *plan, size_t from)
{
	for (size_t i = from; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		if (tile->layer == 0)
			lattices->blocks[(ptrdiff_t)(tile->y / GZ_BLOCK_EDGE) *
						 lattices->block_columns +
					 tile->x / GZ_BLOCK_EDGE] = 0;
	}
}

static void store_point(const struct gz_lattice *lattice, int column, int row, uint32_t pixel)
{
	if (column < lattice->columns && row < lattice->rows)
		lattice->points[(size_t)row * lattice->stride + (size_t)column] = pixel;
}

/* Points of a tile, ray by ray. */
typedef uint32_t tile_points[GZ_TILE_EDGE * GZ_TILE_EDGE];

/* Store a tile that lies wholly on its lattice and begins at (column, row). */
static void store_whole(const struct gz_lattice *lattice, int pattern, int column, int row,
			const tile_points points)
{
	uint32_t *to = lattice->points + (size_t)row * lattice->stride + (size_t)column;
	const uint8_t *columns = gz_tile_columns[pattern];
	for (int y = 0; y < GZ_TILE_EDGE; y++, to += lattice->stride) {
		if (pattern == GZ_TILE_SQUARE)
			memcpy(to, points + GZ_TILE_EDGE * y, GZ_TILE_EDGE * sizeof *to);
		for (int x = 0; pattern != GZ_TILE_SQUARE && x < GZ_TILE_EDGE; x++)
			to[columns[GZ_TILE_EDGE * y + x]] = points[GZ_TILE_EDGE * y + x];
	}
}

static int least_of(int a, int b)
{
	return a < b ? a : b;
}

/* The rays in even columns and rows of their tile, which coarser lattices have too. */
static const struct {
	uint8_t count, rays[8];
} even_rays[GZ_TILE_PATTERN_COUNT] = {
	[GZ_TILE_SQUARE] = { 4, { 0, 2, 8, 10 } },
	[GZ_TILE_QUINCUNX] = { 8, { 0, 1, 2, 3, 8, 9, 10, 11 } },
};

/* Store the points of a tile that coarser lattices of the pyramid have too. Each coarser lattice
 * has every second point of the finer one along x and y. The lattices of all planes lie alike. */
static void store_coarser(const struct gz_lattices planes[], int count, const struct gz_tile *tile,
			  int last, int column, int row, const tile_points points[])
{
	for (int k = 0; k < even_rays[tile->pattern].count; k++) {
		const int ray = even_rays[tile->pattern].rays[k];
		const int x = column + gz_tile_columns[tile->pattern][ray];
		const int y = row + gz_tile_rows[ray];
		/* As many coarser lattices have it as both can be halved. */
		const int deepest =
			least_of(last, tile->layer + __builtin_ctz((unsigned)(x | y) |
								   1U << GZ_PLAN_LAYERS_MAX));
		for (int layer = tile->layer + 1; layer <= deepest; layer++) {
			const struct gz_lattice *lattice = &planes[0].layers[layer];
			const int shift = layer - tile->layer, to_x = x >> shift, to_y = y >> shift;
			if (to_x >= lattice->columns || to_y >= lattice->rows)
				continue;
			const size_t at = (size_t)to_y * lattice->stride + (size_t)to_x;
			for (int plane = 0; plane < count; plane++)
				planes[plane].layers[layer].points[at] = points[plane][ray];
		}
	}
}

/* Store a tile that begins at (column, row) of its lattice, which it may leave. */
static void store_tile(const struct gz_lattice *lattice, const struct gz_tile *tile,
		       uint32_t active, int column, int row, const tile_points points)
{
	if (active == 0xFFFF) {
		store_whole(lattice, tile->pattern, column, row, points);
		return;
	}
	for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++)
		store_point(lattice, column + gz_tile_columns[tile->pattern][i],
			    row + gz_tile_rows[i], points[i]);
}

void gz_lattices_store_planes(struct gz_lattices planes[], int count, const struct gz_plan *plan,
			      const struct gz_tile *tile, uint32_t active,
			      const uint32_t points[][GZ_TILE_EDGE * GZ_TILE_EDGE])
{
	const int spacing = plan->layers[tile->layer].spacing;
	const int column = tile->x / spacing, row = tile->y / spacing;
	for (int plane = 0; plane < count; plane++) {
		store_tile(&planes[plane].layers[tile->layer], tile, active, column, row,
			   points[plane]);
		if (plan->reconstruction == GZ_RECONSTRUCT_PYRAMID)
			gz_lattices_mark(&planes[plane], tile);
	}
	if (plan->reconstruction == GZ_RECONSTRUCT_PYRAMID)
		store_coarser(planes, count, tile, plan->layer_count - 1, column, row, points);
}

void gz_lattices_store(struct gz_lattices *lattices, const struct gz_plan *plan,
		       const struct gz_tile *tile, uint32_t active,
		       const uint32_t pixels[GZ_TILE_EDGE * GZ_TILE_EDGE])
{
	gz_lattices_store_planes(lattices, 1, plan, tile, active,
				 (const uint32_t(*)[GZ_TILE_EDGE * GZ_TILE_EDGE]) pixels);
}

enum gz_result gz_lattices_prepare(struct gz_lattices *lattices, const struct gz_plan *plan,
				   uint32_t *picture)
{
	const size_t needed = points_outside_picture(plan);
	if (needed > lattices->capacity) {
		uint32_t *memory = realloc(lattices->memory, needed * sizeof *memory);
		if (!memory)
			return GZ_ERR_NO_MEM;
		lattices->memory = memory;
		lattices->capacity = needed;
	}
	if (plan->reconstruction == GZ_RECONSTRUCT_PYRAMID) {
		const enum gz_result result = prepare_blocks(lattices, plan);
		if (result != GZ_OK)
			return result;
	}
	lattices->count = plan->layer_count;
	uint32_t *next = lattices->memory;
	for (int i = 0; i < plan->layer_count; i++) {
		const struct gz_plan_layer *layer = &plan->layers[i];
		struct gz_lattice *lattice = &lattices->layers[i];
		lattice->spacing = layer->spacing;
		lattice->columns = layer->columns;
		lattice->rows = layer->rows;
		lattice->stride = (size_t)layer->columns;
		if (lies_in_picture(plan, i)) {
			lattice->points = picture;
			continue;
		}
		lattice->points = next;
		next += (size_t)layer->columns * (size_t)layer->rows + PADDING_POINTS;
	}
	return GZ_OK;
}

void gz_lattices_free(struct gz_lattices *lattices)
{
	free(lattices->memory);
	free(lattices->blocks);
	*lattices = (struct gz_lattices) { 0 };
}
