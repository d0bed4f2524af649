/**
 * @file
 * The six pictures of the surroundings on the graphics device. All calls need a current context.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_CUBE_H
#define GZ_RENDER_SURFACE_GL_RASTER_CUBE_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/surface/shared/surface_cube.h"

/** Zero-initialised is none; keep it from frame to frame. */
struct gz_raster_cube {
	unsigned texture; /**< OpenGL's name, six layers; 0: none */
	uint64_t serial;  /**< of the pictures */
};

/**
 * Upload the pictures, unless the device has them, and bind them to their texture unit. Does
 * nothing if there are none.
 *
 * @retval GZ_ERR_NO_MEM, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_DEVICE  logged
 */
enum gz_result gz_raster_cube_bind(struct gz_raster_cube *cube, const struct gz_gl_device *device,
				   const struct gz_surface_cube *pictures,
				   const struct gz_log *log);

/** Delete and zero. Accepts a zeroed one. */
void gz_raster_cube_free(struct gz_raster_cube *cube);

#endif
