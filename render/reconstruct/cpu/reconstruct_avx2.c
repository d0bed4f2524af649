/* The row filters with AVX2, eight points in a register. reconstruct_rows.h explains the scheme. */
#include <immintrin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define POINTS 8

typedef __m256i vp;

#define SIMD static inline __attribute__((always_inline))

SIMD vp vp_set(uint32_t point)
{
	return _mm256_set1_epi32((int)point);
}
SIMD vp vp_load(const uint32_t *points)
{
	return _mm256_loadu_si256((const void *)points);
}
SIMD void vp_store(uint32_t *points, vp a)
{
	_mm256_storeu_si256((void *)points, a);
}
SIMD void vp_stream(uint32_t *points, vp a)
{
	_mm256_stream_si256((void *)points, a);
}
SIMD void vp_settle(void)
{
	_mm_sfence();
}
SIMD bool vp_differ(vp a, vp b)
{
	const vp difference = _mm256_xor_si256(a, b);
	return !_mm256_testz_si256(difference, difference);
}
SIMD vp vp_mean(vp a, vp b)
{
	return _mm256_avg_epu8(a, b);
}
SIMD vp vp_add(vp a, vp b)
{
	return _mm256_adds_epu8(a, b);
}
SIMD vp vp_but(vp a, vp b)
{
	return _mm256_subs_epu8(a, b);
}
SIMD vp vp_least(vp a, vp b)
{
	return _mm256_min_epu8(a, b);
}
SIMD vp vp_greatest(vp a, vp b)
{
	return _mm256_max_epu8(a, b);
}
SIMD vp vp_not(vp a)
{
	return _mm256_xor_si256(a, _mm256_set1_epi32(-1));
}
SIMD vp vp_and(vp a, vp b)
{
	return _mm256_and_si256(a, b);
}
SIMD vp vp_xor(vp a, vp b)
{
	return _mm256_xor_si256(a, b);
}
SIMD vp vp_or(vp a, vp b)
{
	return _mm256_or_si256(a, b);
}
SIMD vp vp_where_same(vp a, vp b, vp c)
{
	return _mm256_andnot_si256(_mm256_xor_si256(a, b), c);
}
SIMD vp vp_quarter(vp a)
{
	return _mm256_and_si256(_mm256_srli_epi16(a, 2), _mm256_set1_epi8(0x3F));
}
#define vp_from(n, a, b) _mm256_alignr_epi8(_mm256_permute2x128_si256(a, b, 0x21), a, 4 * (n))
SIMD void vp_interleave(vp a, vp b, vp *first, vp *second)
{
	const vp low = _mm256_unpacklo_epi32(a, b), high = _mm256_unpackhi_epi32(a, b);
	*first = _mm256_permute2x128_si256(low, high, 0x20);
	*second = _mm256_permute2x128_si256(low, high, 0x31);
}
SIMD vp vp_alternate(vp even, vp odd)
{
	return _mm256_blend_epi32(even, odd, 0xAA);
}

#include "render/reconstruct/cpu/reconstruct_rows.h"
#include "render/reconstruct/cpu/reconstruct_spans.h"

const struct gz_row_filters gz_row_filters_avx2 = GZ_ROW_FILTERS("avx2");
