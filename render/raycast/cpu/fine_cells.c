#include "render/raycast/cpu/fine_cells.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(2 * GZ_FINE_EDGE == GZ_MACROCELL_EDGE, "two fine cells along a macrocell's edge");

static const struct gz_range_blocks fine_blocks = { GZ_FINE_EDGE, 0, 1 };

static size_t fine_row(const struct gz_fine_grid *grid)
{
	return (size_t)grid->dims[0];
}

static size_t fine_slice(const struct gz_fine_grid *grid)
{
	return fine_row(grid) * (size_t)grid->dims[1];
}

static size_t fine_count(const struct gz_fine_grid *grid)
{
	return fine_slice(grid) * (size_t)grid->dims[2];
}

/* What the threads that build fine cells share. */
struct fine_building {
	const struct gz_volume *volume;
	struct gz_fine_cells *cells;
	char *scratch; /* of each thread */
};

static void find_fine_slice(void *user, size_t part, int worker)
{
	const struct fine_building *job = user;
	const struct gz_fine_cells *cells = job->cells;
	const struct gz_fine_grid *grid = &cells->grid[0];
	char *scratch = job->scratch + (size_t)worker * gz_voxel_ranges_scratch(job->volume);
	const size_t size = gz_voxel_size(cells->type);
	size_t index = part * fine_slice(grid);
	for (int y = 0; y < grid->dims[1]; y++, index += fine_row(grid)) {
		const struct gz_range_row at = { job->volume, &fine_blocks, y, (int)part,
						 grid->dims[0] };
		gz_voxel_ranges_row(&at, scratch, (char *)cells->least + index * size,
				    (char *)cells->greatest + index * size);
	}
}

static enum gz_result allocate_fine_cells(const struct gz_volume *volume,
					  struct gz_fine_cells *cells)
{
	bool whole = true;
	for (int i = 0; i < GZ_FINE_GRIDS; i++) {
		struct gz_fine_grid *grid = &cells->grid[i];
		const int edge = GZ_FINE_EDGE << i;
		for (int axis = 0; axis < 3; axis++)
			grid->dims[axis] = (volume->dims[axis] + edge - 1) / edge;
		grid->flags = calloc(fine_count(grid) + 4, 1);
		whole = whole && grid->flags;
	}
	const size_t bytes = fine_count(&cells->grid[0]) * gz_voxel_size(volume->type);
	cells->type = volume->type;
	cells->least = malloc(bytes);
	cells->greatest = malloc(bytes);
	return whole && cells->least && cells->greatest ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_fine_cells_build(const struct gz_volume *volume, struct gz_workers *workers,
				   struct gz_fine_cells *cells)
{
	gz_fine_cells_free(cells);
	struct fine_building job = { .volume = volume, .cells = cells };
	job.scratch = malloc((size_t)gz_workers_count(workers) * gz_voxel_ranges_scratch(volume));
	if (!job.scratch || allocate_fine_cells(volume, cells) != GZ_OK) {
		free(job.scratch);
		gz_fine_cells_free(cells);
		return GZ_ERR_NO_MEM;
	}
	gz_workers_run(workers, find_fine_slice, &job, (size_t)cells->grid[0].dims[2]);
	free(job.scratch);
	return GZ_OK;
}

/* What the threads that classify fine cells share. */
struct fine_classifying {
	struct gz_fine_cells *cells;
	const struct gz_macrocells *coarse;
	const struct gz_transfer_table *table;
};

/* Find which cells of a row show something by themselves. Only those in macrocells that show can,
 * since a macrocell has all voxels of its fine cells. */
static void classify_fine_row(const struct fine_classifying *job, int y, int z, size_t first)
{
	const struct gz_fine_cells *cells = job->cells;
	const struct gz_macrocells *coarse = job->coarse;
	uint8_t *flags = cells->grid[0].flags + first;
	const size_t above = ((size_t)(z / 2) * (size_t)coarse->dims[1] + (size_t)(y / 2)) *
			     (size_t)coarse->dims[0];
	for (int x = 0; x < cells->grid[0].dims[0]; x++) {
		const size_t index = first + (size_t)x;
		flags[x] = coarse->distance[above + (size_t)(x / 2)] == 0 &&
			   gz_transfer_table_shows(
				   job->table, gz_voxel_stored(cells->type, cells->least, index),
				   gz_voxel_stored(cells->type, cells->greatest, index));
	}
}

static void classify_fine_slice(void *user, size_t part, int worker)
{
	(void)worker;
	const struct fine_classifying *job = user;
	const struct gz_fine_grid *grid = &job->cells->grid[0];
	for (int y = 0; y < grid->dims[1]; y++)
		classify_fine_row(job, y, (int)part,
				  part * fine_slice(grid) + (size_t)y * fine_row(grid));
}

/* Merge into each cell's flags those of its next neighbour along one axis: the lowest `bits` bits
 * of both go to the `bits` bits above. */
static void merge_flags(uint8_t *flags, const uint8_t *next, size_t count, int bits)
{
	const unsigned low = (1U << bits) - 1;
	for (size_t i = 0; i < count; i++)
		flags[i] = (uint8_t)(flags[i] | ((flags[i] | next[i]) & low) << bits);
}

/* From the flag of each cell by itself to all eight. */
static void spread_flags(struct gz_fine_grid *grid)
{
	const size_t row = fine_row(grid), slice = fine_slice(grid), count = fine_count(grid);
	const size_t rows = (size_t)grid->dims[1];
	for (uint8_t *x = grid->flags; x < grid->flags + count; x += row) {
		merge_flags(x, x + 1, row - 1, 1);
		merge_flags(x + row - 1, x + row - 1, 1, 1);
	}
	for (uint8_t *y = grid->flags; y < grid->flags + count; y += slice) {
		merge_flags(y, y + row, slice - row, 2);
		merge_flags(y + (rows - 1) * row, y + (rows - 1) * row, row, 2);
	}
	merge_flags(grid->flags, grid->flags + slice, count - slice, 4);
	merge_flags(grid->flags + count - slice, grid->flags + count - slice, slice, 4);
}

/* A cell of the next grid is eight cells of this one. */
static void coarsen_flags(const struct gz_fine_grid *finer, struct gz_fine_grid *grid)
{
	uint8_t *flags = grid->flags;
	for (int z = 0; z < grid->dims[2]; z++)
		for (int y = 0; y < grid->dims[1]; y++) {
			const uint8_t *from = finer->flags + (size_t)(2 * z) * fine_slice(finer) +
					      (size_t)(2 * y) * fine_row(finer);
			for (int x = 0; x < grid->dims[0]; x++)
				*flags++ = from[2 * x] >> 7;
		}
}

void gz_fine_cells_classify(struct gz_fine_cells *cells, const struct gz_macrocells *coarse,
			    const struct gz_transfer_table *table, struct gz_workers *workers)
{
	struct fine_classifying job = { .cells = cells, .coarse = coarse, .table = table };
	gz_workers_run(workers, classify_fine_slice, &job, (size_t)cells->grid[0].dims[2]);
	spread_flags(&cells->grid[0]);
	for (int i = 1; i < GZ_FINE_GRIDS; i++) {
		coarsen_flags(&cells->grid[i - 1], &cells->grid[i]);
		spread_flags(&cells->grid[i]);
	}
}

void gz_fine_cells_free(struct gz_fine_cells *cells)
{
	free(cells->least);
	free(cells->greatest);
	for (int i = 0; i < GZ_FINE_GRIDS; i++)
		free(cells->grid[i].flags);
	*cells = (struct gz_fine_cells) { 0 };
}
