#include "render/mesh/mesh_smooth.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/portable.h"
#include "base/vector.h"

/* Vertices of a part of the work. Chosen: a part takes some 50 us. */
enum { SMOOTH_PART = 4096 };

/* A normal with a fourth number, for loads of 16 bytes. */
struct wide_normal {
	float parts[4];
};

/* Who lies beside each vertex, and how much each counts. */
struct vertex_links {
	size_t *first;     /* of each vertex, in the arrays below; one more at the end */
	uint32_t *to;      /* neighbours in rising order, each once */
	float *weights;    /* of them */
	float *own_weight; /* of each vertex */
};

/* One step of smoothing. */
struct smoothing_step {
	const struct vertex_links *links;
	size_t vertex_count;
	const struct wide_normal *from;
	struct wide_normal *to;
};

static void free_links(struct vertex_links *links)
{
	free(links->first);
	free(links->to);
	free(links->weights);
	free(links->own_weight);
}

static bool allocate_links(const struct gz_mesh *mesh, struct vertex_links *links)
{
	const size_t ends = 6 * mesh->triangle_count + 1;
	links->first = calloc(mesh->vertex_count + 1, sizeof *links->first);
	links->to = calloc(ends, sizeof *links->to);
	links->weights = calloc(ends, sizeof *links->weights);
	links->own_weight = calloc(mesh->vertex_count + 1, sizeof *links->own_weight);
	return links->first && links->to && links->weights && links->own_weight;
}

/* List both other corners of each triangle at each corner; neighbours come twice. Afterwards
 * first[v] is where the list of v ends; the next one begins there. */
static void list_neighbours(const struct gz_mesh *mesh, struct vertex_links *links)
{
	size_t sum = 0;
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++)
			links->first[mesh->triangles[t][k]] += 2;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const size_t count = links->first[v];
		links->first[v] = sum;
		sum += count;
	}
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t *corners = mesh->triangles[t];
			size_t *next = &links->first[corners[k]];
			links->to[(*next)++] = corners[(k + 1) % 3];
			links->to[(*next)++] = corners[(k + 2) % 3];
		}
}

/* Sort the few neighbours of a vertex, and leave each once, without the vertex itself. Returns how
 * many are left. */
static size_t sort_neighbours(uint32_t *to, size_t count, size_t self)
{
	size_t left = 0;
	for (size_t i = 0; i < count; i++) {
		const uint32_t vertex = to[i];
		size_t at = left;
		while (at > 0 && to[at - 1] > vertex)
			at--;
		if (vertex == self || (at > 0 && to[at - 1] == vertex))
			continue;
		memmove(to + at + 1, to + at, (left - at) * sizeof *to);
		to[at] = vertex;
		left++;
	}
	return left;
}

static void keep_each_once(const struct gz_mesh *mesh, struct vertex_links *links)
{
	size_t kept = 0, begin = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const size_t end = links->first[v];
		const size_t left = sort_neighbours(links->to + begin, end - begin, v);
		memmove(links->to + kept, links->to + begin, left * sizeof *links->to);
		links->first[v] = kept;
		kept += left;
		begin = end;
	}
	links->first[mesh->vertex_count] = kept;
}

static double squared_distance(const struct gz_mesh *mesh, size_t a, size_t b)
{
	double edge[3];
	for (int axis = 0; axis < 3; axis++)
		edge[axis] = (double)mesh->positions[a][axis] - (double)mesh->positions[b][axis];
	return gz_dot3(edge, edge);
}

/* A third of the area of each triangle goes to each corner. */
static void share_areas(const struct gz_mesh *mesh, struct vertex_links *links)
{
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *corners = mesh->triangles[t];
		double edges[2][3], normal[3];
		for (int i = 0; i < 2; i++)
			for (int axis = 0; axis < 3; axis++)
				edges[i][axis] = (double)mesh->positions[corners[i + 1]][axis] -
						 (double)mesh->positions[corners[0]][axis];
		gz_cross3(edges[0], edges[1], normal);
		const double area = gz_length3(normal) / 2;
		for (int k = 0; k < 3; k++)
			links->own_weight[corners[k]] += (float)(area / 3);
	}
}

static double mean_squared_edge(const struct gz_mesh *mesh, const struct vertex_links *links)
{
	double sum = 0;
	size_t count = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (size_t i = links->first[v]; i < links->first[v + 1]; i++, count++)
			sum += squared_distance(mesh, v, links->to[i]);
	return count > 0 ? sum / (double)count : 0;
}

static void weigh_links(const struct gz_mesh *mesh, struct vertex_links *links)
{
	const double variance = mean_squared_edge(mesh, links);
	for (size_t v = 0; v < mesh->vertex_count; v++)
		for (size_t i = links->first[v]; i < links->first[v + 1]; i++) {
			const double far2 = squared_distance(mesh, v, links->to[i]);
			const double power = variance > 0 ? -far2 / (2 * variance) : 0;
			links->weights[i] = links->own_weight[links->to[i]] *
					    (float)gz_portable_exp(fmax(power, -700));
		}
}

static void smooth_vertex(const struct smoothing_step *step, size_t v)
{
	const struct vertex_links *links = step->links;
	float sum[4];
	for (int k = 0; k < 4; k++)
		sum[k] = links->own_weight[v] * step->from[v].parts[k];
	for (size_t i = links->first[v]; i < links->first[v + 1]; i++)
		for (int k = 0; k < 4; k++)
			sum[k] += links->weights[i] * step->from[links->to[i]].parts[k];
	const float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	step->to[v] = step->from[v];
	for (int k = 0; length > 0 && isfinite(length) && k < 4; k++)
		step->to[v].parts[k] = sum[k] / length;
}

static void smooth_part(void *user, size_t part, int worker)
{
	const struct smoothing_step *step = user;
	const size_t begin = part * SMOOTH_PART, rest = step->vertex_count - begin;
	(void)worker;
	for (size_t v = begin; v < begin + (rest < SMOOTH_PART ? rest : SMOOTH_PART); v++)
		smooth_vertex(step, v);
}

static void run_step(struct smoothing_step *step, struct gz_workers *workers)
{
	const size_t parts = (step->vertex_count + SMOOTH_PART - 1) / SMOOTH_PART;
	if (workers)
		gz_workers_run(workers, smooth_part, step, parts);
	for (size_t part = 0; !workers && part < parts; part++)
		smooth_part(step, part, 0);
}

static void smooth_levels(const struct gz_mesh *mesh, int levels, struct smoothing_step *step,
			  struct wide_normal *both[2], struct gz_workers *workers,
			  float (*out_normals)[3])
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		memcpy(both[0][v].parts, mesh->normals[v], sizeof mesh->normals[v]);
	int now = 0;
	for (int level = 0; level < levels; level++) {
		for (int i = 0; i < 1 << level; i++, now = !now) {
			step->from = both[now];
			step->to = both[!now];
			run_step(step, workers);
		}
		float(*normals)[3] = out_normals + (size_t)level * mesh->vertex_count;
		for (size_t v = 0; v < mesh->vertex_count; v++)
			memcpy(normals[v], both[now][v].parts, sizeof normals[v]);
	}
}

/* Lengths relative to the mesh, so that weights neither overflow nor vanish. */
static void scale_weights(const struct gz_mesh *mesh, struct vertex_links *links)
{
	float most = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		most = fmaxf(most, links->own_weight[v]);
	for (size_t v = 0; most > 0 && v < mesh->vertex_count; v++)
		links->own_weight[v] /= most;
}

enum gz_result gz_mesh_smooth_normals(const struct gz_mesh *mesh, int levels,
				      struct gz_workers *workers, float (*out_normals)[3])
{
	struct vertex_links links = { 0 };
	struct smoothing_step step = { .links = &links, .vertex_count = mesh->vertex_count };
	struct wide_normal *both[2] = { NULL, NULL };
	if (levels < 1 || levels > GZ_MESH_SMOOTH_LEVELS_MAX)
		return GZ_ERR_INVAL;
	const bool room = allocate_links(mesh, &links);
	for (int i = 0; i < 2; i++)
		both[i] = calloc(mesh->vertex_count + 1, sizeof *both[i]);
	const enum gz_result result = room && both[0] && both[1] ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		list_neighbours(mesh, &links);
		keep_each_once(mesh, &links);
		share_areas(mesh, &links);
		scale_weights(mesh, &links);
		weigh_links(mesh, &links);
		smooth_levels(mesh, levels, &step, both, workers, out_normals);
	}
	for (int i = 0; i < 2; i++)
		free(both[i]);
	free_links(&links);
	return result;
}
