/**
 * @file
 * Pictures on the whole window: one triangle over the viewport, a texture, and a fragment shader.
 * Every call needs a current OpenGL 3.3 context.
 */
#ifndef GZ_VIEW_DRAW_QUAD_H
#define GZ_VIEW_DRAW_QUAD_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** A program that fills the viewport, and a texture for it. Names of OpenGL; 0: none. */
struct gz_fill {
	unsigned program, vertices, texture;
	int width, height; /**< size of the texture, texels; 0: it has no content */
};

/**
 * Compile the program and make an empty texture without filtering, clamped at its edges.
 *
 * @param name      file name of the fragment shader, for messages
 * @param fragment  its source; it gets "in vec2 place", 0 to 1 from the top left corner
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses the shader; logged. gz_fill_free() is still
 * correct
 */
enum gz_result gz_fill_init(struct gz_fill *fill, const char *name, const char *fragment,
			    const struct gz_log *log);

/** Copy RGBA texels, 8 bits each, row 0 on top, into the texture. Its memory is kept while the size
 *  stays the same. */
void gz_fill_upload(struct gz_fill *fill, const uint8_t *rgba, int width, int height);

/** Make the program current for a viewport of @p width times @p height px: uniforms can be set. */
void gz_fill_use(const struct gz_fill *fill, int width, int height);

/** Draw with @p texture in unit 0, the program being current. */
void gz_fill_draw(const struct gz_fill *fill, unsigned texture);

/** Delete program and texture, and zero the struct. Correct after a failed gz_fill_init(). */
void gz_fill_free(struct gz_fill *fill);

/** The picture of the window. */
struct gz_quad {
	struct gz_fill fill;
	unsigned shown; /**< the texture on the screen: the one of fill, or a borrowed one */
};

/** Compile and make what is needed. @return what gz_fill_init() returns */
enum gz_result gz_quad_init(struct gz_quad *quad, const struct gz_log *log);

/** Copy @p image into the texture, and show it from now on. */
void gz_quad_upload(struct gz_quad *quad, const struct gz_image *image);

/** Show @p texture from now on. It stays the caller's. */
void gz_quad_show(struct gz_quad *quad, unsigned texture);

/** Draw the picture over a viewport of @p width times @p height px. */
void gz_quad_draw(const struct gz_quad *quad, int width, int height);

/** Draw the picture as gz_quad_draw() does, but only within a rectangle of the viewport, in pixels
 *  from its lower left corner. */
void gz_quad_draw_part(const struct gz_quad *quad, int width, int height, const int corner[2],
		       const int size[2]);

/** Fill a viewport of @p width times @p height px with the dark ground of an empty window. */
void gz_quad_clear(int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_quad_init(). */
void gz_quad_free(struct gz_quad *quad);

/** The standard picture, to be shown beside another one or subtracted from it. Zero-initialised:
 *  not made yet. */
struct gz_compare {
	struct gz_fill fill;         /**< its texture holds the standard picture */
	int picture, standard, gain; /**< locations of the shader's uniforms */
};

/** Compile and make what is needed. @return what gz_fill_init() returns */
enum gz_result gz_compare_init(struct gz_compare *compare, const struct gz_log *log);

/** Copy the standard picture into the texture. */
void gz_compare_upload(struct gz_compare *compare, const struct gz_image *standard);

/** Draw the standard picture over a viewport of @p width times @p height px, to the right of
 *  @p split, a share of its width. */
void gz_compare_draw_beside(const struct gz_compare *compare, double split, int width, int height);

/** Draw the absolute difference between the standard picture and the texture @p picture, each
 *  colour multiplied by @p gain. */
void gz_compare_draw_difference(const struct gz_compare *compare, unsigned picture, double gain,
				int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_compare_init(). */
void gz_compare_free(struct gz_compare *compare);

#endif
