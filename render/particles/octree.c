#include "render/particles/octree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A radix sort takes this many bits of a key at once. Chosen: its counters fit into the first-level
 * cache. */
#define RADIX_BITS 11
#define RADIX      (1U << RADIX_BITS)

/* A search does not look into nodes of so few points. Chosen: looking costs more than the points
 * that may lie outside. */
#define RUN_UNDIVIDED 8

/* A point on its way into the tree. */
struct coded_point {
	uint64_t code;
	uint32_t number;
};

/* What building needs. */
struct octree_builder {
	struct gz_octree *tree;
	const struct coded_point *points; /* sorted */
	int levels;
	uint32_t room; /* nodes that fit */
	bool failed;
};

/* Two zero bits behind each of the 21 lowest bits. */
static uint64_t spread_bits(uint64_t bits)
{
	bits = (bits | bits << 32) & UINT64_C(0x001f00000000ffff);
	bits = (bits | bits << 16) & UINT64_C(0x001f0000ff0000ff);
	bits = (bits | bits << 8) & UINT64_C(0x100f00f00f00f00f);
	bits = (bits | bits << 4) & UINT64_C(0x10c30c30c30c30c3);
	return (bits | bits << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t cell_of(float x, int levels)
{
	const int64_t cells = INT64_C(1) << levels;
	const int64_t cell = (int64_t)((double)x * (double)cells);
	return (uint64_t)(cell < 0 ? 0 : cell >= cells ? cells - 1 : cell);
}

static uint64_t code_of(const float point[3], int levels)
{
	return spread_bits(cell_of(point[0], levels)) |
	       spread_bits(cell_of(point[1], levels)) << 1 |
	       spread_bits(cell_of(point[2], levels)) << 2;
}

/* Sort by the lowest bits of the codes; equal ones keep their order. Returns where the result is:
 * one of the two arrays. */
static struct coded_point *sort_points(struct coded_point *from, struct coded_point *to,
				       size_t count, int bits)
{
	for (int shift = 0; shift < bits; shift += RADIX_BITS) {
		uint32_t starts[RADIX] = { 0 }, sum = 0;
		for (size_t i = 0; i < count; i++)
			starts[from[i].code >> shift & (RADIX - 1)]++;
		for (size_t k = 0; k < RADIX; k++) {
			const uint32_t here = starts[k];
			starts[k] = sum;
			sum += here;
		}
		for (size_t i = 0; i < count; i++)
			to[starts[from[i].code >> shift & (RADIX - 1)]++] = from[i];
		struct coded_point *sorted = to;
		to = from;
		from = sorted;
	}
	return from;
}

static void set_leaf_box(struct gz_octree *tree, struct gz_octree_node *node)
{
	for (int axis = 0; axis < 3; axis++) {
		const float *at = tree->at[axis] + node->first;
		float least = at[0], greatest = at[0];
		for (uint32_t i = 1; i < node->count; i++) {
			least = at[i] < least ? at[i] : least;
			greatest = at[i] > greatest ? at[i] : greatest;
		}
		node->least[axis] = least;
		node->greatest[axis] = greatest;
	}
}

static void join_child_boxes(struct gz_octree *tree, struct gz_octree_node *node)
{
	const struct gz_octree_node *children = tree->nodes + node->child;
	memcpy(node->least, children->least, sizeof node->least);
	memcpy(node->greatest, children->greatest, sizeof node->greatest);
	for (uint32_t i = 1; i < node->children; i++)
		for (int axis = 0; axis < 3; axis++) {
			node->least[axis] = fminf(node->least[axis], children[i].least[axis]);
			node->greatest[axis] =
				fmaxf(node->greatest[axis], children[i].greatest[axis]);
		}
}

/* Add a node at the end of the list. */
static void add_node(struct octree_builder *builder, uint32_t first, uint32_t count)
{
	struct gz_octree *tree = builder->tree;
	if (tree->node_count == builder->room) {
		const uint32_t room = builder->room ? builder->room + builder->room / 2 : 64;
		struct gz_octree_node *nodes = realloc(tree->nodes, room * sizeof *nodes);
		builder->failed = builder->failed || !nodes;
		if (!nodes)
			return;
		tree->nodes = nodes;
		builder->room = room;
	}
	tree->nodes[tree->node_count++] =
		(struct gz_octree_node) { .first = first, .count = count };
}

/* The end of the points that share the digit of the first one. */
static uint32_t end_of_digit(const struct octree_builder *builder, uint32_t first, uint32_t end,
			     int shift)
{
	const uint64_t prefix = builder->points[first].code >> shift;
	uint32_t inside = first, outside = end;
	while (outside - inside > 1) {
		const uint32_t middle = inside + (outside - inside) / 2;
		if (builder->points[middle].code >> shift == prefix)
			inside = middle;
		else
			outside = middle;
	}
	return outside;
}

static void divide_node(struct octree_builder *builder, uint32_t index, int level)
{
	struct gz_octree *tree = builder->tree;
	const struct gz_octree_node node = tree->nodes[index];
	if (node.count == 1 || level == builder->levels) {
		set_leaf_box(tree, &tree->nodes[index]);
		return;
	}
	const int shift = 3 * (builder->levels - 1 - level);
	const uint32_t end = node.first + node.count, child = tree->node_count;
	for (uint32_t at = node.first; at < end && !builder->failed;) {
		const uint32_t next = end_of_digit(builder, at, end, shift);
		add_node(builder, at, next - at);
		at = next;
	}
	const uint32_t children = tree->node_count - child;
	for (uint32_t i = 0; i < children && !builder->failed; i++)
		divide_node(builder, child + i, level + 1);
	if (builder->failed)
		return;
	tree->nodes[index].child = child;
	tree->nodes[index].children = children;
	join_child_boxes(tree, &tree->nodes[index]);
}

static bool allocate_points(struct gz_octree *tree, size_t count)
{
	bool good = true;
	for (int axis = 0; axis < 3; axis++) {
		tree->at[axis] = malloc(count * sizeof *tree->at[axis]);
		good = good && tree->at[axis];
	}
	tree->order = malloc(count * sizeof *tree->order);
	return good && tree->order;
}

/* Sort the points into the tree, and make its nodes. */
static bool fill_tree(struct gz_octree *tree, const float (*points)[3], struct coded_point *memory,
		      int levels)
{
	const size_t count = tree->count;
	for (size_t i = 0; i < count; i++)
		memory[i] = (struct coded_point) { code_of(points[i], levels), (uint32_t)i };
	const struct coded_point *sorted = sort_points(memory, memory + count, count, 3 * levels);
	for (size_t i = 0; i < count; i++) {
		tree->order[i] = sorted[i].number;
		for (int axis = 0; axis < 3; axis++)
			tree->at[axis][i] = points[sorted[i].number][axis];
	}
	struct octree_builder builder = { .tree = tree, .points = sorted, .levels = levels };
	add_node(&builder, 0, tree->count);
	if (!builder.failed)
		divide_node(&builder, 0, 0);
	return !builder.failed;
}

enum gz_result gz_octree_build(const float (*points)[3], size_t count, double least_edge,
			       struct gz_octree *out_tree)
{
	struct gz_octree tree = { .count = (uint32_t)count };
	int levels = 1;
	if (count < 1 || count > INT32_MAX)
		return GZ_ERR_INVAL;
	while (levels < GZ_OCTREE_LEVELS_MAX && ldexp(1, -levels) > least_edge)
		levels++;
	struct coded_point *memory = malloc(2 * count * sizeof *memory);
	const bool good =
		memory && allocate_points(&tree, count) && fill_tree(&tree, points, memory, levels);
	free(memory);
	if (!good) {
		gz_octree_free(&tree);
		return GZ_ERR_NO_MEM;
	}
	*out_tree = tree;
	return GZ_OK;
}

void gz_octree_free(struct gz_octree *tree)
{
	for (int axis = 0; axis < 3; axis++)
		free(tree->at[axis]);
	free(tree->order);
	free(tree->nodes);
	*tree = (struct gz_octree) { 0 };
}

void gz_octree_walk_begin(struct gz_octree_walk *walk, const struct gz_octree *tree,
			  const float least[3], const float greatest[3])
{
	walk->tree = tree;
	memcpy(walk->least, least, sizeof walk->least);
	memcpy(walk->greatest, greatest, sizeof walk->greatest);
	walk->nodes[0] = 0;
	walk->waiting = 1;
}

static bool node_outside(const struct gz_octree_walk *walk, const struct gz_octree_node *node)
{
	return node->least[0] > walk->greatest[0] || node->greatest[0] < walk->least[0] ||
	       node->least[1] > walk->greatest[1] || node->greatest[1] < walk->least[1] ||
	       node->least[2] > walk->greatest[2] || node->greatest[2] < walk->least[2];
}

static bool node_inside(const struct gz_octree_walk *walk, const struct gz_octree_node *node)
{
	return node->least[0] >= walk->least[0] && node->greatest[0] <= walk->greatest[0] &&
	       node->least[1] >= walk->least[1] && node->greatest[1] <= walk->greatest[1] &&
	       node->least[2] >= walk->least[2] && node->greatest[2] <= walk->greatest[2];
}

bool gz_octree_walk_next(struct gz_octree_walk *walk, uint32_t *out_first, uint32_t *out_count)
{
	while (walk->waiting > 0) {
		const struct gz_octree_node *node =
			&walk->tree->nodes[walk->nodes[--walk->waiting]];
		if (node_outside(walk, node))
			continue;
		if (node->count <= RUN_UNDIVIDED || node->children == 0 ||
		    node_inside(walk, node)) {
			*out_first = node->first;
			*out_count = node->count;
			return true;
		}
		for (uint32_t i = node->children; i > 0; i--)
			walk->nodes[walk->waiting++] = node->child + i - 1;
	}
	return false;
}

/* Squared distance from a point to the box of a node. */
static float distance_to_box(const struct gz_octree_node *node, const float point[3])
{
	float sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		const float below = node->least[axis] - point[axis];
		const float above = point[axis] - node->greatest[axis];
		const float away = fmaxf(0, fmaxf(below, above));
		sum += away * away;
	}
	return sum;
}

static float nearest_in_leaf(const struct gz_octree *tree, const struct gz_octree_node *leaf,
			     uint32_t index, float best)
{
	for (uint32_t i = leaf->first; i < leaf->first + leaf->count && best > 0; i++) {
		const float dx = tree->at[0][i] - tree->at[0][index],
			    dy = tree->at[1][i] - tree->at[1][index],
			    dz = tree->at[2][i] - tree->at[2][index];
		const float squared = dx * dx + dy * dy + dz * dz;
		if (i != index && squared < best)
			best = squared;
	}
	return best;
}

float gz_octree_nearest_other(const struct gz_octree *tree, uint32_t index)
{
	uint32_t waiting[7 * GZ_OCTREE_LEVELS_MAX + 8] = { 0 };
	const float point[3] = { tree->at[0][index], tree->at[1][index], tree->at[2][index] };
	float best = INFINITY;
	int count = 1;
	/* Neighbours in the order are near in space: a bound to begin with. */
	for (int step = -1; step <= 1; step += 2) {
		const int64_t other = (int64_t)index + step;
		if (other < 0 || other >= (int64_t)tree->count)
			continue;
		const struct gz_octree_node one = { .first = (uint32_t)other, .count = 1 };
		best = nearest_in_leaf(tree, &one, index, best);
	}
	while (count > 0 && best > 0) {
		const struct gz_octree_node *node = &tree->nodes[waiting[--count]];
		if (distance_to_box(node, point) >= best)
			continue;
		if (node->children == 0)
			best = nearest_in_leaf(tree, node, index, best);
		for (uint32_t i = 0; i < node->children; i++)
			waiting[count++] = node->child + i;
	}
	return best;
}
