/*
 * Blocks of 4 x 4 x 4 voxels in registers, from which all lanes take their eight neighbours by
 * permutation. Rays of a tile lie close together, so one block serves all of them, where gathers
 * would fetch each voxel many times. If rays lie farther apart along x, a wide block of 8 x 4 x 4
 * voxels of 8 or 16 bits serves them. A part of the kernel, for AVX-512: see cast_kernel.h.
 *
 * Along x, neighbours are weighted in whole numbers of 1/32767, where one multiplication serves
 * both of a lane's voxels; beyond 256 voxels single-precision places are coarser than that. Values
 * leave here in units of 1 / FETCH_UNIT, 16-bit ones less 32768, which the scale of the look-up
 * includes. A value does not depend on whether it came from a block or from single loads.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_BLOCK_H
#define GZ_RENDER_RAYCAST_CPU_CAST_BLOCK_H

#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cast_fetch.h"
#include "render/raycast/cpu/cast_rays.h"

enum { BLOCK_EDGE = 4, BLOCK_VOXELS = BLOCK_EDGE * BLOCK_EDGE * BLOCK_EDGE, BLOCK_WIDE = 8 };

struct block {
	vf base[3]; /* index of the first voxel, the same in all lanes */
	union {
		vi words[BLOCK_EDGE]; /* of 8 and 16 bits: two slices a word, wide one */
		vf slices[BLOCK_EDGE];
	};
};

/* Voxels along an edge of a block. */
SIMD float block_edge(int wide, int axis)
{
	return wide && axis == 0 ? BLOCK_WIDE : BLOCK_EDGE;
}

/* Whether a volume has blocks: it must be in one piece and large enough. */
SIMD int blocks_fit(const struct gz_cast *cast, enum gz_voxel_type type, int wide)
{
	return !cast->bricks.table && !(wide && type == GZ_VOXEL_F32) &&
	       cast->dims[0] >= block_edge(wide, 0) && cast->dims[1] >= BLOCK_EDGE &&
	       cast->dims[2] >= BLOCK_EDGE;
}

/* One slice: rows of four voxels, `stride` apart. */
SIMD __m128i block_slice_u8(const uint8_t *from, int64_t stride)
{
	int32_t rows[BLOCK_EDGE];
	for (int y = 0; y < BLOCK_EDGE; y++)
		memcpy(&rows[y], from + y * stride, sizeof rows[y]);
	return _mm_setr_epi32(rows[0], rows[1], rows[2], rows[3]);
}

SIMD __m256i block_slice_u16(const uint16_t *from, int64_t stride)
{
	int64_t rows[BLOCK_EDGE];
	for (int y = 0; y < BLOCK_EDGE; y++)
		memcpy(&rows[y], from + y * stride, sizeof rows[y]);
	return _mm256_setr_epi64x(rows[0], rows[1], rows[2], rows[3]);
}

SIMD vf block_slice_f32(const float *from, int64_t stride)
{
	vf slice = _mm512_castps128_ps512(_mm_loadu_ps(from));
	slice = _mm512_insertf32x4(slice, _mm_loadu_ps(from + stride), 1);
	slice = _mm512_insertf32x4(slice, _mm_loadu_ps(from + 2 * stride), 2);
	return _mm512_insertf32x4(slice, _mm_loadu_ps(from + 3 * stride), 3);
}

/* One slice of a wide block. */
SIMD vi block_wide_slice(enum gz_voxel_type type, const void *from, int64_t stride)
{
	if (type == GZ_VOXEL_U8) {
		int64_t rows[BLOCK_EDGE];
		for (int y = 0; y < BLOCK_EDGE; y++)
			memcpy(&rows[y], (const uint8_t *)from + y * stride, sizeof rows[y]);
		return _mm512_cvtepu8_epi16(_mm256_setr_epi64x(rows[0], rows[1], rows[2], rows[3]));
	}
	__m128i rows[BLOCK_EDGE];
	for (int y = 0; y < BLOCK_EDGE; y++)
		memcpy(&rows[y], (const uint16_t *)from + y * stride, sizeof rows[y]);
	const vi words =
		_mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(rows[1], rows[0])),
				   _mm256_set_m128i(rows[3], rows[2]), 1);
	return _mm512_xor_si512(words, _mm512_set1_epi16((int16_t)0x8000));
}

SIMD void block_load_wide(enum gz_voxel_type type, const void *from, int64_t row, int64_t slice,
			  struct block *block)
{
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : 2;
	for (int z = 0; z < BLOCK_EDGE; z++)
		block->words[z] =
			block_wide_slice(type, (const char *)from + z * slice * bytes, row);
}

/* Load a block whose rows and slices lie these strides apart. */
SIMD void block_load(enum gz_voxel_type type, const void *from, int64_t row, int64_t slice,
		     struct block *block)
{
	if (type == GZ_VOXEL_F32) {
		for (int z = 0; z < BLOCK_EDGE; z++)
			block->slices[z] = block_slice_f32((const float *)from + z * slice, row);
		return;
	}
	for (int half = 0; half < 2; half++) {
		const int64_t low = 2 * half * slice, high = low + slice;
		if (type == GZ_VOXEL_U8) {
			const uint8_t *voxels = from;
			block->words[half] = _mm512_cvtepu8_epi16(
				_mm256_set_m128i(block_slice_u8(voxels + high, row),
						 block_slice_u8(voxels + low, row)));
		} else {
			const uint16_t *voxels = from;
			const vi words = _mm512_inserti64x4(
				_mm512_castsi256_si512(block_slice_u16(voxels + low, row)),
				block_slice_u16(voxels + high, row), 1);
			/* multiplications take signed words */
			block->words[half] =
				_mm512_xor_si512(words, _mm512_set1_epi16((int16_t)0x8000));
		}
	}
}

/* Load the block whose first voxel holds a place (x, y, z), moved into the volume at its rim. */
SIMD void block_take(const struct gz_cast *cast, enum gz_voxel_type type, int wide, __m128 place,
		     struct block *block)
{
	const __m128 last =
		_mm_sub_ps(_mm_setr_ps(cast->dims[0], cast->dims[1], cast->dims[2], BLOCK_EDGE),
			   _mm_setr_ps(block_edge(wide, 0), BLOCK_EDGE, BLOCK_EDGE, BLOCK_EDGE));
	const __m128 base = _mm_min_ps(_mm_max_ps(_mm_floor_ps(place), _mm_setzero_ps()), last);
	block->base[0] = _mm512_broadcastss_ps(base);
	block->base[1] = _mm512_broadcastss_ps(_mm_permute_ps(base, 0x55));
	block->base[2] = _mm512_broadcastss_ps(_mm_permute_ps(base, 0xAA));
	const __m128i first = _mm_cvtps_epi32(base);
	const int64_t row = cast->stride[1], slice = cast->stride[2];
	const int64_t from = _mm_cvtsi128_si32(first) + _mm_extract_epi32(first, 1) * row +
			     _mm_extract_epi32(first, 2) * slice;
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : type == GZ_VOXEL_U16 ? 2 : 4;
	const char *voxels = (const char *)cast->voxels + from * bytes;
	if (wide)
		block_load_wide(type, voxels, row, slice, block);
	else
		block_load(type, voxels, row, slice, block);
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
		places[axis] = _mm512_mask_max_ps(places[axis], at_first, places[axis], vf_set(0));
		places[axis] = _mm512_mask_min_ps(places[axis], at_last, places[axis], most);
	}
}

/* Whether the places of all lanes of mask lie in the block. */
SIMD int block_holds(const vf places[3], int wide, vm mask)
{
	/* As unsigned numbers, floats from 0 up have their order and negative ones lie above. */
	const vi x = vi_bits(places[0]), end = vi_bits(vf_set(BLOCK_EDGE - 1));
	vi most = _mm512_max_epu32(vi_bits(places[1]), vi_bits(places[2]));
	vm beyond = 0;
	if (wide)
		beyond = _mm512_mask_cmpge_epu32_mask(mask, x, vi_bits(vf_set(BLOCK_WIDE - 1)));
	else
		most = _mm512_max_epu32(most, x);
	return !vm_any(vm_or(beyond, _mm512_mask_cmpge_epu32_mask(mask, most, end)));
}

/* Find places within the block. Returns whether those of all lanes of mask lie in it. */
SIMD int block_places(const struct gz_cast *cast, const struct block *block, int wide,
		      const vf at[3], vm mask, vf places[3])
{
	for (int axis = 0; axis < 3; axis++)
		places[axis] = at[axis] - block->base[axis];
	if (__builtin_expect(block_holds(places, wide, mask), 1))
		return 1;
	block_clamp(cast, block, wide, places);
	return block_holds(places, wide, mask);
}

/* Weights of two words: the share of the upper voxel in the high half, the rest in the low half. */
SIMD vi word_weights(vf share)
{
	const vi high = _mm512_cvtps_epi32(share * vf_set(32767));
	const vi both = _mm512_or_si512(_mm512_slli_epi32(high, 16), high);
	return _mm512_xor_si512(both, _mm512_set1_epi32(0x7FFF));
}

SIMD vf mix_words(vi words, vi weights)
{
	return _mm512_cvtepi32_ps(_mm512_madd_epi16(words, weights));
}

/* Four pairs of words, in the order (y, z) = 00, 10, 01, 11. */
SIMD vf mix_pairs(const vi pairs[4], const vf share[3])
{
	const vi weights = word_weights(share[0]);
	const vf v00 = mix_words(pairs[0], weights), v10 = mix_words(pairs[1], weights);
	const vf v01 = mix_words(pairs[2], weights), v11 = mix_words(pairs[3], weights);
	return mix(mix(v00, v10, share[1]), mix(v01, v11, share[1]), share[2]);
}

SIMD vf block_sample_words(const struct block *block, const vf whole[3], const vf share[3])
{
	/* The index of a word in the low half of each lane, of the next word in the high half. */
	const float both = 65537;
	const vi first = _mm512_cvtps_epi32(vf_fma(
		whole[2], vf_set(16 * both),
		vf_fma(whole[1], vf_set(4 * both), vf_fma(whole[0], vf_set(both), vf_set(65536)))));
	static const int offset[4] = { 0, 4 * 65537, 16 * 65537, 20 * 65537 };
	vi pairs[4];
	for (int i = 0; i < 4; i++)
		pairs[i] = _mm512_permutex2var_epi16(
			block->words[0], vi_add(first, vi_set(offset[i])), block->words[1]);
	return mix_pairs(pairs, share);
}

SIMD vf block_sample_wide(const struct block *block, const vf whole[3], const vf share[3])
{
	const float both = 65537;
	const vi first = _mm512_cvtps_epi32(vf_fma(
		whole[2], vf_set(32 * both),
		vf_fma(whole[1], vf_set(8 * both), vf_fma(whole[0], vf_set(both), vf_set(65536)))));
	vi pairs[4];
	for (int i = 0; i < 4; i++) {
		const vi index = vi_add(first, vi_set(((i & 1) * 8 + (i >> 1) * 32) * 65537));
		const vi low = _mm512_permutex2var_epi16(block->words[0], index, block->words[1]);
		const vi high = _mm512_permutex2var_epi16(block->words[2], index, block->words[3]);
		pairs[i] = vi_select(_mm512_test_epi32_mask(index, vi_set(64)), high, low);
	}
	return mix_pairs(pairs, share);
}

SIMD vf block_voxel_f32(const struct block *block, vi index)
{
	const vf low = _mm512_permutex2var_ps(block->slices[0], index, block->slices[1]);
	const vf high = _mm512_permutex2var_ps(block->slices[2], index, block->slices[3]);
	return vf_select(_mm512_test_epi32_mask(index, vi_set(BLOCK_VOXELS / 2)), high, low);
}

SIMD vf block_sample_f32(const struct block *block, const vf whole[3], const vf share[3])
{
	const vi first = _mm512_cvtps_epi32(
		vf_fma(whole[2], vf_set(16), vf_fma(whole[1], vf_set(4), whole[0])));
	vf rows[4];
	for (int i = 0; i < 4; i++) {
		const vi index = vi_add(first, vi_set((i & 1) * 4 + (i >> 1) * 16));
		rows[i] = mix(block_voxel_f32(block, index),
			      block_voxel_f32(block, vi_add(index, vi_set(1))), share[0]);
	}
	return mix(mix(rows[0], rows[1], share[1]), mix(rows[2], rows[3], share[1]), share[2]);
}

/* 16 bits for each lane, from base + index bytes. Single loads take half the time of a gather. */
SIMD __m256i load_halves(const uint8_t *base, const int32_t index[SIMD_LANES])
{
	__m128i half[2];
	for (int i = 0; i < 2; i++, index += SIMD_LANES / 2) {
		uint16_t pair[SIMD_LANES / 2];
		for (int lane = 0; lane < SIMD_LANES / 2; lane++)
			memcpy(&pair[lane], base + index[lane], sizeof pair[lane]);
		half[i] = _mm_setr_epi16((int16_t)pair[0], (int16_t)pair[1], (int16_t)pair[2],
					 (int16_t)pair[3], (int16_t)pair[4], (int16_t)pair[5],
					 (int16_t)pair[6], (int16_t)pair[7]);
	}
	return _mm256_set_m128i(half[1], half[0]);
}

/* 32 bits for each lane, from base + 2 * index bytes. */
SIMD vi load_words(const uint16_t *base, const int32_t index[SIMD_LANES])
{
	__m128i quarter[4];
	for (int i = 0; i < 4; i++, index += SIMD_LANES / 4) {
		int32_t pair[SIMD_LANES / 4];
		for (int lane = 0; lane < SIMD_LANES / 4; lane++)
			memcpy(&pair[lane], base + index[lane], sizeof pair[lane]);
		quarter[i] = _mm_setr_epi32(pair[0], pair[1], pair[2], pair[3]);
	}
	return _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(quarter[1], quarter[0])),
				  _mm256_set_m128i(quarter[3], quarter[2]), 1);
}

/* Two neighbours along x for each lane, as words. */
SIMD vi load_word_pairs(enum gz_voxel_type type, const void *voxels, int64_t from,
			const int32_t index[SIMD_LANES])
{
	if (type == GZ_VOXEL_U8)
		return _mm512_cvtepu8_epi16(load_halves((const uint8_t *)voxels + from, index));
	return _mm512_xor_si512(load_words((const uint16_t *)voxels + from, index),
				vi_set((int32_t)0x80008000));
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
	_mm512_storeu_si512(first, _mm512_maskz_mov_epi32(mask, lane));
	const int64_t up_y = cast->stride[1], up_z = cast->stride[2];
	const vi pairs[4] = {
		load_word_pairs(type, cast->voxels, 0, first),
		load_word_pairs(type, cast->voxels, up_y, first),
		load_word_pairs(type, cast->voxels, up_z, first),
		load_word_pairs(type, cast->voxels, up_y + up_z, first),
	};
	return mix_pairs(pairs, share);
}

/* The values at places within the block, in FETCH_UNITs. */
SIMD vf block_sample(const struct block *block, enum gz_voxel_type type, int wide,
		     const vf places[3])
{
	vf whole[3], share[3];
	for (int axis = 0; axis < 3; axis++) {
		whole[axis] = vf_floor(places[axis]);
		share[axis] = places[axis] - whole[axis];
	}
	if (type == GZ_VOXEL_F32)
		return block_sample_f32(block, whole, share);
	return wide ? block_sample_wide(block, whole, share)
		    : block_sample_words(block, whole, share);
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

#endif
