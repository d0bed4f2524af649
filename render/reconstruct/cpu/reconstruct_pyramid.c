/*
 * Pyramid reconstruction: from coarse to fine, the points of the lattice of spacing s that were not
 * cast are filled from the lattice of spacing 2s (docs/foveation.md has the formulas).
 *
 * The picture is cut into squares, and each square is finished before the next. Its part of every
 * lattice is filled in a scratch buffer that stays in the cache, with a margin as wide as the
 * filters of the next finer lattice reach; the last fill writes the picture. Margins overlap and
 * are made more than once, with equal results, so squares do not depend on each other. A square
 * skips the lattices that are coarser than all tiles it reads. Where all points that the filters
 * would read have one colour, the result is that colour and nothing is computed.
 *
 * Quincunx tiles of spacing 1 are cast into the picture itself. What they lack is filled after all
 * squares, from pixels of neighbouring squares, too.
 */
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

enum {
	SQUARE_WIDTH = GZ_ROW_STREAMED, /* px; chosen: margins are a tenth of the work, and the
					   buffers fit a */
	SQUARE_HEIGHT = 128,            /* second-level cache */
	BLOCK = GZ_BLOCK_EDGE,
	REACH = 3, /* how far a filter of quincunx tiles looks along an axis */
	/* A lattice's part of a square: half of it, and at both ends what the filters of two finer
	 * lattices reach, a start rounded down to even each time. */
	PATCH_WIDTH = SQUARE_WIDTH / 2 + 4 + 2 * (REACH + 1),
	PATCH_HEIGHT = SQUARE_HEIGHT / 2 + 4 + 2 * (REACH + 1),
	LEFT = 16, /* room for points beyond the rim, and aligned */
	PATCH_STRIDE = LEFT + (PATCH_WIDTH + REACH + 2 * GZ_ROW_POINTS + 15) / 16 * 16,
	PATCH_ROWS = PATCH_HEIGHT + 2 * REACH + 1,
	FLAT_WIDTH = 2 * GZ_ROW_POINTS, /* px whose source is looked at together for one colour */
};

/* Columns [x0, x1) and rows [y0, y1) of a lattice. */
struct range {
	int x0, y0, x1, y1;
};

/* A square's part of a lattice. */
struct patch {
	struct range all;    /* filled before quincunx tiles are */
	struct range needed; /* read by finer lattices */
	int columns, rows;   /* of the whole lattice */
	ptrdiff_t stride;
	uint32_t *first;              /* point (all.x0, all.y0) */
	bool cast, quincunx, coarser; /* which kinds of fill its blocks need */
};

/* How a run of blocks is filled. */
enum fill {
	FILL_NONE,     /* every point was cast */
	FILL_QUINCUNX, /* every second point was cast */
	FILL_COARSER,  /* from the next coarser lattice */
};

struct square {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	const struct gz_row_filters *filters;
	bool stream, leaves_empty; /* leaves_empty: as in struct gz_reconstructed */
	struct patch patches[GZ_PLAN_LAYERS_MAX];
	uint32_t unused_row[SQUARE_WIDTH];
};

static uint32_t *point_at(const struct patch *patch, int x, int y)
{
	return patch->first + (y - patch->all.y0) * patch->stride + (x - patch->all.x0);
}

static int block_end(int x, int end)
{
	return gz_least(x - x % BLOCK + BLOCK, end);
}

static enum fill fill_of_block(const struct square *square, int level, int x, int y)
{
	const int tile =
		gz_lattices_block(square->lattices, (x / BLOCK) << level, (y / BLOCK) << level);
	if (tile / 2 > level)
		return FILL_COARSER;
	return tile == 2 * level + 1 ? FILL_QUINCUNX : FILL_NONE;
}

/* The end of the run of blocks from (x, y) on that are filled alike, `last` at most. */
static int run_end(const struct square *square, int level, int x, int y, int last,
		   enum fill *out_fill)
{
	*out_fill = fill_of_block(square, level, x, y);
	int end = x - x % BLOCK + BLOCK;
	while (end < last && fill_of_block(square, level, end, y) == *out_fill)
		end += BLOCK;
	return gz_least(end, last);
}

/* Fill points [x, end) of rows y and y + 1, if below `bottom`, from the coarser lattice. */
static void double_row(struct square *square, int level, int x, int end, int y, int bottom)
{
	const struct patch *patch = &square->patches[level];
	const struct patch *coarse = &square->patches[level + 1];
	const uint32_t *row = point_at(coarse, x / 2, y / 2);
	uint32_t *even = point_at(patch, x, y);
	uint32_t *odd = y + 1 < bottom ? even + patch->stride : square->unused_row;
	const bool stream = level == 0 && square->stream;
	if (square->plan->filter == GZ_FILTER_BILINEAR)
		square->filters->double_mean(row, coarse->stride, even, odd, end - x, stream);
	else
		square->filters->double_cubic(row, coarse->stride, even, odd, end - x, stream);
}

/* Whether all points that filters read for [x, end) of rows [y, bottom) have one colour. */
static bool source_is_flat(const struct square *square, int level, int x, int end, int y,
			   int bottom)
{
	const struct patch *coarse = &square->patches[level + 1];
	const int left = x / 2 - 1, right = (end - 1) / 2 + 3;
	const int top = y / 2 - 1, below = (bottom - 1) / 2 + 3;
	return square->filters->all_are(point_at(coarse, left, top), coarse->stride, right - left,
					below - top, *point_at(coarse, x / 2, y / 2));
}

/* The bits of INFINITY, which marks points without a value. */
#define NO_VALUE UINT32_C(0x7F800000)

/* Fill points [x, end) of rows [y, bottom) with one colour. */
static void fill_flat(const struct square *square, int level, const struct range *points,
		      uint32_t colour)
{
	if (level == 0 && square->leaves_empty && colour == NO_VALUE)
		return;
	for (int y = points->y0; y < points->y1; y++)
		square->filters->fill(colour, point_at(&square->patches[level], points->x0, y),
				      points->x1 - points->x0, level == 0 && square->stream);
}

/* Fill points [x, end) of rows [y, bottom), which lie in one row of blocks, from the coarser
 * lattice. */
static void fill_block_run(struct square *square, int level, int x, int end, int y, int bottom)
{
	const struct patch *coarse = &square->patches[level + 1];
	for (int to; x < end; x = to) {
		to = gz_least(x + FLAT_WIDTH, end);
		const bool flat = source_is_flat(square, level, x, to, y, bottom);
		const uint32_t colour = *point_at(coarse, x / 2, y / 2);
		for (int next = to; next < end; to = next) {
			next = gz_least(to + FLAT_WIDTH, end);
			if (source_is_flat(square, level, to, next, y, bottom) != flat ||
			    (flat && *point_at(coarse, to / 2, y / 2) != colour))
				break;
		}
		if (flat)
			fill_flat(square, level, &(struct range) { x, y, to, bottom }, colour);
		else
			for (int row = y; row < bottom; row += 2)
				double_row(square, level, x, to, row, bottom);
	}
}

static void take_cast_rows(struct square *square, int level, int x, int end, int y, int bottom)
{
	const struct gz_lattice *lattice = &square->lattices->layers[level];
	for (int row = y; row < bottom; row++)
		memcpy(point_at(&square->patches[level], x, row),
		       lattice->points + (size_t)row * lattice->stride + (size_t)x,
		       (size_t)(end - x) * 4);
}

/* Take the points that were cast, and fill those that come from the coarser lattice. */
static void fill_patch(struct square *square, int level)
{
	const struct range *all = &square->patches[level].all;
	for (int y = all->y0, bottom; y < all->y1; y = bottom) {
		bottom = block_end(y, all->y1);
		enum fill fill;
		for (int x = all->x0, end; x < all->x1; x = end) {
			end = run_end(square, level, x, y, all->x1, &fill);
			if (fill == FILL_COARSER)
				fill_block_run(square, level, x, end, y, bottom);
			else if (level > 0) /* level 0 is cast into the picture */
				take_cast_rows(square, level, x, end, y, bottom);
		}
	}
}

/* The index, within a lattice of `count` points, that stands for index i outside: mirrored about
 * both ends, which keeps odd numbers odd. */
static int mirrored(int i, int count)
{
	const int period = 2 * (count - 1);
	if (period == 0)
		return 0;
	i = (i % period + period) % period;
	return i < count ? i : period - i;
}

/* Fill the points beyond the lattice's rim in a patch that touches it. */
static void extend_beyond_rim(const struct patch *patch)
{
	const struct range *all = &patch->all;
	for (int i = 1; i <= REACH; i++) {
		const int left = mirrored(-i, patch->columns), right = all->x1 - 1 + i;
		const int stands_in = mirrored(right, patch->columns);
		for (int y = all->y0; y < all->y1; y++) {
			if (all->x0 == 0)
				*point_at(patch, -i, y) = *point_at(patch, left, y);
			if (all->x1 == patch->columns)
				*point_at(patch, right, y) = *point_at(patch, stands_in, y);
		}
	}
	const size_t row_bytes = (size_t)(all->x1 - all->x0 + 2 * REACH) * 4;
	for (int i = 1; i <= REACH; i++) {
		if (all->y0 == 0)
			memcpy(point_at(patch, all->x0 - REACH, -i),
			       point_at(patch, all->x0 - REACH, mirrored(-i, patch->rows)),
			       row_bytes);
		if (all->y1 == patch->rows)
			memcpy(point_at(patch, all->x0 - REACH, all->y1 - 1 + i),
			       point_at(patch, all->x0 - REACH,
					mirrored(all->y1 - 1 + i, patch->rows)),
			       row_bytes);
	}
}

/* Fill the missing points of a lattice of one column or one row, which has neighbours along the
 * other axis only, by the filters for odd rows along that axis. */
static void fill_quincunx_line(struct square *square, int level, int x, int end, int y)
{
	const struct patch *patch = &square->patches[level];
	const ptrdiff_t step = patch->columns == 1 ? patch->stride : 1;
	for (x += (x + y) % 2 == 0; x < end; x += 2) {
		uint32_t *point = point_at(patch, x, y);
		uint32_t made;
		if (square->plan->filter == GZ_FILTER_BILINEAR)
			square->filters->double_mean(point - step, 2 * step, square->unused_row,
						     &made, 1, false);
		else
			square->filters->double_cubic(point - step, 2 * step, square->unused_row,
						      &made, 1, false);
		*point = made;
	}
}

/* Fill the missing points of rows y, which is even, and y + 1 if it is before `bottom`. */
static void fill_quincunx_rows(struct square *square, int level, int x, int end, int y, int bottom)
{
	const struct patch *patch = &square->patches[level];
	const int rows = gz_least(bottom - y, 2), first = x % 2 == 0;
	if (patch->columns == 1 || patch->rows == 1) {
		for (int row = y; row < y + rows; row++)
			fill_quincunx_line(square, level, x, end, row);
		return;
	}
	if (square->plan->filter == GZ_FILTER_BILINEAR)
		square->filters->quincunx_mean(point_at(patch, x, y), patch->stride, first, rows,
					       end - x);
	else
		square->filters->quincunx_cubic(point_at(patch, x, y), patch->stride, first, rows,
						end - x);
}

/* Fill the points that quincunx tiles lack. */
static void fill_square_quincunx(struct square *square, int level)
{
	const struct range *needed = &square->patches[level].needed;
	enum fill fill;
	for (int y = needed->y0, bottom; y < needed->y1; y = bottom) {
		bottom = block_end(y, needed->y1);
		for (int x = needed->x0, end; x < needed->x1; x = end) {
			end = run_end(square, level, x, y, needed->x1, &fill);
			for (int row = y; row < bottom && fill == FILL_QUINCUNX; row += 2)
				fill_quincunx_rows(square, level, x, end, row, bottom);
		}
	}
}

static bool at_rim(const struct patch *patch)
{
	return patch->all.x0 == 0 || patch->all.y0 == 0 || patch->all.x1 == patch->columns ||
	       patch->all.y1 == patch->rows;
}

static void fill_square_level(struct square *square, int level)
{
	const struct patch *patch = &square->patches[level];
	fill_patch(square, level);
	if (level == 0)
		return;
	if (at_rim(patch))
		extend_beyond_rim(patch);
	if (!patch->quincunx)
		return;
	fill_square_quincunx(square, level);
	if (at_rim(patch))
		extend_beyond_rim(patch);
}

/* The finest lattice on which points were cast that the square reads. */
static int finest_cast(const struct square *square)
{
	int level = 0;
	while (!square->patches[level].cast && !square->patches[level].quincunx)
		level++;
	return level;
}

/* Fill the square with one colour if all points that it needs of a lattice have that colour.
 * Returns whether it did. */
static bool fill_flat_square(const struct square *square, int level)
{
	const struct patch *patch = &square->patches[level];
	const struct range *needed = &patch->needed;
	const uint32_t colour = *point_at(patch, needed->x0, needed->y0);
	if (!square->filters->all_are(point_at(patch, needed->x0, needed->y0), patch->stride,
				      needed->x1 - needed->x0, needed->y1 - needed->y0, colour))
		return false;
	fill_flat(square, 0, &square->patches[0].all, colour);
	return true;
}

/* Note which kinds of fill the blocks of a range need. */
static void survey_blocks(const struct square *square, int level, const struct range *range,
			  struct patch *patch)
{
	enum fill fill;
	for (int y = range->y0; y < range->y1; y = block_end(y, range->y1))
		for (int x = range->x0, end; x < range->x1; x = end) {
			end = run_end(square, level, x, y, range->x1, &fill);
			patch->cast |= fill == FILL_NONE;
			patch->quincunx |= fill == FILL_QUINCUNX;
			patch->coarser |= fill == FILL_COARSER;
		}
}

/* From columns or rows [*from, *to) of a lattice to those that they need of the next coarser one:
 * one before and two after. Starts are even, so that pairs are whole. */
static void halve_range(int *from, int *to, int count)
{
	*from = *from / 2 - 1;
	*from = *from > 0 ? *from - *from % 2 : 0;
	*to = gz_least((*to - 1) / 2 + 3, count);
}

/* Widen a range by the reach of the filters of quincunx tiles. */
static void widen_for_quincunx(int *from, int *to, int count)
{
	*from = *from > REACH ? *from - REACH - 1 : 0;
	*to = gz_least(*to + REACH, count);
}

static void lay_out_coarser(struct square *square, int level, uint32_t *memory)
{
	const struct gz_lattice *lattice = &square->lattices->layers[level];
	struct patch *patch = &square->patches[level];
	*patch = (struct patch) {
		.needed = square->patches[level - 1].all,
		.columns = lattice->columns,
		.rows = lattice->rows,
		.stride = PATCH_STRIDE,
		.first = memory + (ptrdiff_t)REACH * PATCH_STRIDE + LEFT,
	};
	halve_range(&patch->needed.x0, &patch->needed.x1, patch->columns);
	halve_range(&patch->needed.y0, &patch->needed.y1, patch->rows);
	survey_blocks(square, level, &patch->needed, patch);
	patch->all = patch->needed;
	if (!patch->quincunx)
		return;
	widen_for_quincunx(&patch->all.x0, &patch->all.x1, patch->columns);
	widen_for_quincunx(&patch->all.y0, &patch->all.y1, patch->rows);
	survey_blocks(square, level, &patch->all, patch);
}

static void lay_out_picture(struct square *square, int column, int row)
{
	const struct gz_lattice *picture = &square->lattices->layers[0];
	struct patch *patch = &square->patches[0];
	patch->all = (struct range) {
		column * SQUARE_WIDTH,
		row * SQUARE_HEIGHT,
		gz_least((column + 1) * SQUARE_WIDTH, picture->columns),
		gz_least((row + 1) * SQUARE_HEIGHT, picture->rows),
	};
	patch->needed = patch->all;
	patch->columns = picture->columns;
	patch->rows = picture->rows;
	patch->stride = (ptrdiff_t)picture->stride;
	patch->first = picture->points + patch->all.y0 * patch->stride + patch->all.x0;
	survey_blocks(square, 0, &patch->all, patch);
}

/* Lay out the square's patches. Returns the coarsest lattice that it needs. */
static int lay_out_square(struct square *square, int column, int row,
			  uint32_t memory[][PATCH_ROWS * PATCH_STRIDE])
{
	lay_out_picture(square, column, row);
	int level = 0;
	while (square->patches[level].coarser && level + 1 < square->lattices->count) {
		level++;
		lay_out_coarser(square, level, memory[level - 1]);
	}
	return level;
}

void gz_reconstruct_square(const struct gz_plan *plan, const struct gz_reconstructed *plane,
			   int column, int row)
{
	uint32_t memory[GZ_PLAN_LAYERS_MAX - 1][PATCH_ROWS * PATCH_STRIDE];
	struct square square = {
		.plan = plan,
		.lattices = plane->lattices,
		.filters = plane->filters,
		.stream = gz_reconstruct_streams(plan),
		.leaves_empty = plane->leaves_empty,
	};
	const int coarsest = lay_out_square(&square, column, row, memory);
	if (coarsest == 0)
		return;
	const int finest = finest_cast(&square);
	for (int level = coarsest; level >= 0; level--) {
		fill_square_level(&square, level);
		if (level > 0 && level == finest && fill_flat_square(&square, level))
			return;
	}
}

/* The mark of quincunx tiles of spacing 1, and how many blocks of them a scratch buffer holds. */
enum { FINEST_MARK = GZ_TILE_QUINCUNX, RUN_BLOCKS = SQUARE_WIDTH / 2 / BLOCK };

bool gz_reconstruct_has_finest(const struct gz_lattices *lattices)
{
	return memchr(lattices->blocks, FINEST_MARK,
		      (size_t)lattices->block_columns * (size_t)lattices->block_rows) != NULL;
}

/* Copy every second pixel, those with x + y even, of columns [x0, x1) of a row; outside the picture
 * the mirrored ones. Other threads may write the pixels between them. */
static void copy_cast_pixels(const struct patch *patch, const uint32_t *picture, int x0, int x1,
			     int y)
{
	const uint32_t *row = picture + (ptrdiff_t)mirrored(y, patch->rows) * patch->columns;
	for (int x = x0 + ((x0 ^ y) & 1); x < x1; x += 2)
		*point_at(patch, x, y) =
			row[x >= 0 && x < patch->columns ? x : mirrored(x, patch->columns)];
}

/* Fill a run of quincunx tiles of spacing 1 in the square's buffer, and write what they lack. */
static void fill_finest_run(struct square *square, const struct range *run, uint32_t *picture)
{
	struct patch *patch = &square->patches[0];
	patch->all = *run;
	for (int y = run->y0 - REACH; y < run->y1 + REACH; y++)
		copy_cast_pixels(patch, picture, run->x0 - REACH, run->x1 + REACH, y);
	for (int y = run->y0; y < run->y1; y += 2)
		fill_quincunx_rows(square, 0, run->x0, run->x1, y, run->y1);
	for (int y = run->y0; y < run->y1; y++)
		for (int x = run->x0 + (y % 2 == 0); x < run->x1; x += 2)
			picture[(ptrdiff_t)y * patch->columns + x] = *point_at(patch, x, y);
}

void gz_reconstruct_finest(const struct gz_plan *plan, const struct gz_reconstructed *plane,
			   int block_row)
{
	const struct gz_lattices *lattices = plane->lattices;
	const uint8_t *marks = lattices->blocks + (ptrdiff_t)block_row * lattices->block_columns;
	const uint8_t *end = marks + (plan->width + GZ_BLOCK_EDGE - 1) / GZ_BLOCK_EDGE;
	uint32_t memory[(GZ_BLOCK_EDGE + 2 * REACH + 1) * PATCH_STRIDE];
	struct square square = { .plan = plan, .lattices = lattices, .filters = plane->filters };
	square.patches[0].columns = plan->width;
	square.patches[0].rows = plan->height;
	square.patches[0].stride = PATCH_STRIDE;
	square.patches[0].first = memory + (ptrdiff_t)REACH * PATCH_STRIDE + LEFT;
	struct range run = { .y0 = block_row * GZ_BLOCK_EDGE };
	run.y1 = gz_least(run.y0 + GZ_BLOCK_EDGE, plan->height);
	for (const uint8_t *at = marks;
	     at < end && (at = memchr(at, FINEST_MARK, (size_t)(end - at))) != NULL;) {
		const uint8_t *from = at;
		while (at < end && *at == FINEST_MARK && at - from < RUN_BLOCKS)
			at++;
		run.x0 = (int)(from - marks) * GZ_BLOCK_EDGE;
		run.x1 = gz_least((int)(at - marks) * GZ_BLOCK_EDGE, plan->width);
		fill_finest_run(&square, &run, plane->picture);
	}
}

void gz_reconstruct_squares(const struct gz_plan *plan, int *out_columns, int *out_rows)
{
	*out_columns = (plan->width + SQUARE_WIDTH - 1) / SQUARE_WIDTH;
	*out_rows = (plan->height + SQUARE_HEIGHT - 1) / SQUARE_HEIGHT;
}
