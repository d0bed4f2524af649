#include "filter/classifier/forest.h"

#include <string.h>

#include "filter/classifier/whole.h"

/* With the constants of its callers, so that loops are unrolled and arrays become registers. */
#define INLINED static inline __attribute__((always_inline))

/* Trees that are asked side by side: each answer leads to the next question, so one tree alone
 * leaves the processor waiting. Chosen: as fast as any number of 6 and more, and forests are often
 * of a multiple of it. */
enum { TREES_AT_ONCE = 10 };

/* Find the leaves of @p count neighbouring trees, which is constant in each caller. Always goes
 * down as far as the deepest one: a leaf leads to itself. A loop of that length without branches is
 * faster than one that ends at the leaf. */
INLINED void find_leaves(const struct gz_forest *forest, const struct gz_forest_tree *trees,
			 size_t count, const float *features, size_t *out_leaves)
{
	const struct gz_forest_node *root[TREES_AT_ONCE];
	uint32_t at[TREES_AT_ONCE], depth = 0;
#pragma GCC unroll 10
	for (size_t t = 0; t < count; t++) {
		root[t] = forest->node + trees[t].node;
		at[t] = 0;
		depth = trees[t].depth > depth ? trees[t].depth : depth;
	}
	for (uint32_t i = 0; i < depth; i++) {
#pragma GCC unroll 10
		for (size_t t = 0; t < count; t++) {
			const struct gz_forest_node *node = root[t] + at[t];
			at[t] = node->next[features[node->feature] >= node->threshold];
		}
	}
#pragma GCC unroll 10
	for (size_t t = 0; t < count; t++)
		out_leaves[t] = trees[t].leaf + root[t][at[t]].leaf;
}

/* Add the scores of the leaves of @p count neighbouring trees. */
INLINED void add_trees(const struct gz_forest *forest, const struct gz_forest_tree *trees,
		       size_t count, const float *features, int class_count, int32_t *scores)
{
	size_t leaves[TREES_AT_ONCE];
	find_leaves(forest, trees, count, features, leaves);
#pragma GCC unroll 10
	for (size_t t = 0; t < count; t++) {
		const int16_t *score = forest->leaf + leaves[t] * (size_t)class_count;
		for (int k = 0; k < class_count; k++)
			scores[k] += score[k];
	}
}

/* The number of classes is constant in each caller, so that the sums stay in registers. */
static inline void score_features(const struct gz_forest *forest, const float *features,
				  int class_count, int32_t *out_scores)
{
	const struct gz_forest_tree *tree = forest->tree, *end = tree + forest->tree_count;
	memcpy(out_scores, forest->base, (size_t)class_count * sizeof out_scores[0]);
	for (; end - tree >= TREES_AT_ONCE; tree += TREES_AT_ONCE)
		add_trees(forest, tree, TREES_AT_ONCE, features, class_count, out_scores);
	for (; tree < end; tree++)
		add_trees(forest, tree, 1, features, class_count, out_scores);
}

void gz_forest_score(const struct gz_forest *forest, const float features[GZ_MOVEMENT_FEATURES],
		     int32_t out_scores[GZ_FOREST_CLASSES])
{
	if (forest->class_count == GZ_FOREST_CLASSES) {
		score_features(forest, features, GZ_FOREST_CLASSES, out_scores);
		return;
	}
	score_features(forest, features, GZ_FOREST_RINGING, out_scores);
	out_scores[GZ_FOREST_RINGING] = GZ_FOREST_NEVER;
}

void gz_whole_score(const float features[GZ_WHOLE_FEATURES], int32_t out_scores[GZ_FOREST_CLASSES])
{
	score_features(&gz_forest_whole, features, GZ_FOREST_CLASSES, out_scores);
}

/* The class of the greatest score, the first one of several, after @p last. */
static enum gz_forest_class best_class(const int32_t scores[GZ_FOREST_CLASSES],
				       enum gz_forest_class last)
{
	const bool may_ring = last == GZ_FOREST_SACCADE || last == GZ_FOREST_RINGING;
	int best = 0;
	for (int k = 1; k < GZ_FOREST_CLASSES; k++)
		if (scores[k] > scores[best] && (k != GZ_FOREST_RINGING || may_ring))
			best = k;
	return (enum gz_forest_class)best;
}

/* By how much the score must be greater to change between fixation and pursuit, GZ_FOREST_UNIT:
 * odds of 1.5. Chosen: labels flicker less, and agree as much with those of people. */
static const int32_t CHANGE_LEAD = 1661;

static bool is_slow_class(enum gz_forest_class class)
{
	return class == GZ_FOREST_FIXATION || class == GZ_FOREST_PURSUIT;
}

/* In a still scene there is nothing to follow. */
static enum gz_forest_class without_pursuit(enum gz_forest_class class, bool still_scene)
{
	return still_scene && class == GZ_FOREST_PURSUIT ? GZ_FOREST_FIXATION : class;
}

enum gz_forest_class gz_forest_label(struct gz_forest_memory *memory, const int32_t *scores,
				     bool still_scene)
{
	const enum gz_forest_class best =
		scores ? best_class(scores, memory->last) : GZ_FOREST_NOISE;
	enum gz_forest_class now = without_pursuit(best, still_scene);
	const enum gz_forest_class last = without_pursuit(memory->last, still_scene);
	const bool slow = memory->any && is_slow_class(now) && is_slow_class(last);
	if (slow && scores[now] - scores[last] < CHANGE_LEAD)
		now = last;
	memory->last = now;
	memory->any = true;
	return now;
}
