/**
 * @file
 * The columns of a file of answers; for the files that implement answers.h.
 */
#ifndef GZ_VIEW_EXPERIMENT_ANSWER_COLUMNS_H
#define GZ_VIEW_EXPERIMENT_ANSWER_COLUMNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "view/experiment/run.h"

/** Room for a cell. */
#define GZ_ANSWER_CELL_SIZE 4096

/** What a row is made of. */
struct gz_answer_row {
	const struct gz_experiment *experiment;
	const char *participant, *session;
	int run;                              /**< from 1: how often the file was gone on with */
	int64_t start_ns;                     /**< of the run */
	const struct gz_trial_result *result; /**< for identity columns only index, presentation */
};

/** One column. */
struct gz_answer_column {
	const char *name;
	const char *help;   /**< a sentence */
	const char *units;  /**< NULL: none */
	const char *levels; /**< "a: what it means | b: …"; NULL: any */
	bool identity;      /**< known beforehand: a file that is gone on with must have the same */
	/** Its text, without tabs and line breaks; "n/a" where there is none. */
	void (*print)(const struct gz_answer_row *row, char *text, size_t size);
};

extern const struct gz_answer_column gz_answer_columns[];
extern const size_t gz_answer_column_count;

/** Write what the columns are, as JSON. @retval GZ_ERR_IO, GZ_ERR_NO_MEM  not logged */
enum gz_result gz_answer_columns_write(const char *path, const struct gz_experiment *experiment,
				       const char *version);

#endif
