#include "render/transfer/transfer_preintegrated.h"

#include <math.h>
#include <string.h>

#include "render/transfer/segment_kernels.h"

/* Sums at the ends of quarters are taken between entries. */
_Static_assert(GZ_PREINTEGRATED_STRIDE(GZ_TRANSFER_TABLE_SIZE) % GZ_SEGMENT_PARTS == 0,
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
	const struct gz_segment_kernels *kernels;
	const double *lengths; /* of segments, voxel lengths; NULL: one table of extinction */
	int count;
	struct gz_transfer_entry *const *entries; /* a table for each length */
};

/* A block of rows that is made at a time. */
struct block {
	int first; /* row */
	struct gz_segment_means means[GZ_SEGMENT_ROWS];
	struct gz_transfer_entry falling[GZ_SEGMENT_ROWS][GZ_PREINTEGRATED_SIZE];
};

/* How many segments rise from a cell to higher ones. */
static int segments_from(int low)
{
	return GZ_PREINTEGRATED_SIZE - 1 - low;
}

static struct gz_transfer_entry *diagonal_of(struct gz_transfer_entry *entries, int cell)
{
	return entries + (size_t)cell * (GZ_PREINTEGRATED_SIZE + 1);
}

/* Write falling segments, from a higher cell to a lower one, into the columns below the diagonal.
 */
static void put_falling(const struct block *block, struct gz_transfer_entry *entries)
{
	const int first = block->first;
	for (int high = first + 1; high < GZ_PREINTEGRATED_SIZE; high++)
		for (int low = first; low < first + GZ_SEGMENT_ROWS && low < high; low++)
			entries[(size_t)high * GZ_PREINTEGRATED_SIZE + (size_t)low] =
				block->falling[low - first][high];
}

/* The rows of a block in the table of one length: rising segments from the diagonal to the right.
 */
static void bake_length(const struct baking *job, int index, struct block *block)
{
	const float part_length = (float)(job->lengths[index] / GZ_SEGMENT_PARTS);
	for (int row = 0; row < GZ_SEGMENT_ROWS; row++) {
		const int low = block->first + row;
		struct gz_transfer_entry *diagonal = diagonal_of(job->entries[index], low);
		job->kernels->segment_in_cell(job->sums, low, part_length, diagonal);
		job->kernels->blend(&block->means[row], segments_from(low), part_length,
				    diagonal + 1, &block->falling[row][low] + 1);
	}
	put_falling(block, job->entries[index]);
}

/* The rows of a block in the table of extinction. */
static void bake_extinction(const struct baking *job, struct block *block)
{
	for (int row = 0; row < GZ_SEGMENT_ROWS; row++) {
		const int low = block->first + row, count = segments_from(low);
		struct gz_transfer_entry *diagonal = diagonal_of(job->entries[0], low);
		struct gz_transfer_entry *falling = &block->falling[row][low] + 1;
		job->kernels->mix_in_cell(job->sums, low, diagonal);
		job->kernels->mix(job->sums, low, count, diagonal + 1);
		memcpy(falling, diagonal + 1, (size_t)count * sizeof *falling);
	}
	put_falling(block, job->entries[0]);
}

/* The means of a segment's parts serve all lengths. */
static void bake_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct baking *job = user;
	struct block block;
	block.first = (int)part * GZ_SEGMENT_ROWS;
	if (!job->lengths) {
		bake_extinction(job, &block);
		return;
	}
	for (int row = 0; row < GZ_SEGMENT_ROWS; row++)
		job->kernels->average(job->sums, block.first + row,
				      segments_from(block.first + row), &block.means[row]);
	for (int i = 0; i < job->count; i++)
		bake_length(job, i, &block);
}

static void bake(struct baking *job, struct gz_workers *workers)
{
	const size_t blocks = GZ_PREINTEGRATED_SIZE / GZ_SEGMENT_ROWS;
	job->kernels = gz_segment_kernels_find(NULL);
	if (workers) {
		gz_workers_run(workers, bake_part, job, blocks);
		return;
	}
	for (size_t block = 0; block < blocks; block++)
		bake_part(job, block, 0);
}

void gz_transfer_preintegrate(const struct gz_transfer_sums *sums, const double lengths[],
			      int count, struct gz_workers *workers,
			      struct gz_transfer_entry *const out_tables[])
{
	struct baking job = {
		.sums = sums,
		.lengths = lengths,
		.count = count,
		.entries = out_tables,
	};
	bake(&job, workers);
}

void gz_transfer_preintegrate_extinction(const struct gz_transfer_sums *sums,
					 struct gz_workers *workers,
					 struct gz_transfer_entry *out_entries)
{
	struct baking job = { .sums = sums, .entries = &out_entries };
	bake(&job, workers);
}
