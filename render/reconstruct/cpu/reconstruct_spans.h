/*
 * The row filters of regions: bilinear interpolation of one lattice, and mixing where regions fade.
 * Included after reconstruct_rows.h, which explains the scheme.
 *
 * Interpolation uses whole numbers of 1/128 grey level: first a row between two lattice rows, then
 * multiples of the slope within each cell. Rounding errs by at most (1 + spacing) / 256 of a level
 * beyond the last half, and not at all for spacings 2, 4 and 8. For spacing 2 the means of two and
 * of four bytes give the same values.
 */
#include "render/reconstruct/cpu/reconstruct.h"

#include <math.h>
#include <string.h>

enum {
	CHANNELS = 4,
	FRACTION_BITS = 7,  /* 255 and its differences fit 16 bits with their sign */
	STRIP = POINTS / 2, /* pixels of 16-bit channels that fill a register */
	PIXELS_A_CHUNK =
		512, /* chosen: what is made stays in the first cache until it is written */
	CELLS_A_CHUNK = PIXELS_A_CHUNK / 2,
};

typedef uint16_t strip_u16 __attribute__((vector_size(2 * CHANNELS * STRIP)));
typedef uint64_t strip_u64 __attribute__((vector_size(2 * CHANNELS * STRIP)));
typedef uint8_t strip_u8 __attribute__((vector_size(CHANNELS * STRIP)));

/* A lattice spacing, and how to divide by it. */
struct cell_spacing {
	int spacing;
	int shift; /* log2 of a spacing that is a power of two; else -1 */
};

/* Points between two lattice rows, `down` pixels below the upper, plus half a level for later
 * rounding. Loops have no branch, so that compilers vectorise them. */
static void between_rows(const struct cell_spacing *span, const uint8_t *above,
			 const uint8_t *below, int down, int count, uint16_t *restrict out)
{
	const uint16_t below_weight = (uint16_t)down;
	const uint16_t above_weight = (uint16_t)(span->spacing - down);
	const uint16_t half = 1U << (FRACTION_BITS - 1);
	if (span->shift >= 0) {
		const int shift = FRACTION_BITS - span->shift;
		for (int i = 0; i < count; i++)
			out[i] = (uint16_t)(((uint16_t)(above[i] * above_weight +
							below[i] * below_weight)
					     << shift) +
					    half);
		return;
	}
	enum { BITS = 12 };
	const uint32_t scale = (1U << (FRACTION_BITS + BITS)) / (uint32_t)span->spacing;
	for (int i = 0; i < count; i++) {
		const uint32_t sum =
			(uint32_t)above[i] * above_weight + (uint32_t)below[i] * below_weight;
		out[i] = (uint16_t)(((sum * scale + (1U << (BITS - 1))) >> BITS) + half);
	}
}

/* Slopes from pixel to pixel within each cell, rounded to the nearest whole number. */
static void find_slopes(const struct cell_spacing *span, const uint16_t *points, int count,
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

/* One point in every pixel of a strip. */
SIMD strip_u16 load_point(const void *point)
{
	uint64_t bits;
	memcpy(&bits, point, sizeof bits);
	return (strip_u16)(bits - (strip_u64) { 0 });
}

/* 0 in the first pixel, 1 in the second, ... */
SIMD strip_u16 count_pixels(void)
{
	strip_u16 numbers = { 0 };
	for (int i = 0; i < CHANNELS * STRIP; i++)
		numbers[i] = (uint16_t)(i / CHANNELS);
	return numbers;
}

/* Pixels of neighbouring cells, a strip at a time. A cell may write up to a strip too much, which
 * the next cell overwrites. Inlined, so that a spacing known to the compiler costs no loop. */
SIMD void fill_cells(int spacing, const uint16_t *points, const int16_t *slopes, int cells,
		     uint32_t *out)
{
	const strip_u16 numbers = count_pixels();
	for (int i = 0; i < cells; i++, out += spacing) {
		const strip_u16 slope = load_point(slopes + (ptrdiff_t)CHANNELS * i);
		strip_u16 sum = load_point(points + (ptrdiff_t)CHANNELS * i) + slope * numbers;
		for (int x = 0; x < spacing; x += STRIP) {
			const strip_u8 pixels =
				__builtin_convertvector(sum >> FRACTION_BITS, strip_u8);
			memcpy(out + x, &pixels, sizeof pixels);
			sum += slope * (uint16_t)STRIP;
		}
	}
}

static void fill_cell_run(int spacing, const uint16_t *points, const int16_t *slopes, int cells,
			  uint32_t *out)
{
	switch (spacing) {
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

/* Fill cells wider than two pixels. Beyond a lattice's last column its last points stand in, with
 * weight 0; on a lattice row the row below, which may not exist, has weight 0 too. */
static void fill_by_slopes(const struct gz_lattice *lattice, int y, int column, int cells,
			   uint32_t *out)
{
	const int spacing = lattice->spacing;
	const struct cell_spacing span = {
		spacing,
		(spacing & (spacing - 1)) == 0 ? __builtin_ctz((unsigned)spacing) : -1,
	};
	const int down = y % spacing;
	const uint32_t *above = lattice->points + (size_t)(y / spacing) * lattice->stride + column;
	const uint32_t *below = down ? above + lattice->stride : above;
	const int there = lattice->columns - column;
	const int count = cells + 1 < there ? cells + 1 : there;
	uint16_t points[CHANNELS * (CELLS_A_CHUNK + 1)];
	int16_t slopes[CHANNELS * CELLS_A_CHUNK];
	between_rows(&span, (const uint8_t *)above, (const uint8_t *)below, down, CHANNELS * count,
		     points);
	if (count <= cells)
		memcpy(points + CHANNELS * count, points + CHANNELS * (count - 1),
		       CHANNELS * sizeof *points);
	find_slopes(&span, points, CHANNELS * cells, slopes);
	fill_cell_run(spacing, points, slopes, cells, out);
}

/* Fill cells of two pixels. Reads stay in the lattice's row and the padding behind it (lattice.h).
 */
static void fill_by_means(const struct gz_lattice *lattice, int y, int column, int cells,
			  uint32_t *out)
{
	const uint32_t *row = lattice->points + (size_t)(y / 2) * lattice->stride + column;
	const ptrdiff_t below = y % 2 ? (ptrdiff_t)lattice->stride : 0;
	for (int i = 0; i < cells; i += POINTS, row += POINTS, out += 2 * POINTS) {
		const vp a = vp_load(row), b = vp_load(row + 1);
		const vp c = vp_load(row + below), d = vp_load(row + below + 1);
		store_pair(out, vp_mean(a, c), mean_of_4(a, b, c, d), STORE_CACHED);
	}
}

/* Whether all points of cells, and so all their pixels, have one colour. */
static bool cells_are_flat(const struct gz_lattice *lattice, int y, int column, int cells,
			   uint32_t colour)
{
	const uint32_t *above =
		lattice->points + (size_t)(y / lattice->spacing) * lattice->stride + column;
	const int there = lattice->columns - column;
	return all_are(above, (ptrdiff_t)lattice->stride, cells + 1 < there ? cells + 1 : there,
		       y % lattice->spacing ? 2 : 1, colour);
}

/* The end of the run of cells from `column` on that have one colour, or of those that do not,
 * in groups as wide as a register. */
static int run_of_cells(const struct gz_lattice *lattice, int y, int column, int end,
			bool *out_flat)
{
	const uint32_t colour =
		lattice->points[(size_t)(y / lattice->spacing) * lattice->stride + column];
	int to = column + POINTS < end ? column + POINTS : end;
	*out_flat = cells_are_flat(lattice, y, column, to - column, colour);
	while (to < end) {
		const int next = to + POINTS < end ? to + POINTS : end;
		const uint32_t own =
			lattice->points[(size_t)(y / lattice->spacing) * lattice->stride + to];
		if (cells_are_flat(lattice, y, to, next - to, *out_flat ? colour : own) !=
		    *out_flat)
			break;
		to = next;
	}
	return to;
}

/* Pixels [x0, x1) of a row; `out` is the place of pixel x0. */
struct pixel_run {
	int x0, x1;
	uint32_t *out;
};

/* Those pixels of a run that lie in cells [column, end). */
static void fill_cells_of_row(const struct gz_lattice *lattice, int y, int column, int end,
			      const struct pixel_run *run)
{
	const int spacing = lattice->spacing, cells_a_chunk = PIXELS_A_CHUNK / spacing;
	uint32_t pixels[PIXELS_A_CHUNK + 2 * POINTS];
	for (int to; column < end; column = to) {
		to = column + cells_a_chunk < end ? column + cells_a_chunk : end;
		if (spacing == 2)
			fill_by_means(lattice, y, column, to - column, pixels);
		else
			fill_by_slopes(lattice, y, column, to - column, pixels);
		const int first = column * spacing > run->x0 ? column * spacing : run->x0;
		const int last = to * spacing < run->x1 ? to * spacing : run->x1;
		copy_points(pixels + (first - column * spacing), run->out + (first - run->x0),
			    last - first, false);
	}
}

static void fill_span(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out)
{
	const int spacing = lattice->spacing, end = (x1 - 1) / spacing + 1;
	const uint32_t *row = lattice->points + (size_t)(y / spacing) * lattice->stride;
	if (spacing == 1) {
		copy_points(row + x0, out, x1 - x0, false);
		return;
	}
	if (spacing == 2) { /* two means cost no more than the search for flat cells */
		fill_cells_of_row(lattice, y, x0 / 2, end, &(struct pixel_run) { x0, x1, out });
		return;
	}
	bool flat;
	for (int column = x0 / spacing, to; column < end; column = to) {
		to = run_of_cells(lattice, y, column, end, &flat);
		const int first = column * spacing > x0 ? column * spacing : x0;
		const int last = to * spacing < x1 ? to * spacing : x1;
		const struct pixel_run run = { first, last, out + (first - x0) };
		if (flat)
			fill_points(row[column], run.out, last - first, false);
		else
			fill_cells_of_row(lattice, y, column, to, &run);
	}
}

static double least_of(double a, double b)
{
	return a < b ? a : b;
}

static double greatest_of(double a, double b)
{
	return a > b ? a : b;
}

/* gz_region_weight() without its divisions. The difference is far below 1/512, the distance between
 * a full share and the least that is rounded to it. */
static void find_region_shares(const struct gz_region *region, int y, int x0, int count,
			       uint32_t *out)
{
	const double centre = region->centre_px[0], per_px = 1 / region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	const double bands = least_of(region->half_px[0], region->half_px[1]) / region->blend_px;
	if (region->shape == GZ_REGION_ELLIPSE)
		for (int i = 0; i < count; i++) {
			const double u = (x0 + i - centre) * per_px;
			const double share = (1 - sqrt(u * u + v * v)) * bands;
			out[i] =
				(uint32_t)(int32_t)(least_of(greatest_of(share, 0), 1) * 256 + 0.5);
		}
	else
		for (int i = 0; i < count; i++) {
			const double u = (x0 + i - centre) * per_px;
			const double share = (1 - greatest_of(fabs(u), fabs(v))) * bands;
			out[i] =
				(uint32_t)(int32_t)(least_of(greatest_of(share, 0), 1) * 256 + 0.5);
		}
}

static void blend_points(const uint32_t *behind, const uint32_t *shares, uint32_t *restrict points,
			 int count)
{
	const uint32_t channels = 0x00FF00FFU, half = 0x00800080U;
	for (int i = 0; i < count; i++) {
		const uint32_t a = points[i], b = behind[i], own = shares[i], rest = 256 - own;
		const uint32_t even = (a & channels) * own + (b & channels) * rest + half;
		const uint32_t odd = (a >> 8 & channels) * own + (b >> 8 & channels) * rest + half;
		points[i] = (even >> 8 & channels) | (odd & ~channels);
	}
}
