/*
 * Rays in voxel coordinates, cut by the box.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_CPU_CAST_RAYS_H
#define GZ_RENDER_CPU_CAST_RAYS_H

#include "render/cpu/cast.h"

/* One chunk of lanes: its rays in voxel coordinates, position = start + k * delta; counted from the
 * first datum, datum + k * delta. */
struct rays {
	vf start[3], datum[3], delta[3], inverse[3];
	vf count; /* whole segments */
	vf rest;  /* of a segment, at the end; [0, 1) */
	vm hit;
};

/* Rays of pixels (x, y), cut by the box. */
SIMD void set_up_rays(const struct gz_cast *cast, int step, vf x, vf y, vm active,
		      struct rays *rays)
{
	vf origin[3], direction[3];
	vf length2 = vf_set(0);
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = vf_fma(
			y, vf_set(cast->origin_dy[axis]),
			vf_fma(x, vf_set(cast->origin_dx[axis]), vf_set(cast->origin00[axis])));
		direction[axis] = vf_fma(y, vf_set(cast->direction_dy[axis]),
					 vf_fma(x, vf_set(cast->direction_dx[axis]),
						vf_set(cast->direction00[axis])));
		const vf world = direction[axis] * vf_set(cast->world_per_voxel[axis]);
		length2 = vf_fma(world, world, length2);
	}
	/* One step along the ray, in voxel coordinates. */
	const vf scale = vf_set(cast->step[step]) / vf_sqrt(length2);
	vf enter = vf_set(0), leave = vf_set(3e38F);
	for (int axis = 0; axis < 3; axis++) {
		const vf least = vf_set(1e-12F);
		const vf raw = direction[axis] * scale;
		const vf delta = vf_select(vf_less(vf_abs(raw), least), least, raw);
		const vf inverse = vf_set(1) / delta;
		const vf a = (vf_set(0) - origin[axis]) * inverse;
		const vf b = (vf_set(cast->box[axis]) - origin[axis]) * inverse;
		enter = vf_max(enter, vf_min(a, b));
		leave = vf_min(leave, vf_max(a, b));
		rays->delta[axis] = delta;
		rays->inverse[axis] = inverse;
	}
	rays->hit = vm_and(active, vf_less(enter, leave));
	const vf length = vf_select(rays->hit, leave - enter, vf_set(0));
	rays->count = vf_floor(length);
	rays->rest = length - rays->count;
	for (int axis = 0; axis < 3; axis++) {
		rays->start[axis] = vf_fma(enter, rays->delta[axis], origin[axis]);
		rays->datum[axis] = vf_fma(enter, rays->delta[axis], origin[axis] - vf_set(0.5F));
	}
}

#endif
