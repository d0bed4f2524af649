/**
 * @file
 * The columns of a file of answers. Used by answers.c.
 */
#ifndef GZ_VIEW_EXPERIMENT_ANSWER_COLUMNS_H
#define GZ_VIEW_EXPERIMENT_ANSWER_COLUMNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "view/experiment/run.h"

/** Size of a cell's text with its NUL, bytes. */
#define GZ_ANSWER_CELL_SIZE 4096

/** The data of a row. */
struct gz_answer_row {
	const struct gz_experiment *experiment;
	const char *participant, *session;
	int run;          /**< which run of the session, from 1 */
	int64_t start_ns; /**< start of the run, host time */
	const struct gz_trial_result
		*result; /**< identity columns use index and presentation only */
};

/** One column. */
struct gz_answer_column {
	const char *name;
	const char *help;   /**< description, one sentence */
	const char *units;  /**< unit; NULL: none */
	const char *levels; /**< values, "a: meaning | b: …"; NULL: any */
	bool identity;      /**< known in advance: must match when a file is continued */
	/** Print the cell, without tabs and line breaks; "n/a" if there is no value. */
	void (*print)(const struct gz_answer_row *row, char *text, size_t size);
};

extern const struct gz_answer_column gz_answer_columns[];
extern const size_t gz_answer_column_count;

/**
 * Write the description of the columns as JSON.
 *
 * @retval GZ_ERR_IO      the file cannot be written; not logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_answer_columns_write(const char *path, const struct gz_experiment *experiment,
				       const char *version);

#endif
