/* Blocks of voxels in eight-lane registers: cast_block.h explains them, and what is defined here
 * for it. A slice of 4 x 4 voxels fills the table of a byte shuffle, so each lane looks its four
 * neighbours up in all four slices and keeps those of two. */
#ifndef GZ_RENDER_RAYCAST_CPU_BLOCK_AVX2_H
#define GZ_RENDER_RAYCAST_CPU_BLOCK_AVX2_H

/* Widest extent of a tile's rays, voxels, for blocks. */
#define TOGETHER_SPREAD 2.5F

/* The slices' bytes, of 16-bit voxels the low ones. Both halves of a register are alike. */
struct block_voxels {
	vi bytes[BLOCK_EDGE];
	vi high_bytes[BLOCK_EDGE]; /* of 16-bit voxels, less 128 */
};

SIMD int block_exists(enum gz_voxel_type type, int wide)
{
	return !wide && type != GZ_VOXEL_F32;
}

SIMD vi both_halves(__m128i half)
{
	return _mm256_broadcastsi128_si256(half);
}

SIMD void block_slice_u8(const uint8_t *from, int64_t row, vi *bytes)
{
	int32_t rows[BLOCK_EDGE];
	for (int y = 0; y < BLOCK_EDGE; y++)
		memcpy(&rows[y], from + y * row, sizeof rows[y]);
	*bytes = both_halves(_mm_setr_epi32(rows[0], rows[1], rows[2], rows[3]));
}

SIMD void block_slice_u16(const uint16_t *from, int64_t row, vi *low, vi *high)
{
	int64_t rows[BLOCK_EDGE];
	for (int y = 0; y < BLOCK_EDGE; y++)
		memcpy(&rows[y], from + y * row, sizeof rows[y]);
	const __m128i before = _mm_set_epi64x(rows[1], rows[0]);
	const __m128i after = _mm_set_epi64x(rows[3], rows[2]);
	const __m128i byte = _mm_set1_epi16(0xFF);
	*low = both_halves(
		_mm_packus_epi16(_mm_and_si128(before, byte), _mm_and_si128(after, byte)));
	const __m128i upper = _mm_packus_epi16(_mm_srli_epi16(before, 8), _mm_srli_epi16(after, 8));
	*high = both_halves(_mm_xor_si128(upper, _mm_set1_epi8((int8_t)0x80)));
}

SIMD void block_load(enum gz_voxel_type type, int wide, const void *from, int64_t row,
		     int64_t slice, struct block_voxels *block)
{
	(void)wide;
	for (int z = 0; z < BLOCK_EDGE; z++)
		if (type == GZ_VOXEL_U8)
			block_slice_u8((const uint8_t *)from + z * slice, row, &block->bytes[z]);
		else
			block_slice_u16((const uint16_t *)from + z * slice, row, &block->bytes[z],
					&block->high_bytes[z]);
}

/* The bytes that `control` names in the slices below and above a lane. Bits 4 and 5 of each byte of
 * `control` are the number of the slice below, 0 to 2; shuffles ignore them. */
SIMD void block_look_up(const vi slices[BLOCK_EDGE], vi control, vi *below, vi *above)
{
	const vi second = _mm256_cmpgt_epi8(control, vi_set(0x0F0F0F0F));
	const vi third = _mm256_cmpgt_epi8(control, vi_set(0x1F1F1F1F));
	vi found[BLOCK_EDGE];
	for (int z = 0; z < BLOCK_EDGE; z++)
		found[z] = _mm256_shuffle_epi8(slices[z], control);
	*below =
		_mm256_blendv_epi8(_mm256_blendv_epi8(found[0], found[1], second), found[2], third);
	*above =
		_mm256_blendv_epi8(_mm256_blendv_epi8(found[1], found[2], second), found[3], third);
}

/* The number in the block of the voxel at these places. */
SIMD vi block_first(const vf whole[3])
{
	return vi_round(vf_fma(whole[2], vf_set(16), vf_fma(whole[1], vf_set(4), whole[0])));
}

/* In each lane the neighbours (x, y) = 00, 01, 10, 11. */
SIMD void block_pairs_u8(const struct block_voxels *block, vi first, vi pairs[4])
{
	const vi own =
		both_halves(_mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12));
	const vi control = _mm256_add_epi8(_mm256_shuffle_epi8(first, own), vi_set(0x05010400));
	const vi even = vi_set(0x00FF00FF);
	vi side[2];
	block_look_up(block->bytes, control, &side[0], &side[1]);
	for (int z = 0; z < 2; z++) {
		pairs[2 * z] = vi_and(side[z], even);
		pairs[2 * z + 1] = _mm256_srli_epi16(side[z], 8);
	}
}

/* For block_look_up(): in each half of a register the neighbours along x of all its lanes, and
 * those at the next y. So unpacking puts them in order. */
SIMD vi words_control(vi first)
{
	const vi own =
		both_halves(_mm_setr_epi8(0, 0, 4, 4, 8, 8, 12, 12, 0, 0, 4, 4, 8, 8, 12, 12));
	const vi offset =
		both_halves(_mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 4, 5, 4, 5, 4, 5, 4, 5));
	return _mm256_add_epi8(_mm256_shuffle_epi8(first, own), offset);
}

SIMD void block_pairs_u16(const struct block_voxels *block, vi first, vi pairs[4])
{
	const vi control = words_control(first);
	vi low[2], high[2];
	block_look_up(block->bytes, control, &low[0], &low[1]);
	block_look_up(block->high_bytes, control, &high[0], &high[1]);
	for (int z = 0; z < 2; z++) {
		pairs[2 * z] = _mm256_unpacklo_epi8(low[z], high[z]);
		pairs[2 * z + 1] = _mm256_unpackhi_epi8(low[z], high[z]);
	}
}

SIMD void block_pairs(const struct block_voxels *block, enum gz_voxel_type type, int wide,
		      const vf whole[3], vi pairs[4])
{
	(void)wide;
	const vi first = block_first(whole);
	if (type == GZ_VOXEL_U8)
		block_pairs_u8(block, first, pairs);
	else
		block_pairs_u16(block, first, pairs);
}

/* The same for slices of which both halves are alike and only one is kept. */
SIMD void near_look_up(const __m128i slices[BLOCK_EDGE], vi control, vi *below, vi *above)
{
	vi both[BLOCK_EDGE];
	for (int z = 0; z < BLOCK_EDGE; z++)
		both[z] = both_halves(slices[z]);
	block_look_up(both, control, below, above);
}

/* The slices of the blocks around one, a voxel before and after it along each axis: bytes of a
 * voxel. Along z those after it are those before it, two slices on. */
struct near_bytes {
	__m128i x[2][BLOCK_EDGE], y[2][BLOCK_EDGE], z[BLOCK_EDGE + 2];
};

struct near_blocks {
	/* Differences of 8-bit voxels between the blocks before and after one along each axis,
	 * where none is too great for a byte. */
	__m128i along[3][BLOCK_EDGE];
	int exact;              /* they are there; what follows is not */
	struct near_bytes low;  /* of 8-bit voxels the only ones */
	struct near_bytes high; /* of 16-bit voxels, less 128 */
};

/* The first four bytes of four halves. */
SIMD __m128i first_bytes(__m128i two, __m128i next_two)
{
	return _mm_castps_si128(
		_mm_shuffle_ps(_mm_castsi128_ps(two), _mm_castsi128_ps(next_two), 0x88));
}

/* From rows 0 to 3 of a slice, two a register, which begin a voxel before the block. */
SIMD __m128i near_middle(__m128i two, __m128i next_two)
{
	return first_bytes(_mm_srli_epi64(two, 8), _mm_srli_epi64(next_two, 8));
}

/* From rows -1 to 4 of slice z. */
SIMD void near_slice(const __m128i rows[3], int z, struct near_bytes *near)
{
	const __m128i two = _mm_alignr_epi8(rows[1], rows[0], 8);
	const __m128i next_two = _mm_alignr_epi8(rows[2], rows[1], 8);
	near->x[0][z] = first_bytes(two, next_two);
	near->x[1][z] = first_bytes(_mm_srli_epi64(two, 16), _mm_srli_epi64(next_two, 16));
	near->y[0][z] = near_middle(rows[0], rows[1]);
	near->y[1][z] = near_middle(rows[1], rows[2]);
	near->z[z + 1] = near_middle(two, next_two);
}

/* Two rows of eight voxels each, their low bytes and, of 16 bits, their high ones less 128. */
SIMD void near_rows(enum gz_voxel_type type, const char *from, int64_t row, __m128i *low,
		    __m128i *high)
{
	if (type == GZ_VOXEL_U8) {
		*low = near_two_rows(from, row);
		return;
	}
	__m128i first, second;
	memcpy(&first, from, sizeof first);
	memcpy(&second, from + row, sizeof second);
	const __m128i byte = _mm_set1_epi16(0xFF);
	*low = _mm_packus_epi16(_mm_and_si128(first, byte), _mm_and_si128(second, byte));
	*high = _mm_xor_si128(_mm_packus_epi16(_mm_srli_epi16(first, 8), _mm_srli_epi16(second, 8)),
			      _mm_set1_epi8((int8_t)0x80));
}

/* Load the bytes of the blocks around one whose first voxel is at `from`. */
SIMD void near_load_bytes(enum gz_voxel_type type, const char *from, int64_t row, int64_t slice,
			  struct near_blocks *near)
{
	__m128i low[3], high[3];
	for (int z = 0; z < BLOCK_EDGE; z++) {
		const char *rows = from + z * slice - row;
		for (int i = 0; i < 3; i++)
			near_rows(type, rows + 2 * i * row, row, &low[i], &high[i]);
		near_slice(low, z, &near->low);
		if (type != GZ_VOXEL_U8)
			near_slice(high, z, &near->high);
	}
	for (int side = 0; side < 2; side++) {
		const int z = side == 0 ? -1 : BLOCK_EDGE;
		for (int i = 0; i < 2; i++)
			near_rows(type, from + z * slice + 2 * i * row, row, &low[i], &high[i]);
		near->low.z[z + 1] = near_middle(low[0], low[1]);
		if (type != GZ_VOXEL_U8)
			near->high.z[z + 1] = near_middle(high[0], high[1]);
	}
}

/* Two rows each of two slices of 8-bit voxels, less 128. */
SIMD vi near_four_rows(const char *from, int64_t row, int64_t slice)
{
	return vi_xor(_mm256_set_m128i(near_two_rows(from + slice, row), near_two_rows(from, row)),
		      _mm256_set1_epi8((int8_t)0x80));
}

/* In each half the first four bytes of four rows, from byte `first` on. */
#define near_four_bytes(two, next_two, first)                             \
	_mm256_castps_si256(_mm256_shuffle_ps(                            \
		_mm256_castsi256_ps(_mm256_srli_epi64(two, 8 * (first))), \
		_mm256_castsi256_ps(_mm256_srli_epi64(next_two, 8 * (first))), 0x88))

/* Least and greatest bytes. */
struct byte_range {
	vi least, most;
};

/* The differences between signed bytes, which are exact if they are neither -128 nor 127. */
SIMD vi byte_differences(vi after, vi before, struct byte_range *range)
{
	const vi difference = _mm256_subs_epi8(after, before);
	range->least = _mm256_min_epi8(range->least, difference);
	range->most = _mm256_max_epi8(range->most, difference);
	return difference;
}

/* Load the differences around a block of 8-bit voxels, two slices a register. Returns whether all
 * are exact. */
SIMD int near_load_differences(const char *from, int64_t row, int64_t slice,
			       __m128i along[3][BLOCK_EDGE])
{
	struct byte_range range = { vi_set(0), vi_set(0) };
	vi middle[2];
	for (int half = 0; half < 2; half++) {
		vi rows[3];
		for (int i = 0; i < 3; i++)
			rows[i] = near_four_rows(from + 2 * half * slice + (2 * i - 1) * row, row,
						 slice);
		const vi two = _mm256_alignr_epi8(rows[1], rows[0], 8);
		const vi next_two = _mm256_alignr_epi8(rows[2], rows[1], 8);
		middle[half] = near_four_bytes(two, next_two, 1);
		const vi x = byte_differences(near_four_bytes(two, next_two, 2),
					      near_four_bytes(two, next_two, 0), &range);
		const vi y = byte_differences(near_four_bytes(rows[1], rows[2], 1),
					      near_four_bytes(rows[0], rows[1], 1), &range);
		vi_store((uint32_t *)&along[0][2 * half], x);
		vi_store((uint32_t *)&along[1][2 * half], y);
	}
	/* the slices before and after them, in both halves */
	vi ends[2];
	for (int side = 0; side < 2; side++) {
		const char *rows = from + (side == 0 ? -1 : BLOCK_EDGE) * slice;
		ends[side] = near_four_bytes(near_four_rows(rows, row, 0),
					     near_four_rows(rows + 2 * row, row, 0), 1);
	}
	const vi inner = _mm256_permute2x128_si256(middle[0], middle[1], 0x21);
	const vi first = _mm256_permute2x128_si256(ends[0], middle[0], 0x20);
	const vi last = _mm256_permute2x128_si256(middle[1], ends[1], 0x31);
	vi_store((uint32_t *)&along[2][0], byte_differences(inner, first, &range));
	vi_store((uint32_t *)&along[2][2], byte_differences(last, inner, &range));
	const vi low = _mm256_cmpeq_epi8(range.least, _mm256_set1_epi8(INT8_MIN));
	const vi high = _mm256_cmpeq_epi8(range.most, _mm256_set1_epi8(INT8_MAX));
	return _mm256_testz_si256(vi_or(low, high), vi_or(low, high));
}

/* Load the blocks around one whose first voxel is at `from`; strides are in bytes. Rows are read to
 * three voxels beyond what is needed. */
SIMD void near_load_blocks(enum gz_voxel_type type, const char *from, int64_t row, int64_t slice,
			   struct near_blocks *near)
{
	from -= type == GZ_VOXEL_U8 ? 1 : 2;
	near->exact = type == GZ_VOXEL_U8 && near_load_differences(from, row, slice, near->along);
	if (!near->exact)
		near_load_bytes(type, from, row, slice, near);
}

/* The slices of the block before (0) or after (1) along an axis. */
SIMD const __m128i *near_side(const struct near_bytes *near, int axis, int side)
{
	return axis == 0 ? near->x[side] : axis == 1 ? near->y[side] : near->z + 2 * side;
}

/* The unit of near_rows_of(). */
SIMD float near_unit(const struct near_blocks *near, enum gz_voxel_type type)
{
	(void)type;
	return near->exact ? 1 / (256.0F * 32767) : 1.0F / 32767;
}

/* Differences along an axis, weighted along x, in the order (y, z) = 00, 10, 01, 11. `first` is the
 * number of the voxel before each lane's place. */
SIMD void near_rows_of(const struct near_blocks *near, enum gz_voxel_type type, int axis, vi first,
		       vi weights, vi rows[4])
{
	const vi control = words_control(first);
	vi before[2], after[2];
	if (near->exact) {
		const vi zero = vi_set(0);
		near_look_up(near->along[axis], control, &after[0], &after[1]);
		for (int z = 0; z < 2; z++) {
			rows[2 * z] =
				vi_sum_of_products(_mm256_unpacklo_epi8(zero, after[z]), weights);
			rows[2 * z + 1] =
				vi_sum_of_products(_mm256_unpackhi_epi8(zero, after[z]), weights);
		}
		return;
	}
	near_look_up(near_side(&near->low, axis, 0), control, &before[0], &before[1]);
	near_look_up(near_side(&near->low, axis, 1), control, &after[0], &after[1]);
	if (type == GZ_VOXEL_U8) {
		const vi signs = _mm256_set1_epi16((int16_t)0xFF01);
		for (int z = 0; z < 2; z++) {
			const vi pairs[2] = { _mm256_unpacklo_epi8(after[z], before[z]),
					      _mm256_unpackhi_epi8(after[z], before[z]) };
			for (int y = 0; y < 2; y++)
				rows[2 * z + y] = vi_sum_of_products(
					_mm256_maddubs_epi16(pairs[y], signs), weights);
		}
		return;
	}
	vi high_before[2], high_after[2];
	near_look_up(near_side(&near->high, axis, 0), control, &high_before[0], &high_before[1]);
	near_look_up(near_side(&near->high, axis, 1), control, &high_after[0], &high_after[1]);
	for (int z = 0; z < 2; z++) {
		rows[2 * z] = vi_subtract(
			vi_sum_of_products(_mm256_unpacklo_epi8(after[z], high_after[z]), weights),
			vi_sum_of_products(_mm256_unpacklo_epi8(before[z], high_before[z]),
					   weights));
		rows[2 * z + 1] = vi_subtract(
			vi_sum_of_products(_mm256_unpackhi_epi8(after[z], high_after[z]), weights),
			vi_sum_of_products(_mm256_unpackhi_epi8(before[z], high_before[z]),
					   weights));
	}
}

/* There are no blocks of floats. */
SIMD vf block_mix_floats(const struct block_voxels *block, const vf whole[3], const vf share[3])
{
	(void)block, (void)whole, (void)share;
	return vf_set(0);
}

#endif
