#include "render/raycast/shared/macrocells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"

/* Least and greatest of each column of several rows of voxels, then of each block of columns.
 * Written out by type, so that each is a plain loop that compilers vectorise. */
#define DEFINE_COLUMNS(name, type)                                                                \
	static void name(const void *voxels, size_t from, int count, void *least, void *greatest) \
	{                                                                                         \
		const type *restrict row = (const type *)voxels + from;                           \
		type *restrict low = least, *restrict high = greatest;                            \
		for (int i = 0; i < count; i++) {                                                 \
			low[i] = row[i] < low[i] ? row[i] : low[i];                               \
			high[i] = row[i] > high[i] ? row[i] : high[i];                            \
		}                                                                                 \
	}                                                                                         \
	static void name##_block(const void *least, const void *greatest, int from, int to,       \
				 void *out_least, void *out_greatest, int block)                  \
	{                                                                                         \
		type low = ((const type *)least)[from], high = ((const type *)greatest)[from];    \
		for (int i = from + 1; i <= to; i++) {                                            \
			const type l = ((const type *)least)[i];                                  \
			const type h = ((const type *)greatest)[i];                               \
			low = l < low ? l : low;                                                  \
			high = h > high ? h : high;                                               \
		}                                                                                 \
		((type *)out_least)[block] = low;                                                 \
		((type *)out_greatest)[block] = high;                                             \
	}

DEFINE_COLUMNS(columns_u8, uint8_t)
DEFINE_COLUMNS(columns_u16, uint16_t)
DEFINE_COLUMNS(columns_f32, float)

/* The loops for one type of voxel. */
static const struct voxel_kind {
	void (*columns)(const void *voxels, size_t from, int count, void *least, void *greatest);
	void (*block)(const void *least, const void *greatest, int from, int to, void *out_least,
		      void *out_greatest, int block);
} voxel_kinds[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = { columns_u8, columns_u8_block },
	[GZ_VOXEL_U16] = { columns_u16, columns_u16_block },
	[GZ_VOXEL_F32] = { columns_f32, columns_f32_block },
};

/* The voxels of a block along one axis. */
static void block_span(const struct gz_range_blocks *blocks, int block, int dim, int *out_from,
		       int *out_to)
{
	const int from = block * blocks->edge - blocks->before;
	const int to = block * blocks->edge + blocks->edge - 1 + blocks->behind;
	*out_from = from > 0 ? from : 0;
	*out_to = to < dim - 1 ? to : dim - 1;
}

size_t gz_voxel_ranges_scratch(const struct gz_volume *volume)
{
	return 2 * (size_t)volume->dims[0] * gz_voxel_size(volume->type);
}

void gz_voxel_ranges_row(const struct gz_range_row *at, void *scratch, void *out_least,
			 void *out_greatest)
{
	const struct gz_volume *volume = at->volume;
	const struct gz_range_blocks *blocks = at->blocks;
	const struct voxel_kind *kind = &voxel_kinds[volume->type];
	const size_t row = (size_t)volume->dims[0], slice = row * (size_t)volume->dims[1];
	const size_t row_bytes = row * gz_voxel_size(volume->type);
	char *least = scratch, *greatest = least + row_bytes;
	int from[3], to[3];
	block_span(blocks, at->y, volume->dims[1], &from[1], &to[1]);
	block_span(blocks, at->z, volume->dims[2], &from[2], &to[2]);
	const char *first =
		(const char *)volume->voxels +
		((size_t)from[2] * slice + (size_t)from[1] * row) * gz_voxel_size(volume->type);
	memcpy(least, first, row_bytes);
	memcpy(greatest, first, row_bytes);
	for (int k = from[2]; k <= to[2]; k++)
		for (int j = from[1]; j <= to[1]; j++)
			kind->columns(volume->voxels, (size_t)k * slice + (size_t)j * row,
				      volume->dims[0], least, greatest);
	for (int x = 0; x < at->count; x++) {
		block_span(blocks, x, volume->dims[0], &from[0], &to[0]);
		kind->block(least, greatest, from[0], to[0], out_least, out_greatest, x);
	}
}

static int minimum(int a, int b)
{
	return a < b ? a : b;
}

/* Threads are started for volumes of so many voxels or more. Chosen. */
#define PARALLEL_FROM ((size_t)1 << 23)

/* One voxel on each side: see struct gz_macrocells. */
static const struct gz_range_blocks macrocell_blocks = { GZ_MACROCELL_EDGE, 1, 1 };

/* What the threads that build macrocells share. */
struct macrocell_building {
	const struct gz_volume *volume;
	struct gz_macrocells *cells;
	char *scratch; /* of each thread: what gz_voxel_ranges_row() needs, and its results */
	size_t scratch_bytes;
};

static void voxels_to_floats(enum gz_voxel_type type, const void *values, int count, float *out)
{
	for (int i = 0; i < count; i++)
		out[i] = (float)gz_voxel_stored(type, values, (size_t)i);
}

static void find_macrocell_slice(void *user, size_t part, int worker)
{
	const struct macrocell_building *job = user;
	struct gz_macrocells *cells = job->cells;
	const enum gz_voxel_type type = job->volume->type;
	const size_t row = (size_t)cells->dims[0];
	char *scratch = job->scratch + (size_t)worker * job->scratch_bytes;
	char *least = scratch + gz_voxel_ranges_scratch(job->volume);
	char *greatest = least + row * gz_voxel_size(type);
	size_t index = part * (size_t)cells->dims[1] * row;
	for (int y = 0; y < cells->dims[1]; y++, index += row) {
		const struct gz_range_row at = { job->volume, &macrocell_blocks, y, (int)part,
						 cells->dims[0] };
		gz_voxel_ranges_row(&at, scratch, least, greatest);
		voxels_to_floats(type, least, cells->dims[0], cells->least + index);
		voxels_to_floats(type, greatest, cells->dims[0], cells->greatest + index);
	}
}

static enum gz_result find_macrocells(struct macrocell_building *job, struct gz_workers *workers)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	const size_t slices = (size_t)job->cells->dims[2];
	job->scratch_bytes = gz_voxel_ranges_scratch(job->volume) +
			     2 * (size_t)job->cells->dims[0] * gz_voxel_size(job->volume->type);
	job->scratch = malloc(threads * job->scratch_bytes);
	if (!job->scratch)
		return GZ_ERR_NO_MEM;
	if (workers)
		gz_workers_run(workers, find_macrocell_slice, job, slices);
	else
		for (size_t z = 0; z < slices; z++)
			find_macrocell_slice(job, z, 0);
	free(job->scratch);
	return GZ_OK;
}

static size_t cell_count(const struct gz_macrocells *cells)
{
	return (size_t)cells->dims[0] * (size_t)cells->dims[1] * (size_t)cells->dims[2];
}

static enum gz_result allocate_macrocells(const int dims[3], struct gz_macrocells *cells)
{
	gz_macrocells_free(cells);
	for (int axis = 0; axis < 3; axis++)
		cells->dims[axis] = (dims[axis] + GZ_MACROCELL_EDGE - 1) / GZ_MACROCELL_EDGE;
	const size_t count = cell_count(cells);
	cells->least = malloc(count * sizeof *cells->least);
	cells->greatest = malloc(count * sizeof *cells->greatest);
	cells->distance = calloc(count + 4, 1);
	cells->reach = calloc(count + 4, 1);
	if (!cells->least || !cells->greatest || !cells->distance || !cells->reach) {
		gz_macrocells_free(cells);
		return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

enum gz_result gz_macrocells_build(const struct gz_volume *volume, struct gz_macrocells *cells)
{
	const enum gz_result result = allocate_macrocells(volume->dims, cells);
	if (result != GZ_OK)
		return result;
	struct macrocell_building job = { .volume = volume, .cells = cells };
	struct gz_workers *workers = NULL;
	/* Without further threads the calling one does all. */
	if (gz_volume_voxel_count(volume) >= PARALLEL_FROM)
		(void)gz_workers_create(0, &workers);
	const enum gz_result found = find_macrocells(&job, workers);
	gz_workers_destroy(&workers);
	if (found != GZ_OK)
		gz_macrocells_free(cells);
	return found;
}

_Static_assert(GZ_MACROCELL_EDGE == GZ_BRICK_CELL_EDGE, "a brick file has ranges of macrocells");

/* Macrocells along an edge of a brick. */
enum { BRICK_CELLS = GZ_BRICK_EDGE / GZ_BRICK_CELL_EDGE };

static size_t cell_index(const struct gz_macrocells *cells, int x, int y, int z)
{
	return ((size_t)z * (size_t)cells->dims[1] + (size_t)y) * (size_t)cells->dims[0] +
	       (size_t)x;
}

enum gz_result gz_macrocells_of_bricks(const struct gz_brick_file *file,
				       struct gz_macrocells *cells)
{
	const enum gz_result result = allocate_macrocells(file->layout.levels[0].dims, cells);
	if (result != GZ_OK)
		return result;
	for (int z = 0; z < cells->dims[2]; z++)
		for (int y = 0; y < cells->dims[1]; y++)
			for (int x = 0; x < cells->dims[0]; x++) {
				const int brick[3] = { x / BRICK_CELLS, y / BRICK_CELLS,
						       z / BRICK_CELLS };
				const int cell = (z % BRICK_CELLS * BRICK_CELLS + y % BRICK_CELLS) *
							 BRICK_CELLS +
						 x % BRICK_CELLS;
				const size_t index = cell_index(cells, x, y, z);
				gz_brick_file_cell(file, gz_brick_number(&file->layout, 0, brick),
						   cell, &cells->least[index],
						   &cells->greatest[index]);
			}
	return GZ_OK;
}

/* The finer cells that hold a cell's voxels: its own and, along a halved axis, one more to each
 * side, since a voxel of the neighbour is made of two of the finer level. */
static void finer_span(int cell, bool halved, int count, int *out_first, int *out_last)
{
	const int first = halved ? 2 * cell - 1 : cell, last = halved ? 2 * cell + 2 : cell;
	*out_first = first < 0 ? 0 : first;
	*out_last = last > count - 1 ? count - 1 : last;
}

static void join_finer_cells(const struct gz_macrocells *finer, const int first[3],
			     const int last[3], float *out_least, float *out_greatest)
{
	float least = INFINITY, greatest = -INFINITY;
	for (int z = first[2]; z <= last[2]; z++)
		for (int y = first[1]; y <= last[1]; y++)
			for (int x = first[0]; x <= last[0]; x++) {
				const size_t index = cell_index(finer, x, y, z);
				least = fminf(least, finer->least[index]);
				greatest = fmaxf(greatest, finer->greatest[index]);
			}
	*out_least = least;
	*out_greatest = greatest;
}

enum gz_result gz_macrocells_of_coarser_bricks(const struct gz_brick_file *file, int level,
					       const struct gz_macrocells *finer,
					       struct gz_macrocells *cells)
{
	const struct gz_brick_level *l = &file->layout.levels[level];
	const enum gz_result result = allocate_macrocells(l->dims, cells);
	if (result != GZ_OK)
		return result;
	for (int z = 0; z < cells->dims[2]; z++)
		for (int y = 0; y < cells->dims[1]; y++)
			for (int x = 0; x < cells->dims[0]; x++) {
				const int cell[3] = { x, y, z };
				int first[3], last[3];
				for (int axis = 0; axis < 3; axis++)
					finer_span(cell[axis],
						   l->halvings[axis] > l[-1].halvings[axis],
						   finer->dims[axis], &first[axis], &last[axis]);
				const size_t index = cell_index(cells, x, y, z);
				join_finer_cells(finer, first, last, &cells->least[index],
						 &cells->greatest[index]);
			}
	return GZ_OK;
}

/* Neighbouring cells whose lines are searched together. */
enum { COLUMNS = 32 };

/* Distances along x to the nearest 0; until now all are 0 or 255. */
static void relax_row(uint8_t *row, int count)
{
	for (int i = 1; i < count; i++)
		row[i] = (uint8_t)minimum(row[i], row[i - 1] + 1);
	for (int i = count - 2; i >= 0; i--)
		row[i] = (uint8_t)minimum(row[i], row[i + 1] + 1);
}

static uint8_t farthest_of(const uint8_t values[COLUMNS])
{
	uint8_t most = 0;
	for (int c = 0; c < COLUMNS; c++)
		most = values[c] > most ? values[c] : most;
	return most;
}

/* Take the cells `away` before and after along the line into account. */
static void relax_by(uint8_t values[COLUMNS], const uint8_t left[COLUMNS],
		     const uint8_t right[COLUMNS], uint8_t away)
{
	for (int c = 0; c < COLUMNS; c++) {
		const uint8_t near = left[c] < right[c] ? left[c] : right[c];
		const uint8_t far = near > away ? near : away;
		values[c] = values[c] < far ? values[c] : far;
	}
}

/*
 * Lines along y or z: d[i] = min over j of max(|i - j|, before[j]); the Chebyshev distance is
 * separable in this form. The window grows only while it can still lower a value, so that the work
 * is bounded by the distances.
 */
static void relax_lines(uint8_t *first, size_t stride, int count, int columns)
{
	uint8_t before[GZ_VOLUME_DIM_MAX / GZ_MACROCELL_EDGE][COLUMNS];
	uint8_t none[COLUMNS];
	memset(none, 255, sizeof none);
	for (int i = 0; i < count; i++) {
		memset(before[i], 0, sizeof before[i]);
		memcpy(before[i], first + (size_t)i * stride, (size_t)columns);
	}
	for (int i = 0; i < count; i++) {
		uint8_t values[COLUMNS];
		memcpy(values, before[i], sizeof values);
		for (int away = 1; away < farthest_of(values); away++)
			relax_by(values, i - away >= 0 ? before[i - away] : none,
				 i + away < count ? before[i + away] : none, (uint8_t)away);
		memcpy(first + (size_t)i * stride, values, (size_t)columns);
	}
}

/* Chebyshev distance to the nearest cell that is 0; the others are 255. */
static void relax_distances(const int dims[3], uint8_t *distance)
{
	const size_t row = (size_t)dims[0], slice = row * (size_t)dims[1];
	for (size_t i = 0; i < (size_t)dims[1] * (size_t)dims[2]; i++)
		relax_row(distance + i * row, dims[0]);
	for (int x = 0; x < dims[0]; x += COLUMNS) {
		const int columns = minimum(COLUMNS, dims[0] - x);
		for (int z = 0; z < dims[2]; z++)
			relax_lines(distance + (size_t)z * slice + (size_t)x, row, dims[1],
				    columns);
		for (int y = 0; y < dims[1]; y++)
			relax_lines(distance + (size_t)y * row + (size_t)x, slice, dims[2],
				    columns);
	}
}

static void put_shows(struct gz_macrocells *cells, size_t index, bool shows)
{
	cells->distance[index] = shows ? 0 : 255;
	cells->reach[index] = shows ? 255 : 0;
}

/* After put_shows() for each cell. */
static void find_distances(struct gz_macrocells *cells)
{
	const size_t count = cell_count(cells);
	relax_distances(cells->dims, cells->distance);
	relax_distances(cells->dims, cells->reach);
	for (size_t i = 0; i < count; i++) {
		const int empty = minimum(cells->distance[i], GZ_REACH_MAX);
		const int full = minimum(cells->reach[i], GZ_REACH_MAX);
		cells->reach[i] = (uint8_t)(GZ_REACH_BORDER + empty - full);
	}
}

void gz_macrocells_classify(struct gz_macrocells *cells, const struct gz_transfer_table *table)
{
	const size_t count = cell_count(cells);
	for (size_t i = 0; i < count; i++)
		put_shows(cells, i,
			  gz_transfer_table_shows(table, cells->least[i], cells->greatest[i]));
	find_distances(cells);
}

void gz_macrocells_classify_surface(struct gz_macrocells *cells, double value)
{
	const size_t count = cell_count(cells);
	for (size_t i = 0; i < count; i++)
		put_shows(cells, i,
			  (double)cells->least[i] <= value && value <= (double)cells->greatest[i]);
	find_distances(cells);
}

void gz_macrocells_free(struct gz_macrocells *cells)
{
	free(cells->least);
	free(cells->greatest);
	free(cells->distance);
	free(cells->reach);
	*cells = (struct gz_macrocells) { 0 };
}
