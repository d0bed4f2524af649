/**
 * @file
 * Answers of experiments, gathered from the tables that gazeview writes (docs/experiments.md): one
 * group a trial, or a scene, over all participants and sessions that are given.
 */
#ifndef GZ_BENCH_ANSWERS_ANSWER_TABLE_H
#define GZ_BENCH_ANSWERS_ANSWER_TABLE_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/answers/psychometric.h"

/** Size of names with their NUL, bytes. */
#define GZ_ANSWER_NAME_SIZE 128

/** Answers of one kind. */
struct gz_answer_group {
	char name[GZ_ANSWER_NAME_SIZE];
	char key[GZ_ANSWER_NAME_SIZE]; /**< scene key that varied; empty: none */
	int trials, right;             /**< trials with a correct answer that counts */
	double *times_s;               /**< response times, in the order of the files */
	size_t time_count;
	struct gz_value_count *counts; /**< by value of the key, ascending */
	size_t count_count;
};

/** All groups, in the order in which they first occur. */
struct gz_answer_table {
	struct gz_answer_group *groups;
	size_t group_count;
	int practice, late, unjudged; /**< trials that do not count, and why */
};

/**
 * Add the rows of a file. Practice, answers too late, and trials without a correct answer do not
 * count.
 *
 * @param key  scene key whose values are looked for in what the intervals showed; groups are scenes
 *             then. Empty: groups are trials, and values those of their staircases
 * @retval GZ_ERR_FORMAT  not a table of answers; logged with its line
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_answer_table_add(struct gz_answer_table *table, const char *path, const char *key,
				   const struct gz_log *log);

/** Median response time, s; NaN without one. Sorts the group's times. */
double gz_answer_group_median_s(struct gz_answer_group *group);

/** Free what it holds and zero it. */
void gz_answer_table_free(struct gz_answer_table *table);

#endif
