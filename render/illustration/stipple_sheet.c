#include "render/illustration/stipple_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	BAND_ROWS = 32, /* chosen: more bands than threads, and few marks that touch two */
	BLOCK = 8,      /* pixels at once; rows may be written so far beyond their end */
};

enum gz_result gz_stipple_sheet_clear_strip(struct gz_stipple_sheet *sheet, int width, int top,
					    int height)
{
	if (width < 1 || height < 1 || top < 0 || width > GZ_STIPPLE_SIDE_MAX ||
	    height > GZ_STIPPLE_SIDE_MAX || top > GZ_STIPPLE_SIDE_MAX - height)
		return GZ_ERR_INVAL;
	const size_t stride = (size_t)(width + BLOCK + 63) / 64 * 64;
	const size_t size = stride * (size_t)height;
	const size_t bands = ((size_t)height + BAND_ROWS - 1) / BAND_ROWS;
	if (size > sheet->capacity || bands > sheet->band_capacity) {
		uint8_t *ink = aligned_alloc(64, size);
		size_t *ends = calloc(bands, sizeof *ends);
		if (!ink || !ends) {
			free(ink);
			free(ends);
			return GZ_ERR_NO_MEM;
		}
		free(sheet->ink);
		free(sheet->band_ends);
		sheet->ink = ink;
		sheet->capacity = size;
		sheet->band_ends = ends;
		sheet->band_capacity = bands;
	}
	sheet->width = width;
	sheet->height = height;
	sheet->stride = stride;
	sheet->top = top;
	memset(sheet->ink, 0, size);
	return GZ_OK;
}

enum gz_result gz_stipple_sheet_clear(struct gz_stipple_sheet *sheet, int width, int height)
{
	if (width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	return gz_stipple_sheet_clear_strip(sheet, width, 0, height);
}

/* Rows [from, to) of a sheet that a mark touches. */
struct row_range {
	int from, to;
};

/* Those of [from, to) between two places. */
static struct row_range rows_between(float least, float greatest, struct row_range all)
{
	struct row_range range = { all.from, all.from };
	if (!(greatest >= (float)all.from) || !(least <= (float)(all.to - 1)))
		return range; /* also if a number is NaN */
	range.from = least > (float)all.from ? (int)ceilf(least) : all.from;
	range.to = greatest < (float)(all.to - 1) ? (int)greatest + 1 : all.to;
	return range;
}

static struct row_range rows_of_sheet(const struct gz_stipple_sheet *sheet)
{
	return (struct row_range) { sheet->top, sheet->top + sheet->height };
}

/* How far the rim of a disc reaches: where its ink of ink_of_disc() ends. */
static float disc_reach(float radius)
{
	return sqrtf(radius * radius + radius);
}

static struct row_range rows_of_disc(const void *marks, size_t number, struct row_range all)
{
	const struct gz_stipple_disc *disc = (const struct gz_stipple_disc *)marks + number;
	const float reach = disc_reach(disc->radius);
	return rows_between(disc->y - reach, disc->y + reach, all);
}

/* How far a piece reaches across its line. */
static float piece_reach(const struct gz_stipple_piece *piece)
{
	return fmaxf(piece->from_width, piece->to_width) / 2 + 0.5F;
}

static struct row_range rows_of_piece(const void *marks, size_t number, struct row_range all)
{
	const struct gz_stipple_piece *piece = (const struct gz_stipple_piece *)marks + number;
	const float reach = piece_reach(piece);
	return rows_between(fminf(piece->from[1], piece->to[1]) - reach,
			    fmaxf(piece->from[1], piece->to[1]) + reach, all);
}

/* A kind of marks: which rows each touches, and how it is drawn there. */
struct mark_kind {
	struct row_range (*rows)(const void *marks, size_t number, struct row_range all);
	void (*draw)(struct gz_stipple_sheet *sheet, const void *marks, size_t number,
		     struct row_range within);
};

struct mark_job {
	struct gz_stipple_sheet *sheet;
	const struct mark_kind *kind;
	const void *marks;
};

static size_t count_bands(const struct gz_stipple_sheet *sheet)
{
	return ((size_t)sheet->height + BAND_ROWS - 1) / BAND_ROWS;
}

/* The rows of a band that a mark touches. */
static struct row_range rows_in_band(const struct mark_job *job, size_t mark, size_t band)
{
	struct row_range rows = job->kind->rows(job->marks, mark, rows_of_sheet(job->sheet));
	const int from = job->sheet->top + (int)band * BAND_ROWS;
	rows.from = rows.from > from ? rows.from : from;
	rows.to = rows.to < from + BAND_ROWS ? rows.to : from + BAND_ROWS;
	return rows;
}

static void draw_band(void *user, size_t band, int worker)
{
	(void)worker;
	const struct mark_job *job = user;
	const struct gz_stipple_sheet *sheet = job->sheet;
	for (size_t i = band > 0 ? sheet->band_ends[band - 1] : 0; i < sheet->band_ends[band]; i++)
		job->kind->draw(job->sheet, job->marks, sheet->band_marks[i],
				rows_in_band(job, sheet->band_marks[i], band));
}

static enum gz_result reserve_band_marks(struct gz_stipple_sheet *sheet, size_t count)
{
	if (count <= sheet->band_mark_capacity)
		return GZ_OK;
	uint32_t *marks = malloc((count + count / 4) * sizeof *marks);
	if (!marks)
		return GZ_ERR_NO_MEM;
	free(sheet->band_marks);
	sheet->band_marks = marks;
	sheet->band_mark_capacity = count + count / 4;
	return GZ_OK;
}

/* Lists the marks of each band in their order. */
static enum gz_result list_bands(const struct mark_job *job, size_t count)
{
	struct gz_stipple_sheet *sheet = job->sheet;
	size_t *ends = sheet->band_ends, sum = 0;
	memset(ends, 0, count_bands(sheet) * sizeof *ends);
	for (size_t i = 0; i < count; i++) {
		const struct row_range rows = job->kind->rows(job->marks, i, rows_of_sheet(sheet));
		for (int band = (rows.from - sheet->top) / BAND_ROWS;
		     band * BAND_ROWS < rows.to - sheet->top; band++)
			ends[band]++;
	}
	for (size_t band = 0; band < count_bands(sheet); band++) {
		const size_t own = ends[band];
		ends[band] = sum; /* while lists are filled, where the next mark goes */
		sum += own;
	}
	const enum gz_result result = reserve_band_marks(sheet, sum);
	for (size_t i = 0; result == GZ_OK && i < count; i++) {
		const struct row_range rows = job->kind->rows(job->marks, i, rows_of_sheet(sheet));
		for (int band = (rows.from - sheet->top) / BAND_ROWS;
		     band * BAND_ROWS < rows.to - sheet->top; band++)
			sheet->band_marks[ends[band]++] = (uint32_t)i;
	}
	return result;
}

static enum gz_result add_marks(struct mark_job *job, size_t count, struct gz_workers *workers)
{
	if (count > UINT32_MAX)
		return GZ_ERR_FULL;
	const enum gz_result result = list_bands(job, count);
	if (result != GZ_OK)
		return result;
	const size_t bands = count_bands(job->sheet);
	if (workers)
		gz_workers_run(workers, draw_band, job, bands);
	else
		for (size_t band = 0; band < bands; band++)
			draw_band(job, band, 0);
	return GZ_OK;
}

/* Columns [from, to) of a sheet between two places. */
static struct row_range columns_between(const struct gz_stipple_sheet *sheet, float least,
					float greatest)
{
	return rows_between(least, greatest, (struct row_range) { 0, sheet->width });
}

static void add_ink(uint8_t ink[BLOCK], const float shares[BLOCK])
{
	for (int i = 0; i < BLOCK; i++) {
		const int sum = ink[i] + (int)(shares[i] * 255 + 0.5F);
		ink[i] = (uint8_t)(sum < 255 ? sum : 255);
	}
}

/* A disc as its drawing needs it, in units of ink. */
struct disc_frame {
	float middle, slope, most; /* ink at the centre, its fall with d², and its bound */
};

/* The share of a pixel that a disc covers falls linearly with the square of the distance, by
 * (r² - d²) / 2r + 1/2, which is about r - d + 1/2 at the rim. Its integral over the plane is pi r²
 * for r >= 1; below, the share at the centre would not reach 1, and 4 r / (r + 1)² restores it. */
static struct disc_frame frame_of_disc(float r)
{
	const float most = r < 1 ? 255 * 4 * r / ((r + 1) * (r + 1)) : 255;
	return (struct disc_frame) { most * (0.5F + r / 2), most / (2 * r), most };
}

/* The ink of a pixel, rounded. */
static int rounded_ink(float ink, float most)
{
	const float within = ink < 0 ? 0 : ink > most ? most : ink;
	return (int)(within + 0.5F);
}

/* Draws pixels [from, to) of a row; @p at_row is the ink below the centre. */
static void draw_disc_row(uint8_t *row, struct row_range columns, float centre, float at_row,
			  const struct disc_frame *frame)
{
	for (int x = columns.from; x < columns.to; x++) {
		const float dx = (float)x - centre;
		const int sum = row[x] + rounded_ink(at_row - frame->slope * dx * dx, frame->most);
		row[x] = (uint8_t)(sum < 255 ? sum : 255);
	}
}

static void draw_disc(struct gz_stipple_sheet *sheet, const void *marks, size_t number,
		      struct row_range within)
{
	const struct gz_stipple_disc *disc = (const struct gz_stipple_disc *)marks + number;
	const float reach = disc_reach(disc->radius);
	const struct disc_frame frame = frame_of_disc(disc->radius);
	const struct row_range columns = columns_between(sheet, disc->x - reach, disc->x + reach);
	for (int y = within.from; y < within.to; y++) {
		const float dy = (float)y - disc->y;
		draw_disc_row(sheet->ink + (size_t)(y - sheet->top) * sheet->stride, columns,
			      disc->x, frame.middle - frame.slope * dy * dy, &frame);
	}
}

/* A piece as its drawing needs it. */
struct piece_frame {
	float along[2], length;     /* unit vector from end to end, px */
	float half_width, widening; /* at the first end, and by px along the line */
};

/* The share of a pixel that a line of half width h covers is h + 1/2 less the distance from its
 * middle, within 0 to 1: of integral 2 h across the line for h >= 1/2. Below, 2 h / (h + 1/2)²
 * restores it. */
static float line_share(const struct piece_frame *frame, float dx, float dy)
{
	const float t = dx * frame->along[0] + dy * frame->along[1];
	const float across = fabsf(dx * frame->along[1] - dy * frame->along[0]);
	const float half = frame->half_width + frame->widening * t;
	const float rim = half + 0.5F;
	const float strength = half < 0.5F ? 2 * half / (rim * rim) : 1;
	const float share = rim - across;
	const float within = share < 0 ? 0 : share > 1 ? 1 : share;
	return t >= 0 && t < frame->length ? strength * within : 0;
}

static void draw_piece(struct gz_stipple_sheet *sheet, const void *marks, size_t number,
		       struct row_range within)
{
	const struct gz_stipple_piece *piece = (const struct gz_stipple_piece *)marks + number;
	const float run[2] = { piece->to[0] - piece->from[0], piece->to[1] - piece->from[1] };
	struct piece_frame frame = { .length = sqrtf(run[0] * run[0] + run[1] * run[1]),
				     .half_width = piece->from_width / 2 };
	if (!(frame.length > 0))
		return;
	frame.along[0] = run[0] / frame.length;
	frame.along[1] = run[1] / frame.length;
	frame.widening = (piece->to_width - piece->from_width) / 2 / frame.length;
	const float reach = piece_reach(piece);
	const struct row_range columns =
		columns_between(sheet, fminf(piece->from[0], piece->to[0]) - reach,
				fmaxf(piece->from[0], piece->to[0]) + reach);
	for (int y = within.from; y < within.to; y++) {
		uint8_t *row = sheet->ink + (size_t)(y - sheet->top) * sheet->stride;
		for (int x = columns.from; x < columns.to; x += BLOCK) {
			float shares[BLOCK];
			for (int i = 0; i < BLOCK; i++)
				shares[i] = line_share(&frame, (float)(x + i) - piece->from[0],
						       (float)y - piece->from[1]);
			add_ink(row + x, shares);
		}
	}
}

enum gz_result gz_stipple_sheet_add_discs(struct gz_stipple_sheet *sheet,
					  const struct gz_stipple_disc *discs, size_t count,
					  struct gz_workers *workers)
{
	static const struct mark_kind kind = { rows_of_disc, draw_disc };
	struct mark_job job = { sheet, &kind, discs };
	return add_marks(&job, count, workers);
}

enum gz_result gz_stipple_sheet_add_pieces(struct gz_stipple_sheet *sheet,
					   const struct gz_stipple_piece *pieces, size_t count,
					   struct gz_workers *workers)
{
	static const struct mark_kind kind = { rows_of_piece, draw_piece };
	struct mark_job job = { sheet, &kind, pieces };
	return add_marks(&job, count, workers);
}

enum gz_result gz_stipple_sheet_to_image(const struct gz_stipple_sheet *sheet,
					 struct gz_image *image)
{
	const enum gz_result result = gz_image_resize(image, sheet->width, sheet->height);
	if (result != GZ_OK)
		return result;
	uint8_t *pixel = image->pixels;
	for (int y = 0; y < sheet->height; y++)
		for (int x = 0; x < sheet->width; x++, pixel += 4) {
			memset(pixel, 255 - sheet->ink[(size_t)y * sheet->stride + (size_t)x], 3);
			pixel[3] = 255;
		}
	return GZ_OK;
}

void gz_stipple_sheet_free(struct gz_stipple_sheet *sheet)
{
	free(sheet->ink);
	free(sheet->band_marks);
	free(sheet->band_ends);
	*sheet = (struct gz_stipple_sheet) { 0 };
}
