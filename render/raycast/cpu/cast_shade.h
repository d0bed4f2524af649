/*
 * Colour: light on a sample, gathering front to back, and the pixel that it becomes. A part of the
 * kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_SHADE_H
#define GZ_RENDER_RAYCAST_CPU_CAST_SHADE_H

#include <math.h>

#include "render/data/voxel_colour.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_near.h"
#include "render/raycast/cpu/cast_rays.h"
#include "render/raycast/cpu/simd_light.h"
#include "render/raycast/cpu/simd_surroundings.h"
#include "render/raycast/shared/cast_constants.h"

/* Colour gathered so far, front to back, and the share of light that still comes through. The depth
 * is k, weighted as the colour is. */
struct light {
	vf red, green, blue, through, depth;
};

/* A sample's colour: red and green up to 2047, blue up to 1023. */
struct colour {
	vf red, green, blue;
};

SIMD struct colour unpack_colour(vi packed)
{
	return (struct colour) {
		vf_from_i(vi_shift_right(packed, 21)),
		vf_from_i(vi_and(vi_shift_right(packed, 10), vi_set(2047))),
		vf_from_i(vi_and(packed, vi_set(1023))),
	};
}

/* Take a share of the light that still comes through. */
SIMD vf take_light(vf opacity, vm visible, struct light *light)
{
	const vf weight = light->through * vf_keep(visible, opacity);
	light->through = light->through - weight;
	return weight;
}

SIMD void add_colour_share(struct colour colour, vf weight, struct light *light)
{
	light->red = vf_fma(weight, colour.red, light->red);
	light->green = vf_fma(weight, colour.green, light->green);
	light->blue = vf_fma(weight, colour.blue, light->blue);
}

SIMD void composite_colour(struct colour colour, vf opacity, vm visible, struct light *light)
{
	add_colour_share(colour, take_light(opacity, visible, light), light);
}

/* Add what the rays of a register meet: it is opaque, so nothing comes through. */
SIMD void composite_hits(const struct gz_cast_tile *tile, int first, struct light *light)
{
	const vm met = vf_less(vf_load(tile->hit_depth + first), vf_set(INFINITY));
	const vi pixels = vi_load(tile->hit_pixels + first);
	const vi byte = vi_set(0xFF);
	const struct colour colour = {
		vf_from_i(vi_and(pixels, byte)) * vf_set(2047.0F / 255),
		vf_from_i(vi_and(vi_shift_right(pixels, 8), byte)) * vf_set(2047.0F / 255),
		vf_from_i(vi_and(vi_shift_right(pixels, 16), byte)) * vf_set(1023.0F / 255),
	};
	composite_colour(colour, vf_set(1), met, light);
}

/* Add the depth of what composite_hits() adds: before it. */
SIMD void gather_hit_depths(const struct gz_cast *cast, const struct gz_cast_tile *tile, int first,
			    const struct rays *rays, struct light *light)
{
	const vf depth = vf_load(tile->hit_depth + first);
	const vm met = vf_less(depth, vf_set(INFINITY));
	const vf k = vf_keep(met, depth * vf_set(1 / cast->step[tile->step]) - rays->zero);
	light->depth = vf_fma(light->through, k, light->depth);
}

/* Put the mean depth of what the rays show into the fourth byte of their pixels. */
SIMD vi with_depth(const struct gz_cast *cast, int step, const struct rays *rays,
		   const struct light *light, vi pixels)
{
	const vf shown = vf_set(1) - light->through;
	const vm any = vf_less(vf_set(1.0F / 255), shown);
	const vf k = light->depth / vf_select(any, shown, vf_set(1));
	const vf share = vf_fma((k + rays->zero) * vf_set(cast->step[step]),
				vf_set(cast->depth_scale), vf_set(cast->depth_bias));
	const vi byte = to_byte(vf_select(any, share, vf_set(0.5F)));
	return vi_or(vi_and(pixels, vi_set(0x00FFFFFF)), vi_shift_left(byte, 24));
}

/* The world place of voxel coordinates along an axis. */
SIMD vf world_place(const struct gz_cast *cast, int axis, vf at)
{
	return (at - vf_set(0.5F * cast->box[axis])) * vf_set(cast->world_per_voxel[axis]);
}

/* What the rays of a register see behind the volume. Not inlined, for the reasons of shade(). */
static __attribute__((noinline)) struct rgb see_behind(const struct gz_cast *cast,
						       const struct gz_cast_tile *tile, int first)
{
	const vf x = vf_load(tile->x + first), y = vf_load(tile->y + first);
	vf origin[3], direction[3], length2 = vf_set(0);
	for (int axis = 0; axis < 3; axis++) {
		origin[axis] = vf_fma(
			y, vf_set(cast->origin_dy[axis]),
			vf_fma(x, vf_set(cast->origin_dx[axis]), vf_set(cast->origin00[axis])));
		origin[axis] = world_place(cast, axis, origin[axis]);
		direction[axis] = vf_fma(y, vf_set(cast->direction_dy[axis]),
					 vf_fma(x, vf_set(cast->direction_dx[axis]),
						vf_set(cast->direction00[axis])));
		direction[axis] = direction[axis] * vf_set(cast->world_per_voxel[axis]);
		length2 = vf_fma(direction[axis], direction[axis], length2);
	}
	const vf inverse = vf_set(1) / vf_sqrt(length2);
	for (int axis = 0; axis < 3; axis++)
		direction[axis] = direction[axis] * inverse;
	return see_surroundings(&cast->around, origin, direction);
}

/* The pixels of rays number `first` and after of a tile. */
SIMD vi to_pixel(const struct gz_cast *cast, const struct gz_cast_tile *tile, int first,
		 const struct light *light)
{
	const vf t = light->through;
	struct rgb behind;
	if (__builtin_expect(cast->around.kind != GZ_SURROUNDINGS_NONE, 0))
		behind = see_behind(cast, tile, first);
	else
		for (int i = 0; i < 3; i++)
			behind.channel[i] = vf_set(cast->around.horizon[i]);
	const vi red = to_byte(vf_fma(t, behind.channel[0], light->red * vf_set(1.0F / 2047)));
	const vi green = to_byte(vf_fma(t, behind.channel[1], light->green * vf_set(1.0F / 2047)));
	const vi blue = to_byte(vf_fma(t, behind.channel[2], light->blue * vf_set(1.0F / 1023)));
	const vi opaque = vi_set((int32_t)0xFF000000);
	return vi_or(vi_or(red, vi_shift_left(green, 8)), vi_or(vi_shift_left(blue, 16), opaque));
}

/* Find what all lit samples of the rays share. */
SIMD void set_up_view(const struct gz_cast *cast, int step, const struct rays *rays,
		      struct view *view)
{
	vf length2 = vf_set(1e-12F); /* not 0 where eye and light are opposite */
	for (int axis = 0; axis < 3; axis++) {
		const float world_per_step = cast->world_per_voxel[axis] / cast->step[step];
		view->eye[axis] = rays->delta[axis] * vf_set(-world_per_step);
		view->half[axis] = view->eye[axis] + vf_set(cast->light.towards[axis]);
		length2 = vf_fma(view->half[axis], view->half[axis], length2);
	}
	const vf inverse = vf_set(1) / vf_sqrt(length2);
	for (int axis = 0; axis < 3; axis++)
		view->half[axis] = view->half[axis] * inverse;
}

/* The gradient's differences at places counted from the first datum, from two samples along each
 * axis. */
SIMD void difference_samples(const struct gz_cast *cast, enum gz_voxel_type type, int nearest,
			     const vf at[3], vm mask, vf difference[3])
{
	for (int axis = 0; axis < 3; axis++) {
		vf side[2];
		for (int i = 0; i < 2; i++) {
			vf there[3] = { at[0], at[1], at[2] };
			there[axis] = there[axis] + vf_set(i ? 1.0F : -1.0F);
			side[i] = nearest ? sample_nearest(cast, type, there, mask)
					  : sample_trilinear(cast, type, there, mask);
		}
		difference[axis] = side[1] - side[0];
	}
}

/* Four voxels of a row, the first one before the index. */
SIMD void load_four(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask,
		    vf row[4])
{
	const vi first = vi_add(index, vi_set(-1));
	if (type == GZ_VOXEL_U8) {
		const vi four = vi_gather(cast->voxels, first, 1, mask);
		row[0] = vf_from_i(vi_and(four, vi_set(0xFF)));
		row[1] = vf_from_i(vi_and(vi_shift_right(four, 8), vi_set(0xFF)));
		row[2] = vf_from_i(vi_and(vi_shift_right(four, 16), vi_set(0xFF)));
		row[3] = vf_from_i(vi_shift_right(four, 24));
	} else {
		load_pair(cast, type, first, mask, &row[0], &row[1]);
		load_pair(cast, type, vi_add(index, vi_set(1)), mask, &row[2], &row[3]);
	}
}

/* The trilinear differences where all voxels that they need lie within the data: samples a voxel
 * apart share most of their voxels. */
SIMD void difference_voxels(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			    vm mask, vf difference[3])
{
	vf share[3], value[4], along[4];
	vi index[3];
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	const vi up_y = vi_set(cast->stride[1]), up_z = vi_set(cast->stride[2]);
	const vi down_y = vi_set(-cast->stride[1]), down_z = vi_set(-cast->stride[2]);
	const vi first = vi_add(index[0], vi_add(vi_mul(index[1], up_y), vi_mul(index[2], up_z)));
	const vi rows[4] = { first, vi_add(first, up_y), vi_add(first, up_z),
			     vi_add(vi_add(first, up_y), up_z) };
	for (int i = 0; i < 4; i++) { /* bit 0: y, bit 1: z */
		vf four[4];
		load_four(cast, type, rows[i], mask, four);
		value[i] = mix(four[1], four[2], share[0]);
		along[i] = mix(four[2], four[3], share[0]) - mix(four[0], four[1], share[0]);
	}
	vf across[2], before[2], behind[2];
	for (int i = 0; i < 2; i++) {
		const vf low = load_row(cast, type, vi_add(rows[2 * i], down_y), mask, share[0]);
		const vf high = load_row(cast, type, vi_add(rows[2 * i + 1], up_y), mask, share[0]);
		across[i] =
			mix(value[2 * i + 1], high, share[1]) - mix(low, value[2 * i], share[1]);
		before[i] = load_row(cast, type, vi_add(rows[i], down_z), mask, share[0]);
		behind[i] = load_row(cast, type, vi_add(rows[i + 2], up_z), mask, share[0]);
	}
	const vf lower = mix(value[0], value[1], share[1]);
	const vf upper = mix(value[2], value[3], share[1]);
	difference[0] =
		mix(mix(along[0], along[1], share[1]), mix(along[2], along[3], share[1]), share[2]);
	difference[1] = mix(across[0], across[1], share[2]);
	difference[2] = mix(upper, mix(behind[0], behind[1], share[1]), share[2]) -
			mix(mix(before[0], before[1], share[1]), lower, share[2]);
}

#ifdef SIMD_BLOCKS
/* Find the differences where the blocks nearby hold all places of the mask. Returns whether they
 * do. */
SIMD int difference_nearby(struct reading reading, const struct near_voxels *near, const vf at[3],
			   vm mask, vf difference[3])
{
	vf places[3];
	return !reading.nearest && reading.type != GZ_VOXEL_F32 &&
	       near_places(near, at, mask, places) &&
	       near_mix(near, reading.type, places, difference);
}
#else
SIMD int difference_nearby(struct reading reading, const struct near_voxels *near, const vf at[3],
			   vm mask, vf difference[3])
{
	(void)reading, (void)near, (void)at, (void)mask, (void)difference;
	return 0;
}

SIMD int by_words(const struct gz_cast *cast, struct reading reading)
{
	(void)cast, (void)reading;
	return 0;
}

SIMD void difference_by_words(const struct gz_cast *cast, enum gz_voxel_type type,
			      const struct places *here, const struct places *next,
			      struct near_voxels *near, vf difference[3])
{
	(void)cast, (void)type, (void)here, (void)next, (void)near, (void)difference;
}
#endif

/* The gradient's differences where words do not give them. */
SIMD void difference_floats(const struct gz_cast *cast, struct reading reading, const vf at[3],
			    vm mask, vf difference[3])
{
	vm outside = vm_but(mask, mask); /* closer than a voxel, and rounding, to the rim */
	for (int axis = 0; axis < 3; axis++)
		outside =
			vm_or(outside, vm_or(vf_less(at[axis], vf_set(1)),
					     vf_less(vf_set(cast->dims[axis] - 2.01F), at[axis])));
	/* The two ways round differently, so a ray's way must not depend on its neighbours. */
	const vm inside = vm_but(mask, outside);
	const int by_voxels = !reading.nearest && !cast->bricks.table && vm_any(inside);
	if (by_voxels)
		difference_voxels(cast, reading.type, at, inside, difference);
	if (!by_voxels || vm_any(vm_and(mask, outside))) {
		vf samples[3];
		difference_samples(cast, reading.type, reading.nearest, at, mask, samples);
		for (int axis = 0; axis < 3; axis++)
			difference[axis] =
				by_voxels ? vf_select(outside, samples[axis], difference[axis])
					  : samples[axis];
	}
}

/* The gradient at places, on the way that the rays go; `next` are those asked for after them. */
SIMD void find_gradient(const struct gz_cast *cast, struct reading reading,
			const struct places *here, const struct places *next,
			struct near_voxels *near, vf gradient[3])
{
	if (!difference_nearby(reading, near, here->at, here->mask, gradient)) {
		if (by_words(cast, reading))
			difference_by_words(cast, reading.type, here, next, near, gradient);
		else
			difference_floats(cast, reading, here->at, here->mask, gradient);
	}
	for (int axis = 0; axis < 3; axis++)
		gradient[axis] = gradient[axis] * vf_set(cast->light.gradient_scale[axis]);
}

/* What cells say at places counted from the first datum, trilinear in their grid. */
SIMD vf find_in_cells(const struct gz_cast_cells *grid, const vf at[3], vm mask)
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf place =
			vf_fma(at[axis], vf_set(grid->scale[axis]), vf_set(grid->bias[axis]));
		const vf inside = clamp_lanes(place, vf_set(0), vf_set(grid->greatest[axis]));
		index[axis] = vi_min(vi_trunc(inside), vi_set(grid->last[axis]));
		share[axis] = inside - vf_from_i(index[axis]);
	}
	const vi up_y = vi_set(grid->stride[1]), up_z = vi_set(grid->stride[2]);
	const vi first = vi_add(vi_add(index[0], vi_mul(index[1], up_y)), vi_mul(index[2], up_z));
	vf rows[4];
	for (int i = 0; i < 4; i++) {
		vi row = first;
		row = i & 1 ? vi_add(row, up_y) : row;
		row = i & 2 ? vi_add(row, up_z) : row;
		const vi pair = vi_gather(grid->cells, row, 2, mask);
		rows[i] = mix(vf_from_i(vi_and(pair, vi_set(0xFFFF))),
			      vf_from_i(vi_shift_right(pair, 16)), share[0]);
	}
	return mix(mix(rows[0], rows[1], share[1]), mix(rows[2], rows[3], share[1]), share[2]);
}

/* The occlusion at places counted from the first datum. */
SIMD vf find_occlusion(const struct gz_cast_light *light, const vf at[3], vm mask)
{
	const vf filled = find_in_cells(&light->occluded, at, mask);
	return clamp_lanes(vf_fma(filled, vf_set(2.0F / 65535), vf_set(-1)), vf_set(0), vf_set(1));
}

/* How many powers of two of light a voxel length keeps back at places counted from the first datum:
 * of the volume itself for steps planned that long, or of blocks of voxels. */
SIMD vf find_kept(const struct gz_cast *cast, struct reading reading, float planned, const vf at[3],
		  vm mask)
{
	const struct gz_cast_shadow *shadow = &cast->light.shadow;
	if (planned >= GZ_SHADOW_DIRECT) {
		int level = 0;
		while (level + 1 < shadow->levels &&
		       planned >= GZ_SHADOW_DIRECT * (float)(2 << level))
			level++;
		return find_in_cells(&shadow->level[level], at, mask) *
		       vf_set(shadow->kept_per_length[level]);
	}
	const struct look_up look_up = stored_look_up(cast);
	const vf value = reading.nearest ? sample_nearest(cast, reading.type, at, mask)
					 : sample_trilinear(cast, reading.type, at, mask);
	vf extinction;
	vi colour;
	gather_pair(cast->extinction, entry_of(&look_up, value), mask, &extinction, &colour);
	return vf_set(0) - extinction;
}

/* The share of light that arrives at places counted from the first datum, by steps towards it:
 * struct gz_light has the formulas. */
SIMD vf walk_to_light(const struct gz_cast *cast, struct reading reading, float longer,
		      const vf at[3], vm mask)
{
	const struct gz_cast_shadow *shadow = &cast->light.shadow;
	vf leave = vf_set(shadow->reach), kept = vf_set(0);
	for (int axis = 0; axis < 3; axis++)
		leave = vf_min(leave, (vf_set(shadow->exit[axis]) - at[axis]) *
					      vf_set(shadow->inverse[axis]));
	const vf exit[3] = { vf_set(shadow->exit_plane[0]), vf_set(shadow->exit_plane[1]),
			     vf_set(shadow->exit_plane[2]) };
	leave = vf_min(leave, vf_set(shadow->exit_plane[3]) - dot_lanes(exit, at));
	const float steps = (float)shadow->steps;
	const float unit = (shadow->reach - GZ_SHADOW_START) / (steps * steps);
	for (float i = 0, next; i < steps; i = next) {
		next = lesser(i + (i < GZ_SHADOW_FIRST ? 1 : longer), steps);
		const float from = GZ_SHADOW_START + unit * (i * i),
			    planned = unit * (next * next - i * i);
		const vf length = vf_min(leave - vf_set(from), vf_set(planned));
		const vm within = vm_and(vm_and(mask, vf_less(vf_set(0), length)),
					 vf_less(kept, vf_set(GZ_SHADOW_BLACK)));
		if (!vm_any(within))
			break;
		vf place[3];
		const vf middle = vf_fma(length, vf_set(0.5F), vf_set(from));
		for (int axis = 0; axis < 3; axis++)
			place[axis] = vf_fma(middle, vf_set(shadow->towards[axis]), at[axis]);
		const vf here = find_kept(cast, reading, planned, place, within);
		kept = vf_select(within, vf_fma(length, here, kept), kept);
	}
	return exp2_negative(vf_set(0) - kept);
}

/* The same from the grid. */
SIMD vf find_arriving(const struct gz_cast *cast, const vf at[3], vm mask)
{
	return find_in_cells(&cast->light.shadow.arriving, at, mask) *
	       vf_set(1.0F / GZ_LIGHT_GRID_UNIT);
}

/* How light changes a colour without regard to its surface: the factor, and what follows from the
 * surface, with its weight. */
struct lighting {
	vf even;
	struct shine shine;
	struct mirrored mirrored; /* if anything is */
	vf weight;
};

/* Light one channel of a colour, 0 to `full`. */
SIMD vf shade_channel(const struct gz_cast_light *light, vf colour, float full,
		      const struct lighting *lighting, int channel)
{
	const struct shine *shine = &lighting->shine;
	vf even = colour;
	if (light->shadow.steps)
		even = even * lighting->even;
	vf lit = vf_min(vf_fma(colour, shine->factor, shine->white * vf_set(full)), vf_set(full));
	if (light->reflection > 0)
		lit = lerp_lanes(lit, lighting->mirrored.seen.channel[channel] * vf_set(full),
				 lighting->mirrored.share);
	return vf_fma(lighting->weight, lit - even, even);
}

/* Surfaces at places counted from the first datum, of which this share sees the light. The gradient
 * becomes a unit vector. */
SIMD void light_surfaces(const struct gz_cast *cast, const struct view *view, const vf at[3],
			 vm mask, vf gradient[3], vf arriving, struct lighting *lighting)
{
	const vf length2 = dot_lanes(gradient, gradient);
	lighting->weight =
		length2 * vf_inverse(length2 + vf_set(GZ_LIGHT_GRADIENT * GZ_LIGHT_GRADIENT));
	const vf inverse = vf_inverse_root(vf_max(length2, vf_set(1e-30F)));
	for (int axis = 0; axis < 3; axis++)
		gradient[axis] = gradient[axis] * inverse;
	vf occlusion = vf_set(0);
	if (cast->light.occluded.cells)
		occlusion = find_occlusion(&cast->light, at, mask) * vf_set(cast->light.occlusion);
	lighting->shine = find_shine(&cast->light, view, gradient, occlusion);
	if (cast->light.shadow.steps) {
		const vf ambient = vf_set(cast->light.ambient) * (vf_set(1) - occlusion);
		struct shine *shine = &lighting->shine;
		shine->factor = vf_fma(arriving, shine->factor - ambient, ambient);
		shine->white = shine->white * arriving;
	}
	if (cast->light.reflection > 0) {
		vf place[3];
		for (int axis = 0; axis < 3; axis++)
			place[axis] = world_place(cast, axis, at[axis] + vf_set(0.5F));
		lighting->mirrored = find_mirrored(&cast->around, cast->light.reflection, place,
						   gradient, view->eye);
	}
}

/* Samples of a tile whose colours are still to be lit and added, in the order in which they were
 * taken. Several are lit at once, because each takes a long row of steps that wait for each other,
 * and so do not wait for those of the others. */
enum { LIT_AT_ONCE = 4 };

struct unlit_sample {
	vf k;
	vm mask;
	struct colour colour;
	vf weight; /* share of the light that it adds */
	int part;  /* the register of its rays */
};

struct unlit {
	const struct rays *rays; /* of the tile */
	struct light *light;
	int count;
	struct unlit_sample samples[LIT_AT_ONCE];
};

/* The register of a sample's rays: a constant where a tile has but one. */
SIMD int unlit_part(const struct unlit_sample *sample)
{
	return TILE_PARTS == 1 ? 0 : sample->part;
}

/* The places of a sample. */
SIMD struct places unlit_places(const struct unlit *unlit, const struct unlit_sample *sample)
{
	const struct rays *rays = &unlit->rays[unlit_part(sample)];
	struct places places = { .mask = sample->mask };
	for (int axis = 0; axis < 3; axis++)
		places.at[axis] = vf_fma(sample->k, rays->delta[axis], rays->datum[axis]);
	return places;
}

/* Light a sample of which the gradient is known. */
SIMD struct colour shade(const struct gz_cast *cast, const struct unlit *unlit,
			 const struct unlit_sample *sample, vf gradient[3])
{
	struct lighting lighting = { .even = vf_set(1),
				     .shine = { vf_set(0), vf_set(0) },
				     .mirrored = { { { vf_set(0), vf_set(0), vf_set(0) } },
						   vf_set(0) },
				     .weight = vf_set(0) };
	const struct colour *colour = &sample->colour;
	const struct places places = unlit_places(unlit, sample);
	const vf *at = places.at;
	vf arriving = vf_set(1);
	if (cast->light.shadow.steps) {
		const vf ambient = vf_set(cast->light.ambient);
		arriving = find_arriving(cast, at, sample->mask);
		lighting.even = vf_fma(arriving, vf_set(1) - ambient, ambient);
	}
	if (cast->light.gradient)
		light_surfaces(cast, unlit->rays[unlit_part(sample)].view, at, sample->mask,
			       gradient, arriving, &lighting);
	return (struct colour) {
		shade_channel(&cast->light, colour->red, 2047, &lighting, 0),
		shade_channel(&cast->light, colour->green, 2047, &lighting, 1),
		shade_channel(&cast->light, colour->blue, 1023, &lighting, 2),
	};
}

/* Light and add all samples that are still to be. Not inlined: only visible samples need it, which
 * are few, and one function for all voxel types is a twelfth of the code. */
static __attribute__((noinline)) void light_samples(const struct gz_cast *cast,
						    struct reading reading,
						    struct near_voxels *near, struct unlit *unlit)
{
	struct places here = unlit_places(unlit, &unlit->samples[0]);
	vf gradients[LIT_AT_ONCE][3];
	struct light light[TILE_PARTS];
	for (int part = 0; part < TILE_PARTS; part++)
		light[part] = unlit->light[part];
	for (int i = 0; cast->light.gradient && i < unlit->count; i++) {
		const int last = i + 1 == unlit->count;
		const struct places next = unlit_places(unlit, &unlit->samples[last ? i : i + 1]);
		find_gradient(cast, reading, &here, &next, near, gradients[i]);
		here = next;
	}
	for (int i = 0; i < unlit->count; i++) {
		const struct unlit_sample *sample = &unlit->samples[i];
		add_colour_share(shade(cast, unlit, sample, gradients[i]), sample->weight,
				 &light[unlit_part(sample)]);
	}
	for (int part = 0; part < TILE_PARTS; part++) {
		unlit->light[part].red = light[part].red;
		unlit->light[part].green = light[part].green;
		unlit->light[part].blue = light[part].blue;
	}
	unlit->count = 0;
}

/* Light and add what is still to be. */
SIMD void settle_unlit(const struct march *m)
{
	if (m->rich && m->unlit->count > 0)
		light_samples(m->cast, m->reading, m->near, m->unlit);
}

/* Add a voxel's colour to sums of colours by weight, and of weights. */
SIMD void add_colour(const struct gz_cast *cast, vi index, vf share, vm mask, vf sums[4])
{
	const vi word = vi_gather(cast->colours, index, 4, mask);
	const vf weight = share * (vf_from_i(vi_shift_right(word, 24)) +
				   vf_set(1.0F / GZ_COLOUR_WEIGHT_SHARE));
	sums[0] = vf_fma(weight, vf_from_i(vi_and(word, vi_set(0xFF))), sums[0]);
	sums[1] = vf_fma(weight, vf_from_i(vi_and(vi_shift_right(word, 8), vi_set(0xFF))), sums[1]);
	sums[2] =
		vf_fma(weight, vf_from_i(vi_and(vi_shift_right(word, 16), vi_set(0xFF))), sums[2]);
	sums[3] = sums[3] + weight;
}

/* The sums of the eight voxels around places counted from the first datum. */
SIMD void sum_colours(const struct gz_cast *cast, const vf at[3], vm mask, vf sums[4])
{
	vf shares[3][2];
	vi index[3];
	for (int axis = 0; axis < 3; axis++) {
		index[axis] = clamp_place(cast, axis, at[axis], &shares[axis][1]);
		shares[axis][0] = vf_set(1) - shares[axis][1];
	}
	const vi up_y = vi_set(cast->stride[1]), up_z = vi_set(cast->stride[2]);
	const vi first = vi_add(vi_add(index[0], vi_mul(index[1], up_y)), vi_mul(index[2], up_z));
	for (int corner = 0; corner < 8; corner++) {
		const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
		vi voxel = vi_add(first, vi_set(x));
		voxel = y ? vi_add(voxel, up_y) : voxel;
		voxel = z ? vi_add(voxel, up_z) : voxel;
		add_colour(cast, voxel, shares[0][x] * shares[1][y] * shares[2][z], mask, sums);
	}
}

/* The colour of the voxels at k, of the lanes of mask. Not inlined, for the reasons of shade(). */
static __attribute__((noinline)) struct colour own_colour(const struct gz_cast *cast, int nearest,
							  const struct rays *rays, vf k, vm mask)
{
	vf at[3], sums[4] = { vf_set(0), vf_set(0), vf_set(0), vf_set(0) };
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
	if (nearest)
		add_colour(cast, nearest_voxel(cast, at), vf_set(1), mask, sums);
	else
		sum_colours(cast, at, mask, sums);
	const vf inverse = vf_set(1.0F / 255) / sums[3];
	return (struct colour) {
		sums[0] * (inverse * vf_set(2047)),
		sums[1] * (inverse * vf_set(2047)),
		sums[2] * (inverse * vf_set(1023)),
	};
}

/* Add the colour of a sample at k of the lanes of mask, now or, if the scene has light, when it is
 * lit (settle_unlit). Voxels' own colours replace those of the transfer function. */
SIMD void composite_at(const struct march *m, vf k, vi packed, vf opacity, vm mask,
		       struct light *light)
{
	struct colour colour = unpack_colour(packed);
	if (m->rich && (m->rays->view || m->coloured)) {
		const vm visible = vm_and(mask, vf_less(vf_set(0), opacity));
		if (!vm_any(visible))
			return;
		if (m->coloured)
			colour = own_colour(m->cast, m->reading.nearest, m->rays, k, visible);
		if (m->rays->view) {
			const vf weight = take_light(opacity, visible, light);
			light->depth = vf_fma(weight, k, light->depth);
			m->unlit->samples[m->unlit->count++] =
				(struct unlit_sample) { k, visible, colour, weight, m->part };
			if (m->unlit->count == LIT_AT_ONCE)
				settle_unlit(m);
			return;
		}
	}
	const vf before = light->through;
	composite_colour(colour, opacity, mask, light);
	if (m->rich)
		light->depth = vf_fma(before - light->through, k, light->depth);
}

/* Which rays have whole segments to come. */
SIMD vm rays_alive(const struct march *m, const struct rays *rays, const struct light *light)
{
	return vm_and(rays->hit, vf_less(vf_set(m->cast->end_transmittance), light->through));
}

/* A sample whose colour has not been added yet: it is looked up while the next one is fetched, so
 * that neither waits for the other. */
struct waiting {
	vf at;
	vi entry;
	vm within; /* lanes that have one */
};

SIMD struct waiting none_waiting(void)
{
	return (struct waiting) { vf_set(0), vi_set(0), vf_less(vf_set(0), vf_set(0)) };
}

/* Add the waiting sample and find which lanes are still alive. Returns how many lanes it served. */
SIMD uint32_t settle_waiting(const struct march *m, const struct waiting *waiting, vm *alive,
			     struct light *light)
{
	vf opacity;
	vi colour;
	const vm needed = vm_and(waiting->within, *alive);
	load_pairs(m->cast->step_table[m->step], waiting->entry, &opacity, &colour);
	composite_at(m, waiting->at, colour, opacity, needed, light);
	*alive = vm_and(*alive, vf_less(vf_set(m->cast->end_transmittance), light->through));
	return vm_count(needed);
}

#endif
