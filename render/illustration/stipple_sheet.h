/**
 * @file
 * A sheet of paper that takes ink: discs and lines, smooth at their rims.
 *
 * Ink adds up and never exceeds what covers a pixel, so the order in which marks are drawn does not
 * matter: a sheet has the same bytes for any number of threads. A mark adds as much ink as its area
 * wherever it lies between pixel centres, on average; where marks overlap, rims add up to more
 * than they cover, which stipple_tone.h takes into account.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_SHEET_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_SHEET_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/picture/image.h"

/** A disc of ink. The centre of pixel (x, y) is at (x, y), row 0 on top. */
struct gz_stipple_disc {
	float x, y;   /**< px; may lie outside of the sheet */
	float radius; /**< px, above 0 and at most GZ_STIPPLE_MARK_MAX_PX */
};

/** A straight piece of a line. Its ends are cut off square, so that pieces that follow each other
 *  neither overlap nor leave a gap. */
struct gz_stipple_piece {
	float from[2], to[2];       /**< px */
	float from_width, to_width; /**< px, 0 to GZ_STIPPLE_MARK_MAX_PX; linear in between */
};

/** Largest radius of a disc and width of a line, px. */
#define GZ_STIPPLE_MARK_MAX_PX 1024

/** A sheet, or a strip of one. Zero-initialised is empty; keep it from frame to frame. */
struct gz_stipple_sheet {
	int width, height;
	int top;       /**< the picture's row that is the first one here; 0 of a whole sheet */
	size_t stride; /**< bytes from row to row */
	uint8_t *ink;  /**< of each pixel: 0 paper to 255 ink */
	size_t capacity;
	/** Marks by the bands that they touch; marks of band i are band_ends[i - 1] to
	 *  band_ends[i] - 1. For the functions of this file. */
	uint32_t *band_marks;
	size_t band_mark_capacity;
	size_t *band_ends;
	size_t band_capacity;
};

/**
 * Make a sheet white.
 *
 * @param width, height  px, 1 to GZ_IMAGE_SIDE_MAX
 * @retval GZ_ERR_INVAL   a side is out of range; the sheet is unchanged
 * @retval GZ_ERR_NO_MEM  not logged; the sheet is unchanged
 */
enum gz_result gz_stipple_sheet_clear(struct gz_stipple_sheet *sheet, int width, int height);

/** Longest side of a picture that is drawn in strips, px. Chosen: places are still told apart by
 * less than 1/100 px. */
#define GZ_STIPPLE_SIDE_MAX 131072

/**
 * Make a sheet a white strip of a larger picture: rows @p top to @p top + @p rows - 1. Marks that
 * are added have their places in the picture, and each pixel gets the ink that it has on a whole
 * sheet.
 *
 * @param width      px, 1 to GZ_STIPPLE_SIDE_MAX
 * @param top, rows  0 or more, and 1 or more; their sum at most GZ_STIPPLE_SIDE_MAX
 * @return as gz_stipple_sheet_clear()
 */
enum gz_result gz_stipple_sheet_clear_strip(struct gz_stipple_sheet *sheet, int width, int top,
					    int rows);

/**
 * Add discs.
 *
 * @param workers  share the work; NULL for the calling thread alone
 * @retval GZ_ERR_FULL    more than UINT32_MAX discs; nothing is added
 * @retval GZ_ERR_NO_MEM  not logged; nothing is added
 */
enum gz_result gz_stipple_sheet_add_discs(struct gz_stipple_sheet *sheet,
					  const struct gz_stipple_disc *discs, size_t count,
					  struct gz_workers *workers);

/** Add pieces of lines; as gz_stipple_sheet_add_discs(). */
enum gz_result gz_stipple_sheet_add_pieces(struct gz_stipple_sheet *sheet,
					   const struct gz_stipple_piece *pieces, size_t count,
					   struct gz_workers *workers);

/** The sheet as a picture: paper white, ink black. Errors as gz_image_resize(). */
enum gz_result gz_stipple_sheet_to_image(const struct gz_stipple_sheet *sheet,
					 struct gz_image *image);

/** Free what it holds and zero it. */
void gz_stipple_sheet_free(struct gz_stipple_sheet *sheet);

#endif
