#include "render/illustration/cpu/illustrate_caster.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/vector.h"
#include "render/illustration/cpu/illustrate_scene.h"
#include "render/illustration/shading_picture.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/reconstruct/cpu/reconstruct.h"

#define GZ_LOG_MODULE "illustration"

/* Tiles of a part of the work. Chosen: a part takes some 50 us. */
enum { TILES_A_PART = 32 };

/* What rays find. */
enum illustrate_plane { PLANE_TONE, PLANE_DEPTH, PLANE_IDS, PLANE_DISTANCE, FOUND_PLANES };

static const enum gz_plane_kind found_kinds[FOUND_PLANES] = { GZ_PLANE_VALUE, GZ_PLANE_VALUE,
							      GZ_PLANE_ID, GZ_PLANE_VALUE };

struct gz_illustrate_caster {
	const struct gz_log *log;
	const char *simd; /* of the kernels of planes */
	struct gz_workers *workers;
	struct gz_illustrate_scene scene;
	struct gz_plane planes[FOUND_PLANES];
	struct gz_lattices lattices[FOUND_PLANES];
	struct gz_shading_picture *picture;
	char description[64];
};

/* What the workers of a frame share. */
struct illustrate_job {
	struct gz_illustrate_cast cast;
	const struct gz_plan *plan;
	struct gz_illustrate_caster *caster;
	int plane_count; /* FOUND_PLANES, or one less without distances */
};

bool gz_illustrate_caster_present(void)
{
	return true;
}

enum gz_result gz_illustrate_caster_check(const struct gz_backend_params *params,
					  const struct gz_log *log)
{
	return gz_cpu_raycaster_check(params, log);
}

static enum gz_result start_illustrating(struct gz_illustrate_caster *caster,
					 const struct gz_backend_params *params)
{
	enum gz_result result = gz_illustrate_caster_check(params, caster->log);
	if (result != GZ_OK)
		return result;
	caster->simd = gz_cast_kernels_find(params->simd)->name;
	result = gz_workers_create(params->threads, &caster->workers);
	if (result != GZ_OK) {
		gz_err(caster->log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	snprintf(caster->description, sizeof caster->description, "%s, %d threads", caster->simd,
		 gz_workers_count(caster->workers));
	result = gz_shading_picture_create(&caster->picture);
	/* Embree has no name for the portable set. */
	const char *isa = strcmp(caster->simd, "portable") == 0 ? "sse2" : caster->simd;
	return result == GZ_OK ? gz_surface_tree_open(&caster->scene.tree, isa, caster->log)
			       : result;
}

enum gz_result gz_illustrate_caster_create(const struct gz_backend_params *params,
					   const struct gz_log *log,
					   struct gz_illustrate_caster **out_caster)
{
	static const struct gz_backend_params defaults = { 0 };
	struct gz_illustrate_caster *caster = calloc(1, sizeof *caster);
	if (!caster)
		return GZ_ERR_NO_MEM;
	caster->log = caster->scene.log = caster->scene.meshes.log = log;
	const enum gz_result result = start_illustrating(caster, params ? params : &defaults);
	if (result != GZ_OK) {
		gz_illustrate_caster_destroy(&caster);
		return result;
	}
	*out_caster = caster;
	return GZ_OK;
}

enum gz_result gz_illustrate_caster_show(struct gz_illustrate_caster *caster,
					 const struct gz_object *objects,
					 const struct gz_illustrated *each, size_t count)
{
	return gz_illustrate_scene_show(&caster->scene, objects, each, count);
}

static void fill_illustrate_rays(const struct gz_ray_frame *camera, double world_mm,
				 struct gz_illustrate_cast *cast)
{
	for (int axis = 0; axis < 3; axis++) {
		cast->origin00[axis] = (float)(camera->origin00[axis] * world_mm);
		cast->origin_dx[axis] = (float)(camera->origin_dx[axis] * world_mm);
		cast->origin_dy[axis] = (float)(camera->origin_dy[axis] * world_mm);
		cast->direction00[axis] = (float)camera->direction00[axis];
		cast->direction_dx[axis] = (float)camera->direction_dx[axis];
		cast->direction_dy[axis] = (float)camera->direction_dy[axis];
	}
}

static void fill_illustrate_clip(const struct gz_illustrate_scene *scene,
				 const struct gz_clip_box *clip, struct gz_illustrate_cast *cast)
{
	const struct gz_volume *volume = scene->meshes.items[0].object.volume;
	for (int axis = 0; clip && axis < 3; axis++) {
		const double edge = volume->dims[axis] * volume->spacing[axis];
		cast->clipped = cast->clipped || clip->least[axis] > 0 || clip->greatest[axis] < 1;
		cast->clip_least[axis] = (float)((clip->least[axis] - 0.5) * edge);
		cast->clip_greatest[axis] = (float)((clip->greatest[axis] - 0.5) * edge);
	}
}

/* Turn a direction from the frame of the picture (right, up, towards the viewer) into that of the
 * meshes. Rows of pixels run downwards. */
static void turn_light(const struct gz_ray_frame *camera, const double direction[3],
		       float out_light[3])
{
	double right[3], up[3], viewer[3], light[3];
	for (int axis = 0; axis < 3; axis++) {
		right[axis] = camera->origin_dx[axis] + camera->direction_dx[axis];
		up[axis] = -camera->origin_dy[axis] - camera->direction_dy[axis];
	}
	(void)gz_normalise3(right);
	(void)gz_normalise3(up);
	gz_cross3(right, up, viewer);
	for (int axis = 0; axis < 3; axis++)
		light[axis] = direction[0] * right[axis] + direction[1] * up[axis] +
			      direction[2] * viewer[axis];
	const bool any = gz_normalise3(light);
	for (int axis = 0; axis < 3; axis++)
		out_light[axis] = (float)(any ? light[axis] : viewer[axis]);
}

static void fill_illustrate_look(const struct gz_shading_settings *settings,
				 const struct gz_ray_frame *camera, struct gz_illustrate_cast *cast)
{
	/* Chosen: the way that photographs are lit. */
	static const double lamp[3] = { -0.5, 0.5, 1 };
	cast->weights = (struct gz_illustrate_weights) {
		.main_light = (float)settings->main_light,
		.plateau_light = (float)settings->plateau_light,
		.grazing_light = (float)settings->grazing_light,
		.surface_shape = (float)settings->surface_shape,
		.curvature = (float)settings->curvature,
		.plain_light = (float)settings->plain_light,
		.flat = (float)settings->flat,
	};
	cast->main_level = settings->main_light_smoothing;
	cast->grazing.exaggeration = (float)settings->exaggeration;
	cast->grazing.levels = GZ_SHADING_LEVELS;
	gz_grazing_weights(GZ_SHADING_LEVELS, settings->detail_frequency, cast->grazing.weights);
	turn_light(camera, settings->light_direction, cast->grazing.light);
	turn_light(camera, lamp, cast->lamp);
}

static void aim_tile(const struct gz_plan *plan, const struct gz_tile *tile,
		     struct gz_illustrate_tile *out_rays)
{
	const int spacing = plan->layers[tile->layer].spacing;
	out_rays->active = gz_plan_tile_active(plan, tile);
	for (int k = 0; k < GZ_ILLUSTRATE_RAYS; k++) {
		const int column = gz_tile_columns[tile->pattern][k];
		out_rays->x[k] = (float)(tile->x - plan->view.shift[0] + column * spacing);
		out_rays->y[k] = (float)(tile->y - plan->view.shift[1] + gz_tile_rows[k] * spacing);
	}
}

_Static_assert(GZ_TILE_EDGE *GZ_TILE_EDGE == GZ_ILLUSTRATE_RAYS, "a tile is a packet");

static void illustrate_part(void *user, size_t part, int worker)
{
	const struct illustrate_job *job = user;
	const struct gz_plan *plan = job->plan;
	const size_t from = part * TILES_A_PART, end = from + TILES_A_PART;
	(void)worker;
	for (size_t i = from; i < end && i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		struct gz_illustrate_tile rays;
		struct gz_illustrate_hits hits;
		uint32_t words[FOUND_PLANES][GZ_ILLUSTRATE_RAYS];
		aim_tile(plan, tile, &rays);
		gz_illustrate_tile_cast(&job->cast, &rays, &hits);
		memcpy(words[PLANE_TONE], hits.tone, sizeof hits.tone);
		memcpy(words[PLANE_DEPTH], hits.depth_mm, sizeof hits.depth_mm);
		memcpy(words[PLANE_IDS], hits.ids, sizeof hits.ids);
		memcpy(words[PLANE_DISTANCE], hits.distance_mm, sizeof hits.distance_mm);
		for (int plane = 0; plane < job->plane_count; plane++)
			gz_lattices_store(&job->caster->lattices[plane], plan, tile, rays.active,
					  words[plane]);
	}
}

static enum gz_result make_found_planes(struct gz_illustrate_caster *caster,
					const struct gz_plan *plan, int count)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		result = gz_plane_resize(&caster->planes[i], found_kinds[i], plan->width,
					 plan->height);
		if (result == GZ_OK)
			result = gz_lattices_prepare(&caster->lattices[i], plan,
						     caster->planes[i].words);
	}
	return result;
}

static void reconstruct_found(struct gz_illustrate_caster *caster, const struct gz_plan *plan,
			      int count)
{
	const struct gz_row_filters *colours = gz_row_filters_find(caster->simd);
	for (int i = 0; i < count; i++) {
		const struct gz_row_filters filters =
			gz_row_filters_of_plane(found_kinds[i], colours);
		gz_reconstruct(plan, &caster->lattices[i], &filters, caster->workers,
			       caster->planes[i].words);
	}
}

/* The scene's nearest and farthest distance from where rays begin, along the ray in the middle. */
static void find_depth_range(const struct gz_illustrate_scene *scene,
			     const struct gz_ray_frame *camera, const struct gz_plan *plan,
			     struct gz_shading_frame *frame)
{
	const double world_mm = scene->meshes.world_mm;
	const double x = plan->view.width / 2.0, y = plan->view.height / 2.0;
	double direction[3], to_centre[3];
	for (int axis = 0; axis < 3; axis++) {
		const double origin = camera->origin00[axis] + x * camera->origin_dx[axis] +
				      y * camera->origin_dy[axis];
		direction[axis] = camera->direction00[axis] + x * camera->direction_dx[axis] +
				  y * camera->direction_dy[axis];
		to_centre[axis] = scene->centre_mm[axis] - origin * world_mm;
	}
	(void)gz_normalise3(direction);
	const double middle = gz_dot3(direction, to_centre), radius = scene->radius_mm;
	frame->near = (float)fmax(middle - radius, 0);
	frame->far = (float)fmax(middle + radius, (double)frame->near * 1.001 + 1e-6 * radius);
}

static enum gz_result compose_picture(struct gz_illustrate_caster *caster,
				      const struct gz_illustrate_shot *shot,
				      const struct gz_ray_frame *camera, bool measured,
				      struct gz_image *image)
{
	const struct gz_plan *plan = shot->plan;
	const struct gz_illustrate_scene *scene = &caster->scene;
	struct gz_shading_frame frame = {
		.width = plan->width,
		.height = plan->height,
		.tone = caster->planes[PLANE_TONE].words,
		.depth = caster->planes[PLANE_DEPTH].words,
		.ids = caster->planes[PLANE_IDS].words,
		.object_distance_mm = measured ? caster->planes[PLANE_DISTANCE].words : NULL,
		.importances = scene->importances,
		.objects = scene->importance_count,
	};
	const float *map = NULL;
	find_depth_range(scene, camera, plan, &frame);
	return gz_shading_picture_compose(caster->picture, &frame, shot->settings, caster->workers,
					  gz_image_words(image), &map);
}

static enum gz_result copy_plane(const struct gz_plane *from, struct gz_plane *to)
{
	if (!to)
		return GZ_OK;
	const enum gz_result result = gz_plane_resize(to, from->kind, from->width, from->height);
	if (result == GZ_OK)
		memcpy(to->words, from->words,
		       (size_t)from->width * (size_t)from->height * sizeof *to->words);
	return result;
}

/* Check a shot, and make what it shows and the room for it. */
static enum gz_result prepare_shot(struct gz_illustrate_caster *caster,
				   const struct gz_illustrate_shot *shot, struct gz_image *image,
				   struct illustrate_job *job, struct gz_ray_frame *out_camera)
{
	const struct gz_plan *plan = shot->plan;
	if (caster->scene.meshes.count < 1 || plan->layer_count < 1 ||
	    !gz_options_hold(gz_shading_options, gz_shading_option_count, shot->settings))
		return GZ_ERR_INVAL;
	const bool measured = shot->settings->object_distance > 0 && shot->chosen_id > 0;
	job->plane_count = measured ? FOUND_PLANES : PLANE_DISTANCE;
	enum gz_result result =
		gz_camera_rays(shot->camera, plan->view.width, plan->view.height, out_camera);
	if (result == GZ_OK)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result == GZ_OK)
		result = make_found_planes(caster, plan, job->plane_count);
	if (result == GZ_OK)
		result = gz_illustrate_scene_prepare(&caster->scene, shot->isovalue,
						     measured ? shot->chosen_id : 0,
						     caster->workers);
	return result;
}

enum gz_result gz_illustrate_caster_draw(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats)
{
	struct illustrate_job job = { .plan = shot->plan, .caster = caster };
	struct gz_ray_frame camera;
	const int64_t start_ns = gz_clock_now_ns();
	const unsigned made_before = caster->scene.made;
	enum gz_result result = prepare_shot(caster, shot, image, &job, &camera);
	if (result != GZ_OK)
		return result;
	const int64_t prepared_ns = gz_clock_now_ns();
	job.cast.tree = caster->scene.tree.scene;
	job.cast.meshes = caster->scene.listed;
	job.cast.mesh_count = (unsigned)caster->scene.meshes.count;
	fill_illustrate_rays(&camera, caster->scene.meshes.world_mm, &job.cast);
	fill_illustrate_clip(&caster->scene, shot->clip, &job.cast);
	fill_illustrate_look(shot->settings, &camera, &job.cast);
	gz_workers_run(caster->workers, illustrate_part, &job,
		       (shot->plan->tile_count + TILES_A_PART - 1) / TILES_A_PART);
	const int64_t cast_ns = gz_clock_now_ns();
	reconstruct_found(caster, shot->plan, job.plane_count);
	result = compose_picture(caster, shot, &camera, job.plane_count == FOUND_PLANES, image);
	if (result == GZ_OK && planes)
		result = copy_plane(&caster->planes[PLANE_DEPTH], planes->depth);
	if (result == GZ_OK && planes)
		result = copy_plane(&caster->planes[PLANE_IDS], planes->ids);
	const bool made = caster->scene.made != made_before;
	const double prepare_ms = made ? gz_ns_to_ms(prepared_ns - start_ns) : 0;
	if (result == GZ_OK && out_stats)
		*out_stats = (struct gz_frame_stats) {
			.rays = shot->plan->ray_count,
			.prepare_ms = prepare_ms,
			.prepare_within_ms = prepare_ms,
			.cast_ms = gz_ns_to_ms(cast_ns - prepared_ns),
			.reconstruct_ms = gz_ns_to_ms(gz_clock_now_ns() - cast_ns),
			.gpu_ms = NAN,
		};
	return result;
}

const char *gz_illustrate_caster_describe(const struct gz_illustrate_caster *caster)
{
	return caster->description;
}

void gz_illustrate_caster_destroy(struct gz_illustrate_caster **caster)
{
	struct gz_illustrate_caster *self = *caster;
	if (!self)
		return;
	gz_workers_destroy(&self->workers);
	gz_illustrate_scene_free(&self->scene);
	gz_shading_picture_destroy(&self->picture);
	for (int i = 0; i < FOUND_PLANES; i++) {
		gz_plane_free(&self->planes[i]);
		gz_lattices_free(&self->lattices[i]);
	}
	free(self);
	*caster = NULL;
}
