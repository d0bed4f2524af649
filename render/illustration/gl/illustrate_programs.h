/**
 * @file
 * The program that finds the surfaces of illustrations, and what it knows of a frame. Within this
 * room and for tests.
 */
#ifndef GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_PROGRAMS_H
#define GZ_RENDER_ILLUSTRATION_GL_ILLUSTRATE_PROGRAMS_H

#include "base/log.h"
#include "render/illustration/shading_constants.h"
#include "render/illustration/shared/illustrate_frame.h"
#include "render/opengl/gl_program.h"
#include "render/surface/gl/raster_view.h"

/** The uniform block of shaders/illustrate_block.glsl, byte for byte by the rules of std140. */
struct gz_illustrate_block {
	float origin00[4], origin_dx[4], origin_dy[4];
	float direction00[4], direction_dx[4], direction_dy[4];
	float view_rows[4][4];
	float clip_least[4], clip_greatest[4], clip_plane[4];
	float lamp[4];
};

/** Fill the block of a frame. @param rays  of the plan's pixels, world units @param world_mm  mm of
 *  a world unit */
void gz_illustrate_block_fill(const struct gz_illustrate_frame *frame,
			      const struct gz_ray_frame *rays, double world_mm,
			      const struct gz_raster_view *view,
			      struct gz_illustrate_block *out_block);

/** A look as shaders/illustrate.frag takes it, by the rules of std430. */
struct gz_illustrate_shader_look {
	float lights[4], shape[4], light[4];
	float levels[(GZ_SHADING_LEVELS + 3) / 4 * 4]; /**< whole vectors of four */
};

/** Fill a look of a frame: weights become shares of 1. */
void gz_illustrate_shader_look_fill(const struct gz_illustrate_look *look,
				    struct gz_illustrate_shader_look *out_look);

/** Locations of the uniforms of shaders/illustrate.frag; those of
 *  render/surface/gl/shaders/raster_place.glsl are before them. Literal numbers, since they are
 *  pasted into the shaders' text, as are all others here. */
#define GZ_ILLUSTRATE_LATTICE 0
#define GZ_ILLUSTRATE_POINTS  1
#define GZ_ILLUSTRATE_OBJECT  2
#define GZ_ILLUSTRATE_BEHIND  3

/** Attributes of a vertex, beside GZ_RASTER_POSITION: normals take one for each level. */
#define GZ_ILLUSTRATE_NORMALS 1
#define GZ_ILLUSTRATE_SCALARS 7

/** Texture unit of the layer before. */
#define GZ_ILLUSTRATE_UNIT_BEFORE 0

/** Binding point of the storage buffer of looks. */
#define GZ_ILLUSTRATE_STORAGE_LOOKS 3

/** Make the program that finds meshes on a lattice. Needs a current context. @return OpenGL's name,
 *  which the caller deletes; 0: the driver refuses it, which is logged */
unsigned gz_illustrate_program(const struct gz_log *log);

/** Its vertex and its fragment shader. */
void gz_illustrate_shaders(struct gz_gl_shader out_shaders[2]);

#endif
