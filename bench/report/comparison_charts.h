/**
 * @file
 * The charts of a comparison of techniques: for each scene, error over time, and times beside those
 * that others have printed.
 */
#ifndef GZ_BENCH_REPORT_COMPARISON_CHARTS_H
#define GZ_BENCH_REPORT_COMPARISON_CHARTS_H

#include "base/result.h"
#include "bench/comparison/comparison.h"
#include "bench/report/charts.h"
#include "bench/report/names.h"

/** Draw all charts. GZ_ERR_IO, GZ_ERR_NO_MEM: logged. */
enum gz_result gz_comparison_charts_draw(const struct gz_comparison *comparison,
					 struct gz_charts *charts);

/** Name of a scene's chart: @p kind is "error" or "times". */
void gz_comparison_chart_name(const struct gz_comparison *comparison, const char *kind,
			      size_t scene, char out_name[GZ_NAMES_SIZE]);

#endif
