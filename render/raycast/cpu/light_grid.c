#include "render/raycast/cpu/light_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/light/light_cells.h"
#include "render/light/light_constants.h"

#define GZ_LOG_MODULE "render"

/* Voxels along the edge of a macrocell. */
enum { MACROCELL = GZ_MACROCELL_EDGE };

/* The job that the workers share. */
struct light_grid_job {
	const struct gz_light_grid_request *request;
	struct gz_light_walk walk;
	struct gz_light_grid *grid;
	bool everywhere; /* make all cells */
	/* For shades: a voxel and the first datum in the world, and GZ_SHADOW_START. */
	float world_per_voxel[3], first_datum[3], start;
};

void gz_light_grid_forget(struct gz_light_grid *grid)
{
	grid->current = false;
}

size_t gz_light_grid_lay_out(const struct gz_shadow_cells *shadows, struct gz_light_grid *grid)
{
	size_t count = 0;
	for (int i = 0; i < shadows->count; i++) {
		const struct gz_shadow_level *level = &shadows->level[i];
		count = (size_t)level->dims[0] * (size_t)level->dims[1] * (size_t)level->dims[2];
		memcpy(grid->dims, level->dims, sizeof grid->dims);
		memcpy(grid->edge, level->edge, sizeof grid->edge);
		if (count <= GZ_LIGHT_GRID_MOST)
			break;
	}
	return count;
}

/* The number of the macrocell that holds the middle of a cell, along one axis. */
static size_t macrocell_of(const struct light_grid_job *job, int axis, int cell)
{
	const int edge = job->grid->edge[axis];
	const int number = (cell * edge + edge / 2) / MACROCELL;
	const int last = job->request->cells->dims[axis] - 1;
	return (size_t)(number < last ? number : last);
}

/* Whether a sample that shows something can look up a cell: it reads the cells around it, which
 * reach no farther than into the next macrocell. */
static bool is_cell_wanted(const struct light_grid_job *job, const int cell[3])
{
	const struct gz_macrocells *cells = job->request->cells;
	if (job->everywhere)
		return true;
	const size_t row = macrocell_of(job, 2, cell[2]) * (size_t)cells->dims[1] +
			   macrocell_of(job, 1, cell[1]);
	return cells->distance[row * (size_t)cells->dims[0] + macrocell_of(job, 0, cell[0])] <= 1;
}

/* Multiply the shares of cells by what others let through. */
static void dim_cells_by_shades(const struct light_grid_job *job,
				const struct gz_cast_places *places, float shares[GZ_TILE_RAYS])
{
	const struct gz_light_grid_request *request = job->request;
	struct gz_shade_places asked = { .from = job->start };
	for (int i = 0; i < GZ_TILE_RAYS; i++) {
		const bool active = places->active >> i & 1 && shares[i] > 0;
		asked.active |= (uint32_t)active << i;
		for (int axis = 0; axis < 3; axis++)
			asked.at[axis][i] = places->at[axis][i] * job->world_per_voxel[axis] +
					    job->first_datum[axis];
	}
	for (size_t k = 0; k < request->shade_count && asked.active; k++) {
		float through[GZ_SHADE_PLACES];
		request->shades[k].find(request->shades[k].user, &asked, through);
		for (int i = 0; i < GZ_TILE_RAYS; i++)
			if (asked.active >> i & 1)
				shares[i] *= through[i];
	}
}

/* Fill some cells of a row, from one on. */
static void fill_light_cells(const struct light_grid_job *job, const int first[3], int count,
			     uint16_t *out_cells)
{
	const struct gz_light_walk *walk = &job->walk;
	const int *edge = job->grid->edge;
	struct gz_cast_places places = { .longer = 1 };
	float shares[GZ_TILE_RAYS] = { 0 };
	for (int i = 0; i < count; i++) {
		const int cell[3] = { first[0] + i, first[1], first[2] };
		for (int axis = 0; axis < 3; axis++)
			places.at[axis][i] = ((float)cell[axis] + 0.5F) * (float)edge[axis] - 0.5F;
		places.active |= (uint32_t)is_cell_wanted(job, cell) << i;
	}
	if (places.active)
		walk->arriving(&walk->cast, walk->type, walk->nearest, &places, shares);
	if (places.active && job->request->shade_count > 0)
		dim_cells_by_shades(job, &places, shares);
	for (int i = 0; i < count; i++) {
		const float rounded = shares[i] * GZ_LIGHT_GRID_UNIT + 0.5F;
		out_cells[i] = places.active >> i & 1 ? (uint16_t)rounded : GZ_LIGHT_GRID_UNIT;
	}
}

/* A part is a row of cells. */
static void light_grid_row(void *user, size_t part, int worker)
{
	const struct light_grid_job *job = user;
	const int *dims = job->grid->dims;
	uint16_t *row = job->grid->cells + part * (size_t)dims[0];
	int first[3] = { 0, (int)(part % (size_t)dims[1]), (int)(part / (size_t)dims[1]) };
	(void)worker;
	for (; first[0] < dims[0]; first[0] += GZ_TILE_RAYS) {
		const int rest = dims[0] - first[0];
		fill_light_cells(job, first, rest < GZ_TILE_RAYS ? rest : GZ_TILE_RAYS,
				 row + first[0]);
	}
}

static void light_grid_rows(struct light_grid_job *job)
{
	const int *dims = job->grid->dims;
	const size_t rows = (size_t)dims[1] * (size_t)dims[2];
	if (job->request->workers) {
		gz_workers_run(job->request->workers, light_grid_row, job, rows);
		return;
	}
	for (size_t i = 0; i < rows; i++)
		light_grid_row(job, i, 0);
}

static struct gz_light_grid_key key_of(const struct light_grid_job *job)
{
	const struct gz_cast_shadow *shadow = &job->walk.cast.light.shadow;
	struct gz_light_grid_key key = {
		.steps = shadow->steps,
		.reach = shadow->reach,
		.clip = job->request->rays->clip,
		.nearest = job->walk.nearest,
		.everywhere = job->everywhere,
	};
	memcpy(key.towards, shadow->towards, sizeof key.towards);
	for (size_t i = 0; i < job->request->shade_count; i++)
		key.shades[i] = job->request->shades[i].revision;
	return key;
}

static bool same_key(const struct gz_light_grid_key *a, const struct gz_light_grid_key *b)
{
	return a->steps == b->steps && a->reach == b->reach && a->nearest == b->nearest &&
	       a->everywhere == b->everywhere && a->towards[0] == b->towards[0] &&
	       a->towards[1] == b->towards[1] && a->towards[2] == b->towards[2] &&
	       memcmp(a->shades, b->shades, sizeof a->shades) == 0 &&
	       gz_clip_region_same(&a->clip, &b->clip);
}

/* Whether the grid that is there is the one that is asked for. */
static bool is_grid_current(const struct light_grid_job *job, const struct gz_light_grid_key *key)
{
	for (size_t i = 0; i < job->request->shade_count; i++)
		if (key->shades[i] == 0)
			return false;
	return job->grid->current && same_key(&job->grid->key, key);
}

/* Find where cells are in the world. */
static void place_in_world(struct light_grid_job *job)
{
	const struct gz_volume *volume = job->request->lighting->volume;
	double half[3];
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++) {
		const double edge = 2 * half[axis] / volume->dims[axis];
		job->world_per_voxel[axis] = (float)edge;
		job->first_datum[axis] = (float)(edge / 2 - half[axis]);
	}
	job->start = (float)(GZ_SHADOW_START * gz_volume_voxel_length(volume));
}

static enum gz_result make_light_grid(struct light_grid_job *job)
{
	const struct gz_light_grid_request *request = job->request;
	struct gz_light_grid *grid = job->grid;
	const struct gz_light_grid_key key = key_of(job);
	if (is_grid_current(job, &key))
		return GZ_OK;
	grid->current = false;
	const size_t count = gz_light_grid_lay_out(&request->lighting->shadows, grid);
	if (gz_light_cells_reserve(count, &grid->cells, &grid->capacity) != GZ_OK) {
		gz_err(request->log, "no memory for shadows: set light.shadow_steps to 0");
		gz_light_grid_free(grid);
		return GZ_ERR_NO_MEM;
	}
	for (int axis = 0; axis < 3; axis++) /* else they reach beyond the next macrocell */
		job->everywhere = job->everywhere || grid->edge[axis] > MACROCELL;
	place_in_world(job);
	light_grid_rows(job);
	grid->key = key;
	grid->current = true;
	grid->serial++;
	return GZ_OK;
}

enum gz_result gz_light_grid_make(const struct gz_light_grid_request *request,
				  struct gz_light_grid *grid)
{
	struct light_grid_job job = { .request = request,
				      .grid = grid,
				      .everywhere = request->everywhere };
	const enum gz_result result =
		gz_light_walk_make(request->lighting, request->arriving, request->rays,
				   request->ray_frame, request->log, &job.walk);
	return result == GZ_OK ? make_light_grid(&job) : result;
}

void gz_light_grid_free(struct gz_light_grid *grid)
{
	free(grid->cells);
	*grid = (struct gz_light_grid) { .serial = grid->serial };
}
