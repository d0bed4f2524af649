/* The weight of each particle in a sum of kernels: its value over its density, which is itself a
 * sum of kernels. Particles are taken in runs of the octree that are no wider than a kernel; the
 * particles near a run are gathered once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/particles/particle_cells.h"

enum {
	BATCH = 64, /* runs of one part */
	FIRST_ROOM = 4096,
};

/* Farther than any kernel reaches. */
#define FAR_AWAY 1e6F

/* Particles near a run. */
struct near_particles {
	float *at[3];
	size_t count, room;
};

struct weight_job {
	struct gz_particle_cells *cells;
	uint32_t *runs; /* indices of nodes */
	size_t run_count;
	struct near_particles near[GZ_WORKERS_MAX];
};

static bool is_run(const struct gz_particle_cells *cells, const struct gz_octree_node *node)
{
	bool small = true;
	for (int axis = 0; axis < 3; axis++)
		small = small && node->greatest[axis] - node->least[axis] <= cells->support;
	return small || node->children == 0;
}

/* The largest nodes that are small enough. */
static void list_runs(struct weight_job *job, uint32_t index)
{
	const struct gz_octree_node *node = &job->cells->tree.nodes[index];
	if (is_run(job->cells, node)) {
		job->runs[job->run_count++] = index;
		return;
	}
	for (uint32_t i = 0; i < node->children; i++)
		list_runs(job, node->child + i);
}

static bool make_room(struct near_particles *near, size_t wanted)
{
	if (wanted <= near->room)
		return true;
	const size_t room = wanted > 2 * near->room ? wanted + FIRST_ROOM : 2 * near->room;
	for (int axis = 0; axis < 3; axis++) {
		float *at = realloc(near->at[axis], room * sizeof *at);
		if (!at)
			return false;
		near->at[axis] = at;
	}
	near->room = room;
	return true;
}

/* Gather all particles within reach of a run; the list is filled up to whole lanes. */
static bool gather_near(const struct gz_particle_cells *cells, const struct gz_octree_node *run,
			struct near_particles *near)
{
	struct gz_octree_walk walk;
	float least[3], greatest[3];
	uint32_t first, count;
	for (int axis = 0; axis < 3; axis++) {
		least[axis] = run->least[axis] - cells->support;
		greatest[axis] = run->greatest[axis] + cells->support;
	}
	near->count = 0;
	gz_octree_walk_begin(&walk, &cells->tree, least, greatest);
	while (gz_octree_walk_next(&walk, &first, &count)) {
		if (!make_room(near, near->count + count + GZ_PARTICLE_SUM_LANES))
			return false;
		for (int axis = 0; axis < 3; axis++)
			memcpy(near->at[axis] + near->count, cells->tree.at[axis] + first,
			       count * sizeof(float));
		near->count += count;
	}
	while (near->count % GZ_PARTICLE_SUM_LANES != 0) {
		for (int axis = 0; axis < 3; axis++)
			near->at[axis][near->count] = FAR_AWAY;
		near->count++;
	}
	return true;
}

static void weigh_run(struct gz_particle_cells *cells, const struct gz_octree_node *run,
		      const struct near_particles *near)
{
	const float *values = cells->particles->values;
	const struct gz_octree *tree = &cells->tree;
	for (uint32_t i = run->first; i < run->first + run->count; i++) {
		const float point[3] = { tree->at[0][i], tree->at[1][i], tree->at[2][i] };
		const double sum =
			cells->kernels->sum(near->at, near->count, point, 1 / cells->support);
		const double value = values ? (double)values[tree->order[i]] : 1;
		cells->weights[i] = (float)(value / sum);
	}
}

static void weigh_batch(void *user, size_t part, int worker)
{
	struct weight_job *job = user;
	struct gz_particle_cells *cells = job->cells;
	struct near_particles *near = &job->near[worker];
	const size_t end =
		(part + 1) * BATCH < job->run_count ? (part + 1) * BATCH : job->run_count;
	if (!gz_particle_cells_go_on(cells, worker))
		return;
	for (size_t i = part * BATCH; i < end; i++) {
		const struct gz_octree_node *run = &cells->tree.nodes[job->runs[i]];
		if (!gather_near(cells, run, near)) {
			atomic_store(&cells->result, GZ_ERR_NO_MEM);
			return;
		}
		const uint64_t pairs = (uint64_t)run->count * near->count;
		if (atomic_fetch_add(&cells->pairs, pairs) + pairs > GZ_PARTICLE_PAIRS_MAX) {
			atomic_store(&cells->result, GZ_ERR_FULL);
			return;
		}
		weigh_run(cells, run, near);
	}
	atomic_fetch_add(&cells->parts_done, 1);
}

enum gz_result gz_particle_weights_find(struct gz_particle_cells *cells, struct gz_workers *workers)
{
	struct weight_job *job = calloc(1, sizeof *job);
	if (!job)
		return GZ_ERR_NO_MEM;
	job->cells = cells;
	job->runs = malloc(cells->tree.node_count * sizeof *job->runs);
	cells->weights = malloc(cells->tree.count * sizeof *cells->weights);
	enum gz_result result = job->runs && cells->weights ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		list_runs(job, 0);
		cells->parts = (job->run_count + BATCH - 1) / BATCH;
		atomic_store(&cells->parts_done, 0);
		gz_workers_run(workers, weigh_batch, job, cells->parts);
		result = (enum gz_result)atomic_load(&cells->result);
	}
	for (int i = 0; i < GZ_WORKERS_MAX; i++)
		for (int axis = 0; axis < 3; axis++)
			free(job->near[i].at[axis]);
	free(job->runs);
	free(job);
	return result;
}
