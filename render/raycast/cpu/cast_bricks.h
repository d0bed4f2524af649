/*
 * Voxels of a volume of bricks: each lane finds the brick in memory over its place, of the cast's
 * level or a coarser one, and interpolates in it.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_BRICKS_H
#define GZ_RENDER_RAYCAST_CPU_CAST_BRICKS_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_voxels.h"

/* The room of each lane's brick as the index of its first voxel, and the place in it, counted from
 * its first datum: 1/2 to 32 1/2. */
SIMD vi find_bricks(const struct gz_cast_bricks *bricks, const vf at[3], vm mask, vf place[3])
{
	vf brick[3];
	vi index = vi_set(0);
	for (int axis = 0; axis < 3; axis++) {
		place[axis] = at[axis] + vf_set(0.5F);
		brick[axis] = vf_floor(
			vf_min(vf_max(place[axis] * vf_set(1.0F / GZ_BRICK_EDGE), vf_set(0)),
			       vf_set(bricks->last[axis])));
		index = vi_add(index, vi_mul(vi_trunc(brick[axis]), vi_set(bricks->stride[axis])));
	}
	const vi entry = vi_gather(bricks->table, index, 4, mask);
	const vi level = vi_and(entry, vi_set((1 << GZ_BRICK_LEVEL_BITS) - 1));
	for (int axis = 0; axis < 3; axis++) {
		const vf scale = vf_gather(bricks->scale[axis], level, mask);
		const vf own = vf_floor(brick[axis] * scale) * vf_set(GZ_BRICK_EDGE);
		place[axis] = place[axis] * scale - own + vf_set(0.5F);
	}
	return vi_mul(vi_shift_right(entry, GZ_BRICK_LEVEL_BITS), vi_set(GZ_BRICK_VOXELS));
}

SIMD vf bricks_nearest(const struct gz_cast *cast, enum gz_voxel_type type, vi first,
		       const vf place[3], vm mask)
{
	static const int stride[3] = { 1, GZ_BRICK_STORED_EDGE,
				       GZ_BRICK_STORED_EDGE * GZ_BRICK_STORED_EDGE };
	const vf top = vf_set(GZ_BRICK_STORED_EDGE - 1);
	for (int axis = 0; axis < 3; axis++) {
		const vf voxel = vf_min(vf_max(place[axis] + vf_set(0.5F), vf_set(0)), top);
		first = vi_add(first, vi_mul(vi_trunc(voxel), vi_set(stride[axis])));
	}
	vf low, high;
	load_pair(cast, type, first, mask, &low, &high);
	return low;
}

SIMD vf bricks_trilinear(const struct gz_cast *cast, enum gz_voxel_type type, vi first,
			 const vf place[3], vm mask)
{
	static const int stride[3] = { 1, GZ_BRICK_STORED_EDGE,
				       GZ_BRICK_STORED_EDGE * GZ_BRICK_STORED_EDGE };
	vf share[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf inside = vf_max(place[axis], vf_set(0));
		const vi index = vi_min(vi_trunc(inside), vi_set(GZ_BRICK_STORED_EDGE - 2));
		share[axis] = vf_min(inside - vf_from_i(index), vf_set(1));
		first = vi_add(first, vi_mul(index, vi_set(stride[axis])));
	}
	return mix_rows(cast, type, first, stride[1], stride[2], share, mask);
}

/* At places counted from the level's first datum. One function for all: kernels for volumes in
 * memory stay as small as they are. */
static __attribute__((noinline)) vf sample_bricks(const struct gz_cast *cast,
						  enum gz_voxel_type type, int nearest,
						  const vf at[3], vm mask)
{
	vf place[3];
	const vi first = find_bricks(&cast->bricks, at, mask, place);
	return nearest ? bricks_nearest(cast, type, first, place, mask)
		       : bricks_trilinear(cast, type, first, place, mask);
}

#endif
