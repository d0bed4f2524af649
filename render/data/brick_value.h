/**
 * @file
 * Single values of a volume of bricks, from what is in memory.
 */
#ifndef GZ_RENDER_DATA_BRICK_VALUE_H
#define GZ_RENDER_DATA_BRICK_VALUE_H

#include "render/data/brick_pool.h"

/**
 * The stored value at a place, of the finest brick over it that is in memory. With all bricks there
 * it is that of the volume in memory.
 *
 * @param place    fractions of the box along x, y, z, [0, 1]
 * @param nearest  of the nearest voxel; else interpolated linearly
 *
 * Threads: any number, between two turns of the pool.
 */
double gz_brick_value(const struct gz_brick_pool *pool, const double place[3], bool nearest);

#endif
