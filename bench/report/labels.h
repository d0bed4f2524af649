/**
 * @file
 * Where labels go so that they can be read: beside their points, off each other and off curves.
 */
#ifndef GZ_BENCH_REPORT_LABELS_H
#define GZ_BENCH_REPORT_LABELS_H

#include <stdbool.h>
#include <stddef.h>

/** A rectangle of the canvas, px, y down. */
struct gz_box {
	double left, top, right, bottom;
};

/** What has been placed on a canvas so far. Zero-initialised but for @p area is empty. */
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

/**
 * Find the best of the places around a point for a label and take it.
 *
 * @param width, height  of the label, px
 * @param must           place it whatever it lies on
 * @param[out] out_x, out_y  of its anchor: its centre, or the middle of the edge that is next to
 * the point, so that no guess of its width parts them
 * @param[out] out_side      which: 0 centre, 1 left edge (it is right of the point), -1 right edge
 * @return false where it would lie on another label or outside, and @p must is false
 */
bool gz_labels_place(struct gz_label_field *field, double x, double y, double width, double height,
		     bool must, double *out_x, double *out_y, int *out_side);

/** Free what it holds and zero it. */
void gz_labels_free(struct gz_label_field *field);

#endif
