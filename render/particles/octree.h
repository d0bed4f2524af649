/**
 * @file
 * An octree of points in the unit cube. A leaf has one point, or is as small as asked for. Points
 * are kept in the order of the tree (Morton order), so that each node is a run of them.
 */
#ifndef GZ_RENDER_PARTICLES_OCTREE_H
#define GZ_RENDER_PARTICLES_OCTREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Most levels below the root. Their codes of three bits a level fit into 64 bits. */
#define GZ_OCTREE_LEVELS_MAX 21

/** A node: a run of points and the box round them. */
struct gz_octree_node {
	float least[3], greatest[3]; /**< of its points; tighter than its cube */
	uint32_t first, count;       /**< points: [first, first + count); count is 1 or more */
	uint32_t child;              /**< index of its first child; the others follow it */
	uint32_t children;           /**< 0 to 8; 0: a leaf */
};

/** The tree. Read-only once built; threads may share it. */
struct gz_octree {
	uint32_t count;               /**< points; 1 or more */
	float *at[3];                 /**< coordinates x, y, z of points in the tree's order */
	uint32_t *order;              /**< the number of each of them as they were given */
	struct gz_octree_node *nodes; /**< node 0 is the root */
	uint32_t node_count;
};

/**
 * Build a tree.
 *
 * @param points      x, y, z, each 0 to 1
 * @param count       1 to 2^31 - 1
 * @param least_edge  a cube of this edge or less is not divided; above 0
 * @param[out] out_tree  written on GZ_OK; the caller frees it with gz_octree_free()
 * @retval GZ_ERR_INVAL   @p count is out of range
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * Points in one leaf keep their order. Takes 24 bytes a point and 44 a node; about 32 bytes a point
 * more while it is built.
 */
enum gz_result gz_octree_build(const float (*points)[3], size_t count, double least_edge,
			       struct gz_octree *out_tree);

/** Free the tree and zero it. Accepts a zero-initialised one. */
void gz_octree_free(struct gz_octree *tree);

/** A search for the points in a box. */
struct gz_octree_walk {
	const struct gz_octree *tree;
	float least[3], greatest[3];
	int waiting;
	uint32_t nodes[7 * GZ_OCTREE_LEVELS_MAX + 8]; /**< still to be looked at */
};

/** Begin to search for the points in a box, whose faces belong to it. */
void gz_octree_walk_begin(struct gz_octree_walk *walk, const struct gz_octree *tree,
			  const float least[3], const float greatest[3]);

/**
 * The next run of points, in the tree's order. All points in the box are in one of the runs; some
 * points of a run may lie outside.
 *
 * @return false if there are no more
 */
bool gz_octree_walk_next(struct gz_octree_walk *walk, uint32_t *out_first, uint32_t *out_count);

/** Squared distance from point @p index of the tree's order to the nearest other point; INFINITY if
 *  there is no other. */
float gz_octree_nearest_other(const struct gz_octree *tree, uint32_t index);

#endif
