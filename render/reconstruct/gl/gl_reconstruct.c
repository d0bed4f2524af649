#include "render/reconstruct/gl/gl_reconstruct.h"

#include <stdio.h>
#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

/* Shader texts, embedded when the program is built. */
extern const char gz_glsl_plan_constants_h[];
extern const char gz_glsl_plan_glsl[];
extern const char gz_glsl_pyramid_glsl[];
extern const char gz_glsl_fill_comp[];
extern const char gz_glsl_quincunx_comp[];
extern const char gz_glsl_regions_comp[];

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

static const char plan_sizes[] = DEFINE("GROUP_SIZE", GZ_GL_GROUP_SIZE)
	DEFINE("TILE_POINTS", GZ_GL_TILE_POINTS) DEFINE("IMAGE_POINTS", GZ_GL_IMAGE_POINTS);

const char *const gz_gl_plan_parts[GZ_GL_PLAN_PARTS] = { gz_glsl_plan_constants_h, plan_sizes,
							 gz_glsl_plan_glsl };

/* Uniform locations and the work-group edge of the shaders. */
enum { FIRST_ITEM = 0, ITEM_END = 1, LEVEL = 2, BLOCK_EDGE = 8 };
enum { TILES_A_GROUP = GZ_GL_GROUP_SIZE / (GZ_TILE_EDGE * GZ_TILE_EDGE) };

static const char *const plane_defines[GZ_PLANE_KIND_COUNT] = {
	[GZ_PLANE_COLOUR] = "",
	[GZ_PLANE_DEEP_COLOUR] = "#define PLANE_DEEP\n",
	[GZ_PLANE_VALUE] = "#define PLANE_VALUE\n",
	[GZ_PLANE_ID] = "#define PLANE_ID\n",
};

/* Mesa's software renderer reads a storage buffer lane by lane, so shaders read texels there. */
static void make_point_texels(struct gz_gl_points *points)
{
	if (!points->texels)
		glGenTextures(1, &points->texels);
	glBindTexture(GL_TEXTURE_BUFFER, points->texels);
	glTexBuffer(GL_TEXTURE_BUFFER, GL_R32UI, points->points.name);
	glBindTexture(GL_TEXTURE_BUFFER, 0);
}

enum gz_result gz_gl_points_prepare(struct gz_gl_points *points, const struct gz_gl_device *device,
				    size_t count)
{
	const size_t size = count * sizeof(uint32_t);
	const bool grows = size > points->points.size;
	gz_gl_buffer_reserve(&points->points, size, GL_DYNAMIC_COPY);
	if (device->software && grows)
		make_point_texels(points);
	const enum gz_result result = gz_gl_device_errors(device);
	if (result != GZ_OK)
		points->points.size = 0;
	return result;
}

void gz_gl_points_bind(const struct gz_gl_points *points)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_POINTS, points->points.name);
	if (points->texels)
		glBindImageTexture(GZ_GL_IMAGE_POINTS, points->texels, 0, GL_FALSE, 0, GL_READ_ONLY,
				   GL_R32UI);
}

enum gz_result gz_gl_points_read(struct gz_gl_points *points, const struct gz_gl_device *device,
				 size_t first, size_t count, uint32_t *out_words)
{
	const size_t bytes = count * sizeof *out_words;
	const size_t at = gz_gl_buffer_bring(device, &points->points, first * sizeof *out_words,
					     bytes, &points->staging);
	const void *words = glMapBufferRange(GL_COPY_READ_BUFFER, (GLintptr)at, (GLsizeiptr)bytes,
					     GL_MAP_READ_BIT);
	if (!words) {
		const enum gz_result result = gz_gl_device_errors(device);
		return result == GZ_OK ? GZ_ERR_NO_MEM : result;
	}
	memcpy(out_words, words, bytes);
	glUnmapBuffer(GL_COPY_READ_BUFFER);
	return GZ_OK;
}

void gz_gl_points_to_texture(struct gz_gl_points *points, int width, int height)
{
	if (points->picture_width != width || points->picture_height != height) {
		if (points->picture)
			glDeleteTextures(1, &points->picture);
		points->picture = gz_gl_texture(GL_TEXTURE_2D);
		glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, width, height);
		points->picture_width = width;
		points->picture_height = height;
	}
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, points->points.name);
	glBindTexture(GL_TEXTURE_2D, points->picture);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
	glBindTexture(GL_TEXTURE_2D, 0);
	glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void gz_gl_points_free(struct gz_gl_points *points)
{
	gz_gl_buffer_free(&points->points);
	gz_gl_buffer_free(&points->staging);
	if (points->picture)
		glDeleteTextures(1, &points->picture);
	if (points->texels)
		glDeleteTextures(1, &points->texels);
	*points = (struct gz_gl_points) { 0 };
}

const char *gz_gl_device_defines(const struct gz_gl_device *device)
{
	return device->software ? "#define FETCH_IMAGES\n" : "";
}

void gz_gl_dispatch(const struct gz_gl_device *device, struct gz_gl_items items)
{
	const size_t most = (size_t)device->groups_max * items.a_group;
	const size_t end = items.first + items.count;
	for (size_t from = items.first; from < end;) {
		const size_t left = end - from, now = left < most ? left : most;
		glUniform1ui(FIRST_ITEM, (GLuint)from);
		glUniform1ui(ITEM_END, (GLuint)(from + now));
		glDispatchCompute((GLuint)((now + items.a_group - 1) / items.a_group), 1, 1);
		from += now;
	}
}

/* Later passes see what earlier ones have written. */
static void await_points(void)
{
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

/* A pass: its file, and a file before it or NULL. */
struct plane_pass {
	const char *name, *before, *file;
	bool bilinear;
};

/* Use the program of a pass; compile it the first time. */
static enum gz_result use_pass(unsigned *program, const struct plane_pass *pass,
			       const struct gz_gl_reconstruct_job *job)
{
	if (!*program) {
		char defines[120];
		snprintf(defines, sizeof defines, "%s%s%s", plane_defines[job->kind],
			 pass->bilinear ? "#define BILINEAR\n" : "",
			 gz_gl_device_defines(job->device));
		struct gz_gl_shader shader = { .stage = GZ_GL_COMPUTE,
					       .name = pass->name,
					       .defines = defines };
		int count = GZ_GL_PLAN_PARTS;
		memcpy(shader.parts, gz_gl_plan_parts, sizeof gz_gl_plan_parts);
		if (pass->before)
			shader.parts[count++] = pass->before;
		shader.parts[count] = pass->file;
		*program = gz_gl_program(&shader, 1, "use --backend cpu", job->log);
	}
	if (!*program)
		return GZ_ERR_UNSUPPORTED;
	glUseProgram(*program);
	return GZ_OK;
}

/* Object ids are not filtered, so they take the shaders' shorter path. */
static bool is_bilinear(const struct gz_gl_reconstruct_job *job)
{
	return job->plan->filter == GZ_FILTER_BILINEAR || job->kind == GZ_PLANE_ID;
}

/* Use a pass of the pyramid over one lattice, ready for dispatch. */
static enum gz_result use_pyramid_pass(unsigned programs[2], struct plane_pass pass, int level,
				       const struct gz_gl_reconstruct_job *job)
{
	pass.before = gz_glsl_pyramid_glsl;
	pass.bilinear = is_bilinear(job);
	const enum gz_result result = use_pass(&programs[pass.bilinear], &pass, job);
	if (result != GZ_OK)
		return result;
	await_points();
	glUniform1ui(LEVEL, (GLuint)level);
	return GZ_OK;
}

/* Fill the points of a lattice that lie in coarser tiles. */
static enum gz_result fill_pyramid_level(struct gz_gl_reconstruct *programs,
					 const struct gz_gl_reconstruct_job *job, int level)
{
	const size_t tiles = job->plan->tile_count;
	const size_t first = level + 1 < job->plan->layer_count
				     ? job->gl_plan->ranges[level + 1][0].first
				     : tiles;
	if (first == tiles)
		return GZ_OK;
	const struct plane_pass pass = { .name = "fill.comp", .file = gz_glsl_fill_comp };
	const enum gz_result result = use_pyramid_pass(programs->fill[job->kind], pass, level, job);
	if (result == GZ_OK)
		gz_gl_dispatch(job->device, (struct gz_gl_items) { first, tiles - first, 1 });
	return result;
}

/* Fill the points of a lattice that quincunx tiles lack. */
static enum gz_result fill_pyramid_quincunx(struct gz_gl_reconstruct *programs,
					    const struct gz_gl_reconstruct_job *job, int level)
{
	const struct gz_gl_tile_range *range = &job->gl_plan->ranges[level][GZ_TILE_QUINCUNX];
	if (range->count == 0)
		return GZ_OK;
	const struct plane_pass pass = { .name = "quincunx.comp", .file = gz_glsl_quincunx_comp };
	const enum gz_result result =
		use_pyramid_pass(programs->quincunx[job->kind], pass, level, job);
	if (result == GZ_OK)
		gz_gl_dispatch(job->device,
			       (struct gz_gl_items) { range->first, range->count, TILES_A_GROUP });
	return result;
}

static enum gz_result fill_pyramid(struct gz_gl_reconstruct *programs,
				   const struct gz_gl_reconstruct_job *job)
{
	enum gz_result result = GZ_OK;
	for (int level = job->plan->layer_count - 1; level >= 0 && result == GZ_OK; level--) {
		result = fill_pyramid_level(programs, job, level);
		if (result == GZ_OK)
			result = fill_pyramid_quincunx(programs, job, level);
	}
	return result;
}

static enum gz_result fill_regions(struct gz_gl_reconstruct *programs,
				   const struct gz_gl_reconstruct_job *job)
{
	const struct plane_pass pass = { .name = "regions.comp", .file = gz_glsl_regions_comp };
	enum gz_result result = use_pass(&programs->regions[job->kind], &pass, job);
	if (result == GZ_OK)
		result = gz_gl_plan_bind_spans(job->gl_plan, job->plan, job->log);
	if (result != GZ_OK)
		return result;
	await_points();
	glUniform1ui(FIRST_ITEM, 0);
	glDispatchCompute((GLuint)((job->plan->width + BLOCK_EDGE - 1) / BLOCK_EDGE),
			  (GLuint)((job->plan->height + BLOCK_EDGE - 1) / BLOCK_EDGE), 1);
	return GZ_OK;
}

enum gz_result gz_gl_reconstruct(struct gz_gl_reconstruct *programs,
				 const struct gz_gl_reconstruct_job *job)
{
	enum gz_result result = GZ_OK;
	gz_gl_points_bind(job->points);
	if (job->plan->reconstruction == GZ_RECONSTRUCT_PYRAMID)
		result = fill_pyramid(programs, job);
	else if (job->plan->reconstruction == GZ_RECONSTRUCT_REGIONS)
		result = fill_regions(programs, job);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_PIXEL_BUFFER_BARRIER_BIT |
			GL_SHADER_STORAGE_BARRIER_BIT);
	glUseProgram(0);
	return result;
}

void gz_gl_reconstruct_free(struct gz_gl_reconstruct *programs)
{
	const GLuint *names = &programs->fill[0][0];
	/* Without a program GLEW may have no functions yet. */
	for (size_t i = 0; i < sizeof *programs / sizeof *names; i++)
		if (names[i])
			glDeleteProgram(names[i]);
	*programs = (struct gz_gl_reconstruct) { 0 };
}
