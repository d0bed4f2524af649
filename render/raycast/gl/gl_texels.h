/**
 * @file
 * What a texel of voxels holds.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_TEXELS_H
#define GZ_RENDER_RAYCAST_GL_GL_TEXELS_H

#include <stddef.h>

#include "render/data/volume.h"

/** How voxels lie in textures; the shaders have a variant for each (shaders/fetch.glsl). */
enum gz_gl_texels {
	/** 32 bits each: a voxel with those neighbours along x, y that fit. Fewest fetches. */
	GZ_GL_TEXELS_PACKED,
	GZ_GL_TEXELS_SINGLE, /**< a voxel each, of its own size */
	GZ_GL_TEXELS_BRICKS, /**< a voxel each, in the rooms of an atlas (gl_bricks.h) */
	GZ_GL_TEXELS_COUNT,
};

/** A format in OpenGL's words. */
struct gz_gl_texel_format {
	unsigned internal, external, type;
	size_t bytes; /**< a texel */
};

/** The format of such texels. Static. */
const struct gz_gl_texel_format *gz_gl_texel_format(enum gz_gl_texels texels,
						    enum gz_voxel_type type);

#endif
