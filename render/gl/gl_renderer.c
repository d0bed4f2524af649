#include "render/gl/gl_renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/gl/context_egl.h"
#include "render/gl/gl_device.h"
#include "render/gl/gl_frame.h"
#include "render/gl/gl_passes.h"
#include "render/gl/gl_scene.h"
#include "render/gl/gl_timer.h"

#define GZ_LOG_MODULE "gl"

enum { REASON_SIZE = 200 };

/* Moments of a frame. */
enum { MARK_START, MARK_CAST, MARK_END };

struct gl_renderer {
	struct gz_renderer base;
	struct gz_gl_context *context;
	struct gz_gl_context *own_context; /* the same, where this renderer made it */
	struct gz_gl_device device;
	struct gz_gl_scene scene;
	struct gz_gl_frame frame;
	struct gz_gl_passes passes;
	struct gz_gl_timer timer;
	bool wait_for_bricks;
};

static struct gl_renderer *gl_of(struct gz_renderer *renderer)
{
	return (struct gl_renderer *)renderer;
}

static enum gz_result enter(struct gl_renderer *gl)
{
	const enum gz_result result = gl->context->ops->make_current(gl->context);
	if (result != GZ_OK)
		gz_err(gl->base.log, "the OpenGL context cannot be used any more");
	return result;
}

static void leave(struct gl_renderer *gl)
{
	gl->context->ops->release(gl->context);
}

static void gl_destroy(struct gz_renderer *renderer)
{
	struct gl_renderer *gl = gl_of(renderer);
	if (gl->context && gl->context->ops->make_current(gl->context) == GZ_OK) {
		gz_gl_scene_free(&gl->scene);
		gz_gl_frame_free(&gl->frame);
		gz_gl_passes_free(&gl->passes);
		gz_gl_timer_free(&gl->timer);
		leave(gl);
	} else {
		/* What a lost context held is gone with it. */
		gz_gl_scene_forget(&gl->scene);
	}
	gz_gl_context_destroy(&gl->own_context);
	free(gl);
}

/* The context that was given, or one of its own. */
static enum gz_result open_context(struct gl_renderer *gl, const struct gz_renderer_params *params,
				   char *reason)
{
	gl->context = params->gl_context;
	if (gl->context)
		return GZ_OK;
	const enum gz_result result =
		gz_gl_context_egl(params->gl_hardware_only, &gl->own_context, reason, REASON_SIZE);
	gl->context = gl->own_context;
	return result;
}

static enum gz_result open_device(struct gl_renderer *gl, const struct gz_renderer_params *params,
				  char *reason)
{
	enum gz_result result = enter(gl);
	if (result != GZ_OK)
		return result;
	result = gz_gl_device_open(&gl->device, reason, REASON_SIZE);
	leave(gl);
	if (result == GZ_OK && gl->device.software && params->gl_hardware_only) {
		snprintf(reason, REASON_SIZE, "%.120s is software", gl->device.description);
		result = GZ_ERR_UNSUPPORTED;
	}
	if (params->gl_as_hardware)
		gl->device.software = false;
	if (params->gl_volume_edge_max > 0 &&
	    params->gl_volume_edge_max < gl->device.volume_edge_max)
		gl->device.volume_edge_max = params->gl_volume_edge_max;
	if (params->gl_memory_bytes > 0) {
		gl->device.memory_max = (int64_t)params->gl_memory_bytes;
		gl->device.memory_told = true;
	}
	return result;
}

static enum gz_result gl_create(const struct gz_renderer_params *params, const struct gz_log *log,
				struct gz_renderer **out_renderer)
{
	char reason[REASON_SIZE] = "its context cannot be made current";
	struct gl_renderer *gl = calloc(1, sizeof *gl);
	if (!gl)
		return GZ_ERR_NO_MEM;
	gl->base = (struct gz_renderer) { .ops = &gz_gl_renderer_ops, .log = log };
	gl->wait_for_bricks = params->wait_for_bricks;
	enum gz_result result = open_context(gl, params, reason);
	if (result == GZ_OK)
		result = open_device(gl, params, reason);
	if (result != GZ_OK) {
		/* Who only tries takes cpu then; who insists must be told what to do. */
		if (params->gl_hardware_only)
			gz_debug(log, "cpu casts the rays: %s", reason);
		else
			gz_err(log,
			       "no OpenGL 4.3: %s; update the graphics driver, or take "
			       "--backend cpu",
			       reason);
		gl_destroy(&gl->base);
		return result;
	}
	*out_renderer = &gl->base;
	return GZ_OK;
}

static enum gz_result gl_set_volume(struct gz_renderer *renderer, const struct gz_volume *volume)
{
	struct gl_renderer *gl = gl_of(renderer);
	gl->scene.volume = NULL; /* borrowed until now */
	enum gz_result result = enter(gl);
	if (result != GZ_OK)
		return result;
	result = gz_gl_scene_set_volume(&gl->scene, &gl->device, volume, renderer->log);
	leave(gl);
	return result;
}

static enum gz_result gl_set_transfer(struct gz_renderer *renderer,
				      const struct gz_transfer *transfer)
{
	struct gl_renderer *gl = gl_of(renderer);
	if (!gl->scene.volume)
		return GZ_ERR_INVAL;
	enum gz_result result = enter(gl);
	if (result != GZ_OK)
		return result;
	gz_gl_scene_set_transfer(&gl->scene, transfer);
	result = gz_gl_device_errors(&gl->device);
	leave(gl);
	if (result != GZ_OK)
		gz_err(renderer->log, "the graphics device did not take the transfer function: %s",
		       gz_result_text(result));
	return result;
}

static void fill_region(const struct gz_region *region, float place[4], float fade[4])
{
	for (int axis = 0; axis < 2; axis++) {
		place[axis] = (float)region->centre_px[axis];
		place[2 + axis] = (float)region->half_px[axis];
	}
	if (region->shape != GZ_REGION_ALL && region->blend_px > 0)
		fade[0] = (float)(fmin(region->half_px[0], region->half_px[1]) / region->blend_px);
	fade[1] = region->shape == GZ_REGION_ELLIPSE;
}

static void fill_plan(const struct gz_plan *plan, struct gz_gl_frame_block *block)
{
	block->plan[0] = (uint32_t)plan->layer_count;
	block->plan[1] = plan->reconstruction == GZ_RECONSTRUCT_PYRAMID;
	block->plan[2] = (uint32_t)plan->width;
	block->plan[3] = (uint32_t)plan->height;
	for (int i = 0; i < plan->layer_count; i++)
		fill_region(&plan->layers[i].region, block->region_places[i],
			    block->region_fades[i]);
	enum { RAYS = GZ_TILE_EDGE * GZ_TILE_EDGE };
	for (int i = 0; i < GZ_GL_TILE_POINTS; i++) {
		block->tile_points[i][0] = gz_tile_columns[i / RAYS][i % RAYS];
		block->tile_points[i][1] = gz_tile_rows[i % RAYS];
	}
}

/* The blocks of all levels that tiles take, and what else the passes need. */
static enum gz_result prepare(struct gl_renderer *gl, const struct gz_camera *camera,
			      const struct gz_ray_frame *world, const struct gz_ray_params *rays,
			      const struct gz_plan *plan)
{
	struct gz_gl_frame_block block = { 0 };
	struct gz_gl_tile_levels levels;
	const struct gz_log *log = gl->base.log;
	enum gz_result result = gz_gl_scene_prepare(&gl->scene, &gl->device, camera, rays, plan,
						    gl->wait_for_bricks, &levels, log);
	if (result == GZ_OK)
		result = gz_gl_frame_prepare(&gl->frame, &gl->device, plan, &levels, &block, log);
	if (result != GZ_OK)
		return result;
	fill_plan(plan, &block);
	for (int i = 0; i < gl->scene.level_count; i++) {
		if (i > 0 && gl->frame.level_ranges[i].count == 0)
			continue;
		gz_gl_scene_fill(&gl->scene, i, world, rays, plan, &block);
		gz_gl_frame_set_block(&gl->frame, i, &block);
	}
	gz_gl_frame_begin(&gl->frame);
	gz_gl_scene_bind(&gl->scene);
	return GZ_OK;
}

/* All passes of a frame. */
static enum gz_result draw(struct gl_renderer *gl, const struct gz_ray_params *rays,
			   const struct gz_plan *plan)
{
	const struct gz_log *log = gl->base.log;
	struct gz_gl_cast_kind kind = {
		.type = gl->scene.volume->type,
		.nearest = rays->interpolation == GZ_INTERPOLATION_NEAREST,
		.segments = rays->integration == GZ_INTEGRATION_PREINTEGRATED,
		.shaded = rays->shading == GZ_SHADING_GRADIENT,
	};
	enum gz_result result = GZ_OK;
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_START);
	for (int i = 0; i < gl->scene.level_count && result == GZ_OK; i++) {
		if (gl->frame.level_ranges[i].count == 0)
			continue;
		gz_gl_frame_use_block(&gl->frame, i);
		gz_gl_volume_bind(&gl->scene.levels[i], kind.type);
		kind.texels = gl->scene.levels[i].texels;
		result = gz_gl_cast(&gl->passes, &gl->device, &gl->frame, i, kind, log);
	}
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_CAST);
	gz_gl_frame_use_block(&gl->frame, 0);
	if (result == GZ_OK)
		result = gz_gl_reconstruct(&gl->passes, &gl->device, &gl->frame, plan, log);
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_END);
	return result;
}

/* The picture to where it is wanted, and whether all went well. */
static enum gz_result deliver(struct gl_renderer *gl, const struct gz_plan *plan,
			      struct gz_image *image)
{
	enum gz_result result = GZ_OK;
	if (image)
		result = gz_gl_frame_read(&gl->frame, &gl->device, image);
	else
		gz_gl_frame_to_texture(&gl->frame, plan->width, plan->height);
	if (result == GZ_OK)
		result = gz_gl_device_errors(&gl->device);
	if (result != GZ_OK)
		gz_err(gl->base.log, "%s failed a frame: %s", gl->device.description,
		       result == GZ_ERR_NO_DEVICE ? "the context is lost" : gz_result_text(result));
	return result;
}

/* The plan's pixel (0, 0) is the picture's -shift. */
static void shift_rays(const int shift[2], struct gz_ray_frame *rays)
{
	for (int axis = 0; axis < 3; axis++) {
		rays->origin00[axis] -=
			shift[0] * rays->origin_dx[axis] + shift[1] * rays->origin_dy[axis];
		rays->direction00[axis] -=
			shift[0] * rays->direction_dx[axis] + shift[1] * rays->direction_dy[axis];
	}
}

static enum gz_result gl_render(struct gz_renderer *renderer, const struct gz_camera *camera,
				const struct gz_ray_params *rays, const struct gz_plan *plan,
				struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct gl_renderer *gl = gl_of(renderer);
	struct gz_ray_frame world;
	if (!gl->scene.volume || !gl->scene.has_transfer)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_camera_rays(camera, plan->view.width, plan->view.height, &world);
	if (result == GZ_OK)
		shift_rays(plan->view.shift, &world);
	if (result == GZ_OK && image)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result == GZ_OK)
		result = enter(gl);
	if (result != GZ_OK)
		return result;
	result = prepare(gl, camera, &world, rays, plan);
	if (result == GZ_OK)
		result = draw(gl, rays, plan);
	if (result == GZ_OK)
		result = deliver(gl, plan, image);
	if (result == GZ_OK && out_stats)
		*out_stats = (struct gz_frame_stats) {
			.rays = plan->ray_count,
			.samples = gz_gl_frame_samples(&gl->frame, &gl->device),
			.cast_ms = gz_gl_timer_ms(&gl->timer, &gl->device, MARK_START, MARK_CAST),
			.reconstruct_ms =
				gz_gl_timer_ms(&gl->timer, &gl->device, MARK_CAST, MARK_END),
			.gpu_ms = gl->device.software ? NAN
						      : gz_gl_timer_ms(&gl->timer, &gl->device,
								       MARK_START, MARK_END),
			.bricks_coming = gl->scene.bricks.coming,
		};
	leave(gl);
	return result;
}

static unsigned gl_picture_texture(const struct gz_renderer *renderer)
{
	return ((const struct gl_renderer *)renderer)->frame.picture;
}

static const char *gl_describe(const struct gz_renderer *renderer)
{
	return ((const struct gl_renderer *)renderer)->device.description;
}

const struct gz_renderer_ops gz_gl_renderer_ops = {
	.name = "gl",
	.create = gl_create,
	.set_volume = gl_set_volume,
	.set_transfer = gl_set_transfer,
	.render = gl_render,
	.picture_texture = gl_picture_texture,
	.describe = gl_describe,
	.destroy = gl_destroy,
};
