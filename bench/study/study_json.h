/**
 * @file
 * study.json: everything of a study but its rows. For bench/study/study_folder.c alone.
 */
#ifndef GZ_BENCH_STUDY_STUDY_JSON_H
#define GZ_BENCH_STUDY_STUDY_JSON_H

#include <jansson.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/** Format name in the file, and the version that this program reads and writes. */
#define GZ_STUDY_FORMAT  "gazecast study"
#define GZ_STUDY_VERSION 1

/** A study as JSON, without rows: the caller's, json_decref(). NULL where there is no memory. */
json_t *gz_study_to_json(const struct gz_study *study);

/** The same as text, each number as short as it can be without changing: the caller's, free().
 *  It also has the paths of scenes as seen from @p folder, where the study is. */
char *gz_study_to_text(const struct gz_study *study, const char *folder);

/**
 * A study of JSON, without rows. Counts are checked before they are believed. Where a scene's path
 * leads nowhere from here, but leads to a file as seen from the study's folder, it becomes that.
 *
 * @param name  path of the study's file
 * @param[out] out_study  the caller frees it with gz_study_free()
 * @retval GZ_ERR_FORMAT  another version, or something missing or out of range; logged
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_study_from_json(const json_t *json, const char *name, const struct gz_log *log,
				  struct gz_study *out_study);

#endif
