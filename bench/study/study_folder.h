/**
 * @file
 * The folder of a study:
 *
 *   study.json  what was asked, what it ran on, whether it is complete
 *   frames.csv  one line a row under one line of names; texts instead of places in lists
 *
 * docs/gazebench.md describes both for scripts. Reports add their own files.
 */
#ifndef GZ_BENCH_STUDY_STUDY_FOLDER_H
#define GZ_BENCH_STUDY_STUDY_FOLDER_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/**
 * Read a study from its folder. An interrupted study is read up to its last complete unit, and
 * complete is false.
 *
 * @param[out] out_study  the caller frees it with gz_study_free()
 * @retval GZ_ERR_NOT_FOUND  no such folder, or no study in it; logged
 * @retval GZ_ERR_FORMAT     not a study of this version, or damaged; logged with file:line
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_read(const char *folder, const struct gz_log *log,
			     struct gz_study *out_study);

/**
 * Write a study with all its rows into a folder, which is created if missing.
 *
 * @retval GZ_ERR_BUSY  the folder is there and not empty; logged
 * @retval GZ_ERR_FULL  no room on the disk; logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_write(const char *folder, const struct gz_study *study,
			      const struct gz_log *log);

/**
 * Quick check whether a study may be written into a folder: it does not exist, is empty, or holds a
 * study.
 *
 * @retval GZ_ERR_BUSY  it holds something else; logged
 */
enum gz_result gz_study_folder_check(const char *folder, const struct gz_log *log);

/** Writes the folder of a study unit by unit: if the process is killed, complete units survive and
 *  the study can be resumed. */
struct gz_study_writer;

/**
 * Begin a folder, created if missing, or resume a study of the same request.
 *
 * @param study  the request; borrowed until the writer is destroyed; its rows are ignored
 * @param[out] out_writer  owned by the caller: gz_study_writer_destroy()
 * @param[out] out_done    units of the shard that are already complete, the first ones
 * @retval GZ_ERR_INVAL   it holds a study of another request; logged with the difference
 * @retval GZ_ERR_BUSY    the folder holds something that is no study, or another program writes
 *                        it; logged
 * @retval GZ_ERR_FORMAT  the study in it is damaged; logged with file:line
 * @retval GZ_ERR_FULL    no room on the disk; logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_writer_open(const char *folder, const struct gz_study *study,
				    const struct gz_log *log, struct gz_study_writer **out_writer,
				    size_t *out_done);

/**
 * Add the rows of the shard's next unit; on the disk when this returns.
 *
 * @param rows  gz_study_unit_rows() of them, in order
 * @retval GZ_ERR_FULL  no room on the disk; logged; the folder is as it was before the call
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged; as it was
 */
enum gz_result gz_study_writer_add(struct gz_study_writer *writer, const struct gz_study_row *rows);

/** Mark the study as complete. Errors as of gz_study_writer_add(). */
enum gz_result gz_study_writer_finish(struct gz_study_writer *writer);

/** Close the files and set to NULL. Accepts a pointer to NULL. */
void gz_study_writer_destroy(struct gz_study_writer **writer);

#endif
