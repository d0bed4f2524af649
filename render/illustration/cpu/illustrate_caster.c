#include "render/illustration/cpu/illustrate_caster.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/illustration/cpu/illustrate_cast.h"
#include "render/illustration/shared/illustrate_frame.h"
#include "render/illustration/shared/illustrate_picture.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/cpu_raycaster.h"
#include "render/reconstruct/cpu/reconstruct.h"
#include "render/surface/cpu/surface_tree.h"

#define GZ_LOG_MODULE "illustration"

/* Tiles of a part of the work. Chosen: a part takes some 50 us. */
enum { TILES_A_PART = 32 };

struct gz_illustrate_caster {
	const struct gz_log *log;
	const struct gz_illustrate_kernel *kernel;
	struct gz_workers *workers;
	struct gz_illustrate_scene scene;
	struct gz_surface_tree tree;
	uint64_t tree_of; /* scene.meshes_made when the tree was built; 0: never */
	struct gz_illustrate_frame frame;
	struct gz_illustrate_picture picture;
	struct gz_lattices lattices[GZ_ILLUSTRATE_LAYERS_MAX][GZ_ILLUSTRATE_FOUND];
	char description[64];
};

/* What the workers of a frame share. */
struct illustrate_job {
	struct gz_illustrate_cast cast;
	const struct gz_plan *plan;
	struct gz_illustrate_caster *caster;
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

/* The kernel of an instruction set that this processor runs. */
static const struct gz_illustrate_kernel *find_illustrate_kernel(const char *simd)
{
	static const struct gz_illustrate_kernel *const kernels[] = {
#ifdef GZ_CAST_X86
		&gz_illustrate_avx512,
		&gz_illustrate_avx2,
#endif
		&gz_illustrate_portable,
	};
	const struct gz_cast_kernels *found = gz_cast_kernels_find(simd);
	for (size_t i = 0; found && i < sizeof kernels / sizeof kernels[0]; i++)
		if (strcmp(kernels[i]->name, found->name) == 0)
			return kernels[i];
	return &gz_illustrate_portable;
}

static enum gz_result start_illustrating(struct gz_illustrate_caster *caster,
					 const struct gz_backend_params *params)
{
	enum gz_result result = gz_illustrate_caster_check(params, caster->log);
	if (result != GZ_OK)
		return result;
	caster->kernel = find_illustrate_kernel(params->simd);
	result = gz_workers_create(params->threads, &caster->workers);
	if (result != GZ_OK) {
		gz_err(caster->log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	snprintf(caster->description, sizeof caster->description, "%s, %d threads",
		 caster->kernel->name, gz_workers_count(caster->workers));
	result = gz_illustrate_picture_open(&caster->picture);
	return result == GZ_OK
		       ? gz_surface_tree_open(&caster->tree, caster->kernel->isa, caster->log)
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
	caster->scene.waits_for_marks = params && params->wait_for_bricks;
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

static struct gz_illustrate_tile aim_tile(const struct gz_plan *plan, const struct gz_tile *tile)
{
	return (struct gz_illustrate_tile) {
		.x = (float)(tile->x - plan->view.shift[0]),
		.y = (float)(tile->y - plan->view.shift[1]),
		.spacing = (float)plan->layers[tile->layer].spacing,
		.columns = gz_tile_columns[tile->pattern],
		.rows = gz_tile_rows,
		.active = gz_plan_tile_active(plan, tile),
	};
}

_Static_assert(GZ_TILE_EDGE *GZ_TILE_EDGE == GZ_ILLUSTRATE_RAYS, "a tile is a packet");

static void store_hits(const struct illustrate_job *job, int layer, const struct gz_tile *tile,
		       uint32_t active, const struct gz_illustrate_hits *hits)
{
	uint32_t words[GZ_ILLUSTRATE_FOUND][GZ_ILLUSTRATE_RAYS];
	memcpy(words[GZ_ILLUSTRATE_TONE], hits->tone, sizeof hits->tone);
	memcpy(words[GZ_ILLUSTRATE_DEPTH], hits->depth_mm, sizeof hits->depth_mm);
	memcpy(words[GZ_ILLUSTRATE_IDS], hits->ids, sizeof hits->ids);
	memcpy(words[GZ_ILLUSTRATE_DISTANCE], hits->distance_mm, sizeof hits->distance_mm);
	gz_lattices_store_planes(job->caster->lattices[layer], job->caster->picture.plane_count,
				 job->plan, tile, active, words);
}

static void illustrate_part(void *user, size_t part, int worker)
{
	const struct illustrate_job *job = user;
	const struct gz_plan *plan = job->plan;
	const size_t from = part * TILES_A_PART, end = from + TILES_A_PART;
	(void)worker;
	for (size_t i = from; i < end && i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const struct gz_illustrate_tile rays = aim_tile(plan, tile);
		struct gz_illustrate_hits hits[GZ_ILLUSTRATE_LAYERS_MAX];
		job->caster->kernel->cast(&job->cast, &rays, hits);
		for (int layer = 0; layer < job->cast.layers; layer++)
			store_hits(job, layer, tile, rays.active, &hits[layer]);
	}
}

/* Make the tree if the meshes are others. */
static enum gz_result prepare_tree(struct gz_illustrate_caster *caster)
{
	if (caster->tree_of == caster->scene.meshes_made)
		return GZ_OK;
	caster->tree_of = 0;
	const enum gz_result result = gz_surface_tree_build(
		&caster->tree, caster->scene.meshes.shown, caster->scene.count);
	if (result == GZ_OK)
		caster->tree_of = caster->scene.meshes_made;
	return result;
}

/* Make the room for what rays find, and the tree. */
static enum gz_result prepare_caster(struct gz_illustrate_caster *caster,
				     const struct gz_illustrate_shot *shot)
{
	enum gz_result result =
		gz_illustrate_picture_prepare(&caster->picture, &caster->scene, shot);
	for (int layer = 0; layer < caster->picture.layers; layer++)
		for (int i = 0; i < caster->picture.plane_count && result == GZ_OK; i++)
			result = gz_lattices_prepare(&caster->lattices[layer][i], shot->plan,
						     caster->picture.planes[layer][i].words);
	return result == GZ_OK ? prepare_tree(caster) : result;
}

/* @param needs_depth  someone reads depth where there is nothing, too */
static void reconstruct_found(struct gz_illustrate_caster *caster, const struct gz_plan *plan,
			      bool needs_depth)
{
	const struct gz_row_filters *colours = gz_row_filters_find(caster->kernel->name);
	struct gz_row_filters filters[GZ_ILLUSTRATE_FOUND];
	struct gz_reconstructed planes[GZ_ILLUSTRATE_LAYERS_MAX * GZ_ILLUSTRATE_FOUND];
	int count = 0;
	for (int i = 0; i < caster->picture.plane_count; i++)
		filters[i] = gz_row_filters_of_plane(gz_illustrate_found_kinds[i], colours);
	for (int layer = 0; layer < caster->picture.layers; layer++)
		for (int i = 0; i < caster->picture.plane_count; i++)
			planes[count++] = (struct gz_reconstructed) {
				.lattices = &caster->lattices[layer][i],
				.filters = &filters[i],
				.picture = caster->picture.planes[layer][i].words,
				.leaves_empty = gz_illustrate_found_kinds[i] == GZ_PLANE_VALUE &&
						!(needs_depth && i == GZ_ILLUSTRATE_DEPTH),
			};
	gz_reconstruct_planes(plan, planes, count, caster->workers);
}

/* What all rays share. */
static void fill_illustrate_cast(const struct gz_illustrate_caster *caster, int layers,
				 const struct gz_ray_frame *camera, struct gz_illustrate_cast *cast)
{
	*cast = (struct gz_illustrate_cast) {
		.tree = caster->tree.scene,
		.meshes = caster->scene.listed,
		.mesh_count = (unsigned)caster->scene.count,
		.frame = &caster->frame,
		.layers = layers,
	};
	fill_illustrate_rays(camera, caster->scene.meshes.world_mm, cast);
}

/* Cast all rays of a shot. */
static void cast_shot(struct gz_illustrate_caster *caster, const struct gz_illustrate_shot *shot,
		      const struct gz_ray_frame *camera)
{
	struct illustrate_job job = { .plan = shot->plan, .caster = caster };
	fill_illustrate_cast(caster, caster->picture.layers, camera, &job.cast);
	gz_workers_run(caster->workers, illustrate_part, &job,
		       (shot->plan->tile_count + TILES_A_PART - 1) / TILES_A_PART);
}

enum gz_result gz_illustrate_caster_draw(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 struct gz_image *image,
					 const struct gz_illustrate_planes *planes,
					 struct gz_frame_stats *out_stats)
{
	const struct gz_plan *plan = shot->plan;
	struct gz_ray_frame camera;
	const int64_t start_ns = gz_clock_now_ns();
	const uint64_t made_before = caster->scene.made;
	enum gz_result result =
		gz_camera_rays(shot->camera, plan->view.width, plan->view.height, &camera);
	if (result == GZ_OK)
		result = gz_illustrate_scene_prepare(&caster->scene, shot, caster->workers);
	if (result == GZ_OK)
		result = prepare_caster(caster, shot);
	if (result == GZ_OK)
		result = gz_illustrate_frame_make(&caster->scene, shot, &camera, &caster->frame);
	if (result == GZ_OK)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result != GZ_OK)
		return result;
	const int64_t prepared_ns = gz_clock_now_ns();
	cast_shot(caster, shot, &camera);
	const int64_t cast_ns = gz_clock_now_ns();
	reconstruct_found(caster, plan, planes || caster->picture.drawing.drawn);
	result = gz_illustrate_picture_compose(&caster->picture, &caster->scene, &caster->frame,
					       caster->workers, image, planes);
	const bool made = caster->scene.made != made_before;
	const double prepare_ms = made ? gz_ns_to_ms(prepared_ns - start_ns) : 0;
	if (result == GZ_OK && out_stats)
		*out_stats = (struct gz_frame_stats) {
			.rays = plan->ray_count,
			.prepare_ms = prepare_ms,
			.prepare_within_ms = prepare_ms,
			.bricks_coming = caster->scene.marks_coming,
			.cast_ms = gz_ns_to_ms(cast_ns - prepared_ns),
			.reconstruct_ms = gz_ns_to_ms(gz_clock_now_ns() - cast_ns),
			.gpu_ms = NAN,
			.measures = gz_illustrate_picture_measures(&caster->picture),
		};
	return result;
}

/* Add the surface of a layer at the ray. @return what it lets through of what lies behind */
static double add_picked(const struct gz_illustrate_scene *scene,
			 const struct gz_illustrate_hits *hits, double seen, struct gz_pick *pick)
{
	const uint32_t id = hits->ids[0];
	if (id < 1 || id > scene->id_count)
		return 0;
	const double opacity = (double)scene->opacities[id - 1];
	if (opacity > 0) {
		pick->ids[pick->count] = id;
		pick->depths[pick->count] = (double)hits->depth_mm[0] / scene->meshes.world_mm;
		pick->shares[pick->count++] = seen * opacity;
	}
	return seen * (1 - opacity);
}

_Static_assert(GZ_ILLUSTRATE_LAYERS_MAX <= GZ_PICKS_MAX, "a pick holds all layers");

enum gz_result gz_illustrate_caster_pick(struct gz_illustrate_caster *caster,
					 const struct gz_illustrate_shot *shot,
					 const struct gz_pick_request *request,
					 struct gz_pick *out_pick)
{
	const struct gz_illustrate_tile rays = {
		.x = (float)(request->x - 0.5),
		.y = (float)(request->y - 0.5),
		.columns = gz_tile_columns[GZ_TILE_SQUARE],
		.rows = gz_tile_rows,
		.active = 1,
	};
	const int layers = caster->scene.transparent ? GZ_ILLUSTRATE_LAYERS_MAX : 1;
	const struct gz_plan plan = { .layer_count = 1,
				      .view = { request->width, request->height, { 0, 0 } } };
	struct gz_illustrate_shot planned = *shot;
	struct gz_illustrate_cast cast;
	struct gz_illustrate_hits hits[GZ_ILLUSTRATE_LAYERS_MAX];
	struct gz_ray_frame camera;
	struct gz_pick pick = { 0 };
	double seen = 1;
	planned.plan = &plan;
	enum gz_result result =
		gz_camera_rays(request->camera, request->width, request->height, &camera);
	if (result == GZ_OK)
		result = gz_illustrate_scene_prepare(&caster->scene, &planned, caster->workers);
	if (result == GZ_OK)
		result = prepare_tree(caster);
	if (result == GZ_OK)
		result =
			gz_illustrate_frame_make(&caster->scene, &planned, &camera, &caster->frame);
	if (result != GZ_OK)
		return result;
	fill_illustrate_cast(caster, layers, &camera, &cast);
	caster->kernel->cast(&cast, &rays, hits);
	for (int layer = 0; layer < layers && seen > 0; layer++)
		seen = add_picked(&caster->scene, &hits[layer], seen, &pick);
	*out_pick = pick;
	return GZ_OK;
}

enum gz_result gz_illustrate_caster_print(const struct gz_illustrate_caster *caster,
					  const struct gz_print *print)
{
	return gz_illustrate_drawing_print(&caster->picture.drawing, print, caster->workers,
					   caster->log);
}

size_t gz_illustrate_caster_triangles(const struct gz_illustrate_caster *caster)
{
	return gz_surface_meshes_triangles(&caster->scene.meshes);
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
	gz_surface_tree_close(&self->tree);
	gz_illustrate_frame_free(&self->frame);
	gz_illustrate_picture_close(&self->picture);
	for (int layer = 0; layer < GZ_ILLUSTRATE_LAYERS_MAX; layer++)
		for (int i = 0; i < GZ_ILLUSTRATE_FOUND; i++)
			gz_lattices_free(&self->lattices[layer][i]);
	free(self);
	*caster = NULL;
}
