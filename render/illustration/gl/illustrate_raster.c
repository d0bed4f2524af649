#include "render/illustration/gl/illustrate_raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#include "base/clock.h"
#include "base/workers.h"
#include "render/illustration/gl/illustrate_points.h"
#include "render/illustration/gl/illustrate_programs.h"
#include "render/illustration/shared/illustrate_frame.h"
#include "render/illustration/shared/illustrate_picture.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/layers/gl_layers.h"
#include "render/opengl/gl_target.h"
#include "render/surface/gl/raster_meshes.h"
#include "render/surface/gl/raster_programs.h"
#include "render/surface/gl/raster_view.h"

#define GZ_LOG_MODULE "illustration"

/* Moments of a frame. */
enum { MARK_START, MARK_FOUND };

static const char remedy[] = "use --backend cpu";

struct gz_illustrate_raster {
	const struct gz_log *log;
	struct gz_gl_device device;
	struct gz_workers *workers; /* make surfaces, and compose the picture */
	struct gz_illustrate_scene scene;
	struct gz_illustrate_frame frame;
	struct gz_illustrate_picture picture;
	struct gz_image kept; /* a picture that goes back to the device */
	struct gz_raster_meshes meshes;
	uint64_t uploaded; /* scene.made when they were; 0: never */
	unsigned program;  /* OpenGL's name; 0: not yet made */
	struct gz_illustrate_points points;
	/* Of a layer of surfaces and of the one before, in turn. */
	struct gz_gl_target targets[2][GZ_PLAN_RECTANGLES_MAX];
	struct gz_gl_points shown; /* a picture that stays on the device */
	struct gz_gl_buffer block, looks;
	struct gz_gl_timer timer;
};

/* What the steps of one picture share. */
struct illustrate_rastering {
	struct gz_illustrate_raster *raster;
	const struct gz_illustrate_shot *shot;
	struct gz_raster_view view;
	bool any; /* something is in view */
};

static void delete_illustrate_objects(struct gz_illustrate_raster *raster)
{
	gz_raster_meshes_free(&raster->meshes);
	if (raster->program)
		glDeleteProgram(raster->program);
	for (int i = 0; i < GZ_PLAN_RECTANGLES_MAX; i++) {
		gz_gl_target_free(&raster->targets[0][i]);
		gz_gl_target_free(&raster->targets[1][i]);
	}
	gz_gl_points_free(&raster->shown);
	gz_gl_buffer_free(&raster->block);
	gz_gl_buffer_free(&raster->looks);
	gz_gl_timer_free(&raster->timer);
}

void gz_illustrate_raster_destroy(struct gz_illustrate_raster **raster)
{
	struct gz_illustrate_raster *self = *raster;
	if (!self)
		return;
	if (gz_gl_device_enter(&self->device) == GZ_OK) {
		delete_illustrate_objects(self);
		gz_gl_device_leave(&self->device);
	} else {
		gz_raster_meshes_forget(&self->meshes);
	}
	gz_gl_device_destroy(&self->device);
	gz_workers_destroy(&self->workers);
	gz_illustrate_scene_free(&self->scene);
	gz_illustrate_frame_free(&self->frame);
	gz_illustrate_picture_close(&self->picture);
	gz_illustrate_points_free(&self->points);
	gz_image_free(&self->kept);
	free(self);
	*raster = NULL;
}

static enum gz_result open_illustrate_raster(struct gz_illustrate_raster *raster,
					     const struct gz_backend_params *params)
{
	const struct gz_gl_setup setup = {
		.lent = params->gl_context,
		.hardware_only = params->gl_hardware_only,
		.memory_bytes = params->gl_memory_bytes,
	};
	enum gz_result result = gz_workers_create(params->threads, &raster->workers);
	if (result != GZ_OK) {
		gz_err(raster->log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	result = gz_illustrate_picture_open(&raster->picture);
	return result == GZ_OK ? gz_gl_device_create(&setup, raster->log, &raster->device) : result;
}

enum gz_result gz_illustrate_raster_create(const struct gz_backend_params *params,
					   const struct gz_log *log,
					   struct gz_illustrate_raster **out_raster)
{
	static const struct gz_backend_params defaults = { 0 };
	struct gz_illustrate_raster *raster = calloc(1, sizeof *raster);
	if (!raster)
		return GZ_ERR_NO_MEM;
	raster->log = raster->scene.log = raster->scene.meshes.log = log;
	raster->scene.waits_for_marks = params && params->wait_for_bricks;
	const enum gz_result result = open_illustrate_raster(raster, params ? params : &defaults);
	if (result != GZ_OK) {
		gz_illustrate_raster_destroy(&raster);
		return result;
	}
	*out_raster = raster;
	return GZ_OK;
}

enum gz_result gz_illustrate_raster_show(struct gz_illustrate_raster *raster,
					 const struct gz_object *objects, size_t count)
{
	return gz_illustrate_scene_show(&raster->scene, objects, count);
}

/* Upload meshes with what shading reads of their vertices. */
static enum gz_result upload_illustrated(struct gz_illustrate_raster *raster)
{
	struct gz_raster_field fields[GZ_SHADING_LEVELS + 1];
	const struct gz_illustrate_scene *scene = &raster->scene;
	const void **data = malloc(scene->count * sizeof *data);
	if (!data)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < scene->count; i++)
		data[i] = scene->listed[i].vertices;
	for (unsigned level = 0; level < GZ_SHADING_LEVELS; level++)
		fields[level] = (struct gz_raster_field) {
			.location = GZ_ILLUSTRATE_NORMALS + level,
			.components = 3,
			.type = GL_SHORT,
			.offset = offsetof(struct gz_illustrate_vertex, normals) +
				  level * sizeof(int16_t[3]),
		};
	fields[GZ_SHADING_LEVELS] = (struct gz_raster_field) {
		.location = GZ_ILLUSTRATE_SCALARS,
		.components = 3,
		.type = GL_FLOAT,
		.offset = offsetof(struct gz_illustrate_vertex, greatest),
	};
	const struct gz_raster_vertices vertices = { fields, GZ_SHADING_LEVELS + 1,
						     sizeof(struct gz_illustrate_vertex), data };
	raster->uploaded = 0;
	const enum gz_result result = gz_raster_meshes_upload(
		&raster->meshes, &raster->device, &scene->meshes, &vertices, raster->log);
	if (result == GZ_OK)
		raster->uploaded = scene->made;
	free(data);
	return result;
}

_Static_assert(offsetof(struct gz_illustrate_vertex, least) ==
			       offsetof(struct gz_illustrate_vertex, greatest) + sizeof(float) &&
		       offsetof(struct gz_illustrate_vertex, distance_mm) ==
			       offsetof(struct gz_illustrate_vertex, least) + sizeof(float),
	       "shaders read three numbers side by side");

/* Make the program, and room on the device for the lattices. */
static enum gz_result prepare_lattices(struct gz_illustrate_raster *raster)
{
	enum gz_result result = GZ_OK;
	if (!raster->program)
		raster->program = gz_illustrate_program(raster->log);
	if (!raster->program)
		return GZ_ERR_UNSUPPORTED;
	for (int k = 0; k < (raster->picture.layers > 1 ? 2 : 1); k++)
		for (int i = 0; i < raster->points.count && result == GZ_OK; i++) {
			const struct gz_raster_layer *layer = &raster->points.lattices[i].layer;
			result = gz_gl_target_reserve(&raster->targets[k][i], &raster->device,
						      1U << GZ_GL_TARGET_VECTOR, layer->points[0],
						      layer->points[1], raster->log);
		}
	return result;
}

static enum gz_result fill_looks(struct gz_illustrate_raster *raster)
{
	const size_t count = raster->scene.template_count;
	struct gz_illustrate_shader_look *looks = malloc(count * sizeof *looks);
	if (!looks)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < count; i++)
		gz_illustrate_shader_look_fill(&raster->frame.looks[i], &looks[i]);
	gz_gl_buffer_reserve(&raster->looks, count * sizeof *looks, GL_STREAM_DRAW);
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, raster->looks.name);
	glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)(count * sizeof *looks), looks);
	glBindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
	free(looks);
	return GZ_OK;
}

/* The part of the meshes' box that the clip region leaves. */
static struct gz_raster_box illustrated_box(const struct gz_illustrate_raster *raster)
{
	const struct gz_illustrate_frame *frame = &raster->frame;
	struct gz_raster_box box = raster->meshes.box;
	for (int axis = 0; axis < 3 && frame->clipped; axis++) {
		box.least[axis] = fmax(box.least[axis], (double)frame->clip_least[axis]);
		box.greatest[axis] = fmin(box.greatest[axis], (double)frame->clip_greatest[axis]);
	}
	return box;
}

/* Give the shaders the numbers of the frame. */
static enum gz_result fill_numbers(struct illustrate_rastering *rastering,
				   const struct gz_ray_frame *rays)
{
	struct gz_illustrate_raster *raster = rastering->raster;
	const double world_mm = raster->scene.meshes.world_mm;
	const struct gz_raster_box box = illustrated_box(raster);
	struct gz_illustrate_block block;
	rastering->any = gz_raster_view_make(rays, world_mm, &box, &rastering->view);
	gz_illustrate_block_fill(&raster->frame, rays, world_mm, &rastering->view, &block);
	gz_gl_buffer_reserve(&raster->block, sizeof block, GL_STREAM_DRAW);
	glBindBuffer(GL_UNIFORM_BUFFER, raster->block.name);
	glBufferSubData(GL_UNIFORM_BUFFER, 0, sizeof block, &block);
	glBindBuffer(GL_UNIFORM_BUFFER, 0);
	return fill_looks(raster);
}

/* Draw the meshes of a layer of surfaces on a lattice. The last one has what is opaque alone. */
static void draw_illustrated(const struct illustrate_rastering *rastering, int layer,
			     const struct gz_raster_layer *lattice)
{
	const struct gz_illustrate_raster *raster = rastering->raster;
	const bool opaque_alone = layer > 0 && layer + 1 == raster->picture.layers;
	for (size_t i = 0; i < raster->meshes.count; i++) {
		const struct gz_illustrate_mesh *mesh = &raster->scene.listed[i];
		if ((opaque_alone && mesh->transparent) ||
		    !gz_raster_mesh_in_view(&raster->meshes.items[i], &rastering->view, lattice))
			continue;
		glUniform3i(GZ_ILLUSTRATE_OBJECT, (GLint)mesh->id, (GLint)mesh->look,
			    mesh->transparent);
		gz_raster_mesh_draw_seen(&raster->meshes.items[i], &rastering->view, lattice);
	}
}

/* Find a layer of surfaces on a lattice. */
static void find_on_lattice(const struct illustrate_rastering *rastering, int layer, int index)
{
	static const float unused[4] = { 0 };
	const struct gz_illustrate_raster *raster = rastering->raster;
	const struct gz_raster_layer *lattice = &raster->points.lattices[index].layer;
	const struct gz_gl_target *target = &raster->targets[layer % 2][index];
	const struct gz_gl_target *before = &raster->targets[(layer + 1) % 2][index];
	gz_gl_target_begin(target);
	gz_gl_target_clear(target, unused);
	gz_gl_layer_begin(lattice);
	if (!rastering->any)
		return;
	glUseProgram(raster->program);
	glBindBufferBase(GL_UNIFORM_BUFFER, GZ_GL_BLOCK_TECHNIQUE, raster->block.name);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GZ_ILLUSTRATE_STORAGE_LOOKS, raster->looks.name);
	glActiveTexture(GL_TEXTURE0 + GZ_ILLUSTRATE_UNIT_BEFORE);
	glBindTexture(GL_TEXTURE_2D, layer > 0 ? before->planes[GZ_GL_TARGET_VECTOR] : 0);
	glUniform3f(GZ_ILLUSTRATE_LATTICE, (float)lattice->from[0], (float)lattice->from[1],
		    (float)lattice->spacing);
	glUniform2f(GZ_ILLUSTRATE_POINTS, (float)lattice->points[0], (float)lattice->points[1]);
	glUniform1i(GZ_ILLUSTRATE_BEHIND, layer > 0);
	gz_raster_clip(raster->frame.clipped);
	draw_illustrated(rastering, layer, lattice);
	gz_raster_clip(false);
	glBindTexture(GL_TEXTURE_2D, 0);
}

/* Find a layer of surfaces on all lattices, and bring it to the host. */
static void find_layer(const struct illustrate_rastering *rastering, int layer)
{
	const struct gz_illustrate_raster *raster = rastering->raster;
	for (int i = 0; i < raster->points.count; i++)
		find_on_lattice(rastering, layer, i);
	if (layer + 1 == raster->picture.layers)
		gz_gl_timer_mark(&rastering->raster->timer, &raster->device, MARK_FOUND);
	for (int i = 0; i < raster->points.count; i++) {
		const struct gz_illustrate_lattice *lattice = &raster->points.lattices[i];
		gz_gl_target_read(&raster->targets[layer % 2][i], GZ_GL_TARGET_VECTOR,
				  lattice->layer.points[0], lattice->layer.points[1],
				  lattice->vectors);
	}
}

/* Find all layers of surfaces, and make the planes of the picture. */
static enum gz_result find_layers(const struct illustrate_rastering *rastering)
{
	struct gz_illustrate_raster *raster = rastering->raster;
	const struct gz_gl_outer_state outer = gz_gl_outer_state_leave();
	gz_gl_timer_mark(&raster->timer, &raster->device, MARK_START);
	for (int layer = 0; layer < raster->picture.layers; layer++) {
		find_layer(rastering, layer);
		gz_illustrate_points_to_planes(&raster->points, raster->workers,
					       raster->picture.planes[layer]);
	}
	gz_gl_outer_state_return(&outer);
	glUseProgram(0);
	const enum gz_result result = gz_gl_device_errors(&raster->device);
	if (result != GZ_OK)
		gz_err(raster->log, "%s failed a frame: %s; %s", raster->device.description,
		       result == GZ_ERR_NO_DEVICE ? "the context is lost" : gz_result_text(result),
		       remedy);
	return result;
}

/* Leave a picture on the device. */
static enum gz_result upload_picture(struct gz_illustrate_raster *raster,
				     const struct gz_image *image)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	enum gz_result result = gz_gl_points_prepare(&raster->shown, &raster->device, pixels);
	if (result == GZ_OK) {
		glBindBuffer(GL_COPY_WRITE_BUFFER, raster->shown.points.name);
		glBufferSubData(GL_COPY_WRITE_BUFFER, 0, (GLsizeiptr)(4 * pixels), image->pixels);
		glBindBuffer(GL_COPY_WRITE_BUFFER, 0);
		gz_gl_points_to_texture(&raster->shown, image->width, image->height);
		result = gz_gl_device_errors(&raster->device);
	}
	if (result != GZ_OK)
		gz_err(raster->log, "the graphics device has no room for a picture of %d x %d px",
		       image->width, image->height);
	return result;
}

/* Compose the picture, and bring it back to the device if it is wanted there. */
static enum gz_result compose_found(struct gz_illustrate_raster *raster, struct gz_image *image,
				    const struct gz_illustrate_planes *planes)
{
	struct gz_image *composed = image ? image : &raster->kept;
	const enum gz_result result =
		gz_illustrate_picture_compose(&raster->picture, &raster->scene, &raster->frame,
					      raster->workers, composed, planes);
	return result == GZ_OK && !image ? upload_picture(raster, composed) : result;
}

/* Make the objects' surfaces, and room for the picture on the host. */
static enum gz_result prepare_host(struct illustrate_rastering *rastering, struct gz_image *image)
{
	struct gz_illustrate_raster *raster = rastering->raster;
	const struct gz_illustrate_shot *shot = rastering->shot;
	struct gz_ray_frame camera;
	enum gz_result result = gz_camera_rays(shot->camera, shot->plan->view.width,
					       shot->plan->view.height, &camera);
	if (result == GZ_OK)
		result = gz_illustrate_scene_prepare(&raster->scene, shot, raster->workers);
	if (result == GZ_OK)
		result = gz_illustrate_picture_prepare(&raster->picture, &raster->scene, shot);
	if (result == GZ_OK)
		result = gz_illustrate_frame_make(&raster->scene, shot, &camera, &raster->frame);
	if (result == GZ_OK)
		result = gz_illustrate_points_prepare(&raster->points, shot->plan,
						      raster->picture.plane_count,
						      gz_workers_count(raster->workers));
	return result == GZ_OK ? gz_image_resize(image ? image : &raster->kept, shot->plan->width,
						 shot->plan->height)
			       : result;
}

static uint64_t points_drawn(const struct gz_illustrate_points *points)
{
	uint64_t sum = 0;
	for (int i = 0; i < points->count; i++)
		sum += gz_raster_layer_drawn(&points->lattices[i].layer);
	return sum;
}

/* Draw on the device, whose context is current. */
static enum gz_result draw_illustrated_frame(struct illustrate_rastering *rastering,
					     struct gz_image *image,
					     const struct gz_illustrate_planes *planes,
					     int64_t start_ns, struct gz_frame_stats *out_stats)
{
	struct gz_illustrate_raster *raster = rastering->raster;
	const bool new_meshes = raster->uploaded != raster->scene.made;
	struct gz_ray_frame rays;
	enum gz_result result = gz_plan_rays(rastering->shot->plan, rastering->shot->camera, &rays);
	if (result == GZ_OK && new_meshes)
		result = upload_illustrated(raster);
	const int64_t uploaded_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = prepare_lattices(raster);
	if (result == GZ_OK)
		result = fill_numbers(rastering, &rays);
	if (result == GZ_OK)
		result = find_layers(rastering);
	const int64_t found_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = compose_found(raster, image, planes);
	if (result != GZ_OK || !out_stats)
		return result;
	const double prepare_ms = new_meshes ? gz_ns_to_ms(uploaded_ns - start_ns) : 0;
	*out_stats = (struct gz_frame_stats) {
		.measures = gz_illustrate_picture_measures(&raster->picture),
		.rays = points_drawn(&raster->points),
		.prepare_ms = prepare_ms,
		.prepare_within_ms = prepare_ms,
		.bricks_coming = raster->scene.marks_coming,
		.cast_ms = gz_ns_to_ms(found_ns - uploaded_ns),
		.reconstruct_ms = gz_ns_to_ms(gz_clock_now_ns() - found_ns),
		.gpu_ms = raster->device.software ? NAN
						  : gz_gl_timer_ms(&raster->timer, &raster->device,
								   MARK_START, MARK_FOUND),
	};
	return result;
}

enum gz_result gz_illustrate_raster_draw(struct gz_illustrate_raster *raster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats)
{
	struct illustrate_rastering rastering = { .raster = raster, .shot = shot };
	const int64_t start_ns = gz_clock_now_ns();
	enum gz_result result = prepare_host(&rastering, image);
	if (result != GZ_OK)
		return result;
	result = gz_gl_device_enter(&raster->device);
	if (result != GZ_OK) {
		gz_err(raster->log, "the OpenGL context cannot be used any more");
		return result;
	}
	result = draw_illustrated_frame(&rastering, image, planes, start_ns, out_stats);
	gz_gl_device_leave(&raster->device);
	return result;
}

unsigned gz_illustrate_raster_picture(const struct gz_illustrate_raster *raster)
{
	return raster->shown.picture;
}

enum gz_result gz_illustrate_raster_print(const struct gz_illustrate_raster *raster,
					  const struct gz_print *print)
{
	return gz_illustrate_drawing_print(&raster->picture.drawing, print, raster->workers,
					   raster->log);
}

const char *gz_illustrate_raster_describe(const struct gz_illustrate_raster *raster)
{
	return raster->device.description;
}
