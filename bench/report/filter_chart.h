/**
 * @file
 * The chart of jitter over lag: the raw signal, the 1 euro filter and the pipeline.
 */
#ifndef GZ_BENCH_REPORT_FILTER_CHART_H
#define GZ_BENCH_REPORT_FILTER_CHART_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/filter/stillness.h"

/**
 * Draw FOLDER/jitter-over-lag.svg and .png. Lags beyond 40 ms, ten samples and what the pipeline
 * takes are cut off, and so is more jitter than 1.2 of the raw signal's: such a filter is of no
 * use.
 *
 * @param interval_ms     time between samples, ms; above 0
 * @param folder          is there
 * @param[out] out_drawn  false without gnuplot, which a warning says
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_filter_chart_draw(const struct gz_sweep *pipeline,
				    const struct gz_sweep *one_euro, double interval_ms,
				    const char *folder, const struct gz_log *log, bool *out_drawn);

#endif
