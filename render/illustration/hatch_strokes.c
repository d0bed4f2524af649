#include "render/illustration/hatch_strokes.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "render/mesh/point_grid.h"

enum {
	NO_NEIGHBOUR = -1,
	STEPS_MAX = 100000,   /* triangles that a stroke crosses */
	NODES_A_DISTANCE = 2, /* chosen: strokes look round, and gaps between nodes are small */
	SHORTEST_DISTANCES = 2,
};

/* Longest strokes, in distances: from half of it to one and a half, by chance, so that ends do not
 * line up. Chosen by eye: longer ones look like wire, shorter ones like fur. */
#define LONGEST_DISTANCES 24.0

/* How far along a stroke its corners may be near each other, in distances: its own bend. */
#define OWN_DISTANCES 4.0

#define DISTANCE_STEP 0.70710678118654752

/* A corner while strokes are traced. */
struct traced_node {
	struct gz_hatch_node node;
	uint32_t stroke;
	int32_t order; /* within the stroke: 0 where it starts, below 0 on the way back */
	int32_t next;  /* in its list */
};

struct tracing {
	const struct gz_mesh *mesh;
	const float (*directions)[3];
	int32_t *neighbours; /* of each edge of each triangle: the triangle beyond it */
	float (*normals)[3]; /* of triangles */
	struct traced_node *nodes;
	size_t node_count, node_capacity;
	struct gz_hatch_stroke *strokes;
	size_t stroke_count, stroke_capacity;
	struct gz_point_grid grid;
	const atomic_bool *stop; /* NULL: nothing ends it */
	double distance;
	double step;   /* between the nodes of a stroke, mm: the last distance */
	int stride;    /* every so many nodes of a stroke keep others away, for less work */
	double length; /* of all strokes */
};

/* Where a stroke is: in a triangle, by the shares of its corners. */
struct tracer {
	uint32_t triangle;
	int entered; /* the corner opposite to the edge that it came in by, or -1 */
	double shares[3];
	double place[3], way[3]; /* mm; unit vector */
	bool ended;              /* at a border, or where directions turn back */
};

struct mesh_edge {
	uint32_t high, side; /* the higher vertex, and triangle * 3 + edge */
};

static int compare_edges(const void *left, const void *right)
{
	const struct mesh_edge *a = left, *b = right;
	if (a->high != b->high)
		return a->high < b->high ? -1 : 1;
	return a->side < b->side ? -1 : a->side > b->side;
}

/* Joins the triangles of one vertex's edges where exactly two share one. */
static void join_edges(struct mesh_edge *edges, size_t count, int32_t *neighbours)
{
	qsort(edges, count, sizeof *edges, compare_edges);
	for (size_t first = 0, next; first < count; first = next) {
		for (next = first + 1; next < count; next++)
			if (edges[next].high != edges[first].high)
				break;
		if (next - first != 2)
			continue;
		neighbours[edges[first].side] = (int32_t)(edges[first + 1].side / 3);
		neighbours[edges[first + 1].side] = (int32_t)(edges[first].side / 3);
	}
}

/* The ends of edge @p side: of its triangle, from corner side % 3 to the next one. */
static void edge_ends(const struct gz_mesh *mesh, size_t side, uint32_t *out_low,
		      uint32_t *out_high)
{
	const uint32_t from = mesh->triangles[side / 3][side % 3];
	const uint32_t to = mesh->triangles[side / 3][(side + 1) % 3];
	*out_low = from < to ? from : to;
	*out_high = from < to ? to : from;
}

static enum gz_result find_neighbours(struct tracing *tracing)
{
	const struct gz_mesh *mesh = tracing->mesh;
	const size_t sides = 3 * mesh->triangle_count;
	size_t *ends = calloc(mesh->vertex_count + 1, sizeof *ends);
	struct mesh_edge *edges = calloc(sides, sizeof *edges);
	tracing->neighbours = malloc(sides * sizeof *tracing->neighbours);
	const bool complete = ends && edges && tracing->neighbours;
	uint32_t low, high;
	for (size_t side = 0; complete && side < sides; side++) {
		tracing->neighbours[side] = NO_NEIGHBOUR;
		edge_ends(mesh, side, &low, &high);
		ends[low + 1]++;
	}
	for (size_t i = 0; complete && i < mesh->vertex_count; i++)
		ends[i + 1] += ends[i];
	for (size_t side = 0; complete && side < sides; side++) {
		edge_ends(mesh, side, &low, &high);
		edges[ends[low]++] = (struct mesh_edge) { high, (uint32_t)side };
	}
	for (size_t i = 0, first = 0; complete && i < mesh->vertex_count; first = ends[i++])
		join_edges(edges + first, ends[i] - first, tracing->neighbours);
	free(ends);
	free(edges);
	return complete ? GZ_OK : GZ_ERR_NO_MEM;
}

static void corner_place(const struct gz_mesh *mesh, uint32_t triangle, int corner, double out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (double)mesh->positions[mesh->triangles[triangle][corner]][axis];
}

static void find_normals(struct tracing *tracing)
{
	for (size_t i = 0; i < tracing->mesh->triangle_count; i++) {
		double corners[3][3], side[2][3], normal[3];
		for (int corner = 0; corner < 3; corner++)
			corner_place(tracing->mesh, (uint32_t)i, corner, corners[corner]);
		for (int axis = 0; axis < 3; axis++) {
			side[0][axis] = corners[1][axis] - corners[0][axis];
			side[1][axis] = corners[2][axis] - corners[0][axis];
		}
		gz_cross3(side[0], side[1], normal);
		const bool some = gz_normalise3(normal);
		for (int axis = 0; axis < 3; axis++)
			tracing->normals[i][axis] = some ? (float)normal[axis] : 0;
	}
}

/* Turns a tracer's way along the directions of the corners of its triangle, the way it went before.
 * Returns false if there is none. */
static bool turn_along(const struct tracing *tracing, struct tracer *tracer)
{
	const uint32_t *corners = tracing->mesh->triangles[tracer->triangle];
	const float *normal = tracing->normals[tracer->triangle];
	double way[3] = { 0 };
	for (int corner = 0; corner < 3; corner++) {
		const float *direction = tracing->directions[corners[corner]];
		double sign = 0;
		for (int axis = 0; axis < 3; axis++)
			sign += (double)direction[axis] * tracer->way[axis];
		for (int axis = 0; axis < 3; axis++)
			way[axis] += (sign < 0 ? -1 : 1) * tracer->shares[corner] *
				     (double)direction[axis];
	}
	double up = 0;
	for (int axis = 0; axis < 3; axis++)
		up += way[axis] * (double)normal[axis];
	for (int axis = 0; axis < 3; axis++)
		way[axis] -= up * (double)normal[axis];
	if (!gz_normalise3(way))
		return false;
	const double along = gz_dot3(way, tracer->way);
	memcpy(tracer->way, way, sizeof way);
	return along > 0; /* otherwise the direction turns back here */
}

/* How fast the shares of the corners change along a tracer's way, 1/mm. False for a triangle
 * without area. */
static bool find_rates(const struct tracing *tracing, const struct tracer *tracer, double rates[3])
{
	double corners[3][3], side[2][3], normal[3], across[3];
	for (int corner = 0; corner < 3; corner++)
		corner_place(tracing->mesh, tracer->triangle, corner, corners[corner]);
	for (int axis = 0; axis < 3; axis++) {
		side[0][axis] = corners[1][axis] - corners[0][axis];
		side[1][axis] = corners[2][axis] - corners[0][axis];
	}
	gz_cross3(side[0], side[1], normal);
	const double square = gz_dot3(normal, normal);
	if (!(square > 0) || !isfinite(1 / square))
		return false;
	gz_cross3(tracer->way, side[1], across);
	rates[1] = gz_dot3(across, normal) / square;
	gz_cross3(side[0], tracer->way, across);
	rates[2] = gz_dot3(across, normal) / square;
	rates[0] = -rates[1] - rates[2];
	return true;
}

static void place_tracer(const struct tracing *tracing, struct tracer *tracer)
{
	for (int axis = 0; axis < 3; axis++)
		tracer->place[axis] = 0;
	for (int corner = 0; corner < 3; corner++) {
		double place[3];
		corner_place(tracing->mesh, tracer->triangle, corner, place);
		for (int axis = 0; axis < 3; axis++)
			tracer->place[axis] += tracer->shares[corner] * place[axis];
	}
}

/* Goes over the edge opposite to a corner. False at a border. */
static bool cross_edge(const struct tracing *tracing, struct tracer *tracer, int opposite)
{
	const struct gz_mesh *mesh = tracing->mesh;
	const uint32_t *from = mesh->triangles[tracer->triangle];
	const int first = (opposite + 1) % 3, second = (opposite + 2) % 3;
	const int32_t neighbour = tracing->neighbours[3 * (size_t)tracer->triangle + (size_t)first];
	if (neighbour == NO_NEIGHBOUR)
		return false;
	const uint32_t *to = mesh->triangles[neighbour];
	double shares[3] = { 0 };
	int entered = 0;
	for (int corner = 0; corner < 3; corner++) {
		if (to[corner] == from[first])
			shares[corner] = tracer->shares[first];
		else if (to[corner] == from[second])
			shares[corner] = tracer->shares[second];
		else
			entered = corner;
	}
	/* the way bends with the surface: what it loses across the edge is made good when it turns
	 */
	tracer->triangle = (uint32_t)neighbour;
	tracer->entered = entered;
	memcpy(tracer->shares, shares, sizeof shares);
	return true;
}

/* Goes on for @p most mm or to the edge of the triangle, and over it. Returns how far, mm. */
static double step_tracer(const struct tracing *tracing, struct tracer *tracer, double most)
{
	double rates[3], far = most;
	int leaves = -1;
	tracer->ended = !turn_along(tracing, tracer) || !find_rates(tracing, tracer, rates) ||
			/* back over the edge that it came by: the directions meet there */
			(tracer->entered >= 0 && rates[tracer->entered] < 0);
	if (tracer->ended)
		return 0;
	for (int corner = 0; corner < 3; corner++) {
		if (corner == tracer->entered || !(rates[corner] < 0))
			continue;
		const double end = -tracer->shares[corner] / rates[corner];
		if (end < far) {
			far = end;
			leaves = corner;
		}
	}
	double sum = 0;
	for (int corner = 0; corner < 3; corner++) {
		tracer->shares[corner] = fmax(0, tracer->shares[corner] + far * rates[corner]);
		if (corner == leaves)
			tracer->shares[corner] = 0;
		sum += tracer->shares[corner];
	}
	for (int corner = 0; corner < 3; corner++)
		tracer->shares[corner] /= sum;
	place_tracer(tracing, tracer);
	tracer->entered = -1;
	tracer->ended = leaves >= 0 && !cross_edge(tracing, tracer, leaves);
	return far;
}

/* Whether a node of a list is too near. */
static bool hatch_list_is_clear(const struct tracing *tracing, size_t list,
				const struct traced_node *node, double near)
{
	int32_t i = tracing->grid.heads[list & tracing->grid.mask];
	for (; i != GZ_POINT_GRID_END; i = tracing->nodes[i].next) {
		const struct traced_node *other = &tracing->nodes[i];
		if (other->stroke == node->stroke &&
		    abs(other->order - node->order) * tracing->step <
			    OWN_DISTANCES * tracing->distance)
			continue;
		double square = 0, facing = 0;
		for (int axis = 0; axis < 3; axis++) {
			const double away =
				(double)other->node.place[axis] - (double)node->node.place[axis];
			square += away * away;
			facing +=
				(double)other->node.normal[axis] * (double)node->node.normal[axis];
		}
		if (square < near * near && facing > -0.5)
			return false;
	}
	return true;
}

static bool node_is_clear(const struct tracing *tracing, const struct traced_node *node,
			  double near)
{
	int64_t cell[3];
	gz_point_grid_cell(&tracing->grid, node->node.place, cell);
	for (int row = 0; row < GZ_POINT_GRID_ROWS; row++) {
		const size_t list = gz_point_grid_list(&tracing->grid, cell, row);
		if (!hatch_list_is_clear(tracing, list, node, near) ||
		    !hatch_list_is_clear(tracing, list - 1, node, near) ||
		    !hatch_list_is_clear(tracing, list + 1, node, near))
			return false;
	}
	return true;
}

static struct traced_node node_of_tracer(const struct tracing *tracing, const struct tracer *tracer,
					 uint32_t triangle, int32_t order)
{
	struct traced_node node = { .stroke = (uint32_t)tracing->stroke_count, .order = order };
	for (int axis = 0; axis < 3; axis++)
		node.node.place[axis] = (float)tracer->place[axis];
	memcpy(node.node.normal, tracing->normals[triangle], sizeof node.node.normal);
	return node;
}

/* Room for one more node, by doubling. */
static bool reserve_node(struct tracing *tracing)
{
	if (tracing->node_count < tracing->node_capacity)
		return true;
	const size_t capacity = tracing->node_capacity ? 2 * tracing->node_capacity : 4096;
	struct traced_node *nodes = realloc(tracing->nodes, capacity * sizeof *nodes);
	if (!nodes)
		return false;
	tracing->nodes = nodes;
	tracing->node_capacity = capacity;
	return true;
}

/* Whether a node keeps others away, and is itself tested. */
static bool node_counts(const struct tracing *tracing, const struct traced_node *node)
{
	return node->order % tracing->stride == 0;
}

static bool add_node(struct tracing *tracing, const struct traced_node *node)
{
	if (!reserve_node(tracing))
		return false;
	struct traced_node *added = &tracing->nodes[tracing->node_count];
	*added = *node;
	if (node_counts(tracing, node))
		gz_point_grid_add(&tracing->grid, added->node.place, (int32_t)tracing->node_count,
				  &added->next);
	tracing->node_count++;
	return true;
}

/* Takes the last nodes back: they are the first of their lists. */
static void remove_nodes(struct tracing *tracing, size_t count)
{
	while (tracing->node_count > count) {
		const struct traced_node *node = &tracing->nodes[--tracing->node_count];
		if (!node_counts(tracing, node))
			continue;
		int64_t cell[3];
		gz_point_grid_cell(&tracing->grid, node->node.place, cell);
		tracing->grid.heads[gz_point_grid_list(&tracing->grid, cell, 0)] = node->next;
	}
}

/* Traces a stroke one way and adds its nodes. @param longest  mm  @return false if out of memory */
static bool trace_one_way(struct tracing *tracing, struct tracer tracer, int sign, double longest,
			  double *out_length)
{
	const double step = tracing->step;
	double length = 0, since = 0;
	int32_t order = 0;
	for (int i = 0; i < STEPS_MAX && length < longest; i++) {
		const uint32_t triangle = tracer.triangle;
		since += step_tracer(tracing, &tracer, step - since);
		if (!tracer.ended && since < 0.999 * step)
			continue;
		if (tracer.ended && since < 0.1 * step)
			break;
		const struct traced_node node =
			node_of_tracer(tracing, &tracer, triangle, sign * ++order);
		if (node_counts(tracing, &node) &&
		    !node_is_clear(tracing, &node, GZ_HATCH_NEAR * tracing->distance))
			break;
		if (!add_node(tracing, &node))
			return false;
		length += since;
		since = 0;
		if (tracer.ended)
			break;
	}
	*out_length = length;
	return true;
}

static bool add_stroke(struct tracing *tracing, size_t first, double length)
{
	if (tracing->stroke_count == tracing->stroke_capacity) {
		const size_t capacity =
			tracing->stroke_capacity ? 2 * tracing->stroke_capacity : 1024;
		struct gz_hatch_stroke *strokes =
			realloc(tracing->strokes, capacity * sizeof *strokes);
		if (!strokes)
			return false;
		tracing->strokes = strokes;
		tracing->stroke_capacity = capacity;
	}
	tracing->strokes[tracing->stroke_count++] = (struct gz_hatch_stroke) {
		.first = (uint32_t)first,
		.count = (uint32_t)(tracing->node_count - first),
		.before_mm = (float)tracing->length,
	};
	tracing->length += length - GZ_HATCH_POINTED * tracing->step;
	return true;
}

/* Traces the stroke that starts at a point, if it is clear there. @return false if out of memory */
static bool trace_stroke(struct tracing *tracing, const struct gz_mesh_point *point, size_t rank)
{
	struct tracer tracer = { .triangle = point->triangle, .entered = -1 };
	tracer.shares[1] = (double)point->across[0];
	tracer.shares[2] = (double)point->across[1];
	tracer.shares[0] = fmax(0, 1 - tracer.shares[1] - tracer.shares[2]);
	place_tracer(tracing, &tracer);
	/* most starts are too near to a stroke */
	const struct traced_node start = node_of_tracer(tracing, &tracer, point->triangle, 0);
	if (!node_is_clear(tracing, &start, tracing->distance))
		return true;
	const float *direction = tracing->directions[tracing->mesh->triangles[point->triangle][0]];
	for (int axis = 0; axis < 3; axis++)
		tracer.way[axis] = (double)direction[axis];
	if (!gz_normalise3(tracer.way) || !turn_along(tracing, &tracer))
		return true;
	const size_t first = tracing->node_count;
	const double share = (double)(gz_mixed_bits(7, rank) >> 11) * 0x1p-53;
	const double longest = LONGEST_DISTANCES * (0.5 + share) * tracing->distance / 2;
	double forward = 0, back = 0;
	struct tracer other = tracer;
	for (int axis = 0; axis < 3; axis++)
		other.way[axis] = -other.way[axis];
	if (!add_node(tracing, &start) || !trace_one_way(tracing, tracer, 1, longest, &forward) ||
	    !trace_one_way(tracing, other, -1, longest, &back))
		return false;
	if (forward + back < SHORTEST_DISTANCES * tracing->distance) {
		remove_nodes(tracing, first);
		return true;
	}
	return add_stroke(tracing, first, forward + back);
}

/* Traces the strokes of one distance. */
static enum gz_result trace_step(struct tracing *tracing, const struct gz_mesh_points *points)
{
	const double cells = points->area_mm2 / (tracing->distance * tracing->distance);
	const enum gz_result result =
		gz_point_grid_reset(&tracing->grid, tracing->distance, 4 * cells + 1024);
	if (result != GZ_OK)
		return result;
	tracing->stride = (int)fmax(1, tracing->distance / (2 * tracing->step));
	for (size_t i = 0; i < tracing->node_count; i++)
		if (node_counts(tracing, &tracing->nodes[i]))
			gz_point_grid_add(&tracing->grid, tracing->nodes[i].node.place, (int32_t)i,
					  &tracing->nodes[i].next);
	const double wanted = 4 * cells + 64;
	const size_t count = wanted < (double)points->count ? (size_t)wanted : points->count;
	for (size_t rank = 0; rank < count && tracing->node_count < GZ_HATCH_NODES_MAX; rank++) {
		if (gz_stop_wanted(tracing->stop))
			return GZ_ERR_CANCELLED;
		if (!trace_stroke(tracing, &points->points[rank], rank))
			return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

/* The nodes of a stroke in their order: the way back turned round, the start, the way forth. */
static void order_nodes(const struct tracing *tracing, const struct gz_hatch_stroke *stroke,
			struct gz_hatch_node *out_nodes)
{
	const struct traced_node *nodes = tracing->nodes + stroke->first;
	int32_t back = 0;
	for (uint32_t i = 0; i < stroke->count; i++)
		back = nodes[i].order < back ? nodes[i].order : back;
	for (uint32_t i = 0; i < stroke->count; i++)
		out_nodes[stroke->first + (uint32_t)(nodes[i].order - back)] = nodes[i].node;
}

static enum gz_result hand_strokes_over(struct tracing *tracing, double area_mm2,
					struct gz_hatch_strokes *out_strokes)
{
	struct gz_hatch_strokes strokes = { .stroke_count = tracing->stroke_count,
					    .node_count = tracing->node_count,
					    .length_mm = tracing->length,
					    .area_mm2 = area_mm2 };
	if (!tracing->strokes) {
		*out_strokes = strokes;
		return GZ_OK;
	}
	strokes.nodes = malloc(strokes.node_count * sizeof *strokes.nodes);
	if (!strokes.nodes)
		return GZ_ERR_NO_MEM;
	strokes.strokes = tracing->strokes;
	tracing->strokes = NULL;
	for (size_t i = 0; i < strokes.stroke_count; i++)
		order_nodes(tracing, &strokes.strokes[i], strokes.nodes);
	*out_strokes = strokes;
	return GZ_OK;
}

static enum gz_result trace_strokes(struct tracing *tracing, const struct gz_mesh_points *points,
				    double distance_mm)
{
	enum gz_result result = find_neighbours(tracing);
	tracing->normals = malloc(tracing->mesh->triangle_count * sizeof *tracing->normals);
	if (result != GZ_OK || !tracing->normals)
		return GZ_ERR_NO_MEM;
	find_normals(tracing);
	for (int axis = 0; axis < 3; axis++) {
		tracing->grid.origin[axis] = (double)tracing->mesh->positions[0][axis];
		for (size_t i = 1; i < tracing->mesh->vertex_count; i++)
			tracing->grid.origin[axis] =
				fmin(tracing->grid.origin[axis],
				     (double)tracing->mesh->positions[i][axis]);
	}
	int steps = 0;
	while (distance_mm / pow(DISTANCE_STEP, steps + 1) < sqrt(points->area_mm2) / 4)
		steps++;
	for (; result == GZ_OK && steps >= 0; steps--) {
		tracing->distance = distance_mm / pow(DISTANCE_STEP, steps);
		result = trace_step(tracing, points);
	}
	return result;
}

enum gz_result gz_hatch_strokes_make(const struct gz_mesh *mesh, const float (*directions)[3],
				     const struct gz_mesh_points *points, double distance_mm,
				     const atomic_bool *stop, struct gz_hatch_strokes *out_strokes)
{
	if (!(distance_mm > 0) || !isfinite(distance_mm))
		return GZ_ERR_INVAL;
	if (points->count == 0) {
		*out_strokes = (struct gz_hatch_strokes) { 0 };
		return GZ_OK;
	}
	struct tracing tracing = {
		.mesh = mesh, .directions = directions, .stop = stop, .step = distance_mm
	};
	enum gz_result result = trace_strokes(&tracing, points, distance_mm);
	if (result == GZ_OK)
		result = hand_strokes_over(&tracing, points->area_mm2, out_strokes);
	free(tracing.neighbours);
	free(tracing.normals);
	free(tracing.nodes);
	free(tracing.strokes);
	gz_point_grid_free(&tracing.grid);
	return result;
}

void gz_hatch_strokes_free(struct gz_hatch_strokes *strokes)
{
	free(strokes->strokes);
	free(strokes->nodes);
	*strokes = (struct gz_hatch_strokes) { 0 };
}
