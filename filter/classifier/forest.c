#include "filter/classifier/forest.h"

#include <string.h>

#include "filter/classifier/whole.h"

/* Always goes down as far as the tree is deep: a leaf leads to itself. A loop of constant length
 * without branches is faster than one that ends at the leaf. */
static uint8_t find_leaf(const struct gz_forest_node *nodes, uint32_t depth, const float *features)
{
	const struct gz_forest_node *node = nodes;
	for (uint32_t i = 0; i < depth; i++)
		node = nodes + node->next[features[node->feature] >= node->threshold];
	return node->leaf;
}

/* The number of classes is constant in each caller, so that the sums stay in registers. */
static inline void score_features(const struct gz_forest *forest, const float *features,
				  int class_count, int32_t *out_scores)
{
	memcpy(out_scores, forest->base, (size_t)class_count * sizeof out_scores[0]);
	for (size_t i = 0; i < forest->tree_count; i++) {
		const struct gz_forest_tree *tree = &forest->tree[i];
		const size_t leaf =
			tree->leaf + find_leaf(forest->node + tree->node, tree->depth, features);
		const int16_t *score = forest->leaf + leaf * (size_t)class_count;
		for (int k = 0; k < class_count; k++)
			out_scores[k] += score[k];
	}
}

void gz_forest_score(const struct gz_forest *forest, const float features[GZ_MOVEMENT_FEATURES],
		     int32_t out_scores[GZ_FOREST_CLASSES])
{
	score_features(forest, features, GZ_FOREST_CLASSES, out_scores);
}

void gz_whole_score(const float features[GZ_WHOLE_FEATURES], int32_t out_scores[GZ_WHOLE_CLASSES])
{
	score_features(&gz_forest_whole, features, GZ_WHOLE_CLASSES, out_scores);
}

enum gz_forest_class gz_forest_best(const int32_t scores[GZ_FOREST_CLASSES])
{
	int best = 0;
	for (int k = 1; k < GZ_FOREST_CLASSES; k++)
		if (scores[k] > scores[best])
			best = k;
	return (enum gz_forest_class)best;
}
