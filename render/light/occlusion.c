#include "render/light/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/light/light_cells.h"

/* A voxel that is filled completely. The largest cell, 32^3 voxels, sums up to less than 2^32. */
enum { FULL = 65535 };

/* Most cells that the weights reach to either side. A cell is longer than R / 8: it is at most R /
 * 2 and is halved at most twice, once for the power of two and once for coarse spacing. */
enum { REACH_MAX = 8 };

/* Cells along the longest axis. */
enum { LINE_MAX_CELLS = GZ_VOLUME_DIM_MAX };

/* Number of stored values of 16-bit voxels. */
enum { INTEGER_VALUES = 65536 };

static double finest_spacing(const struct gz_volume *volume)
{
	return fmin(fmin(volume->spacing[0], volume->spacing[1]), volume->spacing[2]);
}

void gz_occlusion_edges(const struct gz_volume *volume, double radius, int out_edge[3])
{
	int edge = 2;
	while (2 * edge <= radius / 2)
		edge *= 2;
	for (int axis = 0; axis < 3; axis++) {
		const double ratio = volume->spacing[axis] / finest_spacing(volume);
		out_edge[axis] = 1;
		while (2 * out_edge[axis] * ratio <= edge)
			out_edge[axis] *= 2;
	}
}

/* The job that the workers share. */
struct job {
	const struct gz_volume *volume;
	const struct gz_transfer_table *table;
	struct gz_occlusion *occlusion;
	struct gz_clip_voxels shown;
	uint16_t by_entry[GZ_TRANSFER_TABLE_MOST]; /* how much a voxel fills, by its table entry */
	uint16_t by_value[INTEGER_VALUES];         /* how much a voxel fills, by its stored value */
	int axis;                                  /* along which cells are weighted */
	float weights[2 * REACH_MAX + 1]; /* from the cell at -reach to the one at +reach */
	int reach;
};

static void find_filled(struct job *job, double radius)
{
	for (int i = 0; i < job->table->count; i++) {
		const double extinction = (double)job->table->entries[i].extinction;
		job->by_entry[i] = (uint16_t)lround(FULL * (1 - exp2(extinction * radius / 2)));
	}
	if (job->volume->type == GZ_VOXEL_F32)
		return;
	const int values = job->volume->type == GZ_VOXEL_U8 ? 256 : INTEGER_VALUES;
	for (int value = 0; value < values; value++)
		job->by_value[value] =
			job->by_entry[gz_transfer_table_nearest(job->table, (float)value)];
}

static uint32_t sum_row(const struct job *job, size_t from, int count)
{
	const struct gz_volume *volume = job->volume;
	uint32_t sum = 0;
	if (volume->type == GZ_VOXEL_U8)
		for (int i = 0; i < count; i++)
			sum += job->by_value[((const uint8_t *)volume->voxels)[from + (size_t)i]];
	else if (volume->type == GZ_VOXEL_U16)
		for (int i = 0; i < count; i++)
			sum += job->by_value[((const uint16_t *)volume->voxels)[from + (size_t)i]];
	else
		for (int i = 0; i < count; i++)
			sum += job->by_entry[gz_transfer_table_nearest(
				job->table, ((const float *)volume->voxels)[from + (size_t)i])];
	return sum;
}

static uint16_t fill_cell(const struct job *job, const int cell[3])
{
	const int *dims = job->volume->dims, *edge = job->occlusion->edge;
	const struct gz_clip_voxels *shown = &job->shown;
	int from[3], to[3];
	for (int axis = 0; axis < 3; axis++) {
		from[axis] = cell[axis] * edge[axis];
		to[axis] = from[axis] + edge[axis];
		from[axis] = from[axis] > shown->from[axis] ? from[axis] : shown->from[axis];
		to[axis] = to[axis] < shown->to[axis] ? to[axis] : shown->to[axis];
	}
	uint32_t sum = 0;
	for (int z = from[2]; z < to[2]; z++)
		for (int y = from[1]; y < to[1]; y++) {
			const size_t row = (size_t)z * (size_t)dims[1] + (size_t)y;
			int first = from[0], end = to[0];
			gz_clip_voxels_keep(shown, y, z, &first, &end);
			sum += sum_row(job, row * (size_t)dims[0] + (size_t)first, end - first);
		}
	const uint32_t voxels = (uint32_t)(edge[0] * edge[1] * edge[2]);
	return (uint16_t)((sum + voxels / 2) / voxels);
}

/* A part is a row of cells. */
static void fill_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int *dims = job->occlusion->dims;
	uint16_t *cells = job->occlusion->cells + part * (size_t)dims[0];
	int cell[3] = { 0, (int)(part % (size_t)dims[1]), (int)(part / (size_t)dims[1]) };
	for (; cell[0] < dims[0]; cell[0]++)
		cells[cell[0]] = fill_cell(job, cell);
}

static void find_tent_weights(struct job *job, int axis, double radius)
{
	const struct gz_volume *volume = job->volume;
	const double cell =
		job->occlusion->edge[axis] * volume->spacing[axis] / finest_spacing(volume);
	double sum = 1;
	job->axis = axis;
	job->reach = 0;
	while (job->reach < REACH_MAX && (job->reach + 1) * cell < radius) {
		job->reach++;
		sum += 2 * (1 - job->reach * cell / radius);
	}
	for (int away = -job->reach; away <= job->reach; away++)
		job->weights[away + job->reach] = (float)((1 - abs(away) * cell / radius) / sum);
}

/* Weight one line of cells. */
static void weight_line(const struct job *job, uint16_t *cells, size_t stride, int count)
{
	uint16_t line[LINE_MAX_CELLS];
	for (int i = 0; i < count; i++)
		line[i] = cells[(size_t)i * stride];
	for (int i = 0; i < count; i++) {
		const int first = i > job->reach ? i - job->reach : 0;
		const int last = i + job->reach < count ? i + job->reach : count - 1;
		float sum = 0;
		for (int j = first; j <= last; j++)
			sum += job->weights[j - i + job->reach] * (float)line[j];
		cells[(size_t)i * stride] = (uint16_t)(fminf(sum, FULL) + 0.5F);
	}
}

/* A part is all lines through one row (along y, z) or column (along x) of cells. */
static void weight_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int *dims = job->occlusion->dims;
	const size_t strides[3] = { 1, (size_t)dims[0], (size_t)dims[0] * (size_t)dims[1] };
	const int across = job->axis == 0 ? 1 : 0, along = 3 - job->axis - across;
	uint16_t *cells = job->occlusion->cells + part * strides[along];
	for (int i = 0; i < dims[across]; i++)
		weight_line(job, cells + (size_t)i * strides[across], strides[job->axis],
			    dims[job->axis]);
}

static enum gz_result reserve(struct gz_occlusion *occlusion)
{
	const size_t count = (size_t)occlusion->dims[0] * (size_t)occlusion->dims[1] *
			     (size_t)occlusion->dims[2];
	return gz_light_cells_reserve(count, &occlusion->cells, &occlusion->capacity);
}

static void run_parts(struct gz_workers *workers, gz_workers_part *part, struct job *job,
		      size_t parts)
{
	if (workers) {
		gz_workers_run(workers, part, job, parts);
		return;
	}
	for (size_t i = 0; i < parts; i++)
		part(job, i, 0);
}

static void make_grid(struct job *job, double radius, struct gz_workers *workers)
{
	const int *dims = job->occlusion->dims;
	run_parts(workers, fill_part, job, (size_t)dims[1] * (size_t)dims[2]);
	for (int axis = 0; axis < 3; axis++) {
		find_tent_weights(job, axis, radius);
		run_parts(workers, weight_part, job, (size_t)dims[axis == 2 ? 1 : 2]);
	}
}

enum gz_result gz_occlusion_make(const struct gz_volume *volume,
				 const struct gz_transfer_table *table, double radius,
				 const struct gz_clip_region *clip, struct gz_workers *workers,
				 struct gz_occlusion *occlusion)
{
	gz_occlusion_edges(volume, radius, occlusion->edge);
	for (int axis = 0; axis < 3; axis++) {
		const int edge = occlusion->edge[axis];
		occlusion->dims[axis] = (volume->dims[axis] + edge - 1) / edge;
	}
	struct job *job = calloc(1, sizeof *job);
	if (!job || reserve(occlusion) != GZ_OK) {
		free(job);
		gz_occlusion_free(occlusion);
		return GZ_ERR_NO_MEM;
	}
	job->volume = volume;
	job->table = table;
	job->occlusion = occlusion;
	find_filled(job, radius);
	gz_clip_region_voxels(clip, volume, &job->shown);
	make_grid(job, radius, workers);
	free(job);
	return GZ_OK;
}

void gz_occlusion_free(struct gz_occlusion *occlusion)
{
	free(occlusion->cells);
	*occlusion = (struct gz_occlusion) { 0 };
}
