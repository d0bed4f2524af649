/**
 * @file
 * One session of a participant as the command line asks for it: the experiment, checked, its order
 * and the file of answers.
 */
#ifndef GZ_VIEW_EXPERIMENT_SITTING_H
#define GZ_VIEW_EXPERIMENT_SITTING_H

#include <stdbool.h>
#include <stdio.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "view/experiment/answers.h"
#include "view/experiment/participants.h"

/** Options of the command line for experiments. */
struct gz_sitting_options {
	char file[GZ_PATH_SIZE]; /**< of the experiment; empty: none */
	char participant[GZ_PARTICIPANT_SIZE];
	char session[GZ_PARTICIPANT_SIZE];
	char notes[GZ_NOTES_SIZE];
	char answers[GZ_PATH_SIZE]; /**< folder or file */
	bool resume;
};

/** Table over struct gz_sitting_options. */
extern const struct gz_option gz_sitting_option_table[];
extern const size_t gz_sitting_option_count;

/** Check what needs no file. @retval GZ_ERR_INVAL  refused; logged with the remedy */
enum gz_result gz_sitting_options_check(const struct gz_sitting_options *options,
					const struct gz_log *log);

/** The program that runs a sitting, for its answers. Texts are borrowed and outlive it. */
struct gz_sitting_program {
	const char *version;
	const char *gaze_source; /**< see struct gz_answers_request */
};

/** A sitting. */
struct gz_sitting {
	const struct gz_sitting_options *options;
	struct gz_experiment experiment;
	struct gz_sequence sequence;
	struct gz_answers *answers; /**< NULL: not asked for */
};

/**
 * Read the experiment, check everything it names, and draw its order.
 *
 * @param options       borrowed, outlives the sitting
 * @param program       create the file of answers, or continue it; NULL: do not
 * @param log           borrowed, outlives the sitting
 * @param[out] out_sitting  the caller closes it with gz_sitting_close()
 * @return the results of gz_experiment_load(), gz_experiment_check(), gz_sequence_make() and
 *         gz_answers_open(); logged
 */
enum gz_result gz_sitting_open(const struct gz_sitting_options *options,
			       const struct gz_sitting_program *program, const struct gz_log *log,
			       struct gz_sitting **out_sitting);

/** Print the trials in their order, one a line, and their total time without answers and breaks. */
void gz_sitting_print(const struct gz_sitting *sitting, FILE *out);

/** Log the threshold of each staircase that has taken answers. */
void gz_sitting_log_thresholds(const struct gz_sitting *sitting, const struct gz_log *log);

/** Close the sitting and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_sitting_close(struct gz_sitting **sitting);

#endif
