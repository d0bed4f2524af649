/**
 * @file
 * The same scores as gz_forest_score() for one sample after the other, in a third of the time. A
 * tree that is walked from its root waits for memory at each question. Here the questions of all
 * trees lie in lists, one after the other, each list for one feature and ordered by threshold. Only
 * the beginning of each list is read: the questions whose answer is unusual. Each of them excludes
 * leaves of its tree; what is left in the end is the leaf that the walk would find. (Lucchese et
 * al., "QuickScorer: a fast algorithm to rank documents with additive ensembles of regression
 * trees", SIGIR 2015; there one of the answers is always the one that excludes.)
 */
#ifndef GZ_FILTER_CLASSIFIER_FOREST_LISTS_H
#define GZ_FILTER_CLASSIFIER_FOREST_LISTS_H

#include "filter/classifier/forest.h"

/** Most leaves of a tree and most trees of a forest that can be in lists. */
#define GZ_FOREST_LIST_LEAVES 32
#define GZ_FOREST_LIST_TREES  512

/** The lists of a forest. */
struct gz_forest_lists;

/**
 * The lists of a forest, made by the first call for it, which allocates about 200 KB and takes
 * some milliseconds. They stay until the program ends.
 *
 * @param forest  gz_forest_at_once or gz_forest_certain
 * @return NULL if it is neither of them, is too large for lists, or there is no memory; then
 *         gz_forest_score() does the same
 *
 * Threads: any.
 */
const struct gz_forest_lists *gz_forest_lists_of(const struct gz_forest *forest);

/**
 * As gz_forest_score(), with the same result.
 *
 * @param features  finite
 *
 * Does not allocate. Threads: any.
 */
void gz_forest_lists_score(const struct gz_forest_lists *lists,
			   const float features[GZ_MOVEMENT_FEATURES],
			   int32_t out_scores[GZ_FOREST_CLASSES]);

#endif
