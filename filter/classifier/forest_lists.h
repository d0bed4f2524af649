/**
 * @file
 * The same scores as gz_forest_score() for one sample after the other, in a fraction of the time.
 * From one sample to the next, most features stay between the same thresholds, and most of the
 * answers that change lie beside the way that a tree was walked. So the thresholds of each feature
 * lie in a list, in order. A feature that moves past thresholds finds the questions whose answers
 * change, and only the trees that asked one of them are walked again. Scores are integers, so
 * taking the old leaf away and adding the new one is exact.
 */
#ifndef GZ_FILTER_CLASSIFIER_FOREST_LISTS_H
#define GZ_FILTER_CLASSIFIER_FOREST_LISTS_H

#include "filter/classifier/forest.h"

/** Most leaves of a tree and most trees of a forest that can be in lists. */
#define GZ_FOREST_LIST_LEAVES 32
#define GZ_FOREST_LIST_TREES  192

/** The lists of a forest. */
struct gz_forest_lists;

/** What the features of the sample before gave. Zero-initialised is the start. Plain data; it holds
 *  for one forest. */
struct gz_forest_walks {
	bool begun; /**< whether the other fields are set */
	/** A feature that is at least low and below high changes no answer. */
	float low[GZ_MOVEMENT_FEATURES], high[GZ_MOVEMENT_FEATURES];
	uint16_t place[GZ_MOVEMENT_FEATURES]; /**< of high in the lists */
	uint32_t asked[GZ_FOREST_LIST_TREES]; /**< questions on the way to each tree's leaf, bits */
	uint8_t leaf[GZ_FOREST_LIST_TREES];   /**< that leaf, among the leaves of the tree */
	int32_t scores[GZ_FOREST_CLASSES];
};

/**
 * The lists of a forest, made by the first call for it, which allocates about 150 KB and takes
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
 * As gz_forest_score(), with the same result, whatever @p walks holds from before.
 *
 * @param features  finite
 *
 * Does not allocate. The more the features differ from those before, the longer it takes. Threads:
 * any, each with its own @p walks.
 */
void gz_forest_lists_score(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			   const float features[GZ_MOVEMENT_FEATURES],
			   int32_t out_scores[GZ_FOREST_CLASSES]);

#endif
