#include "render/slices/gl/gl_slicer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "render/layers/gl_layers.h"
#include "render/raycast/gl/gl_scene.h"
#include "render/slices/gl/gl_slice_target.h"
#include "render/slices/gl/gl_slice_units.h"
#include "render/slices/gl/slice_cut.h"

#define GZ_LOG_MODULE "slices"

/* Moments of a frame. */
enum { MARK_START, MARK_DRAWN, MARK_END };

/* Parts in which the slices of a layer are drawn; after each, points are closed that need no more.
 * Chosen: closing then costs a hundredth of 512 slices. */
enum { PARTS = 16, QUERIES = PARTS * GZ_PLAN_RECTANGLES_MAX };

static const char remedy[] = "use --technique raycast";

struct gz_gl_slicer {
	const struct gz_log *log;
	struct gz_gl_device device;
	struct gz_gl_scene scene;
	struct gz_slice_cut cut;
	uint64_t corners_revision; /* of the cut whose corners the device has; 0 = none */
	struct gz_gl_layers layers;
	struct gz_gl_slice_target targets[GZ_PLAN_RECTANGLES_MAX];
	struct gz_gl_buffer corners, block;
	unsigned vertices, no_vertices; /* vertex arrays: of the corners, and of nothing */
	/* OpenGL's names, by the members of struct gz_gl_cast_kind; 0 = not yet made. */
	unsigned programs[GZ_GL_TEXELS_COUNT][GZ_VOXEL_TYPE_COUNT][2][2][2][2][2][2];
	unsigned hide, behind;
	unsigned queries[QUERIES]; /* samples of each part; 0 = none made yet */
	int query_count;           /* of this frame */
	struct gz_gl_timer timer;
	bool wait_for_bricks;
};

/* What the steps of one picture share. */
struct slicing {
	struct gz_gl_slicer *slicer;
	const struct gz_ray_params *rays;
	const struct gz_plan *plan;
	struct gz_ray_frame near_rays; /* from the first depth of the box on */
	struct gz_gl_frame frame;
	struct gz_gl_tile_levels levels;
};

/* Make the context current until gz_gl_device_leave(). A lost context is logged. */
static enum gz_result enter_device(const struct gz_gl_slicer *slicer)
{
	const enum gz_result result = gz_gl_device_enter(&slicer->device);
	if (result != GZ_OK)
		gz_err(slicer->log, "the OpenGL context cannot be used any more");
	return result;
}

static void delete_programs(struct gz_gl_slicer *slicer)
{
	const GLuint *programs = &slicer->programs[0][0][0][0][0][0][0][0];
	for (size_t i = 0; i < sizeof slicer->programs / sizeof(GLuint); i++)
		if (programs[i])
			glDeleteProgram(programs[i]);
	if (slicer->hide)
		glDeleteProgram(slicer->hide);
	if (slicer->behind)
		glDeleteProgram(slicer->behind);
}

static void delete_objects(struct gz_gl_slicer *slicer)
{
	delete_programs(slicer);
	gz_gl_scene_free(&slicer->scene);
	gz_gl_layers_free(&slicer->layers);
	gz_gl_buffer_free(&slicer->corners);
	gz_gl_buffer_free(&slicer->block);
	gz_gl_timer_free(&slicer->timer);
	for (int i = 0; i < GZ_PLAN_RECTANGLES_MAX; i++)
		gz_gl_slice_target_free(&slicer->targets[i]);
	if (slicer->vertices)
		glDeleteVertexArrays(1, &slicer->vertices);
	if (slicer->no_vertices)
		glDeleteVertexArrays(1, &slicer->no_vertices);
	if (slicer->queries[0])
		glDeleteQueries(QUERIES, slicer->queries);
}

void gz_gl_slicer_destroy(struct gz_gl_slicer **slicer)
{
	struct gz_gl_slicer *self = *slicer;
	if (!self)
		return;
	if (gz_gl_device_enter(&self->device) == GZ_OK) {
		delete_objects(self);
		gz_gl_device_leave(&self->device);
	} else {
		/* A lost context took its objects with it. */
		gz_gl_scene_forget(&self->scene);
	}
	gz_gl_device_destroy(&self->device);
	gz_slice_cut_free(&self->cut);
	free(self);
	*slicer = NULL;
}

enum gz_result gz_gl_slicer_create(const struct gz_backend_params *params, const struct gz_log *log,
				   struct gz_gl_slicer **out_slicer)
{
	const struct gz_gl_setup setup = {
		.lent = params->gl_context,
		.hardware_only = params->gl_hardware_only,
		.memory_bytes = params->gl_memory_bytes,
	};
	struct gz_gl_slicer *slicer = calloc(1, sizeof *slicer);
	if (!slicer)
		return GZ_ERR_NO_MEM;
	slicer->log = log;
	slicer->wait_for_bricks = params->wait_for_bricks;
	const enum gz_result result = gz_gl_device_create(&setup, log, &slicer->device);
	if (result != GZ_OK) {
		free(slicer);
		return result;
	}
	*out_slicer = slicer;
	return GZ_OK;
}

enum gz_result gz_gl_slicer_set_volume(struct gz_gl_slicer *slicer, const struct gz_volume *volume)
{
	slicer->scene.volume = NULL; /* borrowed until now */
	enum gz_result result = enter_device(slicer);
	if (result != GZ_OK)
		return result;
	result = gz_gl_scene_set_volume(&slicer->scene, &slicer->device, volume, slicer->log);
	gz_gl_device_leave(&slicer->device);
	return result;
}

enum gz_result gz_gl_slicer_set_transfer(struct gz_gl_slicer *slicer,
					 const struct gz_transfer *transfer)
{
	if (!slicer->scene.volume)
		return GZ_ERR_INVAL;
	enum gz_result result = enter_device(slicer);
	if (result != GZ_OK)
		return result;
	result = gz_gl_scene_set_transfer(&slicer->scene, transfer);
	if (result == GZ_OK)
		result = gz_gl_device_errors(&slicer->device);
	gz_gl_device_leave(&slicer->device);
	if (result != GZ_OK)
		gz_err(slicer->log, "the graphics device did not take the transfer function: %s",
		       gz_result_text(result));
	return result;
}

static bool make_program(unsigned *program, const struct gz_gl_shader *shaders, int count,
			 const struct gz_log *log)
{
	if (!*program)
		*program = gz_gl_program(shaders, count, remedy, log);
	return *program != 0;
}

/* The kind of samples of a level of detail. */
static struct gz_gl_cast_kind sample_kind(const struct slicing *slicing, int level)
{
	const struct gz_gl_slicer *slicer = slicing->slicer;
	const struct gz_volume *volume = slicer->scene.volume;
	return (struct gz_gl_cast_kind) {
		.texels = slicer->scene.levels[level].texels,
		.type = volume->type,
		.nearest = gz_ray_samples_nearest(slicing->rays, volume),
		.segments = slicing->rays->integration == GZ_INTEGRATION_PREINTEGRATED,
		.shaded = slicing->rays->shading == GZ_SHADING_GRADIENT,
		.shadowed = slicing->rays->light.shadow_steps > 0,
		.fine = slicer->scene.table->count > GZ_TRANSFER_TABLE_SIZE,
		.coloured = volume->colours != NULL,
	};
}

/* The program for slices of one level of detail; 0 if the driver refuses it. */
static unsigned slice_program(const struct slicing *slicing, int level)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	const struct gz_gl_cast_kind kind = sample_kind(slicing, level);
	unsigned *program = &slicer->programs[kind.texels][kind.type][kind.nearest][kind.segments]
					     [kind.shaded][kind.shadowed][kind.fine][kind.coloured];
	if (!*program) {
		char defines[GZ_GL_CAST_DEFINES_SIZE];
		struct gz_gl_shader shaders[2];
		gz_gl_slice_shaders(kind, &slicer->device, defines, shaders);
		make_program(program, shaders, 2, slicer->log);
	}
	return *program;
}

/* The programs that fill whole targets, as far as the frame needs them. */
static bool make_fill_programs(const struct slicing *slicing)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	char defines[GZ_GL_CAST_DEFINES_SIZE];
	struct gz_gl_shader hide[2], behind[2];
	gz_gl_hide_shaders(hide);
	if (!make_program(&slicer->hide, hide, 2, slicer->log))
		return false;
	if (slicing->rays->environment.kind == GZ_SURROUNDINGS_NONE)
		return true;
	gz_gl_behind_shaders(sample_kind(slicing, 0), &slicer->device, defines, behind);
	return make_program(&slicer->behind, behind, 2, slicer->log);
}

/* Cut the box for the camera, and move the rays' origins to its first depth: places along rays are
 * then small numbers, which single precision holds. */
static enum gz_result cut_volume(struct slicing *slicing, const struct gz_ray_frame *world)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	struct gz_slice_request request = { .rays = *world, .count = slicing->rays->slicing.count };
	gz_volume_half_extent(slicer->scene.volume, request.half);
	double edges[3], corner[3];
	for (int axis = 0; axis < 3; axis++) {
		edges[axis] = 2 * request.half[axis];
		corner[axis] = -request.half[axis];
	}
	gz_clip_region_place(&slicing->rays->clip, slicer->scene.volume, edges, corner,
			     &request.shown);
	const enum gz_result result = gz_slice_cut_make(&request, &slicer->cut);
	if (result == GZ_ERR_NO_MEM)
		gz_err(slicer->log, "no memory for %d slices", request.count);
	if (result != GZ_OK)
		return result;
	slicing->near_rays = *world;
	const double near = slicer->cut.near;
	slicing->frame.near = near;
	for (int axis = 0; axis < 3; axis++) {
		slicing->near_rays.origin00[axis] += near * world->direction00[axis];
		slicing->near_rays.origin_dx[axis] += near * world->direction_dx[axis];
		slicing->near_rays.origin_dy[axis] += near * world->direction_dy[axis];
	}
	return GZ_OK;
}

/* Upload the corners of the slices, unless the device has them. */
static void upload_corners(struct gz_gl_slicer *slicer)
{
	const struct gz_slice_cut *cut = &slicer->cut;
	const size_t size = (size_t)cut->first[cut->count] * sizeof *cut->corners;
	if (slicer->corners_revision == cut->revision || size == 0)
		return;
	if (!slicer->vertices) {
		glGenVertexArrays(1, &slicer->vertices);
		glGenVertexArrays(1, &slicer->no_vertices);
	}
	gz_gl_buffer_reserve(&slicer->corners, size, GL_STREAM_DRAW);
	glBindVertexArray(slicer->vertices);
	glBindBuffer(GL_ARRAY_BUFFER, slicer->corners.name);
	glBufferSubData(GL_ARRAY_BUFFER, 0, (GLsizeiptr)size, cut->corners);
	glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof *cut->corners, NULL);
	glEnableVertexAttribArray(0);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glBindVertexArray(0);
	slicer->corners_revision = cut->revision;
}

/* Make room on the device for the layers. */
static enum gz_result reserve_targets(struct gz_gl_slicer *slicer)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < slicer->layers.count && result == GZ_OK; i++)
		result = gz_gl_slice_target_reserve(&slicer->targets[i], &slicer->device,
						    &slicer->layers.items[i], slicer->log);
	if (result != GZ_OK)
		return result;
	gz_gl_buffer_reserve(&slicer->block, sizeof(struct gz_gl_cast_block), GL_STREAM_DRAW);
	if (!slicer->queries[0])
		glGenQueries(QUERIES, slicer->queries);
	return GZ_OK;
}

static enum gz_result prepare_slices(struct slicing *slicing, const struct gz_ray_frame *world)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	enum gz_result result = cut_volume(slicing, world);
	if (result != GZ_OK)
		return result;
	slicer->query_count = 0;
	result = gz_gl_layers_prepare(&slicer->layers, &slicer->device, slicing->plan, remedy,
				      slicer->log);
	if (result == GZ_OK)
		result = gz_gl_scene_prepare(&slicer->scene, &slicer->device, &slicing->frame,
					     &slicing->levels, slicer->log);
	if (result == GZ_OK)
		result = reserve_targets(slicer);
	if (result == GZ_OK && !make_fill_programs(slicing))
		result = GZ_ERR_UNSUPPORTED;
	if (result == GZ_OK)
		upload_corners(slicer);
	return result;
}

/* The level of detail of a layer: that of rays with its spacing and the plan's shortest step. */
static int level_of(const struct slicing *slicing, const struct gz_raster_layer *layer)
{
	const struct gz_plan *plan = slicing->plan;
	int level = 0, spacing = 0;
	for (int i = 0; i < plan->layer_count; i++)
		if (plan->layers[i].spacing <= layer->spacing &&
		    plan->layers[i].spacing > spacing) {
			spacing = plan->layers[i].spacing;
			level = slicing->levels.of[i][GZ_TILE_SQUARE][0];
		}
	return level;
}

/* Use the program and the data of a layer. */
static enum gz_result bind_layer(const struct slicing *slicing, const struct gz_raster_layer *layer,
				 unsigned *out_program)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	const int level = level_of(slicing, layer);
	struct gz_gl_cast_block block = { 0 };
	*out_program = slice_program(slicing, level);
	if (!*out_program)
		return GZ_ERR_UNSUPPORTED;
	gz_gl_scene_fill(&slicer->scene, level, &slicing->frame, &block);
	glBindBuffer(GL_UNIFORM_BUFFER, slicer->block.name);
	glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block, &block);
	glBindBufferBase(GL_UNIFORM_BUFFER, GZ_GL_BLOCK_TECHNIQUE, slicer->block.name);
	gz_gl_scene_bind(&slicer->scene);
	gz_gl_volume_bind(&slicer->scene.levels[level], slicer->scene.volume->type);
	glUseProgram(*out_program);
	glUniform3f(GZ_GL_SLICES_LATTICE, (float)layer->from[0], (float)layer->from[1],
		    (float)layer->spacing);
	glUniform2f(GZ_GL_SLICES_POINTS, (float)layer->points[0], (float)layer->points[1]);
	const double gap = slicer->cut.distance;
	glUniform2f(GZ_GL_SLICES_GAP, (float)gap,
		    (float)(gap / gz_volume_voxel_length(slicer->scene.volume)));
	return GZ_OK;
}

/* Close the points of a target that hardly any light comes through. */
static void close_opaque(const struct gz_gl_slicer *slicer, const struct gz_gl_slice_target *target)
{
	gz_gl_slice_target_close(target);
	glUseProgram(slicer->hide);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_BLENDED);
	glBindTexture(GL_TEXTURE_2D, target->blended);
	glActiveTexture(GL_TEXTURE0);
	glBindVertexArray(slicer->no_vertices);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	gz_gl_slice_target_open(target);
}

/* Draw the surroundings where light comes through all slices. */
static void draw_behind_slices(const struct gz_gl_slicer *slicer,
			       const struct gz_raster_layer *layer)
{
	glUseProgram(slicer->behind);
	glUniform3f(GZ_GL_SLICES_LATTICE, (float)layer->from[0], (float)layer->from[1],
		    (float)layer->spacing);
	glBindVertexArray(slicer->no_vertices);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* Draw the slices of a layer, nearest first. */
static enum gz_result draw_layer(const struct slicing *slicing, int index)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	const struct gz_slice_cut *cut = &slicer->cut;
	const struct gz_gl_slice_target *target = &slicer->targets[index];
	unsigned program = 0;
	const enum gz_result result = bind_layer(slicing, &slicer->layers.items[index], &program);
	if (result != GZ_OK)
		return result;
	gz_gl_slice_target_begin(target, &slicer->layers.items[index]);
	for (int part = 0; part < PARTS; part++) {
		const int first = cut->first[cut->count * part / PARTS];
		const int end = cut->first[cut->count * (part + 1) / PARTS];
		if (first == end)
			continue;
		glUseProgram(program);
		glBindVertexArray(slicer->vertices);
		glBeginQuery(GL_SAMPLES_PASSED, slicer->queries[slicer->query_count++]);
		glDrawArrays(GL_TRIANGLES, first, end - first);
		glEndQuery(GL_SAMPLES_PASSED);
		if (slicing->rays->early_termination && end < cut->first[cut->count])
			close_opaque(slicer, target);
	}
	if (slicing->rays->environment.kind != GZ_SURROUNDINGS_NONE)
		draw_behind_slices(slicer, &slicer->layers.items[index]);
	return GZ_OK;
}

static enum gz_result draw_layers(const struct slicing *slicing)
{
	const struct gz_gl_outer_state outer = gz_gl_outer_state_leave();
	enum gz_result result = GZ_OK;
	for (int i = 0; i < slicing->slicer->layers.count && result == GZ_OK; i++)
		result = draw_layer(slicing, i);
	gz_gl_outer_state_return(&outer);
	return result;
}

/* Join the layers into the picture. */
static void join_layers(const struct slicing *slicing)
{
	const struct gz_gl_slicer *slicer = slicing->slicer;
	unsigned textures[GZ_PLAN_RECTANGLES_MAX] = { 0 };
	for (int i = 0; i < slicer->layers.count; i++)
		textures[i] = slicer->targets[i].blended;
	gz_gl_layers_join(&slicer->layers, textures, slicing->rays->background);
}

static enum gz_result draw_frame(const struct slicing *slicing)
{
	struct gz_gl_slicer *slicer = slicing->slicer;
	gz_gl_timer_mark(&slicer->timer, &slicer->device, MARK_START);
	const enum gz_result result = draw_layers(slicing);
	gz_gl_timer_mark(&slicer->timer, &slicer->device, MARK_DRAWN);
	if (result == GZ_OK)
		join_layers(slicing);
	gz_gl_timer_mark(&slicer->timer, &slicer->device, MARK_END);
	return result;
}

/* Samples taken by this frame. Waits for the device. */
static uint64_t count_samples(const struct gz_gl_slicer *slicer)
{
	uint64_t sum = 0;
	for (int i = 0; i < slicer->query_count; i++) {
		GLuint64 samples = 0;
		glGetQueryObjectui64v(slicer->queries[i], GL_QUERY_RESULT, &samples);
		sum += samples;
	}
	return sum;
}

static struct gz_frame_stats frame_stats(const struct gz_gl_slicer *slicer)
{
	const struct gz_gl_timer *timer = &slicer->timer;
	const struct gz_gl_device *device = &slicer->device;
	struct gz_frame_stats stats = {
		.samples = count_samples(slicer),
		.prepare_ms = slicer->scene.prepare_ms,
		.prepare_within_ms = slicer->scene.prepare_ms,
		.cast_ms = gz_gl_timer_ms(timer, device, MARK_START, MARK_DRAWN),
		.reconstruct_ms = gz_gl_timer_ms(timer, device, MARK_DRAWN, MARK_END),
		.gpu_ms = device->software ? NAN
					   : gz_gl_timer_ms(timer, device, MARK_START, MARK_END),
		.bricks_coming = slicer->scene.bricks.coming,
		.rays = gz_gl_layers_drawn(&slicer->layers),
	};
	return stats;
}

enum gz_result gz_gl_slicer_draw(struct gz_gl_slicer *slicer, const struct gz_shot *shot,
				 struct gz_image *image, struct gz_frame_stats *out_stats)
{
	const struct gz_plan *plan = shot->plan;
	const struct gz_ray_params *rays = shot->settings;
	struct slicing slicing = { .slicer = slicer, .rays = rays, .plan = plan };
	struct gz_ray_frame world;
	if (!slicer->scene.volume || !slicer->scene.has_transfer || !gz_ray_params_valid(rays) ||
	    plan->layer_count < 1)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_plan_rays(plan, shot->camera, &world);
	if (result == GZ_OK && image)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result == GZ_OK)
		result = enter_device(slicer);
	if (result != GZ_OK)
		return result;
	slicing.frame = (struct gz_gl_frame) {
		.camera = shot->camera,
		.world = &slicing.near_rays,
		.rays = rays,
		.plan = plan,
		.wait = slicer->wait_for_bricks,
	};
	result = prepare_slices(&slicing, &world);
	if (result == GZ_OK)
		result = draw_frame(&slicing);
	if (result == GZ_OK)
		result = gz_gl_layers_deliver(&slicer->layers, &slicer->device, image, slicer->log);
	if (result == GZ_OK && out_stats)
		*out_stats = frame_stats(slicer);
	gz_gl_device_leave(&slicer->device);
	return result;
}

unsigned gz_gl_slicer_picture_texture(const struct gz_gl_slicer *slicer)
{
	return slicer->layers.picture.picture;
}

const char *gz_gl_slicer_describe(const struct gz_gl_slicer *slicer)
{
	return slicer->device.description;
}
