/*
 * Marching side by side: all rays of a tile at the same distance from the eye, so that a block of
 * voxels serves them all and cells are asked for the tile as a whole. Where one ray's cell shows
 * something, all take their samples: in an empty cell they have no opacity.
 * A part of the kernel, for sets with blocks: see cast_kernel.h.
 */
#ifndef GZ_RENDER_CPU_CAST_TOGETHER_H
#define GZ_RENDER_CPU_CAST_TOGETHER_H

#include "render/cpu/cast_block.h"
#include "render/cpu/cast_light.h"
#include "render/cpu/cast_look_up.h"
#include "render/cpu/cast_shade.h"
#include "render/cpu/cast_skip.h"

/* Samples that no block serves, in excess of those one does, after which a tile's rays are taken to
 * be too far apart: gathers serve the rest. Chosen: a tile that crosses the box's edge recovers. */
enum { TOGETHER_PATIENCE = 4 };

/* The first sample of the ray that has its own first, and those of the others that are level with
 * it, which may lie before they come to the box. */
SIMD vf level_start(const struct rays *rays)
{
	const float nearest = _mm512_mask_reduce_min_ps(rays->hit, rays->zero + rays->first);
	return vf_set(0.5F) + _mm512_roundscale_ps(vf_set(nearest) - rays->zero,
						   _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}

/* Ask for the cells of all rays still going. If all are empty, the number of samples to leave out;
 * else, negative, of those to take. */
SIMD float ask_together(const struct gz_cast *cast, const struct rays *rays, vf k, vm going)
{
	vf leave;
	const vm full = vm_but(going, look_up_cell(cast, rays, k, going, &leave));
	const vf ahead = vf_max(vf_ceil(vf_min(leave, rays->end) - k), vf_set(1));
	return vm_any(full) ? -_mm512_mask_reduce_max_ps(full, ahead)
			    : _mm512_mask_reduce_min_ps(going, ahead);
}

/* Rays on their way. Of one sample to the next, the block of voxels is fetched while the one before
 * it is interpolated, whose colour is looked up while the next is: a processor that runs ahead of a
 * dozen loads, but not of two samples, has something to do meanwhile. */
struct company {
	vf k;
	struct block_place place; /* of the sample at k */
	struct block block;       /* there */
	int misses;
	/* the sample before: not added yet */
	vf at;
	vi entry;
	vm within;
};

/* The value at k, by the block if it holds all rays; the block of the next sample. */
SIMD vf fetch_together(const struct gz_cast *cast, enum gz_voxel_type type, const struct rays *rays,
		       vm needed, struct company *company)
{
	vf at[3], places[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(company->k, rays->delta[axis], rays->datum[axis]);
	if (__builtin_expect(company->misses >= TOGETHER_PATIENCE, 0))
		return fetch_sample(cast, type, 0, rays, company->k, needed);
	struct block block = company->block;
	if (__builtin_expect(!block_places(cast, &block, at, needed, places), 0)) {
		company->place = block_find(rays, at, needed);
		block_take(cast, type, &company->place, &block);
		const int fits = block_places(cast, &block, at, needed, places);
		company->misses += fits ? -(company->misses > 0) : 1;
		if (!fits) {
			block_advance(&company->place, 1);
			block_take(cast, type, &company->place, &company->block);
			return fetch_sample(cast, type, 0, rays, company->k, needed);
		}
	}
	block_advance(&company->place, 1);
	block_take(cast, type, &company->place, &company->block);
	return block_sample(&block, type, places);
}

/* Add the sample that has been waiting. */
SIMD uint32_t settle(const struct gz_cast *cast, enum gz_voxel_type type, int step,
		     const struct rays *rays, const struct company *company, vm *alive,
		     struct light *light)
{
	vf opacity;
	vi colour;
	const vm needed = vm_and(company->within, *alive);
	gather_pair(cast->step_table[step], company->entry, vm_all(), &opacity, &colour);
	composite_at(cast, type, 0, rays, company->at, colour, opacity, needed, light);
	*alive = vm_and(*alive, vf_less(vf_set(GZ_TRANSMITTANCE_END), light->through));
	return vm_count(needed);
}

/* Leave out what is empty and say how many samples to take then; 0 at the end. */
SIMD float go_ahead(const struct gz_cast *cast, enum gz_voxel_type type, const struct rays *rays,
		    vm alive, struct company *company)
{
	float ahead, skipped = 0;
	for (;;) {
		const vm going = vm_and(alive, vf_less(company->k, rays->end));
		if (!vm_any(going))
			return 0;
		ahead = ask_together(cast, rays, company->k, going);
		if (ahead < 0)
			break;
		company->k = company->k + vf_set(ahead);
		skipped += ahead;
	}
	if (skipped > 0 && company->misses < TOGETHER_PATIENCE) {
		block_advance(&company->place, skipped);
		block_take(cast, type, &company->place, &company->block);
	}
	return -ahead;
}

/* All whole segments. */
SIMD uint32_t march_together(const struct gz_cast *cast, enum gz_voxel_type type,
			     const struct look_up *look_up, int step, const struct rays *rays,
			     vm alive, struct light *light)
{
	struct company company = { .k = level_start(rays), .at = vf_set(0), .entry = vi_set(0) };
	block_take(cast, type, &company.place, &company.block);
	uint32_t samples = 0;
	float run = 0; /* samples to take before the cells are asked */
	while (vm_any(alive)) {
		if (run <= 0) {
			run = go_ahead(cast, type, rays, alive, &company);
			if (run <= 0)
				break;
		}
		run -= 1;
		const vm within =
			vm_and(vf_less(rays->first, company.k), vf_less(company.k, rays->end));
		const vf value = fetch_together(cast, type, rays, vm_and(within, alive), &company);
		samples += settle(cast, type, step, rays, &company, &alive, light);
		company.entry = entry_of(look_up->scale, look_up->bias, value);
		company.within = within;
		company.at = company.k;
		company.k = company.k + vf_set(1);
	}
	return samples + settle(cast, type, step, rays, &company, &alive, light);
}

#endif
