/**
 * @file
 * Draws surfaces by OpenGL: triangles on nested layers (render/layers/), lit as rays light them,
 * with a shadow map in place of shadow rays, and glass of one reflection and one refraction.
 */
#ifndef GZ_RENDER_SURFACE_GL_SURFACE_RASTER_H
#define GZ_RENDER_SURFACE_GL_SURFACE_RASTER_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "render/surface/shared/surface_meshes.h"
#include "render/surface/shared/surface_shot.h"
#include "render/technique/technique.h"

/** Surfaces, and the device that draws them. One thread at a time may use it. */
struct gz_surface_raster;

/**
 * Make one that shows nothing.
 *
 * @param params  NULL: the defaults
 * @param log     outlives it
 * @param[out] out_raster  owned by the caller: gz_surface_raster_destroy()
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_UNSUPPORTED  no OpenGL 4.3; logged
 * @retval GZ_ERR_INVAL                          the number of threads is out of range; logged
 * @retval GZ_ERR_NO_MEM                         out of memory
 */
enum gz_result gz_surface_raster_create(const struct gz_backend_params *params,
					const struct gz_log *log,
					struct gz_surface_raster **out_raster);

/** Show these objects from the next picture on. Surfaces are made when that picture is drawn, as
 * its settings have the isovalue. Returns what gz_surface_meshes_show() returns. */
enum gz_result gz_surface_raster_show(struct gz_surface_raster *raster,
				      const struct gz_object *objects, size_t count);

/** Take the meshes that a caster of rays has made of the same data: gz_surface_meshes_take(). */
void gz_surface_raster_take(struct gz_surface_raster *raster, struct gz_surface_meshes *from);

/**
 * Draw a picture of the plan's size and write every pixel. Makes and uploads the surfaces first if
 * the isovalue or the objects have changed.
 *
 * @param shot       without hits; volumes are shown as triangles
 * @param image      NULL: the picture stays on the device, see gz_surface_raster_picture()
 * @param planes     NULL: only colours. Between points a plane takes the nearest one
 * @param out_stats  may be NULL; its prepare_ms is the time for surfaces and their upload
 * @retval GZ_ERR_INVAL        the settings or the camera are not valid, or nothing is shown
 * @retval GZ_ERR_FULL         the surface has too many triangles; logged
 * @retval GZ_ERR_NO_MEM       no room for triangles or the picture; logged
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses a program or a framebuffer; logged
 * @retval GZ_ERR_NO_DEVICE    the context is lost; logged
 */
enum gz_result gz_surface_raster_draw(struct gz_surface_raster *raster,
				      const struct gz_surface_shot *shot, struct gz_image *image,
				      const struct gz_surface_planes *planes,
				      struct gz_frame_stats *out_stats);

/** OpenGL's name of the texture with the last picture drawn without an image; 0: none. */
unsigned gz_surface_raster_picture(const struct gz_surface_raster *raster);

/** The device in words, such as "gl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5"; owned by it. */
const char *gz_surface_raster_describe(const struct gz_surface_raster *raster);

/** Destroy it and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_surface_raster_destroy(struct gz_surface_raster **raster);

#endif
