/*
 * The row filters of the pyramid (docs/foveation.md gives their formulas). Included by one file an
 * instruction set and compiled with its flags: loops of constant length over whole numbers, which
 * the compiler turns into vectors and which give the same bits everywhere.
 */
#include "render/cpu/reconstruct.h"

#include <stdbool.h>
#include <string.h>

/* Points and bytes at a time. */
enum { CHUNK = GZ_ROW_CHUNK, BYTES = 4 * CHUNK };

static inline const uint8_t *bytes_of(const uint32_t *points)
{
	return (const uint8_t *)points;
}

static inline uint8_t least(uint8_t a, uint8_t b)
{
	return a < b ? a : b;
}

static inline uint8_t greatest(uint8_t a, uint8_t b)
{
	return a > b ? a : b;
}

/* (a + b + 1) / 2 */
static inline uint8_t mean_of_2(uint8_t a, uint8_t b)
{
	return (uint8_t)((a + b + 1) >> 1);
}

/* (a + b + c + d + 2) / 4: the mean of two means, less what both have rounded up too often. All in
 * 8 bits, of which a register holds most. */
static inline uint8_t mean_of_4(uint8_t a, uint8_t b, uint8_t c, uint8_t d)
{
	const uint8_t first = mean_of_2(a, b), second = mean_of_2(c, d);
	const uint8_t odd = (uint8_t)(((a ^ b) | (c ^ d)) & (first ^ second) & 1);
	return (uint8_t)(mean_of_2(first, second) - odd);
}

/* (a + b) / 2 */
static inline uint8_t mean_of_2_down(uint8_t a, uint8_t b)
{
	return (uint8_t)(mean_of_2(a, b) - ((a ^ b) & 1));
}

/* Catmull-Rom at 1/2 between b and c, with a before and d behind; never outside of [b, c]. With m
 * and n the means of b, c and of a, d it is m and an eighth of m - n, which takes 9 bits: half of
 * it above -256 takes 8. */
static inline uint8_t cubic(uint8_t a, uint8_t b, uint8_t c, uint8_t d)
{
	const uint8_t m = mean_of_2(b, c), n = mean_of_2(a, d);
	const uint8_t odd = (b ^ c) & 1; /* m was rounded up */
	const uint8_t quarter = (uint8_t)(mean_of_2(m, (uint8_t)~n) >> 1);
	const uint8_t eighth = mean_of_2((uint8_t)(greatest(quarter, odd) - odd), 0);
	const uint8_t up = (uint8_t)(greatest(eighth, 32) - 32);
	const uint8_t down = (uint8_t)(32 - least(eighth, 32));
	const uint8_t room_up = (uint8_t)(greatest(b, c) - m);
	const uint8_t room_down = (uint8_t)(m - least(b, c));
	return (uint8_t)(m + least(up, room_up) - least(down, room_down));
}

static void cubic_between(const uint32_t *const rows[4], uint32_t *out, int count)
{
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *a = bytes_of(rows[0] + i), *b = bytes_of(rows[1] + i);
		const uint8_t *c = bytes_of(rows[2] + i), *d = bytes_of(rows[3] + i);
		uint8_t *to = (uint8_t *)(out + i);
		uint8_t values[BYTES];
		for (int k = 0; k < BYTES; k++)
			values[k] = cubic(a[k], b[k], c[k], d[k]);
		memcpy(to, values, BYTES);
	}
}

/* Compilers do not find the shuffles by themselves. */
typedef uint32_t points_8 __attribute__((vector_size(32)));

static inline void interleave(const uint32_t *even, const uint32_t *odd, uint32_t *out)
{
	for (int k = 0; k < CHUNK; k += 8) {
		points_8 a, b;
		memcpy(&a, even + k, sizeof a);
		memcpy(&b, odd + k, sizeof b);
		const points_8 low = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
		const points_8 high = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
		memcpy(out + 2 * k, &low, sizeof low);
		memcpy(out + 2 * k + 8, &high, sizeof high);
	}
}

static void cubic_double(const uint32_t *row, uint32_t *out, int count)
{
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *b = bytes_of(row + i);
		uint32_t odd[CHUNK];
		uint8_t values[BYTES];
		for (int k = 0; k < BYTES; k++)
			values[k] = cubic(b[k - 4], b[k], b[k + 4], b[k + 8]);
		memcpy(odd, values, sizeof odd);
		interleave(row + i, odd, out + 2 * (ptrdiff_t)i);
	}
}

static void mean_double_row(const uint32_t *row, uint32_t *out, int count)
{
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *a = bytes_of(row + i);
		uint8_t values[BYTES];
		uint32_t odd[CHUNK];
		for (int k = 0; k < BYTES; k++)
			values[k] = mean_of_2_down(a[k], a[k + 4]);
		memcpy(odd, values, sizeof odd);
		interleave(row + i, odd, out + 2 * (ptrdiff_t)i);
	}
}

static void mean_double(const uint32_t *above, const uint32_t *below, uint32_t *out, int count)
{
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *a = bytes_of(above + i), *b = bytes_of(below + i);
		uint8_t even_values[BYTES], odd_values[BYTES];
		uint32_t even[CHUNK], odd[CHUNK];
		for (int k = 0; k < BYTES; k++)
			even_values[k] = mean_of_2(a[k], b[k]);
		for (int k = 0; k < BYTES; k++)
			odd_values[k] = mean_of_4(a[k], a[k + 4], b[k], b[k + 4]);
		memcpy(even, even_values, sizeof even);
		memcpy(odd, odd_values, sizeof odd);
		interleave(even, odd, out + 2 * (ptrdiff_t)i);
	}
}

/* The points of a row whose column is odd (first = 1) or even (first = 0) are put in. */
static inline void put_every_second(const uint8_t values[BYTES], const uint32_t *row, int first,
				    uint32_t *out)
{
	uint32_t made[CHUNK];
	memcpy(made, values, sizeof made);
	for (int k = 0; k < CHUNK; k++)
		out[k] = ((k & 1) == first) ? made[k] : row[k];
}

static void cubic_quincunx(const uint32_t *row, ptrdiff_t stride, int first, bool up, uint32_t *out,
			   int count)
{
	const uint8_t odd_down = up ? 0 : 1;
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *p = bytes_of(row + i);
		const uint8_t *a = bytes_of(row + i - 3 * stride), *b = bytes_of(row + i - stride);
		const uint8_t *c = bytes_of(row + i + stride), *d = bytes_of(row + i + 3 * stride);
		uint8_t values[BYTES];
		for (int k = 0; k < BYTES; k++) {
			const uint8_t along = cubic(p[k - 12], p[k - 4], p[k + 4], p[k + 12]);
			const uint8_t down = cubic(a[k], b[k], c[k], d[k]);
			values[k] = (uint8_t)(mean_of_2(along, down) - ((along ^ down) & odd_down));
		}
		put_every_second(values, row + i, first, out + i);
	}
}

static void mean_quincunx(const uint32_t *row, ptrdiff_t stride, int first, uint32_t *out,
			  int count)
{
	for (int i = 0; i < count; i += CHUNK) {
		const uint8_t *p = bytes_of(row + i);
		const uint8_t *above = bytes_of(row + i - stride);
		const uint8_t *below = bytes_of(row + i + stride);
		uint8_t values[BYTES];
		for (int k = 0; k < BYTES; k++)
			values[k] = mean_of_4(p[k - 4], p[k + 4], above[k], below[k]);
		put_every_second(values, row + i, first, out + i);
	}
}

#define GZ_ROW_FILTERS(set)                                                                \
	{                                                                                  \
		.name = set, .cubic_between = cubic_between, .cubic_double = cubic_double, \
		.mean_double = mean_double, .mean_double_row = mean_double_row,            \
		.cubic_quincunx = cubic_quincunx, .mean_quincunx = mean_quincunx,          \
	}
