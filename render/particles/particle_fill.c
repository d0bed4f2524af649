/* Voxels of particles. A part is a bundle of rows along x, TILE by TILE; it takes the particles
 * that reach it in the octree's order, so that sums do not depend on threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/particles/particle_cells.h"

enum {
	TILE = 16, /* rows along y and z. Chosen: a tile of 256 voxels' length fits into a
		      second-level cache */
	LANES = 8, /* voxels that are computed together */
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

/* A particle in units of voxels. */
struct placed_particle {
	float at[3];
	float weight;    /* sum */
	uint32_t number; /* nearest */
};

/* A run of voxels of a row, and the squared distance of the row from the particle. */
struct row_run {
	int first, last; /* voxels that may be within reach */
	float squared;
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

static struct placed_particle place_particle(const struct gz_particle_cells *cells, uint32_t index)
{
	struct placed_particle particle;
	for (int axis = 0; axis < 3; axis++)
		particle.at[axis] =
			(cells->tree.at[axis][index] - cells->origin[axis]) / cells->voxel;
	particle.weight = cells->weights ? cells->weights[index] : 0;
	particle.number = cells->tree.order[index];
	return particle;
}

/* The rows of a tile that a particle reaches along y or z. */
static void bound_rows(float centre, float reach, int least, int end, int *out_first, int *out_last)
{
	const float first = ceilf(centre - reach), last = floorf(centre + reach);
	*out_first = first > (float)least ? (int)fminf(first, (float)end) : least;
	*out_last = last < (float)(end - 1) ? (int)fmaxf(last, -1) : end - 1;
}

/* The voxels of a row within reach; a hair more, because of rounding. */
static bool find_run(const struct fill_job *job, const struct placed_particle *particle, float dy,
		     float dz, struct row_run *out_run)
{
	const float limit = job->reach * job->reach;
	out_run->squared = dy * dy + dz * dz;
	if (out_run->squared > limit)
		return false;
	const float half = sqrtf(limit - out_run->squared) + 1e-3F;
	bound_rows(particle->at[0], half, 0, job->cells->dims[0], &out_run->first, &out_run->last);
	return out_run->first <= out_run->last;
}

/* Where whole lanes can begin so that they cover a run; -1 if the row is too short for that. More
 * voxels than the run has do no harm: they are out of reach. */
static int start_of_lanes(const struct row_run *run, int length, int *out_lanes)
{
	const int lanes = (run->last - run->first + LANES) / LANES * LANES;
	*out_lanes = lanes;
	return run->first + lanes <= length ? run->first : length - lanes;
}

/* 2 ((1 - q)+^3 - 4 (1/2 - q)+^3) is the cubic spline of particle_grid.h. */
static float half_kernel(float squared, float per_reach)
{
	const float q = sqrtf(squared) * per_reach;
	const float outer = 1 - q > 0 ? 1 - q : 0;
	const float inner = 0.5F - q > 0 ? 0.5F - q : 0;
	return outer * outer * outer - 4 * (inner * inner * inner);
}

static void add_to_row(float *row, int length, const struct placed_particle *particle,
		       const struct row_run *run, float per_reach)
{
	static const float steps[LANES] = { 0, 1, 2, 3, 4, 5, 6, 7 };
	const float twice = 2 * particle->weight, px = particle->at[0], away = run->squared;
	int lanes;
	const int start = start_of_lanes(run, length, &lanes);
	for (int x = run->first; start < 0 && x <= run->last; x++) {
		const float dx = (float)x - px;
		row[x] += twice * half_kernel(dx * dx + away, per_reach);
	}
	for (int x = start; start >= 0 && x < start + lanes; x += LANES) {
		const float from = (float)x;
		float *voxels = row + x;
		for (int k = 0; k < LANES; k++) {
			const float dx = (from + steps[k]) - px;
			voxels[k] += twice * half_kernel(dx * dx + away, per_reach);
		}
	}
}

static void sum_tile(void *user, size_t part, int worker)
{
	struct fill_job *job = user;
	struct gz_particle_cells *cells = job->cells;
	const struct tile_rows rows = rows_of_tile(job, part);
	const size_t length = (size_t)cells->dims[0], slice = length * (size_t)cells->dims[1];
	const float per_reach = 1 / job->reach;
	struct gz_octree_walk walk;
	uint32_t run_first, run_count;
	if (!gz_particle_cells_go_on(cells, worker))
		return;
	for (int z = rows.least[1]; z < rows.end[1]; z++)
		memset(cells->voxels + (size_t)z * slice + (size_t)rows.least[0] * length, 0,
		       (size_t)(rows.end[0] - rows.least[0]) * length * sizeof(float));
	walk_tile(job, &rows, &walk);
	while (gz_octree_walk_next(&walk, &run_first, &run_count)) {
		for (uint32_t i = run_first; i < run_first + run_count; i++) {
			const struct placed_particle particle = place_particle(cells, i);
			int y0, y1, z0, z1;
			bound_rows(particle.at[1], job->reach, rows.least[0], rows.end[0], &y0,
				   &y1);
			bound_rows(particle.at[2], job->reach, rows.least[1], rows.end[1], &z0,
				   &z1);
			for (int z = z0; z <= z1; z++)
				for (int y = y0; y <= y1; y++) {
					struct row_run run;
					if (find_run(job, &particle, (float)y - particle.at[1],
						     (float)z - particle.at[2], &run))
						add_to_row(cells->voxels + (size_t)z * slice +
								   (size_t)y * length,
							   cells->dims[0], &particle, &run,
							   per_reach);
				}
		}
	}
	atomic_fetch_add(&cells->parts_done, 1);
}

/* Of particles that are equally near, the one that comes first in the file counts. */
static void take_nearer(float *squared, uint32_t *number, float distance, uint32_t candidate)
{
	const bool nearer = distance < *squared || (distance == *squared && candidate < *number);
	*squared = nearer ? distance : *squared;
	*number = nearer ? candidate : *number;
}

static void compare_row(float *squared, uint32_t *number, int length,
			const struct placed_particle *particle, const struct row_run *run)
{
	static const float steps[LANES] = { 0, 1, 2, 3, 4, 5, 6, 7 };
	const float px = particle->at[0], away = run->squared;
	const uint32_t candidate = particle->number;
	int lanes;
	const int start = start_of_lanes(run, length, &lanes);
	for (int x = run->first; start < 0 && x <= run->last; x++) {
		const float dx = (float)x - px;
		take_nearer(&squared[x], &number[x], dx * dx + away, candidate);
	}
	for (int x = start; start >= 0 && x < start + lanes; x += LANES) {
		const float from = (float)x;
		for (int k = 0; k < LANES; k++) {
			const float dx = (from + steps[k]) - px;
			take_nearer(&squared[x + k], &number[x + k], dx * dx + away, candidate);
		}
	}
}

static void compare_particle(const struct fill_job *job, const struct tile_rows *rows,
			     const struct nearest_tile *tile, uint32_t index)
{
	const struct placed_particle particle = place_particle(job->cells, index);
	const size_t length = (size_t)job->cells->dims[0];
	int y0, y1, z0, z1;
	bound_rows(particle.at[1], job->reach, rows->least[0], rows->end[0], &y0, &y1);
	bound_rows(particle.at[2], job->reach, rows->least[1], rows->end[1], &z0, &z1);
	for (int z = z0; z <= z1; z++)
		for (int y = y0; y <= y1; y++) {
			struct row_run run;
			const size_t row = ((size_t)(z - rows->least[1]) * TILE +
					    (size_t)(y - rows->least[0])) *
					   length;
			if (find_run(job, &particle, (float)y - particle.at[1],
				     (float)z - particle.at[2], &run))
				compare_row(tile->squared + row, tile->number + row, (int)length,
					    &particle, &run);
		}
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
	struct gz_octree_walk walk;
	uint32_t first, count;
	if (!gz_particle_cells_go_on(cells, worker))
		return;
	for (size_t i = 0; i < TILE * TILE * length; i++) {
		tile->squared[i] = job->reach * job->reach;
		tile->number[i] = UINT32_MAX;
	}
	walk_tile(job, &rows, &walk);
	while (gz_octree_walk_next(&walk, &first, &count)) {
		for (uint32_t i = first; i < first + count; i++)
			compare_particle(job, &rows, tile, i);
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
