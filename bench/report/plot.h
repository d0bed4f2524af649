/**
 * @file
 * A chart of curves whose points are labelled where they are: error over time, time over what
 * grows.
 */
#ifndef GZ_BENCH_REPORT_PLOT_H
#define GZ_BENCH_REPORT_PLOT_H

#include <stdint.h>

#include "bench/report/charts.h"

#define GZ_PLOT_LABEL_SIZE 96 /**< bytes of a label with its NUL */

/** An axis. Values grow from its origin: the least, or the greatest where @p falls. */
struct gz_plot_axis {
	char title[GZ_PLOT_LABEL_SIZE];
	bool logarithmic;
	bool from_zero;     /**< linear: begins at 0 whatever the values */
	double name_room;   /**< logarithmic: room behind the last value for names, of the span */
	bool falls;         /**< the greatest value is at the origin */
	double first, last; /**< ends; set by gz_plot_fit() */
};

/** A point of a curve. */
struct gz_plot_point {
	double x, y;
	bool marked;                    /**< gets a ring */
	char label[GZ_PLOT_LABEL_SIZE]; /**< empty for none */
};

/** A curve: its points joined in their order. */
struct gz_plot_curve {
	char name[GZ_PLOT_LABEL_SIZE];
	uint32_t colour;
	int point_type;
	struct gz_plot_point *points;
	size_t point_count;
};

/** The chart. */
struct gz_plot {
	char title[2 * GZ_PLOT_LABEL_SIZE];
	struct gz_plot_axis x, y;
	struct gz_plot_curve *curves;
	size_t curve_count;
	bool join_marked; /**< draw a line through the marked points, by x: the front */
	double bound;     /**< x of a line from top to bottom; 0 for none */
	char bound_text[GZ_PLOT_LABEL_SIZE];
};

/** Room for @p curves curves, of no points. False without memory. */
bool gz_plot_start(struct gz_plot *plot, size_t curves);

/** Room for @p points of a curve. False without memory. */
bool gz_plot_curve_start(struct gz_plot_curve *curve, size_t points);

/** Free curves and points and zero it. */
void gz_plot_free(struct gz_plot *plot);

/**
 * Draw it on all canvases. Points that are no finite numbers, and on a logarithmic axis those not
 * above 0, are left out; without any other nothing is drawn.
 *
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_plot_draw(struct gz_charts *charts, const char *name, struct gz_plot *plot);

#endif
