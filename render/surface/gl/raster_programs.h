/**
 * @file
 * The programs that draw surfaces, and what they know of a frame.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_PROGRAMS_H
#define GZ_RENDER_SURFACE_GL_RASTER_PROGRAMS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/light/gl/gl_surroundings.h"
#include "render/opengl/gl_program.h"
#include "render/surface/gl/raster_view.h"
#include "render/surface/shared/surface_frame.h"

/** The uniform block of shaders/surface_block.glsl, byte for byte by the rules of std140. */
struct gz_raster_block {
	float origin00[4], origin_dx[4], origin_dy[4];
	float direction00[4], direction_dx[4], direction_dy[4];
	float view_rows[4][4];
	float clip_least[4], clip_greatest[4], clip_plane[4];
	float light_towards[4];
	float light_terms[4];
	float scale[4];
	float glass[4];
	float shadow_rows[3][4];
	float shadow_texel[4];
	int32_t are[4];
	struct gz_gl_surroundings around;
};

/** Fill the block of a frame. @param edge  of the shadow map, texels */
void gz_raster_block_fill(const struct gz_surface_frame *frame, const struct gz_raster_view *view,
			  const struct gz_raster_shadow *shadow, int edge,
			  struct gz_raster_block *out_block);

/** Locations of the uniforms of all shaders. */
enum { GZ_RASTER_LATTICE, GZ_RASTER_POINTS, GZ_RASTER_ID, GZ_RASTER_COLOUR };

/** Texture units of the shadow map, and of the pictures around. Literal numbers, since they are
 *  pasted into the shaders' text. */
#define GZ_RASTER_UNIT_SHADOW 0
#define GZ_RASTER_UNIT_CUBE   1

/** Programs. */
enum gz_raster_program {
	GZ_RASTER_SURFACE, /**< meshes in the picture */
	GZ_RASTER_BEHIND,  /**< the surroundings where there is no mesh */
	GZ_RASTER_SHADOW,  /**< meshes in the shadow map */
	GZ_RASTER_PROGRAMS,
};

/** OpenGL's names; 0 = not yet made. Zero-initialised has none. */
struct gz_raster_programs {
	unsigned names[GZ_RASTER_PROGRAMS];
};

/** Make the programs, unless they are there. Needs a current context. GZ_ERR_UNSUPPORTED: the
 * driver refuses one; logged. */
enum gz_result gz_raster_programs_make(struct gz_raster_programs *programs,
				       const struct gz_log *log);

/** Delete them. Needs a current context. */
void gz_raster_programs_free(struct gz_raster_programs *programs);

/** Clip vertices to the clip region, as far as shaders/clip_distances.glsl tells, or not any
 * longer. Needs a current context. */
void gz_raster_clip(bool on);

/** The vertex and the fragment shader of a program. */
void gz_raster_shaders(enum gz_raster_program program, struct gz_gl_shader out_shaders[2]);

#endif
