/**
 * @file
 * Transfer functions: colour and opacity per voxel length by data value, from control points.
 */
#ifndef GZ_RENDER_TRANSFER_TRANSFER_H
#define GZ_RENDER_TRANSFER_TRANSFER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "render/transfer/emphasis.h"

#define GZ_TRANSFER_POINTS_MAX 256

enum gz_transfer_interpolation {
	GZ_TRANSFER_LINEAR,
	GZ_TRANSFER_QUADRATIC, /**< flat at each point: the weight is a smoothstep of two
				  parabolas */
};

/** One control point; all in [0, 1]. */
struct gz_transfer_point {
	double value;
	double rgb[3];
	double opacity; /**< per voxel length */
};

/** A transfer function. Points are in rising order of value; outside them the first or last holds.
 */
struct gz_transfer {
	size_t count; /**< 1 to GZ_TRANSFER_POINTS_MAX */
	struct gz_transfer_point points[GZ_TRANSFER_POINTS_MAX];
	enum gz_transfer_interpolation interpolation;
	bool has_range;  /**< false: 0 and 1 stand for the volume's minimum and maximum */
	double range[2]; /**< the data values that 0 and 1 stand for */
	/** Of what is shown for a while. Files do not hold it. */
	struct gz_transfer_emphasis emphasis;
};

/** Whether two points have equal value, colour and opacity. */
bool gz_transfer_point_same(const struct gz_transfer_point *a, const struct gz_transfer_point *b);

/** Whether two functions have equal points, interpolation, range and emphasis. */
bool gz_transfer_same(const struct gz_transfer *a, const struct gz_transfer *b);

/**
 * Read a .tf file: lines "value r g b a", "range LO HI", "interpolation linear|quadratic", comments
 * after '#'; docs/scenes.md has the grammar.
 *
 * @param log                may be NULL
 * @param[out] out_transfer  written on GZ_OK
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     NaN, a number outside [0, 1], values that do not rise, no point, an
 *                           unknown word or a file above 1 MiB; logged with file, line and remedy
 * @retval GZ_ERR_NO_MEM     logged
 */
enum gz_result gz_transfer_load(const char *path, const struct gz_log *log,
				struct gz_transfer *out_transfer);

/** As gz_transfer_load(), from @p size bytes of text; messages call it @p name. */
enum gz_result gz_transfer_parse(const char *name, const char *text, size_t size,
				 const struct gz_log *log, struct gz_transfer *out_transfer);

/** Append the text of a .tf file. gz_transfer_parse() reads the same bits back. */
void gz_transfer_print(const struct gz_transfer *transfer, struct gz_text *text);

/**
 * Write a .tf file. The file is replaced as a whole or not at all.
 *
 * @retval GZ_ERR_INVAL   gz_transfer_parse() would refuse it: no point, more than
 *                        GZ_TRANSFER_POINTS_MAX, …; logged except for too many points
 * @retval GZ_ERR_IO      the file cannot be written; logged
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_transfer_write(const struct gz_transfer *transfer, const char *path,
				 const struct gz_log *log);

/** Colour and opacity at @p value, which is clamped to [0, 1]. Two points of one value make a step.
 */
void gz_transfer_evaluate(const struct gz_transfer *transfer, double value, double out_rgba[4]);

/** Whether any data value from @p least to @p greatest has an opacity above 0. */
bool gz_transfer_shows(const struct gz_transfer *transfer, double least, double greatest);

/** Opacity over @p length voxel lengths: 1 - (1 - opacity)^length (docs/units.md). */
double gz_transfer_opacity_over(double opacity, double length);

#endif
