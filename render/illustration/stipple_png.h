/**
 * @file
 * Drawings as grey PNG of any size: strips are drawn and written one after the other, so that only
 * one is held in memory.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_PNG_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_PNG_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/stipple_sheet.h"

/** The marks of a drawing; borrowed. */
struct gz_stipple_marks {
	const struct gz_stipple_disc *discs;
	size_t disc_count;
	const struct gz_stipple_piece *pieces;
	size_t piece_count;
};

/** Rows of a strip that suit any picture. Chosen: 8 MiB at 16384 columns. */
#define GZ_STIPPLE_STRIP_ROWS 512

/**
 * Write a drawing: paper white, ink black. The same bytes for any height of the strips and any
 * number of threads, and the pixels of gz_stipple_sheet_to_image().
 *
 * @param size_px     width and height, 1 to GZ_STIPPLE_SIDE_MAX
 * @param strip_rows  1 or more
 * @param workers     share the drawing; NULL for the calling thread alone
 * @retval GZ_ERR_INVAL   a size is out of range; nothing is written
 * @retval GZ_ERR_NO_MEM  not logged; no file is left
 * @retval GZ_ERR_FULL    more than UINT32_MAX marks of a kind; no file is left
 * @return otherwise as gz_image_write_png()
 */
enum gz_result gz_stipple_write_png(const struct gz_stipple_marks *marks, const int size_px[2],
				    int strip_rows, struct gz_workers *workers, const char *path,
				    const struct gz_log *log);

#endif
