#include "view/draw/icon.h"

#include <stdlib.h>

#include <GL/glew.h>

unsigned gz_icon_make_colour(const uint8_t *rgba, int width, int height)
{
	GLuint texture = 0;
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	return texture;
}

unsigned gz_icon_make(const uint8_t *grey, int edge)
{
	const size_t count = (size_t)edge * (size_t)edge;
	uint8_t *rgba = malloc(4 * count);
	if (!rgba)
		return 0;
	for (size_t i = 0; i < count; i++) {
		rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = grey[i];
		rgba[4 * i + 3] = 255;
	}
	const unsigned texture = gz_icon_make_colour(rgba, edge, edge);
	free(rgba);
	return texture;
}

void gz_icon_free(unsigned *icon)
{
	if (*icon)
		glDeleteTextures(1, icon);
	*icon = 0;
}
