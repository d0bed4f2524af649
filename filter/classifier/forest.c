#include "filter/classifier/forest.h"

#include <string.h>

/* Always goes down as far as the tree is deep: a leaf leads to itself. A loop of constant length
 * without branches is faster than one that ends at the leaf. */
static uint8_t find_leaf(const struct gz_forest_node *nodes, uint32_t depth, const float *features)
{
	const struct gz_forest_node *node = nodes;
	for (uint32_t i = 0; i < depth; i++)
		node = nodes + node->next[features[node->feature] >= node->threshold];
	return node->leaf;
}

void gz_forest_score(const struct gz_forest *forest, const float features[GZ_MOVEMENT_FEATURES],
		     int32_t out_scores[GZ_FOREST_CLASSES])
{
	memcpy(out_scores, forest->base, GZ_FOREST_CLASSES * sizeof out_scores[0]);
	for (size_t i = 0; i < forest->tree_count; i++) {
		const struct gz_forest_tree *tree = &forest->tree[i];
		const int16_t *score =
			forest->leaf[tree->leaf +
				     find_leaf(forest->node + tree->node, tree->depth, features)];
		for (int k = 0; k < GZ_FOREST_CLASSES; k++)
			out_scores[k] += score[k];
	}
}

enum gz_forest_class gz_forest_best(const int32_t scores[GZ_FOREST_CLASSES])
{
	int best = 0;
	for (int k = 1; k < GZ_FOREST_CLASSES; k++)
		if (scores[k] > scores[best])
			best = k;
	return (enum gz_forest_class)best;
}
