/**
 * @file
 * The order of an experiment's trials for one participant: which block, which trial, which
 * alternative first. Drawn by the experiment's seed, the participant and the session alone, so that
 * it can be made again.
 */
#ifndef GZ_VIEW_EXPERIMENT_SEQUENCE_H
#define GZ_VIEW_EXPERIMENT_SEQUENCE_H

#include <stdbool.h>
#include <stddef.h>

#include "view/experiment/experiment.h"

/** One presentation of a trial. */
struct gz_presentation {
	const struct gz_block *block;
	const struct gz_condition *condition;
	int repetition; /**< of the condition in its block, from 1 */
	int number;     /**< within the block as it comes, from 1 */
	bool swapped;   /**< b comes first */
};

/** All of them, in order. Points into the experiment. */
struct gz_sequence {
	struct gz_presentation *presentations;
	size_t count;
};

/**
 * Draw the order.
 *
 * @param participant, session  labels; session may be empty
 * @param[out] out_sequence  filled; the caller frees it with gz_sequence_free()
 * @retval GZ_ERR_INVAL   nothing to order, or blocks rotate by the participant's number, and @p
 * participant is none; logged
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_sequence_make(const struct gz_experiment *experiment, const char *participant,
				const char *session, const struct gz_log *log,
				struct gz_sequence *out_sequence);

/** Free what it holds and zero it. */
void gz_sequence_free(struct gz_sequence *sequence);

#endif
