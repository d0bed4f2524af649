/**
 * @file
 * Parts of gz_study_charts_draw(). For bench/report/study_charts.c alone.
 */
#ifndef GZ_BENCH_REPORT_CHART_PARTS_H
#define GZ_BENCH_REPORT_CHART_PARTS_H

#include "bench/report/charts.h"
#include "bench/report/summary.h"

/** Draw the boxes of a group's frame times. Errors as gz_study_charts_draw(). */
enum gz_result gz_boxes_draw(const struct gz_summary *summary, const struct gz_group *group,
			     struct gz_charts *charts);

/** Draw the maps of time and of error over the gaze of a group's series. Errors as
 *  gz_study_charts_draw(). */
enum gz_result gz_maps_draw(const struct gz_summary *summary, const struct gz_group *group,
			    struct gz_charts *charts);

#endif
