/*
 * Marching side by side: all rays of a tile at the same distance from the eye, so that one block of
 * voxels serves them all. A level is one step of all rays, counted from the first ray's first
 * sample. As many levels as lanes are tested at a time for the tile as a whole, and those that show
 * something are listed before any is sampled. If one ray's cell shows something, all rays take
 * their samples; those in empty cells have no opacity. A part of the kernel, for sets with blocks:
 * see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_TOGETHER_H
#define GZ_RENDER_RAYCAST_CPU_CAST_TOGETHER_H

#include <math.h>

#include "render/raycast/cpu/cast_block.h"
#include "render/raycast/cpu/cast_shade.h"

/* Widest extents for wide blocks, along x and across. Rays that far apart gain more from a block,
 * so that a block pays even if it holds them only at the near side of the volume. */
#define TOGETHER_SPREAD_WIDE   7.0F
#define TOGETHER_SPREAD_ACROSS 3.5F
/* Rounding error of a ray's place, voxels, at most. */
#define TOGETHER_SLACK (1.0F / 32)

/* Levels that are listed at a time. Chosen: a stretch is seldom longer. */
enum { LEVELS_LISTED = 64 };

/* Levels that show something. */
struct level_list {
	int count;
	float levels[LEVELS_LISTED + SIMD_LANES];
};

/* A box around all rays of a tile at each level. Its corners go straight, and no ray is ever
 * outside. Corners are x, y, z and 0, counted from the first datum. */
struct beam {
	__m128 low, high;           /* at level 0 */
	__m128 low_step, high_step; /* from one level to the next */
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

/* k at level 0: the first sample of the ray that comes first, and the samples of the others that
 * are level with it, which may lie before they enter the box. Finds the levels, too. */
SIMD void beam_levels(const struct rays *rays, struct beam *beam)
{
	float nearest = INFINITY;
	for (int part = 0; part < beam_parts(beam); part++)
		nearest = fminf(nearest,
				vf_least_of(rays[part].zero + rays[part].first, rays[part].hit));
	beam->count = 0;
	for (int part = 0; part < beam_parts(beam); part++) {
		beam->first[part] = vf_set(0.5F) + vf_nearest(vf_set(nearest) - rays[part].zero);
		const vf levels = rays[part].end - beam->first[part];
		beam->count = fmaxf(beam->count, ceilf(vf_greatest_of(levels, rays[part].hit)));
	}
}

/* The box around the places at a level. */
SIMD void beam_corners(const struct rays *rays, const struct beam *beam, float level, __m128 *low,
		       __m128 *high)
{
	float least[3] = { INFINITY, INFINITY, INFINITY };
	float most[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (int part = 0; part < beam_parts(beam); part++)
		for (int axis = 0; axis < 3; axis++) {
			const struct rays *of = &rays[part];
			const vf at = vf_fma(beam->first[part] + vf_set(level), of->delta[axis],
					     of->datum[axis]);
			least[axis] = fminf(least[axis], vf_least_of(at, of->hit));
			most[axis] = fmaxf(most[axis], vf_greatest_of(at, of->hit));
		}
	const __m128 slack = _mm_set1_ps(TOGETHER_SLACK);
	*low = _mm_sub_ps(_mm_setr_ps(least[0], least[1], least[2], 0), slack);
	*high = _mm_add_ps(_mm_setr_ps(most[0], most[1], most[2], 0), slack);
}

SIMD float greatest_of_four(__m128 x)
{
	const __m128 two = _mm_max_ps(x, _mm_movehl_ps(x, x));
	return _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)));
}

SIMD __m128 absolute_of_four(__m128 x)
{
	return _mm_andnot_ps(_mm_set1_ps(-0.0F), x);
}

/* Each ray moves straight and evenly, so the least coordinate of all rays is a concave function of
 * the level and never below the line between its ends; likewise for the greatest. */
SIMD struct beam beam_of(const struct rays *rays, int parts)
{
	struct beam beam = { .parts = parts };
	beam_levels(rays, &beam);
	__m128 low, high;
	beam_corners(rays, &beam, 0, &beam.low, &beam.high);
	beam_corners(rays, &beam, beam.count, &low, &high);
	const __m128 share = _mm_set1_ps(1 / fmaxf(beam.count, 1));
	beam.low_step = _mm_mul_ps(_mm_sub_ps(low, beam.low), share);
	beam.high_step = _mm_mul_ps(_mm_sub_ps(high, beam.high), share);
	const __m128 edges = _mm_max_ps(_mm_sub_ps(beam.high, beam.low), _mm_sub_ps(high, low));
	beam.spread_x = edges[0];
	beam.spread_yz = fmaxf(edges[1], edges[2]);
	beam.spread = fmaxf(beam.spread_x, beam.spread_yz);
	while (beam.grid < GZ_FINE_GRIDS && beam.spread > (float)(GZ_FINE_EDGE << beam.grid))
		beam.grid++;
	beam.levels_per_voxel = 1 / greatest_of_four(_mm_max_ps(absolute_of_four(beam.low_step),
								absolute_of_four(beam.high_step)));
	return beam;
}

/* The cells of a corner along one axis at several levels. */
SIMD vi beam_cells(const struct gz_cast_grid *grid, const __m128 *corner, const __m128 *step,
		   int axis, vf level)
{
	const vf place = vf_fma(level, vf_set((*step)[axis] * grid->cells_per_voxel),
				vf_set((*corner)[axis] * grid->cells_per_voxel));
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
	const __m128 low = _mm_fmadd_ps(_mm_set1_ps(level), beam->low_step, beam->low);
	const __m128 last =
		_mm_setr_ps(cast->cell_last[0], cast->cell_last[1], cast->cell_last[2], 0);
	const __m128 place = _mm_mul_ps(_mm_add_ps(low, _mm_set1_ps(0.5F)),
					_mm_set1_ps(1.0F / GZ_MACROCELL_EDGE));
	const __m128i cell =
		_mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(place, _mm_setzero_ps()), last));
	const int64_t index = _mm_cvtsi128_si32(cell) +
			      (int64_t)_mm_extract_epi32(cell, 1) * cast->cell_stride[1] +
			      (int64_t)_mm_extract_epi32(cell, 2) * cast->cell_stride[2];
	/* Cells less than this away are empty; the low corner is anywhere in its own cell. */
	const int away = cast->reach[index] - GZ_REACH_BORDER;
	const float free = (float)((away - 1) * GZ_MACROCELL_EDGE) - beam->spread;
	return fmaxf(floorf(free * beam->levels_per_voxel), 0);
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

/* The box around all rays at a level. */
SIMD void beam_box(const struct beam *beam, float level, __m128 *low, __m128 *high)
{
	*low = _mm_fmadd_ps(_mm_set1_ps(level), beam->low_step, beam->low);
	*high = _mm_fmadd_ps(_mm_set1_ps(level), beam->high_step, beam->high);
}

/* Cells along the edges of a block. */
SIMD __m128 block_cells(int wide)
{
	return _mm_setr_ps(block_edge(wide, 0) - 1, BLOCK_EDGE - 1, BLOCK_EDGE - 1, 1);
}

/* Whether the block that begins at `base` holds the beam at a level. */
SIMD int block_serves(int wide, const struct beam *beam, float level, __m128 base)
{
	__m128 low, high;
	beam_box(beam, level, &low, &high);
	const __m128 beyond = _mm_cmple_ps(_mm_add_ps(base, block_cells(wide)), high);
	return (_mm_movemask_ps(_mm_or_ps(_mm_cmplt_ps(low, base), beyond)) & 7) == 0;
}

/* Load the block of a level. It begins so that it holds the beam as far ahead as it can. Returns
 * where. */
SIMD __m128 beam_block(const struct march *m, int wide, const struct beam *beam, float level,
		       struct block *block)
{
	__m128 low, high;
	beam_box(beam, level, &low, &high);
	const __m128 backward = _mm_sub_ps(_mm_add_ps(high, _mm_set1_ps(1)), block_cells(wide));
	return block_take(m->cast, m->reading.type, wide,
			  _mm_blendv_ps(low, backward, beam->low_step), block);
}

/* The values at k of the needed lanes, from the block if it holds them. */
SIMD vf fetch_together(const struct march *m, int wide, vf k, vm needed, const struct block *block)
{
	vf at[3], places[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, m->rays->delta[axis], m->rays->datum[axis]);
	if (__builtin_expect(!block_places(m->cast, block, wide, at, needed, places), 0))
		return fetch_sample(m, k, needed);
	return block_sample(block, m->reading.type, wide, places);
}

/* A beam on its way: of each register, which rays are alive, and the sample that waits. */
struct progress {
	vm alive[TILE_PARTS];
	struct waiting before[TILE_PARTS];
	struct light *light;
};

SIMD int beam_alive(const struct progress *on, int parts)
{
	vm alive = on->alive[0];
	for (int part = 1; part < parts; part++)
		alive = vm_or(alive, on->alive[part]);
	return vm_any(alive);
}

/* Add the waiting sample of a register. */
SIMD uint32_t settle_part(const struct march *m, int part, struct progress *on)
{
	const struct march one = march_of_part(m, part);
	return settle_waiting(&one, &on->before[part], &on->alive[part], &on->light[part]);
}

/* Take the samples of one register at a level. */
SIMD uint32_t take_level(const struct march *m, const struct look_up *look_up, int wide,
			 const struct beam *beam, float level, const struct block *block, int part,
			 struct progress *on)
{
	const struct march one = march_of_part(m, part);
	const vf k = beam->first[part] + vf_set(level);
	const vm within = vm_and(vf_less(one.rays->first, k), vf_less(k, one.rays->end));
	const vf value = fetch_together(&one, wide, k, vm_and(within, on->alive[part]), block);
	const uint32_t samples = settle_part(m, part, on);
	on->before[part] = (struct waiting) { k, entry_of(look_up, value), within };
	return samples;
}

/* Take the samples of listed levels by blocks. A sample's colour is looked up during the next one:
 * a processor that runs a dozen loads ahead, but not two samples, is never idle. */
SIMD uint32_t take_together(const struct march *m, const struct look_up *look_up, int wide,
			    const struct beam *beam, const struct level_list *list,
			    struct progress *on)
{
	const float *levels = list->levels;
	const int count = list->count;
	uint32_t samples = 0;
	struct block block;
	__m128 base = beam_block(m, wide, beam, levels[0], &block);
	for (int i = 0; i < count && beam_alive(on, beam_parts(beam)); i++) {
		if (!block_serves(wide, beam, levels[i], base))
			base = beam_block(m, wide, beam, levels[i], &block);
		for (int part = 0; part < beam_parts(beam); part++)
			samples += take_level(m, look_up, wide, beam, levels[i], &block, part, on);
	}
	return samples;
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
		_mm_prefetch(row, _MM_HINT_T0);
		_mm_prefetch(row + up_y * bytes, _MM_HINT_T0);
		_mm_prefetch(row + up_z * bytes, _MM_HINT_T0);
		_mm_prefetch(row + (up_y + up_z) * bytes, _MM_HINT_T0);
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

/* How the rays of a tile fetch voxels: by blocks, by wide blocks, each for itself. */
enum company { SIDE_BY_SIDE, IN_A_ROW, SCATTERED };

SIMD enum company company_of(const struct gz_cast *cast, struct reading reading,
			     const struct beam *beam)
{
	const enum gz_voxel_type type = reading.type;
	if (reading.nearest)
		return SCATTERED;
	if (beam->spread <= TOGETHER_SPREAD && blocks_fit(cast, type, 0))
		return SIDE_BY_SIDE;
	return beam->spread_x <= TOGETHER_SPREAD_WIDE &&
			       beam->spread_yz <= TOGETHER_SPREAD_ACROSS &&
			       blocks_fit(cast, type, 1)
		       ? IN_A_ROW
		       : SCATTERED;
}

/* All whole segments of a beam. */
SIMD uint32_t march_beam(const struct march *m, const struct look_up *look_up,
			 const struct beam *beam, struct light *light)
{
	const enum gz_voxel_type type = m->reading.type;
	const enum company company = company_of(m->cast, m->reading, beam);
	struct level_list list;
	struct progress on = { .light = light };
	uint32_t samples = 0;
	float from = 0;
	for (int part = 0; part < beam_parts(beam); part++) {
		on.alive[part] = rays_alive(m, &m->rays[part], &light[part]);
		on.before[part] = none_waiting();
	}
	while (beam_alive(&on, beam_parts(beam)) && list_levels(m->cast, beam, &from, &list)) {
		if (block_exists(type, 0) && company == SIDE_BY_SIDE)
			samples += take_together(m, look_up, 0, beam, &list, &on);
		else if (block_exists(type, 1) && company == IN_A_ROW)
			samples += take_together(m, look_up, 1, beam, &list, &on);
		else
			samples += take_scattered(m, look_up, beam, &list, &on);
	}
	for (int part = 0; part < beam_parts(beam); part++)
		samples += settle_part(m, part, &on);
	return samples;
}

#endif
