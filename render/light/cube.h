/**
 * @file
 * Surroundings from six square pictures, the faces of a cube around the eye: environment.cube of a
 * scene. The folder holds right.png, left.png, front.png, back.png, up.png and down.png, all of one
 * size, each as it is seen from the cube's centre: the picture's left edge is where the eye comes
 * from as it turns to the right, and the lower edge of up.png and the upper one of down.png join
 * front.png.
 *
 * Let d be a direction with the components r, f and u along the cube's right, front and up
 * (gz_cube_axes()), and m the greatest of their absolute values. The face and the place (s, t) on
 * it, -1 to 1 from left to right and from top to bottom, are
 *
 *   |r| = m:  r > 0: right, s = -f / m, t = -u / m      r < 0: left, s =  f / m, t = -u / m
 *   |f| = m:  f > 0: front, s =  r / m, t = -u / m      f < 0: back, s = -r / m, t = -u / m
 *   |u| = m:  u > 0: up,    s =  r / m, t =  f / m      u < 0: down, s =  r / m, t = -f / m
 *
 * Where components are equally long, any of their faces is right: colours are bilinear between
 * texels, and each face has a rim of its neighbours' texels, so that both sides of an edge agree.
 */
#ifndef GZ_RENDER_LIGHT_CUBE_H
#define GZ_RENDER_LIGHT_CUBE_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Longest edge of a face, pixels. Chosen: finer than a screen shows, in 400 MiB. */
#define GZ_CUBE_EDGE_MAX 4096

/** The faces in the order in which they are kept. */
enum gz_cube_face {
	GZ_CUBE_RIGHT,
	GZ_CUBE_LEFT,
	GZ_CUBE_FRONT,
	GZ_CUBE_BACK,
	GZ_CUBE_UP,
	GZ_CUBE_DOWN,
	GZ_CUBE_FACES,
};

/** Six faces, or nothing if zero-initialised. */
struct gz_cube {
	int edge; /**< of a face, pixels, without its rim; 0: nothing */
	/** Pixels as in struct gz_image: face after face, each with edge + 2 rows of as many. */
	uint32_t *texels;
};

/**
 * Check the six files without reading their pixels: they are PNGs, square, and of one size.
 *
 * @retval GZ_ERR_NOT_FOUND  a face is missing; logged with its name
 * @retval GZ_ERR_FORMAT     a face is no PNG, not square, too large or of another size; logged
 */
enum gz_result gz_cube_check(const char *folder, const struct gz_log *log);

/**
 * Read the six faces. 8 and 16 bits, grey, palettes and alpha are read; what a face says about its
 * gamma is followed, and else it is sRGB, as pictures on a screen are.
 *
 * @param[out] out_cube  written on success only; gz_cube_free()
 * @retval GZ_ERR_NOT_FOUND  a face is missing; logged with its name
 * @retval GZ_ERR_FORMAT     a face is damaged, or what gz_cube_check() refuses; logged
 * @retval GZ_ERR_NO_MEM     logged
 */
enum gz_result gz_cube_load(const char *folder, const struct gz_log *log, struct gz_cube *out_cube);

/** How many texels lie before a face of a cube with that edge. At most 2^27. */
static inline size_t gz_cube_first_texel(int edge, int face)
{
	const size_t row = (size_t)edge + 2;
	return (size_t)face * row * row;
}

/** The unit vectors right, front and up of a cube whose top is in direction @p up, any length but
 *  0: x, y and z, turned on the shortest way that takes z there; about x if it points down. */
void gz_cube_axes(const double up[3], double out_axes[3][3]);

/** Free the texels and zero the struct. */
void gz_cube_free(struct gz_cube *cube);

#endif
