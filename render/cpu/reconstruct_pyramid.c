/*
 * Pyramid reconstruction: the lattice of spacing s is filled from that of 2s, coarse to fine, where
 * nothing was cast (docs/foveation.md has the formulas).
 *
 * The picture is cut into squares, and each is made in one go: its part of every lattice is filled
 * in a scratch buffer that stays in the cache, with a margin as wide as the filters of the next
 * finer lattice reach, and the last fill writes the picture. Points of margins are made more than
 * once, always the same, so squares need nothing of each other.
 */
#include <string.h>

#include "render/cpu/reconstruct.h"

enum {
	SQUARE = 128, /* px; chosen: margins are a fifth of the work, and the buffers fit a cache */
	BLOCK = GZ_BLOCK_EDGE,
	REACH = 3, /* how far a filter of quincunx tiles looks along an axis */
	/* A lattice's part of a square: half of it, and margins of 4 and 5 points and a half. */
	PATCH_EDGE = SQUARE / 2 + 12,
	PATCH_STRIDE = PATCH_EDGE + REACH + 1 + 2 * GZ_ROW_CHUNK,
	PATCH_ROWS = PATCH_EDGE + 2 * REACH,
	ROW_ROOM = SQUARE + 2 * GZ_ROW_CHUNK, /* points of a row that is made */
};

/* Columns [x0, x1) and rows [y0, y1) of a lattice. */
struct patch {
	int x0, y0, x1, y1;
	int columns, rows; /* of the whole lattice */
	ptrdiff_t stride;
	uint32_t *first; /* point (x0, y0) */
};

/* What is to be done with a run of blocks. */
enum fill {
	FILL_NONE,     /* every point was cast */
	FILL_QUINCUNX, /* every second was */
	FILL_COARSER,  /* from the next coarser lattice */
};

struct square {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	const struct gz_row_filters *filters;
	struct patch patches[GZ_PLAN_LAYERS_MAX];
	uint32_t row[ROW_ROOM], between[ROW_ROOM]; /* rows in the making */
};

static uint32_t *at(const struct patch *patch, int x, int y)
{
	return patch->first + (y - patch->y0) * patch->stride + (x - patch->x0);
}

static enum fill fill_of_block(const struct square *square, int level, int x, int y)
{
	const int tile =
		gz_lattices_block(square->lattices, (x / BLOCK) << level, (y / BLOCK) << level);
	if (tile / 2 > level)
		return FILL_COARSER;
	return tile == 2 * level + 1 ? FILL_QUINCUNX : FILL_NONE;
}

/* The end of the run of blocks that begins at (x, y) and asks for the same. */
static int run_end(const struct square *square, int level, int x, int y, enum fill *out_fill)
{
	const int x1 = square->patches[level].x1;
	*out_fill = fill_of_block(square, level, x, y);
	int end = x - x % BLOCK + BLOCK;
	while (end < x1 && fill_of_block(square, level, end, y) == *out_fill)
		end += BLOCK;
	return end < x1 ? end : x1;
}

/* Points [x, end) of row y from the coarser lattice. */
static void fill_row(struct square *square, int level, int x, int end, int y)
{
	const struct patch *coarse = &square->patches[level + 1];
	const uint32_t *row = at(coarse, x / 2, y / 2);
	const int count = (end - x + 1) / 2;
	/* What is written too much in a patch is written again by the next run, but around a run of
	 * the picture lies what was cast. */
	uint32_t *to = at(&square->patches[level], x, y);
	uint32_t *out = level > 0 || (end - x) % (2 * GZ_ROW_CHUNK) == 0 ? to : square->row;
	if (square->plan->filter == GZ_FILTER_BILINEAR) {
		if (y % 2 == 0)
			square->filters->mean_double_row(row, out, count);
		else
			square->filters->mean_double(row, row + coarse->stride, out, count);
	} else if (y % 2 == 0) {
		square->filters->cubic_double(row, out, count);
	} else {
		const uint32_t *const rows[4] = {
			row - 1 - coarse->stride,
			row - 1,
			row - 1 + coarse->stride,
			row - 1 + 2 * coarse->stride,
		};
		square->filters->cubic_between(rows, square->between, count + REACH);
		square->filters->cubic_double(square->between + 1, out, count);
	}
	if (out != to)
		memcpy(to, out, (size_t)(end - x) * 4);
}

static void take_cast_row(struct square *square, int level, int x, int end, int y)
{
	const struct gz_lattice *lattice = &square->lattices->layers[level];
	memcpy(at(&square->patches[level], x, y),
	       lattice->points + (size_t)y * lattice->stride + (size_t)x, (size_t)(end - x) * 4);
}

/* What was cast, and what comes from the coarser lattice. Whether there are quincunx tiles. */
static bool fill_patch(struct square *square, int level)
{
	const struct patch *patch = &square->patches[level];
	bool quincunx = false;
	for (int y = patch->y0, bottom; y < patch->y1; y = bottom) {
		bottom = y - y % BLOCK + BLOCK < patch->y1 ? y - y % BLOCK + BLOCK : patch->y1;
		enum fill fill;
		for (int x = patch->x0, end; x < patch->x1; x = end) {
			end = run_end(square, level, x, y, &fill);
			quincunx |= fill == FILL_QUINCUNX;
			for (int row = y; row < bottom; row++)
				if (fill == FILL_COARSER)
					fill_row(square, level, x, end, row);
				else if (level > 0) /* level 0 is cast into the picture */
					take_cast_row(square, level, x, end, row);
		}
	}
	return quincunx;
}

/* Index of the point that stands for number i of a lattice's count: mirrored about both ends, which
 * keeps odd numbers odd. */
static int mirrored(int i, int count)
{
	const int period = 2 * (count - 1);
	if (period == 0)
		return 0;
	i = (i % period + period) % period;
	return i < count ? i : period - i;
}

/* Give a patch that touches the lattice's rim the points beyond. */
static void extend_beyond_rim(const struct patch *patch)
{
	for (int i = 1; i <= REACH; i++)
		for (int y = patch->y0; y < patch->y1; y++) {
			const int right = patch->x1 - 1 + i;
			if (patch->x0 == 0)
				memcpy(at(patch, -i, y), at(patch, mirrored(-i, patch->columns), y),
				       4);
			if (patch->x1 == patch->columns)
				memcpy(at(patch, right, y),
				       at(patch, mirrored(right, patch->columns), y), 4);
		}
	const size_t row_bytes = (size_t)(patch->x1 - patch->x0 + 2 * REACH) * 4;
	for (int i = 1; i <= REACH; i++) {
		if (patch->y0 == 0)
			memcpy(at(patch, patch->x0 - REACH, -i),
			       at(patch, patch->x0 - REACH, mirrored(-i, patch->rows)), row_bytes);
		if (patch->y1 == patch->rows)
			memcpy(at(patch, patch->x0 - REACH, patch->y1 - 1 + i),
			       at(patch, patch->x0 - REACH,
				  mirrored(patch->y1 - 1 + i, patch->rows)),
			       row_bytes);
	}
}

/* A lattice of one column or one row has neighbours along the other axis only. */
static void fill_quincunx_line(struct square *square, int level, int x, int end, int y)
{
	const struct patch *patch = &square->patches[level];
	const ptrdiff_t step = patch->columns == 1 ? patch->stride : 1;
	for (x += (x + y) % 2 == 0; x < end; x += 2) {
		uint32_t *point = at(patch, x, y);
		if (square->plan->filter == GZ_FILTER_BILINEAR) {
			square->filters->mean_double(point - step, point + step, square->row, 1);
		} else {
			const uint32_t *const points[4] = { point - 3 * step, point - step,
							    point + step, point + 3 * step };
			square->filters->cubic_between(points, square->row, 1);
		}
		*point = square->row[0];
	}
}

static void fill_quincunx_row(struct square *square, int level, int x, int end, int y)
{
	const struct patch *patch = &square->patches[level];
	uint32_t *row = at(patch, x, y);
	const int first = (x + y) % 2 == 0;
	if (patch->columns == 1 || patch->rows == 1) {
		fill_quincunx_line(square, level, x, end, y);
		return;
	}
	if (square->plan->filter == GZ_FILTER_BILINEAR)
		square->filters->mean_quincunx(row, patch->stride, first, square->row, end - x);
	else
		square->filters->cubic_quincunx(row, patch->stride, first, y % 2 != 0, square->row,
						end - x);
	memcpy(row, square->row, (size_t)(end - x) * 4);
}

/* The points between those of quincunx tiles, as far from the patch's own rim as the filter looks.
 */
static void fill_quincunx(struct square *square, int level)
{
	const struct patch *patch = &square->patches[level];
	const int top = patch->y0 == 0 ? 0 : patch->y0 + REACH;
	const int bottom = patch->y1 == patch->rows ? patch->y1 : patch->y1 - REACH;
	const int left = patch->x0 == 0 ? 0 : patch->x0 + REACH;
	const int right = patch->x1 == patch->columns ? patch->x1 : patch->x1 - REACH;
	enum fill fill;
	for (int y = top, below; y < bottom; y = below) {
		below = y - y % BLOCK + BLOCK < bottom ? y - y % BLOCK + BLOCK : bottom;
		for (int x = left, end; x < right; x = end) {
			end = run_end(square, level, x, y, &fill);
			end = end < right ? end : right;
			for (int row = y; row < below && fill == FILL_QUINCUNX; row++)
				fill_quincunx_row(square, level, x, end, row);
		}
	}
}

static void fill_level(struct square *square, int level)
{
	const struct patch *patch = &square->patches[level];
	const bool quincunx = fill_patch(square, level);
	if (level == 0)
		return;
	const bool at_rim = patch->x0 == 0 || patch->y0 == 0 || patch->x1 == patch->columns ||
			    patch->y1 == patch->rows;
	if (at_rim)
		extend_beyond_rim(patch);
	if (!quincunx)
		return;
	fill_quincunx(square, level);
	if (at_rim)
		extend_beyond_rim(patch);
}

static bool all_was_cast(const struct gz_lattices *lattices, const struct patch *picture)
{
	for (int y = picture->y0; y < picture->y1; y += BLOCK)
		for (int x = picture->x0; x < picture->x1; x += BLOCK)
			if (gz_lattices_block(lattices, x / BLOCK, y / BLOCK) > 0)
				return false;
	return true;
}

/* What columns or rows [*from, *to) of a lattice take from those of the next coarser one: one
 * before and two behind for the filter, and as many more as quincunx tiles look at. Starts are
 * even, so that pairs are whole. */
static void halve_range(int *from, int *to, int count)
{
	*from = *from / 2 - 1 - REACH;
	*from = *from > 0 ? *from - *from % 2 : 0;
	*to = (*to - 1) / 2 + 3 + REACH;
	*to = *to < count ? *to : count;
}

void gz_reconstruct_square(const struct gz_plan *plan, const struct gz_lattices *lattices,
			   const struct gz_row_filters *filters, int column, int row)
{
	uint32_t memory[GZ_PLAN_LAYERS_MAX - 1][PATCH_ROWS][PATCH_STRIDE];
	struct square square = { .plan = plan, .lattices = lattices, .filters = filters };
	const struct gz_lattice *picture = &lattices->layers[0];
	struct patch *patch = &square.patches[0];
	patch->x0 = column * SQUARE;
	patch->y0 = row * SQUARE;
	patch->x1 = patch->x0 + SQUARE < picture->columns ? patch->x0 + SQUARE : picture->columns;
	patch->y1 = patch->y0 + SQUARE < picture->rows ? patch->y0 + SQUARE : picture->rows;
	patch->stride = (ptrdiff_t)picture->stride;
	patch->first = picture->points + patch->y0 * patch->stride + patch->x0;
	if (all_was_cast(lattices, patch))
		return;
	for (int level = 1; level < lattices->count; level++) {
		const struct gz_lattice *lattice = &lattices->layers[level];
		struct patch *coarse = &square.patches[level];
		*coarse = square.patches[level - 1];
		coarse->columns = lattice->columns;
		coarse->rows = lattice->rows;
		halve_range(&coarse->x0, &coarse->x1, coarse->columns);
		halve_range(&coarse->y0, &coarse->y1, coarse->rows);
		coarse->stride = PATCH_STRIDE;
		coarse->first = &memory[level - 1][REACH][REACH + 1];
	}
	for (int level = lattices->count - 1; level >= 0; level--)
		fill_level(&square, level);
}

void gz_reconstruct_squares(const struct gz_plan *plan, int *out_columns, int *out_rows)
{
	*out_columns = (plan->width + SQUARE - 1) / SQUARE;
	*out_rows = (plan->height + SQUARE - 1) / SQUARE;
}
