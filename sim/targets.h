/**
 * @file
 * The places that attract a simulated viewer: from a list, or the salient points of a picture.
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

/** A place that attracts the viewer. */
struct gz_target {
	struct gz_point point;
	double weight; /**< how strongly it attracts, above 0 */
};

/** A list of places. Plain data. */
struct gz_targets {
	size_t count;
	struct gz_target target[GZ_TARGETS_MAX];
};

/**
 * Parse a target list. A line is "x y" or "x y weight", separated by blanks; "#" begins a comment.
 * x and y are normalised display coordinates, -0.5 to 1.5; the weight is above 0 and at most 1000,
 * 1 if absent.
 *
 * @param name  the file's name in messages
 * @param[out] out_targets  written on success only
 * @retval GZ_ERR_FORMAT  a malformed line, no target, or more than GZ_TARGETS_MAX; logged
 */
enum gz_result gz_targets_parse(const char *name, const char *text, size_t size,
				const struct gz_log *log, struct gz_targets *out_targets);

/**
 * Read a target list from a file of at most 64 KiB.
 *
 * @param[out] out_targets  written on success only
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     not a target list; logged
 * @retval GZ_ERR_NO_MEM     out of memory; not logged
 */
enum gz_result gz_targets_load(const char *path, const struct gz_log *log,
			       struct gz_targets *out_targets);

/**
 * Find the salient points of a picture that fills the display. They are the peaks of the
 * centre-surround contrast of its luminance, the strongest first; each inhibits its neighbourhood.
 * After Itti, Koch and Niebur, "A model of saliency-based visual attention for rapid scene
 * analysis", IEEE PAMI 20(11), 1998 (intensity channel only).
 *
 * @param luminance   @p width * @p height values of any scale, rows top down
 * @param width, height  1 to 16384
 * @param[out] out_targets  at least one target: a picture without contrast gives its centre
 * @retval GZ_ERR_NO_MEM  out of memory; nothing is written
 * @retval GZ_ERR_INVAL   a side is out of range
 */
enum gz_result gz_targets_from_luminance(const float *luminance, int width, int height,
					 struct gz_targets *out_targets);

/**
 * Find the salient points of a PNG file, which has at most 16384 pixels on a side and 64 million in
 * all.
 *
 * @param[out] out_targets  written on success only
 * @retval GZ_ERR_NOT_FOUND    no such file; logged
 * @retval GZ_ERR_IO           the file cannot be opened; logged
 * @retval GZ_ERR_FORMAT       not a PNG picture, or a damaged one; logged
 * @retval GZ_ERR_UNSUPPORTED  too many pixels; logged
 * @retval GZ_ERR_NO_MEM       out of memory; not logged
 */
enum gz_result gz_targets_from_png(const char *path, const struct gz_log *log,
				   struct gz_targets *out_targets);

#endif
