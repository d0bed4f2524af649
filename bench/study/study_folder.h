/**
 * @file
 * The folder of a study:
 *
 *   study.json  what was asked, what it ran on, whether it is complete
 *   frames.csv  one line a row under one line of names; texts instead of places in lists
 *
 * docs/gazebench.md describes both for scripts. Reports add their own files beside them.
 */
#ifndef GZ_BENCH_STUDY_STUDY_FOLDER_H
#define GZ_BENCH_STUDY_STUDY_FOLDER_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/**
 * Read a study from its folder. One that was interrupted is read as far as it goes: the lines of
 * the last unit, where they are not all there, do not count, and complete is false.
 *
 * @param[out] out_study  the caller frees it with gz_study_free()
 * @retval GZ_ERR_NOT_FOUND  no such folder, or no study in it; logged
 * @retval GZ_ERR_FORMAT     not a study of this version, or damaged; logged with file:line
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_read(const char *folder, const struct gz_log *log,
			     struct gz_study *out_study);

#endif
