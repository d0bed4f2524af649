/**
 * @file
 * The colours of cast rays before reconstruction: one lattice of points for each layer of the plan.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_LATTICE_H
#define GZ_RENDER_RECONSTRUCT_CPU_LATTICE_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/plan/plan.h"

/** The points of one layer. The first layer of spacing 1 lies in the picture itself. */
struct gz_lattice {
	uint32_t *points; /**< row by row; 32 more after the last may be read */
	size_t stride;    /**< points from one row to the next */
	int spacing, columns, rows;
};

/** Edge of a block of points that are filled alike: the smallest tile that leaves points to fill
 *  covers so many points of the next finer lattice. */
#define GZ_BLOCK_EDGE 8

/** All layers of a frame. Zero-initialised is empty; keep it from frame to frame. */
struct gz_lattices {
	int count;
	struct gz_lattice layers[GZ_PLAN_LAYERS_MAX];
	uint32_t *memory; /**< for the layers outside the picture */
	size_t capacity;  /**< points */
	/** For a pyramid: 2 * layer + pattern of the tile at each block of GZ_BLOCK_EDGE x
	 *  GZ_BLOCK_EDGE pixels; 0 for square tiles of layer 0. */
	uint8_t *blocks;
	size_t block_capacity;
	int block_columns, block_rows;
};

/** Lay out the layers of @p plan. The first of spacing 1 lies in @p picture, which has the plan's
 *  size and is aligned to 64 bytes. The points are undefined. GZ_ERR_NO_MEM: out of memory. */
enum gz_result gz_lattices_prepare(struct gz_lattices *lattices, const struct gz_plan *plan,
				   uint32_t *picture);

/** Note which blocks a tile of a pyramid covers. Threads: any number, each with tiles of its own.
 */
void gz_lattices_mark(struct gz_lattices *lattices, const struct gz_tile *tile);

/** Note that tiles of layer 0 cover the blocks that tiles from @p from on lie in, in place of the
 *  coarser ones of an earlier round. After this, threads may store these tiles. */
void gz_lattices_unmark(struct gz_lattices *lattices, const struct gz_plan *plan, size_t from);

/**
 * Store the colours of a tile's rays on its layer's lattice. In a pyramid, store them on all
 * coarser lattices that have the point too, and mark the tile's blocks.
 *
 * @param active  from gz_plan_tile_active()
 * @param pixels  colours by ray
 *
 * Threads: any number, each with tiles of its own.
 */
void gz_lattices_store(struct gz_lattices *lattices, const struct gz_plan *plan,
		       const struct gz_tile *tile, uint32_t active,
		       const uint32_t pixels[GZ_TILE_EDGE * GZ_TILE_EDGE]);

/** gz_lattices_store() of several planes at once, which is faster.
 *  @param planes  prepared with the same plan @param points  by plane and ray */
void gz_lattices_store_planes(struct gz_lattices planes[], int count, const struct gz_plan *plan,
			      const struct gz_tile *tile, uint32_t active,
			      const uint32_t points[][GZ_TILE_EDGE * GZ_TILE_EDGE]);

/** What gz_lattices_mark() noted of block (@p column, @p row): 2 * layer + pattern. */
static inline int gz_lattices_block(const struct gz_lattices *lattices, int column, int row)
{
	return lattices->blocks[(ptrdiff_t)row * lattices->block_columns + column];
}

/** Free and zero. */
void gz_lattices_free(struct gz_lattices *lattices);

#endif
