/*
 * Blocks of 4 x 4 x 4 voxels in registers, from which all lanes take their eight neighbours by
 * permutation. Rays of a tile lie close together, so one block serves all of them, where gathers
 * would fetch each voxel many times. If rays lie farther apart along x, a wide block of 8 x 4 x 4
 * voxels of 8 or 16 bits serves them. A part of the kernel, for sets with blocks: see
 * cast_kernel.h.
 *
 * A set's own header (SIMD_BLOCKS) says how its registers hold voxels:
 *
 * - block_exists(type, wide): whether there are blocks of a type;
 * - struct block_voxels, and block_load(): load it from rows and slices that lie these strides
 *   apart;
 * - block_pairs(): each lane's neighbours along x as signed words, of 16-bit values less 32768, in
 *   the order (y, z) = 00, 10, 01, 11, for places of whole voxels in the block;
 * - block_mix_floats(): the values between floats;
 * - TOGETHER_SPREAD: how far apart rays may be.
 *
 * Along x, neighbours are weighted in whole numbers of 1/32767, where one multiplication serves
 * both of a lane's voxels; beyond 256 voxels single-precision places are coarser than that. Values
 * leave here in units of 1 / FETCH_UNIT, 16-bit ones less 32768, which the scale of the look-up
 * includes. A value does not depend on whether it came from a block or from single loads,
 * but for 2^-22 where a place is at or beyond the last datum along an axis.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_BLOCK_H
#define GZ_RENDER_RAYCAST_CPU_CAST_BLOCK_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_rays.h"

enum { BLOCK_EDGE = 4, BLOCK_VOXELS = BLOCK_EDGE * BLOCK_EDGE * BLOCK_EDGE, BLOCK_WIDE = 8 };

/* Two rows of eight 8-bit voxels. */
SIMD __m128i near_two_rows(const char *from, int64_t row)
{
	int64_t rows[2];
	memcpy(&rows[0], from, sizeof rows[0]);
	memcpy(&rows[1], from + row, sizeof rows[1]);
	return _mm_set_epi64x(rows[1], rows[0]);
}

#include SIMD_BLOCKS

struct block {
	vf base[3]; /* index of the first voxel, the same in all lanes */
	struct block_voxels voxels;
};

/* Voxels along an edge of a block. */
SIMD float block_edge(int wide, int axis)
{
	return wide && axis == 0 ? BLOCK_WIDE : BLOCK_EDGE;
}

/* Whether a volume has blocks: it must be in one piece and large enough. */
SIMD int blocks_fit(const struct gz_cast *cast, enum gz_voxel_type type, int wide)
{
	return !cast->bricks.table && block_exists(type, wide) &&
	       cast->dims[0] >= block_edge(wide, 0) && cast->dims[1] >= BLOCK_EDGE &&
	       cast->dims[2] >= BLOCK_EDGE;
}

/* Load the block whose first voxel holds a place (x, y, z), moved into the volume at its rim.
 * Returns the index of that voxel. */
SIMD __m128 block_take(const struct gz_cast *cast, enum gz_voxel_type type, int wide, __m128 place,
		       struct block *block)
{
	const __m128 last =
		_mm_sub_ps(_mm_setr_ps(cast->dims[0], cast->dims[1], cast->dims[2], BLOCK_EDGE),
			   _mm_setr_ps(block_edge(wide, 0), BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE));
	const __m128 base = _mm_min_ps(_mm_max_ps(_mm_floor_ps(place), _mm_setzero_ps()), last);
	block->base[0] = vf_set(_mm_cvtss_f32(base));
	block->base[1] = vf_set(_mm_cvtss_f32(_mm_permute_ps(base, 0x55)));
	block->base[2] = vf_set(_mm_cvtss_f32(_mm_permute_ps(base, 0xAA)));
	const __m128i first = _mm_cvtps_epi32(base);
	const int64_t row = cast->stride[1], slice = cast->stride[2];
	const int64_t from = _mm_cvtsi128_si32(first) + _mm_extract_epi32(first, 1) * row +
			     _mm_extract_epi32(first, 2) * slice;
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : type == GZ_VOXEL_U16 ? 2 : 4;
	const char *voxels = (const char *)cast->voxels + from * bytes;
	block_load(type, wide, voxels, row, slice, &block->voxels);
	return base;
}

/* Move places beyond the first or the last datum to that datum. */
SIMD void block_clamp(const struct gz_cast *cast, const struct block *block, int wide, vf places[3])
{
	for (int axis = 0; axis < 3; axis++) {
		const float edge = block_edge(wide, axis);
		const vf most = vf_set((edge - 1) * (1 - 0x1p-23F)); /* the float below */
		const vf last = vf_set(cast->dims[axis] - edge);
		const vm at_first = vf_less(block->base[axis], vf_set(1));
		const vm at_last = vf_less(last - vf_set(1), block->base[axis]);
		places[axis] = vf_select(at_first, vf_max(places[axis], vf_set(0)), places[axis]);
		places[axis] = vf_select(at_last, vf_min(places[axis], most), places[axis]);
	}
}

/* Whether the places of all lanes of mask lie in the block. */
SIMD int block_holds(const vf places[3], int wide, vm mask)
{
	/* As unsigned numbers, floats from 0 up have their order and negative ones lie above. */
	const vi x = vi_bits(places[0]), end = vi_bits(vf_set(BLOCK_EDGE - 1));
	vi most = vi_greater_unsigned(vi_bits(places[1]), vi_bits(places[2]));
	if (!wide)
		most = vi_greater_unsigned(most, x);
	vm beyond = vi_reaches_unsigned(most, end);
	if (wide)
		beyond = vm_or(beyond, vi_reaches_unsigned(x, vi_bits(vf_set(BLOCK_WIDE - 1))));
	return !vm_any(vm_and(mask, beyond));
}

/* Whether places counted from the block's first voxel, of all lanes of mask, lie in it. Moves those
 * beyond the volume's data into it. */
SIMD int block_places(const struct gz_cast *cast, const struct block *block, int wide, vm mask,
		      vf places[3])
{
	if (__builtin_expect(block_holds(places, wide, mask), 1))
		return 1;
	block_clamp(cast, block, wide, places);
	return block_holds(places, wide, mask);
}

/* Places within a block: the voxel before each, and the share of the next. */
SIMD void block_shares(const vf places[3], vf whole[3], vf share[3])
{
	for (int axis = 0; axis < 3; axis++) {
		whole[axis] = vf_floor(places[axis]);
		share[axis] = places[axis] - whole[axis];
	}
}

/* The values at places within the block, in FETCH_UNITs. */
SIMD vf block_sample(const struct block *block, enum gz_voxel_type type, int wide,
		     const vf places[3])
{
	vf whole[3], share[3];
	block_shares(places, whole, share);
	if (type == GZ_VOXEL_F32)
		return block_mix_floats(&block->voxels, whole, share);
	vi pairs[4];
	block_pairs(&block->voxels, type, wide, whole, pairs);
	return mix_pairs(pairs, share);
}

#endif
