#include "render/macrocells.h"

#include <stdlib.h>
#include <string.h>

static int minimum(int a, int b)
{
	return a < b ? a : b;
}

static int maximum(int a, int b)
{
	return a > b ? a : b;
}

/* Least and greatest of one row of voxels. Written out by type, so that each is a plain loop that
 * compilers turn into vector code. */
#define DEFINE_ROW_RANGE(name, type)                                               \
	static void name(const void *voxels, size_t from, int count, float *least, \
			 float *greatest)                                          \
	{                                                                          \
		const type *row = (const type *)voxels + from;                     \
		type low = row[0], high = row[0];                                  \
		for (int i = 1; i < count; i++) {                                  \
			low = row[i] < low ? row[i] : low;                         \
			high = row[i] > high ? row[i] : high;                      \
		}                                                                  \
		*least = (float)low < *least ? (float)low : *least;                \
		*greatest = (float)high > *greatest ? (float)high : *greatest;     \
	}

DEFINE_ROW_RANGE(row_range_u8, uint8_t)
DEFINE_ROW_RANGE(row_range_u16, uint16_t)
DEFINE_ROW_RANGE(row_range_f32, float)

typedef void row_range(const void *voxels, size_t from, int count, float *least, float *greatest);

static row_range *const row_ranges[GZ_VOXEL_TYPE_COUNT] = {
	[GZ_VOXEL_U8] = row_range_u8,
	[GZ_VOXEL_U16] = row_range_u16,
	[GZ_VOXEL_F32] = row_range_f32,
};

/* The voxels of a cell along one axis. */
static void cell_span(int cell, int dim, int *out_from, int *out_to)
{
	*out_from = maximum(cell * GZ_MACROCELL_EDGE - 1, 0);
	*out_to = minimum(cell * GZ_MACROCELL_EDGE + GZ_MACROCELL_EDGE, dim - 1);
}

static void find_cell(const struct gz_volume *volume, struct gz_macrocells *cells,
		      const int cell[3])
{
	int from[3], to[3];
	for (int axis = 0; axis < 3; axis++)
		cell_span(cell[axis], volume->dims[axis], &from[axis], &to[axis]);
	const size_t row = (size_t)volume->dims[0], slice = row * (size_t)volume->dims[1];
	float least = 3.4e38F, greatest = -3.4e38F;
	for (int z = from[2]; z <= to[2]; z++)
		for (int y = from[1]; y <= to[1]; y++)
			row_ranges[volume->type](volume->voxels,
						 (size_t)z * slice + (size_t)y * row +
							 (size_t)from[0],
						 to[0] - from[0] + 1, &least, &greatest);
	const size_t index = ((size_t)cell[2] * (size_t)cells->dims[1] + (size_t)cell[1]) *
				     (size_t)cells->dims[0] +
			     (size_t)cell[0];
	cells->least[index] = least;
	cells->greatest[index] = greatest;
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
	for (int z = 0; z < cells->dims[2]; z++)
		for (int y = 0; y < cells->dims[1]; y++)
			for (int x = 0; x < cells->dims[0]; x++)
				find_cell(volume, cells, (const int[3]) { x, y, z });
	return GZ_OK;
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
