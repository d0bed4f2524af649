/*
 * Where something shows: the distance field of the macrocells along the rays.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_SKIP_H
#define GZ_RENDER_RAYCAST_CPU_CAST_SKIP_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/shared/macrocells.h"

/* The cell at k: which lanes' are empty, and up to which k (from above) all samples are alike. */
SIMD vm look_up_cell(const struct gz_cast *cast, const struct rays *rays, vf k, vm mask, vf *until)
{
	vi index = vi_set(0);
	vf cell[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf at = vf_fma(k, rays->delta[axis], rays->start[axis]);
		const vf place = at * vf_set(1.0F / GZ_MACROCELL_EDGE);
		cell[axis] =
			vf_floor(vf_min(vf_max(place, vf_set(0)), vf_set(cast->cell_last[axis])));
		index = vi_add(index,
			       vi_mul(vi_trunc(cell[axis]), vi_set(cast->cell_stride[axis])));
	}
	const vf away = vf_from_i(vi_and(vi_gather(cast->reach, index, 1, mask), vi_set(0xFF))) -
			vf_set(GZ_REACH_BORDER);
	/* A distance of d says that the cells less than d away are of the same kind. */
	const vf reach = vf_abs(away);
	vf leave = vf_set(3e38F);
	for (int axis = 0; axis < 3; axis++) {
		const vm forward = vf_less(vf_set(0), rays->delta[axis]);
		const vf high = cell[axis] + reach, low = cell[axis] + vf_set(1) - reach;
		const vf edge = vf_select(forward, high, low) * vf_set(GZ_MACROCELL_EDGE);
		leave = vf_min(leave, (edge - rays->start[axis]) * rays->inverse[axis]);
	}
	*until = leave;
	return vf_less(vf_set(0), away);
}

#endif
