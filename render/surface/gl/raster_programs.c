#include "render/surface/gl/raster_programs.h"

#include <string.h>

#include <GL/glew.h>

#include "render/reconstruct/gl/gl_plan.h"

/* Shader texts, embedded when the program is built. */
extern const char gz_glsl_light_constants_h[];
extern const char gz_glsl_shine_glsl[];
extern const char gz_glsl_surface_block_glsl[];
extern const char gz_glsl_surroundings_glsl[];
extern const char gz_glsl_clip_distances_glsl[];
extern const char gz_glsl_raster_place_glsl[];
extern const char gz_glsl_raster_rays_glsl[];
extern const char gz_glsl_surface_vert[];
extern const char gz_glsl_surface_frag[];
extern const char gz_glsl_behind_vert[];
extern const char gz_glsl_behind_frag[];
extern const char gz_glsl_shadow_vert[];
extern const char gz_glsl_shadow_frag[];

/* GZ_GL_BLOCK_TECHNIQUE as a literal number, since it is pasted into the shaders' text. */
#define BLOCK 1

_Static_assert(BLOCK == GZ_GL_BLOCK_TECHNIQUE, "the block is bound there");

/* Texels by which a place that the light grazes is lifted off the surface, where the texels that a
 * filter reads lie up to 2 from its place along each axis. Chosen: the least without spots on the
 * tests' surfaces and on bone of a CT. */
#define SHADOW_LIFT 3.0

/* The length of gl_ClipDistance. */
enum { CLIP_DISTANCES = 7 };

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char numbers[] = DEFINE("BLOCK", BLOCK) DEFINE("SHADOW_LIFT", SHADOW_LIFT)
	DEFINE("UNIT_SHADOW", GZ_RASTER_UNIT_SHADOW) DEFINE("UNIT_CUBE", GZ_RASTER_UNIT_CUBE);

static const char remedy[] = "use --backend cpu";

static void copy3(const float from[3], float last, float out[4])
{
	memcpy(out, from, 3 * sizeof *from);
	out[3] = last;
}

void gz_raster_block_fill(const struct gz_surface_frame *frame, const struct gz_raster_view *view,
			  const struct gz_raster_shadow *shadow, int edge,
			  struct gz_raster_block *out_block)
{
	const struct gz_cast_light *light = &frame->light;
	*out_block = (struct gz_raster_block) {
		.light_terms = { light->ambient, light->diffuse, light->specular,
				 light->shininess },
		.scale = { frame->world_per_mm, light->reflection },
		.glass = { frame->refractive_index, frame->least_reflection },
		.shadow_texel = { shadow->texel_mm, 1.0F / (float)edge,
				  shadow->texel_mm / shadow->depth_mm },
		.are = { frame->bounces > 0, frame->shadows },
	};
	copy3(frame->origin00, 0, out_block->origin00);
	copy3(frame->origin_dx, 0, out_block->origin_dx);
	copy3(frame->origin_dy, 0, out_block->origin_dy);
	copy3(frame->direction00, 0, out_block->direction00);
	copy3(frame->direction_dx, 0, out_block->direction_dx);
	copy3(frame->direction_dy, 0, out_block->direction_dy);
	memcpy(out_block->view_rows, view->rows, sizeof view->rows);
	copy3(frame->clip_least, 0, out_block->clip_least);
	copy3(frame->clip_greatest, 0, out_block->clip_greatest);
	memcpy(out_block->clip_plane, frame->clip_plane, sizeof frame->clip_plane);
	copy3(light->towards, 0, out_block->light_towards);
	memcpy(out_block->shadow_rows, shadow->rows, sizeof shadow->rows);
	gz_gl_surroundings_fill(&frame->around, &out_block->around);
}

/* What each program is made of. */
static const struct {
	const char *clip, *place, *vertex_name, *vertex, *fragment_name, *fragment;
} texts[GZ_RASTER_PROGRAMS] = {
	[GZ_RASTER_SURFACE] = { gz_glsl_clip_distances_glsl, gz_glsl_raster_place_glsl,
				"surface.vert", gz_glsl_surface_vert, "surface.frag",
				gz_glsl_surface_frag },
	[GZ_RASTER_BEHIND] = { "", "", "behind.vert", gz_glsl_behind_vert, "behind.frag",
			       gz_glsl_behind_frag },
	[GZ_RASTER_SHADOW] = { gz_glsl_clip_distances_glsl, "", "shadow.vert", gz_glsl_shadow_vert,
			       "shadow.frag", gz_glsl_shadow_frag },
};

void gz_raster_clip(bool on)
{
	for (GLenum i = 0; i < CLIP_DISTANCES; i++)
		if (on)
			glEnable(GL_CLIP_DISTANCE0 + i);
		else
			glDisable(GL_CLIP_DISTANCE0 + i);
}

void gz_raster_shaders(enum gz_raster_program program, struct gz_gl_shader out_shaders[2])
{
	out_shaders[0] = (struct gz_gl_shader) {
		.stage = GZ_GL_VERTEX,
		.name = texts[program].vertex_name,
		.parts = { numbers, gz_gl_surroundings_numbers, gz_glsl_light_constants_h,
			   gz_glsl_surroundings_glsl, gz_glsl_surface_block_glsl,
			   texts[program].clip, texts[program].place, texts[program].vertex },
		.with_430 = true,
	};
	out_shaders[1] = (struct gz_gl_shader) {
		.stage = GZ_GL_FRAGMENT,
		.name = texts[program].fragment_name,
		.parts = { numbers, gz_gl_surroundings_numbers, gz_glsl_light_constants_h,
			   gz_glsl_shine_glsl, gz_glsl_surroundings_glsl,
			   gz_glsl_surface_block_glsl, gz_glsl_raster_rays_glsl,
			   texts[program].fragment },
		.with_430 = true,
	};
}

enum gz_result gz_raster_programs_make(struct gz_raster_programs *programs,
				       const struct gz_log *log)
{
	for (int i = 0; i < GZ_RASTER_PROGRAMS; i++) {
		struct gz_gl_shader shaders[2];
		gz_raster_shaders((enum gz_raster_program)i, shaders);
		if (!programs->names[i])
			programs->names[i] = gz_gl_program(shaders, 2, remedy, log);
		if (!programs->names[i])
			return GZ_ERR_UNSUPPORTED;
	}
	return GZ_OK;
}

void gz_raster_programs_free(struct gz_raster_programs *programs)
{
	for (int i = 0; i < GZ_RASTER_PROGRAMS; i++)
		if (programs->names[i])
			glDeleteProgram(programs->names[i]);
	*programs = (struct gz_raster_programs) { 0 };
}
