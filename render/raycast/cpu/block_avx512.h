/* Blocks of voxels in sixteen-lane registers: cast_block.h explains them, and what is defined here
 * for it. */
#ifndef GZ_RENDER_RAYCAST_CPU_BLOCK_AVX512_H
#define GZ_RENDER_RAYCAST_CPU_BLOCK_AVX512_H

/* Widest extent of a tile's rays, voxels, for blocks. Chosen by measuring: up to 2 a block holds
 * all rays wherever they are, at 3 only by chance, and single loads serve the rest. */
#define TOGETHER_SPREAD 2.5F

struct block_voxels {
	union {
		vi words[BLOCK_EDGE]; /* of 8 and 16 bits: two slices a word, wide one */
		vf slices[BLOCK_EDGE];
	};
};

SIMD int block_exists(enum gz_voxel_type type, int wide)
{
	return !(wide && type == GZ_VOXEL_F32);
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
			  struct block_voxels *block)
{
	const int64_t bytes = type == GZ_VOXEL_U8 ? 1 : 2;
	for (int z = 0; z < BLOCK_EDGE; z++)
		block->words[z] =
			block_wide_slice(type, (const char *)from + z * slice * bytes, row);
}

SIMD void block_load(enum gz_voxel_type type, int wide, const void *from, int64_t row,
		     int64_t slice, struct block_voxels *block)
{
	if (wide) {
		block_load_wide(type, from, row, slice, block);
		return;
	}
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

/* The number in the block of the word at these places in the low half of each lane, of the next
 * word in the high half. */
SIMD vi block_first(const vf whole[3])
{
	const float both = 65537;
	return _mm512_cvtps_epi32(vf_fma(
		whole[2], vf_set(16 * both),
		vf_fma(whole[1], vf_set(4 * both), vf_fma(whole[0], vf_set(both), vf_set(65536)))));
}

/* Pairs of words of four slices, two a register, in the order (y, z) = 00, 10, 01, 11. */
SIMD void pairs_of_words(const vi words[2], vi first, vi pairs[4])
{
	static const int offset[4] = { 0, 4 * 65537, 16 * 65537, 20 * 65537 };
	for (int i = 0; i < 4; i++)
		pairs[i] = _mm512_permutex2var_epi16(words[0], vi_add(first, vi_set(offset[i])),
						     words[1]);
}

SIMD void block_pairs_wide(const struct block_voxels *block, const vf whole[3], vi pairs[4])
{
	const float both = 65537;
	const vi first = _mm512_cvtps_epi32(vf_fma(
		whole[2], vf_set(32 * both),
		vf_fma(whole[1], vf_set(8 * both), vf_fma(whole[0], vf_set(both), vf_set(65536)))));
	for (int i = 0; i < 4; i++) {
		const vi index = vi_add(first, vi_set(((i & 1) * 8 + (i >> 1) * 32) * 65537));
		const vi low = _mm512_permutex2var_epi16(block->words[0], index, block->words[1]);
		const vi high = _mm512_permutex2var_epi16(block->words[2], index, block->words[3]);
		pairs[i] = vi_select(_mm512_test_epi32_mask(index, vi_set(64)), high, low);
	}
}

SIMD void block_pairs(const struct block_voxels *block, enum gz_voxel_type type, int wide,
		      const vf whole[3], vi pairs[4])
{
	(void)type;
	if (wide)
		block_pairs_wide(block, whole, pairs);
	else
		pairs_of_words(block->words, block_first(whole), pairs);
}

/* Differences between the blocks a voxel before and after one along each axis, as words, two slices
 * a register. */
struct near_blocks {
	vi along[3][2];
	int exact; /* none is too great for a word */
};

/* Four rows of eight 16-bit voxels, less 32768. */
SIMD vi near_four_rows(const __m128i rows[4])
{
	const vi words =
		_mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(rows[1], rows[0])),
				   _mm256_set_m128i(rows[3], rows[2]), 1);
	return _mm512_xor_si512(words, _mm512_set1_epi16((int16_t)0x8000));
}

/* Rows 0 to 3 of a slice as words. */
SIMD vi near_slice(enum gz_voxel_type type, const char *from, int64_t row)
{
	if (type == GZ_VOXEL_U8)
		return _mm512_cvtepu8_epi16(_mm256_set_m128i(near_two_rows(from + 2 * row, row),
							     near_two_rows(from, row)));
	__m128i rows[4];
	for (int y = 0; y < 4; y++)
		memcpy(&rows[y], from + y * row, sizeof rows[y]);
	return near_four_rows(rows);
}

/* Rows -1 to 2 and 1 to 4 of a slice as words. */
SIMD void near_two_slices(enum gz_voxel_type type, const char *from, int64_t row, vi *before,
			  vi *after)
{
	if (type == GZ_VOXEL_U8) {
		const __m128i middle = near_two_rows(from + row, row);
		*before = _mm512_cvtepu8_epi16(
			_mm256_set_m128i(middle, near_two_rows(from - row, row)));
		*after = _mm512_cvtepu8_epi16(
			_mm256_set_m128i(near_two_rows(from + 3 * row, row), middle));
		return;
	}
	__m128i rows[6];
	for (int y = 0; y < 6; y++)
		memcpy(&rows[y], from + (y - 1) * row, sizeof rows[y]);
	*before = near_four_rows(rows);
	*after = near_four_rows(rows + 2);
}

/* The first four words of each row of two slices. */
SIMD vi near_compact(vi slice, vi next_slice)
{
	const vi evens = _mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14);
	return _mm512_permutex2var_epi64(slice, evens, next_slice);
}

/* Load the blocks around one whose first voxel is at `from`; strides are in bytes. Rows are read to
 * three voxels beyond what is needed. */
SIMD void near_load_blocks(enum gz_voxel_type type, const char *from, int64_t row, int64_t slice,
			   struct near_blocks *near)
{
	vi x[BLOCK_EDGE], y[BLOCK_EDGE], z[BLOCK_EDGE], middle[BLOCK_EDGE + 2];
	from -= type == GZ_VOXEL_U8 ? 1 : 2;
	middle[0] = near_slice(type, from - slice, row);
	middle[BLOCK_EDGE + 1] = near_slice(type, from + BLOCK_EDGE * slice, row);
	for (int i = 0; i < BLOCK_EDGE; i++) {
		vi before, after;
		near_two_slices(type, from + i * slice, row, &before, &after);
		/* rows 0 and 1 of one, 2 and 3 of the other */
		middle[i + 1] = _mm512_shuffle_i64x2(before, after, 0x99);
		x[i] = _mm512_subs_epi16(_mm512_bsrli_epi128(middle[i + 1], 4), middle[i + 1]);
		y[i] = _mm512_bsrli_epi128(_mm512_subs_epi16(after, before), 2);
	}
	for (int i = 0; i < BLOCK_EDGE; i++)
		z[i] = _mm512_bsrli_epi128(_mm512_subs_epi16(middle[i + 2], middle[i]), 2);
	__mmask32 beyond = 0;
	for (int half = 0; half < 2; half++) {
		near->along[0][half] = near_compact(x[2 * half], x[2 * half + 1]);
		near->along[1][half] = near_compact(y[2 * half], y[2 * half + 1]);
		near->along[2][half] = near_compact(z[2 * half], z[2 * half + 1]);
		for (int axis = 0; axis < 3 && type != GZ_VOXEL_U8; axis++)
			beyond |= _mm512_cmpge_epu16_mask(_mm512_abs_epi16(near->along[axis][half]),
							  _mm512_set1_epi16(INT16_MAX));
	}
	near->exact = beyond == 0;
}

/* The unit of near_rows_of(); 0: there are no differences. */
SIMD float near_unit(const struct near_blocks *near, enum gz_voxel_type type)
{
	return type == GZ_VOXEL_U8 || near->exact ? 1.0F / 32767 : 0;
}

/* Differences along an axis, weighted along x, in the order (y, z) = 00, 10, 01, 11. `first` is the
 * number of the voxel before each lane's place. */
SIMD void near_rows_of(const struct near_blocks *near, enum gz_voxel_type type, int axis, vi first,
		       vi weights, vi rows[4])
{
	vi pairs[4];
	(void)type;
	pairs_of_words(near->along[axis], first, pairs);
	for (int i = 0; i < 4; i++)
		rows[i] = vi_sum_of_products(pairs[i], weights);
}

SIMD vf block_voxel_f32(const struct block_voxels *block, vi index)
{
	const vf low = _mm512_permutex2var_ps(block->slices[0], index, block->slices[1]);
	const vf high = _mm512_permutex2var_ps(block->slices[2], index, block->slices[3]);
	return vf_select(_mm512_test_epi32_mask(index, vi_set(BLOCK_VOXELS / 2)), high, low);
}

SIMD vf block_mix_floats(const struct block_voxels *block, const vf whole[3], const vf share[3])
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

#endif
