#include "render/gl/gl_passes.h"

#include <stdio.h>

#include <GL/glew.h>

#include "render/gl/compute_program.h"

#define GZ_LOG_MODULE "gl"

/* Made from shaders/ when the program is built. */
extern const char gz_glsl_frame_glsl[];
extern const char gz_glsl_fetch_glsl[];
extern const char gz_glsl_shade_glsl[];
extern const char gz_glsl_pyramid_glsl[];
extern const char gz_glsl_cast_comp[];
extern const char gz_glsl_fill_comp[];
extern const char gz_glsl_quincunx_comp[];
extern const char gz_glsl_regions_comp[];

/* Locations and sizes of the shaders. */
enum { FIRST_ITEM = 0, ITEM_END = 1, LEVEL = 2, BLOCK_EDGE = 8 };
enum { TILES_A_GROUP = GZ_GL_GROUP_SIZE / (GZ_TILE_EDGE * GZ_TILE_EDGE) };

/* The program, made if there is none yet. */
static enum gz_result use(unsigned *program, const struct gz_compute_text *text,
			  const struct gz_log *log)
{
	if (!*program)
		*program = gz_compute_program(text, log);
	if (!*program)
		return GZ_ERR_UNSUPPORTED;
	glUseProgram(*program);
	return GZ_OK;
}

/* Run the program over items [first, first + count), @p items_a_group to a work-group, in as many
 * dispatches as it takes. */
static void dispatch(const struct gz_gl_device *device, size_t first, size_t count,
		     size_t items_a_group)
{
	const size_t most = (size_t)device->groups_max * items_a_group;
	for (size_t from = first; from < first + count;) {
		const size_t left = first + count - from, now = left < most ? left : most;
		glUniform1ui(FIRST_ITEM, (GLuint)from);
		glUniform1ui(ITEM_END, (GLuint)(from + now));
		glDispatchCompute((GLuint)((now + items_a_group - 1) / items_a_group), 1, 1);
		from += now;
	}
}

static void await_points(void)
{
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

/* What all shaders are told of the device. */
static const char *fetch_define(const struct gz_gl_device *device)
{
	return device->software ? "#define FETCH_IMAGES\n" : "";
}

enum gz_result gz_gl_cast(struct gz_gl_passes *passes, const struct gz_gl_device *device,
			  const struct gz_gl_frame *frame, int level, struct gz_gl_cast_kind kind,
			  const struct gz_log *log)
{
	static const char *const texels[GZ_GL_TEXELS_COUNT] = {
		[GZ_GL_TEXELS_PACKED] = "",
		[GZ_GL_TEXELS_SINGLE] = "#define SINGLE\n",
		[GZ_GL_TEXELS_BRICKS] = "#define SINGLE\n#define BRICKS\n",
	};
	char defines[200];
	snprintf(defines, sizeof defines, "#define VOXEL_BITS %zu\n%s%s%s%s%s",
		 8 * gz_voxel_size(kind.type), texels[kind.texels],
		 kind.nearest ? "#define NEAREST\n" : "", kind.segments ? "#define SEGMENTS\n" : "",
		 kind.shaded ? "#define SHADED\n" : "", fetch_define(device));
	const struct gz_compute_text text = {
		.name = "cast.comp",
		.defines = defines,
		.parts = { gz_glsl_frame_glsl, gz_glsl_fetch_glsl, gz_glsl_shade_glsl,
			   gz_glsl_cast_comp },
	};
	const struct gz_gl_tile_range *range = &frame->level_ranges[level];
	const enum gz_result result =
		use(&passes->cast[kind.texels][kind.type][kind.nearest][kind.segments][kind.shaded],
		    &text, log);
	if (result != GZ_OK)
		return result;
	glUniform1ui(LEVEL, (GLuint)level);
	dispatch(device, range->first, range->count, TILES_A_GROUP);
	return GZ_OK;
}

/* A pass of the pyramid over lattice @p level, ready to be dispatched. */
static enum gz_result use_filter(unsigned programs[2], const char *name, const char *shader,
				 const struct gz_gl_device *device, const struct gz_plan *plan,
				 int level, const struct gz_log *log)
{
	const bool bilinear = plan->filter == GZ_FILTER_BILINEAR;
	char defines[80];
	snprintf(defines, sizeof defines, "%s%s", bilinear ? "#define BILINEAR\n" : "",
		 fetch_define(device));
	const struct gz_compute_text text = {
		.name = name,
		.defines = defines,
		.parts = { gz_glsl_frame_glsl, gz_glsl_pyramid_glsl, shader },
	};
	const enum gz_result result = use(&programs[bilinear], &text, log);
	if (result != GZ_OK)
		return result;
	await_points();
	glUniform1ui(LEVEL, (GLuint)level);
	return GZ_OK;
}

/* Points of lattice @p level that lie in coarser tiles. */
static enum gz_result fill_level(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				 const struct gz_gl_frame *frame, const struct gz_plan *plan,
				 int level, const struct gz_log *log)
{
	const size_t first = level + 1 < plan->layer_count ? frame->ranges[level + 1][0].first
							   : plan->tile_count;
	if (first == plan->tile_count)
		return GZ_OK;
	const enum gz_result result =
		use_filter(passes->fill, "fill.comp", gz_glsl_fill_comp, device, plan, level, log);
	if (result == GZ_OK)
		dispatch(device, first, plan->tile_count - first, 1);
	return result;
}

/* Points of lattice @p level between those of quincunx tiles. */
static enum gz_result fill_quincunx(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				    const struct gz_gl_frame *frame, const struct gz_plan *plan,
				    int level, const struct gz_log *log)
{
	const struct gz_gl_tile_range *range = &frame->ranges[level][GZ_TILE_QUINCUNX];
	if (range->count == 0)
		return GZ_OK;
	const enum gz_result result = use_filter(passes->quincunx, "quincunx.comp",
						 gz_glsl_quincunx_comp, device, plan, level, log);
	if (result == GZ_OK)
		dispatch(device, range->first, range->count, TILES_A_GROUP);
	return result;
}

static enum gz_result fill_pyramid(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				   const struct gz_gl_frame *frame, const struct gz_plan *plan,
				   const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	for (int level = plan->layer_count - 1; level >= 0 && result == GZ_OK; level--) {
		result = fill_level(passes, device, frame, plan, level, log);
		if (result == GZ_OK)
			result = fill_quincunx(passes, device, frame, plan, level, log);
	}
	return result;
}

static enum gz_result fill_regions(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				   struct gz_gl_frame *frame, const struct gz_plan *plan,
				   const struct gz_log *log)
{
	const struct gz_compute_text text = {
		.name = "regions.comp",
		.defines = fetch_define(device),
		.parts = { gz_glsl_frame_glsl, gz_glsl_regions_comp },
	};
	enum gz_result result = use(&passes->regions, &text, log);
	if (result == GZ_OK)
		result = gz_gl_frame_spans(frame, device, plan, log);
	if (result != GZ_OK)
		return result;
	await_points();
	glUniform1ui(FIRST_ITEM, 0);
	glDispatchCompute((GLuint)((plan->width + BLOCK_EDGE - 1) / BLOCK_EDGE),
			  (GLuint)((plan->height + BLOCK_EDGE - 1) / BLOCK_EDGE), 1);
	return GZ_OK;
}

enum gz_result gz_gl_reconstruct(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				 struct gz_gl_frame *frame, const struct gz_plan *plan,
				 const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	if (plan->reconstruction == GZ_RECONSTRUCT_PYRAMID)
		result = fill_pyramid(passes, device, frame, plan, log);
	else if (plan->reconstruction == GZ_RECONSTRUCT_REGIONS)
		result = fill_regions(passes, device, frame, plan, log);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT |
			GL_SHADER_STORAGE_BARRIER_BIT);
	glUseProgram(0);
	return result;
}

static void delete_programs(const GLuint *programs, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (programs[i])
			glDeleteProgram(programs[i]);
}

void gz_gl_passes_free(struct gz_gl_passes *passes)
{
	delete_programs((const GLuint *)passes->cast, sizeof passes->cast / sizeof(GLuint));
	delete_programs(passes->fill, 2);
	delete_programs(passes->quincunx, 2);
	delete_programs(&passes->regions, 1);
	*passes = (struct gz_gl_passes) { 0 };
}
