/**
 * @file
 * Parts of gz_page_write(). For bench/report/page.c alone.
 */
#ifndef GZ_BENCH_REPORT_PAGE_PARTS_H
#define GZ_BENCH_REPORT_PAGE_PARTS_H

#include "bench/report/page.h"

/** A chart as a figure; nothing if it was not drawn. @p caption is text, and the picture's
 *  alternative too; @p class_name is a name of report.css. */
void gz_page_figure(const struct gz_charts *charts, const char *name, const char *class_name,
		    const char *caption, struct gz_text *out);

/** Gain and error of each variant. */
void gz_page_gain_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out);

/** All measures of error against one reference; nothing where it was not measured. */
void gz_page_error_table(const struct gz_summary *summary, const struct gz_group *group,
			 enum gz_error_reference reference, struct gz_text *out);

/** Distributions of frame times. */
void gz_page_time_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out);

/** What Bauer's table 5.1 shows. */
void gz_page_cast_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out);

/** Time at equal error, and error at equal time. */
void gz_page_equal_tables(const struct gz_summary *summary, const struct gz_group *group,
			  struct gz_text *out);

/** Exponents of growth; nothing without any. */
void gz_page_growth_table(const struct gz_summary *summary, struct gz_text *out);

/** What it ran on, and the command that makes it. */
void gz_page_origin(const struct gz_summary *summary, struct gz_text *out);

#endif
