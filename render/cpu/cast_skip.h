/*
 * Where something shows: the distance field of the macrocells along the rays.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_CPU_CAST_SKIP_H
#define GZ_RENDER_CPU_CAST_SKIP_H

#include "render/cpu/cast.h"
#include "render/cpu/cast_rays.h"
#include "render/macrocells.h"

/* Distance field at k: *leap says how many samples may be skipped, *until up to which k (from
 * above) the cell at hand lasts. Lanes in a cell where something shows have a leap of 0. */
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
	const vi distance = vi_and(vi_gather(cast->distance, index, 1, mask), vi_set(0xFF));
	/* A distance of d says that d - 1 cells to each side are empty too. An occupied cell has
	 * itself. */
	const vf reach = vf_max(vf_from_i(distance), vf_set(1));
	vf leave = vf_set(3e38F);
	for (int axis = 0; axis < 3; axis++) {
		const vm forward = vf_less(vf_set(0), rays->delta[axis]);
		const vf high = cell[axis] + reach, low = cell[axis] + vf_set(1) - reach;
		const vf edge = vf_select(forward, high, low) * vf_set(GZ_MACROCELL_EDGE);
		leave = vf_min(leave, (edge - rays->start[axis]) * rays->inverse[axis]);
	}
	*until = leave;
	return vi_nonzero(distance);
}

#endif
