/**
 * @file
 * A comparison of techniques as a folder: frames.csv, techniques.json, charts and report.html.
 */
#ifndef GZ_BENCH_REPORT_COMPARISON_REPORT_H
#define GZ_BENCH_REPORT_COMPARISON_REPORT_H

#include <jansson.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/comparison/comparison.h"
#include "bench/report/measures.h"

/** Format name in techniques.json, and its version. */
#define GZ_COMPARISON_FORMAT  "gazecast techniques"
#define GZ_COMPARISON_VERSION 1

/** A row summed up. */
struct gz_comparison_summary {
	struct gz_distribution frame_ms;
	double fps;          /**< 1000 over the mean */
	double weighted_fps; /**< 1000 over the time-weighted mean */
	double ratio;        /**< mean of standard of the same series over this mean */
};

/** Sum a row up. NaN without memory. @p row is one of the comparison's. */
struct gz_comparison_summary gz_comparison_sum(const struct gz_comparison *comparison,
					       const struct gz_comparison_row *row);

/** Everything but the frames: the caller's, json_decref(). NULL without memory. */
json_t *gz_comparison_to_json(const struct gz_comparison *comparison);

/** Print the table that people read: a line for each row, then what is missing. */
void gz_comparison_print(const struct gz_comparison *comparison, FILE *file);

/**
 * Write all files into a folder that is there.
 *
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_comparison_write(const struct gz_comparison *comparison, const char *folder,
				   const struct gz_log *log);

#endif
