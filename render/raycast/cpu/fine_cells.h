/**
 * @file
 * Fine cells: blocks of 4 x 4 x 4 voxels within the macrocells, which say for each sample whether
 * anything shows, and grids of larger cells over them. For volumes in memory; they take 3.5 to 5 %
 * of the voxels' memory.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_FINE_CELLS_H
#define GZ_RENDER_RAYCAST_CPU_FINE_CELLS_H

#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/volume.h"
#include "render/raycast/shared/macrocells.h"
#include "render/transfer/transfer_table.h"

/** Edge of a fine cell, voxels. Chosen: the longest step is not much shorter, and the flags of a
 * volume of 256 voxels a side take 256 KiB, which fit a processor's cache. */
#define GZ_FINE_EDGE 4

/** Grids of cells, each of twice the edge of the one before. Chosen: rays of a tile lie at most 64
 *  voxels apart if pixels are not much coarser than voxels. */
#define GZ_FINE_GRIDS 5

/** The flag for a box that reaches into the next cell along the axes in @p axes (bit 0: x). */
#define GZ_FINE_FLAG(axes) (1U << (axes))

/**
 * Cells of one edge, E. Cell (i, j, k) is for samples whose lower neighbours are voxels
 * [E i, E i + E - 1] along x, and so on; their interpolation touches [E i, E i + E]. Bit
 * GZ_FINE_FLAG(axes) of its flags says whether anything shows in it or in the cells that lie one
 * further along any of these axes. So one of the eight flags covers all cells that a box no
 * longer than E touches.
 */
struct gz_fine_grid {
	int dims[3];
	uint8_t *flags; /**< 4 bytes of padding */
};

/** All cells of a volume. Zero-initialised is empty. */
struct gz_fine_cells {
	enum gz_voxel_type type;
	void *least, *greatest; /**< stored values of the first grid, of the volume's type */
	struct gz_fine_grid grid[GZ_FINE_GRIDS];
};

/** Find the values of all cells of @p volume, which is in memory; replaces the earlier content.
 *  @p workers share the work. GZ_ERR_NO_MEM: out of memory; cells are empty. */
enum gz_result gz_fine_cells_build(const struct gz_volume *volume, struct gz_workers *workers,
				   struct gz_fine_cells *cells);

/** Find the flags for a transfer function. @p coarse are the macrocells of the volume, classified
 * for it. */
void gz_fine_cells_classify(struct gz_fine_cells *cells, const struct gz_macrocells *coarse,
			    const struct gz_transfer_table *table, struct gz_workers *workers);

/** Free and zero. */
void gz_fine_cells_free(struct gz_fine_cells *cells);

#endif
