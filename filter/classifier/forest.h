/**
 * @file
 * Decision forests that label a sample from its features (movement.h). A tree asks whether features
 * are below thresholds; its leaf has a number for each class, and the class with the greatest sum
 * over all trees wins. The numbers are integers and the thresholds are compared exactly, so the
 * result is the same on every machine.
 *
 * The forests are in forest_at_once.inc, forest_certain.inc and forest_whole.inc (whole.h), which
 * bench/probes/gaze_forest_fit.c made from recordings that people labelled; the files say from
 * which.
 */
#ifndef GZ_FILTER_CLASSIFIER_FOREST_H
#define GZ_FILTER_CLASSIFIER_FOREST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "filter/classifier/movement.h"

/** What a sample can be. */
enum gz_forest_class {
	GZ_FOREST_FIXATION,
	GZ_FOREST_SACCADE,
	GZ_FOREST_PURSUIT,
	GZ_FOREST_NOISE,   /**< not the eye: a lid in front of it, or a bad measurement */
	GZ_FOREST_RINGING, /**< the eye rings after a saccade; not every forest knows it */
	GZ_FOREST_CLASSES,
};

/** One unit of a score: 1/4096 of a natural logarithm of odds. */
#define GZ_FOREST_UNIT (1.0 / 4096)

/** The score of a class that a forest does not know. */
#define GZ_FOREST_NEVER (INT32_MIN / 2)

/** A question, or a leaf, which is its own successor. */
struct gz_forest_node {
	float threshold;
	uint8_t feature;
	uint8_t next[2]; /**< the node if the feature is below the threshold, and if it is not */
	uint8_t leaf;    /**< for a leaf, its place among the tree's leaves */
};

/** One tree. Its root is its first node. */
struct gz_forest_tree {
	uint32_t node;  /**< its first node in the forest's nodes */
	uint32_t leaf;  /**< its first leaf in the forest's leaves */
	uint32_t depth; /**< questions on the longest way to a leaf */
};

/** A forest. All of it is constant. */
struct gz_forest {
	size_t tree_count;
	const struct gz_forest_tree *tree;
	const struct gz_forest_node *node;
	int class_count;        /**< that it knows, the first ones of enum gz_forest_class */
	const int16_t *leaf;    /**< for each leaf the scores of these classes, GZ_FOREST_UNIT */
	const int32_t *base;    /**< a score for each class, added to the sums of the leaves */
	uint64_t training_hash; /**< of the scores that the training gave, for a test */
};

/** What the eye does at a sample, from its features and nothing later. */
extern const struct gz_forest gz_forest_at_once;

/** What the eye did 8 ms before a sample, from the sample's features. */
extern const struct gz_forest gz_forest_certain;

/** How long before a sample the moment is that gz_forest_certain labels, ms. */
#define GZ_FOREST_CERTAIN_MS 8

/**
 * The score of each class: greater is more likely. Differences of two scores, in GZ_FOREST_UNIT,
 * are logarithms of the classes' odds, as learned.
 *
 * Does not allocate. The time does not depend on the features.
 */
void gz_forest_score(const struct gz_forest *forest, const float features[GZ_MOVEMENT_FEATURES],
		     int32_t out_scores[GZ_FOREST_CLASSES]);

/** The newest label of one sample after the other. Zero-initialised is the start. */
struct gz_forest_memory {
	enum gz_forest_class last;
	bool any; /**< whether last is set */
};

/**
 * Label one sample by the scores of a forest, without flicker between fixation and pursuit. Ringing
 * follows a saccade only.
 *
 * @param scores       gz_forest_score(); NULL if nothing was measured: noise
 * @param still_scene  nothing moves in the scene, so there is no pursuit
 */
enum gz_forest_class gz_forest_label(struct gz_forest_memory *memory, const int32_t *scores,
				     bool still_scene);

#endif
