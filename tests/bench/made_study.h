/**
 * @file
 * Studies made by hand, for tests of what is computed from them.
 */
#ifndef GZ_TESTS_BENCH_MADE_STUDY_H
#define GZ_TESTS_BENCH_MADE_STUDY_H

#include "bench/study/study.h"

/** What a made study has; each list ends with NULL. */
struct made_study {
	const char *scenes[4];
	const char *variants[8]; /**< the first is "standard" */
	const char *backends[4];
	int sizes[4][2];
	int size_count;
	int points, frames;
};

/** An empty study of these lists; rows by make_rows(). The caller frees it with gz_study_free(). */
void make_study(const struct made_study *made, struct gz_study *out_study);

/** Give every row's measured values; all else of @p row is set. */
typedef void made_row(const struct gz_study *study, struct gz_study_row *row);

/** All rows, in order. */
void make_rows(struct gz_study *study, made_row *measure);

/** All errors NaN, as where nothing was measured. */
struct gz_study_errors no_errors(void);

#endif
