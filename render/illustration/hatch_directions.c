/*
 * Directions as tensors, so that a direction and its opposite are one, and those that contradict
 * each other cancel out: of a direction u across the normal n, u u^T less half of what every
 * direction has, which is the projection across n.
 *
 * Tensors spread over the edges of the mesh. Where they agree with those around them, they stay. On
 * noisy places, where most cancel out, the directions come from a coarser graph, whose vertices are
 * all those of a cube of a few edges, and which spreads them farther: the noisier, the more.
 */
#include "render/illustration/hatch_strokes.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
	PASSES_MAX = 1000,
	TENSOR = 6,      /* xx, yy, zz, xy, xz, yz */
	FIELD_FLOATS = 8 /* and the weights that are in it; the last is 0, for whole SIMD words */
};

/* Edge of the coarse graph's cubes, in mean edges. Chosen: it costs about as much as the mesh. */
#define CUBE_EDGES 4.0

/* How much of the weights of a place must agree for its own directions to count nothing, and to
 * count alone. Chosen by eye. */
#define AGREE_NONE 0.25F
#define AGREE_ALL  0.6F

static float dot_of(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross_of(const float a[3], const float b[3], float out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

void gz_hatch_cross_directions(const struct gz_mesh *mesh, const float (*directions)[3],
			       float (*out_directions)[3])
{
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		float across[3];
		cross_of(mesh->normals[i], directions[i], across);
		memcpy(out_directions[i], across, sizeof across);
	}
}

/* A graph over which tensors spread. */
struct tensor_graph {
	size_t count, triangle_count;
	const uint32_t (*triangles)[3]; /* two corners may be one vertex */
	float (*now)[FIELD_FLOATS], (*next)[FIELD_FLOATS];
};

static bool allocate_fields(size_t count, struct tensor_graph *graph)
{
	graph->count = count;
	graph->now = calloc(count, sizeof *graph->now);
	graph->next = calloc(count, sizeof *graph->next);
	return graph->now && graph->next;
}

static void free_fields(struct tensor_graph *graph)
{
	free(graph->now);
	free(graph->next);
}

/* The direction of the least curvature, as a tensor whose weight is how much the curvatures differ:
 * 0 on a ball, 1 on a tube. @param flat  what is bent less has less weight, 1/mm */
static void start_tensor(const struct gz_curvature *curvature, const float normal[3], float flat,
			 float out[FIELD_FLOATS])
{
	const float sum = fabsf(curvature->greatest) + fabsf(curvature->least) + flat;
	const float weight = sum > 0 ? (curvature->greatest - curvature->least) / sum : 0;
	float u[3];
	cross_of(normal, curvature->along, u);
	const bool good = isfinite(weight * (u[0] + u[1] + u[2]));
	for (int axis = 0; axis < 3 && good; axis++) {
		const int a = axis == 2, b = axis == 0 ? 1 : 2; /* xy, xz, yz */
		out[axis] = weight * (u[axis] * u[axis] - 0.5F * (1 - normal[axis] * normal[axis]));
		out[3 + axis] = weight * (u[a] * u[b] + 0.5F * normal[a] * normal[b]);
	}
	out[TENSOR] = good ? weight : 0;
}

/* The mean bend of all vertices, of which noise has most. */
static float mean_bend(const struct gz_curvature *curvatures, size_t count)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++) {
		const float bend = fabsf(curvatures[i].greatest) + fabsf(curvatures[i].least);
		sum += isfinite(bend) ? (double)bend : 0;
	}
	return count > 0 ? (float)(sum / (double)count) : 0;
}

/* One step: each vertex gets a quarter of each neighbour's, once for each triangle. */
static void spread_tensors(struct tensor_graph *graph)
{
	memcpy(graph->next, graph->now, graph->count * sizeof *graph->next);
	for (size_t i = 0; i < graph->triangle_count; i++) {
		const uint32_t *corners = graph->triangles[i];
		const float *a = graph->now[corners[0]], *b = graph->now[corners[1]];
		const float *c = graph->now[corners[2]];
		for (int k = 0; k < FIELD_FLOATS; k++) {
			const float sum = 0.25F * (a[k] + b[k] + c[k]);
			graph->next[corners[0]][k] += sum - 0.25F * a[k];
			graph->next[corners[1]][k] += sum - 0.25F * b[k];
			graph->next[corners[2]][k] += sum - 0.25F * c[k];
		}
	}
	float(*swap)[FIELD_FLOATS] = graph->now;
	graph->now = graph->next;
	graph->next = swap;
}

/* Bring all to about one size, so that many steps neither overflow nor vanish. */
static void rescale_tensors(struct tensor_graph *graph)
{
	for (size_t i = 0; i < graph->count; i++) {
		const float weight = graph->now[i][TENSOR];
		/* strong places stay a little stronger, so that they win over noisy ones */
		const float scale = weight > 1 ? 1 / weight : 1;
		for (int k = 0; k < FIELD_FLOATS; k++)
			graph->now[i][k] *= scale;
	}
}

static void spread_far(struct tensor_graph *graph, int passes, const atomic_bool *stop)
{
	for (int pass = 0; pass < passes && !gz_stop_wanted(stop); pass++) {
		spread_tensors(graph);
		rescale_tensors(graph);
	}
}

/* A vertex and the cube it is in. */
struct cube_vertex {
	uint64_t cube;
	uint32_t vertex;
};

static int by_cube(const void *a, const void *b)
{
	const struct cube_vertex *x = a, *y = b;
	if (x->cube != y->cube)
		return x->cube < y->cube ? -1 : 1;
	return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static double mean_edge(const struct gz_mesh *mesh)
{
	double sum = 0;
	for (size_t i = 0; i < mesh->triangle_count; i++) {
		const float *a = mesh->positions[mesh->triangles[i][0]];
		const float *b = mesh->positions[mesh->triangles[i][1]];
		float way[3];
		for (int axis = 0; axis < 3; axis++)
			way[axis] = b[axis] - a[axis];
		sum += sqrt((double)dot_of(way, way));
	}
	return mesh->triangle_count > 0 ? sum / (double)mesh->triangle_count : 0;
}

/* The cube of a vertex, apart for the six sides that it can face. */
static uint64_t cube_of(const struct gz_mesh *mesh, size_t vertex, double edge)
{
	const float *normal = mesh->normals[vertex];
	uint64_t cube = 0;
	int facing = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double place = /* and no overflow, whatever the mesh */
			fmin(fmax(floor((double)mesh->positions[vertex][axis] / edge), -0x1p40),
			     0x1p40);
		cube = cube << 20 | ((uint64_t)(int64_t)place & 0xFFFFF);
		facing = fabsf(normal[axis]) > fabsf(normal[facing]) ? axis : facing;
	}
	return cube << 3 | (uint64_t)(2 * facing + (normal[facing] < 0));
}

/* Number the cubes of all vertices. Returns how many there are; 0 if out of memory. */
static size_t number_cubes(const struct gz_mesh *mesh, uint32_t *out_cubes)
{
	struct cube_vertex *list = malloc(mesh->vertex_count * sizeof *list);
	const double edge = CUBE_EDGES * mean_edge(mesh);
	size_t cubes = 0;
	if (!list)
		return 0;
	for (size_t i = 0; i < mesh->vertex_count; i++)
		list[i] =
			(struct cube_vertex) { edge > 0 ? cube_of(mesh, i, edge) : i, (uint32_t)i };
	qsort(list, mesh->vertex_count, sizeof *list, by_cube);
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		cubes += i == 0 || list[i].cube != list[i - 1].cube;
		out_cubes[list[i].vertex] = (uint32_t)(cubes - 1);
	}
	free(list);
	return cubes;
}

/* The triangles of the coarse graph: those that are not within one cube. Returns how many. */
static size_t list_coarse_triangles(const struct gz_mesh *mesh, const uint32_t *cubes,
				    uint32_t (*out_triangles)[3])
{
	size_t count = 0;
	for (size_t i = 0; i < mesh->triangle_count; i++) {
		for (int corner = 0; corner < 3; corner++)
			out_triangles[count][corner] = cubes[mesh->triangles[i][corner]];
		const uint32_t *made = out_triangles[count];
		count += made[0] != made[1] || made[0] != made[2];
	}
	return count;
}

/* The weight of what agrees in a tensor across a normal, and its direction; 0 without a normal. */
static float find_direction(const float tensor[FIELD_FLOATS], const float normal[3], float out[3])
{
	const int least = fabsf(normal[0]) < fabsf(normal[1])
				  ? (fabsf(normal[0]) < fabsf(normal[2]) ? 0 : 2)
				  : (fabsf(normal[1]) < fabsf(normal[2]) ? 1 : 2);
	float axis[3] = { 0 }, right[3], up[3], times[2][3];
	axis[least] = 1;
	cross_of(normal, axis, right);
	const float length = sqrtf(dot_of(right, right));
	memset(out, 0, 3 * sizeof *out);
	if (!(length > 0)) /* no normal */
		return 0;
	for (int i = 0; i < 3; i++)
		right[i] /= length;
	cross_of(normal, right, up);
	for (int k = 0; k < 2; k++) {
		const float *v = k == 0 ? right : up;
		times[k][0] = tensor[0] * v[0] + tensor[3] * v[1] + tensor[4] * v[2];
		times[k][1] = tensor[3] * v[0] + tensor[1] * v[1] + tensor[5] * v[2];
		times[k][2] = tensor[4] * v[0] + tensor[5] * v[1] + tensor[2] * v[2];
	}
	const float differ = dot_of(right, times[0]) - dot_of(up, times[1]);
	const float mixed = 2 * dot_of(right, times[1]);
	const float angle = 0.5F * atan2f(mixed, differ);
	for (int i = 0; i < 3; i++)
		out[i] = cosf(angle) * right[i] + sinf(angle) * up[i];
	return sqrtf(differ * differ + mixed * mixed);
}

/* The direction of a vertex: its own, that of its cube, or a mean by how much its own agree. */
static void choose_direction(const float own[FIELD_FLOATS], const float cube[FIELD_FLOATS],
			     const float normal[3], float out[3])
{
	float unused[3], mixed[FIELD_FLOATS];
	const float agreed = find_direction(own, normal, out);
	const float coarse = find_direction(cube, normal, unused);
	const float share = own[TENSOR] > 0 ? agreed / own[TENSOR] : 0;
	const float within = fminf(fmaxf((share - AGREE_NONE) / (AGREE_ALL - AGREE_NONE), 0), 1);
	if (coarse > 0) {
		const float own_scale = agreed > 0 ? within / agreed : 0;
		for (int k = 0; k < FIELD_FLOATS; k++)
			mixed[k] = own_scale * own[k] + (1 - within) / coarse * cube[k];
		if (find_direction(mixed, normal, out) > 0)
			return;
	}
	for (int axis = 0; axis < 3 && !(agreed > 0); axis++)
		out[axis] = 0;
}

/* Spread over the mesh, and over the cubes from where the mesh left off. */
static void spread_both(struct tensor_graph *mesh_graph, struct tensor_graph *cube_graph,
			const uint32_t *cubes, int passes, const atomic_bool *stop)
{
	spread_far(mesh_graph, passes, stop);
	for (size_t i = 0; i < mesh_graph->count; i++)
		for (int k = 0; k < FIELD_FLOATS; k++)
			cube_graph->now[cubes[i]][k] += mesh_graph->now[i][k];
	rescale_tensors(cube_graph);
	spread_far(cube_graph, passes, stop);
}

enum gz_result gz_hatch_directions(const struct gz_mesh *mesh,
				   const struct gz_curvature *curvatures, int passes,
				   const atomic_bool *stop, float (*out_directions)[3])
{
	if (passes < 0 || passes > PASSES_MAX)
		return GZ_ERR_INVAL;
	if (mesh->vertex_count == 0)
		return GZ_OK;
	struct tensor_graph own = { .triangle_count = mesh->triangle_count,
				    .triangles = (const uint32_t(*)[3])mesh->triangles };
	struct tensor_graph coarse = { 0 };
	uint32_t *cubes = malloc(mesh->vertex_count * sizeof *cubes);
	uint32_t(*triangles)[3] = calloc(mesh->triangle_count + 1, sizeof *triangles);
	const size_t cube_count = cubes ? number_cubes(mesh, cubes) : 0;
	const bool complete = cube_count > 0 && triangles &&
			      allocate_fields(mesh->vertex_count, &own) &&
			      allocate_fields(cube_count, &coarse);
	if (complete) {
		const float flat = mean_bend(curvatures, mesh->vertex_count);
		coarse.triangle_count = list_coarse_triangles(mesh, cubes, triangles);
		coarse.triangles = (const uint32_t(*)[3])triangles;
		for (size_t i = 0; i < own.count; i++)
			start_tensor(&curvatures[i], mesh->normals[i], flat, own.now[i]);
		spread_both(&own, &coarse, cubes, passes, stop);
		for (size_t i = 0; i < own.count && !gz_stop_wanted(stop); i++)
			choose_direction(own.now[i], coarse.now[cubes[i]], mesh->normals[i],
					 out_directions[i]);
	}
	free_fields(&own);
	free_fields(&coarse);
	free(cubes);
	free(triangles);
	if (!complete)
		return GZ_ERR_NO_MEM;
	return gz_stop_wanted(stop) ? GZ_ERR_CANCELLED : GZ_OK;
}
