/* The texts of the slicer's shaders. */
#include <string.h>

#include "render/layers/gl_layers.h"
#include "render/reconstruct/gl/gl_reconstruct.h"
#include "render/slices/gl/gl_slice_units.h"
#include "render/slices/gl/gl_slicer.h"

/* Shader texts, embedded when the program is built. */
extern const char gz_glsl_slices_vert[];
extern const char gz_glsl_slices_frag[];
extern const char gz_glsl_cover_vert[];
extern const char gz_glsl_hide_frag[];
extern const char gz_glsl_slices_behind_frag[];

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char slice_units[] = DEFINE("BLENDED", GZ_GL_UNIT_BLENDED);

_Static_assert(GZ_GL_UNIT_BLENDED > GZ_GL_UNIT_ARRIVING && GZ_GL_UNIT_LAYERS > GZ_GL_UNIT_ARRIVING,
	       "units of samples stay bound");

/* A fragment shader that knows what the ray caster's shaders know. */
static struct gz_gl_shader sample_shader(const char *name, const char *defines, const char *text)
{
	struct gz_gl_shader shader = {
		.stage = GZ_GL_FRAGMENT,
		.name = name,
		.defines = defines,
		.parts = { gz_gl_plan_parts[0] },
		.with_430 = true,
	};
	memcpy(&shader.parts[1], gz_gl_sample_parts, sizeof gz_gl_sample_parts);
	shader.parts[1 + GZ_GL_SAMPLE_PARTS] = text;
	return shader;
}

void gz_gl_slice_shaders(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			 char defines[GZ_GL_CAST_DEFINES_SIZE], struct gz_gl_shader out_shaders[2])
{
	gz_gl_cast_defines(kind, device, defines);
	out_shaders[0] = (struct gz_gl_shader) {
		.stage = GZ_GL_VERTEX,
		.name = "slices.vert",
		.parts = { gz_glsl_slices_vert },
		.with_430 = true,
	};
	out_shaders[1] = sample_shader("slices.frag", defines, gz_glsl_slices_frag);
}

/* A triangle over the whole target, nearer than all slices. */
static const struct gz_gl_shader cover = {
	.stage = GZ_GL_VERTEX,
	.name = "cover.vert",
	.parts = { gz_glsl_cover_vert },
	.with_430 = true,
};

void gz_gl_behind_shaders(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			  char defines[GZ_GL_CAST_DEFINES_SIZE], struct gz_gl_shader out_shaders[2])
{
	gz_gl_cast_defines(kind, device, defines);
	out_shaders[0] = cover;
	out_shaders[1] = sample_shader("slices_behind.frag", defines, gz_glsl_slices_behind_frag);
}

void gz_gl_hide_shaders(struct gz_gl_shader out_shaders[2])
{
	out_shaders[0] = cover;
	out_shaders[1] = (struct gz_gl_shader) {
		.stage = GZ_GL_FRAGMENT,
		.name = "hide.frag",
		.parts = { gz_gl_sample_parts[GZ_GL_SAMPLE_CONSTANTS], slice_units,
			   gz_glsl_hide_frag },
		.with_430 = true,
	};
}
