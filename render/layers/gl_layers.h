/**
 * @file
 * A picture drawn as nested layers (raster_layers.h) on a graphics device: the technique draws each
 * layer into textures of its own, and the layers are joined into the picture by masks that fade
 * from one to the next. All calls need a current context.
 */
#ifndef GZ_RENDER_LAYERS_GL_LAYERS_H
#define GZ_RENDER_LAYERS_GL_LAYERS_H

#include "base/log.h"
#include "base/result.h"
#include "render/layers/raster_layers.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/picture/image.h"
#include "render/reconstruct/gl/gl_reconstruct.h"

/** Texture unit of the first layer when layers are joined; the others follow. Units below stay as
 *  they are. Every OpenGL 4.3 has 16. */
#define GZ_GL_UNIT_LAYERS 8

/** The layers of a frame, and the picture that they become. Zero-initialised is empty; keep it from
 *  frame to frame. */
struct gz_gl_layers {
	struct gz_raster_layer items[GZ_PLAN_RECTANGLES_MAX]; /**< coarsest first */
	int count;
	int width, height; /**< of the picture, px */
	struct gz_gl_points picture;
	unsigned join, pick; /**< programs, OpenGL's names; 0 = not yet made */
};

/**
 * Make the layers of a plan and room for its picture.
 *
 * @param remedy  advice if the driver refuses the program; see gz_gl_program()
 * @retval GZ_ERR_UNSUPPORTED                the driver refuses the program; logged
 * @retval GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE   no room for the picture; logged
 */
enum gz_result gz_gl_layers_prepare(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				    const struct gz_plan *plan, const char *remedy,
				    const struct gz_log *log);

/** Make the points of a layer the viewport of the bound framebuffer, and set its depth: nearest
 *  where only finer layers show, so that a depth test passes nothing there, else farthest. */
void gz_gl_layer_begin(const struct gz_raster_layer *layer);

/**
 * Join the layers into the picture.
 *
 * @param textures    of each layer, at least as large as its points: colours times opacity, and
 *                    opacity; row 0 on top
 * @param background  red, green, blue of what is behind, [0, 1]
 */
void gz_gl_layers_join(const struct gz_gl_layers *layers,
		       const unsigned textures[GZ_PLAN_RECTANGLES_MAX], const double background[3]);

/**
 * Make a plane of numbers in place of the picture, which has been delivered: each pixel takes the
 * nearest point of the layer that it shows most.
 *
 * @param textures   of each layer, R32UI; row 0 on top
 * @param out_words  of the picture's size
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_gl_layers_pick(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				 const unsigned textures[GZ_PLAN_RECTANGLES_MAX],
				 uint32_t *out_words);

/**
 * Copy the picture to where it is wanted, and check for errors of the frame.
 *
 * @param image  of the picture's size; NULL: into layers->picture.picture, a texture
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_NO_MEM, GZ_ERR_UNSUPPORTED  logged
 */
enum gz_result gz_gl_layers_deliver(struct gz_gl_layers *layers, const struct gz_gl_device *device,
				    struct gz_image *image, const struct gz_log *log);

/** Points of all layers that are drawn. */
uint64_t gz_gl_layers_drawn(const struct gz_gl_layers *layers);

/** Delete all of it and zero the struct. */
void gz_gl_layers_free(struct gz_gl_layers *layers);

/** What a window, or the next technique, expects to find as it left it. */
struct gz_gl_outer_state {
	int framebuffer, viewport[4];
};

/** Note the state before layers are drawn. */
struct gz_gl_outer_state gz_gl_outer_state_leave(void);

/** Return to it: framebuffer and viewport; no vertex array, no blending, no tests. */
void gz_gl_outer_state_return(const struct gz_gl_outer_state *outer);

/* For tests: */

/** The shaders that join layers into the picture, and that pick numbers. */
struct gz_gl_shader gz_gl_join_shader(void);
struct gz_gl_shader gz_gl_pick_shader(void);

#endif
