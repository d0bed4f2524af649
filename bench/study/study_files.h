/**
 * @file
 * The files of a study's folder. For reading and writing it alone.
 */
#ifndef GZ_BENCH_STUDY_STUDY_FILES_H
#define GZ_BENCH_STUDY_STUDY_FILES_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

#define GZ_STUDY_JSON "study.json"
#define GZ_STUDY_ROWS "frames.csv"

/** "folder/name". GZ_ERR_IO where that is too long; logged. */
enum gz_result gz_study_file_path(const char *folder, const char *name, const struct gz_log *log,
				  char out_path[GZ_PATH_SIZE]);

/** Read study.json: everything but the rows. Errors as of gz_study_read(). */
enum gz_result gz_study_read_asked(const char *folder, const struct gz_log *log,
				   struct gz_study *out_study);

/**
 * Read frames.csv into a study that has been read from study.json. Errors as of gz_study_read();
 * the caller frees the study in any case.
 *
 * @param[out] out_whole_bytes  of the file, up to the end of the last whole unit; may be NULL
 */
enum gz_result gz_study_read_rows(const char *folder, const struct gz_log *log,
				  struct gz_study *study, long long *out_whole_bytes);

#endif
