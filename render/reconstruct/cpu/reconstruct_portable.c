/*
 * The row filters in plain C, which the compiler's vectors of four points turn into the baseline
 * instructions of any processor (SSE2 on x86). reconstruct_rows.h explains the scheme.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define POINTS 4

typedef uint8_t vp __attribute__((vector_size(4 * POINTS)));
typedef uint32_t vp_words __attribute__((vector_size(4 * POINTS)));

#define SIMD static inline __attribute__((always_inline))

SIMD vp vp_set(uint32_t point)
{
	return (vp)((vp_words) { 0 } + point);
}
SIMD vp vp_load(const uint32_t *points)
{
	vp a;
	memcpy(&a, points, sizeof a);
	return a;
}
SIMD void vp_store(uint32_t *points, vp a)
{
	memcpy(points, &a, sizeof a);
}
SIMD void vp_stream(uint32_t *points, vp a)
{
	vp_store(points, a);
}
SIMD void vp_settle(void)
{
}
SIMD bool vp_differ(vp a, vp b)
{
	uint64_t x[2], y[2];
	memcpy(x, &a, sizeof x);
	memcpy(y, &b, sizeof y);
	return ((x[0] ^ y[0]) | (x[1] ^ y[1])) != 0;
}
SIMD vp vp_least(vp a, vp b)
{
	const vp less = (vp)(a < b);
	return (a & less) | (b & ~less);
}
SIMD vp vp_greatest(vp a, vp b)
{
	const vp less = (vp)(a < b);
	return (b & less) | (a & ~less);
}
SIMD vp vp_not(vp a)
{
	return ~a;
}
SIMD vp vp_and(vp a, vp b)
{
	return a & b;
}
SIMD vp vp_xor(vp a, vp b)
{
	return a ^ b;
}
SIMD vp vp_or(vp a, vp b)
{
	return a | b;
}
SIMD vp vp_where_same(vp a, vp b, vp c)
{
	return ~(a ^ b) & c;
}
/* Of words, without the bits that come from the byte above. */
#define vp_shift_right(a, n) ((vp)((vp_words)(a) >> (n)) & (uint8_t)(255 >> (n)))
SIMD vp vp_quarter(vp a)
{
	return vp_shift_right(a, 2);
}
SIMD vp vp_mean(vp a, vp b)
{
	return (a | b) - vp_shift_right(a ^ b, 1);
}
SIMD vp vp_add(vp a, vp b)
{
	const vp sum = a + b;
	return sum | (vp)(sum < a);
}
SIMD vp vp_but(vp a, vp b)
{
	return (a - b) & (vp)(a > b);
}
#define vp_from(n, a, b) \
	((vp)__builtin_shufflevector((vp_words)(a), (vp_words)(b), (n), (n) + 1, (n) + 2, (n) + 3))
SIMD void vp_interleave(vp a, vp b, vp *first, vp *second)
{
	*first = (vp)__builtin_shufflevector((vp_words)a, (vp_words)b, 0, 4, 1, 5);
	*second = (vp)__builtin_shufflevector((vp_words)a, (vp_words)b, 2, 6, 3, 7);
}
SIMD vp vp_alternate(vp even, vp odd)
{
	return (vp)__builtin_shufflevector((vp_words)even, (vp_words)odd, 0, 5, 2, 7);
}

#include "render/reconstruct/cpu/reconstruct_rows.h"
#include "render/reconstruct/cpu/reconstruct_spans.h"

const struct gz_row_filters gz_row_filters_portable = GZ_ROW_FILTERS("portable");
