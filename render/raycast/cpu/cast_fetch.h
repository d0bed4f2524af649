/*
 * From a place along the rays to the value there and its entry in the transfer function.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_FETCH_H
#define GZ_RENDER_RAYCAST_CPU_CAST_FETCH_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_bricks.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/cpu/cast_voxels.h"

/* The lower of two neighbours along an axis and the share of the other. */
SIMD vi clamp_place(const struct gz_cast *cast, int axis, vf at, vf *share)
{
	const vf place = vf_min(vf_max(at, vf_set(0)), vf_set(cast->dims[axis] - 1));
	const vi index = vi_min(vi_trunc(place), vi_set(cast->last[axis]));
	*share = place - vf_from_i(index);
	return index;
}

/* Index of the first of the eight neighbours of places counted from the first datum. */
SIMD vi first_voxel(const struct gz_cast *cast, const vf at[3])
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	return vi_add(vi_add(index[0], vi_mul(index[1], vi_set(cast->stride[1]))),
		      vi_mul(index[2], vi_set(cast->stride[2])));
}

/* At places counted from the first datum: 0 to dims - 1. */
SIMD vf sample_trilinear(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			 vm mask)
{
	vf share[3];
	vi index[3];
	if (__builtin_expect(cast->bricks.table != NULL, 0))
		return sample_bricks(cast, type, 0, at, mask);
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	const vi first = vi_add(vi_add(index[0], vi_mul(index[1], vi_set(cast->stride[1]))),
				vi_mul(index[2], vi_set(cast->stride[2])));
	return mix_rows(cast, type, first, cast->stride[1], cast->stride[2], share, mask);
}

SIMD vf sample_nearest(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3], vm mask)
{
	vi index = vi_set(0);
	if (__builtin_expect(cast->bricks.table != NULL, 0))
		return sample_bricks(cast, type, 1, at, mask);
	for (int axis = 0; axis < 3; axis++) {
		const vf top = vf_set(cast->dims[axis] - 1);
		const vf place = vf_min(vf_max(vf_floor(at[axis] + vf_set(0.5F)), vf_set(0)), top);
		index = vi_add(index, vi_mul(vi_trunc(place), vi_set(cast->stride[axis])));
	}
	vf low, high;
	load_pair(cast, type, index, mask, &low, &high);
	return low;
}

SIMD vf sample_at(const struct gz_cast *cast, enum gz_voxel_type type, int nearest,
		  const struct rays *rays, vf k, vm mask)
{
	vf at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
	return nearest ? sample_nearest(cast, type, at, mask)
		       : sample_trilinear(cast, type, at, mask);
}

/* The transfer function's entry for a sample. */
SIMD vi entry_of(vf scale, vf bias, vf value)
{
	const vf last = vf_set(GZ_TRANSFER_TABLE_SIZE - 1);
	return vi_round(vf_min(vf_max(vf_fma(value, scale, bias), vf_set(0)), last));
}

#endif
