/**
 * @file
 * The six pictures of the surroundings on the graphics device. All calls need a current context.
 */
#ifndef GZ_RENDER_LIGHT_GL_GL_CUBE_H
#define GZ_RENDER_LIGHT_GL_GL_CUBE_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/light/cube_pictures.h"
#include "render/opengl/gl_device.h"

/** Zero-initialised is none; keep it from frame to frame. */
struct gz_gl_cube {
	unsigned texture; /**< OpenGL's name, six layers; 0: none */
	uint64_t serial;  /**< of the pictures */
};

/**
 * Upload the pictures, unless the device has them, and bind them to the texture unit @p unit. Does
 * nothing if there are none.
 *
 * @param unit  the number of the texture unit; the active unit is the first one afterwards
 * @retval GZ_ERR_NO_MEM, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_DEVICE  logged
 */
enum gz_result gz_gl_cube_bind(struct gz_gl_cube *cube, const struct gz_gl_device *device,
			       const struct gz_cube_pictures *pictures, unsigned unit,
			       const struct gz_log *log);

/** Delete and zero. Accepts a zeroed one. */
void gz_gl_cube_free(struct gz_gl_cube *cube);

#endif
