/**
 * @file
 * Planes of a picture: 32 bits for each pixel, which are a colour, a value or an object number.
 */
#ifndef GZ_RENDER_PICTURE_PLANE_H
#define GZ_RENDER_PICTURE_PLANE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/result.h"

/** What the 32 bits of a pixel are. */
enum gz_plane_kind {
	GZ_PLANE_COLOUR,      /**< R, G, B, A from the lowest byte, as in struct gz_image */
	GZ_PLANE_DEEP_COLOUR, /**< R, G, B and a depth, which is interpolated as they are */
	GZ_PLANE_VALUE, /**< a float: depth or any other number; INFINITY where there is nothing */
	GZ_PLANE_ID,    /**< the number of an object; 0 where there is nothing */
	GZ_PLANE_KIND_COUNT,
};

/** One plane, row 0 on top. Zero-initialised is empty. */
struct gz_plane {
	enum gz_plane_kind kind;
	int width, height; /**< 1 to GZ_IMAGE_SIDE_MAX */
	uint32_t *words;   /**< width * height, aligned to 64 bytes */
	size_t capacity;   /**< words allocated */
};

/**
 * Make room for a plane of @p width by @p height pixels; what the words hold is undefined.
 *
 * @retval GZ_ERR_INVAL   a side is not 1 to GZ_IMAGE_SIDE_MAX; the plane is unchanged
 * @retval GZ_ERR_NO_MEM  the plane is unchanged
 */
enum gz_result gz_plane_resize(struct gz_plane *plane, enum gz_plane_kind kind, int width,
			       int height);

/** The value of pixel (@p x, @p y) of a GZ_PLANE_VALUE. */
static inline float gz_plane_value(const struct gz_plane *plane, int x, int y)
{
	float value;
	memcpy(&value, &plane->words[(ptrdiff_t)y * plane->width + x], sizeof value);
	return value;
}

/** Free the words and zero the struct. */
void gz_plane_free(struct gz_plane *plane);

#endif
