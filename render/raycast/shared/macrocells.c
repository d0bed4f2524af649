#include "render/raycast/shared/macrocells.h"

#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/raycast/shared/voxel_ranges.h"

static int minimum(int a, int b)
{
	return a < b ? a : b;
}

/* Chosen: from here on, in voxels, threads are started for the work. */
#define PARALLEL_FROM ((size_t)1 << 23)

/* One voxel on each side: see struct gz_macrocells. */
static const struct gz_range_blocks macrocells = { GZ_MACROCELL_EDGE, 1, 1 };

/* What the threads that build cells share. */
struct building {
	const struct gz_volume *volume;
	struct gz_macrocells *cells;
	char *scratch; /* of each thread: what a row takes, and its ranges */
	size_t scratch_bytes;
};

static void to_floats(enum gz_voxel_type type, const void *values, int count, float *out)
{
	for (int i = 0; i < count; i++)
		out[i] = type == GZ_VOXEL_U8    ? ((const uint8_t *)values)[i]
			 : type == GZ_VOXEL_U16 ? ((const uint16_t *)values)[i]
						: ((const float *)values)[i];
}

static void find_slice(void *user, size_t part, int worker)
{
	const struct building *job = user;
	struct gz_macrocells *cells = job->cells;
	const enum gz_voxel_type type = job->volume->type;
	const size_t row = (size_t)cells->dims[0];
	char *scratch = job->scratch + (size_t)worker * job->scratch_bytes;
	char *least = scratch + gz_voxel_ranges_scratch(job->volume);
	char *greatest = least + row * gz_voxel_size(type);
	size_t index = part * (size_t)cells->dims[1] * row;
	for (int y = 0; y < cells->dims[1]; y++, index += row) {
		gz_voxel_ranges_row(job->volume, &macrocells, y, (int)part, cells->dims[0], scratch,
				    least, greatest);
		to_floats(type, least, cells->dims[0], cells->least + index);
		to_floats(type, greatest, cells->dims[0], cells->greatest + index);
	}
}

static enum gz_result find_all(struct building *job, struct gz_workers *workers)
{
	const size_t threads = workers ? (size_t)gz_workers_count(workers) : 1;
	const size_t slices = (size_t)job->cells->dims[2];
	job->scratch_bytes = gz_voxel_ranges_scratch(job->volume) +
			     2 * (size_t)job->cells->dims[0] * gz_voxel_size(job->volume->type);
	job->scratch = malloc(threads * job->scratch_bytes);
	if (!job->scratch)
		return GZ_ERR_NO_MEM;
	if (workers)
		gz_workers_run(workers, find_slice, job, slices);
	else
		for (size_t z = 0; z < slices; z++)
			find_slice(job, z, 0);
	free(job->scratch);
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
