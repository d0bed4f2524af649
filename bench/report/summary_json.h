/**
 * @file
 * A summary as JSON; docs/gazebench.md describes it for scripts.
 */
#ifndef GZ_BENCH_REPORT_SUMMARY_JSON_H
#define GZ_BENCH_REPORT_SUMMARY_JSON_H

#include <jansson.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/report/summary.h"

/** Format name and version in the file. */
#define GZ_SUMMARY_FORMAT  "gazecast summary"
#define GZ_SUMMARY_VERSION 1

/** Foveal FLIP up to which methods count as equal: docs/gazebench.md. */
#define GZ_EQUAL_FOVEAL_FLIP 0.02

/** Shares of standard's time at which errors are compared. */
#define GZ_EQUAL_TIMES 4
extern const double gz_equal_time_shares[GZ_EQUAL_TIMES];

/** The whole summary: the caller's, json_decref(). A value that was not measured is null, an
 * infinite PSNR the text "inf". NULL if memory runs out. */
json_t *gz_summary_to_json(const struct gz_summary *summary);

/**
 * Write JSON to a file through a temporary name, so that an existing file is replaced completely or
 * stays.
 *
 * @retval GZ_ERR_IO  logged
 */
enum gz_result gz_json_write(const json_t *json, const char *path, const struct gz_log *log);

#endif
