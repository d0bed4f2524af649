#include "render/mesh/mesh_measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void cross_product(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void add_sizes(const struct gz_mesh *mesh, struct gz_mesh_measures *measures)
{
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		const float *corner[3];
		double side[2][3], across[3], square = 0;
		for (int c = 0; c < 3; c++)
			corner[c] = mesh->positions[mesh->triangles[t][c]];
		for (int axis = 0; axis < 3; axis++) {
			side[0][axis] = (double)corner[1][axis] - (double)corner[0][axis];
			side[1][axis] = (double)corner[2][axis] - (double)corner[0][axis];
		}
		cross_product(side[0], side[1], across);
		for (int axis = 0; axis < 3; axis++) {
			square += across[axis] * across[axis];
			/* of the tetrahedron with the origin */
			measures->volume += across[axis] * (double)corner[0][axis] / 6;
		}
		measures->area += sqrt(square) / 2;
	}
}

/* The edges of a mesh, by the lower number of their vertices. */
struct edge_lists {
	size_t *end; /* of each vertex: where its list ends; the list before it ends where it begins
		      */
	uint32_t *end_vertex; /* twice the higher number, and 1 if the triangle runs towards it */
};

static void list_edges(const struct gz_mesh *mesh, struct edge_lists *lists)
{
	size_t *end = lists->end;
	for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
		const uint32_t *corners = mesh->triangles[i / 3];
		const uint32_t from = corners[i % 3], to = corners[(i + 1) % 3];
		end[from < to ? from : to]++;
	}
	size_t sum = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const size_t count = end[v];
		end[v] = sum; /* while lists are filled, where the next entry goes */
		sum += count;
	}
	for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
		const uint32_t *corners = mesh->triangles[i / 3];
		const uint32_t from = corners[i % 3], to = corners[(i + 1) % 3];
		const uint32_t low = from < to ? from : to, high = from < to ? to : from;
		lists->end_vertex[end[low]++] = 2 * high + (from < to);
	}
}

static int compare_numbers(const void *a, const void *b)
{
	const uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
	return left < right ? -1 : left > right;
}

/* Lists of edges are short, but a fan of triangles may have a long one. */
static void sort_list(uint32_t *list, size_t count)
{
	enum { SHORT = 32 };
	if (count > SHORT) {
		qsort(list, count, sizeof *list, compare_numbers);
		return;
	}
	for (size_t i = 1; i < count; i++) {
		const uint32_t moved = list[i];
		size_t at = i;
		for (; at > 0 && list[at - 1] > moved; at--)
			list[at] = list[at - 1];
		list[at] = moved;
	}
}

static void count_list(uint32_t *list, size_t count, struct gz_mesh_measures *measures)
{
	sort_list(list, count);
	for (size_t first = 0, next; first < count; first = next) {
		size_t forward = 0;
		for (next = first; next < count && list[next] / 2 == list[first] / 2; next++)
			forward += list[next] & 1;
		const size_t triangles = next - first;
		measures->edges++;
		measures->border_edges += triangles == 1;
		measures->crowded_edges += triangles > 2;
		measures->turned_edges += triangles == 2 && forward != 1;
	}
}

static void count_edges(const struct gz_mesh *mesh, struct edge_lists *lists,
			struct gz_mesh_measures *measures)
{
	list_edges(mesh, lists);
	size_t begin = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		count_list(lists->end_vertex + begin, lists->end[v] - begin, measures);
		begin = lists->end[v];
	}
}

/* Counts the vertices that triangles use, and marks them in used[]. */
static size_t count_used(const struct gz_mesh *mesh, size_t *used)
{
	size_t count = 0;
	memset(used, 0, mesh->vertex_count * sizeof *used);
	for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
		size_t *mark = &used[mesh->triangles[i / 3][i % 3]];
		count += *mark == 0;
		*mark = 1;
	}
	return count;
}

enum gz_result gz_mesh_measure(const struct gz_mesh *mesh, struct gz_mesh_measures *out_measures)
{
	struct gz_mesh_measures measures = { 0 };
	if (mesh->triangle_count == 0) {
		*out_measures = measures;
		return GZ_OK;
	}
	struct edge_lists lists = {
		.end = calloc(mesh->vertex_count, sizeof *lists.end),
		.end_vertex = calloc(3 * mesh->triangle_count, sizeof *lists.end_vertex),
	};
	const bool complete = lists.end && lists.end_vertex;
	if (complete) {
		add_sizes(mesh, &measures);
		count_edges(mesh, &lists, &measures);
		measures.euler = (int64_t)count_used(mesh, lists.end) - (int64_t)measures.edges +
				 (int64_t)mesh->triangle_count;
		*out_measures = measures;
	}
	free(lists.end);
	free(lists.end_vertex);
	return complete ? GZ_OK : GZ_ERR_NO_MEM;
}

bool gz_mesh_closed(const struct gz_mesh_measures *measures)
{
	return measures->border_edges + measures->crowded_edges + measures->turned_edges == 0;
}
