/*
 * Sixteen lanes of AVX-512 (F, BW, DQ, VL). The vocabulary of the kernel: vf floats, vi 32-bit
 * integers, vm a mask.
 */
#include <immintrin.h>
#include <stdint.h>
#include <string.h>

#define SIMD_LANES 16
/* registers hold a block of voxels: cast_block.h */
#define SIMD_BLOCKS "render/raycast/cpu/block_avx512.h"

typedef __m512 vf;
typedef __m512i vi;
typedef __mmask16 vm;

#define SIMD static inline __attribute__((always_inline))

SIMD vf vf_set(float x)
{
	return _mm512_set1_ps(x);
}
SIMD vf vf_load(const float *x)
{
	return _mm512_loadu_ps(x);
}
SIMD vf vf_fma(vf a, vf b, vf c)
{
	return _mm512_fmadd_ps(a, b, c);
}
SIMD vf vf_min(vf a, vf b)
{
	return _mm512_min_ps(a, b);
}
SIMD vf vf_max(vf a, vf b)
{
	return _mm512_max_ps(a, b);
}
SIMD vf vf_sqrt(vf a)
{
	return _mm512_sqrt_ps(a);
}
/* 1 / a and 1 / sqrt(a) to 2^-22: the processor's estimates and a step of Newton's. */
SIMD vf vf_inverse(vf a)
{
	const vf estimate = _mm512_rcp14_ps(a);
	return estimate * _mm512_fnmadd_ps(estimate, a, vf_set(2));
}
SIMD vf vf_inverse_root(vf a)
{
	const vf estimate = _mm512_rsqrt14_ps(a);
	const vf half = estimate * vf_set(0.5F);
	return half * _mm512_fnmadd_ps(estimate * a, estimate, vf_set(3));
}
SIMD vf vf_ceil(vf a)
{
	return _mm512_roundscale_ps(a, _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC);
}
SIMD vf vf_floor(vf a)
{
	return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
SIMD vf vf_abs(vf a)
{
	return _mm512_abs_ps(a);
}
SIMD vf vf_select(vm m, vf yes, vf no)
{
	return _mm512_mask_blend_ps(m, no, yes);
}
/* Zero outside the mask. */
SIMD vf vf_keep(vm m, vf a)
{
	return _mm512_maskz_mov_ps(m, a);
}
SIMD vf vf_from_i(vi a)
{
	return _mm512_cvtepi32_ps(a);
}
SIMD vf vf_bits(vi a)
{
	return _mm512_castsi512_ps(a);
}
SIMD vi vi_bits(vf a)
{
	return _mm512_castps_si512(a);
}
SIMD vi vi_set(int32_t x)
{
	return _mm512_set1_epi32(x);
}
SIMD void vf_store(float *x, vf a)
{
	_mm512_storeu_ps(x, a);
}
SIMD vi vi_load(const void *x)
{
	vi a;
	memcpy(&a, x, sizeof a);
	return a;
}
SIMD void vi_store(uint32_t *x, vi a)
{
	_mm512_storeu_si512(x, a);
}
SIMD vi vi_trunc(vf a)
{
	return _mm512_cvttps_epi32(a);
}
SIMD vi vi_round(vf a)
{
	return _mm512_cvtps_epi32(a);
}
SIMD vi vi_add(vi a, vi b)
{
	return _mm512_add_epi32(a, b);
}
SIMD vi vi_mul(vi a, vi b)
{
	return _mm512_mullo_epi32(a, b);
}
SIMD vi vi_and(vi a, vi b)
{
	return _mm512_and_si512(a, b);
}
SIMD vi vi_or(vi a, vi b)
{
	return _mm512_or_si512(a, b);
}
SIMD vi vi_select(vm m, vi yes, vi no)
{
	return _mm512_mask_blend_epi32(m, no, yes);
}
SIMD vi vi_min(vi a, vi b)
{
	return _mm512_min_epi32(a, b);
}
#define vi_shift_right(a, n)    _mm512_srli_epi32((a), (n))
#define vi_shift_right_by(a, n) _mm512_srl_epi32((a), _mm_cvtsi32_si128(n))
#define vi_shift_left(a, n)     _mm512_slli_epi32((a), (n))
SIMD vm vf_less(vf a, vf b)
{
	return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}
SIMD vm vi_nonzero(vi a)
{
	return _mm512_test_epi32_mask(a, a);
}
SIMD vm vm_and(vm a, vm b)
{
	return (vm)(a & b);
}
SIMD vm vm_or(vm a, vm b)
{
	return (vm)(a | b);
}
SIMD vm vm_but(vm a, vm b)
{
	return (vm)(a & ~b);
}
SIMD int vm_any(vm a)
{
	return a != 0;
}
SIMD uint32_t vm_count(vm a)
{
	return (uint32_t)__builtin_popcount(a);
}
SIMD vm vm_all(void)
{
	return (vm)0xFFFF;
}
SIMD vm vm_from_bits(uint32_t bits)
{
	return (vm)bits;
}
/* 32 bits from base + index * scale bytes; lanes outside the mask are zero and touch no memory. */
#define vi_gather(base, index, scale, mask) \
	_mm512_mask_i32gather_epi32(_mm512_setzero_si512(), (mask), (index), (base), (scale))
#define vf_gather(base, index, mask) \
	_mm512_mask_i32gather_ps(_mm512_setzero_ps(), (mask), (index), (base), 4)
/* Two 32-bit words from base + index * 8 bytes; zero outside the mask. */
SIMD void gather_pair(const void *base, vi index, vm mask, vf *first, vi *second)
{
	const vi evens =
		_mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
	const vi odds =
		_mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
	const vi low = _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), (__mmask8)mask,
						   _mm512_castsi512_si256(index), base, 8);
	const vi high = _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), (__mmask8)(mask >> 8),
						    _mm512_extracti64x4_epi64(index, 1), base, 8);
	*first = vf_bits(_mm512_permutex2var_epi32(low, evens, high));
	*second = _mm512_permutex2var_epi32(low, odds, high);
}
/* Eight lanes' 64-bit words from base + index * 8 bytes. */
SIMD vi load_eight(const char *base, const int32_t index[8])
{
	__m128i two[4];
	for (int i = 0; i < 4; i++) {
		int64_t words[2];
		memcpy(&words[0], base + 8 * (int64_t)index[2 * i], sizeof words[0]);
		memcpy(&words[1], base + 8 * (int64_t)index[2 * i + 1], sizeof words[1]);
		two[i] = _mm_set_epi64x(words[1], words[0]);
	}
	return _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(two[1], two[0])),
				  _mm256_set_m128i(two[3], two[2]), 1);
}
/* gather_pair() of all lanes; single loads are faster than gathers. */
SIMD void load_pairs(const void *base, vi index, vf *first, vi *second)
{
	const vi evens =
		_mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
	const vi odds =
		_mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
	int32_t lane[SIMD_LANES];
	_mm512_storeu_si512(lane, index);
	const vi low = load_eight(base, lane), high = load_eight(base, lane + 8);
	*first = vf_bits(_mm512_permutex2var_epi32(low, evens, high));
	*second = _mm512_permutex2var_epi32(low, odds, high);
}

/* What only blocks of voxels and beams need. */

/* 0, 1, 2, ... */
SIMD vf vf_counting(void)
{
	return _mm512_setr_ps(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
/* To the nearest whole number, to the even one of two. */
SIMD vf vf_nearest(vf a)
{
	return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
/* The least and the greatest of the lanes of a mask. */
SIMD float vf_least_of(vf a, vm mask)
{
	return _mm512_mask_reduce_min_ps(mask, a);
}
SIMD float vf_greatest_of(vf a, vm mask)
{
	return _mm512_mask_reduce_max_ps(mask, a);
}
/* Store the lanes of a mask side by side. Writes up to SIMD_LANES floats. Returns how many. */
SIMD int vf_store_packed(float *x, vf a, vm mask)
{
	vf_store(x, _mm512_maskz_compress_ps(mask, a));
	return __builtin_popcount(mask);
}
/* The first lane. */
SIMD float vf_first(vf a)
{
	return _mm512_cvtss_f32(a);
}
/* Change the sign where `sign` is -0. */
SIMD vf vf_flip(vf a, vf sign)
{
	return _mm512_xor_ps(a, sign);
}
SIMD vi vi_subtract_words(vi a, vi b)
{
	return _mm512_sub_epi16(a, b);
}
SIMD vi vi_subtract(vi a, vi b)
{
	return _mm512_sub_epi32(a, b);
}
SIMD vi vi_xor(vi a, vi b)
{
	return _mm512_xor_si512(a, b);
}
SIMD vm vi_less(vi a, vi b)
{
	return _mm512_cmplt_epi32_mask(a, b);
}
SIMD vi vi_shift_right_each(vi a, vi by)
{
	return _mm512_srlv_epi32(a, by);
}
/* The greater of unsigned numbers, and whether a is at least b. */
SIMD vi vi_greater_unsigned(vi a, vi b)
{
	return _mm512_max_epu32(a, b);
}
SIMD vm vi_reaches_unsigned(vi a, vi b)
{
	return _mm512_cmpge_epu32_mask(a, b);
}
/* Of two signed words a lane: low * low + high * high. */
SIMD vi vi_sum_of_products(vi a, vi b)
{
	return _mm512_madd_epi16(a, b);
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

/* For each lane two neighbours of `bytes` a voxel along x, from index + `from`, as words, of 16-bit
 * values less 32768. Single loads are faster than gathers. */
SIMD vi load_word_pairs(int bytes, const void *voxels, int64_t from,
			const int32_t index[SIMD_LANES])
{
	if (bytes == 1)
		return _mm512_cvtepu8_epi16(load_halves((const uint8_t *)voxels + from, index));
	return _mm512_xor_si512(load_words((const uint16_t *)voxels + from, index),
				vi_set((int32_t)0x80008000));
}
