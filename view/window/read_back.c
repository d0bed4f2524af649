#include "view/window/read_back.h"

#include <string.h>

#include <GL/glew.h>

static void swap_rows(uint8_t *a, uint8_t *b, size_t size)
{
	uint8_t row[1024];
	for (size_t at = 0; at < size; at += sizeof row) {
		const size_t part = size - at < sizeof row ? size - at : sizeof row;
		memcpy(row, a + at, part);
		memcpy(a + at, b + at, part);
		memcpy(b + at, row, part);
	}
}

/* OpenGL begins below; opacity of a framebuffer is anything. */
static void put_upright(struct gz_image *image)
{
	const size_t row = (size_t)image->width * 4;
	for (int y = 0; y < image->height / 2; y++)
		swap_rows(image->pixels + (size_t)y * row,
			  image->pixels + (size_t)(image->height - 1 - y) * row, row);
	for (size_t i = 3; i < row * (size_t)image->height; i += 4)
		image->pixels[i] = 255;
}

enum gz_result gz_window_read_back(int width, int height, struct gz_image *image)
{
	const enum gz_result r = gz_image_resize(image, width, height);
	if (r != GZ_OK)
		return r;
	glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image->pixels);
	put_upright(image);
	return GZ_OK;
}
