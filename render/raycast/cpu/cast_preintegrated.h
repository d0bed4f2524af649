/*
 * Segments instead of samples: a pre-integrated table gives colour and opacity by the values at
 * both ends of a segment, so that no thin layer is missed. The end of a segment is the front of the
 * next. A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_PREINTEGRATED_H
#define GZ_RENDER_RAYCAST_CPU_CAST_PREINTEGRATED_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/cpu/cast_shade.h"
#include "render/transfer/transfer_preintegrated.h"

/* From an entry of the transfer function to a row or column of the pre-integrated table. */
SIMD vi preintegrated_cell(const struct gz_cast *cast, vi entry)
{
	return vi_shift_right_by(entry, cast->preintegrated_shift);
}

/* The place of a pair of entries in the pre-integrated table. */
SIMD vi preintegrated_pair(const struct gz_cast *cast, vi front, vi back)
{
	const vi row = preintegrated_cell(cast, front);
	return vi_or(vi_shift_left(row, __builtin_ctz(GZ_PREINTEGRATED_SIZE)),
		     preintegrated_cell(cast, back));
}

/* Cells of a fine transfer table are wide beside its narrowest peaks. So a segment between two
 * close entries takes the entry in the middle instead, from a table of samples. */
SIMD void take_close_entries(const struct gz_transfer_entry *samples, vi front, vi back, vm mask,
			     vf *opacity, vi *colour)
{
	const vf from = vf_from_i(front), to = vf_from_i(back);
	const vm close = vm_and(mask, vf_less(vf_abs(to - from), vf_set(GZ_CLOSE_ENTRIES)));
	vf own_opacity;
	vi own_colour;
	gather_pair(samples, vi_trunc((from + to) * vf_set(0.5F)), close, &own_opacity,
		    &own_colour);
	*opacity = vf_select(close, own_opacity, *opacity);
	*colour = vi_select(close, own_colour, *colour);
}

/* Which of the segments between two entries have an entry between them, or at either end, that
 * shows something. */
SIMD vm segments_have_visible(const struct gz_cast *cast, vi front, vi back, vm mask)
{
	const vi low = vi_min(front, back);
	const vi high = vi_select(vi_less(front, back), back, front);
	const vi before = vi_gather(cast->visible_before, low, 4, mask);
	const vi until = vi_gather(cast->visible_before + 1, high, 4, mask);
	return vm_and(mask, vi_less(before, until));
}

/* The opacities of segments of which some are marked (struct gz_preintegration): none if no entry
 * between their ends shows anything. Not inlined, since few segments are marked. */
static __attribute__((noinline)) vf settle_doubtful(const struct gz_cast *cast, vi front, vi back,
						    vf opacity, vm marked)
{
	const vm shows = segments_have_visible(cast, front, back, marked);
	const vf settled = vf_keep(shows, vf_abs(opacity));
	return vf_select(marked, settled, opacity);
}

/* Opacity and colour of whole segments between two entries. */
SIMD void look_up_segments(const struct march *m, vi front, vi back, vm mask, vf *opacity,
			   vi *colour)
{
	const struct gz_cast *cast = m->cast;
	load_pairs(cast->preintegrated[m->step], preintegrated_pair(cast, front, back), opacity,
		   colour);
	const vm marked = vm_and(mask, vf_less(*opacity, vf_set(0)));
	if (__builtin_expect(vm_any(marked), 0))
		*opacity = settle_doubtful(cast, front, back, *opacity, marked);
	if (__builtin_expect(cast->fine_entries, 0))
		take_close_entries(cast->step_table[m->step], front, back, mask, opacity, colour);
}

/*
 * For lanes that ask, at the fronts of their segments: find how far segments are to be taken, and
 * advance past the segments that lie wholly in empty space. A segment that begins there and ends
 * outside is taken. Nothing shows between two values of neighbouring empty cells: the cells share
 * voxels, so there is no gap between their ranges of values.
 */
SIMD void look_ahead_segments(const struct gz_cast *cast, const struct rays *rays, vm asks, vf *k,
			      vf *until, vm *known)
{
	vf leave;
	const vm empty = vm_and(look_up_cell(cast, rays, *k, asks, &leave), asks);
	const vf next = vf_select(empty, vf_max(vf_floor(leave), *k), *k);
	*known = vm_but(*known, vf_less(*k, next));
	*k = next;
	/* At least one segment, wherever rounding puts the end of the cell. */
	const vf one = *k + vf_set(0.5F);
	*until = vf_select(asks, vf_select(empty, one, vf_max(leave, one)), *until);
}

/* All whole segments of one register, each ray for itself; k counts their fronts. */
SIMD uint32_t march_segments(const struct march *m, struct light *light)
{
	const struct gz_cast *cast = m->cast;
	const struct rays *rays = m->rays;
	const struct look_up look_up = look_up_of(cast, m->reading);
	const vf end = rays->end;
	vf k = rays->first;
	vf until = vf_set(-1); /* segments that begin before it are taken */
	vi front = vi_set(0);
	uint32_t samples = 0;
	vm alive = rays->hit;
	vm known = vm_but(alive, alive); /* front is that of k */
	for (;;) {
		const vm asks = vm_but(vm_and(alive, vf_less(k, end)), vf_less(k, until));
		if (vm_any(asks))
			look_ahead_segments(cast, rays, asks, &k, &until, &known);
		const vm takes = vm_and(alive, vf_less(k, end));
		if (!vm_any(takes))
			break;
		const vm lacks = vm_but(takes, known);
		if (vm_any(lacks)) {
			const vf value = fetch_sample(m, k, lacks);
			front = vi_select(lacks, entry_of(&look_up, value), front);
			samples += vm_count(lacks);
		}
		k = vf_select(takes, k + vf_set(1), k);
		const vf value = fetch_sample(m, k, takes);
		const vi back = entry_of(&look_up, value);
		samples += vm_count(takes);
		vf opacity;
		vi colour;
		look_up_segments(m, front, back, takes, &opacity, &colour);
		composite_at(m, k - vf_set(0.5F), colour, opacity, takes, light);
		front = back;
		known = takes;
		alive = vm_and(alive, vf_less(vf_set(cast->end_transmittance), light->through));
	}
	return samples;
}

/* A partial segment from `front` on, `steps` long. */
SIMD uint32_t march_segment_part(const struct march *m, vf front, vf steps, struct light *light)
{
	const struct gz_cast *cast = m->cast;
	const struct rays *rays = m->rays;
	const struct reading reading = m->reading;
	vm mask = vm_and(rays->hit, vf_less(vf_set(GZ_LAST_SEGMENT_LEAST), steps));
	mask = vm_and(mask, vf_less(vf_set(cast->end_transmittance), light->through));
	if (!vm_any(mask))
		return 0;
	vf leave;
	const vf back = front + steps;
	const vm empty = look_up_cell(cast, rays, front, mask, &leave);
	mask = vm_but(mask, vm_but(empty, vf_less(leave, back)));
	if (!vm_any(mask))
		return 0;
	const struct look_up look_up = stored_look_up(cast);
	const vi ends[2] = {
		entry_of(&look_up,
			 sample_at(cast, reading.type, reading.nearest, rays, front, mask)),
		entry_of(&look_up,
			 sample_at(cast, reading.type, reading.nearest, rays, back, mask)),
	};
	vf extinction;
	vi colour;
	gather_pair(cast->preintegrated_extinction, preintegrated_pair(cast, ends[0], ends[1]),
		    mask, &extinction, &colour);
	if (__builtin_expect(cast->fine_entries, 0))
		take_close_entries(cast->extinction, ends[0], ends[1], mask, &extinction, &colour);
	const vf length = steps * vf_set(cast->voxel_lengths[m->step]);
	const vf opacity = vf_set(1) - exp2_negative(extinction * length);
	const vm visible = vm_and(segments_have_visible(cast, ends[0], ends[1], mask),
				  vf_less(extinction, vf_set(0)));
	composite_at(m, vf_fma(steps, vf_set(0.5F), front), colour, opacity, visible, light);
	return 2 * vm_count(mask);
}

/* Where the partial segment before the first whole one begins. */
SIMD vf segment_head(const struct rays *rays)
{
	return vf_fma(rays->head, vf_set(-0.5F), rays->head_at);
}

#endif
