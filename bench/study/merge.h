/**
 * @file
 * Joining the shards of a study.
 */
#ifndef GZ_BENCH_STUDY_MERGE_H
#define GZ_BENCH_STUDY_MERGE_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/**
 * Read the folders of all shards of a study, in any order, and join them: the study that one run
 * would have made, but for its times. Where they ran on several machines, all are named.
 *
 * @param folders  @p count of them
 * @param[out] out_study  complete; the caller's: gz_study_free()
 * @retval GZ_ERR_INVAL  shards of different studies, commits or scenes; one doubled, missing or
 *                       incomplete; logged with the folder
 * @return else what gz_study_read() returns; logged
 */
enum gz_result gz_study_merge(const char *const *folders, size_t count, const struct gz_log *log,
			      struct gz_study *out_study);

#endif
