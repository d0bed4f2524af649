#include "render/surface/gl/surface_raster.h"

#include <math.h>
#include <stdlib.h>

#include <GL/glew.h>

#include "base/clock.h"
#include "base/workers.h"
#include "render/layers/gl_layers.h"
#include "render/light/gl/gl_cube.h"
#include "render/opengl/gl_target.h"
#include "render/surface/gl/raster_meshes.h"
#include "render/surface/gl/raster_programs.h"
#include "render/surface/gl/raster_shadow.h"
#include "render/surface/gl/raster_view.h"
#include "render/surface/shared/surface_frame.h"

#define GZ_LOG_MODULE "isosurface"

/* Moments of a frame. */
enum { MARK_START, MARK_DRAWN, MARK_END };

static const char remedy[] = "use --backend cpu";

struct gz_surface_raster {
	const struct gz_log *log;
	struct gz_gl_device device;
	struct gz_workers *workers; /* make the surfaces of volumes */
	struct gz_surface_meshes surfaces;
	struct gz_raster_meshes meshes;
	struct gz_raster_programs programs;
	struct gz_raster_shadow_map shadow_map;
	struct gz_cube_pictures pictures; /* of the surroundings, if they are wanted */
	struct gz_gl_cube cube;
	struct gz_gl_layers layers;
	struct gz_gl_target targets[GZ_PLAN_RECTANGLES_MAX];
	struct gz_gl_buffer block;
	unsigned no_vertices; /* a vertex array of nothing */
	struct gz_gl_timer timer;
};

/* What the steps of one picture share. */
struct rastering {
	struct gz_surface_raster *raster;
	const struct gz_surface_shot *shot;
	const struct gz_surface_planes *planes; /* NULL: not wanted */
	struct gz_surface_frame frame;
	struct gz_raster_view view;
	struct gz_raster_shadow shadow;
	bool any; /* something is in view */
	double prepare_ms;
};

/* Make the context current until gz_gl_device_leave(). A lost context is logged. */
static enum gz_result enter_raster(const struct gz_surface_raster *raster)
{
	const enum gz_result result = gz_gl_device_enter(&raster->device);
	if (result != GZ_OK)
		gz_err(raster->log, "the OpenGL context cannot be used any more");
	return result;
}

static void delete_raster_objects(struct gz_surface_raster *raster)
{
	gz_raster_meshes_free(&raster->meshes);
	gz_raster_programs_free(&raster->programs);
	gz_raster_shadow_free(&raster->shadow_map);
	gz_gl_cube_free(&raster->cube);
	gz_gl_layers_free(&raster->layers);
	for (int i = 0; i < GZ_PLAN_RECTANGLES_MAX; i++)
		gz_gl_target_free(&raster->targets[i]);
	gz_gl_buffer_free(&raster->block);
	gz_gl_timer_free(&raster->timer);
	if (raster->no_vertices)
		glDeleteVertexArrays(1, &raster->no_vertices);
}

void gz_surface_raster_destroy(struct gz_surface_raster **raster)
{
	struct gz_surface_raster *self = *raster;
	if (!self)
		return;
	if (gz_gl_device_enter(&self->device) == GZ_OK) {
		delete_raster_objects(self);
		gz_gl_device_leave(&self->device);
	} else {
		gz_raster_meshes_forget(&self->meshes);
	}
	gz_gl_device_destroy(&self->device);
	gz_surface_meshes_free(&self->surfaces);
	gz_cube_pictures_free(&self->pictures);
	gz_workers_destroy(&self->workers);
	free(self);
	*raster = NULL;
}

static enum gz_result open_raster(struct gz_surface_raster *raster,
				  const struct gz_backend_params *params)
{
	const struct gz_gl_setup setup = {
		.lent = params->gl_context,
		.hardware_only = params->gl_hardware_only,
		.memory_bytes = params->gl_memory_bytes,
	};
	const enum gz_result result = gz_workers_create(params->threads, &raster->workers);
	if (result != GZ_OK) {
		gz_err(raster->log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	return gz_gl_device_create(&setup, raster->log, &raster->device);
}

enum gz_result gz_surface_raster_create(const struct gz_backend_params *params,
					const struct gz_log *log,
					struct gz_surface_raster **out_raster)
{
	static const struct gz_backend_params defaults = { 0 };
	struct gz_surface_raster *raster = calloc(1, sizeof *raster);
	if (!raster)
		return GZ_ERR_NO_MEM;
	raster->log = raster->surfaces.log = log;
	const enum gz_result result = open_raster(raster, params ? params : &defaults);
	if (result != GZ_OK) {
		gz_surface_raster_destroy(&raster);
		return result;
	}
	*out_raster = raster;
	return GZ_OK;
}

enum gz_result gz_surface_raster_show(struct gz_surface_raster *raster,
				      const struct gz_object *objects, size_t count)
{
	return gz_surface_meshes_show(&raster->surfaces, objects, count);
}

/* Make and upload what the picture shows, and tell the time; 0: all was there. */
static enum gz_result prepare_meshes(struct rastering *rastering)
{
	struct gz_surface_raster *raster = rastering->raster;
	bool new_meshes = false;
	const int64_t start_ns = gz_clock_now_ns();
	enum gz_result result =
		gz_surface_meshes_make(&raster->surfaces, rastering->shot->rays->surface.isovalue,
				       raster->workers, &new_meshes);
	if (result != GZ_OK || (raster->meshes.uploaded && !new_meshes))
		return result;
	const int64_t made_ns = gz_clock_now_ns();
	result = gz_raster_meshes_upload(&raster->meshes, &raster->device, &raster->surfaces, NULL,
					 raster->log);
	rastering->prepare_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	gz_debug(raster->log, "%zu triangles: surfaces %.0f ms, upload %.0f ms",
		 gz_surface_meshes_triangles(&raster->surfaces), gz_ns_to_ms(made_ns - start_ns),
		 gz_ns_to_ms(gz_clock_now_ns() - made_ns));
	return result;
}

/* The part of the meshes' box that the clip region leaves. */
static struct gz_raster_box shown_box(const struct gz_surface_raster *raster,
				      const struct gz_surface_frame *frame)
{
	struct gz_raster_box box = raster->meshes.box;
	for (int axis = 0; axis < 3 && frame->clipped; axis++) {
		box.least[axis] = fmax(box.least[axis], (double)frame->clip_least[axis]);
		box.greatest[axis] = fmin(box.greatest[axis], (double)frame->clip_greatest[axis]);
	}
	return box;
}

static unsigned planes_wanted(const struct gz_surface_planes *planes)
{
	unsigned wanted = 1U << GZ_GL_TARGET_COLOUR;
	if (planes && planes->ids)
		wanted |= 1U << GZ_GL_TARGET_ID;
	if (planes && planes->depth)
		wanted |= 1U << GZ_GL_TARGET_VALUE;
	return wanted;
}

/* Make room on the device for the layers and the numbers of the frame. */
static enum gz_result prepare_layers(const struct rastering *rastering)
{
	struct gz_surface_raster *raster = rastering->raster;
	const unsigned wanted = planes_wanted(rastering->planes);
	enum gz_result result = gz_raster_programs_make(&raster->programs, raster->log);
	if (result == GZ_OK)
		result = gz_gl_layers_prepare(&raster->layers, &raster->device,
					      rastering->shot->plan, remedy, raster->log);
	for (int i = 0; i < raster->layers.count && result == GZ_OK; i++)
		result = gz_gl_target_reserve(&raster->targets[i], &raster->device, wanted,
					      raster->layers.items[i].points[0],
					      raster->layers.items[i].points[1], raster->log);
	gz_gl_buffer_reserve(&raster->block, sizeof(struct gz_raster_block), GL_STREAM_DRAW);
	if (!raster->no_vertices)
		glGenVertexArrays(1, &raster->no_vertices);
	return result;
}

/* Whether the picture needs a shadow map. */
static bool casts_shadows(const struct rastering *rastering)
{
	return rastering->any && rastering->frame.shadows && rastering->frame.bounces == 0;
}

static enum gz_result prepare_frame(struct rastering *rastering, const struct gz_ray_frame *world)
{
	struct gz_surface_raster *raster = rastering->raster;
	const struct gz_plan_view *size = &rastering->shot->plan->view;
	struct gz_raster_block block;
	rastering->frame = gz_surface_frame_make(&raster->surfaces, &raster->pictures,
						 rastering->shot->rays, world);
	const struct gz_raster_box box = shown_box(raster, &rastering->frame);
	const int edge = gz_raster_shadow_edge(size->width, size->height);
	rastering->any =
		gz_raster_view_make(world, raster->surfaces.world_mm, &box, &rastering->view);
	if (rastering->any)
		rastering->shadow =
			gz_raster_shadow_make(rastering->frame.light.towards, &box, edge);
	gz_raster_block_fill(&rastering->frame, &rastering->view, &rastering->shadow, edge, &block);
	glBindBuffer(GL_UNIFORM_BUFFER, raster->block.name);
	glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block, &block);
	glBindBufferBase(GL_UNIFORM_BUFFER, GZ_GL_BLOCK_TECHNIQUE, raster->block.name);
	glBindBuffer(GL_UNIFORM_BUFFER, 0);
	const enum gz_result result =
		gz_gl_cube_bind(&raster->cube, &raster->device, &raster->pictures,
				GZ_RASTER_UNIT_CUBE, raster->log);
	return result == GZ_OK && casts_shadows(rastering)
		       ? gz_raster_shadow_reserve(&raster->shadow_map, &raster->device, edge,
						  raster->log)
		       : result;
}

/* Use a program for a layer. */
static void use_for_layer(const struct gz_surface_raster *raster, enum gz_raster_program program,
			  const struct gz_raster_layer *layer)
{
	glUseProgram(raster->programs.names[program]);
	glUniform3f(GZ_RASTER_LATTICE, (float)layer->from[0], (float)layer->from[1],
		    (float)layer->spacing);
}

/* Draw the surroundings where no surface is. */
static void draw_behind(const struct gz_surface_raster *raster, const struct gz_raster_layer *layer)
{
	use_for_layer(raster, GZ_RASTER_BEHIND, layer);
	glDepthFunc(GL_LEQUAL);
	glBindVertexArray(raster->no_vertices);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDepthFunc(GL_LESS);
}

static void draw_raster_layer(const struct rastering *rastering, int index)
{
	static const float nothing[4] = { 0 };
	const struct gz_surface_raster *raster = rastering->raster;
	const struct gz_raster_layer *layer = &raster->layers.items[index];
	gz_gl_target_begin(&raster->targets[index]);
	gz_gl_target_clear(&raster->targets[index], nothing);
	gz_gl_layer_begin(layer);
	if (rastering->any) {
		use_for_layer(raster, GZ_RASTER_SURFACE, layer);
		glUniform2f(GZ_RASTER_POINTS, (float)layer->points[0], (float)layer->points[1]);
		gz_raster_clip(rastering->frame.clipped);
		gz_raster_meshes_draw_seen(
			&raster->meshes, &raster->surfaces, &rastering->shot->rays->surface,
			&rastering->view, layer,
			(struct gz_raster_locations) { GZ_RASTER_ID, GZ_RASTER_COLOUR });
		gz_raster_clip(false);
	}
	if (rastering->frame.around.kind != GZ_SURROUNDINGS_NONE)
		draw_behind(raster, layer);
}

static void draw_raster_layers(const struct rastering *rastering)
{
	struct gz_surface_raster *raster = rastering->raster;
	const struct gz_gl_outer_state outer = gz_gl_outer_state_leave();
	if (casts_shadows(rastering)) {
		gz_raster_clip(rastering->frame.clipped);
		glUseProgram(raster->programs.names[GZ_RASTER_SHADOW]);
		gz_raster_shadow_draw(&raster->shadow_map, &rastering->shadow, &raster->meshes);
		gz_raster_clip(false);
	}
	for (int i = 0; i < raster->layers.count; i++)
		draw_raster_layer(rastering, i);
	gz_gl_outer_state_return(&outer);
	glUseProgram(0);
}

static void list_textures(const struct gz_surface_raster *raster, enum gz_gl_target_plane plane,
			  unsigned out_textures[GZ_PLAN_RECTANGLES_MAX])
{
	for (int i = 0; i < raster->layers.count; i++)
		out_textures[i] = raster->targets[i].planes[plane];
}

static void draw_raster_frame(const struct rastering *rastering)
{
	struct gz_surface_raster *raster = rastering->raster;
	unsigned textures[GZ_PLAN_RECTANGLES_MAX] = { 0 };
	gz_gl_timer_mark(&raster->timer, &raster->device, MARK_START);
	draw_raster_layers(rastering);
	gz_gl_timer_mark(&raster->timer, &raster->device, MARK_DRAWN);
	list_textures(raster, GZ_GL_TARGET_COLOUR, textures);
	gz_gl_layers_join(&raster->layers, textures, rastering->shot->rays->background);
	gz_gl_timer_mark(&raster->timer, &raster->device, MARK_END);
}

/* Copy a plane from the device, if it is wanted. */
static enum gz_result deliver_plane(struct gz_surface_raster *raster,
				    enum gz_gl_target_plane source, struct gz_plane *plane)
{
	unsigned textures[GZ_PLAN_RECTANGLES_MAX] = { 0 };
	if (!plane)
		return GZ_OK;
	list_textures(raster, source, textures);
	const enum gz_result result =
		gz_gl_layers_pick(&raster->layers, &raster->device, textures, plane->words);
	if (result != GZ_OK)
		gz_err(raster->log,
		       "%s drew a picture, but its %s cannot be copied from the graphics device: "
		       "%s; %s",
		       raster->device.description,
		       source == GZ_GL_TARGET_ID ? "numbers of objects" : "depths",
		       result == GZ_ERR_NO_DEVICE ? "the context is lost" : gz_result_text(result),
		       remedy);
	return result;
}

/* Copy the planes that are wanted, after the picture. */
static enum gz_result deliver_planes(const struct rastering *rastering)
{
	const struct gz_surface_planes *planes = rastering->planes;
	struct gz_surface_raster *raster = rastering->raster;
	enum gz_result result = GZ_OK;
	if (planes)
		result = deliver_plane(raster, GZ_GL_TARGET_ID, planes->ids);
	if (planes && result == GZ_OK)
		result = deliver_plane(raster, GZ_GL_TARGET_VALUE, planes->depth);
	return result;
}

static struct gz_frame_stats raster_stats(const struct rastering *rastering)
{
	const struct gz_surface_raster *raster = rastering->raster;
	const struct gz_gl_timer *timer = &raster->timer;
	const struct gz_gl_device *device = &raster->device;
	return (struct gz_frame_stats) {
		.rays = gz_gl_layers_drawn(&raster->layers),
		.prepare_ms = rastering->prepare_ms,
		.prepare_within_ms = rastering->prepare_ms,
		.cast_ms = gz_gl_timer_ms(timer, device, MARK_START, MARK_DRAWN),
		.reconstruct_ms = gz_gl_timer_ms(timer, device, MARK_DRAWN, MARK_END),
		.gpu_ms = device->software ? NAN
					   : gz_gl_timer_ms(timer, device, MARK_START, MARK_END),
	};
}

/* Make room on the host for what is wanted. */
static enum gz_result prepare_outputs(const struct gz_plan *plan, struct gz_image *image,
				      const struct gz_surface_planes *planes)
{
	const int width = plan->width, height = plan->height;
	enum gz_result result = image ? gz_image_resize(image, width, height) : GZ_OK;
	if (result == GZ_OK && planes && planes->depth)
		result = gz_plane_resize(planes->depth, GZ_PLANE_VALUE, width, height);
	if (result == GZ_OK && planes && planes->ids)
		result = gz_plane_resize(planes->ids, GZ_PLANE_ID, width, height);
	return result;
}

void gz_surface_raster_take(struct gz_surface_raster *raster, struct gz_surface_meshes *from)
{
	gz_surface_meshes_take(&raster->surfaces, from);
}

enum gz_result gz_surface_raster_draw(struct gz_surface_raster *raster,
				      const struct gz_surface_shot *shot, struct gz_image *image,
				      const struct gz_surface_planes *planes,
				      struct gz_frame_stats *out_stats)
{
	struct rastering rastering = { .raster = raster, .shot = shot, .planes = planes };
	struct gz_ray_frame world;
	if (raster->surfaces.count < 1 || !gz_ray_params_valid(shot->rays) ||
	    shot->plan->layer_count < 1)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_plan_rays(shot->plan, shot->camera, &world);
	if (result == GZ_OK)
		result = prepare_outputs(shot->plan, image, planes);
	if (result == GZ_OK)
		result = enter_raster(raster);
	if (result != GZ_OK)
		return result;
	result = prepare_meshes(&rastering);
	if (result == GZ_OK)
		result = gz_cube_pictures_prepare(&raster->pictures, &shot->rays->environment,
						  raster->log, &rastering.prepare_ms);
	if (result == GZ_OK)
		result = prepare_layers(&rastering);
	if (result == GZ_OK)
		result = prepare_frame(&rastering, &world);
	if (result == GZ_OK) {
		draw_raster_frame(&rastering);
		result = gz_gl_layers_deliver(&raster->layers, &raster->device, image, raster->log);
	}
	if (result == GZ_OK)
		result = deliver_planes(&rastering);
	if (result == GZ_OK && out_stats)
		*out_stats = raster_stats(&rastering);
	gz_gl_device_leave(&raster->device);
	return result;
}

unsigned gz_surface_raster_picture(const struct gz_surface_raster *raster)
{
	return raster->layers.picture.picture;
}

const char *gz_surface_raster_describe(const struct gz_surface_raster *raster)
{
	return raster->device.description;
}
