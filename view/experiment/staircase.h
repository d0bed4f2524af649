/**
 * @file
 * The staircase of a condition: a scene key that varies from trial to trial as QUEST (quest.h) asks
 * for. It depends on the answers alone, so that it is the same when a session is continued.
 */
#ifndef GZ_VIEW_EXPERIMENT_STAIRCASE_H
#define GZ_VIEW_EXPERIMENT_STAIRCASE_H

#include <stdbool.h>

#include "view/experiment/experiment.h"
#include "view/experiment/quest.h"

/** A staircase. */
struct gz_staircase {
	/** The key and its value in the present trial; among the settings of its alternatives. */
	struct gz_experiment_setting setting;
	double stop_sd; /**< it is finished at such an sd of the threshold, decades; 0: never */
	struct gz_quest quest;
};

/** Set the value for the next trial. NULL: nothing happens. */
void gz_staircase_place(struct gz_staircase *staircase);

/** Take the answer to the present value, as the file of answers has it. NULL: nothing happens. */
void gz_staircase_take(struct gz_staircase *staircase, bool right);

/** Whether it needs no more trials. NULL: false. */
bool gz_staircase_finished(const struct gz_staircase *staircase);

/** Set the value to one end of the range, for checks. @param end 0 or 1 */
void gz_staircase_go_to_end(struct gz_staircase *staircase, int end);

#endif
