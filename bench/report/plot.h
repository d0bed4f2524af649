/**
 * @file
 * A chart of curves whose points are labelled where they are: error over time, time over what
 * grows.
 */
#ifndef GZ_BENCH_REPORT_PLOT_H
#define GZ_BENCH_REPORT_PLOT_H

#include <stdbool.h>
#include <stddef.h>
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
	double first, last; /**< ends; set when the plot is drawn */
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
	char title[2 * GZ_PLOT_LABEL_SIZE]; /**< above the chart: what y shows */
	struct gz_plot_axis x, y;           /**< titles say by themselves if they are logarithmic
					     *   or reversed */
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

/** A rectangle of the canvas, px, y down. */
struct gz_box {
	double left, top, right, bottom;
};

/** Labels placed on a canvas so far. Zero-initialised but for @p area is empty. */
struct gz_label_field {
	struct gz_box area; /**< labels stay inside */
	struct gz_box *taken;
	double *weights; /**< how bad it is to lie on it */
	size_t count, room;
};

/** Cost of lying on something. */
#define GZ_LABEL_ON_LINE  1.0
#define GZ_LABEL_ON_POINT 6.0
#define GZ_LABEL_ON_LABEL 40.0

/** Keep labels off a rectangle. Without memory it is forgotten. */
void gz_labels_avoid(struct gz_label_field *field, struct gz_box box, double weight);

/** Keep labels off a line. */
void gz_labels_avoid_line(struct gz_label_field *field, double x0, double y0, double x1, double y1);

/** A label at a point, px. */
struct gz_label {
	double x, y;          /**< the point */
	double width, height; /**< of the label */
	bool must;            /**< place it whatever it lies on */
	/** Set by gz_labels_place(): its centre, or the middle of the edge that is next to the
	 * point, so that no guess of its width parts them. */
	double anchor_x, anchor_y;
	int side; /**< likewise: 0 centre, 1 left edge (it is right of the point), -1 right edge */
};

/** Find the best of the places around a point for a label and take it. False where it would lie on
 *  another label or outside, and need not be placed. */
bool gz_labels_place(struct gz_label_field *field, struct gz_label *label);

/** Free what it holds and zero it. */
void gz_labels_free(struct gz_label_field *field);

#endif
