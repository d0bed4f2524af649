/*
 * How the rays of a tile that march side by side fetch voxels: from one block that serves them all,
 * each for itself, or only where samples show something. If one ray's cell shows something, all
 * rays of a block take their samples; those in empty cells have no opacity. A part of the kernel:
 * see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_TOGETHER_H
#define GZ_RENDER_RAYCAST_CPU_CAST_TOGETHER_H

#ifdef SIMD_BLOCKS
#include "render/raycast/cpu/cast_block.h"
#endif
#include "render/raycast/cpu/cast_beam.h"

#ifdef SIMD_BLOCKS
/* Widest extents for wide blocks, along x and across. Rays that far apart gain more from a block,
 * so that a block pays even if it holds them only at the near side of the volume. */
#define TOGETHER_SPREAD_WIDE   7.0F
#define TOGETHER_SPREAD_ACROSS 3.5F

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

_Static_assert(TILE_PARTS <= 2, "take_together() takes two registers");

/* The block that serves the rays at a level. */
struct level_block {
	int wide;
	int holds; /* it holds all rays of the beam there, so none need be tested */
	__m128 base;
	struct block block;
};

SIMD void load_level_block(const struct march *m, const struct beam *beam, float level,
			   struct level_block *at)
{
	at->base = beam_block(m, at->wide, beam, level, &at->block);
	at->holds = block_serves(at->wide, beam, level, at->base);
}

SIMD struct level_block first_level_block(const struct march *m, int wide, const struct beam *beam,
					  float level)
{
	struct level_block at = { .wide = wide };
	load_level_block(m, beam, level, &at);
	return at;
}

/* Go on to a level. */
SIMD void find_level_block(const struct march *m, const struct beam *beam, float level,
			   struct level_block *at)
{
	at->holds = block_serves(at->wide, beam, level, at->base);
	if (!at->holds)
		load_level_block(m, beam, level, at);
}

/* The values at k of the needed lanes, from the block if it holds them. */
SIMD vf fetch_level(const struct march *m, vf k, vm needed, const struct level_block *at)
{
	vf place[3], places[3];
	for (int axis = 0; axis < 3; axis++) {
		place[axis] = vf_fma(k, m->rays->delta[axis], m->rays->datum[axis]);
		places[axis] = place[axis] - at->block.base[axis];
	}
	if (__builtin_expect(!at->holds, 0) &&
	    !block_places(m->cast, &at->block, at->wide, needed, places))
		return fetch_sample(m, k, needed);
	return block_sample(&at->block, m->reading.type, at->wide, places);
}

/* Take the samples of one register at a level. */
SIMD uint32_t take_level(const struct march *m, const struct look_up *look_up,
			 const struct beam *beam, float level, const struct level_block *at,
			 int part, struct progress *on)
{
	const struct march one = march_of_part(m, part);
	const vf k = beam->first[part] + vf_set(level);
	const vm within = vm_and(vf_less(one.rays->first, k), vf_less(k, one.rays->end));
	const vf value = fetch_level(&one, k, vm_and(within, on->alive[part]), at);
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
	struct level_block at = first_level_block(m, wide, beam, levels[0]);
	for (int i = 0; i < count && beam_alive(beam, on->alive); i++) {
		find_level_block(m, beam, levels[i], &at);
		samples += take_level(m, look_up, beam, levels[i], &at, 0, on);
		/* Written out, because both registers then share what they read: 2 % faster. */
		if (TILE_PARTS == 2 && beam->parts == 2)
			samples += take_level(m, look_up, beam, levels[i], &at, 1, on);
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

/* Take the samples of listed levels. */
SIMD uint32_t take_levels(const struct march *m, const struct look_up *look_up,
			  enum company company, const struct beam *beam,
			  const struct level_list *list, struct progress *on)
{
	const enum gz_voxel_type type = m->reading.type;
	if (block_exists(type, 0) && company == SIDE_BY_SIDE)
		return take_together(m, look_up, 0, beam, list, on);
	if (block_exists(type, 1) && company == IN_A_ROW)
		return take_together(m, look_up, 1, beam, list, on);
	return take_scattered(m, look_up, beam, list, on);
}

#else

/* Widest extent of a tile's rays, voxels, up to which all of them take a sample where one does. */
#define TOGETHER_SPREAD 3.5F

/* How the rays of a tile fetch voxels: each for itself, all of them or only those that show
 * something. */
enum company { SIDE_BY_SIDE, SCATTERED };

SIMD enum company company_of(const struct gz_cast *cast, struct reading reading,
			     const struct beam *beam)
{
	(void)cast, (void)reading;
	return beam->spread <= TOGETHER_SPREAD ? SIDE_BY_SIDE : SCATTERED;
}

/* Take the samples of one register at a level. */
SIMD uint32_t take_level(const struct march *m, const struct look_up *look_up,
			 const struct beam *beam, float level, int part, struct progress *on)
{
	const struct march one = march_of_part(m, part);
	const vf k = beam->first[part] + vf_set(level);
	const vm within = vm_and(vf_less(one.rays->first, k), vf_less(k, one.rays->end));
	const vm needed = vm_and(within, on->alive[part]);
	if (!vm_any(needed))
		return 0;
	const vi entry = entry_of(look_up, fetch_sample(&one, k, needed));
	const struct waiting now = { k, entry, within };
	return settle_waiting(&one, &now, &on->alive[part], &on->light[part]);
}

/* Take the samples of listed levels. */
SIMD uint32_t take_levels(const struct march *m, const struct look_up *look_up,
			  enum company company, const struct beam *beam,
			  const struct level_list *list, struct progress *on)
{
	uint32_t samples = 0;
	if (company == SCATTERED)
		return take_scattered(m, look_up, beam, list, on);
	for (int i = 0; i < list->count && beam_alive(beam, on->alive); i++)
		for (int part = 0; part < beam_parts(beam); part++)
			samples += take_level(m, look_up, beam, list->levels[i], part, on);
	return samples;
}

#endif

/* All whole segments of a beam. */
SIMD uint32_t march_beam(const struct march *m, const struct look_up *look_up,
			 const struct beam *beam, struct light *light)
{
	const enum company company = company_of(m->cast, m->reading, beam);
	struct level_list list;
	struct progress on = { .light = light };
	uint32_t samples = 0;
	float from = 0;
	for (int part = 0; part < beam_parts(beam); part++) {
		on.alive[part] = rays_alive(m, &m->rays[part], &light[part]);
		on.before[part] = none_waiting();
	}
	while (beam_alive(beam, on.alive) && list_levels(m->cast, beam, &from, &list)) {
		samples += take_levels(m, look_up, company, beam, &list, &on);
	}
	for (int part = 0; part < beam_parts(beam); part++)
		samples += settle_part(m, part, &on);
	return samples;
}

#endif
