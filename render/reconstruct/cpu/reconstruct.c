/*
 * From lattice points to the picture: the choice of row filters, and pictures of regions.
 * reconstruct_pyramid.c makes pictures of pyramids.
 *
 * A row of a picture of regions goes from layer to layer: the first takes its columns, the next
 * what is left on both sides and its share in the first one's bands. A row is made in the first
 * cache and then written at once; pixels that were cast into the picture and belong to one layer
 * stay.
 */
#include <stddef.h>
#include <string.h>

#include "render/reconstruct/cpu/reconstruct.h"

enum {
	ROWS_A_PART = 16,
	/* Larger pictures, bytes, are written past the caches. Chosen: more than one processor's
	 * cache; measured faster, with a copy of the picture after it, even where a shared cache
	 * would hold the picture (docs/results.md). */
	STREAM_BYTES = 4 << 20,
};

const struct gz_row_filters *gz_row_filters_find(const char *name)
{
	static const struct gz_row_filters *const all[] = {
#ifdef GZ_CAST_X86
		&gz_row_filters_avx512,
		&gz_row_filters_avx2,
#endif
		&gz_row_filters_portable,
	};
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		if (strcmp(all[i]->name, name) == 0)
			return all[i];
	return &gz_row_filters_portable;
}

bool gz_reconstruct_streams(const struct gz_plan *plan)
{
	return (size_t)plan->width * (size_t)plan->height * 4 > STREAM_BYTES;
}

/* What the threads that make a picture share. */
struct reconstruction {
	const struct gz_plan *plan;
	const struct gz_reconstructed *planes;
	int count;
	/* of a pyramid: */
	int square_columns;
	bool finest; /* gz_reconstruct_has_finest() */
};

/* Pixels of a band whose shares are found (SHARES) and mixed (BAND) at a time. Chosen: bands are
 * tens of pixels wide, and longer at the top and bottom of a region. */
enum { SHARES = 16, BAND = 128, PIECE = 2048 };

/* One row of the picture and the columns [from, to) of each layer. */
struct region_row {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	const struct gz_row_filters *filters;
	int y;
	int from[GZ_PLAN_LAYERS_MAX], to[GZ_PLAN_LAYERS_MAX];
};

static void fill_layers(const struct region_row *row, int layer, int x0, int x1, uint32_t *out);

static bool fades(const struct gz_region *region)
{
	return region->shape != GZ_REGION_ALL && region->blend_px > 0;
}

/* Mix pixels where a layer fades into the layers behind it, by the layer's shares. */
static void fill_band(const struct region_row *row, int layer, int x, int count,
		      const uint32_t *shares, uint32_t *out)
{
	uint32_t behind[BAND];
	if (count == 0)
		return;
	fill_layers(row, layer + 1, x, x + count, behind);
	row->filters->span(&row->lattices->layers[layer], row->y, x, x + count, out);
	row->filters->blend(behind, shares, out, count);
}

/* How many pixels from x on, `most` at most, the layer shares with others. Shares rise from the rim
 * to 256; a group that ends below 256 counts as a whole. */
static int shared_from_left(const struct region_row *row, int layer, int x, int most,
			    uint32_t *shares)
{
	const struct gz_region *region = &row->plan->layers[layer].region;
	int count = 0;
	while (count < most) {
		const int group = gz_least(most - count, SHARES);
		row->filters->weights(region, row->y, x + count, group, shares + count);
		if (shares[count + group - 1] >= 256) {
			while (shares[count] < 256)
				count++;
			break;
		}
		count += group;
	}
	return count;
}

/* How many pixels before x the layer shares, counted to the left; the last shares are theirs. */
static int shared_from_right(const struct region_row *row, int layer, int x, int most,
			     uint32_t *shares)
{
	const struct gz_region *region = &row->plan->layers[layer].region;
	int count = 0;
	while (count < most) {
		const int group = gz_least(most - count, SHARES);
		uint32_t *own = shares + BAND - count - group;
		row->filters->weights(region, row->y, x - count - group, group, own);
		if (own[0] >= 256) {
			while (shares[BAND - 1 - count] < 256)
				count++;
			break;
		}
		count += group;
	}
	return count;
}

/* Fill the left band of a layer; out[0] is pixel x0. Returns the first pixel that the layer does
 * not share, or x1. */
static int fill_left_band(const struct region_row *row, int layer, int x0, int x1, uint32_t *out)
{
	uint32_t shares[BAND];
	for (int x = x0, count; x < x1; x += count) {
		const int most = gz_least(x1 - x, BAND);
		count = shared_from_left(row, layer, x, most, shares);
		fill_band(row, layer, x, count, shares, out + (x - x0));
		if (count < most)
			return x + count;
	}
	return x1;
}

/* Fill the right band of a layer. Returns the end of the pixels that the layer does not share. */
static int fill_right_band(const struct region_row *row, int layer, int x0, int x1, uint32_t *out)
{
	uint32_t shares[BAND];
	for (int x = x1; x > x0;) {
		const int most = gz_least(x - x0, BAND);
		const int count = shared_from_right(row, layer, x, most, shares);
		x -= count;
		fill_band(row, layer, x, count, shares + BAND - count, out + (x - x0));
		if (count < most)
			return x;
	}
	return x0;
}

/* Fill pixels [x0, x1) from a layer and the layers behind it. */
static void fill_layers(const struct region_row *row, int layer, int x0, int x1, uint32_t *out)
{
	while (layer < row->plan->layer_count && (row->from[layer] >= x1 || row->to[layer] <= x0))
		layer++;
	if (x0 >= x1 || layer == row->plan->layer_count)
		return;
	const struct gz_region *region = &row->plan->layers[layer].region;
	const int from = row->from[layer] > x0 ? row->from[layer] : x0;
	const int to = row->to[layer] < x1 ? row->to[layer] : x1;
	fill_layers(row, layer + 1, x0, from, out);
	fill_layers(row, layer + 1, to, x1, out + (to - x0));
	int first = from, last = to;
	if (fades(region)) {
		first = fill_left_band(row, layer, from, to, out + (from - x0));
		last = fill_right_band(row, layer, first, to, out + (first - x0));
	}
	if (first < last)
		row->filters->span(&row->lattices->layers[layer], row->y, first, last,
				   out + (first - x0));
}

/* Columns of the first layer that it does not share. */
static void unshared_columns(const struct region_row *row, int *out_from, int *out_to)
{
	uint32_t shares[BAND];
	int from = row->from[0], to = row->to[0];
	for (int count = BAND; fades(&row->plan->layers[0].region) && count == BAND; from += count)
		count = shared_from_left(row, 0, from, gz_least(to - from, BAND), shares);
	for (int count = BAND; fades(&row->plan->layers[0].region) && count == BAND; to -= count)
		count = shared_from_right(row, 0, to, gz_least(to - from, BAND), shares);
	*out_from = from;
	*out_to = to;
}

static void write_pixels(const struct region_row *row, int x0, int x1, uint32_t *pixels)
{
	uint32_t piece[PIECE];
	const bool stream = gz_reconstruct_streams(row->plan);
	for (int x = x0, end; x < x1; x = end) {
		end = gz_least(x - x % PIECE + PIECE, x1);
		fill_layers(row, 0, x, end, piece);
		row->filters->copy(piece, pixels + x, end - x, stream);
	}
}

/* Fill row y of a picture of regions. */
static void fill_region_row(const struct gz_plan *plan, const struct gz_reconstructed *plane, int y)
{
	uint32_t *pixels = plane->picture + (size_t)y * (size_t)plan->width;
	struct region_row row = {
		.plan = plan,
		.lattices = plane->lattices,
		.filters = plane->filters,
		.y = y,
	};
	for (int layer = 0; layer < plan->layer_count; layer++)
		gz_region_columns(&plan->layers[layer].region, y, plan->width, &row.from[layer],
				  &row.to[layer]);
	int from = 0, to = 0;
	if (plane->lattices->layers[0].points == plane->picture)
		unshared_columns(&row, &from, &to);
	write_pixels(&row, 0, from, pixels);
	write_pixels(&row, to, plan->width, pixels);
}

static void fill_region_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct reconstruction *job = user;
	const int from = (int)part * ROWS_A_PART;
	for (int i = 0; i < job->count; i++) {
		for (int y = from; y < from + ROWS_A_PART && y < job->plan->height; y++)
			fill_region_row(job->plan, &job->planes[i], y);
		job->planes[i].filters->settle();
	}
}

static void fill_pyramid_square(void *user, size_t part, int worker)
{
	(void)worker;
	const struct reconstruction *job = user;
	for (int i = 0; i < job->count; i++) {
		struct gz_reconstructed plane = job->planes[i];
		/* Beside them, gz_reconstruct_finest() reads what is empty. */
		plane.leaves_empty = plane.leaves_empty && !job->finest;
		gz_reconstruct_square(job->plan, &plane, (int)part % job->square_columns,
				      (int)part / job->square_columns);
		job->planes[i].filters->settle();
	}
}

static void fill_finest_row(void *user, size_t part, int worker)
{
	(void)worker;
	const struct reconstruction *job = user;
	for (int i = 0; i < job->count; i++)
		gz_reconstruct_finest(job->plan, &job->planes[i], (int)part);
}

static void fill_pyramid(struct reconstruction *job, struct gz_workers *workers)
{
	int square_rows;
	const int pixel_rows = job->plan->height;
	/* All planes have the same tiles. */
	job->finest = gz_reconstruct_has_finest(job->planes[0].lattices);
	gz_reconstruct_squares(job->plan, &job->square_columns, &square_rows);
	gz_workers_run(workers, fill_pyramid_square, job,
		       (size_t)job->square_columns * (size_t)square_rows);
	if (job->finest)
		gz_workers_run(workers, fill_finest_row, job,
			       (size_t)((pixel_rows + GZ_BLOCK_EDGE - 1) / GZ_BLOCK_EDGE));
}

void gz_reconstruct_planes(const struct gz_plan *plan, const struct gz_reconstructed planes[],
			   int count, struct gz_workers *workers)
{
	struct reconstruction job = { .plan = plan, .planes = planes, .count = count };
	switch (plan->reconstruction) {
	case GZ_RECONSTRUCT_DIRECT:
		return;
	case GZ_RECONSTRUCT_PYRAMID:
		fill_pyramid(&job, workers);
		return;
	case GZ_RECONSTRUCT_REGIONS:
		gz_workers_run(workers, fill_region_rows, &job,
			       ((size_t)plan->height + ROWS_A_PART - 1) / ROWS_A_PART);
		return;
	}
}

void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    uint32_t *picture)
{
	const struct gz_reconstructed plane = { lattices, filters, picture, false };
	gz_reconstruct_planes(plan, &plane, 1, workers);
}
