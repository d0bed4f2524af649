/* The trained forests. */
#include "filter/classifier/forest.h"
#include "filter/classifier/whole.h"

/* A question: the feature, its threshold, and the nodes below and not below it. */
#define N(feature, threshold, below, above) { threshold##F, feature, { below, above }, 0 },

/* A leaf, which is its own successor: its place among the nodes and among the leaves. */
#define L(node, leaf) { 0, 0, { node, node }, leaf },

#include "filter/classifier/forest_at_once.inc"
#include "filter/classifier/forest_certain.inc"
#include "filter/classifier/forest_whole.inc"

#define FOREST(name)                                                                               \
	{                                                                                          \
		sizeof name##_trees / sizeof name##_trees[0], name##_trees, name##_nodes,          \
			sizeof name##_base / sizeof name##_base[0], name##_leaves[0], name##_base, \
			name##_hash,                                                               \
	}

const struct gz_forest gz_forest_at_once = FOREST(at_once);
const struct gz_forest gz_forest_certain = FOREST(certain);
const struct gz_forest gz_forest_whole = FOREST(whole);
