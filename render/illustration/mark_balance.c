#include "render/illustration/mark_balance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/hatch_lines.h"
#include "render/illustration/stipple_tone.h"

enum {
	LEVELS_MAX = 7, /* of tents: the widest are 64 times as wide */
	PART_ROWS = 16,
	PART_PIECES = 4096,
};

/* Distance of the lattice's points, in widths of lines or discs, and at least. Chosen: a tent has
 * some marks at most tones, and squares of 32 px have some tents. */
#define CELL_WIDTHS   6.0
#define CELL_DISCS    8.0
#define CELL_LEAST_PX 8.0

/* What is summed over the tents of a level. */
struct tent_level {
	int columns, rows;
	float *area, *wanted, *drawn; /* pixels that count; their ink, wanted and drawn */
};

struct balancing {
	const struct gz_mark_target *target;
	struct gz_mark_balance *balance;
	struct gz_stipple_piece *pieces; /* the marks; NULL: discs */
	struct gz_stipple_disc *discs;
	size_t count;
	float change_most;       /* most that a factor is multiplied or divided by */
	int width, height, cell; /* of the picture, and the distance of the lattice's points, px */
	int level_count;
	struct tent_level levels[LEVELS_MAX];
	float *factors; /* of the lattice's points: what widths are multiplied by */
	/* What is summed: bytes of the picture where the mask says so; and for each row of cells
	 * the sums of the points above it, and below. */
	const uint8_t *summed;
	size_t summed_stride;
	float *row_parts;
	bool area_known; /* levels[0].area is there */
};

static void run_parts(struct balancing *balancing, gz_workers_part *part, size_t count,
		      struct gz_workers *workers)
{
	if (workers)
		gz_workers_run(workers, part, balancing, count);
	else
		for (size_t i = 0; i < count; i++)
			part(balancing, i, 0);
}

static bool is_drawn(const struct gz_mark_target *target, size_t pixel)
{
	const size_t id = target->ids->words[pixel];
	return id >= 1 && id <= target->drawn_count && target->drawn[id - 1];
}

/* The ink that a pixel is to have, in units of 1/255, rounded. */
static uint8_t ink_wanted(const struct gz_plane *tone, size_t pixel)
{
	float brightness;
	memcpy(&brightness, &tone->words[pixel], sizeof brightness);
	const float ink = 1 - brightness;
	return !(ink > 0) ? 0 : (uint8_t)lroundf(255 * fminf(ink, GZ_STIPPLE_DARKEST));
}

static void take_rows(void *user, size_t part, int worker)
{
	const struct balancing *balancing = user;
	const struct gz_mark_balance *balance = balancing->balance;
	const size_t width = (size_t)balancing->width, pixels = width * (size_t)balancing->height;
	const size_t end = (part + 1) * PART_ROWS * width;
	(void)worker;
	for (size_t i = part * PART_ROWS * width; i < end && i < pixels; i++) {
		const bool counts = is_drawn(balancing->target, i);
		balance->mask[i] = counts;
		balance->wanted[i] = counts ? ink_wanted(balancing->target->tone, i) : 0;
	}
}

/* Sums over a part of a row: all, and with weights 0, 1, 2 ... from its beginning. */
static void sum_bytes(const uint8_t *values, const uint8_t *mask, int count, uint32_t out_sums[2])
{
	uint32_t sum = 0, rising = 0;
	for (int i = 0; i < count; i++) {
		const uint32_t value = (uint32_t)values[i] * mask[i];
		sum += value;
		rising += (uint32_t)i * value;
	}
	out_sums[0] = sum;
	out_sums[1] = rising;
}

/* Whether no pixel of a cell counts, as far as that is known. */
static bool cell_is_empty(const struct balancing *balancing, size_t row, int column)
{
	const struct tent_level *lattice = &balancing->levels[0];
	const float *above = lattice->area + row * (size_t)lattice->columns + column;
	const float *below = above + lattice->columns;
	return balancing->area_known && above[0] + above[1] + below[0] + below[1] == 0;
}

/* Sums of the lattice's points above and below a row of cells. */
static void sum_cell_row(void *user, size_t part, int worker)
{
	const struct balancing *balancing = user;
	const int columns = balancing->levels[0].columns, cell = balancing->cell;
	float *sums = balancing->row_parts + part * 2 * (size_t)columns;
	const int first = (int)part * cell;
	(void)worker;
	memset(sums, 0, 2 * (size_t)columns * sizeof *sums);
	for (int y = first; y < first + cell && y < balancing->height; y++) {
		const float below = ((float)(y - first) + 0.5F) / (float)cell;
		const uint8_t *row = balancing->summed + (size_t)y * balancing->summed_stride;
		const uint8_t *mask =
			balancing->balance->mask + (size_t)y * (size_t)balancing->width;
		for (int column = 0; column < columns - 1; column++) {
			const int from = column * cell, left = balancing->width - from;
			uint32_t of[2];
			if (cell_is_empty(balancing, part, column))
				continue;
			sum_bytes(row + from, mask + from, left < cell ? left : cell, of);
			const float all = (float)of[0];
			const float right = ((float)of[1] + 0.5F * all) / (float)cell;
			sums[column] += (1 - below) * (all - right);
			sums[column + 1] += (1 - below) * right;
			sums[columns + column] += below * (all - right);
			sums[columns + column + 1] += below * right;
		}
	}
}

/* Sums of all points of the lattice. */
static void sum_lattice(struct balancing *balancing, float *out_sums, struct gz_workers *workers)
{
	const struct tent_level *lattice = &balancing->levels[0];
	const size_t columns = (size_t)lattice->columns, points = columns * (size_t)lattice->rows;
	const size_t cell_rows = (size_t)lattice->rows - 1;
	run_parts(balancing, sum_cell_row, cell_rows, workers);
	memset(out_sums, 0, points * sizeof *out_sums);
	for (size_t row = 0; row < cell_rows; row++)
		for (size_t i = 0; i < 2 * columns; i++)
			out_sums[row * columns + i] += balancing->row_parts[row * 2 * columns + i];
}

/* The sums of tents that are twice as wide. */
static void sum_wider(const struct tent_level *from, const float *sums, const struct tent_level *to,
		      float *out_sums)
{
	for (int row = 0; row < to->rows; row++)
		for (int column = 0; column < to->columns; column++) {
			float sum = 0;
			for (int k = 0; k < 9; k++) {
				const int x = 2 * column + k % 3 - 1, y = 2 * row + k / 3 - 1;
				const float weight =
					(k % 3 == 1 ? 1.0F : 0.5F) * (k / 3 == 1 ? 1.0F : 0.5F);
				if (x >= 0 && y >= 0 && x < from->columns && y < from->rows)
					sum += weight * sums[y * from->columns + x];
			}
			out_sums[row * to->columns + column] = sum;
		}
}

/* A place in a lattice of points, by its lower corner and shares. */
static float value_between(const float *values, int columns, int rows, float x, float y)
{
	const int column = x < 0 ? 0 : (int)x < columns - 2 ? (int)x : columns - 2;
	const int row = y < 0 ? 0 : (int)y < rows - 2 ? (int)y : rows - 2;
	const float right = fminf(fmaxf(x - (float)column, 0), 1);
	const float down = fminf(fmaxf(y - (float)row, 0), 1);
	const float *above = values + (ptrdiff_t)row * columns + column, *below = above + columns;
	const float upper = above[0] + right * (above[1] - above[0]);
	const float lower = below[0] + right * (below[1] - below[0]);
	return upper + down * (lower - upper);
}

/* What the tents of a level sum around a point of that level. */
struct tent_sums {
	float area, wanted, drawn;
};

/* Those of a level, at a point of another level whose tents are half as wide. */
static struct tent_sums wider_sums(const struct tent_level *level, int column, int row)
{
	const float x = (float)column / 2, y = (float)row / 2;
	return (struct tent_sums) {
		value_between(level->area, level->columns, level->rows, x, y),
		value_between(level->wanted, level->columns, level->rows, x, y),
		value_between(level->drawn, level->columns, level->rows, x, y),
	};
}

/* The marks' area for each area of the picture that covers a share of the paper. */
static float density_of(const struct balancing *balancing, float ink)
{
	return balancing->discs ? gz_stipple_density(ink, 1, (float)balancing->target->size_px / 2)
				: gz_hatch_density(ink);
}

/* How much denser the marks around a point must be. Where much of a tent does not count, as at
 * rims, few lines would tell, and come and go as the view turns: the wider tents fill in for it. */
static float ratio_of_point(const struct balancing *balancing, int level, int column, int row)
{
	const struct tent_level *tents = &balancing->levels[level];
	const int point = row * tents->columns + column;
	const float full = (float)((balancing->cell << level) * (balancing->cell << level));
	struct tent_sums sums = { tents->area[point], tents->wanted[point], tents->drawn[point] };
	if (sums.area < full && level + 1 < balancing->level_count) {
		const struct tent_sums wider =
			wider_sums(&balancing->levels[level + 1], column, row);
		const float share = 1 - sums.area / full;
		sums.area += share * wider.area;
		sums.wanted += share * wider.wanted;
		sums.drawn += share * wider.drawn;
	}
	if (!(sums.area > 0) || !(sums.wanted > 0))
		return 1;
	const float wanted = density_of(balancing, sums.wanted / sums.area / 255);
	const float drawn = density_of(balancing, sums.drawn / sums.area / 255);
	return drawn > 0 ? wanted / drawn : balancing->change_most;
}

/* That of a level's ratios, which lie in level->drawn, at a point of the lattice. */
static float ratio_at(const struct balancing *balancing, int level, int column, int row)
{
	const struct tent_level *tents = &balancing->levels[level];
	const float step = (float)(1 << level);
	return value_between(tents->drawn, tents->columns, tents->rows, (float)column / step,
			     (float)row / step);
}

/* Which tents a point of the lattice is compared by: larger marks need wider ones. */
static float level_of_point(const struct balancing *balancing, int column, int row)
{
	const float scale =
		gz_stipple_scale_at(balancing->target->scale, (float)(column * balancing->cell),
				    (float)(row * balancing->cell));
	return fminf(log2f(fmaxf(scale, 1)), (float)(balancing->level_count - 1));
}

/* Compares what is drawn with what is wanted, and changes the factors. */
static void change_factors(struct balancing *balancing)
{
	const struct tent_level *lattice = &balancing->levels[0];
	for (int level = 1; level < balancing->level_count; level++)
		sum_wider(&balancing->levels[level - 1], balancing->levels[level - 1].drawn,
			  &balancing->levels[level], balancing->levels[level].drawn);
	for (int level = 0; level < balancing->level_count; level++) {
		const struct tent_level *tents = &balancing->levels[level];
		for (int row = 0; row < tents->rows; row++)
			for (int column = 0; column < tents->columns; column++)
				tents->drawn[row * tents->columns + column] =
					ratio_of_point(balancing, level, column, row);
	}
	for (int row = 0; row < lattice->rows; row++)
		for (int column = 0; column < lattice->columns; column++) {
			const float at = level_of_point(balancing, column, row);
			const int low = (int)at;
			const float share = at - (float)low;
			float ratio = ratio_at(balancing, low, column, row);
			if (share > 0)
				ratio +=
					share * (ratio_at(balancing, low + 1, column, row) - ratio);
			float *factor = &balancing->factors[row * lattice->columns + column];
			*factor = fminf(fmaxf(*factor * ratio, 1 / balancing->change_most),
					balancing->change_most);
		}
}

static float factor_at(const struct balancing *balancing, const float place[2])
{
	const struct tent_level *lattice = &balancing->levels[0];
	const float cell = (float)balancing->cell;
	return value_between(balancing->factors, lattice->columns, lattice->rows,
			     (place[0] + 0.5F) / cell, (place[1] + 0.5F) / cell);
}

static void change_widths(void *user, size_t part, int worker)
{
	const struct balancing *balancing = user;
	const size_t end = (part + 1) * PART_PIECES;
	(void)worker;
	for (size_t i = part * PART_PIECES; i < end && i < balancing->count; i++) {
		const float *widths = balancing->balance->widths + 2 * i;
		struct gz_stipple_piece *piece = &balancing->pieces[i];
		piece->from_width = fminf(widths[0] * factor_at(balancing, piece->from),
					  GZ_STIPPLE_MARK_MAX_PX);
		piece->to_width =
			fminf(widths[1] * factor_at(balancing, piece->to), GZ_STIPPLE_MARK_MAX_PX);
	}
}

static void change_radii(void *user, size_t part, int worker)
{
	const struct balancing *balancing = user;
	const size_t end = (part + 1) * PART_PIECES;
	(void)worker;
	for (size_t i = part * PART_PIECES; i < end && i < balancing->count; i++) {
		struct gz_stipple_disc *disc = &balancing->discs[i];
		const float place[2] = { disc->x, disc->y };
		disc->radius =
			fminf(balancing->balance->widths[i] * sqrtf(factor_at(balancing, place)),
			      GZ_STIPPLE_MARK_MAX_PX);
	}
}

static enum gz_result draw_marks(struct balancing *balancing, struct gz_workers *workers)
{
	struct gz_stipple_sheet *sheet = &balancing->balance->sheet;
	const enum gz_result result =
		gz_stipple_sheet_clear(sheet, balancing->width, balancing->height);
	if (result != GZ_OK)
		return result;
	return balancing->discs ? gz_stipple_sheet_add_discs(sheet, balancing->discs,
							     balancing->count, workers)
				: gz_stipple_sheet_add_pieces(sheet, balancing->pieces,
							      balancing->count, workers);
}

/* Draws the marks, and changes their sizes by what they draw. */
static enum gz_result run_round(struct balancing *balancing, struct gz_workers *workers)
{
	const struct gz_stipple_sheet *sheet = &balancing->balance->sheet;
	const enum gz_result result = draw_marks(balancing, workers);
	if (result != GZ_OK)
		return result;
	balancing->summed = sheet->ink;
	balancing->summed_stride = sheet->stride;
	sum_lattice(balancing, balancing->levels[0].drawn, workers);
	change_factors(balancing);
	run_parts(balancing, balancing->discs ? change_radii : change_widths,
		  (balancing->count + PART_PIECES - 1) / PART_PIECES, workers);
	return GZ_OK;
}

/* ---- room ---- */

/* Room for as many bytes; what was there is lost. */
static bool reserve_room(void **room, size_t *size, size_t wanted)
{
	if (wanted <= *size)
		return true;
	free(*room);
	*room = malloc(wanted);
	*size = *room ? wanted : 0;
	return *room;
}

/* How many widths of tents a scale asks for: that of the largest marks, and one to fill in. */
static int count_levels(const struct gz_stipple_scale *scale)
{
	float most = 1;
	for (int i = 0; scale && scale->factors && i < scale->columns * scale->rows; i++)
		most = fmaxf(most, scale->factors[i]);
	const int count = 3 + (int)log2f(most);
	return count < LEVELS_MAX ? count : LEVELS_MAX;
}

/* Lays the lattice and all sums out in one block. */
static bool make_levels(struct balancing *balancing)
{
	struct gz_mark_balance *balance = balancing->balance;
	size_t floats = 0;
	int columns = (balancing->width - 1) / balancing->cell + 2;
	int rows = (balancing->height - 1) / balancing->cell + 2;
	balancing->level_count = count_levels(balancing->target->scale);
	for (int level = 0; level < balancing->level_count; level++) {
		balancing->levels[level] = (struct tent_level) { .columns = columns, .rows = rows };
		floats += 3 * (size_t)columns * (size_t)rows;
		columns = columns / 2 + 1 > 2 ? columns / 2 + 1 : 2;
		rows = rows / 2 + 1 > 2 ? rows / 2 + 1 : 2;
	}
	const struct tent_level *lattice = &balancing->levels[0];
	const size_t points = (size_t)lattice->columns * (size_t)lattice->rows;
	if (!reserve_room((void **)&balance->sums, &balance->sums_size,
			  (floats + 3 * points) * sizeof *balance->sums))
		return false;
	float *next = balance->sums;
	for (int level = 0; level < balancing->level_count; level++) {
		struct tent_level *tents = &balancing->levels[level];
		const size_t own = (size_t)tents->columns * (size_t)tents->rows;
		tents->area = next;
		tents->wanted = next + own;
		tents->drawn = next + 2 * own;
		next += 3 * own;
	}
	balancing->factors = next;
	balancing->row_parts = next + points;
	for (size_t i = 0; i < points; i++)
		balancing->factors[i] = 1;
	return true;
}

static bool target_fits(const struct gz_mark_target *target)
{
	const struct gz_plane *tone = target->tone, *ids = target->ids;
	return tone->kind == GZ_PLANE_VALUE && ids->kind == GZ_PLANE_ID && tone->width >= 1 &&
	       tone->height >= 1 && tone->width == ids->width && tone->height == ids->height &&
	       target->size_px > 0 && target->size_px <= GZ_STIPPLE_MARK_MAX_PX;
}

/* What is wanted, at all widths of tents. */
static void sum_wanted(struct balancing *balancing, struct gz_workers *workers)
{
	const struct gz_mark_balance *balance = balancing->balance;
	struct tent_level *levels = balancing->levels;
	run_parts(balancing, take_rows, ((size_t)balancing->height + PART_ROWS - 1) / PART_ROWS,
		  workers);
	balancing->summed_stride = (size_t)balancing->width;
	balancing->summed = balance->mask;
	sum_lattice(balancing, levels[0].area, workers);
	balancing->area_known = true;
	balancing->summed = balance->wanted;
	sum_lattice(balancing, levels[0].wanted, workers);
	for (int level = 1; level < balancing->level_count; level++) {
		sum_wider(&levels[level - 1], levels[level - 1].area, &levels[level],
			  levels[level].area);
		sum_wider(&levels[level - 1], levels[level - 1].wanted, &levels[level],
			  levels[level].wanted);
	}
}

static bool make_room(struct balancing *balancing)
{
	struct gz_mark_balance *balance = balancing->balance;
	const size_t pixels = (size_t)balancing->width * (size_t)balancing->height;
	return reserve_room((void **)&balance->mask, &balance->mask_size, pixels) &&
	       reserve_room((void **)&balance->wanted, &balance->wanted_size, pixels) &&
	       reserve_room((void **)&balance->widths, &balance->widths_size,
			    2 * balancing->count * sizeof *balance->widths) &&
	       make_levels(balancing);
}

/* Remembers the sizes of marks. */
static void note_sizes(const struct balancing *balancing)
{
	float *sizes = balancing->balance->widths;
	for (size_t i = 0; i < balancing->count; i++) {
		if (balancing->discs) {
			sizes[i] = balancing->discs[i].radius;
			continue;
		}
		sizes[2 * i] = balancing->pieces[i].from_width;
		sizes[2 * i + 1] = balancing->pieces[i].to_width;
	}
}

static enum gz_result balance_marks(struct balancing *balancing, struct gz_workers *workers)
{
	const struct gz_mark_target *target = balancing->target;
	if (!target_fits(target))
		return GZ_ERR_INVAL;
	if (balancing->count == 0)
		return GZ_OK;
	const double widths = balancing->discs ? CELL_DISCS : CELL_WIDTHS;
	balancing->width = target->tone->width;
	balancing->height = target->tone->height;
	balancing->cell = (int)ceil(fmax(CELL_LEAST_PX, widths * target->size_px));
	if (!make_room(balancing))
		return GZ_ERR_NO_MEM;
	note_sizes(balancing);
	sum_wanted(balancing, workers);
	enum gz_result result = GZ_OK;
	for (int round = 0; round < GZ_MARK_ROUNDS && result == GZ_OK; round++)
		result = run_round(balancing, workers);
	return result;
}

enum gz_result gz_mark_balance_lines(struct gz_mark_balance *balance,
				     const struct gz_mark_target *target,
				     struct gz_stipple_piece *pieces, size_t count,
				     struct gz_workers *workers)
{
	struct balancing balancing = { .target = target,
				       .balance = balance,
				       .pieces = pieces,
				       .count = count,
				       .change_most = GZ_HATCH_WIDTH_CHANGE };
	return balance_marks(&balancing, workers);
}

enum gz_result gz_mark_balance_discs(struct gz_mark_balance *balance,
				     const struct gz_mark_target *target,
				     struct gz_stipple_disc *discs, size_t count,
				     struct gz_workers *workers)
{
	struct balancing balancing = { .target = target,
				       .balance = balance,
				       .discs = discs,
				       .count = count,
				       .change_most = GZ_STIPPLE_RADIUS_CHANGE *
						      GZ_STIPPLE_RADIUS_CHANGE };
	return balance_marks(&balancing, workers);
}

void gz_mark_balance_free(struct gz_mark_balance *balance)
{
	gz_stipple_sheet_free(&balance->sheet);
	free(balance->mask);
	free(balance->wanted);
	free(balance->widths);
	free(balance->sums);
	*balance = (struct gz_mark_balance) { 0 };
}
