/**
 * @file
 * Illustrations of surfaces by OpenGL: triangles are drawn on nested layers (render/layers/) into
 * buffers of tone, depth and objects, one layer of surfaces behind the other as far as they are
 * transparent (depth peeling: Everitt 2001). The host composes the picture of them, as it does for
 * rays (render/illustration/shared/illustrate_picture.h).
 */
#ifndef GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_RASTER_H
#define GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_RASTER_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/illustration/shared/illustrate_shot.h"
#include "render/picture/image.h"
#include "render/technique/technique.h"

/** Surfaces, and the device that draws them. One thread at a time may use it. */
struct gz_illustrate_raster;

/**
 * Make one that shows nothing.
 *
 * @param params  NULL: the defaults
 * @param log     outlives it; may be NULL
 * @param[out] out_raster  owned by the caller: gz_illustrate_raster_destroy()
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_UNSUPPORTED  no OpenGL 4.3; logged
 * @retval GZ_ERR_INVAL                          the number of threads is out of range; logged
 * @retval GZ_ERR_NO_MEM                         out of memory
 */
enum gz_result gz_illustrate_raster_create(const struct gz_backend_params *params,
					   const struct gz_log *log,
					   struct gz_illustrate_raster **out_raster);

/** gz_illustrate_scene_show(). */
enum gz_result gz_illustrate_raster_show(struct gz_illustrate_raster *raster,
					 const struct gz_object *objects, size_t count);

/**
 * Draw a picture of the plan's size and write every pixel, as gz_illustrate_caster_draw() does.
 * Uploads the surfaces first if they have changed.
 *
 * @param image      NULL: the picture stays on the device, see gz_illustrate_raster_picture()
 * @param planes     NULL: no planes are wanted
 * @param out_stats  may be NULL
 * @retval GZ_ERR_INVAL        nothing is shown, the camera or the settings are not valid, or the
 *                             plan is empty
 * @retval GZ_ERR_FULL         a surface has too many triangles; logged
 * @retval GZ_ERR_NO_MEM       no room for triangles or the picture; that of the device is logged
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses a program or a framebuffer, or distances need
 *                             Embree, which is not in this build; logged
 * @retval GZ_ERR_NO_DEVICE    the context is lost; logged
 */
enum gz_result gz_illustrate_raster_draw(struct gz_illustrate_raster *raster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats);

/** Write the marks that drew the last picture. @return as gz_illustrate_drawing_print() */
enum gz_result gz_illustrate_raster_print(const struct gz_illustrate_raster *raster,
					  const struct gz_print *print);

/** OpenGL's name of the texture with the last picture drawn without an image; 0: none. */
unsigned gz_illustrate_raster_picture(const struct gz_illustrate_raster *raster);

/** The device in words, such as "gl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5"; owned by it. */
const char *gz_illustrate_raster_describe(const struct gz_illustrate_raster *raster);

/** Destroy it and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_illustrate_raster_destroy(struct gz_illustrate_raster **raster);

#endif
