/*
 * What a value becomes an entry of the transfer function by.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_LOOK_UP_H
#define GZ_RENDER_RAYCAST_CPU_CAST_LOOK_UP_H

#include "render/raycast/cpu/cast.h"

/* For values as fetch_sample() leaves them. */
struct look_up {
	vf scale, bias;
};

SIMD struct look_up look_up_of(const struct gz_cast *cast, enum gz_voxel_type type, int nearest)
{
	float scale = cast->entry_scale, bias = cast->entry_bias;
	if (!nearest) {
		bias += FETCH_OFFSET(type) * scale;
		scale /= FETCH_UNIT(type);
	}
	return (struct look_up) { vf_set(scale), vf_set(bias) };
}

#endif
