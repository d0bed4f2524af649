/**
 * @file
 * Steps of gz_summary_make(). For bench/report/summary.c alone.
 */
#ifndef GZ_BENCH_REPORT_SUMMARY_PARTS_H
#define GZ_BENCH_REPORT_SUMMARY_PARTS_H

#include "bench/report/summary.h"

/** Mark the series of each front. Times and errors are there. */
void gz_group_find_fronts(struct gz_group *group);

/** Make the group's curves. GZ_ERR_NO_MEM: those made so far belong to the group. */
enum gz_result gz_group_find_curves(const struct gz_study *study, struct gz_group *group);

/** Fit how times grow wherever the study has two sizes, volumes or numbers of threads.
 *  GZ_ERR_NO_MEM: those made so far belong to the summary. */
enum gz_result gz_summary_find_scalings(struct gz_summary *summary);

#endif
