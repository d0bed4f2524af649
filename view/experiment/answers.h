/**
 * @file
 * The participant's answers on disk: tab-separated values, one row per trial, in the form of a BIDS
 * events file (Brain Imaging Data Structure, "Task events"), and beside it a JSON file that
 * describes the columns. Each row is on the disk before the next trial begins.
 */
#ifndef GZ_VIEW_EXPERIMENT_ANSWERS_H
#define GZ_VIEW_EXPERIMENT_ANSWERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "view/experiment/run.h"

/** Size of the label of a participant or session, with its NUL, bytes. */
#define GZ_PARTICIPANT_SIZE 32

/** Whose answers to write, and where. */
struct gz_answers_request {
	const char *place; /**< a folder, or a file that ends in ".tsv" */
	const char *participant;
	const char *session; /**< may be empty */
	const char *notes;   /**< for the list of participants; may be empty */
	bool resume;         /**< continue an existing file; its staircases take the answers */
	const char *version; /**< of the program */
	/** Where the gaze comes from: "daemon", "mouse", "pointer", "fixed" or "log". A file is not
	 *  continued with another one. */
	const char *gaze_source;
};

/** What a trial was shown with. Texts are borrowed; NULL: not known. */
struct gz_trial_equipment {
	const char *tracker;        /**< its name, as the daemon has it */
	const char *tracker_serial; /**< empty: it has none */
	const char *daemon_version;
	const char *backend;
	struct gz_display display; /**< the pictures filled it */
};

/** A file of answers being written. */
struct gz_answers;

/** Whether @p label has only letters and digits, like a BIDS label, and is short enough. */
bool gz_answers_label_valid(const char *label);

/** The path of the file; in a folder its name is "sub-07_ses-1_task-NAME_events.tsv".
 * GZ_ERR_FULL: the path is too long. */
enum gz_result gz_answers_path(const struct gz_experiment *experiment,
			       const struct gz_answers_request *request, char *path, size_t size);

/**
 * Create the file or continue it, and write the description of its columns beside it.
 *
 * @param experiment, sequence  borrowed, outlive the answers
 * @param request               copied; its texts are borrowed and outlive the answers
 * @param log                   borrowed, outlives the answers
 * @param[out] out_answers      the caller closes it with gz_answers_close()
 * @retval GZ_ERR_BUSY       the file exists without resume, is complete, or another program is
 *                           writing it; logged
 * @retval GZ_ERR_NOT_FOUND  no file to continue; logged
 * @retval GZ_ERR_FORMAT     the file belongs to another experiment, order, participant, version or
 *                           source of the gaze; logged with the line
 * @retval GZ_ERR_IO, GZ_ERR_FULL  the file cannot be written, or its path is too long; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_answers_open(const struct gz_experiment *experiment,
			       const struct gz_sequence *sequence,
			       const struct gz_answers_request *request, const struct gz_log *log,
			       struct gz_answers **out_answers);

/** Number of trials in the file. */
size_t gz_answers_done(const struct gz_answers *answers);

/** Index of the next trial to show; that of the sequence's end when all are answered. A staircase
 *  that is finished early leaves its last trials out. */
size_t gz_answers_next(const struct gz_answers *answers);

/** Path of the file. */
const char *gz_answers_file(const struct gz_answers *answers);

/**
 * Add the row of a trial. It is on the disk when this returns.
 *
 * With the first row the participant is listed in participants.tsv (participants.h), if the answers
 * have a folder. A list that cannot be written is logged and not an error.
 *
 * @param start_ns   host time that onsets are relative to
 * @param equipment  what it was shown with
 * @retval GZ_ERR_IO      the row could not be written; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_answers_write(struct gz_answers *answers, const struct gz_trial_result *result,
				int64_t start_ns, const struct gz_trial_equipment *equipment);

/** Close the file and set the pointer to NULL. A file without rows is removed. Accepts a pointer to
 * NULL. */
void gz_answers_close(struct gz_answers **answers);

#endif
