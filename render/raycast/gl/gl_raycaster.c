#include "render/raycast/gl/gl_raycaster.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/opengl/gl_device.h"
#include "render/raycast/gl/gl_cast.h"
#include "render/raycast/gl/gl_rounds.h"
#include "render/raycast/gl/gl_scene.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/reconstruct/gl/gl_reconstruct.h"

#define GZ_LOG_MODULE "gl"

/* Moments of a frame. */
enum { MARK_START, MARK_CAST, MARK_END };

struct gl_raycaster {
	struct gz_raycaster base;
	struct gz_gl_device device;
	struct gz_gl_scene scene;
	struct gz_gl_plan plan;
	struct gz_gl_tile_levels levels; /* of the last frame's tiles */
	struct gz_gl_rounds rounds;
	struct gz_gl_points colours;
	struct gz_gl_cast cast;
	struct gz_gl_reconstruct reconstruct;
	struct gz_gl_timer timer;
	bool wait_for_bricks;
};

static struct gl_raycaster *gl_of(struct gz_raycaster *raycaster)
{
	return (struct gl_raycaster *)raycaster;
}

/* Make the context current until gz_gl_device_leave(). A lost context is logged. */
static enum gz_result enter_device(const struct gl_raycaster *gl)
{
	const enum gz_result result = gz_gl_device_enter(&gl->device);
	if (result != GZ_OK)
		gz_err(gl->base.log, "the OpenGL context cannot be used any more");
	return result;
}

static void gl_destroy(struct gz_raycaster *raycaster)
{
	struct gl_raycaster *gl = gl_of(raycaster);
	if (gz_gl_device_enter(&gl->device) == GZ_OK) {
		gz_gl_scene_free(&gl->scene);
		gz_gl_plan_free(&gl->plan);
		gz_gl_points_free(&gl->colours);
		gz_gl_cast_free(&gl->cast);
		gz_gl_reconstruct_free(&gl->reconstruct);
		gz_gl_timer_free(&gl->timer);
		gz_gl_device_leave(&gl->device);
	} else {
		/* A lost context took its objects with it. */
		gz_gl_scene_forget(&gl->scene);
	}
	gz_gl_rounds_free(&gl->rounds);
	gz_gl_device_destroy(&gl->device);
	free(gl);
}

static void apply_hooks(const struct gz_gl_raycaster_hooks *hooks, struct gz_gl_device *device)
{
	if (hooks->as_hardware)
		device->software = false;
	if (hooks->volume_edge_max > 0 && hooks->volume_edge_max < device->volume_edge_max)
		device->volume_edge_max = hooks->volume_edge_max;
}

enum gz_result gz_gl_raycaster_create(const struct gz_backend_params *params,
				      const struct gz_gl_raycaster_hooks *hooks,
				      const struct gz_log *log, struct gz_raycaster **out_raycaster)
{
	const struct gz_gl_setup setup = {
		.lent = params->gl_context,
		.hardware_only = params->gl_hardware_only,
		.memory_bytes = params->gl_memory_bytes,
	};
	struct gl_raycaster *gl = calloc(1, sizeof *gl);
	if (!gl)
		return GZ_ERR_NO_MEM;
	gl->base = (struct gz_raycaster) { .ops = &gz_gl_raycaster_ops, .log = log };
	gl->wait_for_bricks = params->wait_for_bricks;
	const enum gz_result result = gz_gl_device_create(&setup, log, &gl->device);
	if (result != GZ_OK) {
		gl_destroy(&gl->base);
		return result;
	}
	apply_hooks(hooks, &gl->device);
	*out_raycaster = &gl->base;
	return GZ_OK;
}

static enum gz_result gl_create(const struct gz_backend_params *params, const struct gz_log *log,
				struct gz_raycaster **out_raycaster)
{
	static const struct gz_gl_raycaster_hooks none;
	return gz_gl_raycaster_create(params, &none, log, out_raycaster);
}

static enum gz_result gl_set_volume(struct gz_raycaster *raycaster, const struct gz_volume *volume)
{
	struct gl_raycaster *gl = gl_of(raycaster);
	gl->scene.volume = NULL; /* borrowed until now */
	enum gz_result result = enter_device(gl);
	if (result != GZ_OK)
		return result;
	result = gz_gl_scene_set_volume(&gl->scene, &gl->device, volume, raycaster->log);
	gz_gl_device_leave(&gl->device);
	return result;
}

static enum gz_result gl_set_transfer(struct gz_raycaster *raycaster,
				      const struct gz_transfer *transfer)
{
	struct gl_raycaster *gl = gl_of(raycaster);
	if (!gl->scene.volume)
		return GZ_ERR_INVAL;
	enum gz_result result = enter_device(gl);
	if (result != GZ_OK)
		return result;
	result = gz_gl_scene_set_transfer(&gl->scene, transfer);
	if (result == GZ_OK)
		result = gz_gl_device_errors(&gl->device);
	gz_gl_device_leave(&gl->device);
	if (result != GZ_OK)
		gz_err(raycaster->log, "the graphics device did not take the transfer function: %s",
		       gz_result_text(result));
	return result;
}

/* Make room on the device for what the passes write. */
static enum gz_result reserve_outputs(struct gl_raycaster *gl, const struct gz_plan *plan)
{
	enum gz_result result =
		gz_gl_points_prepare(&gl->colours, &gl->device, gl->plan.point_count);
	if (result == GZ_OK)
		result = gz_gl_cast_prepare(&gl->cast, &gl->device);
	if (result != GZ_OK)
		gz_err(gl->base.log, "the graphics device has no room for a picture of %d x %d px",
		       plan->width, plan->height);
	return result;
}

/* Prepare what the passes read: the blocks of all levels that tiles take, and bindings. */
static enum gz_result prepare_frame(struct gl_raycaster *gl, const struct gz_gl_frame *frame)
{
	struct gz_gl_cast_block block = { 0 };
	const struct gz_log *log = gl->base.log;
	enum gz_result result =
		gz_gl_scene_prepare(&gl->scene, &gl->device, frame, &gl->levels, log);
	if (result == GZ_OK)
		result = gz_gl_plan_prepare(&gl->plan, &gl->device, frame->plan, &gl->levels, log);
	if (result == GZ_OK)
		result = reserve_outputs(gl, frame->plan);
	if (result != GZ_OK)
		return result;
	for (int i = 0; i < gl->scene.level_count; i++) {
		/* Tiles of further rounds may take any level. */
		if (i > 0 && gl->plan.level_ranges[i].count == 0 && !frame->plan->refines)
			continue;
		gz_gl_scene_fill(&gl->scene, i, frame, &block);
		gz_gl_cast_set_block(&gl->cast, i, &block);
	}
	gz_gl_plan_bind(&gl->plan);
	gz_gl_points_bind(&gl->colours);
	gz_gl_scene_bind(&gl->scene);
	return GZ_OK;
}

static enum gz_result cast_levels(struct gl_raycaster *gl, const struct gz_shot *shot, bool hits)
{
	const struct gz_ray_params *rays = shot->settings;
	struct gz_gl_cast_job job = {
		.device = &gl->device,
		.gl_plan = &gl->plan,
		.kind = { .type = gl->scene.volume->type,
			  .nearest = gz_ray_samples_nearest(rays, gl->scene.volume),
			  .segments = rays->integration == GZ_INTEGRATION_PREINTEGRATED,
			  .shaded = rays->shading == GZ_SHADING_GRADIENT,
			  .shadowed = rays->light.shadow_steps > 0,
			  .fine = gl->scene.table->count > GZ_TRANSFER_TABLE_SIZE,
			  .coloured = gl->scene.volume->colours != NULL,
			  .hits = hits,
			  .deep = shot->depths != NULL },
		.log = gl->base.log,
	};
	enum gz_result result = GZ_OK;
	for (int i = 0; i < gl->scene.level_count && result == GZ_OK; i++) {
		if (gl->plan.level_ranges[i].count == 0)
			continue;
		gz_gl_volume_bind(&gl->scene.levels[i], job.kind.type);
		job.kind.texels = gl->scene.levels[i].texels;
		job.level = i;
		result = gz_gl_cast_tiles(&gl->cast, &job);
	}
	return result;
}

/* Let the device have these tiles of a plan in place of others. */
static enum gz_result take_tiles(struct gl_raycaster *gl, const struct gz_plan *plan)
{
	const enum gz_result result =
		gz_gl_plan_prepare(&gl->plan, &gl->device, plan, &gl->levels, gl->base.log);
	if (result == GZ_OK)
		gz_gl_plan_bind(&gl->plan);
	return result;
}

/* Refine the plan where the last round's rays differ, and cast the new tiles, round by round. */
static enum gz_result cast_further_rounds(struct gl_raycaster *gl, const struct gz_shot *shot)
{
	struct gz_plan *plan = shot->refined;
	struct gz_plan part;
	struct gz_gl_rounds_job job = {
		.device = &gl->device,
		.gl_plan = &gl->plan,
		.points = &gl->colours,
		.workers = gz_gl_scene_workers(&gl->scene),
		.plan = plan,
	};
	if (!job.workers)
		return GZ_ERR_NO_MEM;
	for (int round = 1; round < gz_plan_rounds(plan); round++) {
		const size_t tiles = plan->tile_count;
		enum gz_result result = gz_gl_rounds_refine(&gl->rounds, &job);
		if (result != GZ_OK || plan->tile_count == tiles)
			return result;
		job.first = tiles;
		part = gz_gl_rounds_part(plan, tiles);
		result = take_tiles(gl, &part);
		if (result == GZ_OK)
			result = cast_levels(gl, shot, false);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

/* All rounds of a plan that refines; after them the device has the tiles to show, those of
 * @p out_shown. */
static enum gz_result cast_rounds(struct gl_raycaster *gl, const struct gz_shot *shot,
				  struct gz_plan *out_shown)
{
	enum gz_result result = cast_further_rounds(gl, shot);
	if (result == GZ_OK)
		result = gz_gl_rounds_show(&gl->rounds, shot->plan, out_shown);
	if (result == GZ_OK && shot->plan->tile_count > shot->plan->first_round.tile_count)
		result = take_tiles(gl, out_shown);
	if (result == GZ_ERR_NO_MEM)
		gz_err(gl->base.log, "no memory to refine the plan: take another method");
	return result;
}

/* All passes of a frame. */
static enum gz_result draw_frame(struct gl_raycaster *gl, const struct gz_shot *shot)
{
	const struct gz_plan *plan = shot->plan;
	struct gz_plan shown;
	struct gz_gl_reconstruct_job job = {
		.device = &gl->device,
		.gl_plan = &gl->plan,
		.plan = plan,
		.points = &gl->colours,
		.kind = shot->depths ? GZ_PLANE_DEEP_COLOUR : GZ_PLANE_COLOUR,
		.log = gl->base.log,
	};
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_START);
	enum gz_result result = GZ_OK;
	if (shot->hits)
		result = gz_gl_cast_set_hits(&gl->cast, &gl->plan, plan, shot->hits);
	if (result == GZ_OK)
		result = cast_levels(gl, shot, shot->hits != NULL);
	if (result == GZ_OK && shot->refined && plan->refines) {
		result = cast_rounds(gl, shot, &shown);
		job.plan = &shown;
	}
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_CAST);
	if (result == GZ_OK)
		result = gz_gl_reconstruct(&gl->reconstruct, &job);
	gz_gl_timer_mark(&gl->timer, &gl->device, MARK_END);
	return result;
}

/* Copy the picture to where it is wanted, and check for errors. */
static enum gz_result deliver_picture(struct gl_raycaster *gl, const struct gz_plan *plan,
				      struct gz_image *image)
{
	enum gz_result result = GZ_OK;
	if (image)
		result = gz_gl_points_read(&gl->colours, &gl->device, 0,
					   (size_t)plan->width * (size_t)plan->height,
					   gz_image_words(image));
	else
		gz_gl_points_to_texture(&gl->colours, plan->width, plan->height);
	if (result == GZ_OK)
		result = gz_gl_device_errors(&gl->device);
	if (result != GZ_OK)
		gz_err(gl->base.log, "%s failed a frame: %s", gl->device.description,
		       result == GZ_ERR_NO_DEVICE ? "the context is lost" : gz_result_text(result));
	return result;
}

static enum gz_result gl_draw(struct gz_raycaster *raycaster, const struct gz_shot *shot,
			      struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct gl_raycaster *gl = gl_of(raycaster);
	const struct gz_ray_params *rays = shot->settings;
	const struct gz_plan *plan = shot->plan;
	struct gz_ray_frame world;
	if (!gl->scene.volume || !gl->scene.has_transfer)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_plan_rays(plan, shot->camera, &world);
	if (result == GZ_OK && image)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result == GZ_OK)
		result = enter_device(gl);
	if (result != GZ_OK)
		return result;
	const struct gz_gl_frame frame = {
		.camera = shot->camera,
		.world = &world,
		.rays = rays,
		.plan = plan,
		.depths = shot->depths,
		.shades = shot->shades,
		.shade_count = shot->shade_count,
		.wait = gl->wait_for_bricks,
	};
	result = prepare_frame(gl, &frame);
	if (result == GZ_OK)
		result = draw_frame(gl, shot);
	if (result == GZ_OK)
		result = deliver_picture(gl, plan, image);
	if (result == GZ_OK && out_stats)
		*out_stats = (struct gz_frame_stats) {
			.rays = plan->ray_count,
			.samples = gz_gl_cast_samples(&gl->cast, &gl->device),
			.prepare_ms = gl->scene.prepare_ms,
			.prepare_within_ms = gl->scene.prepare_ms,
			.cast_ms = gz_gl_timer_ms(&gl->timer, &gl->device, MARK_START, MARK_CAST),
			.reconstruct_ms =
				gz_gl_timer_ms(&gl->timer, &gl->device, MARK_CAST, MARK_END),
			.gpu_ms = gl->device.software ? NAN
						      : gz_gl_timer_ms(&gl->timer, &gl->device,
								       MARK_START, MARK_END),
			.bricks_coming = gl->scene.bricks.coming,
		};
	gz_gl_device_leave(&gl->device);
	return result;
}

static enum gz_result gl_shade(struct gz_raycaster *raycaster, const struct gz_shot *shot,
			       struct gz_shade *out_shade)
{
	struct gl_raycaster *gl = gl_of(raycaster);
	struct gz_ray_frame world;
	if (!gl->scene.volume || !gl->scene.has_transfer)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_plan_rays(shot->plan, shot->camera, &world);
	return result == GZ_OK ? gz_gl_scene_shade(&gl->scene, shot->settings, &world,
						   raycaster->log, out_shade)
			       : result;
}

static unsigned gl_picture_texture(const struct gz_raycaster *raycaster)
{
	return ((const struct gl_raycaster *)raycaster)->colours.picture;
}

static bool gl_refines(const struct gz_raycaster *raycaster)
{
	return !((const struct gl_raycaster *)raycaster)->scene.bricked;
}

static const char *gl_describe(const struct gz_raycaster *raycaster)
{
	return ((const struct gl_raycaster *)raycaster)->device.description;
}

const struct gz_raycaster_ops gz_gl_raycaster_ops = {
	.name = "gl",
	.create = gl_create,
	.set_volume = gl_set_volume,
	.set_transfer = gl_set_transfer,
	.draw = gl_draw,
	.shade = gl_shade,
	.refines = gl_refines,
	.picture_texture = gl_picture_texture,
	.describe = gl_describe,
	.destroy = gl_destroy,
};
