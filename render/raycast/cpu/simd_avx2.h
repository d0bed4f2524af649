/* Eight lanes of AVX2 with FMA: the vocabulary of simd_avx512.h. A mask is all ones or all zeros a
 * lane. */
#include <immintrin.h>
#include <stdint.h>
#include <string.h>

#define SIMD_LANES 8
/* registers hold a block of voxels: cast_block.h */
#define SIMD_BLOCKS "render/raycast/cpu/block_avx2.h"

typedef __m256 vf;
typedef __m256i vi;
typedef __m256 vm;

#define SIMD static inline __attribute__((always_inline))

SIMD vf vf_set(float x)
{
	return _mm256_set1_ps(x);
}
SIMD vf vf_load(const float *x)
{
	return _mm256_loadu_ps(x);
}
SIMD vf vf_fma(vf a, vf b, vf c)
{
	return _mm256_fmadd_ps(a, b, c);
}
SIMD vf vf_min(vf a, vf b)
{
	return _mm256_min_ps(a, b);
}
SIMD vf vf_max(vf a, vf b)
{
	return _mm256_max_ps(a, b);
}
SIMD vf vf_sqrt(vf a)
{
	return _mm256_sqrt_ps(a);
}
/* 1 / a and 1 / sqrt(a) to 2^-22: the processor's estimates and a step of Newton's. */
SIMD vf vf_inverse(vf a)
{
	const vf estimate = _mm256_rcp_ps(a);
	return estimate * _mm256_fnmadd_ps(estimate, a, vf_set(2));
}
SIMD vf vf_inverse_root(vf a)
{
	const vf estimate = _mm256_rsqrt_ps(a);
	const vf half = estimate * vf_set(0.5F);
	return half * _mm256_fnmadd_ps(estimate * a, estimate, vf_set(3));
}
SIMD vf vf_ceil(vf a)
{
	return _mm256_ceil_ps(a);
}
SIMD vf vf_floor(vf a)
{
	return _mm256_floor_ps(a);
}
SIMD vf vf_abs(vf a)
{
	return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), a);
}
SIMD vf vf_select(vm m, vf yes, vf no)
{
	return _mm256_blendv_ps(no, yes, m);
}
/* Zero outside the mask. */
SIMD vf vf_keep(vm m, vf a)
{
	return _mm256_and_ps(m, a);
}
SIMD vf vf_from_i(vi a)
{
	return _mm256_cvtepi32_ps(a);
}
SIMD vf vf_bits(vi a)
{
	return _mm256_castsi256_ps(a);
}
SIMD vi vi_bits(vf a)
{
	return _mm256_castps_si256(a);
}
SIMD vi vi_set(int32_t x)
{
	return _mm256_set1_epi32(x);
}
SIMD void vf_store(float *x, vf a)
{
	_mm256_storeu_ps(x, a);
}
SIMD vi vi_load(const void *x)
{
	vi a;
	memcpy(&a, x, sizeof a);
	return a;
}
SIMD void vi_store(uint32_t *x, vi a)
{
	_mm256_storeu_si256((__m256i *)x, a);
}
SIMD vi vi_trunc(vf a)
{
	return _mm256_cvttps_epi32(a);
}
SIMD vi vi_round(vf a)
{
	return _mm256_cvtps_epi32(a);
}
SIMD vi vi_add(vi a, vi b)
{
	return _mm256_add_epi32(a, b);
}
SIMD vi vi_mul(vi a, vi b)
{
	return _mm256_mullo_epi32(a, b);
}
SIMD vi vi_and(vi a, vi b)
{
	return _mm256_and_si256(a, b);
}
SIMD vi vi_or(vi a, vi b)
{
	return _mm256_or_si256(a, b);
}
SIMD vi vi_select(vm m, vi yes, vi no)
{
	return _mm256_castps_si256(
		_mm256_blendv_ps(_mm256_castsi256_ps(no), _mm256_castsi256_ps(yes), m));
}
SIMD vi vi_min(vi a, vi b)
{
	return _mm256_min_epi32(a, b);
}
#define vi_shift_right(a, n)    _mm256_srli_epi32((a), (n))
#define vi_shift_right_by(a, n) _mm256_srl_epi32((a), _mm_cvtsi32_si128(n))
#define vi_shift_left(a, n)     _mm256_slli_epi32((a), (n))
SIMD vm vf_less(vf a, vf b)
{
	return _mm256_cmp_ps(a, b, _CMP_LT_OQ);
}
SIMD vm vi_nonzero(vi a)
{
	const vi zero = _mm256_cmpeq_epi32(a, _mm256_setzero_si256());
	return _mm256_castsi256_ps(_mm256_xor_si256(zero, _mm256_set1_epi32(-1)));
}
SIMD vm vm_and(vm a, vm b)
{
	return _mm256_and_ps(a, b);
}
SIMD vm vm_or(vm a, vm b)
{
	return _mm256_or_ps(a, b);
}
SIMD vm vm_but(vm a, vm b)
{
	return _mm256_andnot_ps(b, a);
}
SIMD int vm_any(vm a)
{
	return _mm256_movemask_ps(a) != 0;
}
SIMD uint32_t vm_count(vm a)
{
	return (uint32_t)__builtin_popcount((unsigned)_mm256_movemask_ps(a));
}
SIMD vm vm_all(void)
{
	return _mm256_castsi256_ps(_mm256_set1_epi32(-1));
}
SIMD vm vm_from_bits(uint32_t bits)
{
	const vi bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
	return _mm256_castsi256_ps(
		_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), bit), bit));
}
#define vi_gather(base, index, scale, mask)                                               \
	_mm256_mask_i32gather_epi32(_mm256_setzero_si256(), (const int *)(base), (index), \
				    _mm256_castps_si256(mask), (scale))
#define vf_gather(base, index, mask) \
	_mm256_mask_i32gather_ps(_mm256_setzero_ps(), (base), (index), (mask), 4)
/* Two 32-bit words from base + index * 8 bytes; zero outside the mask. */
SIMD void gather_pair(const void *base, vi index, vm mask, vf *first, vi *second)
{
	const vi wide = _mm256_castps_si256(mask);
	const vi low = _mm256_mask_i32gather_epi64(
		_mm256_setzero_si256(), (const long long *)base, _mm256_castsi256_si128(index),
		_mm256_cvtepi32_epi64(_mm256_castsi256_si128(wide)), 8);
	const vi high = _mm256_mask_i32gather_epi64(
		_mm256_setzero_si256(), (const long long *)base, _mm256_extracti128_si256(index, 1),
		_mm256_cvtepi32_epi64(_mm256_extracti128_si256(wide, 1)), 8);
	/* shuffles work in halves: put the quarters in order afterwards */
	const vf a = _mm256_castsi256_ps(low), b = _mm256_castsi256_ps(high);
	const __m256d evens = _mm256_castps_pd(_mm256_shuffle_ps(a, b, 0x88));
	const __m256d odds = _mm256_castps_pd(_mm256_shuffle_ps(a, b, 0xDD));
	*first = _mm256_castpd_ps(_mm256_permute4x64_pd(evens, 0xD8));
	*second = _mm256_castpd_si256(_mm256_permute4x64_pd(odds, 0xD8));
}
/* Two lanes' 64-bit words from base + index * 8 bytes. */
SIMD __m128 load_two(const char *base, int32_t first, int32_t second)
{
	int64_t words[2];
	memcpy(&words[0], base + 8 * (int64_t)first, sizeof words[0]);
	memcpy(&words[1], base + 8 * (int64_t)second, sizeof words[1]);
	return _mm_castsi128_ps(_mm_set_epi64x(words[1], words[0]));
}
/* gather_pair() of all lanes; single loads are faster than gathers. */
SIMD void load_pairs(const void *base, vi index, vf *first, vi *second)
{
	int32_t lane[SIMD_LANES];
	memcpy(lane, &index, sizeof lane);
	/* so that shuffles, which work in halves, leave the lanes in order */
	const vf even =
		_mm256_set_m128(load_two(base, lane[4], lane[5]), load_two(base, lane[0], lane[1]));
	const vf odd =
		_mm256_set_m128(load_two(base, lane[6], lane[7]), load_two(base, lane[2], lane[3]));
	*first = _mm256_shuffle_ps(even, odd, 0x88);
	*second = _mm256_castps_si256(_mm256_shuffle_ps(even, odd, 0xDD));
}

/* What only blocks of voxels and beams need. */

/* 0, 1, 2, ... */
SIMD vf vf_counting(void)
{
	return _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
}
/* To the nearest whole number, to the even one of two. */
SIMD vf vf_nearest(vf a)
{
	return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
/* The least and the greatest of the lanes of a mask. */
SIMD float vf_least_of(vf a, vm mask)
{
	const vf kept = vf_select(mask, a, vf_set(__builtin_inff()));
	__m128 least = _mm_min_ps(_mm256_castps256_ps128(kept), _mm256_extractf128_ps(kept, 1));
	least = _mm_min_ps(least, _mm_movehl_ps(least, least));
	return _mm_cvtss_f32(_mm_min_ss(least, _mm_movehdup_ps(least)));
}
SIMD float vf_greatest_of(vf a, vm mask)
{
	return -vf_least_of(vf_set(0) - a, mask);
}
/* Store the lanes of a mask side by side. Writes up to SIMD_LANES floats. Returns how many. */
SIMD int vf_store_packed(float *x, vf a, vm mask)
{
	float lane[SIMD_LANES];
	int count = 0;
	_mm256_storeu_ps(lane, a);
	for (unsigned bits = (unsigned)_mm256_movemask_ps(mask); bits; bits &= bits - 1)
		x[count++] = lane[__builtin_ctz(bits)];
	return count;
}
/* The first lane. */
SIMD float vf_first(vf a)
{
	return _mm256_cvtss_f32(a);
}
/* Change the sign where `sign` is -0. */
SIMD vf vf_flip(vf a, vf sign)
{
	return _mm256_xor_ps(a, sign);
}
SIMD vi vi_subtract_words(vi a, vi b)
{
	return _mm256_sub_epi16(a, b);
}
SIMD vi vi_subtract(vi a, vi b)
{
	return _mm256_sub_epi32(a, b);
}
SIMD vi vi_xor(vi a, vi b)
{
	return _mm256_xor_si256(a, b);
}
SIMD vm vi_less(vi a, vi b)
{
	return _mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a));
}
SIMD vi vi_shift_right_each(vi a, vi by)
{
	return _mm256_srlv_epi32(a, by);
}
/* The greater of unsigned numbers, and whether a is at least b. */
SIMD vi vi_greater_unsigned(vi a, vi b)
{
	return _mm256_max_epu32(a, b);
}
SIMD vm vi_reaches_unsigned(vi a, vi b)
{
	return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_max_epu32(a, b), a));
}
/* Of two signed words a lane: low * low + high * high. */
SIMD vi vi_sum_of_products(vi a, vi b)
{
	return _mm256_madd_epi16(a, b);
}
/* For each lane two neighbours of `bytes` a voxel along x, from index + `from`, as words, of 16-bit
 * values less 32768. Single loads are faster than gathers. */
SIMD vi load_word_pairs(int bytes, const void *voxels, int64_t from,
			const int32_t index[SIMD_LANES])
{
	if (bytes == 1) {
		const uint8_t *base = (const uint8_t *)voxels + from;
		uint16_t pair[SIMD_LANES];
		for (int lane = 0; lane < SIMD_LANES; lane++)
			memcpy(&pair[lane], base + index[lane], sizeof pair[lane]);
		return _mm256_cvtepu8_epi16(_mm_setr_epi16(
			(int16_t)pair[0], (int16_t)pair[1], (int16_t)pair[2], (int16_t)pair[3],
			(int16_t)pair[4], (int16_t)pair[5], (int16_t)pair[6], (int16_t)pair[7]));
	}
	const uint16_t *base = (const uint16_t *)voxels + from;
	int32_t pair[SIMD_LANES];
	for (int lane = 0; lane < SIMD_LANES; lane++)
		memcpy(&pair[lane], base + index[lane], sizeof pair[lane]);
	return vi_xor(_mm256_setr_epi32(pair[0], pair[1], pair[2], pair[3], pair[4], pair[5],
					pair[6], pair[7]),
		      vi_set((int32_t)0x80008000));
}
