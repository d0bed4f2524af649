#include "render/reconstruct/gl/gl_points.h"

#include <string.h>

#include <GL/glew.h>

#include "render/reconstruct/gl/plan_block.h"

/* Mesa's processor reads a storage buffer lane by lane, so shaders read it as texels there. */
static void make_texels(struct gz_gl_points *points)
{
	if (!points->texels)
		glGenTextures(1, &points->texels);
	glBindTexture(GL_TEXTURE_BUFFER, points->texels);
	glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, points->points.name);
	glBindTexture(GL_TEXTURE_BUFFER, 0);
}

enum gz_result gz_gl_points_prepare(struct gz_gl_points *points, const struct gz_gl_device *device,
				    size_t count)
{
	const size_t size = count * sizeof(uint32_t);
	const bool grows = size > points->points.size;
	gz_gl_buffer_reserve(&points->points, size, GL_DYNAMIC_COPY);
	if (device->software && grows)
		make_texels(points);
	const enum gz_result result = gz_gl_device_errors(device);
	if (result != GZ_OK)
		points->points.size = 0;
	return result;
}

void gz_gl_points_bind(const struct gz_gl_points *points)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_POINTS, points->points.name);
	if (points->texels)
		glBindImageTexture(GZ_GL_IMAGE_POINTS, points->texels, 0, GL_FALSE, 0, GL_READ_ONLY,
				   GL_R32UI);
}

enum gz_result gz_gl_points_read(struct gz_gl_points *points, const struct gz_gl_device *device,
				 size_t count, uint32_t *out_words)
{
	const size_t bytes = count * sizeof *out_words;
	gz_gl_buffer_bring(device, &points->points, bytes, &points->staging);
	const void *words =
		glMapBufferRange(GL_COPY_READ_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
	if (!words) {
		const enum gz_result result = gz_gl_device_errors(device);
		return result == GZ_OK ? GZ_ERR_NO_MEM : result;
	}
	memcpy(out_words, words, bytes);
	glUnmapBuffer(GL_COPY_READ_BUFFER);
	return GZ_OK;
}

void gz_gl_points_to_texture(struct gz_gl_points *points, int width, int height)
{
	if (points->picture_width != width || points->picture_height != height) {
		if (points->picture)
			glDeleteTextures(1, &points->picture);
		points->picture = gz_gl_texture(GL_TEXTURE_2D);
		glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
		points->picture_width = width;
		points->picture_height = height;
	}
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, points->points.name);
	glBindTexture(GL_TEXTURE_2D, points->picture);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
	glBindTexture(GL_TEXTURE_2D, 0);
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void gz_gl_points_free(struct gz_gl_points *points)
{
	gz_gl_buffer_free(&points->points);
	gz_gl_buffer_free(&points->staging);
	if (points->picture)
		glDeleteTextures(1, &points->picture);
	if (points->texels)
		glDeleteTextures(1, &points->texels);
	*points = (struct gz_gl_points) { 0 };
}
