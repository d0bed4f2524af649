/**
 * @file
 * Pictures: 8-bit RGBA, row 0 on top, opaque.
 */
#ifndef GZ_RENDER_PICTURE_IMAGE_H
#define GZ_RENDER_PICTURE_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Longest side of a picture, pixels. */
#define GZ_IMAGE_SIDE_MAX 16384

/** A picture; each pixel is R, G, B, A in memory, A = 255. */
struct gz_image {
	int width, height; /**< 1 to GZ_IMAGE_SIDE_MAX */
	uint8_t *pixels;   /**< width * height * 4 bytes, aligned to 64 */
};

/** Make room for a picture, keeping the buffer where it already fits; contents are undefined.
 *  GZ_ERR_INVAL, GZ_ERR_NO_MEM leave the image as it was. Zero-initialised is a valid start. */
enum gz_result gz_image_resize(struct gz_image *image, int width, int height);

/** The pixels as words, as planes have them. */
static inline uint32_t *gz_image_words(const struct gz_image *image)
{
	return (uint32_t *)(void *)image->pixels; /* aligned to 64 bytes */
}

/** Free the pixels and zero the struct. */
void gz_image_free(struct gz_image *image);

/** Write an opaque RGB PNG. GZ_ERR_IO (disk full, no such folder): logged; no partial file stays.
 */
enum gz_result gz_image_write_png(const struct gz_image *image, const char *path,
				  const struct gz_log *log);

/** A text in a PNG: an iTXt chunk (PNG third edition, section 11.3.3.4). */
struct gz_image_text {
	const char *keyword; /**< 1 to 79 bytes of Latin-1, no blank at an end */
	const char *text;    /**< UTF-8 */
};

/** As gz_image_write_png(), with texts before the pixels. */
enum gz_result gz_image_write_png_with(const struct gz_image *image,
				       const struct gz_image_text *texts, size_t count,
				       const char *path, const struct gz_log *log);

/** Read any PNG as RGBA, alpha forced to 255; what @p out_image held (zeroed: nothing) is freed.
 * GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT, GZ_ERR_NO_MEM: logged. */
enum gz_result gz_image_read_png(const char *path, const struct gz_log *log,
				 struct gz_image *out_image);

/** Scale @p source to the size of @p target: box filter where it shrinks, bilinear where it grows.
 */
void gz_image_resample(const struct gz_image *source, struct gz_image *target);

#endif
