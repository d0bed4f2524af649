/*
 * The kernel: one tile of rays, front to back, SIMD_LANES at a time. Included by one file an
 * instruction set, behind that set's vocabulary (simd_*.h). Voxel type and interpolation are
 * constants of each instance, so that the compiler drops what it does not need.
 *
 * A ray is cut into segments of one step from where it enters the box; a sample sits in the middle
 * of each, at entry + (k + 1/2) step; the last segment is what is left and its opacity is corrected
 * for its length. k is a count, so skipping empty space never shifts the phase.
 */
#include "render/cpu/cast.h"
#include "render/macrocells.h"

/* One chunk of lanes: its rays in voxel coordinates, position = start + k * delta. */
struct rays {
	vf start[3], delta[3], inverse[3];
	vf count; /* whole segments */
	vf rest;  /* of a segment, at the end; [0, 1) */
	vm hit;
};

/* What has been gathered so far. */
struct light {
	vf red, green, blue, through;
};

/* The transfer function's entry for a sample. */
SIMD vi entry_of(const struct gz_cast *cast, vf stored)
{
	const vf entry = vf_fma(stored, vf_set(cast->entry_scale), vf_set(cast->entry_bias));
	const vf last = vf_set(GZ_TRANSFER_TABLE_SIZE - 1);
	return vi_round(vf_min(vf_max(entry, vf_set(0)), last));
}

/* Two neighbours along x, as floats: one 32-bit load where both fit. */
SIMD void load_pair(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask, vf *low,
		    vf *high)
{
	if (type == GZ_VOXEL_U8) {
		const vi pair = vi_gather(cast->voxels, index, 1, mask);
		*low = vf_from_i(vi_and(pair, vi_set(0xFF)));
		*high = vf_from_i(vi_and(vi_shift_right(pair, 8), vi_set(0xFF)));
	} else if (type == GZ_VOXEL_U16) {
		const vi pair = vi_gather(cast->voxels, index, 2, mask);
		*low = vf_from_i(vi_and(pair, vi_set(0xFFFF)));
		*high = vf_from_i(vi_shift_right(pair, 16));
	} else {
		const float *voxels = cast->voxels;
		*low = vf_gather(voxels, index, mask);
		*high = vf_gather(voxels + 1, index, mask);
	}
}

SIMD vf mix(vf a, vf b, vf share)
{
	return vf_fma(share, b - a, a);
}

SIMD vf load_row(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask, vf share)
{
	vf low, high;
	load_pair(cast, type, index, mask, &low, &high);
	return mix(low, high, share);
}

SIMD vf sample_trilinear(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			 vm mask)
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf top = vf_set(cast->dims[axis] - 1);
		const vf place = vf_min(vf_max(at[axis] - vf_set(0.5F), vf_set(0)), top);
		index[axis] = vi_min(vi_trunc(place), vi_set(cast->last[axis]));
		share[axis] = place - vf_from_i(index[axis]);
	}
	const vi up_y = vi_set(cast->stride[1]), up_z = vi_set(cast->stride[2]);
	const vi i00 = vi_add(vi_add(index[0], vi_mul(index[1], up_y)), vi_mul(index[2], up_z));
	const vi i01 = vi_add(i00, up_z);
	const vf v00 = load_row(cast, type, i00, mask, share[0]);
	const vf v10 = load_row(cast, type, vi_add(i00, up_y), mask, share[0]);
	const vf v01 = load_row(cast, type, i01, mask, share[0]);
	const vf v11 = load_row(cast, type, vi_add(i01, up_y), mask, share[0]);
	return mix(mix(v00, v10, share[1]), mix(v01, v11, share[1]), share[2]);
}

SIMD vf sample_nearest(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3], vm mask)
{
	vi index = vi_set(0);
	for (int axis = 0; axis < 3; axis++) {
		const vf top = vf_set(cast->dims[axis] - 1);
		const vf place = vf_min(vf_max(vf_floor(at[axis]), vf_set(0)), top);
		index = vi_add(index, vi_mul(vi_trunc(place), vi_set(cast->stride[axis])));
	}
	vf low, high;
	load_pair(cast, type, index, mask, &low, &high);
	return low;
}

/* 2^x for x <= 0, to 2e-7: the fraction in [-1/2, 1/2] by a polynomial (Taylor of exp(f ln 2),
 * degree 6), the whole part into the exponent. */
SIMD vf exp2_negative(vf x)
{
	x = vf_max(x, vf_set(-126));
	const vf whole = vf_floor(x + vf_set(0.5F));
	const vf f = (x - whole) * vf_set(0.693147180559945F);
	vf p = vf_set(1.0F / 720);
	p = vf_fma(p, f, vf_set(1.0F / 120));
	p = vf_fma(p, f, vf_set(1.0F / 24));
	p = vf_fma(p, f, vf_set(1.0F / 6));
	p = vf_fma(p, f, vf_set(0.5F));
	p = vf_fma(p, f, vf_set(1));
	p = vf_fma(p, f, vf_set(1));
	/* whole + 127 is from 1 to 127: no sign to mind */
	return p * vf_bits(vi_shift_left(vi_trunc(whole + vf_set(127)), 23));
}

/* Add a sample's colour where it has opacity. */
SIMD void composite(vi colour, vf opacity, vm visible, struct light *light)
{
	const vf weight = light->through * vf_select(visible, opacity, vf_set(0));
	const vf red = vf_from_i(vi_shift_right(colour, 21));
	const vf green = vf_from_i(vi_and(vi_shift_right(colour, 10), vi_set(2047)));
	const vf blue = vf_from_i(vi_and(colour, vi_set(1023)));
	light->red = vf_fma(weight, red, light->red);
	light->green = vf_fma(weight, green, light->green);
	light->blue = vf_fma(weight, blue, light->blue);
	light->through = light->through - weight;
}

SIMD vf sample_at(const struct gz_cast *cast, enum gz_voxel_type type, int nearest,
		  const struct rays *rays, vf k, vm mask)
{
	vf at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, rays->delta[axis], rays->start[axis]);
	return nearest ? sample_nearest(cast, type, at, mask)
		       : sample_trilinear(cast, type, at, mask);
}

/* Distance field at k: *leap says how many samples may be skipped, *until up to which k (from
 * above) the cell at hand lasts. Lanes in a cell where something shows have a leap of 0. */
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
	const vi distance = vi_and(vi_gather(cast->distance, index, 1, mask), vi_set(0xFF));
	/* A distance of d says that d - 1 cells to each side are empty too. An occupied cell has
	 * itself. */
	const vf reach = vf_max(vf_from_i(distance), vf_set(1));
	vf leave = vf_set(3e38F);
	for (int axis = 0; axis < 3; axis++) {
		const vm forward = vf_less(vf_set(0), rays->delta[axis]);
		const vf high = cell[axis] + reach, low = cell[axis] + vf_set(1) - reach;
		const vf edge = vf_select(forward, high, low) * vf_set(GZ_MACROCELL_EDGE);
		leave = vf_min(leave, (edge - rays->start[axis]) * rays->inverse[axis]);
	}
	*until = leave;
	return vi_nonzero(distance);
}

/* All whole segments. */
SIMD uint32_t march(const struct gz_cast *cast, enum gz_voxel_type type, int nearest, int step,
		    const struct rays *rays, struct light *light)
{
	const vf end = rays->count; /* k + 1/2 < count */
	const vf half = vf_set(0.5F);
	vf k = half;
	vf until = vf_set(-1);
	uint32_t samples = 0;
	vm alive = rays->hit;
	vm inside = vm_but(alive, alive); /* the last sample showed something: no cell to ask for */
	for (;;) {
		const vm active = vm_and(alive, vf_less(k, end));
		if (!vm_any(active))
			break;
		const vm asks = vm_but(active, vm_or(inside, vf_less(k, until)));
		if (vm_any(asks)) {
			vf leave;
			const vm empty = vm_and(look_up_cell(cast, rays, k, asks, &leave), asks);
			/* To the first sample at or behind the empty box's far side; at least one
			 * on. */
			const vf ahead = vf_max(vf_ceil(leave - k), vf_set(1));
			k = vf_select(empty, k + ahead, k);
			/* A sample that rounding puts just behind its own cell's end is taken too.
			 */
			until = vf_select(vm_but(asks, empty), vf_max(leave, k + half), until);
		}
		const vm takes = vm_and(active, vm_or(inside, vf_less(k, until)));
		if (!vm_any(takes))
			continue;
		samples += vm_count(takes);
		const vi entry = entry_of(cast, sample_at(cast, type, nearest, rays, k, takes));
		vf opacity;
		vi colour;
		gather_pair(cast->step_table[step], entry, takes, &opacity, &colour);
		const vm visible = vf_less(vf_set(0), opacity);
		inside = visible;
		if (vm_any(visible)) {
			composite(colour, opacity, visible, light);
			alive = vm_and(alive,
				       vf_less(vf_set(GZ_TRANSMITTANCE_END), light->through));
		}
		k = vf_select(takes, k + vf_set(1), k);
	}
	return samples;
}

/* What is left behind the whole segments. */
SIMD uint32_t march_rest(const struct gz_cast *cast, enum gz_voxel_type type, int nearest, int step,
			 const struct rays *rays, struct light *light)
{
	vm mask = vm_and(rays->hit, vf_less(vf_set(1e-4F), rays->rest));
	mask = vm_and(mask, vf_less(vf_set(GZ_TRANSMITTANCE_END), light->through));
	if (!vm_any(mask))
		return 0;
	const vf k = vf_fma(rays->rest, vf_set(0.5F), rays->count);
	vf leave;
	mask = vm_but(mask, look_up_cell(cast, rays, k, mask, &leave));
	if (!vm_any(mask))
		return 0;
	const vi entry = entry_of(cast, sample_at(cast, type, nearest, rays, k, mask));
	vf extinction;
	vi colour;
	gather_pair(cast->extinction, entry, mask, &extinction, &colour);
	const vf length = rays->rest * vf_set(cast->voxel_lengths[step]);
	const vf opacity = vf_set(1) - exp2_negative(extinction * length);
	const vm visible = vm_and(mask, vf_less(extinction, vf_set(0)));
	composite(colour, opacity, visible, light);
	return vm_count(mask);
}

/* Rays of pixels (x, y), cut by the box. */
SIMD void set_up_rays(const struct gz_cast *cast, int step, vf x, vf y, vm active,
		      struct rays *rays)
{
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
	const vf scale = vf_set(cast->step[step]) / vf_sqrt(length2);
	vf enter = vf_set(0), leave = vf_set(3e38F);
	for (int axis = 0; axis < 3; axis++) {
		const vf least = vf_set(1e-12F);
		const vf raw = direction[axis] * scale;
		const vf delta = vf_select(vf_less(vf_abs(raw), least), least, raw);
		const vf inverse = vf_set(1) / delta;
		const vf a = (vf_set(0) - origin[axis]) * inverse;
		const vf b = (vf_set(cast->dims[axis]) - origin[axis]) * inverse;
		enter = vf_max(enter, vf_min(a, b));
		leave = vf_min(leave, vf_max(a, b));
		rays->delta[axis] = delta;
		rays->inverse[axis] = inverse;
	}
	rays->hit = vm_and(active, vf_less(enter, leave));
	const vf length = vf_select(rays->hit, leave - enter, vf_set(0));
	rays->count = vf_floor(length);
	rays->rest = length - rays->count;
	for (int axis = 0; axis < 3; axis++)
		rays->start[axis] = vf_fma(enter, rays->delta[axis], origin[axis]);
}

SIMD vi to_byte(vf x)
{
	return vi_trunc(vf_fma(vf_min(vf_max(x, vf_set(0)), vf_set(1)), vf_set(255), vf_set(0.5F)));
}

SIMD vi to_pixel(const struct gz_cast *cast, const struct light *light)
{
	const vf *t = &light->through;
	const vi red =
		to_byte(vf_fma(*t, vf_set(cast->background[0]), light->red * vf_set(1.0F / 2047)));
	const vi green = to_byte(
		vf_fma(*t, vf_set(cast->background[1]), light->green * vf_set(1.0F / 2047)));
	const vi blue =
		to_byte(vf_fma(*t, vf_set(cast->background[2]), light->blue * vf_set(1.0F / 1023)));
	const vi opaque = vi_set((int32_t)0xFF000000);
	return vi_or(vi_or(red, vi_shift_left(green, 8)), vi_or(vi_shift_left(blue, 16), opaque));
}

SIMD uint32_t cast_tile(const struct gz_cast *cast, const struct gz_cast_tile *tile,
			uint32_t out_pixels[GZ_TILE_RAYS], enum gz_voxel_type type, int nearest)
{
	uint32_t samples = 0;
	for (int first = 0; first < GZ_TILE_RAYS; first += SIMD_LANES) {
		const vf x = vf_load(tile->x + first), y = vf_load(tile->y + first);
		struct rays rays;
		struct light light = { vf_set(0), vf_set(0), vf_set(0), vf_set(1) };
		set_up_rays(cast, tile->step, x, y, vm_from_bits(tile->active >> first), &rays);
		samples += march(cast, type, nearest, tile->step, &rays, &light);
		samples += march_rest(cast, type, nearest, tile->step, &rays, &light);
		vi_store(out_pixels + first, to_pixel(cast, &light));
	}
	return samples;
}

#define DEFINE_TILE(name, type, nearest)                                                  \
	static uint32_t name(const struct gz_cast *cast, const struct gz_cast_tile *tile, \
			     uint32_t out_pixels[GZ_TILE_RAYS])                           \
	{                                                                                 \
		return cast_tile(cast, tile, out_pixels, type, nearest);                  \
	}

DEFINE_TILE(tile_u8, GZ_VOXEL_U8, 0)
DEFINE_TILE(tile_u16, GZ_VOXEL_U16, 0)
DEFINE_TILE(tile_f32, GZ_VOXEL_F32, 0)
DEFINE_TILE(tile_u8_nearest, GZ_VOXEL_U8, 1)
DEFINE_TILE(tile_u16_nearest, GZ_VOXEL_U16, 1)
DEFINE_TILE(tile_f32_nearest, GZ_VOXEL_F32, 1)

#define GZ_CAST_KERNELS(set)                                             \
	{                                                                \
		.name = set,                                             \
		.tile = {                                                \
			[GZ_VOXEL_U8] = { tile_u8, tile_u8_nearest },    \
			[GZ_VOXEL_U16] = { tile_u16, tile_u16_nearest }, \
			[GZ_VOXEL_F32] = { tile_f32, tile_f32_nearest }, \
		},                                                       \
	}
