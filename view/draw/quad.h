/**
 * @file
 * A picture on the whole window: one texture, one triangle, no filtering. Needs a current OpenGL
 * 3.3 context in every call.
 */
#ifndef GZ_VIEW_DRAW_QUAD_H
#define GZ_VIEW_DRAW_QUAD_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

struct gz_quad {
	unsigned program, vertices, texture; /**< names of OpenGL; 0: none */
	unsigned shown;                      /**< texture: the one above, or another's */
	int width, height;                   /**< of the texture, px */
};

/** Compile and make what is needed. GZ_ERR_UNSUPPORTED: the driver refuses the shaders; logged. */
enum gz_result gz_quad_init(struct gz_quad *quad, const struct gz_log *log);

/** Give the texture the picture's content. */
void gz_quad_upload(struct gz_quad *quad, const struct gz_image *image);

/** Show another's texture, which stays theirs, from now on. */
void gz_quad_show(struct gz_quad *quad, unsigned texture);

/** Draw over a viewport of @p width times @p height px. */
void gz_quad_draw(const struct gz_quad *quad, int width, int height);

/** What is seen where there is no picture: a dark ground. */
void gz_quad_clear(int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_quad_init(). */
void gz_quad_free(struct gz_quad *quad);

#endif
