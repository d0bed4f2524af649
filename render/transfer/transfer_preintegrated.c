#include "render/transfer/transfer_preintegrated.h"

#include <math.h>

enum {
	PARTS = 4, /* of a segment, whose order is kept */
	BLOCK_ROWS = 64 / sizeof(struct gz_transfer_entry),
};
/* Sums at the ends of quarters are taken between entries. */
_Static_assert(GZ_PREINTEGRATED_STRIDE(GZ_TRANSFER_TABLE_SIZE) % PARTS == 0,
	       "quarters of a segment end between entries");

/* Extinction that stands for opaque, times the entries of the usual table over those of the table.
 * Chosen: a segment of 1/32 voxel length over all values, of which one entry is opaque, transmits
 * 2^-76; and rounding errors of sums in double precision stay far below what is visible. */
static const double OPAQUE = 1e7;

void gz_transfer_sums_make(const struct gz_transfer_table *table, struct gz_transfer_sums *out_sums)
{
	const double opaque = OPAQUE * (table->count / GZ_TRANSFER_TABLE_SIZE);
	out_sums->count = table->count;
	for (int channel = 0; channel < 4; channel++)
		out_sums->sum[0][channel] = 0;
	for (int i = 0; i < table->count; i++) {
		const uint32_t colour = table->entries[i].colour;
		const double extinction = fmin(-(double)table->entries[i].extinction, opaque);
		const double rgb[3] = {
			(colour >> 21) / 2047.0,
			(colour >> 10 & 2047) / 2047.0,
			(colour & 1023) / 1023.0,
		};
		const double *before = out_sums->sum[i];
		double *after = out_sums->sum[i + 1];
		after[0] = before[0] + extinction;
		for (int channel = 0; channel < 3; channel++)
			after[1 + channel] = before[1 + channel] + extinction * rgb[channel];
	}
}

/* The job that the workers share. */
struct baking {
	const struct gz_transfer_sums *sums;
	int stride;   /* entries in a cell */
	float length; /* of a part of a segment, voxel lengths */
	bool extinction;
	struct gz_transfer_entry *entries;
};

/* The segments from one cell to all higher cells, indexed by their width in cells less 1. One array
 * for each part and number, so that compilers vectorise the loops. */
struct row {
	float extinction[PARTS][GZ_PREINTEGRATED_SIZE];
	float opacity[PARTS][GZ_PREINTEGRATED_SIZE];
	float rgb[PARTS][3][GZ_PREINTEGRATED_SIZE];
};

/* 2^-x for x >= 0, error 2e-7: the same polynomial as the kernels'
 * (render/raycast/cpu/cast_shade.h). */
static inline float exp2_minus(float x)
{
	union {
		int32_t bits;
		float power;
	} whole;
	x = x < 126 ? x : 126;
	const int32_t nearest = (int32_t)(x + 0.5F);
	const float f = ((float)nearest - x) * 0.693147180559945F;
	float p = 1.0F / 720;
	p = p * f + 1.0F / 120;
	p = p * f + 1.0F / 24;
	p = p * f + 1.0F / 6;
	p = p * f + 0.5F;
	p = p * f + 1;
	p = p * f + 1;
	whole.bits = (127 - nearest) << 23;
	return p * whole.power;
}

static inline uint32_t pack_channel(float share, float levels)
{
	/* Rounding may take a difference of sums above 1. */
	const float level = share * levels + 0.5F;
	return (uint32_t)(int32_t)(level < levels ? level : levels);
}

static inline uint32_t pack_float_colour(float red, float green, float blue)
{
	return pack_channel(red, 2047) << 21 | pack_channel(green, 2047) << 10 |
	       pack_channel(blue, 1023);
}

/* Mean extinction over the entries [from, to), and their mean colour weighted by extinction. */
static inline void average_stretch(const struct gz_transfer_sums *sums, int from, int to,
				   float *out_extinction, float out_rgb[3])
{
	const double *low = sums->sum[from], *high = sums->sum[to];
	const double sum = high[0] - low[0];
	const double share = sum > 0 ? 1 / sum : 0;
	*out_extinction = (float)(sum / (to - from));
	for (int channel = 0; channel < 3; channel++)
		out_rgb[channel] = (float)((high[1 + channel] - low[1 + channel]) * share);
}

/* Extinction, opacity and colour of each part of the segments of a row. */
static void fill_segment_row(const struct baking *job, int low, int count, struct row *row)
{
	const int from = low * job->stride + job->stride / 2;
	for (int part = 0; part < PARTS; part++) {
		for (int i = 0; i < count; i++) {
			const int width = (i + 1) * (job->stride / PARTS);
			float rgb[3];
			average_stretch(job->sums, from + part * width, from + (part + 1) * width,
					&row->extinction[part][i], rgb);
			for (int channel = 0; channel < 3; channel++)
				row->rgb[part][channel][i] = rgb[channel];
		}
		for (int i = 0; i < count; i++)
			row->opacity[part][i] =
				1 - exp2_minus(row->extinction[part][i] * job->length);
	}
}

/* Blend the parts of each segment front to back, from part `first` on by `step`. */
static void blend_row(const struct row *row, int count, int first, int step,
		      struct gz_transfer_entry *out_entries)
{
	for (int i = 0; i < count; i++) {
		float through = 1, red = 0, green = 0, blue = 0;
		for (int k = 0; k < PARTS; k++) {
			const int part = first + k * step;
			const float weight = through * row->opacity[part][i];
			red += weight * row->rgb[part][0][i];
			green += weight * row->rgb[part][1][i];
			blue += weight * row->rgb[part][2][i];
			through -= weight;
		}
		const float all = 1 - through, share = 1 / (all > 1e-30F ? all : 1e-30F);
		out_entries[i].opacity = all;
		out_entries[i].colour = pack_float_colour(red * share, green * share, blue * share);
	}
}

/* Segments of a row as means, whatever the order of their colours. */
static void average_row(const struct baking *job, int low, int count,
			struct gz_transfer_entry *out_entries)
{
	const int from = low * job->stride + job->stride / 2;
	for (int i = 0; i < count; i++) {
		float extinction, rgb[3];
		average_stretch(job->sums, from, from + (i + 1) * job->stride, &extinction, rgb);
		out_entries[i].extinction = -extinction;
		out_entries[i].colour = pack_float_colour(rgb[0], rgb[1], rgb[2]);
	}
}

/* A segment within one cell. */
static struct gz_transfer_entry segment_in_cell(const struct baking *job, int cell)
{
	float extinction, rgb[3];
	average_stretch(job->sums, cell * job->stride, (cell + 1) * job->stride, &extinction, rgb);
	struct gz_transfer_entry entry = { .colour = pack_float_colour(rgb[0], rgb[1], rgb[2]) };
	if (job->extinction)
		entry.extinction = -extinction;
	else
		entry.opacity = 1 - exp2_minus(extinction * PARTS * job->length);
	return entry;
}

/* Rows of the table from the diagonal to the right: rising segments. Falling ones, from a higher
 * cell to a lower one, are in the columns below the diagonal. A block of rows is made at a time, so
 * that whole cache lines are written. */
static void bake_part(void *user, size_t block, int worker)
{
	(void)worker;
	const struct baking *job = user;
	struct gz_transfer_entry falling[BLOCK_ROWS][GZ_PREINTEGRATED_SIZE];
	struct row row;
	const int first = (int)block * BLOCK_ROWS;
	for (int low = first; low < first + BLOCK_ROWS; low++) {
		const int count = GZ_PREINTEGRATED_SIZE - 1 - low;
		struct gz_transfer_entry *diagonal =
			job->entries + (size_t)low * (GZ_PREINTEGRATED_SIZE + 1);
		*diagonal = segment_in_cell(job, low);
		if (job->extinction) {
			average_row(job, low, count, diagonal + 1);
			average_row(job, low, count, &falling[low - first][low] + 1);
			continue;
		}
		fill_segment_row(job, low, count, &row);
		blend_row(&row, count, 0, 1, diagonal + 1);
		blend_row(&row, count, PARTS - 1, -1, &falling[low - first][low] + 1);
	}
	for (int high = first + 1; high < GZ_PREINTEGRATED_SIZE; high++)
		for (int low = first; low < first + BLOCK_ROWS && low < high; low++)
			job->entries[(size_t)high * GZ_PREINTEGRATED_SIZE + (size_t)low] =
				falling[low - first][high];
}

static void bake(struct baking *job, struct gz_workers *workers)
{
	const size_t blocks = GZ_PREINTEGRATED_SIZE / BLOCK_ROWS;
	if (workers) {
		gz_workers_run(workers, bake_part, job, blocks);
		return;
	}
	for (size_t block = 0; block < blocks; block++)
		bake_part(job, block, 0);
}

void gz_transfer_preintegrate(const struct gz_transfer_sums *sums, double length,
			      struct gz_workers *workers, struct gz_transfer_entry *out_entries)
{
	struct baking job = {
		.sums = sums,
		.stride = GZ_PREINTEGRATED_STRIDE(sums->count),
		.length = (float)(length / PARTS),
		.entries = out_entries,
	};
	bake(&job, workers);
}

void gz_transfer_preintegrate_extinction(const struct gz_transfer_sums *sums,
					 struct gz_workers *workers,
					 struct gz_transfer_entry *out_entries)
{
	struct baking job = {
		.sums = sums,
		.stride = GZ_PREINTEGRATED_STRIDE(sums->count),
		.extinction = true,
		.entries = out_entries,
	};
	bake(&job, workers);
}
