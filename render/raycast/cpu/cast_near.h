/*
 * Differences between voxels, for gradients. Samples that are shaded lie close to each other and to
 * those before them, so a block of voxels and its six neighbours, a voxel away along each axis,
 * serve several: they stay until a sample lies outside. A part of the kernel: see cast_kernel.h.
 *
 * Differences are whole numbers until they are mixed along y and z. So one does not depend on
 * whether it came from a block or from single loads.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_NEAR_H
#define GZ_RENDER_RAYCAST_CPU_CAST_NEAR_H

#include <math.h>

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_rays.h"

#ifndef SIMD_BLOCKS
struct near_voxels {
	int none;
};

SIMD void near_nothing(struct near_voxels *near)
{
	near->none = 1;
}
#else

#include "render/raycast/cpu/cast_block.h"

/* The blocks before and after the one at base along each axis. */
struct near_voxels {
	vf base[3]; /* the same in all lanes; far outside at first */
	struct near_blocks blocks;
};

SIMD void near_nothing(struct near_voxels *near)
{
	for (int axis = 0; axis < 3; axis++)
		near->base[axis] = vf_set(-1e6F);
}

/* Whether all places of the mask lie in the block, and where. */
SIMD int near_places(const struct near_voxels *near, const vf at[3], vm mask, vf places[3])
{
	for (int axis = 0; axis < 3; axis++)
		places[axis] = at[axis] - near->base[axis];
	return block_holds(places, 0, mask);
}

/* Where a block along an axis begins, so that the places lie in it, and what follows them, too. No
 * place in it is closer to the rim than a voxel and rounding. */
SIMD float near_base(const struct gz_cast *cast, int axis, const struct rays *rays, vf at, vm mask)
{
	const vm forward = vm_and(mask, vf_less(vf_set(0), rays->delta[axis]));
	const float first = vm_any(forward) ? floorf(vf_least_of(at, mask))
					    : floorf(vf_greatest_of(at, mask)) - (BLOCK_EDGE - 2);
	return lesser(greater(first, 1), cast->dims[axis] - (BLOCK_EDGE + 2));
}

/* Load the blocks around places. */
SIMD void near_load(const struct gz_cast *cast, enum gz_voxel_type type, const struct rays *rays,
		    const vf at[3], vm mask, struct near_voxels *near)
{
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : 2;
	const int64_t stride[3] = { 1, cast->stride[1], cast->stride[2] };
	int64_t from = 0;
	for (int axis = 0; axis < 3; axis++) {
		const float base = near_base(cast, axis, rays, at[axis], mask);
		near->base[axis] = vf_set(base);
		from += (int64_t)base * stride[axis];
	}
	near_load_blocks(type, (const char *)cast->voxels + from * bytes, stride[1] * bytes,
			 stride[2] * bytes, &near->blocks);
}

/* The weighted difference of two pairs of words. Differences of 8-bit values are words, too. */
SIMD vi weigh_difference(enum gz_voxel_type type, vi before, vi after, vi weights)
{
	if (type == GZ_VOXEL_U8)
		return vi_sum_of_products(vi_subtract_words(after, before), weights);
	return vi_subtract(vi_sum_of_products(after, weights), vi_sum_of_products(before, weights));
}

/* One component from its four rows, in the order (y, z) = 00, 10, 01, 11. */
SIMD vf mix_differences(const vi rows[4], const vf share[3], float unit)
{
	vf mixed[4];
	for (int i = 0; i < 4; i++)
		mixed[i] = vf_from_i(rows[i]);
	return mix(mix(mixed[0], mixed[1], share[1]), mix(mixed[2], mixed[3], share[1]), share[2]) *
	       vf_set(unit);
}

/* Trilinear differences at places in the blocks nearby, of voxels of 8 or 16 bits. Returns 0 if the
 * blocks have none. */
SIMD int near_mix(const struct near_voxels *near, enum gz_voxel_type type, const vf places[3],
		  vf difference[3])
{
	const float unit = near_unit(&near->blocks, type);
	if (unit == 0)
		return 0;
	vf whole[3], share[3];
	block_shares(places, whole, share);
	const vi weights = word_weights(share[0]), first = block_first(whole);
	for (int axis = 0; axis < 3; axis++) {
		vi rows[4];
		near_rows_of(&near->blocks, type, axis, first, weights, rows);
		difference[axis] = mix_differences(rows, share, unit);
	}
	return 1;
}

/* Trilinear differences from the blocks nearby, which are loaded if others are there. Returns 0 if
 * no block holds all places of the mask. */
SIMD int near_differences(const struct gz_cast *cast, enum gz_voxel_type type,
			  const struct rays *rays, struct near_voxels *near, const vf at[3],
			  vm mask, vf difference[3])
{
	vf places[3];
	for (int axis = 0; axis < 3; axis++)
		if (cast->dims[axis] < BLOCK_EDGE + 3)
			return 0;
	near_load(cast, type, rays, at, mask, near);
	return near_places(near, at, mask, places) && near_mix(near, type, places, difference);
}

/* Four voxels of a row as three pairs of words, the first voxel one before the index. */
SIMD void load_pairs_of_row(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask,
			    vi pairs[3])
{
	const vi first = vi_add(index, vi_set(-1));
	if (type == GZ_VOXEL_U8) {
		const vi four = vi_gather(cast->voxels, first, 1, mask);
		const vi low = vi_set(0xFF), high = vi_set(0xFF0000);
		pairs[0] = vi_or(vi_and(four, low), vi_and(vi_shift_left(four, 8), high));
		pairs[1] = vi_or(vi_and(vi_shift_right(four, 8), low), vi_and(four, high));
		pairs[2] = vi_or(vi_and(vi_shift_right(four, 16), low),
				 vi_and(vi_shift_right(four, 8), high));
		return;
	}
	const vi signs = vi_set((int32_t)0x80008000);
	for (int i = 0; i < 3; i++)
		pairs[i] =
			vi_xor(vi_gather(cast->voxels, vi_add(first, vi_set(i)), 2, mask), signs);
}

/* What near_differences() gives, from single loads. */
SIMD void difference_words(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			   vm mask, vf difference[3])
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	const vi up[3] = { vi_set(1), vi_set(cast->stride[1]), vi_set(cast->stride[2]) };
	const vi first = vi_add(index[0], vi_add(vi_mul(index[1], up[1]), vi_mul(index[2], up[2])));
	const vi weights = word_weights(share[0]);
	vi before[3][4], after[3][4];
	for (int i = 0; i < 4; i++) { /* bit 0: y, bit 1: z */
		vi row = i & 1 ? vi_add(first, up[1]) : first, pairs[3];
		row = i & 2 ? vi_add(row, up[2]) : row;
		load_pairs_of_row(cast, type, row, mask, pairs);
		before[0][i] = pairs[0];
		after[0][i] = pairs[2];
		for (int axis = 1; axis < 3; axis++) {
			load_pairs_of_row(cast, type, vi_subtract(row, up[axis]), mask, pairs);
			before[axis][i] = pairs[1];
			load_pairs_of_row(cast, type, vi_add(row, up[axis]), mask, pairs);
			after[axis][i] = pairs[1];
		}
	}
	for (int axis = 0; axis < 3; axis++) {
		vi rows[4];
		for (int i = 0; i < 4; i++)
			rows[i] = weigh_difference(type, before[axis][i], after[axis][i], weights);
		difference[axis] = mix_differences(rows, share, 1.0F / 32767);
	}
}

#endif
#endif
