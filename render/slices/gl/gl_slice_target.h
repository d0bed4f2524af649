/**
 * @file
 * Where the slices of one layer are blended: a texture of colours times opacity and of opacity, in
 * single precision so that a thousand faint slices add up, and a depth buffer that keeps slices
 * from points that need no more of them. All calls need a current context.
 */
#ifndef GZ_RENDER_SLICES_GL_GL_SLICE_TARGET_H
#define GZ_RENDER_SLICES_GL_GL_SLICE_TARGET_H

#include "base/log.h"
#include "base/result.h"
#include "render/layers/raster_layers.h"
#include "render/opengl/gl_device.h"

/** Zero-initialised is empty; keep it from frame to frame. */
struct gz_gl_slice_target {
	unsigned blended, depth;  /**< textures, OpenGL's names; 0: none */
	unsigned drawing, hiding; /**< framebuffers: of both, and of depth alone */
	int width, height;        /**< of the textures, points: at least those of the layer */
};

/**
 * Make room for a layer's points; a target that is large enough is kept.
 *
 * @retval GZ_ERR_NO_MEM, GZ_ERR_UNSUPPORTED, GZ_ERR_NO_DEVICE  logged; the target is empty
 */
enum gz_result gz_gl_slice_target_reserve(struct gz_gl_slice_target *target,
					  const struct gz_gl_device *device,
					  const struct gz_raster_layer *layer,
					  const struct gz_log *log);

/** Clear all points of a layer, and close those that are hidden. Slices are drawn from now on, with
 *  the layer's points as the viewport: front to back, each under those before it. */
void gz_gl_slice_target_begin(const struct gz_gl_slice_target *target,
			      const struct gz_raster_layer *layer);

/** What is drawn from now on closes points, until gz_gl_slice_target_open(). */
void gz_gl_slice_target_close(const struct gz_gl_slice_target *target);

/** Slices are drawn again. */
void gz_gl_slice_target_open(const struct gz_gl_slice_target *target);

/** Delete and zero. Accepts a zeroed one. */
void gz_gl_slice_target_free(struct gz_gl_slice_target *target);

#endif
