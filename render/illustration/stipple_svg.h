/**
 * @file
 * Drawings for print: SVG 1.1 with sizes in millimetres. Marks are written as they come; only a
 * block of text is held in memory.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_SVG_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_SVG_H

#include <stddef.h>
#include <stdint.h>

#include "base/file.h"
#include "base/log.h"
#include "base/result.h"
#include "render/illustration/stipple_sheet.h"

/** A file that is being written. Zero-initialised is closed. */
struct gz_stipple_svg {
	struct gz_part_file file;
	double mm_per_px;
	enum gz_result result; /**< the first error */
	uint64_t written;      /**< bytes in the file */
	size_t used;           /**< bytes of block */
	char block[1 << 14];
};

/**
 * Begin a drawing. Black marks on no background; pixel (0, 0) has its corner in the upper left.
 *
 * @param path           borrowed until gz_stipple_svg_close()
 * @param width, height  px, at least 1
 * @param mm_per_px      edge of a pixel on paper, mm, above 0 and finite
 * @retval GZ_ERR_INVAL  a size is out of range; nothing is open
 * @retval GZ_ERR_IO     the file cannot be created; logged; nothing is open
 * @retval GZ_ERR_FULL   no space is left; logged; nothing is open
 */
enum gz_result gz_stipple_svg_open(struct gz_stipple_svg *svg, const char *path,
				   const int size_px[2], double mm_per_px,
				   const struct gz_log *log);

/** Add discs as circles. Errors are told by gz_stipple_svg_close(). */
void gz_stipple_svg_add_discs(struct gz_stipple_svg *svg, const struct gz_stipple_disc *discs,
			      size_t count);

/**
 * Add lines as filled outlines, which swell and taper as the pieces do. Pieces that follow each
 * other, each beginning exactly where the one before it ended, are one line.
 */
void gz_stipple_svg_add_pieces(struct gz_stipple_svg *svg, const struct gz_stipple_piece *pieces,
			       size_t count);

/**
 * End the drawing. If anything failed, no file is left.
 *
 * @retval GZ_ERR_IO    the file could not be written; logged
 * @retval GZ_ERR_FULL  no space was left; logged
 */
enum gz_result gz_stipple_svg_close(struct gz_stipple_svg *svg);

#endif
