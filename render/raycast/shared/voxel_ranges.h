/**
 * @file
 * The least and the greatest voxel of blocks: what tells, with a transfer function, which of them
 * show something.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_VOXEL_RANGES_H
#define GZ_RENDER_RAYCAST_SHARED_VOXEL_RANGES_H

#include <stddef.h>

#include "render/data/volume.h"

/** Blocks in a grid: block i covers voxels [edge * i - before, edge * i + edge - 1 + behind] along
 *  each axis, as far as the volume goes. */
struct gz_range_blocks {
	int edge, before, behind;
};

/** Bytes that gz_voxel_ranges_row() works in: two rows of voxels. */
size_t gz_voxel_ranges_scratch(const struct gz_volume *volume);

/**
 * Find the ranges of one row of blocks along x.
 *
 * @param y, z    which row; its first voxel lies within the volume
 * @param count   blocks in it; the first voxel of the last lies within the volume
 * @param scratch  gz_voxel_ranges_scratch() bytes, aligned for a voxel
 * @param[out] out_least, out_greatest  @p count values of the volume's type each
 *
 * Threads: any number, each with its own scratch.
 */
void gz_voxel_ranges_row(const struct gz_volume *volume, const struct gz_range_blocks *blocks,
			 int y, int z, int count, void *scratch, void *out_least,
			 void *out_greatest);

#endif
