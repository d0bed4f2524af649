/**
 * @file
 * How transparent blocks of voxels are, from fine blocks to coarse ones: what long steps towards
 * the light read instead of voxels, so that a step does not miss what lies between its samples.
 * Made for a transfer function and a clip region.
 *
 * Level i has cells of the nominal length 2^(i + 1) voxel lengths. Along each axis the edge of a
 * cell, in voxels, is the greatest power of two that is no longer in space, at least 1. A cell is
 * made of eight children, two along each axis; children of level 0 are voxels, whose nominal length
 * is 1. Along an axis where the edge does not grow, a child stands for both. What lies outside the
 * box is clear, and so are voxels whose middle lies outside the clip region.
 *
 * With t(child) the share of light that comes through the child's nominal length, a cell lets
 * through the mean over the three axes, and over the four columns along each, of t(one) t(other).
 * So a wall does not vanish as cells grow, and a body that fills half of a cell does not darken the
 * other half, which a mean of extinctions would do.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_SHADOW_CELLS_H
#define GZ_RENDER_RAYCAST_SHARED_SHADOW_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/clip_region.h"
#include "render/data/volume.h"
#include "render/transfer/transfer_table.h"

/** Greatest number of levels. Chosen: the longest step is then 384 voxel lengths, and one of eight
 *  steps through 1600 voxels is no longer. */
#define GZ_SHADOW_LEVELS 8

/** A cell's number for each power of two of light that its nominal length keeps back. */
#define GZ_SHADOW_UNIT 4095
/** Powers of two kept back, at most: 16 bits then hold a cell. */
#define GZ_SHADOW_MOST 16

/** One level. */
struct gz_shadow_level {
	int dims[3];  /**< cells */
	int edge[3];  /**< voxels of a cell along each axis: a power of two */
	size_t first; /**< number of its first cell */
};

/** All levels. Zero-initialised is empty; its memory is reused when it is made again. */
struct gz_shadow_cells {
	int count; /**< levels: up to the one of a single cell */
	struct gz_shadow_level level[GZ_SHADOW_LEVELS];
	uint16_t
		*cells;  /**< -log2 of the share of light that comes through the nominal length, in
			    units of 1 / GZ_SHADOW_UNIT; x fastest; GZ_VOLUME_PADDING bytes follow */
	size_t capacity; /**< cells allocated */
};

/**
 * Make the cells. The result has the same bits for any number of threads.
 *
 * @param volume   in memory
 * @param table    baked for the volume
 * @param clip     voxels outside it are clear
 * @param workers  share the work; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM  there are no cells; not logged
 */
enum gz_result gz_shadow_cells_make(const struct gz_volume *volume,
				    const struct gz_transfer_table *table,
				    const struct gz_clip_region *clip, struct gz_workers *workers,
				    struct gz_shadow_cells *cells);

/** Free and zero. */
void gz_shadow_cells_free(struct gz_shadow_cells *cells);

#endif
