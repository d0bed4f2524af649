/* Eight lanes of AVX2 with FMA: the vocabulary of simd_avx512.h. A mask is all ones or all zeros a
 * lane. */
#include <immintrin.h>
#include <stdint.h>
#include <string.h>

#define SIMD_LANES   8
#define SIMD_GATHERS /* a look-up for each sample is cheap: fine_cells.h */

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
/* gather_pair() of all lanes. */
SIMD void load_pairs(const void *base, vi index, vf *first, vi *second)
{
	gather_pair(base, index, vm_all(), first, second);
}
