/**
 * @file
 * The plot of a transfer function: a histogram, the opacity curve over it, a band of colours under
 * it, and the control points. On a canvas of panels/widgets.h.
 */
#ifndef GZ_VIEW_PANELS_TRANSFER_PLOT_H
#define GZ_VIEW_PANELS_TRANSFER_PLOT_H

#include <stdbool.h>
#include <stddef.h>

#include "render/transfer/histogram.h"
#include "render/transfer/transfer.h"
#include "view/panels/widgets.h"

/** Height of the canvas, unscaled. */
#define GZ_TRANSFER_PLOT_HEIGHT 224.0f

/** The layout of the plot. A value is 0 to 1 within the function's range, less or more beyond it.
 */
struct gz_transfer_plot {
	struct gz_place corner, opposite; /**< of the curve's area */
	struct gz_place band[2];          /**< corners of the band of colours */
	double range[2];                  /**< data values of 0 and 1 */
	double shown[2];                  /**< data values at the left and right edge */
	bool opacity_logarithmic;         /**< see gz_transfer_axis_of() */
	bool counts_logarithmic;
	size_t selected; /**< index of a point; GZ_TRANSFER_EDIT_NONE: none */
};

/** Set the areas for a canvas; the other fields stay. */
void gz_transfer_plot_lay_out(struct gz_transfer_plot *plot, const struct gz_canvas *canvas);

/** The value at a column. */
double gz_transfer_plot_value(const struct gz_transfer_plot *plot, float x);

/** The column of a value. */
float gz_transfer_plot_x(const struct gz_transfer_plot *plot, double value);

/** The opacity at a row, within 0 to 1. */
double gz_transfer_plot_opacity(const struct gz_transfer_plot *plot, float y);

/** The row of an opacity. */
float gz_transfer_plot_y(const struct gz_transfer_plot *plot, double opacity);

/**
 * Draw the plot.
 *
 * @param histogram  NULL: there is none yet
 * @param note       a line under the plot; NULL: none
 */
void gz_transfer_plot_draw(const struct gz_transfer_plot *plot, const struct gz_transfer *transfer,
			   const struct gz_histogram *histogram, const char *note);

#endif
