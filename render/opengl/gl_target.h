/**
 * @file
 * A framebuffer for triangles, with the planes that a pass writes. All calls need a current
 * context.
 */
#ifndef GZ_RENDER_OPENGL_GL_TARGET_H
#define GZ_RENDER_OPENGL_GL_TARGET_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"

/** Planes of a target. Fragment shaders write each to the location of its number. */
enum gz_gl_target_plane {
	GZ_GL_TARGET_COLOUR, /**< RGBA8 */
	GZ_GL_TARGET_ID,     /**< R32UI: an object's id; 0 = no object */
	GZ_GL_TARGET_VALUE,  /**< R32UI: the bits of a float */
	GZ_GL_TARGET_VECTOR, /**< RGBA32F: four numbers of a technique's own */
	GZ_GL_TARGET_PLANES,
};

/** A framebuffer. Zero-initialised is empty; keep it from frame to frame. */
struct gz_gl_target {
	unsigned framebuffer;                 /**< OpenGL's names; 0: none */
	unsigned planes[GZ_GL_TARGET_PLANES]; /**< textures; 0 if the plane is not wanted */
	unsigned depth;                       /**< texture, DEPTH_COMPONENT32F */
	int width, height;                    /**< at least what was asked for */
};

/**
 * Make a framebuffer of at least @p width x @p height pixels, or keep the one there is if it is
 * large enough.
 *
 * @param planes  bits 1 << enum gz_gl_target_plane of the planes wanted; depth is always there
 * @retval GZ_ERR_NO_MEM       the device has no room; logged. The target is empty
 * @retval GZ_ERR_UNSUPPORTED  the driver has no such framebuffer; logged. The target is empty
 */
enum gz_result gz_gl_target_reserve(struct gz_gl_target *target, const struct gz_gl_device *device,
				    unsigned planes, int width, int height,
				    const struct gz_log *log);

/** Draw into the target from now on, over its whole size, with depth test and without blending. */
void gz_gl_target_begin(const struct gz_gl_target *target);

/** Clear all planes: colour to @p colour (R, G, B, A in [0, 1]), ids to 0, values to infinity,
 * vectors to 0, depth to the farthest. Call it after begin. */
void gz_gl_target_clear(const struct gz_gl_target *target, const float colour[4]);

/** Read the first @p width x @p height pixels of a plane: words of 32 bits, or vectors of four; row
 *  0 is the bottom one. Waits until they are drawn. */
void gz_gl_target_read(const struct gz_gl_target *target, enum gz_gl_target_plane plane, int width,
		       int height, void *out_words);

/** Delete and zero. Accepts a zeroed one. */
void gz_gl_target_free(struct gz_gl_target *target);

#endif
