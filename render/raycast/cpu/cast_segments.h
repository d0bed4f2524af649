/*
 * Segments side by side: all rays of a tile at the same distance from the eye, as their samples
 * march (cast_beam.h, cast_together.h). Segment number n lies between levels n and n + 1. A level
 * that ends one segment begins the next, so it is fetched once. Segments are listed if a fine cell
 * that the beam touches between both levels shows something. A ray's colour does not depend on its
 * tile: segments that some tiles take and others do not have no opacity (look_up_segments()). A
 * part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_SEGMENTS_H
#define GZ_RENDER_RAYCAST_CPU_CAST_SEGMENTS_H

#include <math.h>

#include "render/raycast/cpu/cast_preintegrated.h"
#include "render/raycast/cpu/cast_together.h"

/* The box around a beam's segments: at level n, from level n to n + 1 of its ends. */
SIMD struct beam beam_around_segments(const struct beam *ends)
{
	struct beam beam = *ends;
	for (int axis = 0; axis < 3; axis++) {
		beam.low[axis] += lesser(ends->low_step[axis], 0);
		beam.high[axis] += greater(ends->high_step[axis], 0);
	}
	const corner first = beam.high - beam.low;
	beam_spread(first, first + (beam.high_step - beam.low_step) * beam.count, &beam);
	return beam;
}

/* Segments whose colour has not been added yet: see struct waiting. */
struct waiting_segments {
	vf front_at; /* k */
	vi front, back;
	vm within; /* lanes that have one */
};

/* Segments of a beam on their way. */
struct segment_progress {
	vm alive[TILE_PARTS];
	vi entry[TILE_PARTS]; /* at the level reached */
	struct waiting_segments before[TILE_PARTS];
	float reached; /* level whose entries are known; below 0: none */
	vm known;      /* lanes whose entries are known, of a beam of scattered rays */
	struct light *light;
};

/* Add the waiting segments of a register. */
SIMD void settle_segments(const struct march *m, int part, struct segment_progress *on)
{
	const struct march one = march_of_part(m, part);
	const struct waiting_segments *waiting = &on->before[part];
	const vm needed = vm_and(waiting->within, on->alive[part]);
	vf opacity;
	vi colour;
	look_up_segments(&one, waiting->front, waiting->back, needed, &opacity, &colour);
	composite_at(&one, waiting->front_at + vf_set(0.5F), colour, opacity, needed,
		     &on->light[part]);
	on->alive[part] = vm_and(on->alive[part], vf_less(vf_set(m->cast->end_transmittance),
							  on->light[part].through));
}

/* Lanes whose whole segments begin at k. */
SIMD vm segments_begin(const struct rays *rays, vf k)
{
	return vm_but(vf_less(k, rays->end), vf_less(k, rays->first));
}

/* Lanes that have an end of a whole segment at k. */
SIMD vm segments_meet(const struct rays *rays, vf k)
{
	return vm_but(vm_but(rays->hit, vf_less(k, rays->first)), vf_less(rays->end, k));
}

#ifndef SIMD_BLOCKS

struct level_block {
	int none;
};

SIMD void find_level_block(const struct march *m, const struct beam *beam, float level,
			   struct level_block *at)
{
	(void)m, (void)beam, (void)level, (void)at;
}

SIMD vf fetch_level(const struct march *m, vf k, vm needed, const struct level_block *at)
{
	(void)at;
	return vm_any(needed) ? fetch_sample(m, k, needed) : vf_set(0);
}

SIMD struct level_block first_level_block(const struct march *m, int wide, const struct beam *beam,
					  float level)
{
	(void)m, (void)wide, (void)beam, (void)level;
	return (struct level_block) { 0 };
}

#endif

/* Fetch the ends of segments at a level. */
SIMD uint32_t fetch_ends(const struct march *m, const struct look_up *look_up,
			 const struct beam *beam, float level, const struct level_block *at,
			 int part, struct segment_progress *on)
{
	const struct march one = march_of_part(m, part);
	const vf k = beam->first[part] + vf_set(level);
	const vm needed = vm_and(segments_meet(one.rays, k), on->alive[part]);
	on->entry[part] = entry_of(look_up, fetch_level(&one, k, needed, at));
	return vm_count(needed);
}

/* Take the segments of one register at a level; their fronts are known. */
SIMD uint32_t take_segments(const struct march *m, const struct look_up *look_up,
			    const struct beam *beam, float level, const struct level_block *at,
			    int part, struct segment_progress *on)
{
	const vf k = beam->first[part] + vf_set(level);
	const vi front = on->entry[part];
	const uint32_t samples = fetch_ends(m, look_up, beam, level + 1, at, part, on);
	settle_segments(m, part, on);
	on->before[part] = (struct waiting_segments) { k, front, on->entry[part],
						       segments_begin(&m->rays[part], k) };
	return samples;
}

/* Take listed segments by blocks. */
SIMD uint32_t take_segments_together(const struct march *m, const struct look_up *look_up, int wide,
				     const struct beam *beam, const struct level_list *list,
				     struct segment_progress *on)
{
	const float *levels = list->levels;
	uint32_t samples = 0;
	/* Where the front is known, the first place that is asked for is the far end. */
	const float first = on->reached == levels[0] ? levels[0] + 1 : levels[0];
	struct level_block at = first_level_block(m, wide, beam, first);
	for (int i = 0; i < list->count && beam_alive(beam, on->alive); i++) {
		if (on->reached != levels[i]) {
			find_level_block(m, beam, levels[i], &at);
			for (int part = 0; part < beam_parts(beam); part++)
				samples += fetch_ends(m, look_up, beam, levels[i], &at, part, on);
		}
		find_level_block(m, beam, levels[i] + 1, &at);
		for (int part = 0; part < beam_parts(beam); part++)
			samples += take_segments(m, look_up, beam, levels[i], &at, part, on);
		on->reached = levels[i] + 1;
	}
	return samples;
}

/* How many parts of a segment are no longer than a fine cell along any axis. The same for all rays
 * with steps of a length. */
SIMD int parts_within_cells(const struct gz_cast *cast, int step)
{
	const float *world = cast->world_per_voxel;
	const float finest = lesser(world[0], lesser(world[1], world[2]));
	return 1 + (int)(cast->step[step] / (finest * GZ_FINE_EDGE));
}

/* Which of the whole segments that begin at k show something: in the fine cells of either end, or
 * of places between that lie no farther apart than a cell is long. All others show nothing:
 * neighbouring cells share voxels, so there is no gap between their ranges of values. */
SIMD vm segments_show(const struct gz_cast *cast, int step, const struct rays *rays, vf k, vm mask)
{
	const int parts = parts_within_cells(cast, step);
	vm shows = vm_but(mask, mask);
	for (int i = 0; i <= parts; i++) {
		const vf along = k + vf_set((float)i / (float)parts);
		vf at[3];
		for (int axis = 0; axis < 3; axis++)
			at[axis] = vf_fma(along, rays->delta[axis], rays->datum[axis]);
		shows = vm_or(shows, fine_shows(cast, at, mask));
	}
	return shows;
}

/* Take listed segments where rays are too far apart for a block: only those that show something.
 * The beam is of one register. */
SIMD uint32_t take_scattered_segments(const struct march *m, const struct look_up *look_up,
				      const struct beam *beam, const struct level_list *list,
				      struct segment_progress *on)
{
	uint32_t samples = 0;
	for (int i = 0; i < list->count && vm_any(on->alive[0]); i++) {
		const float level = list->levels[i];
		const vf k = beam->first[0] + vf_set(level);
		const vm begins = vm_and(segments_begin(m->rays, k), on->alive[0]);
		const vm shows = segments_show(m->cast, m->step, m->rays, k, begins);
		if (!vm_any(shows))
			continue;
		vi front = on->entry[0];
		const vm lacks = on->reached == level ? vm_but(shows, on->known) : shows;
		if (vm_any(lacks)) {
			const vf value = fetch_sample(m, k, lacks);
			front = vi_select(lacks, entry_of(look_up, value), front);
		}
		const vf value = fetch_sample(m, k + vf_set(1), shows);
		samples += vm_count(lacks) + vm_count(shows);
		settle_segments(m, 0, on);
		on->entry[0] = entry_of(look_up, value);
		on->before[0] = (struct waiting_segments) { k, front, on->entry[0], shows };
		on->known = shows;
		on->reached = level + 1;
	}
	return samples;
}

/* Take listed segments. */
SIMD uint32_t take_listed_segments(const struct march *m, const struct look_up *look_up,
				   enum company company, const struct beam *beam,
				   const struct level_list *list, struct segment_progress *on)
{
#ifdef SIMD_BLOCKS
	const enum gz_voxel_type type = m->reading.type;
	if (block_exists(type, 0) && company == SIDE_BY_SIDE)
		return take_segments_together(m, look_up, 0, beam, list, on);
	if (block_exists(type, 1) && company == IN_A_ROW)
		return take_segments_together(m, look_up, 1, beam, list, on);
#else
	if (company == SIDE_BY_SIDE)
		return take_segments_together(m, look_up, 0, beam, list, on);
#endif
	return take_scattered_segments(m, look_up, beam, list, on);
}

/* All whole segments of a beam. */
SIMD uint32_t march_beam_segments(const struct march *m, const struct look_up *look_up,
				  const struct beam *ends, const struct beam *around,
				  struct light *light)
{
	const enum company company = company_of(m->cast, m->reading, ends);
	const vm none = vf_less(vf_set(0), vf_set(0));
	struct level_list list;
	struct segment_progress on = { .reached = -1, .known = none, .light = light };
	uint32_t samples = 0;
	float from = 0;
	for (int part = 0; part < beam_parts(ends); part++) {
		on.alive[part] = rays_alive(m, &m->rays[part], &light[part]);
		on.entry[part] = vi_set(0);
		on.before[part] =
			(struct waiting_segments) { vf_set(0), vi_set(0), vi_set(0), none };
	}
	while (beam_alive(ends, on.alive) && list_levels(m->cast, around, &from, &list))
		samples += take_listed_segments(m, look_up, company, ends, &list, &on);
	for (int part = 0; part < beam_parts(ends); part++)
		settle_segments(m, part, &on);
	return samples;
}

/* All whole segments of a tile: its rays side by side if one block serves them, otherwise those of
 * each register. */
SIMD uint32_t march_beams_of_segments(const struct march *m, struct light light[TILE_PARTS])
{
	const struct look_up look_up = look_up_of(m->cast, m->reading);
	const struct beam tile = beam_of(m->rays, TILE_PARTS, 0);
	const int whole = TILE_PARTS == 1 || company_of(m->cast, m->reading, &tile) == SIDE_BY_SIDE;
	uint32_t samples = 0;
	for (int part = 0; part < TILE_PARTS; part += whole ? TILE_PARTS : 1) {
		const struct march some = march_of_part(m, part);
		const struct beam ends = whole ? tile : beam_of(some.rays, 1, 0);
		const struct beam around = beam_around_segments(&ends);
		if (around.grid < GZ_FINE_GRIDS)
			samples +=
				march_beam_segments(&some, &look_up, &ends, &around, &light[part]);
		else
			for (int i = part; i < part + beam_parts(&ends); i++) {
				const struct march one = march_of_part(m, i);
				samples += march_segments(&one, &light[i]);
			}
	}
	return samples;
}

/* All whole segments of a tile. */
SIMD uint32_t march_tile_segments(const struct march *m, struct light light[TILE_PARTS])
{
	uint32_t samples = 0;
	if (m->cast->fine[0].flags)
		return march_beams_of_segments(m, light);
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		samples += march_segments(&one, &light[part]);
	}
	return samples;
}

#endif
