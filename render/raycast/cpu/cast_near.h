/*
 * Differences between voxels, for gradients. Samples that are shaded lie close to each other and to
 * those before them, so a block of voxels and its six neighbours, a voxel away along each axis,
 * serve several: they stay until a sample lies outside. A part of the kernel: see cast_kernel.h.
 *
 * Differences are whole numbers until they are mixed along y and z. So one does not depend on
 * whether it came from a block or from single loads.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_NEAR_H
#define GZ_RENDER_RAYCAST_CPU_CAST_NEAR_H

#include <math.h>

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_rays.h"

/* Places counted from the first datum where differences are wanted, of the lanes of a mask. */
struct places {
	vf at[3];
	vm mask;
};

#ifndef SIMD_BLOCKS
struct near_voxels {
	int none;
};

SIMD void near_nothing(const struct rays *rays, struct near_voxels *near)
{
	(void)rays;
	near->none = 1;
}
#else

#include "render/raycast/cpu/cast_block.h"

/* The blocks before and after the one at base along each axis. */
struct near_voxels {
	vf base[3]; /* the same in all lanes; far outside at first */
	/* Along each axis: -0 where rays go backward, else 0, and how far before the rearmost place
	 * a block begins, so that it holds what follows. They are those of a tile's first ray: the
	 * others go nearly the same way. */
	__m128 backward, begin;
	struct near_blocks blocks;
};

SIMD void near_nothing(const struct rays *rays, struct near_voxels *near)
{
	const __m128 sign = _mm_set1_ps(-0.0F);
	for (int axis = 0; axis < 3; axis++)
		near->base[axis] = vf_set(-1e6F);
	near->backward =
		_mm_and_ps(sign, _mm_setr_ps(vf_first(rays->delta[0]), vf_first(rays->delta[1]),
					     vf_first(rays->delta[2]), 0));
	near->begin = _mm_blendv_ps(_mm_setzero_ps(), _mm_set1_ps(BLOCK_EDGE - 2), near->backward);
}

/* Whether all places of the mask lie in the block, and where. */
SIMD int near_places(const struct near_voxels *near, const vf at[3], vm mask, vf places[3])
{
	for (int axis = 0; axis < 3; axis++)
		places[axis] = at[axis] - near->base[axis];
	return block_holds(places, 0, mask);
}

/* The places that rays reach first along each axis. The registers of a tile take turns, so the
 * places that follow may lie behind those asked for. */
SIMD __m128 near_rearmost(const struct near_voxels *near, const struct places *here,
			  const struct places *next)
{
	float first[3];
	for (int axis = 0; axis < 3; axis++) {
		const vf sign = vf_set(near->backward[axis]), none = vf_set(INFINITY);
		vf at = vf_select(here->mask, vf_flip(here->at[axis], sign), none);
		if (TILE_PARTS > 1)
			at = vf_min(at, vf_select(next->mask, vf_flip(next->at[axis], sign), none));
		first[axis] = vf_least_of(at, vm_all());
	}
	return _mm_xor_ps(_mm_setr_ps(first[0], first[1], first[2], 0), near->backward);
}

/* The voxels around a block at the rim of the volume. Those beyond it are like the nearest ones
 * within. */
struct rim_voxels {
	/* rows of eight voxels of 16 bits, or less */
	__m128i rows[BLOCK_EDGE + 2][BLOCK_EDGE + 2];
};

/* Which bytes of a row make one that begins a voxel before `base`, from voxel `from` on. */
SIMD __m128i rim_control(const struct gz_cast *cast, int bytes, int32_t base, int32_t from)
{
	int8_t control[16];
	for (int i = 0; i < 16; i++) {
		const int32_t x = base - 1 + i / bytes, last = cast->last[0] + 1;
		const int32_t within = x < 0 ? 0 : x > last ? last : x;
		control[i] = (int8_t)((within - from) * bytes + i % bytes);
	}
	return _mm_loadu_si128((const __m128i *)control);
}

/* Copy the voxels around the block at `base`. */
static __attribute__((noinline)) void copy_rim(const struct gz_cast *cast, int bytes,
					       const int32_t base[3], struct rim_voxels *rim)
{
	const int32_t from = base[0] > 0 ? base[0] - 1 : 0;
	const __m128i control = rim_control(cast, bytes, base[0], from);
	for (int z = 0; z < BLOCK_EDGE + 2; z++)
		for (int y = 0; y < BLOCK_EDGE + 2; y++) {
			int64_t index = from;
			const int32_t place[3] = { 0, base[1] - 1 + y, base[2] - 1 + z };
			for (int axis = 1; axis < 3; axis++) {
				const int32_t last = cast->last[axis] + 1;
				const int32_t within = place[axis] < 0      ? 0
						       : place[axis] > last ? last
									    : place[axis];
				index += (int64_t)within * cast->stride[axis];
			}
			const char *row = (const char *)cast->voxels + index * bytes;
			rim->rows[z][y] =
				_mm_shuffle_epi8(_mm_loadu_si128((const __m128i *)row), control);
		}
}

/* The first voxels of the last block. */
SIMD __m128 near_last(const struct gz_cast *cast)
{
	return _mm_sub_ps(_mm_setr_ps(cast->dims[0], cast->dims[1], cast->dims[2], BLOCK_EDGE),
			  _mm_set1_ps(BLOCK_EDGE));
}

/* Where a block in the volume begins, so that the places lie in it, and what follows them, too. */
SIMD __m128 near_base(const struct gz_cast *cast, const struct near_voxels *near,
		      const struct places *here, const struct places *next)
{
	const __m128 first = _mm_sub_ps(_mm_floor_ps(near_rearmost(near, here, next)), near->begin);
	return _mm_min_ps(_mm_max_ps(first, _mm_setzero_ps()), near_last(cast));
}

/* Load the blocks around the one at `base`. */
SIMD void near_load(const struct gz_cast *cast, enum gz_voxel_type type, __m128 base,
		    struct near_voxels *near)
{
	const int bytes = type == GZ_VOXEL_U8 ? 1 : 2;
	const __m128i index = _mm_cvtps_epi32(base);
	for (int axis = 0; axis < 3; axis++)
		near->base[axis] = vf_set(base[axis]);
	/* the voxels before them, and the rows' ends that are read after them */
	const __m128 inner = _mm_sub_ps(near_last(cast), _mm_set1_ps(2));
	const __m128 rim = _mm_or_ps(_mm_cmplt_ps(base, _mm_set1_ps(1)), _mm_cmplt_ps(inner, base));
	if (__builtin_expect((_mm_movemask_ps(rim) & 7) != 0, 0)) {
		struct rim_voxels voxels;
		int32_t from[4];
		_mm_storeu_si128((__m128i *)from, index);
		copy_rim(cast, bytes, from, &voxels);
		near_load_blocks(type, (const char *)&voxels.rows[1][1] + bytes,
				 sizeof voxels.rows[0][0], sizeof voxels.rows[0], &near->blocks);
	} else {
		const int64_t row = cast->stride[1], slice = cast->stride[2];
		const int64_t from = _mm_cvtsi128_si32(index) + _mm_extract_epi32(index, 1) * row +
				     _mm_extract_epi32(index, 2) * slice;
		near_load_blocks(type, (const char *)cast->voxels + from * bytes, row * bytes,
				 slice * bytes, &near->blocks);
	}
}

/* The weighted difference of two pairs of words. Differences of 8-bit values are words, too. */
SIMD vi weigh_difference(enum gz_voxel_type type, vi before, vi after, vi weights)
{
	if (type == GZ_VOXEL_U8)
		return vi_sum_of_products(vi_subtract_words(after, before), weights);
	return vi_subtract(vi_sum_of_products(after, weights), vi_sum_of_products(before, weights));
}

/* One component from its four rows, in the order (y, z) = 00, 10, 01, 11, in these units. */
SIMD vf mix_differences(const vi rows[4], const vf share[3], float unit)
{
	vf mixed[4];
	for (int i = 0; i < 4; i++)
		mixed[i] = vf_from_i(rows[i]);
	return mix(mix(mixed[0], mixed[1], share[1]), mix(mixed[2], mixed[3], share[1]), share[2]) *
	       vf_set(unit);
}

/* Trilinear differences at places in the blocks nearby, of voxels of 8 or 16 bits. Returns 0 if the
 * blocks have none. */
SIMD int near_mix(const struct near_voxels *near, enum gz_voxel_type type, const vf places[3],
		  vf difference[3])
{
	const float unit = near_unit(&near->blocks, type);
	if (unit == 0)
		return 0;
	vf whole[3], share[3];
	block_shares(places, whole, share);
	const vi weights = word_weights(share[0]), first = block_first(whole);
	for (int axis = 0; axis < 3; axis++) {
		vi rows[4];
		near_rows_of(&near->blocks, type, axis, first, weights, rows);
		difference[axis] = mix_differences(rows, share, unit);
	}
	return 1;
}

/* Trilinear differences at places in the volume from the blocks around them, which are loaded.
 * Returns 0 if no block holds them all. */
SIMD int near_differences(const struct gz_cast *cast, enum gz_voxel_type type,
			  const struct places *here, const struct places *next,
			  struct near_voxels *near, vf difference[3])
{
	vf places[3];
	for (int axis = 0; axis < 3; axis++)
		if (cast->dims[axis] < BLOCK_EDGE)
			return 0;
	const __m128 base = near_base(cast, near, here, next);
	for (int axis = 0; axis < 3; axis++) {
		/* The last datum is at the end of the last block, so move it into that. */
		const float end = (BLOCK_EDGE - 1) * (1 - 0x1p-23F);
		const int at_last = base[axis] >= cast->dims[axis] - BLOCK_EDGE;
		places[axis] = vf_min(here->at[axis] - vf_set(base[axis]),
				      vf_set(at_last ? end : INFINITY));
	}
	if (!block_holds(places, 0, here->mask))
		return 0;
	near_load(cast, type, base, near);
	return near_mix(near, type, places, difference);
}

/* Two neighbours along x as words. */
SIMD vi load_word_pair(const struct gz_cast *cast, enum gz_voxel_type type, vi index, vm mask)
{
	if (type == GZ_VOXEL_U8) {
		const vi four = vi_gather(cast->voxels, index, 1, mask);
		return vi_or(vi_and(four, vi_set(0xFF)),
			     vi_and(vi_shift_left(four, 8), vi_set(0xFF0000)));
	}
	return vi_xor(vi_gather(cast->voxels, index, 2, mask), vi_set((int32_t)0x80008000));
}

/* Where the neighbours of places lie along an axis that exist, counted in voxels' strides from the
 * lower of the two that a place is between: before that, and after the upper one. */
struct word_neighbours {
	vi before, after;
};

SIMD struct word_neighbours word_neighbours(const struct gz_cast *cast, int axis, vi index)
{
	const vi none = vi_set(0), up = vi_set(axis == 0 ? 1 : cast->stride[axis]);
	return (struct word_neighbours) {
		vi_select(vi_less(none, index), vi_subtract(none, up), none),
		vi_select(vi_less(index, vi_set(cast->last[axis])), vi_add(up, up), up),
	};
}

/* What near_differences() gives, from single loads. */
SIMD void difference_words(const struct gz_cast *cast, enum gz_voxel_type type,
			   const struct places *here, vf difference[3])
{
	const vm mask = here->mask;
	vf share[3];
	vi index[3];
	struct word_neighbours far[3];
	for (int axis = 0; axis < 3; axis++) {
		index[axis] = clamp_place(cast, axis, here->at[axis], &share[axis]);
		far[axis] = word_neighbours(cast, axis, index[axis]);
	}
	const vi up[3] = { vi_set(1), vi_set(cast->stride[1]), vi_set(cast->stride[2]) };
	const vi first = vi_add(index[0], vi_add(vi_mul(index[1], up[1]), vi_mul(index[2], up[2])));
	const vi weights = word_weights(share[0]);
	vi middle[4], before[3][4], after[3][4];
	for (int i = 0; i < 4; i++) { /* bit 0: y, bit 1: z */
		vi row = i & 1 ? vi_add(first, up[1]) : first;
		row = i & 2 ? vi_add(row, up[2]) : row;
		middle[i] = load_word_pair(cast, type, row, mask);
		const vi low = load_word_pair(cast, type, vi_add(row, far[0].before), mask);
		const vi high = load_word_pair(cast, type, vi_add(row, far[0].after), mask);
		before[0][i] = vi_or(vi_and(low, vi_set(0xFFFF)), vi_shift_left(middle[i], 16));
		after[0][i] = vi_or(vi_shift_right(middle[i], 16), vi_shift_left(high, 16));
	}
	for (int axis = 1; axis < 3; axis++)
		for (int i = 0; i < 2; i++) {
			const int low = axis == 1 ? 2 * i : i, high = low + axis;
			const vi row = i ? vi_add(first, up[3 - axis]) : first;
			before[axis][low] =
				load_word_pair(cast, type, vi_add(row, far[axis].before), mask);
			before[axis][high] = middle[low];
			after[axis][low] = middle[high];
			after[axis][high] =
				load_word_pair(cast, type, vi_add(row, far[axis].after), mask);
		}
	for (int axis = 0; axis < 3; axis++) {
		vi rows[4];
		for (int i = 0; i < 4; i++)
			rows[i] = weigh_difference(type, before[axis][i], after[axis][i], weights);
		difference[axis] = mix_differences(rows, share, 1.0F / 32767);
	}
}

/* Whether differences come from words. */
SIMD int by_words(const struct gz_cast *cast, struct reading reading)
{
	return !reading.nearest && reading.type != GZ_VOXEL_F32 && !cast->bricks.table &&
	       cast->dims[0] >= 2 && cast->dims[1] >= 2 && cast->dims[2] >= 2;
}

/* Trilinear differences anywhere, of voxels of 8 or 16 bits in memory. */
SIMD void difference_by_words(const struct gz_cast *cast, enum gz_voxel_type type,
			      const struct places *here, const struct places *next,
			      struct near_voxels *near, vf difference[3])
{
	struct places within = { .mask = here->mask };
	struct places next_within = { .mask = next->mask };
	for (int axis = 0; axis < 3; axis++) {
		const vf last = vf_set(cast->dims[axis] - 1);
		within.at[axis] = clamp_lanes(here->at[axis], vf_set(0), last);
		next_within.at[axis] = clamp_lanes(next->at[axis], vf_set(0), last);
	}
	if (!near_differences(cast, type, &within, &next_within, near, difference))
		difference_words(cast, type, &within, difference);
	/* Beyond the last datum all voxels are like it, so of two places a voxel apart from one
	 * there, only one still moves away from that. */
	for (int axis = 0; axis < 3; axis++)
		difference[axis] =
			difference[axis] * (vf_set(1) - vf_abs(here->at[axis] - within.at[axis]));
}

#endif
#endif
