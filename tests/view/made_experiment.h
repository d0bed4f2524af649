/**
 * @file
 * A small experiment for tests, and its order.
 */
#ifndef GZ_TESTS_VIEW_MADE_EXPERIMENT_H
#define GZ_TESTS_VIEW_MADE_EXPERIMENT_H

#include "suite.h"

#include <string.h>

#include "view/experiment/sequence.h"

/** An experiment with the order of one participant. */
struct made_experiment {
	struct gz_experiment experiment;
	struct gz_sequence sequence;
};

/** Read @p text, which must be valid, and draw the order of participant 07, session 1. */
static inline void make_experiment(struct made_experiment *made, const char *text)
{
	assert_int_equal(gz_experiment_parse("/place/e.experiment", text, strlen(text), NULL,
					     &made->experiment),
			 GZ_OK);
	assert_int_equal(gz_sequence_make(&made->experiment, "07", "1", NULL, &made->sequence),
			 GZ_OK);
}

static inline void free_experiment(struct made_experiment *made)
{
	gz_sequence_free(&made->sequence);
	gz_experiment_free(&made->experiment);
}

#endif
