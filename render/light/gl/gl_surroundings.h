/**
 * @file
 * The surroundings as shaders take them: render/light/shaders/surroundings.glsl.
 */
#ifndef GZ_RENDER_LIGHT_GL_GL_SURROUNDINGS_H
#define GZ_RENDER_LIGHT_GL_GL_SURROUNDINGS_H

#include <stdint.h>

#include "render/light/surroundings.h"

/** The struct Surroundings of the shaders, byte for byte by the rules of std140. */
struct gz_gl_surroundings {
	float axes[3][4];
	float sun[4];
	float ground[4];
	float horizon[4], zenith[4], bright[4], dark[4];
	int32_t kind[4];
};

/** Fill it. */
void gz_gl_surroundings_fill(const struct gz_seen_surroundings *seen,
			     struct gz_gl_surroundings *out_around);

/** Lines of #define that come before the shaders' text, which also needs UNIT_CUBE, the texture
 *  unit of gz_gl_cube_bind(). */
extern const char gz_gl_surroundings_numbers[];

#endif
