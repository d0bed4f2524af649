/**
 * @file
 * The page of a comparison of techniques: comparison.html, filled.
 */
#ifndef GZ_BENCH_REPORT_COMPARISON_PAGE_H
#define GZ_BENCH_REPORT_COMPARISON_PAGE_H

#include "base/text.h"
#include "bench/comparison/comparison.h"
#include "bench/report/charts.h"

/** Append the page. failed is set without memory. @p charts are drawn, or not available. */
void gz_comparison_page_write(const struct gz_comparison *comparison,
			      const struct gz_charts *charts, struct gz_text *out);

#endif
