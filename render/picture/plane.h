/**
 * @file
 * Planes of a picture beside its colours: depth, object numbers, any number for each pixel.
 */
#ifndef GZ_RENDER_PICTURE_PLANE_H
#define GZ_RENDER_PICTURE_PLANE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/result.h"

/** What the 32 bits of a pixel are. */
enum gz_plane_kind {
	GZ_PLANE_COLOUR, /**< R, G, B, A from the lowest byte, as in struct gz_image */
	GZ_PLANE_VALUE,  /**< a float: depth or any other number; INFINITY where there is nothing */
	GZ_PLANE_ID,     /**< the number of an object; 0 where there is nothing */
	GZ_PLANE_KIND_COUNT,
};

/** One plane, row 0 on top. Zero-initialised is empty. */
struct gz_plane {
	enum gz_plane_kind kind;
	int width, height; /**< 1 to GZ_IMAGE_SIDE_MAX */
	uint32_t *words;   /**< width * height, aligned to 64 bytes */
	size_t capacity;   /**< words there is room for */
};

/** Make room for a plane; what it held is undefined then. GZ_ERR_INVAL, GZ_ERR_NO_MEM leave it as
 * it was. */
enum gz_result gz_plane_resize(struct gz_plane *plane, enum gz_plane_kind kind, int width,
			       int height);

/** The number at a pixel of a GZ_PLANE_VALUE. */
static inline float gz_plane_value(const struct gz_plane *plane, int x, int y)
{
	float value;
	memcpy(&value, &plane->words[(ptrdiff_t)y * plane->width + x], sizeof value);
	return value;
}

/** Free the words and zero the struct. */
void gz_plane_free(struct gz_plane *plane);

#endif
