/**
 * @file
 * Qualities in JOD that somebody has entered from runs of a metric that others have published, such
 * as FovVideoVDP: 10 is no visible difference from the reference, and of two that are 1 apart three
 * of four people prefer the better one.
 *
 * A table of comma-separated values. Its first line is "scene,method,jod,how". The scene is a name
 * of the study, the method a variant as given to gazebench run, and how says by what the value was
 * measured: metric, version, frames. Empty lines and lines that begin with # are left out.
 */
#ifndef GZ_BENCH_REPORT_JOD_TABLE_H
#define GZ_BENCH_REPORT_JOD_TABLE_H

#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "bench/study/study.h"

/** One value. */
struct gz_jod_value {
	char scene[GZ_STUDY_TEXT_SIZE], method[GZ_STUDY_TEXT_SIZE], how[GZ_STUDY_TEXT_SIZE];
	double jod; /**< at most 10 */
};

/** A table. Zero-initialised is empty. */
struct gz_jod_table {
	char path[GZ_PATH_SIZE];
	struct gz_jod_value *values;
	size_t count;
};

/**
 * Read a table. Values of scenes or methods that the study does not have are read, with a warning.
 *
 * @param[out] out_table  the caller's: gz_jod_table_free()
 * @retval GZ_ERR_FORMAT  a line is none, or says what another one has said; logged with its number
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_jod_table_read(const char *path, const struct gz_study *study,
				 const struct gz_log *log, struct gz_jod_table *out_table);

/** The value of a scene and a method; NULL if there is none, also for @p table NULL. */
const struct gz_jod_value *gz_jod_table_find(const struct gz_jod_table *table, const char *scene,
					     const char *method);

/** Free what it holds and zero it. */
void gz_jod_table_free(struct gz_jod_table *table);

#endif
