/*
 * Rays in voxel coordinates, cut by the box, and what the macrocells and fine cells say of the
 * space along them. A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_RAYS_H
#define GZ_RENDER_RAYCAST_CPU_CAST_RAYS_H

#include <stddef.h>

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/fine_cells.h"
#include "render/raycast/cpu/simd_clip.h"
#include "render/raycast/cpu/simd_light.h"
#include "render/raycast/shared/macrocells.h"

/* The lesser and the greater of two numbers: fminf() and fmaxf() are calls, for the sake of NaN. */
SIMD float lesser(float a, float b)
{
	return a < b ? a : b;
}

SIMD float greater(float a, float b)
{
	return a > b ? a : b;
}

/* The rays of one register. After k steps a ray is at start + k * delta in voxel coordinates, which
 * is datum + k * delta counted from the first datum. */
struct rays {
	vf start[3], datum[3], delta[3], inverse[3];
	vf zero;       /* steps from the origin to k = 0 */
	vf first, end; /* whole segments: from k = first to k = end */
	vf head;       /* length of the partial segment before the first, [0, 1) */
	vf head_at;    /* its middle */
	vf rest;       /* length of the partial segment after the last, [0, 1) */
	vm hit;
	const struct view *view; /* NULL: no light */
};

/* How voxels are read: constants of each kernel, so that the compiler drops what they exclude.
 * Passed by value. */
struct reading {
	enum gz_voxel_type type;
	int nearest;
};

/* Registers that the rays of a tile take. */
enum { TILE_PARTS = GZ_TILE_RAYS / SIMD_LANES };

struct near_voxels;
struct unlit;

/* What every function along rays needs. All of them are inlined, so that the fields stay in
 * registers and the constants stay constants. Do not pass it to a function that is not inlined. */
struct march {
	const struct gz_cast *cast;
	struct reading reading;
	int step;     /* of the plan */
	int rich;     /* there may be light or voxels with colours; a constant of each kernel, */
	int coloured; /* as is that there are such voxels */
	int part;     /* which register of the tile's, or the first of several */
	const struct rays *rays; /* its rays */
	/* with light: */
	struct near_voxels *near; /* of the tile: cast_near.h */
	struct unlit *unlit;      /* of the tile: cast_shade.h */
};

/* The march of the rays of one register of several. */
#define march_of_part(m, which)                                                         \
	((struct march) { (m)->cast, (m)->reading, (m)->step, (m)->rich, (m)->coloured, \
			  (m)->part + (which), (m)->rays + (which), (m)->near, (m)->unlit })

/* Steps from the origin to where the rays enter the whole box, and to where they enter and leave
 * the shown part of it. */
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
	cut_by_plane(cast->clip_plane, origin, rays->delta, &cuts.enter, &cuts.leave);
	return cuts;
}

/* Count segments from `shift` steps before the box, and find which are whole. */
SIMD void count_segments(struct cuts cuts, vf shift, struct rays *rays)
{
	const vf none = vf_set(0);
	const vf from = vf_select(rays->hit, cuts.enter - cuts.box + shift, none);
	const vf to = vf_select(rays->hit, cuts.leave - cuts.box + shift, none);
	rays->first = vf_ceil(from);
	rays->end = vf_floor(to);
	rays->head = vf_min(rays->first, to) - from;
	rays->head_at = vf_fma(rays->head, vf_set(0.5F), from);
	/* If everything lies within one segment, the head is all. */
	rays->rest = vf_select(vf_less(rays->end, rays->first), none, to - rays->end);
}

/* Set up SIMD_LANES rays of a tile from number `first` on, cut by the box and the clip region.
 * Segments begin a jitter before the box. */
SIMD void set_up_rays(const struct gz_cast *cast, const struct gz_cast_tile *tile, int first,
		      struct rays *rays)
{
	const vf x = vf_load(tile->x + first), y = vf_load(tile->y + first);
	const vf shift = vf_load(tile->jitter + first);
	const vm active = vm_from_bits(tile->active >> first);
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
	const vf scale = vf_set(cast->step[tile->step]) / vf_sqrt(length2);
	for (int axis = 0; axis < 3; axis++) {
		const vf least = vf_set(1e-12F);
		const vf raw = direction[axis] * scale;
		const vf delta = vf_select(vf_less(vf_abs(raw), least), least, raw);
		rays->delta[axis] = delta;
		rays->inverse[axis] = vf_set(1) / delta;
	}
	rays->view = NULL;
	struct cuts cuts = cut_rays(cast, origin, rays);
	if (__builtin_expect(tile->hit_depth != NULL, 0))
		cuts.leave = vf_min(cuts.leave, vf_load(tile->hit_depth + first) *
							vf_set(1 / cast->step[tile->step]));
	rays->hit = vm_and(active, vf_less(cuts.enter, cuts.leave));
	count_segments(cuts, shift, rays);
	const vf zero = cuts.box - shift;
	rays->zero = zero;
	for (int axis = 0; axis < 3; axis++) {
		rays->start[axis] = vf_fma(zero, rays->delta[axis], origin[axis]);
		rays->datum[axis] = vf_fma(zero, rays->delta[axis], origin[axis] - vf_set(0.5F));
	}
}

/* Find which lanes' macrocells at k are empty, and the k up to which all samples are like this one.
 */
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
	/* Cells less than this distance away are of the same kind. */
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

/* The fine cell along one axis of places counted from the first datum. */
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

/* Which of the samples at these places show something. */
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
