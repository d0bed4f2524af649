/**
 * @file
 * What the eye did at each sample of a whole recording. Here the features of movement.h are taken
 * twice, of what came before a sample and, in reversed time, of what came after it, and a forest
 * reads both. Its scores are then decoded together: the most likely sequence of labels, in which
 * each change of the label has a cost (Viterbi, "Error bounds for convolutional codes and an
 * asymptotically optimum decoding algorithm", IEEE Transactions on Information Theory 13, 1967).
 *
 * The result is the same on every machine: what follows the features is integers.
 */
#ifndef GZ_FILTER_CLASSIFIER_WHOLE_H
#define GZ_FILTER_CLASSIFIER_WHOLE_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "filter/classifier/forest.h"
#include "filter/classifier/movement.h"
#include "protocol/display.h"

/** Number of features of a sample: those of what came before, then those of what came after. */
#define GZ_WHOLE_FEATURES (2 * GZ_MOVEMENT_FEATURES)

/** Takes the features of the samples, in order. */
struct gz_whole_rows {
	void *user;
	void (*take)(void *user, size_t index, const float features[GZ_WHOLE_FEATURES]);
};

/**
 * Compute the features of all samples.
 *
 * @param display  passes gz_display_valid()
 * @param input    @p count samples, each newer than the last
 * @retval GZ_ERR_NO_MEM  no memory; some rows may have been taken
 */
enum gz_result gz_whole_features(const struct gz_display *display,
				 const struct gz_movement_input *input, size_t count,
				 const struct gz_whole_rows *rows);

/** What the eye does at a sample, from its features of both directions. */
extern const struct gz_forest gz_forest_whole;

/** As gz_forest_score(), for gz_forest_whole. */
void gz_whole_score(const float features[GZ_WHOLE_FEATURES], int32_t out_scores[GZ_FOREST_CLASSES]);

/** Costs of a sequence of labels, as times: a change costs as much as a label that is e times less
 *  likely over this time. */
struct gz_whole_costs {
	int64_t change_us;  /**< any change of the label */
	int64_t pursuit_us; /**< a change between fixation and pursuit */
	int64_t saccade_us; /**< a saccade that ends without ringing, or that begins or
			       ends in noise, as the flanks of a blink look */
	int32_t added[GZ_FOREST_CLASSES]; /**< is added to the scores of the classes, GZ_FOREST_UNIT
					   */
};

/** The costs and additions that gz_whole_label() uses. Chosen on recordings that the forest did not
 * learn from (docs/gaze-pipeline.md). */
extern const struct gz_whole_costs gz_whole_preset_costs;

/**
 * Find the best sequence of labels. Ringing follows a saccade only. Samples without a measurement
 * are noise; losses of one sample, or of less than GZ_WHOLE_DROPOUT_NS, get the label of a sample
 * beside them.
 *
 * @param input   @p count samples, each newer than the last; places are not read
 * @param scores  of each sample
 * @param[out] out_class  of each sample, below GZ_FOREST_CLASSES
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_whole_decode(const struct gz_movement_input *input,
			       const int32_t (*scores)[GZ_FOREST_CLASSES], size_t count,
			       const struct gz_whole_costs *costs, uint8_t *out_class);

/** Losses that are shorter, between two measured samples, are no blinks; as pipeline.dropout_ms and
 *  a sample at 250 Hz. */
#define GZ_WHOLE_DROPOUT_NS INT64_C(14000000)

/**
 * The time between two samples from which on something is missing between them: more than
 * GZ_WHOLE_DROPOUT_NS and more than three times the median.
 *
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_whole_gap_ns(const struct gz_movement_input *input, size_t count,
			       int64_t *out_gap_ns);

/** How the odds of pursuit against fixation are weighed in the slow movement. */
struct gz_whole_odds {
	int64_t reach_us; /**< odds are the mean over so much time before and after a sample */
	int32_t limit;    /**< in the mean, none count for more than this, GZ_FOREST_UNIT */
	int32_t lead;     /**< is added to those of pursuit first, GZ_FOREST_UNIT */
	double share;     /**< how much of what the share of pursuit says counts, 0 to 1 */
};

/** What gz_whole_label() uses. Chosen on recordings that the forest did not learn from
 *  (docs/gaze-pipeline.md). */
extern const struct gz_whole_odds gz_whole_preset_odds;

/**
 * Weigh fixation against pursuit with more of the recording in view than a sample's own scores.
 *
 * The odds move to the share of pursuit that the recording seems to have: in front of one scene
 * there is much to follow and in front of another nothing. Bayes' rule with a share that is found
 * by expectation maximisation (Saerens, Latinne and Decaestecker, "Adjusting the outputs of a
 * classifier to new a priori probabilities", Neural Computation 14, 2002). Then each sample gets
 * the mean of the odds around it, across saccades: people label pursuit by whole stretches. The
 * better one of fixation and pursuit stays as likely as it is against the other classes.
 *
 * @param input   @p count samples, each newer than the last; places are not read
 * @retval GZ_ERR_NO_MEM  no memory; the scores are unchanged
 */
enum gz_result gz_whole_weigh(const struct gz_movement_input *input, size_t count,
			      const struct gz_whole_odds *odds,
			      int32_t (*scores)[GZ_FOREST_CLASSES]);

/**
 * Label all samples: features, scores, the odds of pursuit and the best sequence. Parameters and
 * results as gz_whole_features() and gz_whole_decode().
 */
enum gz_result gz_whole_label(const struct gz_display *display,
			      const struct gz_movement_input *input, size_t count,
			      uint8_t *out_class);

#endif
