/**
 * @file
 * Draws a volume as slices by OpenGL: the polygons of slice_cut.h on the lattices of
 * raster_layers.h, nearest first, with the samples, colours and light of the ray caster
 * (render/raycast/gl/).
 */
#ifndef GZ_RENDER_SLICES_GL_GL_SLICER_H
#define GZ_RENDER_SLICES_GL_GL_SLICER_H

#include "render/opengl/gl_program.h"
#include "render/raycast/gl/gl_cast.h"
#include "render/technique/technique.h"

struct gz_gl_slicer;

/**
 * Make a slicer. One thread at a time may use it.
 *
 * @param log  outlives the slicer
 * @param[out] out_slicer  owned by the caller: gz_gl_slicer_destroy()
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_UNSUPPORTED  no OpenGL 4.3; logged
 * @retval GZ_ERR_NO_MEM                         out of memory
 */
enum gz_result gz_gl_slicer_create(const struct gz_backend_params *params, const struct gz_log *log,
				   struct gz_gl_slicer **out_slicer);

/** Show a volume, borrowed until the next call. The failures of gz_gl_scene_set_volume(), and
 *  GZ_ERR_NO_DEVICE if the context is lost; logged. */
enum gz_result gz_gl_slicer_set_volume(struct gz_gl_slicer *slicer, const struct gz_volume *volume);

/** Use a transfer function, which is copied. GZ_ERR_INVAL without a volume; GZ_ERR_NO_MEM,
 *  GZ_ERR_NO_DEVICE: logged. */
enum gz_result gz_gl_slicer_set_transfer(struct gz_gl_slicer *slicer,
					 const struct gz_transfer *transfer);

/**
 * Draw a picture of the plan's size; see gz_drawer_ops.draw. The shot's settings are a struct
 * gz_ray_params.
 *
 * @retval GZ_ERR_INVAL      no volume or transfer function, or a camera or settings out of range
 * @retval GZ_ERR_NO_MEM     no room for the picture; logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost; logged
 */
enum gz_result gz_gl_slicer_draw(struct gz_gl_slicer *slicer, const struct gz_shot *shot,
				 struct gz_image *image, struct gz_frame_stats *out_stats);

/** OpenGL's name of the texture with the last picture drawn without an image; 0: none. */
unsigned gz_gl_slicer_picture_texture(const struct gz_gl_slicer *slicer);

/** The device in words, such as "gl: llvmpipe (LLVM 15.0.6, 256 bits), 4.5". */
const char *gz_gl_slicer_describe(const struct gz_gl_slicer *slicer);

/** Destroy the slicer and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_gl_slicer_destroy(struct gz_gl_slicer **slicer);

/* Within this room, and for tests: */

/** The shaders that draw slices of a kind. @p defines is filled and borrowed by both. */
void gz_gl_slice_shaders(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			 char defines[GZ_GL_CAST_DEFINES_SIZE], struct gz_gl_shader out_shaders[2]);

/** The shaders that draw the surroundings behind the slices: the same for all kinds. @p defines is
 *  filled and borrowed by both. */
void gz_gl_behind_shaders(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			  char defines[GZ_GL_CAST_DEFINES_SIZE],
			  struct gz_gl_shader out_shaders[2]);

/** The shaders that close points hardly any light comes through. */
void gz_gl_hide_shaders(struct gz_gl_shader out_shaders[2]);

#endif
