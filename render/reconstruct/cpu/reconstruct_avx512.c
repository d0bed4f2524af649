/*
 * The row filters with AVX-512 (F, BW), sixteen points in a register. reconstruct_rows.h explains
 * the scheme.
 */
#include <immintrin.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define POINTS 16

typedef __m512i vp;

#define SIMD static inline __attribute__((always_inline))

SIMD vp vp_set(uint32_t point)
{
	return _mm512_set1_epi32((int)point);
}
SIMD vp vp_load(const uint32_t *points)
{
	return _mm512_loadu_si512(points);
}
SIMD void vp_store(uint32_t *points, vp a)
{
	_mm512_storeu_si512(points, a);
}
/* Write past the caches; aligned to the register. */
SIMD void vp_stream(uint32_t *points, vp a)
{
	_mm512_stream_si512((void *)points, a);
}
/* Make streamed points visible to other threads. */
SIMD void vp_settle(void)
{
	_mm_sfence();
}
SIMD bool vp_differ(vp a, vp b)
{
	return _mm512_cmpneq_epi32_mask(a, b) != 0;
}
/* (a + b + 1) / 2, byte by byte as all arithmetic here */
SIMD vp vp_mean(vp a, vp b)
{
	return _mm512_avg_epu8(a, b);
}
/* Saturates at 255. */
SIMD vp vp_add(vp a, vp b)
{
	return _mm512_adds_epu8(a, b);
}
/* Saturates at 0. */
SIMD vp vp_but(vp a, vp b)
{
	return _mm512_subs_epu8(a, b);
}
SIMD vp vp_least(vp a, vp b)
{
	return _mm512_min_epu8(a, b);
}
SIMD vp vp_greatest(vp a, vp b)
{
	return _mm512_max_epu8(a, b);
}
SIMD vp vp_not(vp a)
{
	return _mm512_ternarylogic_epi32(a, a, a, 0x55);
}
SIMD vp vp_and(vp a, vp b)
{
	return _mm512_and_si512(a, b);
}
SIMD vp vp_xor(vp a, vp b)
{
	return _mm512_xor_si512(a, b);
}
SIMD vp vp_or(vp a, vp b)
{
	return _mm512_or_si512(a, b);
}
/* The bits of c where those of a and b agree. */
SIMD vp vp_where_same(vp a, vp b, vp c)
{
	return _mm512_ternarylogic_epi32(a, b, c, 0x82);
}
SIMD vp vp_quarter(vp a)
{
	return _mm512_and_si512(_mm512_srli_epi16(a, 2), _mm512_set1_epi8(0x3F));
}
/* Points n, n + 1... of a followed by b; n is constant, 1 to 3. */
#define vp_from(n, a, b) _mm512_alignr_epi32(b, a, n)
/* a0 b0 a1 b1... */
SIMD void vp_interleave(vp a, vp b, vp *first, vp *second)
{
	const vp low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
	const vp high =
		_mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
	*first = _mm512_permutex2var_epi32(a, low, b);
	*second = _mm512_permutex2var_epi32(a, high, b);
}
/* Points 0, 2... of `even` and 1, 3... of `odd`. */
SIMD vp vp_alternate(vp even, vp odd)
{
	return _mm512_mask_blend_epi32(0xAAAA, even, odd);
}

#include "render/reconstruct/cpu/reconstruct_rows.h"
#include "render/reconstruct/cpu/reconstruct_spans.h"

const struct gz_row_filters gz_row_filters_avx512 = GZ_ROW_FILTERS("avx512");
