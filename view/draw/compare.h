/**
 * @file
 * A picture and the standard one side by side, or their difference. Needs a current OpenGL 3.3
 * context in every call.
 */
#ifndef GZ_VIEW_DRAW_COMPARE_H
#define GZ_VIEW_DRAW_COMPARE_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"

/** Zero-initialised is none. */
struct gz_compare {
	unsigned program, vertices, texture; /**< names of OpenGL; 0: none */
	int picture, standard, gain;         /**< places of the shader's uniforms */
	int width, height;                   /**< of the texture with the standard picture, px */
};

/** Compile and make what is needed. GZ_ERR_UNSUPPORTED: the driver refuses the shader; logged. */
enum gz_result gz_compare_init(struct gz_compare *compare, const struct gz_log *log);

/** Give the texture the standard picture. */
void gz_compare_upload(struct gz_compare *compare, const struct gz_image *standard);

/** Draw the standard picture over a viewport of @p width times @p height px, right of @p split of
 *  its width. */
void gz_compare_draw_beside(const struct gz_compare *compare, double split, int width, int height);

/** Draw the difference to @p picture, a texture, @p gain times: of each colour, what is brighter
 * less what is darker. */
void gz_compare_draw_difference(const struct gz_compare *compare, unsigned picture, double gain,
				int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_compare_init(). */
void gz_compare_free(struct gz_compare *compare);

#endif
