/*
 * The row filters of the pyramid. docs/foveation.md gives their formulas; they use whole numbers,
 * which give the same bits on every processor.
 *
 * The filters are written once and compiled once for each instruction set. The file of a set
 * (reconstruct_avx2.c, ...) defines the vocabulary, which is a vector type `vp` of POINTS points
 * and its operations, then includes this file and reconstruct_spans.h, and is compiled with the
 * set's flags. gz_row_filters_find() chooses at run time. reconstruct_avx512.c comments the
 * vocabulary.
 */
#include "render/reconstruct/cpu/reconstruct.h"

#include <string.h>

_Static_assert(POINTS <= GZ_ROW_POINTS, "reads stay within what callers are told");

/* (a + b) / 2 */
SIMD vp mean_down(vp a, vp b)
{
	return vp_not(vp_mean(vp_not(a), vp_not(b)));
}

/* (a + b + c + d + 2) / 4: the mean of two means, less 1 where rounding was up once too often. */
SIMD vp mean_of_4(vp a, vp b, vp c, vp d)
{
	const vp first = vp_mean(a, b), second = vp_mean(c, d);
	const vp rounded = vp_or(vp_xor(a, b), vp_xor(c, d));
	const vp odd = vp_and(vp_and(rounded, vp_xor(first, second)), vp_set(0x01010101));
	return vp_but(vp_mean(first, second), odd);
}

/* Catmull-Rom halfway between b and c, with a before b and d after c, clamped to [b, c].
 *
 * With m the mean of b and c and n the mean of a and d, the value is m + (m - n) / 8. The
 * difference takes 9 bits, so half of it plus 128 is used, which takes 8. Where b + c is even, that
 * half is raised by 2 so that its quarter rounds; what saturates at 255 lies outside of [b, c]
 * anyway. */
SIMD vp cubic(vp a, vp b, vp c, vp d)
{
	const vp m = vp_mean(b, c), n = vp_mean(a, d);
	const vp raise = vp_where_same(b, c, vp_set(0x01010101));
	const vp half = vp_add(vp_add(vp_mean(m, vp_not(n)), raise), raise);
	const vp eighth = vp_quarter(half), none = vp_set(0x20202020);
	const vp value = vp_but(vp_add(m, vp_but(eighth, none)), vp_but(none, eighth));
	return vp_least(vp_greatest(value, vp_least(b, c)), vp_greatest(b, c));
}

/* How a filled row is written. */
enum store { STORE_CACHED, STORE_STREAMED };

SIMD void store_pair(uint32_t *out, vp even, vp odd, enum store store)
{
	vp first, second;
	vp_interleave(even, odd, &first, &second);
	if (store == STORE_STREAMED) {
		vp_stream(out, first);
		vp_stream(out + POINTS, second);
	} else {
		vp_store(out, first);
		vp_store(out + POINTS, second);
	}
}

/* Store the last points of a row, less than 2 * POINTS. */
SIMD void store_rest(uint32_t *out, vp even, vp odd, int count)
{
	uint32_t points[2 * POINTS];
	store_pair(points, even, odd, STORE_CACHED);
	memcpy(out, points, (size_t)count * sizeof *out);
}

/* Points of two rows of the finer lattice: those above POINTS points of the coarser lattice, and
 * the one to the right of each. */
struct two_rows {
	vp even, even_next, odd, odd_next;
};

/* Points of one row of the coarser lattice, and of the row halfway to the next. */
struct source {
	vp row, between;
};

SIMD struct source cubic_source(const uint32_t *row, ptrdiff_t stride)
{
	const vp here = vp_load(row);
	return (struct source) {
		here,
		cubic(vp_load(row - stride), here, vp_load(row + stride),
		      vp_load(row + 2 * stride)),
	};
}

/* The points halfway to the right of `points`, which begin one point earlier. */
SIMD vp cubic_behind(vp points, vp next)
{
	return cubic(points, vp_from(1, points, next), vp_from(2, points, next),
		     vp_from(3, points, next));
}

SIMD struct two_rows cubic_rows(const struct source *here, const struct source *next)
{
	return (struct two_rows) {
		vp_from(1, here->row, next->row),
		cubic_behind(here->row, next->row),
		vp_from(1, here->between, next->between),
		cubic_behind(here->between, next->between),
	};
}

/* Two rows to fill from a row of the coarser lattice: see double_cubic of struct gz_row_filters. */
struct doubling {
	const uint32_t *row;
	ptrdiff_t stride;
	uint32_t *even, *odd;
	int count;
};

SIMD void double_cubic_to(const struct doubling *job, enum store store)
{
	const uint32_t *row = job->row - 1;
	const ptrdiff_t stride = job->stride;
	uint32_t *even = job->even, *odd = job->odd;
	struct source here = cubic_source(row, stride);
	for (int count = job->count; count > 0;
	     count -= 2 * POINTS, even += 2 * POINTS, odd += 2 * POINTS) {
		row += POINTS;
		const struct source next = cubic_source(row, stride);
		const struct two_rows made = cubic_rows(&here, &next);
		here = next;
		if (count < 2 * POINTS) {
			store_rest(even, made.even, made.even_next, count);
			store_rest(odd, made.odd, made.odd_next, count);
			return;
		}
		store_pair(even, made.even, made.even_next, store);
		store_pair(odd, made.odd, made.odd_next, store);
	}
}

SIMD void double_mean_to(const struct doubling *job, enum store store)
{
	const uint32_t *row = job->row;
	const ptrdiff_t stride = job->stride;
	uint32_t *even = job->even, *odd = job->odd;
	for (int count = job->count; count > 0;
	     count -= 2 * POINTS, even += 2 * POINTS, odd += 2 * POINTS) {
		const vp a = vp_load(row), b = vp_load(row + 1);
		const vp c = vp_load(row + stride), d = vp_load(row + stride + 1);
		const vp across = mean_down(a, b), down = vp_mean(a, c);
		const vp all = mean_of_4(a, b, c, d);
		row += POINTS;
		if (count < 2 * POINTS) {
			store_rest(even, a, across, count);
			store_rest(odd, down, all, count);
			return;
		}
		store_pair(even, a, across, store);
		store_pair(odd, down, all, store);
	}
}

/* Points up to the next whole cache line, where stores past the caches may begin: a whole line
 * leaves the processor at once. */
enum { LINE = 16 };

SIMD int before_line(const uint32_t *out)
{
	return (int)(-((uintptr_t)out / sizeof *out) % LINE);
}

SIMD void stream_line(const uint32_t *points, uint32_t *out)
{
	for (int x = 0; x < LINE; x += POINTS)
		vp_stream(out + x, vp_load(points + x));
}

static void stream_row(const uint32_t *points, uint32_t *out, int count)
{
	int x = before_line(out);
	if (x > count)
		x = count;
	memcpy(out, points, (size_t)x * sizeof *out);
	for (; x + LINE <= count; x += LINE)
		stream_line(points + x, out + x);
	memcpy(out + x, points + x, (size_t)(count - x) * sizeof *out);
}

static void copy_points(const uint32_t *points, uint32_t *out, int count, bool stream)
{
	if (stream)
		stream_row(points, out, count);
	else
		memcpy(out, points, (size_t)count * sizeof *out);
}

typedef void row_filter(const struct doubling *job, enum store store);

/* Write the rows directly, or by way of the first cache if they are not aligned for streaming. */
SIMD void double_to(row_filter *filter, const struct doubling *job, bool stream)
{
	if (!stream) {
		filter(job, STORE_CACHED);
	} else if (before_line(job->even) == 0 && before_line(job->odd) == 0) {
		filter(job, STORE_STREAMED);
	} else {
		uint32_t rows[2][GZ_ROW_STREAMED];
		const struct doubling cached = { job->row, job->stride, rows[0], rows[1],
						 job->count };
		filter(&cached, STORE_CACHED);
		stream_row(rows[0], job->even, job->count);
		stream_row(rows[1], job->odd, job->count);
	}
}

static void double_cubic(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			 int count, bool stream)
{
	const struct doubling job = { row, stride, even, odd, count };
	double_to(double_cubic_to, &job, stream);
}

static void double_mean(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			int count, bool stream)
{
	const struct doubling job = { row, stride, even, odd, count };
	double_to(double_mean_to, &job, stream);
}

/* Alternate points of two rows: the missing ones. A quincunx tile lacks points `first`, `first` +
 * 2,
 * ... of the first row and the others of the second. */
SIMD vp in_turn(vp of_first, vp of_second, int first)
{
	return first ? vp_alternate(of_second, of_first) : vp_alternate(of_first, of_second);
}

SIMD vp load_in_turn(const uint32_t *points, ptrdiff_t stride, int first)
{
	return in_turn(vp_load(points), vp_load(points + stride), first);
}

SIMD void store_first(uint32_t *points, vp a, int count)
{
	if (count >= POINTS) {
		vp_store(points, a);
		return;
	}
	uint32_t all[POINTS];
	vp_store(all, a);
	memcpy(points, all, (size_t)count * sizeof *points);
}

/* Put the points made for in_turn() back into both rows, or into the first only. */
SIMD void put_in_turn(uint32_t *points, ptrdiff_t stride, vp made, int first, int rows, int count)
{
	store_first(points, in_turn(made, vp_load(points), first), count);
	if (rows > 1)
		store_first(points + stride, in_turn(vp_load(points + stride), made, first), count);
}

SIMD void quincunx_cubic_at(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	const vp odd_down = in_turn(vp_set(0x01010101), vp_set(0), first);
	for (int i = 0; i < count; i += POINTS) {
		uint32_t *p = row + i;
		vp across[4], down[4];
		for (int k = 0; k < 4; k++) {
			across[k] = load_in_turn(p + 2 * k - 3, stride, first);
			down[k] = load_in_turn(p + (2 * k - 3) * stride, stride, first);
		}
		const vp a = cubic(across[0], across[1], across[2], across[3]);
		const vp b = cubic(down[0], down[1], down[2], down[3]);
		const vp made = vp_but(vp_mean(a, b), vp_and(vp_xor(a, b), odd_down));
		put_in_turn(p, stride, made, first, rows, count - i);
	}
}

SIMD void quincunx_mean_at(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	for (int i = 0; i < count; i += POINTS) {
		uint32_t *p = row + i;
		const vp made = mean_of_4(load_in_turn(p - 1, stride, first),
					  load_in_turn(p + 1, stride, first),
					  load_in_turn(p - stride, stride, first),
					  load_in_turn(p + stride, stride, first));
		put_in_turn(p, stride, made, first, rows, count - i);
	}
}

static void quincunx_cubic(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	if (first)
		quincunx_cubic_at(row, stride, 1, rows, count);
	else
		quincunx_cubic_at(row, stride, 0, rows, count);
}

static void quincunx_mean(uint32_t *row, ptrdiff_t stride, int first, int rows, int count)
{
	if (first)
		quincunx_mean_at(row, stride, 1, rows, count);
	else
		quincunx_mean_at(row, stride, 0, rows, count);
}

/* Whether a row has one colour. The last wide load overlaps the one before. */
SIMD bool row_is(const uint32_t *points, int columns, uint32_t colour)
{
	int x = 0;
	for (; x + POINTS <= columns; x += POINTS)
		if (vp_differ(vp_load(points + x), vp_set(colour)))
			return false;
	if (x > 0)
		return x == columns ||
		       !vp_differ(vp_load(points + columns - POINTS), vp_set(colour));
	for (; x < columns; x++)
		if (points[x] != colour)
			return false;
	return true;
}

static bool all_are(const uint32_t *points, ptrdiff_t stride, int columns, int rows,
		    uint32_t colour)
{
	for (int y = 0; y < rows; y++, points += stride)
		if (!row_is(points, columns, colour))
			return false;
	return true;
}

static void fill_points(uint32_t colour, uint32_t *out, int count, bool stream)
{
	const vp all = vp_set(colour);
	int x = 0;
	if (stream) {
		for (const int head = before_line(out); x < head && x < count; x++)
			out[x] = colour;
		for (; x + LINE <= count; x += LINE)
			for (int i = 0; i < LINE; i += POINTS)
				vp_stream(out + x + i, all);
	}
	for (; x + POINTS <= count; x += POINTS)
		vp_store(out + x, all);
	for (; x < count; x++)
		out[x] = colour;
}

static void settle_stores(void)
{
	vp_settle();
}

#define GZ_ROW_FILTERS(set)                                                                      \
	{                                                                                        \
		.name = set, .double_cubic = double_cubic, .double_mean = double_mean,           \
		.quincunx_cubic = quincunx_cubic, .quincunx_mean = quincunx_mean,                \
		.all_are = all_are, .fill = fill_points, .copy = copy_points, .span = fill_span, \
		.weights = find_region_shares, .blend = blend_points, .settle = settle_stores,   \
	}
