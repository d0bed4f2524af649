/**
 * @file
 * The list of participants beside the answers, as BIDS has it (Brain Imaging Data Structure,
 * "Participants file"): participants.tsv, one row a participant, and participants.json, which
 * describes its columns. Columns and rows that someone added are kept.
 */
#ifndef GZ_VIEW_EXPERIMENT_PARTICIPANTS_H
#define GZ_VIEW_EXPERIMENT_PARTICIPANTS_H

#include "base/log.h"
#include "base/result.h"

/** Size of notes with their NUL, bytes. */
#define GZ_NOTES_SIZE 512

/** Who took part. Texts are borrowed. */
struct gz_participant {
	const char *label;   /**< letters and digits, without "sub-" */
	const char *session; /**< may be empty */
	const char *notes;   /**< without tabs and line breaks; may be empty */
};

/**
 * List a participant in the files of @p folder, which are made if they are missing. Notes are added
 * to the column notes, behind those of other sessions, unless they are there. participants.json is
 * not changed if it is there. Programs that do this at the same time wait for each other.
 *
 * @retval GZ_ERR_FORMAT  participants.tsv has no column participant_id in front, or a row with
 *                        another number of cells; logged, and it is left as it is
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_participants_list(const char *folder, const struct gz_participant *participant,
				    const struct gz_log *log);

#endif
