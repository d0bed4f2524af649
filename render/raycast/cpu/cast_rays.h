/*
 * Rays in voxel coordinates, cut by the box.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_RAYS_H
#define GZ_RENDER_RAYCAST_CPU_CAST_RAYS_H

#include <stddef.h>

#include "render/raycast/cpu/cast.h"

/* What the light on all samples of a ray shares: unit vectors towards the eye, and halfway from
 * there to the light. */
struct view {
	vf eye[3], half[3];
};

/* One chunk of lanes: its rays in voxel coordinates, position = start + k * delta; counted from the
 * first datum, datum + k * delta. */
struct rays {
	vf start[3], datum[3], delta[3], inverse[3];
	vf zero;       /* where k is 0: steps from the origin */
	vf first, end; /* whole segments: from k = first to k = end */
	vf head;       /* of a segment, before the first; [0, 1) */
	vf head_at;    /* its middle */
	vf rest;       /* of a segment, behind the last; [0, 1) */
	vm hit;
	const struct view *view; /* NULL: not lit */
};

/* Where the rays meet the whole box, and where they are within what is shown of it: k counted from
 * the origin. */
struct cuts {
	vf box, enter, leave;
};

SIMD struct cuts cut_rays(const struct gz_cast *cast, const vf origin[3], const struct rays *rays)
{
	struct cuts cuts = { vf_set(0), vf_set(0), vf_set(3e38F) };
	for (int axis = 0; axis < 3; axis++) {
		const vf inverse = rays->inverse[axis];
		const vf low = (vf_set(0) - origin[axis]) * inverse;
		const vf high = (vf_set(cast->box[axis]) - origin[axis]) * inverse;
		const vf clip_low = (vf_set(cast->clip_least[axis]) - origin[axis]) * inverse;
		const vf clip_high = (vf_set(cast->clip_greatest[axis]) - origin[axis]) * inverse;
		cuts.box = vf_max(cuts.box, vf_min(low, high));
		cuts.enter = vf_max(cuts.enter, vf_min(clip_low, clip_high));
		cuts.leave = vf_min(cuts.leave, vf_max(clip_low, clip_high));
	}
	return cuts;
}

/* Count segments from a share of one before the box, and find which are whole. */
SIMD void count_segments(struct cuts cuts, vf shift, struct rays *rays)
{
	const vf none = vf_set(0);
	const vf from = vf_select(rays->hit, cuts.enter - cuts.box + shift, none);
	const vf to = vf_select(rays->hit, cuts.leave - cuts.box + shift, none);
	rays->first = vf_ceil(from);
	rays->end = vf_floor(to);
	rays->head = vf_min(rays->first, to) - from;
	rays->head_at = vf_fma(rays->head, vf_set(0.5F), from);
	/* Where all lies within one segment, the head is all there is. */
	rays->rest = vf_select(vf_less(rays->end, rays->first), none, to - rays->end);
}

/* Rays of pixels (x, y), cut by the box and the clip box; segments begin `shift` before the box. */
SIMD void set_up_rays(const struct gz_cast *cast, int step, vf x, vf y, vf shift, vm active,
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
	for (int axis = 0; axis < 3; axis++) {
		const vf least = vf_set(1e-12F);
		const vf raw = direction[axis] * scale;
		const vf delta = vf_select(vf_less(vf_abs(raw), least), least, raw);
		rays->delta[axis] = delta;
		rays->inverse[axis] = vf_set(1) / delta;
	}
	rays->view = NULL;
	const struct cuts cuts = cut_rays(cast, origin, rays);
	rays->hit = vm_and(active, vf_less(cuts.enter, cuts.leave));
	count_segments(cuts, shift, rays);
	const vf zero = cuts.box - shift;
	rays->zero = zero;
	for (int axis = 0; axis < 3; axis++) {
		rays->start[axis] = vf_fma(zero, rays->delta[axis], origin[axis]);
		rays->datum[axis] = vf_fma(zero, rays->delta[axis], origin[axis] - vf_set(0.5F));
	}
}

#endif
