/**
 * @file
 * The shadow map: the depths of all surfaces, seen from the light. It is drawn again when the
 * light, the clip region, the meshes or its size change. All calls need a current context.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_SHADOW_H
#define GZ_RENDER_SURFACE_GL_RASTER_SHADOW_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/surface/gl/raster_meshes.h"
#include "render/surface/gl/raster_view.h"

/** Zero-initialised is empty; keep it from frame to frame. */
struct gz_raster_shadow_map {
	unsigned texture, framebuffer; /**< OpenGL's names; 0: none */
	int edge;                      /**< texels */
	struct gz_raster_shadow drawn; /**< what the map holds, of the meshes of serial */
	uint64_t serial;               /**< 0: nothing yet */
};

/** Texels along the edge of the map for a picture: twice its longer side, as a power of two from
 * 256 to 4096, and no more than the device has. */
int gz_raster_shadow_edge(int width, int height);

/**
 * Make room for a map.
 *
 * @retval GZ_ERR_NO_MEM, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_DEVICE  logged; the map is empty
 */
enum gz_result gz_raster_shadow_reserve(struct gz_raster_shadow_map *map,
					const struct gz_gl_device *device, int edge,
					const struct gz_log *log);

/** Draw the meshes into the map, unless it holds them, and bind it to its texture unit. The program
 *  and the block of the frame are in use. */
void gz_raster_shadow_draw(struct gz_raster_shadow_map *map, const struct gz_raster_shadow *view,
			   const struct gz_raster_meshes *meshes);

/** Delete and zero. Accepts a zeroed one. */
void gz_raster_shadow_free(struct gz_raster_shadow_map *map);

#endif
