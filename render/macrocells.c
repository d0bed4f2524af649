#include "render/macrocells.h"

#include <stdlib.h>
#include <string.h>

#include "render/workers.h"

static int minimum(int a, int b)
{
	return a < b ? a : b;
}

static int maximum(int a, int b)
{
	return a > b ? a : b;
}

/* Chosen: from here on, in voxels, threads are started for the work. */
#define PARALLEL_FROM ((size_t)1 << 23)

/* Of each column of several rows of voxels, the least and the greatest. Written out by type, so
 * that each is a plain loop that compilers turn into vector code. */
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
	static void name##_cell(const void *least, const void *greatest, int from, int to,        \
				float *out_least, float *out_greatest)                            \
	{                                                                                         \
		type low = ((const type *)least)[from], high = ((const type *)greatest)[from];    \
		for (int i = from + 1; i <= to; i++) {                                            \
			const type l = ((const type *)least)[i];                                  \
			const type h = ((const type *)greatest)[i];                               \
			low = l < low ? l : low;                                                  \
			high = h > high ? h : high;                                               \
		}                                                                                 \
		*out_least = (float)low;                                                          \
		*out_greatest = (float)high;                                                      \
	}

DEFINE_COLUMNS(columns_u8, uint8_t)
DEFINE_COLUMNS(columns_u16, uint16_t)
DEFINE_COLUMNS(columns_f32, float)

/* How one type of voxel is gone through. */
static const struct voxel_kind {
	void (*columns)(const void *voxels, size_t from, int count, void *least, void *greatest);
	void (*cell)(const void *least, const void *greatest, int from, int to, float *out_least,
		     float *out_greatest);
} voxel_kinds[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = { columns_u8, columns_u8_cell },
	[GZ_VOXEL_U16] = { columns_u16, columns_u16_cell },
	[GZ_VOXEL_F32] = { columns_f32, columns_f32_cell },
};

/* What the threads that build cells share. */
struct building {
	const struct gz_volume *volume;
	struct gz_macrocells *cells;
	char *rows; /* of each thread: the least and the greatest of columns */
	size_t row_bytes;
};

/* The voxels of a cell along one axis. */
static void cell_span(int cell, int dim, int *out_from, int *out_to)
{
	*out_from = maximum(cell * GZ_MACROCELL_EDGE - 1, 0);
	*out_to = minimum(cell * GZ_MACROCELL_EDGE + GZ_MACROCELL_EDGE, dim - 1);
}

/* A row of cells along x. */
static void find_cells(const struct building *job, int y, int z, char *least, char *greatest)
{
	const struct gz_volume *volume = job->volume;
	const struct voxel_kind *kind = &voxel_kinds[volume->type];
	const size_t row = (size_t)volume->dims[0], slice = row * (size_t)volume->dims[1];
	int from[3], to[3];
	cell_span(y, volume->dims[1], &from[1], &to[1]);
	cell_span(z, volume->dims[2], &from[2], &to[2]);
	const char *first =
		(const char *)volume->voxels +
		((size_t)from[2] * slice + (size_t)from[1] * row) * gz_voxel_size(volume->type);
	memcpy(least, first, job->row_bytes);
	memcpy(greatest, first, job->row_bytes);
	for (int k = from[2]; k <= to[2]; k++)
		for (int j = from[1]; j <= to[1]; j++)
			kind->columns(volume->voxels, (size_t)k * slice + (size_t)j * row,
				      volume->dims[0], least, greatest);
	struct gz_macrocells *cells = job->cells;
	size_t index = ((size_t)z * (size_t)cells->dims[1] + (size_t)y) * (size_t)cells->dims[0];
	for (int x = 0; x < cells->dims[0]; x++, index++) {
		cell_span(x, volume->dims[0], &from[0], &to[0]);
		kind->cell(least, greatest, from[0], to[0], &cells->least[index],
			   &cells->greatest[index]);
	}
}

static void find_slice(void *user, size_t part, int worker)
{
	const struct building *job = user;
	char *rows = job->rows + 2 * (size_t)worker * job->row_bytes;
	for (int y = 0; y < job->cells->dims[1]; y++)
		find_cells(job, y, (int)part, rows, rows + job->row_bytes);
}

static enum gz_result find_all(struct building *job, struct gz_workers *workers)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	const size_t slices = (size_t)job->cells->dims[2];
	job->row_bytes = (size_t)job->volume->dims[0] * gz_voxel_size(job->volume->type);
	job->rows = malloc(threads * 2 * job->row_bytes);
	if (!job->rows)
		return GZ_ERR_NO_MEM;
	if (workers)
		gz_workers_run(workers, find_slice, job, slices);
	else
		for (size_t z = 0; z < slices; z++)
			find_slice(job, z, 0);
	free(job->rows);
	return GZ_OK;
}

static size_t cell_count(const struct gz_macrocells *cells)
{
	return (size_t)cells->dims[0] * (size_t)cells->dims[1] * (size_t)cells->dims[2];
}

enum gz_result gz_macrocells_allocate(const int dims[3], struct gz_macrocells *cells)
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
	const enum gz_result result = gz_macrocells_allocate(volume->dims, cells);
	if (result != GZ_OK)
		return result;
	struct building job = { .volume = volume, .cells = cells };
	struct gz_workers *workers = NULL;
	/* Where no thread is to be had, the caller's does it. */
	if (gz_volume_voxel_count(volume) >= PARALLEL_FROM)
		(void)gz_workers_create(0, &workers);
	const enum gz_result found = find_all(&job, workers);
	gz_workers_destroy(&workers);
	if (found != GZ_OK)
		gz_macrocells_free(cells);
	return found;
}

/* Cells side by side whose lines are searched at once. */
enum { COLUMNS = 32 };

/* Along x, where the only distances so far are 0 and 255: to the nearest 0. */
static void relax_row(uint8_t *row, int count)
{
	for (int i = 1; i < count; i++)
		row[i] = (uint8_t)minimum(row[i], row[i - 1] + 1);
	for (int i = count - 2; i >= 0; i--)
		row[i] = (uint8_t)minimum(row[i], row[i + 1] + 1);
}

static uint8_t greatest_of(const uint8_t values[COLUMNS])
{
	uint8_t most = 0;
	for (int c = 0; c < COLUMNS; c++)
		most = values[c] > most ? values[c] : most;
	return most;
}

/* What lies `away` cells before and behind along the line. */
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
 * Lines along y or z: d[i] = min over j of max(|i - j|, before[j]). The Chebyshev distance is
 * separable in this form. A window that grows only while it can still win bounds the work by the
 * answer.
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
		for (int away = 1; away < greatest_of(values); away++)
			relax_by(values, i - away >= 0 ? before[i - away] : none,
				 i + away < count ? before[i + away] : none, (uint8_t)away);
		memcpy(first + (size_t)i * stride, values, (size_t)columns);
	}
}

/* Chebyshev distance to the nearest cell that is 0; the others are 255. */
static void relax(const int dims[3], uint8_t *distance)
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

void gz_macrocells_classify(struct gz_macrocells *cells, const struct gz_transfer_table *table)
{
	const size_t count = cell_count(cells);
	for (size_t i = 0; i < count; i++) {
		const bool shows =
			gz_transfer_table_shows(table, cells->least[i], cells->greatest[i]);
		cells->distance[i] = shows ? 0 : 255;
		cells->reach[i] = shows ? 255 : 0;
	}
	relax(cells->dims, cells->distance);
	relax(cells->dims, cells->reach);
	for (size_t i = 0; i < count; i++) {
		const int empty = minimum(cells->distance[i], GZ_REACH_MAX);
		const int full = minimum(cells->reach[i], GZ_REACH_MAX);
		cells->reach[i] = (uint8_t)(GZ_REACH_BORDER + empty - full);
	}
}

void gz_macrocells_free(struct gz_macrocells *cells)
{
	free(cells->least);
	free(cells->greatest);
	free(cells->distance);
	free(cells->reach);
	*cells = (struct gz_macrocells) { 0 };
}
