/**
 * @file
 * Macrocells: blocks of voxels with their least and greatest value. With them and the transfer
 * function, empty space is found without reading voxels.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_MACROCELLS_H
#define GZ_RENDER_RAYCAST_SHARED_MACROCELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/brick_file.h"
#include "render/data/volume.h"
#include "render/raycast/shared/cast_constants.h"
#include "render/transfer/transfer_table.h"

/** Cell (i, j, k) covers voxels [8i - 1, 8i + 8] along x, and likewise along y and z: every voxel
 * that an interpolation within the cell, or up to half a voxel around it, can read. */
struct gz_macrocells {
	int dims[3];
	float *least, *greatest; /**< stored values */
	/** 0 if something shows in the cell; else the Chebyshev distance, at most 255 cells, to the
	 *  nearest cell where something shows. 4 bytes of padding. */
	uint8_t *distance;
	/** How far a ray may go before it must read again. Empty cells: GZ_REACH_BORDER + the
	 * distance above. Other cells: GZ_REACH_BORDER - the distance to the nearest empty cell.
	 * Distances here are at most GZ_REACH_MAX. 4 bytes of padding. */
	uint8_t *reach;
};

/* The builders below replace what is in @p cells, which must be zeroed or hold an earlier result.
 * GZ_ERR_NO_MEM: out of memory; cells are empty. */

/** Find the values of all cells of a volume in memory. */
enum gz_result gz_macrocells_build(const struct gz_volume *volume, struct gz_macrocells *cells);

/** Take the values of all cells of level 0 from a file of bricks: what gz_macrocells_build() would
 *  find. */
enum gz_result gz_macrocells_of_bricks(const struct gz_brick_file *file,
				       struct gz_macrocells *cells);

/**
 * Find the values of the cells of a coarser level of a file of bricks: ranges that hold what
 * gz_macrocells_build() would find, and may be wider.
 *
 * @param level  of the file, above 0
 * @param finer  the cells of level - 1
 */
enum gz_result gz_macrocells_of_coarser_bricks(const struct gz_brick_file *file, int level,
					       const struct gz_macrocells *finer,
					       struct gz_macrocells *cells);

/** Find distance and reach for a transfer function. Reads the cells' values, not the voxels. */
void gz_macrocells_classify(struct gz_macrocells *cells, const struct gz_transfer_table *table);

/** Find distance and reach for an isosurface: something shows in the cells whose range holds a
 *  stored value. */
void gz_macrocells_classify_surface(struct gz_macrocells *cells, double value);

/** Free and zero. */
void gz_macrocells_free(struct gz_macrocells *cells);

/** Blocks in a grid: block i covers voxels [edge * i - before, edge * i + edge - 1 + behind] along
 *  each axis, as far as the volume
 *  reaches. */
struct gz_range_blocks {
	int edge, before, behind;
};

/** Bytes of scratch memory for gz_voxel_ranges_row(): two rows of voxels. */
size_t gz_voxel_ranges_scratch(const struct gz_volume *volume);

/** A row of blocks along x. */
struct gz_range_row {
	const struct gz_volume *volume; /**< in memory */
	const struct gz_range_blocks *blocks;
	int y, z;  /**< numbers of the row; its first voxel lies within the volume */
	int count; /**< blocks; the first voxel of the last lies within the volume */
};

/**
 * Find the least and the greatest voxel of each block of a row.
 *
 * @param scratch  gz_voxel_ranges_scratch() bytes, aligned for a voxel
 * @param[out] out_least, out_greatest  values of the volume's type, one for each block
 *
 * Threads: any number, each with its own scratch.
 */
void gz_voxel_ranges_row(const struct gz_range_row *at, void *scratch, void *out_least,
			 void *out_greatest);

#endif
