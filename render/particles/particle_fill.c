/* Voxels of particles. A part is a bundle of rows along x, TILE by TILE; it takes the particles
 * that reach it in the octree's order, so that sums do not depend on threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/particles/particle_cells.h"

enum {
	TILE = 16, /* rows along y and z. Chosen: a tile of 256 voxels' length fits into a
		      second-level cache */
};

/* What the nearest particles are found with: squared distances and numbers of a tile's voxels. */
struct nearest_tile {
	float *squared;
	uint32_t *number;
};

struct fill_job {
	struct gz_particle_cells *cells;
	struct nearest_tile tiles[GZ_WORKERS_MAX]; /* nearest only */
	int tiles_along_y;
	float reach; /* of a particle, voxels */
};

/* Rows of one tile: [least, end) along y and z. */
struct tile_rows {
	int least[2], end[2];
};

static struct tile_rows rows_of_tile(const struct fill_job *job, size_t part)
{
	const int *dims = job->cells->dims;
	struct tile_rows rows;
	rows.least[0] = (int)(part % (size_t)job->tiles_along_y) * TILE;
	rows.least[1] = (int)(part / (size_t)job->tiles_along_y) * TILE;
	for (int i = 0; i < 2; i++) {
		const int end = rows.least[i] + TILE;
		rows.end[i] = end < dims[i + 1] ? end : dims[i + 1];
	}
	return rows;
}

/* Begin to search for the particles that reach a tile. */
static void walk_tile(const struct fill_job *job, const struct tile_rows *rows,
		      struct gz_octree_walk *walk)
{
	const struct gz_particle_cells *cells = job->cells;
	/* A hair more than it reaches, because of rounding. */
	const float reach = cells->support + 0.01F * cells->voxel;
	float least[3] = { -INFINITY }, greatest[3] = { INFINITY };
	for (int i = 0; i < 2; i++) {
		least[i + 1] = cells->origin[i + 1] + (float)rows->least[i] * cells->voxel - reach;
		greatest[i + 1] =
			cells->origin[i + 1] + (float)(rows->end[i] - 1) * cells->voxel + reach;
	}
	gz_octree_walk_begin(walk, &cells->tree, least, greatest);
}

/* A particle of the tree, and the rows of a tile. */
static void place_splat(const struct fill_job *job, uint32_t index, struct gz_particle_splat *splat)
{
	const struct gz_particle_cells *cells = job->cells;
	for (int axis = 0; axis < 3; axis++)
		splat->at[axis] =
			(cells->tree.at[axis][index] - cells->origin[axis]) / cells->voxel;
	splat->weight = cells->weights ? cells->weights[index] : 0;
	splat->number = cells->tree.order[index];
}

static struct gz_particle_splat splat_of_tile(const struct fill_job *job,
					      const struct tile_rows *rows)
{
	return (struct gz_particle_splat) {
		.reach = job->reach,
		.length = job->cells->dims[0],
		.least = { rows->least[0], rows->least[1] },
		.end = { rows->end[0], rows->end[1] },
	};
}

static void sum_tile(void *user, size_t part, int worker)
{
	struct fill_job *job = user;
	struct gz_particle_cells *cells = job->cells;
	const struct tile_rows rows = rows_of_tile(job, part);
	const size_t length = (size_t)cells->dims[0], slice = length * (size_t)cells->dims[1];
	float *voxels =
		cells->voxels + (size_t)rows.least[1] * slice + (size_t)rows.least[0] * length;
	struct gz_particle_splat splat = splat_of_tile(job, &rows);
	struct gz_octree_walk walk;
	uint32_t first, count;
	splat.stride[0] = length;
	splat.stride[1] = slice;
	if (!gz_particle_cells_go_on(cells, worker))
		return;
	for (int z = rows.least[1]; z < rows.end[1]; z++)
		memset(voxels + (size_t)(z - rows.least[1]) * slice, 0,
		       (size_t)(rows.end[0] - rows.least[0]) * length * sizeof(float));
	walk_tile(job, &rows, &walk);
	while (gz_octree_walk_next(&walk, &first, &count))
		for (uint32_t i = first; i < first + count; i++) {
			place_splat(job, i, &splat);
			cells->kernels->add(&splat, voxels);
		}
	atomic_fetch_add(&cells->parts_done, 1);
}

/* The values of the nearest particles of a row; 0 where none is near. */
static void write_row(const struct gz_particle_cells *cells, const uint32_t *number, float *row)
{
	const float *values = cells->particles->values;
	for (int x = 0; x < cells->dims[0]; x++)
		row[x] = number[x] == UINT32_MAX ? 0 : values ? values[number[x]] : 1;
}

static void nearest_tile(void *user, size_t part, int worker)
{
	struct fill_job *job = user;
	struct gz_particle_cells *cells = job->cells;
	const struct tile_rows rows = rows_of_tile(job, part);
	const struct nearest_tile *tile = &job->tiles[worker];
	const size_t length = (size_t)cells->dims[0], slice = length * (size_t)cells->dims[1];
	struct gz_particle_splat splat = splat_of_tile(job, &rows);
	struct gz_octree_walk walk;
	uint32_t first, count;
	splat.stride[0] = length;
	splat.stride[1] = TILE * length;
	if (!gz_particle_cells_go_on(cells, worker))
		return;
	for (size_t i = 0; i < TILE * TILE * length; i++) {
		tile->squared[i] = job->reach * job->reach;
		tile->number[i] = UINT32_MAX;
	}
	walk_tile(job, &rows, &walk);
	while (gz_octree_walk_next(&walk, &first, &count))
		for (uint32_t i = first; i < first + count; i++) {
			place_splat(job, i, &splat);
			cells->kernels->compare(&splat, tile->squared, tile->number);
		}
	for (int z = rows.least[1]; z < rows.end[1]; z++)
		for (int y = rows.least[0]; y < rows.end[0]; y++)
			write_row(cells,
				  tile->number + ((size_t)(z - rows.least[1]) * TILE +
						  (size_t)(y - rows.least[0])) *
							 length,
				  cells->voxels + (size_t)z * slice + (size_t)y * length);
	atomic_fetch_add(&cells->parts_done, 1);
}

static enum gz_result run_fill(struct fill_job *job, struct gz_workers *workers,
			       gz_workers_part *part)
{
	struct gz_particle_cells *cells = job->cells;
	job->tiles_along_y = (cells->dims[1] + TILE - 1) / TILE;
	job->reach = cells->support / cells->voxel;
	cells->parts = (size_t)job->tiles_along_y * (size_t)((cells->dims[2] + TILE - 1) / TILE);
	atomic_store(&cells->parts_done, 0);
	gz_workers_run(workers, part, job, cells->parts);
	return (enum gz_result)atomic_load(&cells->result);
}

enum gz_result gz_particle_sum_fill(struct gz_particle_cells *cells, struct gz_workers *workers)
{
	struct fill_job job = { .cells = cells };
	return run_fill(&job, workers, sum_tile);
}

enum gz_result gz_particle_nearest_fill(struct gz_particle_cells *cells, struct gz_workers *workers)
{
	struct fill_job job = { .cells = cells };
	const size_t voxels = (size_t)TILE * TILE * (size_t)cells->dims[0];
	const int count = gz_workers_count(workers);
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		job.tiles[i].squared = malloc(voxels * sizeof *job.tiles[i].squared);
		job.tiles[i].number = malloc(voxels * sizeof *job.tiles[i].number);
		if (!job.tiles[i].squared || !job.tiles[i].number)
			result = GZ_ERR_NO_MEM;
	}
	if (result == GZ_OK)
		result = run_fill(&job, workers, nearest_tile);
	for (int i = 0; i < count; i++) {
		free(job.tiles[i].squared);
		free(job.tiles[i].number);
	}
	return result;
}
