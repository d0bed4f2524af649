/**
 * @file
 * A brick cut out of a volume in memory.
 */
#ifndef GZ_RENDER_DATA_BRICK_CUT_H
#define GZ_RENDER_DATA_BRICK_CUT_H

#include "render/data/brick_layout.h"

/**
 * Copy the voxels of a brick with those of its neighbours on every side; beyond the volume the
 * nearest voxel is repeated.
 *
 * @param volume  the level, in memory
 * @param brick   its place in the level, within it
 * @param[out] out_voxels  GZ_BRICK_VOXELS of them, x fastest
 */
void gz_brick_cut(const struct gz_volume *volume, const int brick[3], void *out_voxels);

#endif
