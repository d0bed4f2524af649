/*
 * Pictures of regions: each row from layer to layer, the first takes its columns, the next what is
 * left on both sides, and what the first shares in its bands. A row is made in the first cache and
 * then written in one go; what was cast into the picture and is shown alone stays where it is.
 */
#include "render/reconstruct/cpu/reconstruct.h"

/* Pixels of a band whose shares are found, and that are mixed, at a time. Chosen: bands are tens of
 * pixels wide, and longer at the top and bottom of a region. */
enum { SHARES = 16, BAND = 128, PIECE = 2048 };

/* One row of the picture and the columns [from, to) of each layer. */
struct row {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	const struct gz_row_filters *filters;
	int y;
	int from[GZ_PLAN_LAYERS_MAX], to[GZ_PLAN_LAYERS_MAX];
};

static void fill(const struct row *row, int layer, int x0, int x1, uint32_t *out);

static int least(int a, int b)
{
	return a < b ? a : b;
}

static bool fades(const struct gz_region *region)
{
	return region->shape != GZ_REGION_ALL && region->blend_px > 0;
}

/* Pixels where a layer fades into those behind it, with its shares in them. */
static void fill_band(const struct row *row, int layer, int x, int count, const uint32_t *shares,
		      uint32_t *out)
{
	uint32_t behind[BAND];
	if (count == 0)
		return;
	fill(row, layer + 1, x, x + count, behind);
	row->filters->span(&row->lattices->layers[layer], row->y, x, x + count, out);
	row->filters->blend(behind, shares, out, count);
}

/* Shares rise from the rim to 256. How many pixels from x on, `most` at most, are shared; a group
 * that ends below 256 is taken as a whole. */
static int shared_from_left(const struct row *row, int layer, int x, int most, uint32_t *shares)
{
	const struct gz_region *region = &row->plan->layers[layer].region;
	int count = 0;
	while (count < most) {
		const int group = least(most - count, SHARES);
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

/* The same from the pixel before x on to the left; the last of the shares belong to them. */
static int shared_from_right(const struct row *row, int layer, int x, int most, uint32_t *shares)
{
	const struct gz_region *region = &row->plan->layers[layer].region;
	int count = 0;
	while (count < most) {
		const int group = least(most - count, SHARES);
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

/* From the left as far as the layer fades; out[0] is pixel x0. The first pixel that it does not
 * share, or x1. */
static int fill_left_band(const struct row *row, int layer, int x0, int x1, uint32_t *out)
{
	uint32_t shares[BAND];
	for (int x = x0, count; x < x1; x += count) {
		const int most = least(x1 - x, BAND);
		count = shared_from_left(row, layer, x, most, shares);
		fill_band(row, layer, x, count, shares, out + (x - x0));
		if (count < most)
			return x + count;
	}
	return x1;
}

/* From the right. The end of the pixels that the layer does not share. */
static int fill_right_band(const struct row *row, int layer, int x0, int x1, uint32_t *out)
{
	uint32_t shares[BAND];
	for (int x = x1; x > x0;) {
		const int most = least(x - x0, BAND);
		const int count = shared_from_right(row, layer, x, most, shares);
		x -= count;
		fill_band(row, layer, x, count, shares + BAND - count, out + (x - x0));
		if (count < most)
			return x;
	}
	return x0;
}

/* Pixels [x0, x1) from a layer and those behind it. */
static void fill(const struct row *row, int layer, int x0, int x1, uint32_t *out)
{
	while (layer < row->plan->layer_count && (row->from[layer] >= x1 || row->to[layer] <= x0))
		layer++;
	if (x0 >= x1 || layer == row->plan->layer_count)
		return;
	const struct gz_region *region = &row->plan->layers[layer].region;
	const int from = row->from[layer] > x0 ? row->from[layer] : x0;
	const int to = row->to[layer] < x1 ? row->to[layer] : x1;
	fill(row, layer + 1, x0, from, out);
	fill(row, layer + 1, to, x1, out + (to - x0));
	int first = from, last = to;
	if (fades(region)) {
		first = fill_left_band(row, layer, from, to, out + (from - x0));
		last = fill_right_band(row, layer, first, to, out + (first - x0));
	}
	if (first < last)
		row->filters->span(&row->lattices->layers[layer], row->y, first, last,
				   out + (first - x0));
}

/* Columns of the first layer that it shares with none behind it. */
static void unshared_columns(const struct row *row, int *out_from, int *out_to)
{
	uint32_t shares[BAND];
	int from = row->from[0], to = row->to[0];
	for (int count = BAND; fades(&row->plan->layers[0].region) && count == BAND; from += count)
		count = shared_from_left(row, 0, from, least(to - from, BAND), shares);
	for (int count = BAND; fades(&row->plan->layers[0].region) && count == BAND; to -= count)
		count = shared_from_right(row, 0, to, least(to - from, BAND), shares);
	*out_from = from;
	*out_to = to;
}

static void write_pixels(const struct row *row, int x0, int x1, uint32_t *pixels)
{
	uint32_t piece[PIECE];
	const bool stream = gz_reconstruct_streams(row->plan);
	for (int x = x0, end; x < x1; x = end) {
		end = least(x - x % PIECE + PIECE, x1);
		fill(row, 0, x, end, piece);
		row->filters->copy(piece, pixels + x, end - x, stream);
	}
}

void gz_reconstruct_row(const struct gz_plan *plan, const struct gz_lattices *lattices,
			const struct gz_row_filters *filters, uint32_t *picture, int y)
{
	uint32_t *pixels = picture + (size_t)y * (size_t)plan->width;
	struct row row = { .plan = plan, .lattices = lattices, .filters = filters, .y = y };
	for (int layer = 0; layer < plan->layer_count; layer++)
		gz_region_columns(&plan->layers[layer].region, y, plan->width, &row.from[layer],
				  &row.to[layer]);
	int from = 0, to = 0;
	if (lattices->layers[0].points == picture)
		unshared_columns(&row, &from, &to);
	write_pixels(&row, 0, from, pixels);
	write_pixels(&row, to, plan->width, pixels);
}
