/**
 * @file
 * What participants answered, on disk: a table of tab-separated values, a row a trial, as BIDS has
 * files of events (Brain Imaging Data Structure, "Task events"), and beside it a JSON file that
 * says what the columns are. A row is on the disk before the next trial begins.
 */
#ifndef GZ_VIEW_EXPERIMENT_ANSWERS_H
#define GZ_VIEW_EXPERIMENT_ANSWERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "view/experiment/run.h"

/** Most bytes of a participant's or session's label, with its NUL. */
#define GZ_PARTICIPANT_SIZE 32

/** Whose answers, and where they go. */
struct gz_answers_request {
	const char *place; /**< a folder, or the file itself, which ends in ".tsv" */
	const char *participant;
	const char *session; /**< may be empty */
	bool resume;         /**< go on with a file that is there */
	const char *version; /**< of the program, for the JSON file */
};

/** A file of answers in writing. */
struct gz_answers;

/** Whether @p label is letters and digits, as BIDS has labels, and short enough. */
bool gz_answers_label_valid(const char *label);

/** The file's path: in a folder "sub-07_ses-1_task-NAME_events.tsv". @retval GZ_ERR_FULL  too
 *  long */
enum gz_result gz_answers_path(const struct gz_experiment *experiment,
			       const struct gz_answers_request *request, char *path, size_t size);

/**
 * Make the file, or go on with it, and write what the columns are beside it.
 *
 * @param experiment, sequence  borrowed, outlive the answers, as the texts of @p request do
 * @param log                   borrowed
 * @param[out] out_answers      the caller closes it with gz_answers_close()
 * @retval GZ_ERR_BUSY       it is there, and not to be gone on with, or complete, or another
 *                           program writes it; logged
 * @retval GZ_ERR_NOT_FOUND  there is none to go on with; logged
 * @retval GZ_ERR_FORMAT     it is of another experiment, order, participant or version; logged with
 *                           its line
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM, GZ_ERR_FULL  logged but for the second
 */
enum gz_result gz_answers_open(const struct gz_experiment *experiment,
			       const struct gz_sequence *sequence,
			       const struct gz_answers_request *request, const struct gz_log *log,
			       struct gz_answers **out_answers);

/** Trials that it holds already: the index of the first that is still to come. */
size_t gz_answers_done(const struct gz_answers *answers);

/** Its path. */
const char *gz_answers_file(const struct gz_answers *answers);

/**
 * Add a trial's row; it is on the disk when this returns.
 *
 * @param start_ns  host time that onsets count from
 * @retval GZ_ERR_IO  could not be written; logged
 */
enum gz_result gz_answers_write(struct gz_answers *answers, const struct gz_trial_result *result,
				int64_t start_ns);

/** Close and set to NULL; a file without a row is removed. Accepts a pointer to NULL. */
void gz_answers_close(struct gz_answers **answers);

#endif
