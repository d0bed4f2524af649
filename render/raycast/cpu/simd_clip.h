/*
 * Cutting rays by the clip plane, for each lane. Include it after the vocabulary of an instruction
 * set: cast_kernel.h explains the scheme.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_SIMD_CLIP_H
#define GZ_RENDER_RAYCAST_CPU_SIMD_CLIP_H

/* Leave of rays what the clip plane (struct gz_clip_bounds) keeps. Without a plane they cross it
 * too far away to matter. */
SIMD void cut_by_plane(const float plane[4], const vf origin[3], const vf along[3], vf *from,
		       vf *to)
{
	vf left = vf_set(plane[3]), across = vf_set(0);
	for (int axis = 0; axis < 3; axis++) {
		left = left - vf_set(plane[axis]) * origin[axis];
		across = vf_fma(vf_set(plane[axis]), along[axis], across);
	}
	const vf least = vf_set(1e-12F);
	const vf at = left / vf_select(vf_less(vf_abs(across), least), least, across);
	const vm nears = vf_less(across, vf_set(0)); /* it comes from the side that is cut off */
	*from = vf_select(nears, vf_max(*from, at), *from);
	*to = vf_select(nears, *to, vf_min(*to, at));
}

#endif
