/*
 * From a place along the rays to the value there and its entry in the transfer function, for
 * volumes in one piece and volumes of bricks. A part of the kernel: see cast_kernel.h.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_FETCH_H
#define GZ_RENDER_RAYCAST_CPU_CAST_FETCH_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_rays.h"

/* Two neighbours along x as floats: one load of 32 bits if both fit. */
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

/* Interpolate between eight voxels, the first at index `first`. */
SIMD vf mix_rows(const struct gz_cast *cast, enum gz_voxel_type type, vi first,
		 const int32_t stride[3], const vf share[3], vm mask)
{
	const vi up_y = vi_set(stride[1]);
	const vi above = vi_add(first, vi_set(stride[2]));
	const vf v00 = load_row(cast, type, first, mask, share[0]);
	const vf v10 = load_row(cast, type, vi_add(first, up_y), mask, share[0]);
	const vf v01 = load_row(cast, type, above, mask, share[0]);
	const vf v11 = load_row(cast, type, vi_add(above, up_y), mask, share[0]);
	return mix(mix(v00, v10, share[1]), mix(v01, v11, share[1]), share[2]);
}

/* Voxels from one to the next along each axis of a brick. */
static const int32_t brick_stride[3] = { 1, GZ_BRICK_STORED_EDGE,
					 GZ_BRICK_STORED_EDGE *GZ_BRICK_STORED_EDGE };

/* Find the brick in memory over each lane's place, which is of the cast's level or a coarser one.
 * Returns the index of the brick's first voxel; `place` is counted from its first datum, 1/2 to
 * 32 1/2. */
SIMD vi find_bricks(const struct gz_cast_bricks *bricks, const vf at[3], vm mask, vf place[3])
{
	vf brick[3];
	vi index = vi_set(0);
	for (int axis = 0; axis < 3; axis++) {
		place[axis] = at[axis] + vf_set(0.5F);
		brick[axis] = vf_floor(
			vf_min(vf_max(place[axis] * vf_set(1.0F / GZ_BRICK_EDGE), vf_set(0)),
			       vf_set(bricks->last[axis])));
		index = vi_add(index, vi_mul(vi_trunc(brick[axis]), vi_set(bricks->stride[axis])));
	}
	const vi entry = vi_gather(bricks->table, index, 4, mask);
	const vi level = vi_and(entry, vi_set((1 << GZ_BRICK_LEVEL_BITS) - 1));
	for (int axis = 0; axis < 3; axis++) {
		const vf scale = vf_gather(bricks->scale[axis], level, mask);
		const vf own = vf_floor(brick[axis] * scale) * vf_set(GZ_BRICK_EDGE);
		place[axis] = place[axis] * scale - own + vf_set(0.5F);
	}
	return vi_mul(vi_shift_right(entry, GZ_BRICK_LEVEL_BITS), vi_set(GZ_BRICK_VOXELS));
}

SIMD vf bricks_nearest(const struct gz_cast *cast, enum gz_voxel_type type, vi first,
		       const vf place[3], vm mask)
{
	const vf top = vf_set(GZ_BRICK_STORED_EDGE - 1);
	for (int axis = 0; axis < 3; axis++) {
		const vf voxel = vf_min(vf_max(place[axis] + vf_set(0.5F), vf_set(0)), top);
		first = vi_add(first, vi_mul(vi_trunc(voxel), vi_set(brick_stride[axis])));
	}
	vf low, high;
	load_pair(cast, type, first, mask, &low, &high);
	return low;
}

SIMD vf bricks_trilinear(const struct gz_cast *cast, enum gz_voxel_type type, vi first,
			 const vf place[3], vm mask)
{
	vf share[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf inside = vf_max(place[axis], vf_set(0));
		const vi index = vi_min(vi_trunc(inside), vi_set(GZ_BRICK_STORED_EDGE - 2));
		share[axis] = vf_min(inside - vf_from_i(index), vf_set(1));
		first = vi_add(first, vi_mul(index, vi_set(brick_stride[axis])));
	}
	return mix_rows(cast, type, first, brick_stride, share, mask);
}

/* Sample a volume of bricks at places counted from the level's first datum. Not inlined, so that
 * the kernels for volumes in memory stay small. */
static __attribute__((noinline)) vf sample_bricks(const struct gz_cast *cast,
						  enum gz_voxel_type type, int nearest,
						  const vf at[3], vm mask)
{
	vf place[3];
	const vi first = find_bricks(&cast->bricks, at, mask, place);
	return nearest ? bricks_nearest(cast, type, first, place, mask)
		       : bricks_trilinear(cast, type, first, place, mask);
}

/* The lower of two neighbours along an axis, and the weight of the upper one. */
SIMD vi clamp_place(const struct gz_cast *cast, int axis, vf at, vf *share)
{
	const vf place = vf_min(vf_max(at, vf_set(0)), vf_set(cast->dims[axis] - 1));
	const vi index = vi_min(vi_trunc(place), vi_set(cast->last[axis]));
	*share = place - vf_from_i(index);
	return index;
}

/* Index of the first of eight neighbours, for places counted from the first datum. */
SIMD vi first_voxel(const struct gz_cast *cast, const vf at[3])
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	return vi_add(vi_add(index[0], vi_mul(index[1], vi_set(cast->stride[1]))),
		      vi_mul(index[2], vi_set(cast->stride[2])));
}

/* Sample at places counted from the first datum, 0 to dims - 1. */
SIMD vf sample_trilinear(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			 vm mask)
{
	vf share[3];
	vi index[3];
	if (__builtin_expect(cast->bricks.table != NULL, 0))
		return sample_bricks(cast, type, 0, at, mask);
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	const vi first = vi_add(vi_add(index[0], vi_mul(index[1], vi_set(cast->stride[1]))),
				vi_mul(index[2], vi_set(cast->stride[2])));
	return mix_rows(cast, type, first, cast->stride, share, mask);
}

/* Index of the voxel at places counted from the first datum. */
SIMD vi nearest_voxel(const struct gz_cast *cast, const vf at[3])
{
	vi index = vi_set(0);
	for (int axis = 0; axis < 3; axis++) {
		const vf top = vf_set(cast->dims[axis] - 1);
		const vf place = vf_min(vf_max(vf_floor(at[axis] + vf_set(0.5F)), vf_set(0)), top);
		index = vi_add(index, vi_mul(vi_trunc(place), vi_set(cast->stride[axis])));
	}
	return index;
}

SIMD vf sample_nearest(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3], vm mask)
{
	if (__builtin_expect(cast->bricks.table != NULL, 0))
		return sample_bricks(cast, type, 1, at, mask);
	vf low, high;
	load_pair(cast, type, nearest_voxel(cast, at), mask, &low, &high);
	return low;
}

SIMD vf sample_at(const struct gz_cast *cast, enum gz_voxel_type type, int nearest,
		  const struct rays *rays, vf k, vm mask)
{
	vf at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, rays->delta[axis], rays->datum[axis]);
	return nearest ? sample_nearest(cast, type, at, mask)
		       : sample_trilinear(cast, type, at, mask);
}

/* From values to entries of the transfer function. */
struct look_up {
	vf scale, bias, last;
};

/* The transfer function's entry for a value. */
SIMD vi entry_of(const struct look_up *look_up, vf value)
{
	const vf entry = vf_fma(value, look_up->scale, look_up->bias);
	return vi_round(vf_min(vf_max(entry, vf_set(0)), look_up->last));
}

/* For values as they are stored. */
SIMD struct look_up stored_look_up(const struct gz_cast *cast)
{
	return (struct look_up) { vf_set(cast->entry_scale), vf_set(cast->entry_bias),
				  vf_set(cast->entry_last) };
}

/* fetch_sample() returns trilinear values less FETCH_OFFSET, in units of 1 / FETCH_UNIT. */
#define FETCH_UNIT(type)   ((type) == GZ_VOXEL_F32 ? 1.0F : 32767.0F)
#define FETCH_OFFSET(type) ((type) == GZ_VOXEL_U16 ? 32768.0F : 0.0F)

/* Weights of two words: the share of the upper voxel in the high half, the rest in the low half. */
SIMD vi word_weights(vf share)
{
	const vi high = vi_round(share * vf_set(32767));
	return vi_xor(vi_or(vi_shift_left(high, 16), high), vi_set(0x7FFF));
}

SIMD vf mix_words(vi words, vi weights)
{
	return vf_from_i(vi_sum_of_products(words, weights));
}

/* Four pairs of words, in the order (y, z) = 00, 10, 01, 11. */
SIMD vf mix_pairs(const vi pairs[4], const vf share[3])
{
	const vi weights = word_weights(share[0]);
	const vf v00 = mix_words(pairs[0], weights), v10 = mix_words(pairs[1], weights);
	const vf v01 = mix_words(pairs[2], weights), v11 = mix_words(pairs[3], weights);
	return mix(mix(v00, v10, share[1]), mix(v01, v11, share[1]), share[2]);
}

/* The values that blocks would give, from single loads, for lanes that lie far apart. Lanes outside
 * the mask load the volume's first voxels, which are in the cache. */
SIMD vf scattered_sample(const struct gz_cast *cast, enum gz_voxel_type type, const vf at[3],
			 vm mask)
{
	vf share[3];
	vi index[3];
	for (int axis = 0; axis < 3; axis++)
		index[axis] = clamp_place(cast, axis, at[axis], &share[axis]);
	const vi lane = vi_add(vi_add(index[0], vi_mul(index[1], vi_set(cast->stride[1]))),
			       vi_mul(index[2], vi_set(cast->stride[2])));
	int32_t first[SIMD_LANES];
	vi_store((uint32_t *)first, vi_select(mask, lane, vi_set(0)));
	const int64_t up_y = cast->stride[1], up_z = cast->stride[2];
	const int bytes = type == GZ_VOXEL_U8 ? 1 : 2;
	const vi pairs[4] = {
		load_word_pairs(bytes, cast->voxels, 0, first),
		load_word_pairs(bytes, cast->voxels, up_y, first),
		load_word_pairs(bytes, cast->voxels, up_z, first),
		load_word_pairs(bytes, cast->voxels, up_y + up_z, first),
	};
	return mix_pairs(pairs, share);
}

/* The value at sample k of the lanes of mask, in FETCH_UNITs, wherever they are. */
SIMD vf fetch_sample(const struct march *m, vf k, vm mask)
{
	const struct gz_cast *cast = m->cast;
	const enum gz_voxel_type type = m->reading.type;
	vf at[3];
	for (int axis = 0; axis < 3; axis++)
		at[axis] = vf_fma(k, m->rays->delta[axis], m->rays->datum[axis]);
	if (m->reading.nearest)
		return sample_nearest(cast, type, at, mask);
	if (__builtin_expect(cast->bricks.table != NULL, 0))
		return (sample_trilinear(cast, type, at, mask) - vf_set(FETCH_OFFSET(type))) *
		       vf_set(FETCH_UNIT(type));
	return type == GZ_VOXEL_F32 ? sample_trilinear(cast, type, at, mask)
				    : scattered_sample(cast, type, at, mask);
}

/* For values as fetch_sample() returns them. */
SIMD struct look_up look_up_of(const struct gz_cast *cast, struct reading reading)
{
	float scale = cast->entry_scale, bias = cast->entry_bias;
	if (!reading.nearest) {
		bias += FETCH_OFFSET(reading.type) * scale;
		scale /= FETCH_UNIT(reading.type);
	}
	return (struct look_up) { vf_set(scale), vf_set(bias), vf_set(cast->entry_last) };
}

#endif
