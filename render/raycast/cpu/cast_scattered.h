/*
 * Every lane fetches its own eight neighbours: the stand-in for cast_block.h where an instruction
 * set has no permutation that wide.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_SCATTERED_H
#define GZ_RENDER_RAYCAST_CPU_CAST_SCATTERED_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_rays.h"

#define FETCH_UNIT(type)   ((void)(type), 1.0F)
#define FETCH_OFFSET(type) ((void)(type), 0.0F)

/* The value at sample k of the lanes of mask. */
SIMD vf fetch_sample(const struct gz_cast *cast, enum gz_voxel_type type, int nearest,
		     const struct rays *rays, vf k, vm mask)
{
	return sample_at(cast, type, nearest, rays, k, mask);
}

#endif
