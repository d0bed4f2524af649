/**
 * @file
 * The report as a page: one HTML file that holds everything and asks nobody for anything.
 */
#ifndef GZ_BENCH_REPORT_PAGE_H
#define GZ_BENCH_REPORT_PAGE_H

#include "bench/report/charts.h"
#include "bench/report/summary.h"
#include "bench/report/text.h"

/** Write the whole page to @p out, with those charts that were drawn. */
void gz_page_write(const struct gz_summary *summary, const struct gz_charts *charts,
		   struct gz_text *out);

#endif
