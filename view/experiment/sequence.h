/**
 * @file
 * The order of an experiment's trials for one participant: blocks, trials, and which alternative
 * comes first. It depends on the experiment's seed, the participant and the session only, so it can
 * be reproduced.
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
	int number;     /**< in the block, from 1 */
	bool swapped;   /**< alternative b comes first */
};

/** All presentations in order. They point into the experiment. */
struct gz_sequence {
	struct gz_presentation *presentations;
	size_t count;
};

/**
 * Draw the order.
 *
 * @param experiment            outlives the sequence
 * @param participant, session  labels; session may be empty
 * @param[out] out_sequence  the caller frees it with gz_sequence_free()
 * @retval GZ_ERR_INVAL   the experiment has no trials, or blocks rotate and @p participant is not a
 *                        number; the latter is logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_sequence_make(const struct gz_experiment *experiment, const char *participant,
				const char *session, const struct gz_log *log,
				struct gz_sequence *out_sequence);

/** The first presentation from @p index on whose staircase is not finished; the sequence's count if
 *  there is none. */
size_t gz_sequence_next(const struct gz_sequence *sequence, size_t index);

/** Free the contents and zero @p sequence. */
void gz_sequence_free(struct gz_sequence *sequence);

#endif
