/**
 * @file
 * Pictures: 8-bit RGBA, row 0 on top, opaque.
 */
#ifndef GZ_RENDER_PICTURE_IMAGE_H
#define GZ_RENDER_PICTURE_IMAGE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"

/** Longest side of a picture, pixels. */
#define GZ_IMAGE_SIDE_MAX 16384

/** A picture; each pixel is R, G, B, A in memory, A = 255. */
struct gz_image {
	int width, height; /**< 1 to GZ_IMAGE_SIDE_MAX */
	uint8_t *pixels;   /**< width * height * 4 bytes, aligned to 64 */
};

/**
 * Make room for a picture of @p width by @p height pixels. The buffer is kept if it has the right
 * size; what the pixels hold is undefined. A zero-initialised image may be resized.
 *
 * @retval GZ_ERR_INVAL   a side is not 1 to GZ_IMAGE_SIDE_MAX; the image is unchanged
 * @retval GZ_ERR_NO_MEM  the image is unchanged
 */
enum gz_result gz_image_resize(struct gz_image *image, int width, int height);

/** The pixels as words of struct gz_plane: R in the lowest byte on a little-endian machine. */
static inline uint32_t *gz_image_words(const struct gz_image *image)
{
	return (uint32_t *)(void *)image->pixels; /* aligned to 64 bytes */
}

/** Free the pixels and zero the struct. */
void gz_image_free(struct gz_image *image);

/**
 * Write an opaque RGB PNG. A regular file is written under a temporary name and then renamed, so
 * that @p path never holds half a picture; a device or pipe is written to directly.
 *
 * @retval GZ_ERR_INVAL  @p image has no pixels; not logged
 * @retval GZ_ERR_IO     the disk is full, there is no such folder, …; logged
 */
enum gz_result gz_image_write_png(const struct gz_image *image, const char *path,
				  const struct gz_log *log);

/** A text in a PNG: an iTXt chunk (PNG third edition, section 11.3.3.4). */
struct gz_image_text {
	const char *keyword; /**< 1 to 79 bytes of Latin-1, no blank at either end */
	const char *text;    /**< UTF-8 */
};

/** As gz_image_write_png(); puts @p count texts in front of the pixels. */
enum gz_result gz_image_write_png_with(const struct gz_image *image,
				       const struct gz_image_text *texts, size_t count,
				       const char *path, const struct gz_log *log);

/** A grey picture whose rows are made as they are written, so that it need not fit into memory. */
struct gz_image_rows {
	int width, height; /**< 1 to GZ_IMAGE_ROWS_MAX */
	/** Make row @p y, @p width bytes, 0 black to 255 white. Called once for each row, in their
	 *  order. A failure ends the file, and no regular file is left. */
	enum gz_result (*make)(void *user, int y, uint8_t *out_greys);
	void *user;
};

/** Longest side of such a picture. Chosen: libpng writes no larger ones unless it is told to. */
#define GZ_IMAGE_ROWS_MAX 1000000

/**
 * Write a grey PNG of 8 bits; the file is treated as by gz_image_write_png().
 *
 * @retval GZ_ERR_INVAL   a side is out of range; not logged
 * @retval GZ_ERR_NO_MEM  no memory for a row; not logged
 * @retval GZ_ERR_IO      the disk is full, there is no such folder, …; logged
 * @return otherwise what make() returns; not logged
 */
enum gz_result gz_image_write_grey_png(const struct gz_image_rows *rows, const char *path,
				       const struct gz_log *log);

/**
 * Read any PNG as RGBA; alpha becomes 255. A gamma that the file states is followed; without one it
 * is sRGB, with 16 bits too.
 *
 * @param[out] out_image  what it held is freed; zero-initialised is empty
 * @retval GZ_ERR_NOT_FOUND  the file cannot be opened; logged
 * @retval GZ_ERR_FORMAT     no PNG, damaged, a side above GZ_IMAGE_SIDE_MAX, or more pixels than so
 *                           few bytes hold; logged
 * @retval GZ_ERR_NO_MEM     logged
 */
enum gz_result gz_image_read_png(const char *path, const struct gz_log *log,
				 struct gz_image *out_image);

/**
 * Read the width and the height of a PNG, not its pixels.
 *
 * @param[out] out_size  width and height, px; written on success only
 * @return as gz_image_read_png(), without GZ_ERR_NO_MEM
 */
enum gz_result gz_image_measure_png(const char *path, const struct gz_log *log, int out_size[2]);

/** Longest text that is read from a PNG, bytes. Chosen: as long as the longest scene. */
#define GZ_IMAGE_TEXT_MAX ((size_t)1 << 20)

/**
 * Find the first text with a keyword in a PNG: a tEXt, zTXt or iTXt chunk (PNG third edition,
 * sections 11.3.3.2 to 11.3.3.4), compressed or not, before or after the pixels. The pixels are
 * decoded only to reach texts after them.
 *
 * @param file           at the beginning of a PNG; where it stands afterwards is undefined
 * @param keyword        1 to 79 bytes
 * @param[out] out_text  must be empty; receives the text
 * @retval GZ_ERR_NOT_FOUND  no text has the keyword; not logged
 * @retval GZ_ERR_FORMAT     no text has the keyword, and the file is no PNG, cut off or damaged, or
 *                           a text in it is damaged or too long; not logged
 * @retval GZ_ERR_NO_MEM     not logged
 */
enum gz_result gz_image_find_text(FILE *file, const char *keyword, struct gz_text *out_text);

/** Scale @p source to the size of @p target: a box filter where it shrinks, bilinear interpolation
 *  where it grows. Both need pixels; otherwise nothing happens. */
void gz_image_resample(const struct gz_image *source, struct gz_image *target);

#endif
