/**
 * @file
 * The report of a study: summary.json, charts, and report.html, one page that holds everything and
 * loads nothing from elsewhere.
 */
#ifndef GZ_BENCH_REPORT_REPORT_H
#define GZ_BENCH_REPORT_REPORT_H

#include "base/log.h"
#include "base/result.h"
#include "bench/report/charts.h"
#include "bench/report/crops.h"
#include "bench/report/summary.h"

/**
 * Write the report of a summary into a folder that is there. Files of an earlier report are
 * replaced. Without gnuplot, a warning, and all but the charts.
 *
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged; what was written before stays
 */
enum gz_result gz_report_write(const struct gz_summary *summary, const char *folder,
			       const struct gz_log *log);

/** Append the whole page to @p out, with those charts that were drawn and those crops that were
 *  made; NULL for none. Sets failed where memory runs out. */
void gz_page_write(const struct gz_summary *summary, const struct gz_charts *charts,
		   const struct gz_crops *crops, struct gz_text *out);

#endif
