/**
 * @file
 * The lattice points of one plane on the graphics device, and the picture that they become. All
 * calls need the context current.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_GL_POINTS_H
#define GZ_RENDER_RECONSTRUCT_GL_GL_POINTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/opengl/gl_device.h"

/** Zero-initialised is empty; keep it from frame to frame. */
struct gz_gl_points {
	struct gz_gl_buffer points, staging;
	unsigned texels;  /**< buffer texture of the points; 0 where shaders need none */
	unsigned picture; /**< texture, RGBA8; 0 until one was asked for */
	int picture_width, picture_height;
};

/** Make room for @p count points. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE: not logged. */
enum gz_result gz_gl_points_prepare(struct gz_gl_points *points, const struct gz_gl_device *device,
				    size_t count);

/** Let shaders see the points. */
void gz_gl_points_bind(const struct gz_gl_points *points);

/** Bring the picture, @p count words, into the host's memory. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE. */
enum gz_result gz_gl_points_read(struct gz_gl_points *points, const struct gz_gl_device *device,
				 size_t count, uint32_t *out_words);

/** Bring the picture into points->picture, on the device. Colours only. */
void gz_gl_points_to_texture(struct gz_gl_points *points, int width, int height);

/** Delete all of it and zero the struct. */
void gz_gl_points_free(struct gz_gl_points *points);

#endif
