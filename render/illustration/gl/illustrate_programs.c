#include "render/illustration/gl/illustrate_programs.h"

#include <string.h>

#include "render/opengl/gl_target.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/surface/gl/raster_meshes.h"

/* Shader texts, embedded when the program is built. */
extern const char gz_glsl_shading_constants_h[];
extern const char gz_glsl_clip_distances_glsl[];
extern const char gz_glsl_raster_place_glsl[];
extern const char gz_glsl_raster_rays_glsl[];
extern const char gz_glsl_illustrate_block_glsl[];
extern const char gz_glsl_illustrate_vert[];
extern const char gz_glsl_illustrate_frag[];

/* Numbers of other rooms as literal ones, since they are pasted into the shaders' text. */
#define BLOCK              1
#define ATTRIBUTE_POSITION 0
#define TARGET_FOUND       3

_Static_assert(BLOCK == GZ_GL_BLOCK_TECHNIQUE, "the block is bound there");
_Static_assert(ATTRIBUTE_POSITION == GZ_RASTER_POSITION, "positions are uploaded there");
_Static_assert(TARGET_FOUND == GZ_GL_TARGET_VECTOR, "targets have vectors there");
_Static_assert(GZ_ILLUSTRATE_STORAGE_LOOKS == GZ_GL_STORAGE_TECHNIQUE, "lower ones are taken");
_Static_assert(GZ_ILLUSTRATE_SCALARS == GZ_ILLUSTRATE_NORMALS + GZ_SHADING_LEVELS,
	       "attributes lie one behind the other");

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char numbers[] = DEFINE("BLOCK", BLOCK) DEFINE("OBJECT", GZ_ILLUSTRATE_OBJECT)
	DEFINE("BEHIND", GZ_ILLUSTRATE_BEHIND) DEFINE("ATTRIBUTE_POSITION", ATTRIBUTE_POSITION)
		DEFINE("ATTRIBUTE_NORMALS", GZ_ILLUSTRATE_NORMALS)
			DEFINE("ATTRIBUTE_SCALARS", GZ_ILLUSTRATE_SCALARS)
				DEFINE("UNIT_BEFORE", GZ_ILLUSTRATE_UNIT_BEFORE)
					DEFINE("STORAGE_LOOKS", GZ_ILLUSTRATE_STORAGE_LOOKS)
						DEFINE("TARGET_FOUND", TARGET_FOUND);

static const char remedy[] = "use --backend cpu";

static void copy_floats3(const float from[3], float out[4])
{
	memcpy(out, from, 3 * sizeof *from);
}

/* A vector in single precision, times a factor. */
static void scale_to_floats3(const double from[3], double factor, float out[4])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (float)(from[axis] * factor);
}

void gz_illustrate_block_fill(const struct gz_illustrate_frame *frame,
			      const struct gz_ray_frame *rays, double world_mm,
			      const struct gz_raster_view *view,
			      struct gz_illustrate_block *out_block)
{
	memset(out_block, 0, sizeof *out_block);
	scale_to_floats3(rays->origin00, world_mm, out_block->origin00);
	scale_to_floats3(rays->origin_dx, world_mm, out_block->origin_dx);
	scale_to_floats3(rays->origin_dy, world_mm, out_block->origin_dy);
	scale_to_floats3(rays->direction00, 1, out_block->direction00);
	scale_to_floats3(rays->direction_dx, 1, out_block->direction_dx);
	scale_to_floats3(rays->direction_dy, 1, out_block->direction_dy);
	memcpy(out_block->view_rows, view->rows, sizeof view->rows);
	copy_floats3(frame->clip_least, out_block->clip_least);
	copy_floats3(frame->clip_greatest, out_block->clip_greatest);
	memcpy(out_block->clip_plane, frame->clip_plane, sizeof frame->clip_plane);
	copy_floats3(frame->lamp, out_block->lamp);
}

void gz_illustrate_shader_look_fill(const struct gz_illustrate_look *look,
				    struct gz_illustrate_shader_look *out_look)
{
	const struct gz_illustrate_weights *weights = &look->weights;
	const float sum = weights->main_light + weights->plateau_light + weights->grazing_light +
			  weights->surface_shape + weights->curvature + weights->plain_light;
	const float scale = sum > 0 ? 1 / sum : 0;
	*out_look = (struct gz_illustrate_shader_look) {
		.lights = { weights->main_light * scale, weights->plateau_light * scale,
			    weights->grazing_light * scale, weights->plain_light * scale },
		.shape = { weights->surface_shape * scale, weights->curvature * scale,
			   sum > 0 ? 0 : weights->flat, look->grazing.exaggeration },
		.light = { look->grazing.light[0], look->grazing.light[1], look->grazing.light[2],
			   (float)look->main_level },
	};
	memcpy(out_look->levels, look->grazing.weights,
	       (GZ_SHADING_LEVELS - 1) * sizeof out_look->levels[0]);
}

void gz_illustrate_shaders(struct gz_gl_shader out_shaders[2])
{
	out_shaders[0] = (struct gz_gl_shader) {
		.stage = GZ_GL_VERTEX,
		.name = "illustrate.vert",
		.parts = { numbers, gz_glsl_shading_constants_h, gz_glsl_illustrate_block_glsl,
			   gz_glsl_clip_distances_glsl, gz_glsl_raster_place_glsl,
			   gz_glsl_illustrate_vert },
		.with_430 = true,
	};
	out_shaders[1] = (struct gz_gl_shader) {
		.stage = GZ_GL_FRAGMENT,
		.name = "illustrate.frag",
		.parts = { numbers, gz_glsl_shading_constants_h, gz_glsl_illustrate_block_glsl,
			   gz_glsl_raster_rays_glsl, gz_glsl_illustrate_frag },
		.with_430 = true,
	};
}

unsigned gz_illustrate_program(const struct gz_log *log)
{
	struct gz_gl_shader shaders[2];
	gz_illustrate_shaders(shaders);
	return gz_gl_program(shaders, 2, remedy, log);
}
