/*
 * The kernel: one tile of rays, front to back, SIMD_LANES at a time.
 *
 * The kernel is written once and compiled once for each instruction set. The file of a set
 * (cast_portable.c, cast_avx2.c, cast_avx512.c) includes the set's vocabulary (simd_avx2.h, ...),
 * which defines vectors of floats (vf), of integers (vi) and masks (vm) with their operations, then
 * this file, and is compiled with the set's flags. gz_cast_kernels_find() chooses at run time. Rays
 * march side by side (cast_beam.h, for segments cast_segments.h); sets with wide permutations
 * (SIMD_BLOCKS) fetch voxels by blocks (cast_together.h). Within a set, DEFINE_TILE makes one
 * kernel for each voxel type, interpolation and variant; these are constants of the kernel, so that
 * the compiler drops what it does not need.
 *
 * A ray is cut into segments of one step, from where it enters the box, or a jitter before. A
 * sample lies in the middle of each, at k + 1/2 steps. Where the box or the clip region cuts a
 * segment at an end of the ray, the sample lies in the middle of what is left, and its opacity is
 * corrected for that length. k is a count, so skipping empty space never shifts the samples.
 */
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_preintegrated.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/cpu/cast_segments.h"
#include "render/raycast/cpu/cast_shade.h"
#include "render/raycast/cpu/cast_together.h"

/* For lanes that ask: find how far their samples show something, or advance past empty space. */
SIMD void look_ahead(const struct gz_cast *cast, const struct rays *rays, vm asks, vf *k, vf *until)
{
	vf leave;
	const vm empty = vm_and(look_up_cell(cast, rays, *k, asks, &leave), asks);
	/* Take a sample too that rounding puts just past the end of its own cell. */
	*until = vf_select(vm_but(asks, empty), vf_max(leave, *k + vf_set(0.5F)), *until);
	/* To the first sample at or past the far side of the empty space; at least one on. */
	const vf ahead = vf_max(vf_ceil(leave - *k), vf_set(1));
	*k = vf_select(empty, *k + ahead, *k);
}

/* Advance past cells known to be empty around samples that show nothing. */
SIMD vf skip_empty(const struct gz_cast *cast, const struct rays *rays, vf k, vm running)
{
	vf leave;
	const vm empty = look_up_cell(cast, rays, k, running, &leave);
	const vf ahead = vf_select(empty, vf_max(vf_ceil(leave - k), vf_set(1)), vf_set(1));
	return vf_select(running, k + ahead, k);
}

/* All whole segments, each ray for itself. Which sample comes next depends only on the cells, not
 * on what samples show, so one need not be finished before the next begins. */
SIMD uint32_t march_apart(const struct march *m, const struct look_up *look_up, vm alive,
			  struct light *light)
{
	const struct gz_cast *cast = m->cast;
	const struct rays *rays = m->rays;
	vf k = rays->first + vf_set(0.5F);
	const vf end = rays->end; /* k + 1/2 <= end */
	vf until = vf_set(-1);    /* samples before this k are taken */
	uint32_t samples = 0;
	for (;;) {
		const vm asks = vm_but(vm_and(alive, vf_less(k, end)), vf_less(k, until));
		if (vm_any(asks))
			look_ahead(cast, rays, asks, &k, &until);
		const vm running = vf_less(k, end);
		const vm takes = vm_and(running, vf_less(k, until));
		const vm needed = vm_and(takes, alive);
		if (!vm_any(needed)) {
			if (!vm_any(vm_and(running, alive)))
				break;
			continue;
		}
		samples += vm_count(needed);
		const vf value = fetch_sample(m, k, needed);
		const vi entry = entry_of(look_up, value);
		const vf at = k;
		k = vf_select(takes, k + vf_set(1), k);
		vf opacity;
		vi colour;
		gather_pair(cast->step_table[m->step], entry, vm_all(), &opacity, &colour);
		composite_at(m, at, colour, opacity, needed, light);
		alive = vm_and(alive, vf_less(vf_set(cast->end_transmittance), light->through));
	}
	return samples;
}

/* All whole segments, each ray for itself, but only the samples that the fine cells say may show
 * something. */
SIMD uint32_t march_fine(const struct march *m, const struct look_up *look_up, vm alive,
			 struct light *light)
{
	const struct rays *rays = m->rays;
	vf k = rays->first + vf_set(0.5F);
	struct waiting before = none_waiting();
	uint32_t samples = 0;
	for (;;) {
		const vm running = vf_less(k, rays->end);
		if (!vm_any(vm_and(running, alive)))
			break;
		vf at[3];
		for (int axis = 0; axis < 3; axis++)
			at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
		const vm shows = vm_and(fine_shows(m->cast, at, running), alive);
		if (!vm_any(shows)) {
			k = skip_empty(m->cast, rays, k, running);
			continue;
		}
		const vf value = fetch_sample(m, k, shows);
		samples += settle_waiting(m, &before, &alive, light);
		before = (struct waiting) { k, entry_of(look_up, value), shows };
		k = vf_select(running, k + vf_set(1), k);
	}
	return samples + settle_waiting(m, &before, &alive, light);
}

/* All whole segments of one register. */
SIMD uint32_t march_whole(const struct march *m, const struct look_up *look_up, struct light *light)
{
	const vm alive = rays_alive(m, m->rays, light);
	if (!vm_any(alive))
		return 0;
	return march_apart(m, look_up, alive, light);
}

/* All whole segments of a tile: its rays side by side if one block serves them, otherwise those of
 * each register. */
SIMD uint32_t march_beams(const struct march *m, const struct look_up *look_up,
			  struct light light[TILE_PARTS])
{
	uint32_t samples = 0;
	const struct beam tile = beam_of(m->rays, TILE_PARTS, 0.5F);
	const int whole = TILE_PARTS == 1 || company_of(m->cast, m->reading, &tile) == SIDE_BY_SIDE;
	for (int part = 0; part < TILE_PARTS; part += whole ? TILE_PARTS : 1) {
		const struct march some = march_of_part(m, part);
		const struct beam beam = whole ? tile : beam_of(some.rays, 1, 0.5F);
		const vm alive = rays_alive(&some, some.rays, &light[part]);
		if (beam.grid < GZ_FINE_GRIDS)
			samples += march_beam(&some, look_up, &beam, &light[part]);
		else
			samples += march_fine(&some, look_up, alive, &light[part]);
	}
	return samples;
}

/* All whole segments of a tile. */
SIMD uint32_t march_tile(const struct march *m, struct light light[TILE_PARTS])
{
	const struct look_up look_up = look_up_of(m->cast, m->reading);
	uint32_t samples = 0;
	if (m->cast->fine[0].flags)
		return march_beams(m, &look_up, light);
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		samples += march_whole(&one, &look_up, &light[part]);
	}
	return samples;
}

/* A partial segment at an end of a ray: `steps` long, with its middle at k. */
SIMD uint32_t march_part(const struct march *m, vf k, vf steps, struct light *light)
{
	const struct gz_cast *cast = m->cast;
	const struct rays *rays = m->rays;
	vm mask = vm_and(rays->hit, vf_less(vf_set(GZ_LAST_SEGMENT_LEAST), steps));
	mask = vm_and(mask, vf_less(vf_set(cast->end_transmittance), light->through));
	if (!vm_any(mask))
		return 0;
	vf leave;
	mask = vm_but(mask, look_up_cell(cast, rays, k, mask, &leave));
	if (!vm_any(mask))
		return 0;
	const struct look_up look_up = stored_look_up(cast);
	const vi entry = entry_of(
		&look_up, sample_at(cast, m->reading.type, m->reading.nearest, rays, k, mask));
	vf extinction;
	vi colour;
	gather_pair(cast->extinction, entry, mask, &extinction, &colour);
	const vf length = steps * vf_set(cast->voxel_lengths[m->step]);
	const vf opacity = vf_set(1) - exp2_negative(extinction * length);
	const vm visible = vm_and(mask, vf_less(extinction, vf_set(0)));
	composite_at(m, k, colour, opacity, visible, light);
	return vm_count(mask);
}

/* The rays of a tile by samples. */
SIMD uint32_t cast_by_samples(const struct march *m, struct light light[TILE_PARTS])
{
	uint32_t samples = 0;
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		samples += march_part(&one, one.rays->head_at, one.rays->head, &light[part]);
	}
	samples += march_tile(m, light);
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		const struct rays *rays = one.rays;
		const vf middle = vf_fma(rays->rest, vf_set(0.5F), rays->end);
		samples += march_part(&one, middle, rays->rest, &light[part]);
	}
	return samples;
}

/* The rays of a tile by segments. */
SIMD uint32_t cast_tile_by_segments(const struct march *m, struct light light[TILE_PARTS])
{
	uint32_t samples = 0;
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		samples += march_segment_part(&one, segment_head(one.rays), one.rays->head,
					      &light[part]);
	}
	samples += march_tile_segments(m, light);
	for (int part = 0; part < TILE_PARTS; part++) {
		const struct march one = march_of_part(m, part);
		samples += march_segment_part(&one, one.rays->end, one.rays->rest, &light[part]);
	}
	return samples;
}

/* The pixels of rays that have gathered all light of the volume. */
SIMD vi end_rays(const struct gz_cast *cast, const struct gz_cast_tile *tile, int first,
		 const struct rays *rays, int rich, struct light *light)
{
	const int deep = rich && cast->depth_scale > 0;
	if (__builtin_expect(tile->hit_depth != NULL, 0)) {
		if (deep)
			gather_hit_depths(cast, tile, first, rays, light);
		composite_hits(tile, first, light);
	}
	const vi pixels = to_pixel(cast, tile, first, light);
	return deep ? with_depth(cast, tile->step, rays, light, pixels) : pixels;
}

SIMD uint32_t cast_tile_rays(const struct gz_cast *cast, const struct gz_cast_tile *tile,
			     uint32_t out_pixels[GZ_TILE_RAYS], struct reading reading,
			     enum gz_cast_variant variant)
{
	const int rich = variant != GZ_CAST_PLAIN, coloured = variant == GZ_CAST_COLOURED;
	uint32_t samples = 0;
	struct rays rays[TILE_PARTS];
	struct view view[TILE_PARTS];
	struct light light[TILE_PARTS];
	struct near_voxels near;
	struct unlit unlit;
	const struct march march = { cast, reading, tile->step, rich,  coloured,
				     0,    rays,    &near,      &unlit };
	int hit = 0;
	for (int part = 0; part < TILE_PARTS; part++) {
		set_up_rays(cast, tile, part * SIMD_LANES, &rays[part]);
		light[part] =
			(struct light) { vf_set(0), vf_set(0), vf_set(0), vf_set(1), vf_set(0) };
		hit |= vm_any(rays[part].hit);
		if (rich && cast->light.on && vm_any(rays[part].hit)) {
			set_up_view(cast, tile->step, &rays[part], &view[part]);
			rays[part].view = &view[part];
		}
	}
	unlit.rays = rays;
	unlit.light = light;
	unlit.count = 0;
	if (rich)
		near_nothing(rays, &near);
	if (hit)
		samples = rich && cast->preintegrated_extinction
				  ? cast_tile_by_segments(&march, light)
				  : cast_by_samples(&march, light);
	settle_unlit(&march);
	for (int part = 0; part < TILE_PARTS; part++) {
		const int first = part * SIMD_LANES;
		vi_store(out_pixels + first,
			 end_rays(cast, tile, first, &rays[part], rich, &light[part]));
	}
	return samples;
}

#define DEFINE_TILE(name, type, nearest, variant)                                                 \
	static uint32_t name(const struct gz_cast *cast, const struct gz_cast_tile *tile,         \
			     uint32_t out_pixels[GZ_TILE_RAYS])                                   \
	{                                                                                         \
		return cast_tile_rays(cast, tile, out_pixels, (struct reading) { type, nearest }, \
				      variant);                                                   \
	}

DEFINE_TILE(tile_u8, GZ_VOXEL_U8, 0, GZ_CAST_PLAIN)
DEFINE_TILE(tile_u16, GZ_VOXEL_U16, 0, GZ_CAST_PLAIN)
DEFINE_TILE(tile_f32, GZ_VOXEL_F32, 0, GZ_CAST_PLAIN)
DEFINE_TILE(tile_u8_nearest, GZ_VOXEL_U8, 1, GZ_CAST_PLAIN)
DEFINE_TILE(tile_u16_nearest, GZ_VOXEL_U16, 1, GZ_CAST_PLAIN)
DEFINE_TILE(tile_f32_nearest, GZ_VOXEL_F32, 1, GZ_CAST_PLAIN)
DEFINE_TILE(rich_u8, GZ_VOXEL_U8, 0, GZ_CAST_RICH)
DEFINE_TILE(rich_u16, GZ_VOXEL_U16, 0, GZ_CAST_RICH)
DEFINE_TILE(rich_f32, GZ_VOXEL_F32, 0, GZ_CAST_RICH)
DEFINE_TILE(rich_u8_nearest, GZ_VOXEL_U8, 1, GZ_CAST_RICH)
DEFINE_TILE(rich_u16_nearest, GZ_VOXEL_U16, 1, GZ_CAST_RICH)
DEFINE_TILE(rich_f32_nearest, GZ_VOXEL_F32, 1, GZ_CAST_RICH)
DEFINE_TILE(coloured_u8, GZ_VOXEL_U8, 0, GZ_CAST_COLOURED)
DEFINE_TILE(coloured_u8_nearest, GZ_VOXEL_U8, 1, GZ_CAST_COLOURED)

/* gz_cast_arriving_function */
static void arriving_shares(const struct gz_cast *cast, enum gz_voxel_type type, bool nearest,
			    const struct gz_cast_places *places, float out_shares[GZ_TILE_RAYS])
{
	for (int first = 0; first < GZ_TILE_RAYS; first += SIMD_LANES) {
		const vm mask = vm_from_bits(places->active >> first);
		const vf at[3] = { vf_load(places->at[0] + first), vf_load(places->at[1] + first),
				   vf_load(places->at[2] + first) };
		vf_store(out_shares + first, walk_to_light(cast, (struct reading) { type, nearest },
							   places->longer, at, mask));
	}
}

#define GZ_CAST_KERNELS(set)                                                       \
	{                                                                          \
		.name = set,                                                     \
		.arriving = arriving_shares,                                     \
		.tile = {                                                        \
			[GZ_CAST_PLAIN] = {                                      \
				[GZ_VOXEL_U8] = { tile_u8, tile_u8_nearest },    \
				[GZ_VOXEL_U16] = { tile_u16, tile_u16_nearest }, \
				[GZ_VOXEL_F32] = { tile_f32, tile_f32_nearest }, \
			},                                                       \
			[GZ_CAST_RICH] = {                                       \
				[GZ_VOXEL_U8] = { rich_u8, rich_u8_nearest },    \
				[GZ_VOXEL_U16] = { rich_u16, rich_u16_nearest }, \
				[GZ_VOXEL_F32] = { rich_f32, rich_f32_nearest }, \
			},                                                       \
			[GZ_CAST_COLOURED] = {                                   \
				[GZ_VOXEL_U8] = { coloured_u8, coloured_u8_nearest }, \
			},                                                       \
		}, \
	}
