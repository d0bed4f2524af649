#include "render/illustration/cpu/illustrate_caster.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/vector.h"
#include "render/illustration/cpu/illustrate_scene.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/shading_picture.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/reconstruct/cpu/reconstruct.h"

#define GZ_LOG_MODULE "illustration"

/* Tiles of a part of the work. Chosen: a part takes some 50 us. */
enum { TILES_A_PART = 32 };

/* Towards the lamp of plain light. Chosen: the way that photographs are lit. */
static const double plain_lamp[3] = { -0.5, 0.5, 1 };

/* What rays find. */
enum illustrate_plane { PLANE_TONE, PLANE_DEPTH, PLANE_IDS, PLANE_DISTANCE, FOUND_PLANES };

static const enum gz_plane_kind found_kinds[FOUND_PLANES] = { GZ_PLANE_VALUE, GZ_PLANE_VALUE,
							      GZ_PLANE_ID, GZ_PLANE_VALUE };

/* One layer of surfaces. */
struct illustrate_layer {
	struct gz_plane planes[FOUND_PLANES];
	struct gz_lattices lattices[FOUND_PLANES];
};

struct gz_illustrate_caster {
	const struct gz_log *log;
	const char *simd; /* of the kernels of planes */
	struct gz_workers *workers;
	struct gz_illustrate_scene scene;
	struct illustrate_layer layers[GZ_ILLUSTRATE_LAYERS_MAX];
	struct gz_shading_picture *picture;
	struct gz_illustrate_look *looks;   /* by template */
	struct gz_shading_weights *weights; /* of object 1 to weight_count */
	size_t look_room, weight_room;
	float *sums, *shares; /* of the layers before one: their map, and what they let through */
	size_t blend_room;
	char description[64];
};

/* What the workers of a frame share. */
struct illustrate_job {
	struct gz_illustrate_cast cast;
	const struct gz_plan *plan;
	struct gz_illustrate_caster *caster;
	struct gz_shading_settings settings; /* of objects without templates; weights are those of
						any object */
	int plane_count;                     /* FOUND_PLANES, or one less without distances */
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
					 const struct gz_object *objects, size_t count)
{
	return gz_illustrate_scene_show(&caster->scene, objects, count);
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

/* The look of surfaces by settings. */
static struct gz_illustrate_look look_of(const struct gz_shading_settings *settings,
					 const struct gz_ray_frame *camera)
{
	struct gz_illustrate_look look = {
		.weights = {
			.main_light = (float)settings->main_light,
			.plateau_light = (float)settings->plateau_light,
			.grazing_light = (float)settings->grazing_light,
			.surface_shape = (float)settings->surface_shape,
			.curvature = (float)settings->curvature,
			.plain_light = (float)settings->plain_light,
			.flat = (float)settings->flat,
		},
		.main_level = settings->main_light_smoothing,
		.grazing = {
			.exaggeration = (float)settings->exaggeration,
			.levels = GZ_SHADING_LEVELS,
		},
	};
	gz_grazing_weights(GZ_SHADING_LEVELS, settings->detail_frequency, look.grazing.weights);
	turn_light(camera, settings->light_direction, look.grazing.light);
	return look;
}

static struct gz_shading_weights weights_of(const struct gz_shading_settings *settings)
{
	return (struct gz_shading_weights) {
		.scene = 1, /* its weights are in the plane */
		.edge_light = (float)settings->edge_light,
		.overlap_shadow = (float)settings->overlap_shadow,
		.haze = (float)settings->haze,
		.lines = (float)settings->lines,
		.background = (float)settings->haze_background,
	};
}

/* Room for at least @p count elements of @p size bytes. */
static enum gz_result make_room(void **room, size_t *have, size_t count, size_t size)
{
	if (*have >= count)
		return GZ_OK;
	free(*room);
	*have = 0;
	*room = calloc(count, size);
	if (!*room)
		return GZ_ERR_NO_MEM;
	*have = count;
	return GZ_OK;
}

/* Steps of the picture are done if any object asks for them. */
static void join_weights(const struct gz_shading_settings *more, struct gz_shading_settings *all)
{
	all->edge_light = fmax(all->edge_light, more->edge_light);
	all->overlap_shadow = fmax(all->overlap_shadow, more->overlap_shadow);
	all->haze = fmax(all->haze, more->haze);
	all->lines = fmax(all->lines, more->lines);
}

/* Resolve the looks of all templates, and the weights of all objects. */
static enum gz_result fill_illustrate_looks(struct gz_illustrate_caster *caster,
					    const struct gz_illustration_look *look,
					    const struct gz_ray_frame *camera,
					    struct illustrate_job *job)
{
	const struct gz_illustrate_scene *scene = &caster->scene;
	enum gz_result result = make_room((void **)&caster->looks, &caster->look_room,
					  scene->template_count, sizeof *caster->looks);
	if (result == GZ_OK)
		result = make_room((void **)&caster->weights, &caster->weight_room, scene->id_count,
				   sizeof *caster->weights);
	if (result != GZ_OK)
		return result;
	gz_illustration_look_resolve(look, NULL, &job->settings);
	for (size_t k = 0; k < scene->template_count; k++) {
		struct gz_shading_settings settings;
		gz_illustration_look_resolve(look, scene->templates[k].said, &settings);
		caster->looks[k] = look_of(&settings, camera);
		const struct gz_shading_weights weights = weights_of(&settings);
		for (size_t i = 0; i < scene->id_count; i++)
			if (scene->looks[i] == k)
				caster->weights[i] = weights;
		join_weights(&settings, &job->settings);
	}
	job->cast.looks = caster->looks;
	return GZ_OK;
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

static void store_hits(const struct illustrate_job *job, int layer, const struct gz_tile *tile,
		       uint32_t active, const struct gz_illustrate_hits *hits)
{
	uint32_t words[FOUND_PLANES][GZ_ILLUSTRATE_RAYS];
	memcpy(words[PLANE_TONE], hits->tone, sizeof hits->tone);
	memcpy(words[PLANE_DEPTH], hits->depth_mm, sizeof hits->depth_mm);
	memcpy(words[PLANE_IDS], hits->ids, sizeof hits->ids);
	memcpy(words[PLANE_DISTANCE], hits->distance_mm, sizeof hits->distance_mm);
	for (int plane = 0; plane < job->plane_count; plane++)
		gz_lattices_store(&job->caster->layers[layer].lattices[plane], job->plan, tile,
				  active, words[plane]);
}

static void illustrate_part(void *user, size_t part, int worker)
{
	const struct illustrate_job *job = user;
	const struct gz_plan *plan = job->plan;
	const size_t from = part * TILES_A_PART, end = from + TILES_A_PART;
	(void)worker;
	for (size_t i = from; i < end && i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		struct gz_illustrate_tile rays;
		struct gz_illustrate_hits hits[GZ_ILLUSTRATE_LAYERS_MAX];
		aim_tile(plan, tile, &rays);
		gz_illustrate_tile_cast(&job->cast, &rays, hits);
		for (int layer = 0; layer < job->cast.layers; layer++)
			store_hits(job, layer, tile, rays.active, &hits[layer]);
	}
}

static enum gz_result make_found_planes(struct illustrate_layer *layer, const struct gz_plan *plan,
					int count)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		result = gz_plane_resize(&layer->planes[i], found_kinds[i], plan->width,
					 plan->height);
		if (result == GZ_OK)
			result = gz_lattices_prepare(&layer->lattices[i], plan,
						     layer->planes[i].words);
	}
	return result;
}

static void reconstruct_found(struct gz_illustrate_caster *caster, struct illustrate_layer *layer,
			      const struct gz_plan *plan, int count)
{
	const struct gz_row_filters *colours = gz_row_filters_find(caster->simd);
	for (int i = 0; i < count; i++) {
		const struct gz_row_filters filters =
			gz_row_filters_of_plane(found_kinds[i], colours);
		gz_reconstruct(plan, &layer->lattices[i], &filters, caster->workers,
			       layer->planes[i].words);
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

/* Compose the map of one layer. Those behind the front one take over its tone curve. */
static enum gz_result compose_layer(const struct illustrate_job *job, int layer,
				    const struct gz_ray_frame *camera, uint32_t *out_pixels,
				    const float **out_map)
{
	struct gz_illustrate_caster *caster = job->caster;
	const struct gz_illustrate_scene *scene = &caster->scene;
	const struct gz_plane *planes = caster->layers[layer].planes;
	struct gz_shading_frame frame = {
		.width = job->plan->width,
		.height = job->plan->height,
		.tone = planes[PLANE_TONE].words,
		.depth = planes[PLANE_DEPTH].words,
		.ids = planes[PLANE_IDS].words,
		.object_distance_mm =
			job->plane_count == FOUND_PLANES ? planes[PLANE_DISTANCE].words : NULL,
		.importances = scene->importances,
		.weights = caster->weights,
		.objects = scene->id_count,
		.keeps_curve = layer > 0,
	};
	find_depth_range(scene, camera, job->plan, &frame);
	return gz_shading_picture_compose(caster->picture, &frame, &job->settings, caster->workers,
					  out_pixels, out_map);
}

/* Add the map of a layer, as far as those before it let it through. */
static void blend_layer(const struct gz_illustrate_caster *caster, int layer, const float *map,
			size_t pixels)
{
	const struct gz_illustrate_scene *scene = &caster->scene;
	const uint32_t *ids = caster->layers[layer].planes[PLANE_IDS].words;
	float *sums = caster->sums, *shares = caster->shares;
	for (size_t i = 0; i < pixels; i++) {
		const size_t id = ids[i];
		const bool is_object = id > 0 && id <= scene->id_count;
		const float opacity = is_object ? scene->opacities[id - 1] : 1;
		sums[i] += shares[i] * opacity * map[i];
		shares[i] *= 1 - opacity;
	}
}

static enum gz_result compose_layers(const struct illustrate_job *job,
				     const struct gz_ray_frame *camera, struct gz_image *image)
{
	struct gz_illustrate_caster *caster = job->caster;
	const size_t pixels = (size_t)job->plan->width * (size_t)job->plan->height;
	const float *map = NULL;
	enum gz_result result = compose_layer(
		job, 0, camera, job->cast.layers == 1 ? gz_image_words(image) : NULL, &map);
	if (result == GZ_OK && job->cast.layers > 1) {
		memset(caster->sums, 0, pixels * sizeof *caster->sums);
		for (size_t i = 0; i < pixels; i++)
			caster->shares[i] = 1;
		blend_layer(caster, 0, map, pixels);
	}
	for (int layer = 1; layer < job->cast.layers && result == GZ_OK; layer++) {
		result = compose_layer(job, layer, camera, NULL, &map);
		if (result == GZ_OK)
			blend_layer(caster, layer, map, pixels);
	}
	if (result == GZ_OK && job->cast.layers > 1)
		gz_shading_grey(caster->sums, pixels, gz_image_words(image));
	return result;
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

/* Room for what is blended of layers behind each other. */
static enum gz_result make_blend_room(struct gz_illustrate_caster *caster,
				      const struct gz_plan *plan)
{
	const size_t pixels = (size_t)plan->width * (size_t)plan->height;
	if (caster->blend_room >= pixels)
		return GZ_OK;
	free(caster->sums);
	free(caster->shares);
	caster->sums = calloc(pixels, sizeof *caster->sums);
	caster->shares = calloc(pixels, sizeof *caster->shares);
	caster->blend_room = caster->sums && caster->shares ? pixels : 0;
	return caster->blend_room > 0 ? GZ_OK : GZ_ERR_NO_MEM;
}

/* Whether distances to the chosen object count. */
static bool is_measured(const struct gz_illustrate_shot *shot)
{
	struct gz_shading_settings settings;
	gz_illustration_look_resolve(shot->look, NULL, &settings);
	return settings.object_distance > 0 && shot->chosen_id > 0;
}

/* Check a shot, and make what it shows and the room for it. */
static enum gz_result prepare_shot(const struct gz_illustrate_shot *shot, struct gz_image *image,
				   struct illustrate_job *job, struct gz_ray_frame *out_camera)
{
	struct gz_illustrate_caster *caster = job->caster;
	const struct gz_plan *plan = shot->plan;
	if (caster->scene.count < 1 || plan->layer_count < 1 ||
	    !gz_illustration_look_valid(shot->look))
		return GZ_ERR_INVAL;
	const bool measured = is_measured(shot);
	job->plane_count = measured ? FOUND_PLANES : PLANE_DISTANCE;
	job->cast.layers = caster->scene.transparent ? GZ_ILLUSTRATE_LAYERS_MAX : 1;
	enum gz_result result =
		gz_camera_rays(shot->camera, plan->view.width, plan->view.height, out_camera);
	if (result == GZ_OK)
		result = gz_image_resize(image, plan->width, plan->height);
	for (int i = 0; i < job->cast.layers && result == GZ_OK; i++)
		result = make_found_planes(&caster->layers[i], plan, job->plane_count);
	if (result == GZ_OK && job->cast.layers > 1)
		result = make_blend_room(caster, plan);
	if (result == GZ_OK)
		result = gz_illustrate_scene_prepare(&caster->scene, shot->isovalue,
						     measured ? shot->chosen_id : 0,
						     caster->workers);
	return result;
}

static enum gz_result copy_found(const struct illustrate_layer *layer,
				 const struct gz_illustrate_planes *planes)
{
	const enum gz_result result = copy_plane(&layer->planes[PLANE_DEPTH], planes->depth);
	return result == GZ_OK ? copy_plane(&layer->planes[PLANE_IDS], planes->ids) : result;
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
	enum gz_result result = prepare_shot(shot, image, &job, &camera);
	if (result == GZ_OK)
		result = fill_illustrate_looks(caster, shot->look, &camera, &job);
	if (result != GZ_OK)
		return result;
	const int64_t prepared_ns = gz_clock_now_ns();
	job.cast.tree = caster->scene.tree.scene;
	job.cast.meshes = caster->scene.listed;
	job.cast.mesh_count = (unsigned)caster->scene.count;
	fill_illustrate_rays(&camera, caster->scene.meshes.world_mm, &job.cast);
	fill_illustrate_clip(&caster->scene, shot->clip, &job.cast);
	turn_light(&camera, plain_lamp, job.cast.lamp);
	gz_workers_run(caster->workers, illustrate_part, &job,
		       (shot->plan->tile_count + TILES_A_PART - 1) / TILES_A_PART);
	const int64_t cast_ns = gz_clock_now_ns();
	for (int i = 0; i < job.cast.layers; i++)
		reconstruct_found(caster, &caster->layers[i], shot->plan, job.plane_count);
	result = compose_layers(&job, &camera, image);
	if (result == GZ_OK && planes)
		result = copy_found(&caster->layers[0], planes);
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
	for (int k = 0; k < GZ_ILLUSTRATE_LAYERS_MAX; k++)
		for (int i = 0; i < FOUND_PLANES; i++) {
			gz_plane_free(&self->layers[k].planes[i]);
			gz_lattices_free(&self->layers[k].lattices[i]);
		}
	free(self->looks);
	free(self->weights);
	free(self->sums);
	free(self->shares);
	free(self);
	*caster = NULL;
}
