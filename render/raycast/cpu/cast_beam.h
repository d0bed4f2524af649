/*
 * Marching side by side: all rays of a tile at the same distance from the eye. A level is one step
 * of all rays, counted from the first ray's first sample, or from the beginning of its first
 * segment. As many levels as lanes are tested at a time for the tile as a whole, and those that
 * show something are listed before any is sampled. A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_BEAM_H
#define GZ_RENDER_RAYCAST_CPU_CAST_BEAM_H

#include <math.h>

#include "render/raycast/cpu/cast_shade.h"

/* Rounding error of a ray's place, voxels, at most. */
#define BEAM_SLACK (1.0F / 32)

/* Levels that are listed at a time. Chosen: a stretch is seldom longer. */
enum { LEVELS_LISTED = 64 };

/* Levels that show something. */
struct level_list {
	int count;
	float levels[LEVELS_LISTED + SIMD_LANES];
};

/* x, y, z and 0 */
typedef float corner __attribute__((vector_size(16)));

/* A box around all rays of a tile at each level from 0 to `count`. Its corners go straight, and no
 * ray is ever outside. Corners are counted from the first datum. */
struct beam {
	corner low, high;           /* at level 0 */
	corner low_step, high_step; /* from one level to the next */
	float spread;               /* longest edge of the box at any level, voxels */
	float spread_x, spread_yz;  /* longest edges along x, and across */
	int grid;                   /* of the fine cells that are at least as long */
	float levels_per_voxel;     /* of the corner and axis that move fastest */
	int parts;                  /* registers of rays */
	vf first[TILE_PARTS];       /* k at level 0 */
	float count;                /* levels */
};

/* Registers of rays in a beam: a constant where a tile has but one. */
SIMD int beam_parts(const struct beam *beam)
{
	return TILE_PARTS == 1 ? 1 : beam->parts;
}

/* k at level 0: the place `within` the first segment, from 0 to 1, of the ray that comes first, and
 * the places of the others that are level with it, which may lie before they enter the box. Finds
 * the levels, too. */
SIMD void beam_levels(const struct rays *rays, float within, struct beam *beam)
{
	float nearest = INFINITY;
	for (int part = 0; part < beam_parts(beam); part++)
		nearest = lesser(nearest,
				 vf_least_of(rays[part].zero + rays[part].first, rays[part].hit));
	beam->count = 0;
	for (int part = 0; part < beam_parts(beam); part++) {
		beam->first[part] = vf_set(within) + vf_nearest(vf_set(nearest) - rays[part].zero);
		const vf levels = rays[part].end - beam->first[part];
		beam->count = greater(beam->count, ceilf(vf_greatest_of(levels, rays[part].hit)));
	}
}

/* The box around the places at a level. */
SIMD void beam_corners(const struct rays *rays, const struct beam *beam, float level, corner *low,
		       corner *high)
{
	float least[3] = { INFINITY, INFINITY, INFINITY };
	float most[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (int part = 0; part < beam_parts(beam); part++)
		for (int axis = 0; axis < 3; axis++) {
			const struct rays *of = &rays[part];
			const vf at = vf_fma(beam->first[part] + vf_set(level), of->delta[axis],
					     of->datum[axis]);
			least[axis] = lesser(least[axis], vf_least_of(at, of->hit));
			most[axis] = greater(most[axis], vf_greatest_of(at, of->hit));
		}
	*low = (corner) { least[0], least[1], least[2], 0 } - BEAM_SLACK;
	*high = (corner) { most[0], most[1], most[2], 0 } + BEAM_SLACK;
}

/* The longest way along any axis. */
SIMD float longest_way(corner way)
{
	return greater(greater(fabsf(way[0]), fabsf(way[1])), fabsf(way[2]));
}

/* How long the box is, from its edges at both ends. */
SIMD void beam_spread(corner first, corner last, struct beam *beam)
{
	beam->spread_x = greater(first[0], last[0]);
	beam->spread_yz = greater(greater(first[1], last[1]), greater(first[2], last[2]));
	beam->spread = greater(beam->spread_x, beam->spread_yz);
	beam->grid = 0;
	while (beam->grid < GZ_FINE_GRIDS && beam->spread > (float)(GZ_FINE_EDGE << beam->grid))
		beam->grid++;
}

/* The rays whose levels lie `within` their segments: 1/2 for samples, 0 for the ends of segments.
 * Each ray moves straight and evenly, so the least coordinate of all rays is a concave function of
 * the level and never below the line between its ends; likewise for the greatest. */
SIMD struct beam beam_of(const struct rays *rays, int parts, float within)
{
	struct beam beam = { .parts = parts };
	beam_levels(rays, within, &beam);
	corner low, high;
	beam_corners(rays, &beam, 0, &beam.low, &beam.high);
	beam_corners(rays, &beam, beam.count, &low, &high);
	const float share = 1 / greater(beam.count, 1);
	beam.low_step = (low - beam.low) * share;
	beam.high_step = (high - beam.high) * share;
	beam_spread(beam.high - beam.low, high - low, &beam);
	beam.levels_per_voxel =
		1 / greater(longest_way(beam.low_step), longest_way(beam.high_step));
	return beam;
}

/* The cells of a corner along one axis at several levels. */
SIMD vi beam_cells(const struct gz_cast_grid *grid, const corner *at, const corner *step, int axis,
		   vf level)
{
	const vf place = vf_fma(level, vf_set((*step)[axis] * grid->cells_per_voxel),
				vf_set((*at)[axis] * grid->cells_per_voxel));
	return vi_min(vi_trunc(vf_max(place, vf_set(0))), vi_set((int32_t)grid->last[axis]));
}

/* Which of these levels show something in any cell that the beam's box touches. The box is no
 * longer than a cell. */
SIMD vm beam_shows(const struct gz_cast *cast, const struct beam *beam, vf level)
{
	const struct gz_cast_grid *grid = &cast->fine[beam->grid];
	vi index = vi_set(0), axes = vi_set(0);
	for (int axis = 0; axis < 3; axis++) {
		const vi cell = beam_cells(grid, &beam->low, &beam->low_step, axis, level);
		const vi last = beam_cells(grid, &beam->high, &beam->high_step, axis, level);
		axes = vi_or(axes, vi_select(vi_less(cell, last), vi_set(1 << axis), vi_set(0)));
		index = vi_add(index, vi_mul(cell, vi_set(grid->stride[axis])));
	}
	const vm asked = vf_less(level, vf_set(beam->count));
	const vi flags = vi_gather(grid->flags, index, 1, asked);
	return vm_and(asked, vi_nonzero(vi_and(vi_shift_right_each(flags, axes), vi_set(1))));
}

/* How many levels after one that shows nothing are empty too, by the macrocells. */
SIMD float beam_empty(const struct gz_cast *cast, const struct beam *beam, float level)
{
	int64_t index = 0;
	for (int axis = 0; axis < 3; axis++) {
		const float low = beam->low[axis] + level * beam->low_step[axis];
		const float place = (low + 0.5F) * (1.0F / GZ_MACROCELL_EDGE);
		const int64_t cell = (int64_t)lesser(greater(place, 0), cast->cell_last[axis]);
		index += cell * cast->cell_stride[axis];
	}
	/* Cells less than this away are empty; the low corner is anywhere in its own cell. */
	const int away = cast->reach[index] - GZ_REACH_BORDER;
	const float free = (float)((away - 1) * GZ_MACROCELL_EDGE) - beam->spread;
	return greater(floorf(free * beam->levels_per_voxel), 0);
}

/* List levels that show something, from `from` on, and advance it. Returns false at the end. */
SIMD int list_levels(const struct gz_cast *cast, const struct beam *beam, float *from,
		     struct level_list *list)
{
	int count = 0;
	while (*from < beam->count && count < LEVELS_LISTED) {
		const vf level = vf_set(*from) + vf_counting();
		const vm shows = beam_shows(cast, beam, level);
		*from += SIMD_LANES;
		if (vm_any(shows)) {
			count += vf_store_packed(list->levels + count, level, shows);
		} else {
			*from += beam_empty(cast, beam, *from - 1);
		}
	}
	list->count = count;
	return count > 0;
}

/* A beam on its way: of each register, which rays are alive, and the sample that waits. */
struct progress {
	vm alive[TILE_PARTS];
	struct waiting before[TILE_PARTS];
	struct light *light;
};

/* Whether any ray of a beam's registers is alive. */
SIMD int beam_alive(const struct beam *beam, const vm alive[TILE_PARTS])
{
	int any = 0;
	for (int part = 0; part < beam_parts(beam); part++)
		any |= vm_any(alive[part]);
	return any;
}

/* Add the waiting sample of a register. */
SIMD uint32_t settle_part(const struct march *m, int part, struct progress *on)
{
	const struct march one = march_of_part(m, part);
	return settle_waiting(&one, &on->before[part], &on->alive[part], &on->light[part]);
}

/* Levels where rays have samples that show something. */
struct showing {
	int count;
	float level[LEVELS_LISTED + SIMD_LANES];
	vm rays[LEVELS_LISTED + SIMD_LANES];
	/* index of the first voxel that each ray fetches; 0, which is in the cache, if none */
	int32_t first[LEVELS_LISTED + SIMD_LANES][SIMD_LANES];
};

/* How many levels ahead voxels are prefetched. Chosen by measuring. */
enum { LEVELS_AHEAD = 2 };

/* Prefetch the voxels that the rays of a level will fetch. */
SIMD void prefetch_voxels(const struct gz_cast *cast, enum gz_voxel_type type, const int32_t *first)
{
	const int64_t up_y = cast->stride[1], up_z = cast->stride[2];
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : type == GZ_VOXEL_U16 ? 2 : 4;
	const char *voxels = cast->voxels;
	for (int lane = 0; lane < SIMD_LANES; lane++) {
		const char *row = voxels + first[lane] * bytes;
		__builtin_prefetch(row);
		__builtin_prefetch(row + up_y * bytes);
		__builtin_prefetch(row + up_z * bytes);
		__builtin_prefetch(row + (up_y + up_z) * bytes);
	}
}

/* Of a beam of one register. */
SIMD void find_showing(const struct march *m, const struct beam *beam,
		       const struct level_list *list, struct showing *showing)
{
	const struct gz_cast *cast = m->cast;
	const struct rays *rays = m->rays;
	const float *levels = list->levels;
	int kept = 0;
	for (int i = 0; i < list->count; i++) {
		const vf k = beam->first[0] + vf_set(levels[i]);
		const vm within = vm_and(vf_less(rays->first, k), vf_less(k, rays->end));
		vf at[3];
		for (int axis = 0; axis < 3; axis++)
			at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
		const vm shows = fine_shows(cast, at, within);
		showing->level[kept] = levels[i];
		showing->rays[kept] = shows;
		vi_store((uint32_t *)showing->first[kept],
			 vi_select(shows, first_voxel(cast, at), vi_set(0)));
		kept += vm_any(shows);
	}
	showing->count = kept;
	for (int i = 0; i < kept && i < LEVELS_AHEAD; i++)
		prefetch_voxels(cast, m->reading.type, showing->first[i]);
}

/* Take the samples of listed levels where rays are too far apart for a block: only those that show
 * something. The beam is of one register. */
SIMD uint32_t take_scattered(const struct march *m, const struct look_up *look_up,
			     const struct beam *beam, const struct level_list *list,
			     struct progress *on)
{
	struct showing showing;
	uint32_t samples = 0;
	find_showing(m, beam, list, &showing);
	for (int i = 0; i < showing.count && vm_any(on->alive[0]); i++) {
		const vf k = beam->first[0] + vf_set(showing.level[i]);
		if (i + LEVELS_AHEAD < showing.count)
			prefetch_voxels(m->cast, m->reading.type, showing.first[i + LEVELS_AHEAD]);
		const vf value = fetch_sample(m, k, vm_and(showing.rays[i], on->alive[0]));
		samples += settle_part(m, 0, on);
		on->before[0] = (struct waiting) { k, entry_of(look_up, value), showing.rays[i] };
	}
	return samples;
}

#endif
