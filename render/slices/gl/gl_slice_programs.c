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

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char slice_units[] = DEFINE("BLENDED", GZ_GL_UNIT_BLENDED);

_Static_assert(GZ_GL_UNIT_BLENDED > GZ_GL_UNIT_COLOURS && GZ_GL_UNIT_LAYERS > GZ_GL_UNIT_COLOURS,
	       "units of samples stay bound");

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
	out_shaders[1] = (struct gz_gl_shader) {
		.stage = GZ_GL_FRAGMENT,
		.name = "slices.frag",
		.defines = defines,
		.parts = { gz_gl_plan_parts[0] },
		.with_430 = true,
	};
	memcpy(&out_shaders[1].parts[1], gz_gl_sample_parts, sizeof gz_gl_sample_parts);
	out_shaders[1].parts[1 + GZ_GL_SAMPLE_PARTS] = gz_glsl_slices_frag;
}

void gz_gl_hide_shaders(struct gz_gl_shader out_shaders[2])
{
	out_shaders[0] = (struct gz_gl_shader) {
		.stage = GZ_GL_VERTEX,
		.name = "cover.vert",
		.parts = { gz_glsl_cover_vert },
		.with_430 = true,
	};
	out_shaders[1] = (struct gz_gl_shader) {
		.stage = GZ_GL_FRAGMENT,
		.name = "hide.frag",
		.parts = { gz_gl_sample_parts[GZ_GL_SAMPLE_CONSTANTS], slice_units,
			   gz_glsl_hide_frag },
		.with_430 = true,
	};
}
