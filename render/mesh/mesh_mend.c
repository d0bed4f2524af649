#include "render/mesh/mesh_mend.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/vector.h"

/* How far from 1 the length of a normal may be. Chosen: half floats and bytes round less. */
#define LENGTH_SLACK 1e-3

/* Most triangles, whose corners are numbered in 32 bits. */
#define TRIANGLES_MAX (UINT32_MAX / 3 - 1)

/* No neighbour over an edge. */
#define ALONE UINT32_MAX

/* One edge of a triangle, in the list of its lower vertex. */
struct half_edge {
	uint32_t higher; /* the edge's other vertex */
	uint32_t corner; /* 3 * triangle + the corner where the edge begins */
};

/* All there is to turn. */
struct turning {
	struct gz_mesh *mesh;
	size_t *first;           /* of each vertex, in edges; one more at the end */
	struct half_edge *edges; /* three a triangle, by the lower of their vertices */
	uint32_t *beside;        /* of each edge of a triangle: the corner where the neighbour's
				    begins, or ALONE */
	uint32_t *order;         /* triangles, in the order in which they are reached */
	unsigned char *seen;     /* of each triangle: enum reached */
};

enum reached { UNSEEN, KEPT, TURNED };

static uint32_t corner_after(uint32_t corner)
{
	return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static uint32_t vertex_at(const struct gz_mesh *mesh, uint32_t corner)
{
	return mesh->triangles[corner / 3][corner % 3];
}

static void list_half_edges(struct turning *turning)
{
	const struct gz_mesh *mesh = turning->mesh;
	const uint32_t corners = (uint32_t)(3 * mesh->triangle_count);
	for (uint32_t c = 0; c < corners; c++) {
		const uint32_t a = vertex_at(mesh, c), b = vertex_at(mesh, corner_after(c));
		turning->first[(a < b ? a : b) + 1]++;
	}
	for (size_t v = 0; v < mesh->vertex_count; v++)
		turning->first[v + 1] += turning->first[v];
	/* From here on first[v] is where the next edge of v goes, and later where its list ends. */
	for (uint32_t c = 0; c < corners; c++) {
		const uint32_t a = vertex_at(mesh, c), b = vertex_at(mesh, corner_after(c));
		turning->edges[turning->first[a < b ? a : b]++] =
			(struct half_edge) { .higher = a < b ? b : a, .corner = c };
	}
}

static int compare_half_edges(const void *a, const void *b)
{
	const struct half_edge *x = a, *y = b;
	if (x->higher != y->higher)
		return x->higher < y->higher ? -1 : 1;
	return x->corner < y->corner ? -1 : x->corner > y->corner;
}

/* Join the two triangles of each edge that has exactly two. */
static void join_neighbours(struct turning *turning)
{
	size_t begin = 0;
	for (size_t v = 0; v < turning->mesh->vertex_count; v++) {
		const size_t end = turning->first[v];
		struct half_edge *edges = turning->edges;
		qsort(edges + begin, end - begin, sizeof *edges, compare_half_edges);
		for (size_t i = begin, next; i < end; i = next) {
			for (next = i + 1; next < end && edges[next].higher == edges[i].higher;)
				next++;
			for (size_t k = i; k < next; k++)
				turning->beside[edges[k].corner] =
					next - i == 2 ? edges[2 * i + 1 - k].corner : ALONE;
		}
		begin = end;
	}
}

/* Whether both triangles of an edge run along it in the same direction, so that one of them faces
 * the wrong side. */
static bool runs_alike(const struct gz_mesh *mesh, uint32_t corner, uint32_t other)
{
	return vertex_at(mesh, corner) == vertex_at(mesh, other);
}

/* Reach all triangles that are connected with one. Returns how many. */
static size_t reach_part(const struct turning *turning, uint32_t start, uint32_t *order)
{
	size_t count = 1;
	order[0] = start;
	turning->seen[start] = KEPT;
	for (size_t done = 0; done < count; done++) {
		const uint32_t triangle = order[done];
		for (uint32_t c = 3 * triangle; c < 3 * triangle + 3; c++) {
			const uint32_t other = turning->beside[c];
			if (other == ALONE || turning->seen[other / 3] != UNSEEN)
				continue;
			const bool turned = (turning->seen[triangle] == TURNED) !=
					    runs_alike(turning->mesh, c, other);
			turning->seen[other / 3] = turned ? TURNED : KEPT;
			order[count++] = other / 3;
		}
	}
	return count;
}

/* The normal of a triangle with the length of twice its area. */
static void area_normal(const struct gz_mesh *mesh, size_t triangle, double out_normal[3])
{
	const uint32_t *corners = mesh->triangles[triangle];
	double edges[2][3];
	for (int i = 0; i < 2; i++)
		for (int axis = 0; axis < 3; axis++)
			edges[i][axis] = (double)mesh->positions[corners[i + 1]][axis] -
					 (double)mesh->positions[corners[0]][axis];
	gz_cross3(edges[0], edges[1], out_normal);
}

/* How much of a part faces the side of its normals, and how much its own outside: above 0 is right,
 * below 0 wrong. */
static double part_vote(const struct turning *turning, const uint32_t *order, size_t count)
{
	const struct gz_mesh *mesh = turning->mesh;
	const float *centre = mesh->positions[mesh->triangles[order[0]][0]];
	double agree = 0, volume = 0;
	for (size_t i = 0; i < count; i++) {
		const uint32_t *corners = mesh->triangles[order[i]];
		const double side = turning->seen[order[i]] == TURNED ? -1 : 1;
		double normal[3], mean = 0;
		area_normal(mesh, order[i], normal);
		for (int axis = 0; axis < 3; axis++) {
			for (int k = 0; k < 3; k++) {
				const double part = (double)mesh->normals[corners[k]][axis];
				mean += isfinite(part) ? normal[axis] * part : 0;
			}
			volume +=
				side * normal[axis] *
				((double)mesh->positions[corners[0]][axis] - (double)centre[axis]);
		}
		agree += mean == 0 ? 0 : side * copysign(gz_length3(normal), mean);
	}
	return agree != 0 ? agree : volume;
}

static void turn_triangles(const struct turning *turning, struct gz_mesh_mending *mending)
{
	struct gz_mesh *mesh = turning->mesh;
	for (uint32_t start = 0; start < mesh->triangle_count; start++) {
		if (turning->seen[start] != UNSEEN)
			continue;
		const size_t count = reach_part(turning, start, turning->order);
		const enum reached wrong =
			part_vote(turning, turning->order, count) < 0 ? KEPT : TURNED;
		for (size_t i = 0; i < count; i++) {
			uint32_t *corners = mesh->triangles[turning->order[i]];
			if (turning->seen[turning->order[i]] != wrong)
				continue;
			const uint32_t swap = corners[1];
			corners[1] = corners[2];
			corners[2] = swap;
			mending->turned_triangles++;
		}
	}
}

static bool normal_is_right(const float normal[3], const double mean[3])
{
	double length2 = 0, along = 0;
	for (int axis = 0; axis < 3; axis++) {
		length2 += (double)normal[axis] * (double)normal[axis];
		along += (double)normal[axis] * mean[axis];
	}
	return fabs(length2 - 1) < 2 * LENGTH_SLACK && along >= 0; /* false for NaN */
}

static void mend_normals(struct gz_mesh *mesh, double (*means)[3], struct gz_mesh_mending *mending)
{
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		double normal[3];
		area_normal(mesh, t, normal);
		mending->flat_triangles += !(gz_length3(normal) > 0);
		for (int k = 0; k < 3; k++)
			for (int axis = 0; axis < 3; axis++)
				means[mesh->triangles[t][k]][axis] += normal[axis];
	}
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		if (normal_is_right(mesh->normals[v], means[v]))
			continue;
		if (!gz_normalise3(means[v])) {
			means[v][0] = means[v][1] = 0;
			means[v][2] = 1;
		}
		for (int axis = 0; axis < 3; axis++)
			mesh->normals[v][axis] = (float)means[v][axis];
		mending->new_normals++;
	}
}

static void free_turning(struct turning *turning)
{
	free(turning->first);
	free(turning->edges);
	free(turning->beside);
	free(turning->order);
	free(turning->seen);
}

static bool allocate_turning(struct turning *turning)
{
	const size_t vertices = turning->mesh->vertex_count + 1;
	const size_t triangles = turning->mesh->triangle_count + 1;
	turning->first = calloc(vertices, sizeof *turning->first);
	turning->edges = calloc(3 * triangles, sizeof *turning->edges);
	turning->beside = calloc(3 * triangles, sizeof *turning->beside);
	turning->order = calloc(triangles, sizeof *turning->order);
	turning->seen = calloc(triangles, 1);
	return turning->first && turning->edges && turning->beside && turning->order &&
	       turning->seen;
}

enum gz_result gz_mesh_mend(struct gz_mesh *mesh, struct gz_mesh_mending *out_mending)
{
	struct gz_mesh_mending mending = { 0 };
	struct turning turning = { .mesh = mesh };
	if (mesh->triangle_count > TRIANGLES_MAX)
		return GZ_ERR_FULL;
	double(*means)[3] = calloc(mesh->vertex_count + 1, sizeof *means);
	const bool room = means && allocate_turning(&turning);
	if (room) {
		list_half_edges(&turning);
		join_neighbours(&turning);
		turn_triangles(&turning, &mending);
		mend_normals(mesh, means, &mending);
		if (out_mending)
			*out_mending = mending;
	}
	free(means);
	free_turning(&turning);
	return room ? GZ_OK : GZ_ERR_NO_MEM;
}
