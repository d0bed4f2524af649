#include "render/raycast/shared/shadow_cells.h"

#include <math.h>
#include <stdlib.h>

#include "render/light/light_cells.h"

/* Number of stored values of 16-bit voxels. */
enum { STORED_VALUES = 65536 };

/* The job that the workers share: one level. */
struct shadow_job {
	const struct gz_volume *volume;
	const struct gz_transfer_table *table;
	struct gz_shadow_cells *cells;
	int index; /* of the level */
	struct gz_clip_voxels shown;
	float by_entry[GZ_TRANSFER_TABLE_MOST]; /* what a voxel lets through, by its entry */
	float by_value[STORED_VALUES];          /* the same by its stored value */
};

static float voxel_through(const struct shadow_job *job, const int at[3])
{
	if (!gz_clip_voxels_hold(&job->shown, at))
		return 1;
	const struct gz_volume *volume = job->volume;
	const size_t index = ((size_t)at[2] * (size_t)volume->dims[1] + (size_t)at[1]) *
				     (size_t)volume->dims[0] +
			     (size_t)at[0];
	if (volume->type == GZ_VOXEL_U8)
		return job->by_value[((const uint8_t *)volume->voxels)[index]];
	if (volume->type == GZ_VOXEL_U16)
		return job->by_value[((const uint16_t *)volume->voxels)[index]];
	return job->by_entry[gz_transfer_table_nearest(job->table,
						       ((const float *)volume->voxels)[index])];
}

static float cell_through(const struct shadow_job *job, const int at[3])
{
	const struct gz_shadow_level *level = &job->cells->level[job->index - 1];
	for (int axis = 0; axis < 3; axis++)
		if (at[axis] >= level->dims[axis])
			return 1;
	const size_t index =
		((size_t)at[2] * (size_t)level->dims[1] + (size_t)at[1]) * (size_t)level->dims[0] +
		(size_t)at[0];
	return exp2f(-(float)job->cells->cells[level->first + index] / GZ_SHADOW_UNIT);
}

/* The share of light that comes through a cell of eight children; bit i of a child's number is its
 * place along axis i. */
static float mean_through(const float child[8])
{
	float sum = 0;
	for (int axis = 0; axis < 3; axis++)
		for (int i = 0; i < 8; i++)
			if (!(i >> axis & 1))
				sum += child[i] * child[i | 1 << axis];
	return sum / 12;
}

static uint16_t shadow_cell(const struct shadow_job *job, const int cell[3])
{
	const struct gz_shadow_level *level = &job->cells->level[job->index];
	float child[8];
	for (int i = 0; i < 8; i++) {
		int at[3];
		for (int axis = 0; axis < 3; axis++) {
			const int before = job->index ? level[-1].edge[axis] : 1;
			const int children = level->edge[axis] / before;
			at[axis] = cell[axis] * children + (children > 1 ? i >> axis & 1 : 0);
		}
		child[i] = job->index ? cell_through(job, at) : voxel_through(job, at);
	}
	const float kept = -log2f(fmaxf(mean_through(child), exp2f(-GZ_SHADOW_MOST)));
	return (uint16_t)(kept * GZ_SHADOW_UNIT + 0.5F);
}

/* A part is a row of cells. */
static void shadow_row(void *user, size_t part, int worker)
{
	(void)worker;
	const struct shadow_job *job = user;
	const struct gz_shadow_level *level = &job->cells->level[job->index];
	const int *dims = level->dims;
	uint16_t *row = job->cells->cells + level->first + part * (size_t)dims[0];
	int cell[3] = { 0, (int)(part % (size_t)dims[1]), (int)(part / (size_t)dims[1]) };
	for (; cell[0] < dims[0]; cell[0]++)
		row[cell[0]] = shadow_cell(job, cell);
}

static void shadow_rows(struct gz_workers *workers, struct shadow_job *job)
{
	const int *dims = job->cells->level[job->index].dims;
	const size_t parts = (size_t)dims[1] * (size_t)dims[2];
	if (workers) {
		gz_workers_run(workers, shadow_row, job, parts);
		return;
	}
	for (size_t i = 0; i < parts; i++)
		shadow_row(job, i, 0);
}

static void find_voxels_through(struct shadow_job *job)
{
	for (int i = 0; i < job->table->count; i++)
		job->by_entry[i] = exp2f(job->table->entries[i].extinction);
	if (job->volume->type == GZ_VOXEL_F32)
		return;
	const int values = job->volume->type == GZ_VOXEL_U8 ? 256 : STORED_VALUES;
	for (int value = 0; value < values; value++)
		job->by_value[value] =
			job->by_entry[gz_transfer_table_nearest(job->table, (float)value)];
}

/* Set sizes and places of all levels. Returns the number of cells. */
static size_t lay_out_levels(const struct gz_volume *volume, struct gz_shadow_cells *cells)
{
	const double *spacing = volume->spacing;
	const double finest = fmin(fmin(spacing[0], spacing[1]), spacing[2]);
	size_t total = 0;
	bool single = false;
	for (cells->count = 0; cells->count < GZ_SHADOW_LEVELS && !single; cells->count++) {
		struct gz_shadow_level *level = &cells->level[cells->count];
		size_t here = 1;
		for (int axis = 0; axis < 3; axis++) {
			int edge = 1;
			while (2 * edge * spacing[axis] <= finest * (2 << cells->count))
				edge *= 2;
			level->edge[axis] = edge;
			level->dims[axis] = (volume->dims[axis] + edge - 1) / edge;
			here *= (size_t)level->dims[axis];
		}
		level->first = total;
		total += here;
		single = here == 1;
	}
	return total;
}

enum gz_result gz_shadow_cells_make(const struct gz_volume *volume,
				    const struct gz_transfer_table *table,
				    const struct gz_clip_region *clip, struct gz_workers *workers,
				    struct gz_shadow_cells *cells)
{
	struct shadow_job *job = calloc(1, sizeof *job);
	if (!job || gz_light_cells_reserve(lay_out_levels(volume, cells), &cells->cells,
					   &cells->capacity) != GZ_OK) {
		free(job);
		gz_shadow_cells_free(cells);
		return GZ_ERR_NO_MEM;
	}
	job->volume = volume;
	job->table = table;
	job->cells = cells;
	gz_clip_region_voxels(clip, volume, &job->shown);
	find_voxels_through(job);
	for (; job->index < cells->count; job->index++)
		shadow_rows(workers, job);
	free(job);
	return GZ_OK;
}

void gz_shadow_cells_free(struct gz_shadow_cells *cells)
{
	free(cells->cells);
	*cells = (struct gz_shadow_cells) { 0 };
}
