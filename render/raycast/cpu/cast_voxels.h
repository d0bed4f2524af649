/*
 * Voxels as floats, and what lies between them.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_VOXELS_H
#define GZ_RENDER_RAYCAST_CPU_CAST_VOXELS_H

#include "render/raycast/cpu/cast.h"

/* Two neighbours along x, as floats: one 32-bit load where both fit. */
SIMD void load_pair(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask, vf *low,
		    vf *high)
{
	if (type == GZ_VOXEL_U8) {
		const vi pair = vi_gather(cast->voxels, index, 1, mask);
		*low = vf_from_i(vi_and(pair, vi_set(0xFF)));
		*high = vf_from_i(vi_and(vi_shift_right(pair, 8), vi_set(0xFF)));
	} else if (type == GZ_VOXEL_U16) {
		const vi pair = vi_gather(cast->voxels, index, 2, mask);
		*low = vf_from_i(vi_and(pair, vi_set(0xFFFF)));
		*high = vf_from_i(vi_shift_right(pair, 16));
	} else {
		const float *voxels = cast->voxels;
		*low = vf_gather(voxels, index, mask);
		*high = vf_gather(voxels + 1, index, mask);
	}
}

SIMD vf mix(vf a, vf b, vf share)
{
	return vf_fma(share, b - a, a);
}

SIMD vf load_row(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask, vf share)
{
	vf low, high;
	load_pair(cast, type, index, mask, &low, &high);
	return mix(low, high, share);
}

/* Between eight voxels: of each lane the first is at index `first`. */
SIMD vf mix_rows(const struct gz_cast *cast, enum gz_voxel_type type, vi first, int32_t stride_y,
		 int32_t stride_z, const vf share[3], vm mask)
{
	const vi up_y = vi_set(stride_y);
	const vi above = vi_add(first, vi_set(stride_z));
	const vf v00 = load_row(cast, type, first, mask, share[0]);
	const vf v10 = load_row(cast, type, vi_add(first, up_y), mask, share[0]);
	const vf v01 = load_row(cast, type, above, mask, share[0]);
	const vf v11 = load_row(cast, type, vi_add(above, up_y), mask, share[0]);
	return mix(mix(v00, v10, share[1]), mix(v01, v11, share[1]), share[2]);
}

#endif
