#include "render/picture/plane.h"

#include <stdlib.h>

#include "render/picture/image.h"

/* Kernels use whole registers and may read a few words after the last one. */
enum { ALIGNMENT = 64 };

enum gz_result gz_plane_resize(struct gz_plane *plane, enum gz_plane_kind kind, int width,
			       int height)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	const size_t count = (size_t)width * (size_t)height;
	if (count > plane->capacity) {
		const size_t bytes =
			(count * sizeof *plane->words + 2 * ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
		uint32_t *words = aligned_alloc(ALIGNMENT, bytes);
		if (!words)
			return GZ_ERR_NO_MEM;
		free(plane->words);
		plane->words = words;
		plane->capacity = count;
	}
	plane->kind = kind;
	plane->width = width;
	plane->height = height;
	return GZ_OK;
}

void gz_plane_free(struct gz_plane *plane)
{
	free(plane->words);
	*plane = (struct gz_plane) { 0 };
}
