/*
 * Bilinear interpolation of one lattice, in whole numbers of 1/128 of a grey level: a row between
 * two lattice rows first, then from cell to cell by adding up the slope. Rounding leaves at most
 * (1 + spacing) / 256 of a level beyond the last half; nothing where the spacing is a power of two
 * up to 8.
 */
#include "render/cpu/reconstruct.h"

#include <string.h>

enum {
	CHANNELS = 4,
	PAIR = 2 * CHANNELS, /* two pixels fill a vector of 16 bytes */
	FRACTION_BITS = 7,   /* 255 and its differences fit 16 bits with their sign */
	CELLS_A_CHUNK = 128, /* chosen: a row's buffer stays in the first cache */
};

typedef uint16_t pair_u16 __attribute__((vector_size(2 * PAIR)));
typedef int16_t pair_i16 __attribute__((vector_size(2 * PAIR)));
typedef uint8_t pair_u8 __attribute__((vector_size(PAIR)));

/* What all cells of a span have in common. */
struct span {
	int spacing;
	int shift; /* of the spacing, a power of two; else -1 */
};

static int shift_of(int spacing)
{
	return (spacing & (spacing - 1)) == 0 ? __builtin_ctz((unsigned)spacing) : -1;
}

/* Points between two lattice rows, `down` below the upper. Loops without a branch: compilers make
 * vectors of them. */
static void between_rows(const struct span *span, const uint8_t *above, const uint8_t *below,
			 int down, int count, uint16_t *restrict out)
{
	const uint16_t below_weight = (uint16_t)down;
	const uint16_t above_weight = (uint16_t)(span->spacing - down);
	if (span->shift >= 0) {
		const int shift = FRACTION_BITS - span->shift;
		for (int i = 0; i < count; i++)
			out[i] = (uint16_t)((uint16_t)(above[i] * above_weight +
						       below[i] * below_weight)
					    << shift);
		return;
	}
	enum { BITS = 12 };
	const uint32_t scale = (1U << (FRACTION_BITS + BITS)) / (uint32_t)span->spacing;
	for (int i = 0; i < count; i++) {
		const uint32_t sum =
			(uint32_t)above[i] * above_weight + (uint32_t)below[i] * below_weight;
		out[i] = (uint16_t)((sum * scale + (1U << (BITS - 1))) >> BITS);
	}
}

/* A point in both halves of a vector. */
static inline pair_i16 load_twice(const void *point)
{
	uint64_t half;
	memcpy(&half, point, sizeof half);
	typedef uint64_t two_u64 __attribute__((vector_size(16)));
	return (pair_i16)(two_u64) { half, half };
}

/* Slopes from pixel to pixel within each cell. A slope that is no whole number is rounded to the
 * nearest. */
static void find_slopes(const struct span *span, const uint16_t *points, int count,
			int16_t *restrict out)
{
	if (span->shift >= 0) {
		for (int i = 0; i < count; i++)
			out[i] = (int16_t)((int16_t)(points[i + CHANNELS] - points[i]) >>
					   span->shift);
		return;
	}
	const int32_t share = (1 << 16) / span->spacing;
	for (int i = 0; i < count; i++)
		out[i] = (int16_t)(((int16_t)(points[i + CHANNELS] - points[i]) * share +
				    (1 << 15)) >>
				   16);
}

/* Pixels of cells in a row, two at a time: an odd spacing writes one more, which the next cell puts
 * right. Inlined, so that a spacing known to the compiler costs no loop. */
static inline __attribute__((always_inline)) void fill_cells(int spacing, const uint16_t *points,
							     const int16_t *slopes, int cells,
							     uint32_t *out)
{
	static const pair_i16 second = { 0, 0, 0, 0, -1, -1, -1, -1 };
	const pair_u16 half = (pair_u16) { 0 } + (1U << (FRACTION_BITS - 1));
	for (int i = 0; i < cells; i++, out += spacing) {
		const pair_i16 slope = load_twice(slopes + (ptrdiff_t)CHANNELS * i);
		const pair_i16 left = load_twice(points + (ptrdiff_t)CHANNELS * i);
		pair_u16 sum = (pair_u16)(left + (slope & second)) + half;
		for (int x = 0; x < spacing; x += 2) {
			const pair_u8 pixels =
				__builtin_convertvector(sum >> FRACTION_BITS, pair_u8);
			memcpy(out + x, &pixels, sizeof pixels);
			sum += (pair_u16)(slope + slope);
		}
	}
}

static void fill_run(int spacing, const uint16_t *points, const int16_t *slopes, int cells,
		     uint32_t *out)
{
	switch (spacing) {
	case 2:
		fill_cells(2, points, slopes, cells, out);
		return;
	case 4:
		fill_cells(4, points, slopes, cells, out);
		return;
	case 7:
		fill_cells(7, points, slopes, cells, out);
		return;
	default:
		fill_cells(spacing, points, slopes, cells, out);
		return;
	}
}

/* Those pixels of a cell that begins at pixel `cell_x` which are in [x0, x1). */
static void fill_part(const struct span *span, const uint16_t *points, const int16_t *slopes,
		      int cell_x, int x0, int x1, uint32_t *out)
{
	uint32_t pixels[GZ_SPACING_MAX + 1];
	const int from = cell_x > x0 ? cell_x : x0;
	const int to = cell_x + span->spacing < x1 ? cell_x + span->spacing : x1;
	fill_cells(span->spacing, points, slopes, 1, pixels);
	memcpy(out + (from - x0), pixels + (from - cell_x), (size_t)(to - from) * sizeof *out);
}

/* The points of `cells` cells from `column` on, and one more. */
static void load_chunk(const struct gz_lattice *lattice, const struct span *span, int y, int column,
		       int cells, uint16_t *points)
{
	const int down = y % span->spacing;
	const uint32_t *above =
		lattice->points + (size_t)(y / span->spacing) * lattice->stride + column;
	/* On a lattice row the row below has no weight and may not exist. */
	const uint32_t *below = down ? above + lattice->stride : above;
	const int there = lattice->columns - column;
	const int count = cells + 1 < there ? cells + 1 : there;
	between_rows(span, (const uint8_t *)above, (const uint8_t *)below, down, CHANNELS * count,
		     points);
	if (count <= cells) /* beyond the last column its own point stands in, without weight */
		memcpy(points + CHANNELS * count, points + CHANNELS * (count - 1),
		       CHANNELS * sizeof *points);
}

void gz_reconstruct_span(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out)
{
	const struct span span = { lattice->spacing, shift_of(lattice->spacing) };
	const int last = (x1 - 1) / span.spacing;
	uint16_t points[CHANNELS * (CELLS_A_CHUNK + 1)];
	int16_t slopes[CHANNELS * CELLS_A_CHUNK];
	for (int column = x0 / span.spacing; column <= last; column += CELLS_A_CHUNK) {
		const int left = last + 1 - column;
		const int cells = left < CELLS_A_CHUNK ? left : CELLS_A_CHUNK;
		load_chunk(lattice, &span, y, column, cells, points);
		find_slopes(&span, points, CHANNELS * cells, slopes);
		/* The first cell and the last may be cut, and the last must not write past it. */
		const int first_whole = column * span.spacing < x0;
		const int whole = column + cells > last ? cells - 1 : cells;
		if (first_whole < whole)
			fill_run(span.spacing, points + (ptrdiff_t)CHANNELS * first_whole,
				 slopes + (ptrdiff_t)CHANNELS * first_whole, whole - first_whole,
				 out + ((column + first_whole) * span.spacing - x0));
		if (first_whole)
			fill_part(&span, points, slopes, column * span.spacing, x0, x1, out);
		if (whole < cells && !(first_whole && cells == 1))
			fill_part(&span, points + (ptrdiff_t)CHANNELS * whole,
				  slopes + (ptrdiff_t)CHANNELS * whole,
				  (column + whole) * span.spacing, x0, x1, out);
	}
}
