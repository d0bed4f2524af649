#include "render/raycast/gl/gl_cast.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <GL/glew.h>

#include "render/data/levels.h"
#include "render/data/voxel_colour.h"
#include "render/reconstruct/gl/gl_reconstruct.h"

#define GZ_LOG_MODULE "gl"

/* Shader texts, embedded when the program is built. */
extern const char gz_glsl_transfer_constants_h[];
extern const char gz_glsl_light_constants_h[];
extern const char gz_glsl_cast_constants_h[];
extern const char gz_glsl_cast_block_glsl[];
extern const char gz_glsl_fetch_glsl[];
extern const char gz_glsl_shine_glsl[];
extern const char gz_glsl_shade_glsl[];
extern const char gz_glsl_surroundings_glsl[];
extern const char gz_glsl_cast_comp[];

#define TEXT_OF(number)      #number
#define DEFINE(name, number) "#define " name " " TEXT_OF(number) "\n"

/* GZ_GL_UNIT_CUBE as a literal number. */
#define UNIT_CUBE 6

_Static_assert(UNIT_CUBE == GZ_GL_UNIT_CUBE, "the pictures are bound there");

static const char cast_sizes[] = DEFINE("COUNT_SLOTS", GZ_GL_COUNT_SLOTS)
	DEFINE("BRICK_EDGE", GZ_GL_BRICK_EDGE) DEFINE("BRICK_STORED_EDGE", GZ_GL_BRICK_STORED_EDGE)
		DEFINE("BRICK_LEVELS", GZ_GL_BRICK_LEVELS) DEFINE("BRICK_LEVEL_BITS",
								  GZ_GL_BRICK_LEVEL_BITS)
			DEFINE("BRICK_PLACE_BITS", GZ_GL_BRICK_PLACE_BITS)
				DEFINE("COLOUR_WEIGHT_SHARE", GZ_GL_COLOUR_WEIGHT_SHARE)
					DEFINE("UNIT_CUBE", UNIT_CUBE)
						DEFINE("NEXT_VISIBLE_ROW", GZ_GL_NEXT_VISIBLE_ROW);

_Static_assert(GZ_GL_COLOUR_WEIGHT_SHARE == GZ_COLOUR_WEIGHT_SHARE, "shaders weigh as C does");

/* Uniform location of the level of detail, and tiles of a work-group. */
enum { LEVEL = 2, TILES_A_GROUP = GZ_GL_GROUP_SIZE / (GZ_TILE_EDGE * GZ_TILE_EDGE) };

/* Bytes from one level's block to the next: a multiple of the alignment that any implementation may
 * demand (GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT is at most 256). */
enum { BLOCK_STRIDE = (sizeof(struct gz_gl_cast_block) + 255) / 256 * 256 };

/* The depth of a ray that meets nothing: shaders need not know infinity. As in cast.comp. */
#define FARTHEST_HIT 1e30F

enum { COUNTS_SIZE = GZ_GL_COUNT_SLOTS * sizeof(uint32_t) };

_Static_assert(GZ_LEVELS_MAX <= GZ_GL_TILE_LEVELS_MAX, "a tile's level of detail fits its bits");

const char *const gz_gl_sample_parts[GZ_GL_SAMPLE_PARTS] = {
	gz_glsl_transfer_constants_h, gz_glsl_light_constants_h,
	gz_glsl_cast_constants_h,     cast_sizes,
	gz_gl_surroundings_numbers,   gz_glsl_surroundings_glsl,
	gz_glsl_cast_block_glsl,      gz_glsl_fetch_glsl,
	gz_glsl_shine_glsl,           gz_glsl_shade_glsl,
};

void gz_gl_cast_defines(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			char out_defines[GZ_GL_CAST_DEFINES_SIZE])
{
	static const char *const texels[GZ_GL_TEXELS_COUNT] = {
		[GZ_GL_TEXELS_PACKED] = "",
		[GZ_GL_TEXELS_SINGLE] = "#define SINGLE\n",
		[GZ_GL_TEXELS_BRICKS] = "#define SINGLE\n#define BRICKS\n",
	};
	snprintf(out_defines, GZ_GL_CAST_DEFINES_SIZE,
		 "#define VOXEL_BITS %zu\n%s%s%s%s%s%s%s%s%s%s", 8 * gz_voxel_size(kind.type),
		 texels[kind.texels], kind.nearest ? "#define NEAREST\n" : "",
		 kind.segments ? "#define SEGMENTS\n" : "", kind.shaded ? "#define SHADED\n" : "",
		 kind.shadowed ? "#define SHADOWED\n" : "", kind.fine ? "#define FINE_TABLE\n" : "",
		 kind.coloured ? "#define COLOURED\n" : "", kind.hits ? "#define HITS\n" : "",
		 kind.deep ? "#define DEEP\n" : "", gz_gl_device_defines(device));
}

struct gz_gl_shader gz_gl_cast_shader(struct gz_gl_cast_kind kind,
				      const struct gz_gl_device *device,
				      char defines[GZ_GL_CAST_DEFINES_SIZE])
{
	struct gz_gl_shader shader = { .stage = GZ_GL_COMPUTE,
				       .name = "cast.comp",
				       .defines = defines };
	const char **parts = &shader.parts[GZ_GL_PLAN_PARTS];
	gz_gl_cast_defines(kind, device, defines);
	memcpy(shader.parts, gz_gl_plan_parts, sizeof gz_gl_plan_parts);
	memcpy(parts, gz_gl_sample_parts, sizeof gz_gl_sample_parts);
	parts[GZ_GL_SAMPLE_PARTS] = gz_glsl_cast_comp;
	return shader;
}

enum gz_result gz_gl_cast_prepare(struct gz_gl_cast *cast, const struct gz_gl_device *device)
{
	gz_gl_buffer_reserve(&cast->blocks, GZ_LEVELS_MAX * BLOCK_STRIDE, GL_STREAM_DRAW);
	gz_gl_buffer_reserve(&cast->counts, COUNTS_SIZE, GL_DYNAMIC_COPY);
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, cast->counts.name);
	glClearBufferData(GL_SHADER_STORAGE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT,
			  NULL);
	return gz_gl_device_errors(device);
}

void gz_gl_cast_set_block(struct gz_gl_cast *cast, int level, const struct gz_gl_cast_block *block)
{
	glBindBuffer(GL_UNIFORM_BUFFER, cast->blocks.name);
	glBufferSubData(GL_UNIFORM_BUFFER, (GLintptr)level * BLOCK_STRIDE, sizeof *block, block);
}

enum gz_result gz_gl_cast_set_hits(struct gz_gl_cast *cast, const struct gz_gl_plan *gl_plan,
				   const struct gz_plan *plan, const struct gz_ray_hits *hits)
{
	struct gz_gl_tiles_placed placed = { 0 };
	const size_t bytes = (plan->tile_count + 1) * GZ_HITS_A_TILE * sizeof(uint32_t[2]);
	uint32_t(*words)[2] = gz_gl_buffer_map_new(&cast->hits, bytes);
	if (!words)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < plan->tile_count; i++) {
		const size_t place = gz_gl_plan_place(gl_plan, &plan->tiles[i], &placed);
		for (int k = 0; k < GZ_HITS_A_TILE; k++) {
			const size_t from = i * GZ_HITS_A_TILE + (size_t)k;
			const float depth = fminf(hits->depth[from], FARTHEST_HIT);
			uint32_t *to = words[place * GZ_HITS_A_TILE + (size_t)k];
			memcpy(&to[0], &depth, sizeof depth);
			to[1] = depth < FARTHEST_HIT ? hits->pixels[from] : 0;
		}
	}
	glUnmapBuffer(GL_SHADER_STORAGE_BUFFER);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_HITS, cast->hits.name);
	return GZ_OK;
}

/* Use the program of a kind of cast; compile it the first time. */
static enum gz_result use_cast_program(struct gz_gl_cast *cast, const struct gz_gl_cast_job *job)
{
	const struct gz_gl_cast_kind kind = job->kind;
	unsigned *program =
		&cast->programs[kind.texels][kind.type][kind.nearest][kind.segments][kind.shaded]
			       [kind.shadowed][kind.fine][kind.coloured][kind.hits][kind.deep];
	if (!*program) {
		char defines[GZ_GL_CAST_DEFINES_SIZE];
		const struct gz_gl_shader shader = gz_gl_cast_shader(kind, job->device, defines);
		*program = gz_gl_program(&shader, 1, "use --backend cpu", job->log);
	}
	if (!*program)
		return GZ_ERR_UNSUPPORTED;
	glUseProgram(*program);
	return GZ_OK;
}

enum gz_result gz_gl_cast_tiles(struct gz_gl_cast *cast, const struct gz_gl_cast_job *job)
{
	const struct gz_gl_tile_range *range = &job->gl_plan->level_ranges[job->level];
	const enum gz_result result = use_cast_program(cast, job);
	if (result != GZ_OK)
		return result;
	glBindBufferRange(GL_UNIFORM_BUFFER, GZ_GL_BLOCK_TECHNIQUE, cast->blocks.name,
			  (GLintptr)job->level * BLOCK_STRIDE, sizeof(struct gz_gl_cast_block));
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_GL_STORAGE_COUNTS, cast->counts.name);
	glUniform1ui(LEVEL, (GLuint)job->level);
	gz_gl_dispatch(job->device,
		       (struct gz_gl_items) { range->first, range->count, TILES_A_GROUP });
	return GZ_OK;
}

uint64_t gz_gl_cast_samples(struct gz_gl_cast *cast, const struct gz_gl_device *device)
{
	uint32_t counts[GZ_GL_COUNT_SLOTS] = { 0 };
	uint64_t sum = 0;
	const size_t at = gz_gl_buffer_bring(device, &cast->counts, 0, COUNTS_SIZE, &cast->staging);
	glGetBufferSubData(GL_COPY_READ_BUFFER, (GLintptr)at, sizeof counts, counts);
	for (int i = 0; i < GZ_GL_COUNT_SLOTS; i++)
		sum += counts[i];
	return sum;
}

void gz_gl_cast_free(struct gz_gl_cast *cast)
{
	const GLuint *programs = &cast->programs[0][0][0][0][0][0][0][0][0][0];
	for (size_t i = 0; i < sizeof cast->programs / sizeof(GLuint); i++)
		if (programs[i])
			glDeleteProgram(programs[i]);
	gz_gl_buffer_free(&cast->blocks);
	gz_gl_buffer_free(&cast->counts);
	gz_gl_buffer_free(&cast->hits);
	gz_gl_buffer_free(&cast->staging);
	*cast = (struct gz_gl_cast) { 0 };
}
