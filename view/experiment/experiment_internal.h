/**
 * @file
 * Shared by the files of this folder: building an experiment, and the columns of its answers.
 */
#ifndef GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H
#define GZ_VIEW_EXPERIMENT_EXPERIMENT_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "view/experiment/answers.h"
#include "view/experiment/experiment.h"
#include "view/experiment/run.h"

/** Whether @p text is one or more ASCII letters and digits, like a BIDS label. */
bool gz_experiment_is_word(const char *text);

/** Whether @p text is a name of a trial, block or answer: ASCII letters, digits and _ . + -,
 * shorter than GZ_EXPERIMENT_LABEL_SIZE bytes. */
bool gz_experiment_is_label(const char *text);

/**
 * Build the blocks and conditions from the sections and check values against each other.
 *
 * @retval GZ_ERR_FORMAT  inconsistent; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_experiment_resolve(struct gz_experiment *experiment, const struct gz_log *log);

/** Read the text files that the experiment names and add them to its fingerprint. Results as for
 * gz_experiment_parse(). */
enum gz_result gz_experiment_read_texts(struct gz_experiment *experiment, const struct gz_log *log);

/** Find the setting of @p key for @p alternative (0, 1, or -1: both) in a section; NULL: none. */
const struct gz_experiment_setting *gz_experiment_find_setting(
	const struct gz_experiment_section *section, const char *key, int alternative);

/** Add bytes to a hash: 64-bit FNV-1a (Fowler, Noll and Vo; IETF draft-eastlake-fnv). */
uint64_t gz_experiment_hash(uint64_t hash, const void *bytes, size_t size);

/** Start value for gz_experiment_hash(). */
#define GZ_EXPERIMENT_HASH_START UINT64_C(0xcbf29ce484222325)

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
	const char *gaze_source;
	const char *version;                        /**< of gazeview */
	const struct gz_trial_equipment *equipment; /**< identity columns do not use it */
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
