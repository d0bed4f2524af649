/**
 * @file
 * Transfer functions: data value to colour and opacity per voxel length, by control points.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_H
#define GZ_RENDER_TRANSFER_TRANSFER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"

#define GZ_TRANSFER_POINTS_MAX 256

enum gz_transfer_interpolation {
	GZ_TRANSFER_LINEAR,
	GZ_TRANSFER_QUADRATIC, /**< eases in and out of each point: the weight is a smoothstep made
				  of two parabolas */
};

/** One control point; all in [0, 1]. */
struct gz_transfer_point {
	double value;
	double rgb[3];
	double opacity; /**< per voxel length */
};

/** Points in rising order of value; clamped beyond the ends. */
struct gz_transfer {
	size_t count; /**< 1 to GZ_TRANSFER_POINTS_MAX */
	struct gz_transfer_point points[GZ_TRANSFER_POINTS_MAX];
	enum gz_transfer_interpolation interpolation;
	bool has_range;  /**< else the volume's minimum and maximum are 0 and 1 */
	double range[2]; /**< the data values that 0 and 1 stand for */
};

/** Whether both stand at one value, with one colour and opacity. */
bool gz_transfer_point_same(const struct gz_transfer_point *a, const struct gz_transfer_point *b);

/** Whether both are one function: the same points, interpolation and range. */
bool gz_transfer_same(const struct gz_transfer *a, const struct gz_transfer *b);

/** Read a .tf file: lines "value r g b a", "range LO HI", "interpolation linear|quadratic", '#'
 *  comments. GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT (NaN, out of [0, 1], values not rising, no
 *  point, unknown word): logged with file:line and what is allowed. */
enum gz_result gz_transfer_load(const char *path, const struct gz_log *log,
				struct gz_transfer *out_transfer);

/** As gz_transfer_load() over text in memory; @p name stands for the file in messages. */
enum gz_result gz_transfer_parse(const char *name, const char *text, size_t size,
				 const struct gz_log *log, struct gz_transfer *out_transfer);

/** Append the text of a .tf file, which gz_transfer_parse() reads back to the same bits. */
void gz_transfer_print(const struct gz_transfer *transfer, struct gz_text *text);

/** Write a .tf file, whole or not at all. GZ_ERR_INVAL: it has no point or more than
 *  GZ_TRANSFER_POINTS_MAX, or what gz_transfer_parse() would refuse; GZ_ERR_IO, GZ_ERR_NO_MEM;
 *  logged. */
enum gz_result gz_transfer_write(const struct gz_transfer *transfer, const char *path,
				 const struct gz_log *log);

/** Colour and opacity at @p value in [0, 1] (clamped). Two points of one value make a step. */
void gz_transfer_evaluate(const struct gz_transfer *transfer, double value, double out_rgba[4]);

/** Opacity over @p length voxel lengths: 1 - (1 - opacity)^length (docs/units.md). */
double gz_transfer_opacity_over(double opacity, double length);

#endif
