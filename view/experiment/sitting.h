/**
 * @file
 * One sitting of a participant, as the command line names it: the experiment, checked, its order,
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

/** What the command line says of an experiment. */
struct gz_sitting_options {
	char file[GZ_PATH_SIZE]; /**< empty: none is asked for */
	char participant[GZ_PARTICIPANT_SIZE];
	char session[GZ_PARTICIPANT_SIZE];
	char answers[GZ_PATH_SIZE]; /**< folder or file */
	bool resume;
};

/** Table over struct gz_sitting_options. */
extern const struct gz_option gz_sitting_option_table[];
extern const size_t gz_sitting_option_count;

/** Check what needs no file. @retval GZ_ERR_INVAL  refused; logged */
enum gz_result gz_sitting_options_check(const struct gz_sitting_options *options,
					const struct gz_log *log);

/** A sitting. */
struct gz_sitting {
	const struct gz_sitting_options *options;
	struct gz_experiment experiment;
	struct gz_sequence sequence;
	struct gz_answers *answers; /**< NULL where none are asked for */
};

/**
 * Read the experiment, check that all it names is there, and draw its order.
 *
 * @param options       borrowed, outlives the sitting
 * @param with_answers  make the file of answers, or go on with it
 * @param version       of the program; borrowed likewise
 * @param log           borrowed likewise
 * @param[out] out_sitting  the caller closes it with gz_sitting_close()
 * @return what gz_experiment_load(), gz_experiment_check(), gz_sequence_make() and
 *         gz_answers_open() return; logged
 */
enum gz_result gz_sitting_open(const struct gz_sitting_options *options, bool with_answers,
			       const char *version, const struct gz_log *log,
			       struct gz_sitting **out_sitting);

/** Print the trials in their order, a line each, and how long they take without the answers. */
void gz_sitting_print(const struct gz_sitting *sitting, FILE *out);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_sitting_close(struct gz_sitting **sitting);

#endif
