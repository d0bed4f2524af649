/*
 * Which samples show something: the flags of the fine cells.
 * A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_FINE_H
#define GZ_RENDER_RAYCAST_CPU_CAST_FINE_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/fine_cells.h"

/* The cell of places counted from the first datum, along one axis. */
SIMD vf fine_place(const struct gz_cast_grid *grid, int axis, vf at)
{
	const vf place = at * vf_set(grid->cells_per_voxel);
	return vf_floor(vf_min(vf_max(place, vf_set(0)), vf_set(grid->last[axis])));
}

SIMD vi fine_index(const struct gz_cast_grid *grid, const vf cell[3])
{
	return vi_add(vi_trunc(cell[0]),
		      vi_add(vi_mul(vi_trunc(cell[1]), vi_set(grid->stride[1])),
			     vi_mul(vi_trunc(cell[2]), vi_set(grid->stride[2]))));
}

/* Which of the samples at these places show something, each for itself. */
SIMD vm fine_shows(const struct gz_cast *cast, const vf at[3], vm mask)
{
	const struct gz_cast_grid *grid = &cast->fine[0];
	vf cell[3];
	for (int axis = 0; axis < 3; axis++)
		cell[axis] = fine_place(grid, axis, at[axis]);
	const vi flags = vi_gather(grid->flags, fine_index(grid, cell), 1, mask);
	return vm_and(mask, vi_nonzero(vi_and(flags, vi_set((int32_t)GZ_FINE_FLAG(0)))));
}

#endif
