/**
 * @file
 * Places a simulated viewer is drawn to: from a list, or the salient points of a picture.
 */
#ifndef GZ_SIM_TARGETS_H
#define GZ_SIM_TARGETS_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"

/** Most targets of a list. Chosen: more than anybody looks at. */
#define GZ_TARGETS_MAX 256

/** One place. */
struct gz_target {
	struct gz_point point;
	double weight; /**< how strongly it draws, above 0 */
};

/** A list of places, plain data. */
struct gz_targets {
	size_t count;
	struct gz_target target[GZ_TARGETS_MAX];
};

/**
 * Parse a target list: a line is "x y" or "x y weight", normalised, separated by blanks; "#" begins
 * a comment; x and y from -0.5 to 1.5, weight above 0 up to 1000, 1 if absent.
 *
 * @param name  stands for the file in messages
 * @param[out] out_targets  written on success only
 * @retval GZ_ERR_FORMAT  not such a list, empty, or longer than GZ_TARGETS_MAX; logged
 */
enum gz_result gz_targets_parse(const char *name, const char *text, size_t size,
				const struct gz_log *log, struct gz_targets *out_targets);

/**
 * Read a target list from a file of at most 64 KiB.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT  logged
 */
enum gz_result gz_targets_load(const char *path, const struct gz_log *log,
			       struct gz_targets *out_targets);

/**
 * Find the salient points of a picture that fills the display: peaks of centre-surround contrast of
 * its luminance, strongest first, each inhibiting its neighbourhood, after Itti, Koch and Niebur,
 * "A model of saliency-based visual attention for rapid scene analysis", IEEE PAMI 20(11), 1998
 * (intensity channel only).
 *
 * @param luminance   @p width * @p height values of any scale, rows top down
 * @param width, height  1 to 16384
 * @param[out] out_targets  at least one: a flat picture gives its centre
 * @retval GZ_ERR_NO_MEM  nothing written
 * @retval GZ_ERR_INVAL   a side is out of range
 */
enum gz_result gz_targets_from_luminance(const float *luminance, int width, int height,
					 struct gz_targets *out_targets);

/**
 * The salient points of a PNG file of at most 16384 pixels a side and 64 million in all.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_FORMAT, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_targets_from_png(const char *path, const struct gz_log *log,
				   struct gz_targets *out_targets);

#endif
