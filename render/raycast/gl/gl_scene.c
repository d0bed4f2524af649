#include "render/raycast/gl/gl_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <GL/glew.h>

#define GZ_LOG_MODULE "gl"

static void free_levels(struct gz_gl_scene *scene)
{
	for (int i = 0; i < GZ_LEVELS_MAX; i++)
		gz_gl_volume_free(&scene->levels[i]);
	scene->level_count = 0;
	gz_gl_bricks_free(&scene->bricks);
	scene->bricked = false;
}

/* Threads for work on the processor; NULL if there are none, then the caller does the work. */
struct gz_workers *gz_gl_scene_workers(struct gz_gl_scene *scene)
{
	if (!scene->workers && gz_workers_create(0, &scene->workers) != GZ_OK)
		scene->workers = NULL;
	return scene->workers;
}

/* Whether textures hold the macrocells; with bricks they must, too. */
static bool cells_fit(const struct gz_gl_scene *scene, const struct gz_gl_device *device)
{
	for (int axis = 0; axis < 3; axis++)
		if (scene->detail.cells[0].dims[axis] > device->texture_edge_max)
			return false;
	return true;
}

/* Show the volume by bricks, with all levels at once. */
static enum gz_result set_bricks(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				 const struct gz_log *log)
{
	gz_detail_make_levels(&scene->detail, gz_gl_scene_workers(scene), NULL, log);
	if (!cells_fit(scene, device)) {
		gz_err(log,
		       "the macrocells of a volume of %d x %d x %d voxels are beyond this OpenGL's "
		       "3D textures of %d; take --backend cpu",
		       scene->detail.levels.level[0].volume.dims[0],
		       scene->detail.levels.level[0].volume.dims[1],
		       scene->detail.levels.level[0].volume.dims[2], device->texture_edge_max);
		return GZ_ERR_UNSUPPORTED;
	}
	const enum gz_result result = gz_gl_bricks_open(&scene->bricks, device, &scene->detail);
	if (result != GZ_OK) {
		gz_err(log,
		       "no room on the graphics device for bricks of the volume: %s; take "
		       "--backend cpu",
		       gz_result_text(result));
		return result;
	}
	scene->bricked = true;
	scene->level_count = scene->detail.levels.count;
	for (int i = 0; i < scene->level_count; i++)
		gz_gl_volume_lend(&scene->levels[i], scene->bricks.atlas);
	return GZ_OK;
}

/* Log why a volume in memory is shown by bricks, and how many fit. */
static void log_bricked(const struct gz_gl_scene *scene, const struct gz_gl_device *device,
			const struct gz_volume *volume, enum gz_result why,
			const struct gz_log *log)
{
	if (why == GZ_ERR_UNSUPPORTED)
		gz_info(log,
			"%d x %d x %d voxels are beyond this OpenGL's 3D textures of %d: they are "
			"shown by bricks, %zu of %zu at once",
			volume->dims[0], volume->dims[1], volume->dims[2], device->volume_edge_max,
			scene->bricks.rooms.count, scene->bricks.source.layout->brick_count);
	else
		gz_info(log,
			"the graphics device has no room for the whole volume: it is shown by "
			"bricks, %zu of %zu at once",
			scene->bricks.rooms.count, scene->bricks.source.layout->brick_count);
}

enum gz_result gz_gl_scene_set_volume(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				      const struct gz_volume *volume, const struct gz_log *log)
{
	scene->volume = NULL;
	scene->has_transfer = false;
	gz_faded_light_forget(&scene->light);
	free_levels(scene);
	const enum gz_result whole = volume->bricks
					     ? GZ_ERR_UNSUPPORTED
					     : gz_gl_volume_load(&scene->levels[0], device, volume);
	if (whole == GZ_ERR_NO_DEVICE) {
		gz_err(log, "the context is lost");
		return whole;
	}
	if (whole != GZ_OK && volume->colours) {
		gz_err(log,
		       "a volume of colours of %d x %d x %d voxels is beyond the graphics device, "
		       "and bricks hold no colours; take --backend cpu",
		       volume->dims[0], volume->dims[1], volume->dims[2]);
		return whole;
	}
	enum gz_result result = gz_detail_start(&scene->detail, volume);
	if (result != GZ_OK) {
		gz_err(log, "no memory for the macrocells of the volume");
		return result;
	}
	scene->level_count = 1;
	if (whole != GZ_OK)
		result = set_bricks(scene, device, log);
	if (result == GZ_OK && whole != GZ_OK && !volume->bricks)
		log_bricked(scene, device, volume, whole, log);
	if (result == GZ_OK)
		scene->volume = volume;
	return result;
}

/* Find what shows something by the present table. */
static void classify_cells(struct gz_gl_scene *scene)
{
	gz_detail_classify(&scene->detail, scene->table);
	for (int i = 0; i < scene->level_count; i++)
		gz_gl_volume_classify(&scene->levels[i], &scene->detail.cells[i]);
	gz_gl_bricks_forget(&scene->bricks);
}

enum gz_result gz_gl_scene_set_transfer(struct gz_gl_scene *scene,
					const struct gz_transfer *transfer)
{
	if (!scene->table)
		scene->table = calloc(1, sizeof *scene->table);
	if (!scene->table)
		return GZ_ERR_NO_MEM;
	const int entries = scene->has_transfer ? scene->table->count : 0;
	const bool same_but_emphasis = gz_faded_light_set_transfer(&scene->light, transfer);
	gz_transfer_table_bake(transfer, scene->volume, scene->table);
	/* What shows something does so with any emphasis, in the same entries. */
	if (!same_but_emphasis || entries != scene->table->count)
		classify_cells(scene);
	gz_preintegration_forget(&scene->preintegration);
	gz_gl_tables_forget(&scene->tables);
	scene->has_transfer = true;
	return GZ_OK;
}

static enum gz_result prepare_tables(struct gz_gl_scene *scene, const struct gz_ray_params *rays,
				     const struct gz_plan *plan, const struct gz_log *log)
{
	double lengths[GZ_PLAN_STEPS_MAX];
	enum gz_result result =
		gz_gl_tables_samples(&scene->tables, scene->table, GZ_PLAN_STEPS_MAX, 1);
	for (int i = 0; i < plan->step_count && result == GZ_OK; i++) {
		lengths[i] = plan->steps[i] / rays->ray_sampling_rate;
		result = gz_gl_tables_samples(&scene->tables, scene->table, i, lengths[i]);
	}
	if (result != GZ_OK) {
		gz_err(log, "no memory for tables of the transfer function");
		return result;
	}
	if (rays->integration != GZ_INTEGRATION_PREINTEGRATED)
		return GZ_OK;
	struct gz_preintegration *preintegration = &scene->preintegration;
	result = gz_gl_tables_samples(&scene->tables, scene->table, GZ_GL_NEXT_VISIBLE_ROW, 1);
	if (result == GZ_OK)
		result = gz_preintegration_make(preintegration, scene->table, lengths,
						plan->step_count, gz_gl_scene_workers(scene));
	if (result != GZ_OK) {
		gz_err(log, "no memory for pre-integrated tables: take sampled");
		return result;
	}
	for (int i = 0; i < plan->step_count; i++)
		gz_gl_tables_segments(&scene->tables, i, lengths[i], preintegration->step[i]);
	gz_gl_tables_segments(&scene->tables, GZ_PLAN_STEPS_MAX, 1, preintegration->extinction);
	return GZ_OK;
}

/* Upload a grid of cells. */
static enum gz_result load_grid(struct gz_gl_grid *grid, const struct gz_gl_device *device,
				const int dims[3], const uint16_t *cells, const struct gz_log *log)
{
	for (int axis = 0; axis < 3; axis++)
		if (dims[axis] > device->texture_edge_max) {
			gz_err(log,
			       "light in %d x %d x %d cells is beyond this OpenGL's 3D textures of "
			       "%d: set light.occlusion and light.shadow_steps to 0, or take "
			       "--backend cpu",
			       dims[0], dims[1], dims[2], device->texture_edge_max);
			return GZ_ERR_UNSUPPORTED;
		}
	if (!grid->texture || memcmp(grid->dims, dims, sizeof grid->dims) != 0) {
		if (grid->texture)
			glDeleteTextures(1, &grid->texture);
		grid->texture = gz_gl_texture(GL_TEXTURE_3D);
		glTexStorage3D(GL_TEXTURE_3D, 1, GL_R16UI, dims[0], dims[1], dims[2]);
		memcpy(grid->dims, dims, sizeof grid->dims);
	}
	glBindTexture(GL_TEXTURE_3D, grid->texture);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, dims[0], dims[1], dims[2], GL_RED_INTEGER,
			GL_UNSIGNED_SHORT, cells);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glBindTexture(GL_TEXTURE_3D, 0);
	return GZ_OK;
}

/* Make the grid of shadows, and upload it if it is new. */
static enum gz_result prepare_shadows(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				      const struct gz_gl_frame *frame, bool coarser,
				      const struct gz_log *log)
{
	const struct gz_ray_params *rays = frame->rays;
	const struct gz_light_grid_request request = {
		.arriving = gz_cast_kernels_find(NULL)->arriving,
		.rays = rays,
		.ray_frame = frame->world,
		.cells = &scene->detail.cells[0],
		/* Coarser levels and bricks, and segments from end to end, may show something
		 * where no voxel does. */
		.everywhere = coarser || scene->bricked ||
			      rays->integration == GZ_INTEGRATION_PREINTEGRATED,
		.shades = frame->shades,
		.shade_count = frame->shade_count,
		.workers = gz_gl_scene_workers(scene),
		.log = log,
	};
	const struct gz_light_grid *grid = &scene->light.shown.light_grid;
	enum gz_result result = gz_faded_light_make_grid(&scene->light, &request);
	if (result != GZ_OK || scene->arriving_serial == grid->serial)
		return result;
	result = load_grid(&scene->arriving, device, grid->dims, grid->cells, log);
	if (result == GZ_OK)
		scene->arriving_serial = grid->serial;
	return result;
}

static enum gz_result prepare_light(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				    const struct gz_gl_frame *frame, bool coarser,
				    const struct gz_log *log)
{
	const struct gz_lighting *lighting = &scene->light.shown.lighting;
	enum gz_result result =
		gz_faded_light_prepare(&scene->light, scene->volume, scene->table, frame->rays,
				       gz_gl_scene_workers(scene), log);
	if (result == GZ_OK && lighting->current && scene->occlusion_serial != lighting->serial) {
		result = load_grid(&scene->occlusion, device, lighting->occlusion.dims,
				   lighting->occlusion.cells, log);
		if (result == GZ_OK)
			scene->occlusion_serial = lighting->serial;
	}
	if (result == GZ_OK && frame->rays->light.shadow_steps > 0)
		result = prepare_shadows(scene, device, frame, coarser, log);
	return result;
}

/* Read and upload the pictures of the surroundings. */
static enum gz_result prepare_pictures(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				       const struct gz_ray_params *rays, const struct gz_log *log)
{
	const enum gz_result result = gz_cube_pictures_prepare(&scene->pictures, &rays->environment,
							       log, &scene->prepare_ms);
	return result == GZ_OK ? gz_gl_cube_bind(&scene->cube, device, &scene->pictures,
						 GZ_GL_UNIT_CUBE, log)
			       : result;
}

enum gz_result gz_gl_scene_shade(struct gz_gl_scene *scene, const struct gz_ray_params *rays,
				 const struct gz_ray_frame *world, const struct gz_log *log,
				 struct gz_shade *out_shade)
{
	const enum gz_result result = gz_faded_light_prepare(
		&scene->light, scene->volume, scene->table, rays, gz_gl_scene_workers(scene), log);
	return result == GZ_OK ? gz_volume_shade_make(&scene->light.shown.lighting,
						      gz_cast_kernels_find(NULL)->arriving, rays,
						      world, log, &scene->shade, out_shade)
			       : result;
}

/* Make and upload the coarser levels, unless the device has them. */
static void prepare_levels(struct gz_gl_scene *scene, const struct gz_gl_device *device,
			   const struct gz_log *log)
{
	if (scene->level_count > 1 || scene->detail.failed || scene->bricked)
		return;
	gz_detail_make_levels(&scene->detail, gz_gl_scene_workers(scene), scene->table, log);
	const int count = scene->detail.levels.count;
	for (int i = 1; i < count; i++) {
		if (gz_gl_volume_load(&scene->levels[i], device,
				      &scene->detail.levels.level[i].volume) != GZ_OK) {
			gz_warn(log,
				"no room on the graphics device for coarser levels of the volume: "
				"rays take the finest %d alone",
				i);
			scene->detail.failed = true; /* logged once */
			return;
		}
		gz_gl_volume_classify(&scene->levels[i], &scene->detail.cells[i]);
		scene->level_count = i + 1;
	}
}

/* Choose the level of each kind of tile. */
static void choose_levels(const struct gz_gl_scene *scene, const struct gz_plan *plan,
			  const struct gz_ray_params *rays, double pixel_lengths,
			  struct gz_gl_tile_levels *out_levels)
{
	for (int layer = 0; layer < plan->layer_count; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++)
			for (int step = 0; step < plan->step_count; step++) {
				const struct gz_tile tile = {
					.layer = (uint8_t)layer,
					.pattern = (uint8_t)pattern,
					.step = (uint8_t)step,
				};
				const int level = gz_detail_choose(&scene->detail, plan, rays,
								   pixel_lengths, &tile);
				out_levels->of[layer][pattern][step] =
					(uint8_t)(level < scene->level_count
							  ? level
							  : scene->level_count - 1);
			}
}

static int brick_tile_level(const void *user, const struct gz_tile *tile)
{
	const struct gz_gl_tile_levels *levels = user;
	return levels->of[tile->layer][tile->pattern][tile->step];
}

/* Upload the bricks of a frame. pixel_lengths is 0 and levels NULL if all tiles take the finest. */
static enum gz_result prepare_bricks(struct gz_gl_scene *scene, const struct gz_gl_frame *frame,
				     double pixel_lengths, const struct gz_gl_tile_levels *levels,
				     const struct gz_log *log)
{
	const struct gz_brick_stream_frame wanted = {
		.detail = &scene->detail,
		.table = scene->table,
		.plan = frame->plan,
		.key = gz_brick_stream_key_of(frame->camera, frame->rays, frame->plan,
					      pixel_lengths),
		.tile_level = levels ? brick_tile_level : NULL,
		.user = levels,
	};
	const enum gz_result result = gz_gl_bricks_turn(&scene->bricks, wanted, frame->wait);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "no memory for the list of bricks that the picture shows");
	return result;
}

enum gz_result gz_gl_scene_prepare(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				   const struct gz_gl_frame *frame,
				   struct gz_gl_tile_levels *out_levels, const struct gz_log *log)
{
	const struct gz_plan *plan = frame->plan;
	const double pixel_lengths =
		gz_levels_pixel_lengths(scene->volume, frame->camera, plan->view.height);
	memset(out_levels, 0, sizeof *out_levels);
	const bool coarser = gz_detail_wanted(scene->volume, plan, frame->rays, pixel_lengths);
	if (coarser) {
		prepare_levels(scene, device, log);
		choose_levels(scene, plan, frame->rays, pixel_lengths, out_levels);
	}
	enum gz_result result = prepare_light(scene, device, frame, coarser, log);
	scene->prepare_ms = gz_lighting_take_spent_ms(&scene->light.shown.lighting);
	if (result == GZ_OK)
		result = prepare_pictures(scene, device, frame->rays, log);
	if (result == GZ_OK)
		result = prepare_tables(scene, frame->rays, plan, log);
	if (result == GZ_OK && scene->bricked)
		result = prepare_bricks(scene, frame, coarser ? pixel_lengths : 0,
					coarser ? out_levels : NULL, log);
	return result;
}

static void vector_to_floats(const double source[3], float out[4])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = (float)source[axis];
}

static void fill_block_rays(const struct gz_gl_scene *scene, const int factor[3],
			    const struct gz_ray_frame *world, struct gz_gl_cast_block *block)
{
	struct gz_voxel_rays rays;
	gz_voxel_rays_make(scene->volume, factor, world, &rays);
	vector_to_floats(rays.frame.origin00, block->origin00);
	vector_to_floats(rays.frame.origin_dx, block->origin_dx);
	vector_to_floats(rays.frame.origin_dy, block->origin_dy);
	vector_to_floats(rays.frame.direction00, block->direction00);
	vector_to_floats(rays.frame.direction_dx, block->direction_dx);
	vector_to_floats(rays.frame.direction_dy, block->direction_dy);
	for (int axis = 0; axis < 3; axis++)
		block->world_per_voxel[axis] = (float)(rays.world_per_voxel[axis] * factor[axis]);
}

static void fill_block_volume(const struct gz_gl_scene *scene, int index,
			      const struct gz_clip_region *clip, struct gz_gl_cast_block *block)
{
	static const double corner[3] = { 0, 0, 0 };
	const struct gz_level *level = &scene->detail.levels.level[index];
	struct gz_clip_bounds bounds;
	double box[3];
	for (int axis = 0; axis < 3; axis++)
		box[axis] = (double)scene->volume->dims[axis] / level->factor[axis];
	gz_clip_region_place(clip, scene->volume, box, corner, &bounds);
	for (int i = 0; i < 4; i++)
		block->clip_plane[i] = (float)bounds.plane[i];
	for (int axis = 0; axis < 3; axis++) {
		const int dim = level->volume.dims[axis];
		block->dims[axis] = (float)dim;
		block->box[axis] = (float)box[axis];
		block->clip_least[axis] = (float)bounds.least[axis];
		block->clip_greatest[axis] = (float)bounds.greatest[axis];
		block->cell_counts[axis] = (float)scene->detail.cells[index].dims[axis];
	}
}

static void fill_block_surroundings(const struct gz_gl_scene *scene,
				    const struct gz_ray_params *rays, const float towards[3],
				    struct gz_gl_cast_block *block)
{
	struct gz_seen_surroundings around;
	gz_ray_params_surroundings(rays, scene->volume, &scene->pictures.cube, towards, 1, &around);
	gz_gl_surroundings_fill(&around, &block->around);
}

/* From places counted from the first datum to those in a grid of cells. */
static void fill_block_grid(const struct gz_cast_cells *cells, float scale[4], float bias[4],
			    float last[4])
{
	for (int axis = 0; axis < 3; axis++) {
		scale[axis] = cells->scale[axis];
		bias[axis] = cells->bias[axis];
		last[axis] = cells->greatest[axis];
	}
}

static void fill_block_light(const struct gz_gl_scene *scene, const int factor[3],
			     const struct gz_ray_frame *world, const struct gz_ray_params *rays,
			     struct gz_gl_cast_block *block)
{
	const struct gz_light_grid *grid = &scene->light.shown.light_grid;
	struct gz_cast_light light;
	gz_lighting_fill(&scene->light.shown.lighting, factor, rays, world, &light);
	if (rays->light.shadow_steps > 0)
		gz_cast_cells_fill(grid->cells, grid->dims, grid->edge, factor,
				   &light.shadow.arriving);
	fill_block_grid(&light.occluded, block->occlusion_scale, block->occlusion_bias,
			block->occlusion_last);
	fill_block_grid(&light.shadow.arriving, block->arriving_scale, block->arriving_bias,
			block->arriving_last);
	for (int axis = 0; axis < 3; axis++) {
		block->light_towards[axis] = light.towards[axis];
		block->gradient_scale[axis] = light.gradient_scale[axis];
	}
	block->light_towards[3] = light.occluded.cells ? light.occlusion : 0;
	block->light_terms[0] = light.ambient;
	block->light_terms[1] = light.diffuse;
	block->light_terms[2] = light.specular;
	block->light_terms[3] = light.shininess;
	block->gradient_scale[3] = light.reflection;
	fill_block_surroundings(scene, rays, light.towards, block);
}

void gz_gl_scene_bind(const struct gz_gl_scene *scene)
{
	gz_gl_tables_bind(&scene->tables);
	if (scene->bricked)
		gz_gl_bricks_bind(&scene->bricks);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_OCCLUSION);
	glBindTexture(GL_TEXTURE_3D, scene->occlusion.texture);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_CUBE);
	glBindTexture(GL_TEXTURE_2D_ARRAY, scene->cube.texture);
	glActiveTexture(GL_TEXTURE0 + GZ_GL_UNIT_ARRIVING);
	glBindTexture(GL_TEXTURE_3D, scene->arriving.texture);
	glActiveTexture(GL_TEXTURE0);
}

void gz_gl_scene_fill(const struct gz_gl_scene *scene, int level, const struct gz_gl_frame *frame,
		      struct gz_gl_cast_block *block)
{
	const struct gz_ray_frame *world = frame->world;
	const struct gz_ray_params *rays = frame->rays;
	const struct gz_plan *plan = frame->plan;
	const double voxel_length = gz_volume_voxel_length(scene->volume);
	fill_block_rays(scene, scene->detail.levels.level[level].factor, world, block);
	fill_block_volume(scene, level, &rays->clip, block);
	fill_block_light(scene, scene->detail.levels.level[level].factor, world, rays, block);
	if (scene->bricked)
		gz_gl_bricks_fill(&scene->bricks, scene->detail.brick_level[level], block);
	block->world_per_voxel[3] = (float)frame->near;
	block->jitter[0] = (uint32_t)rays->jitter;
	block->jitter[1] = (uint32_t)plan->view.shift[0];
	block->jitter[2] = (uint32_t)plan->view.shift[1];
	const int last = scene->table->count - 1;
	block->transfer[0] = (float)(scene->table->scale / last);
	block->transfer[1] = (float)(scene->table->bias / last);
	block->transfer[2] = gz_ray_end_transmittance(rays);
	block->transfer[3] = (float)last;
	if (frame->depths) {
		const double range = frame->depths->farthest - frame->depths->nearest;
		block->depths[0] = (float)(1 / range);
		block->depths[1] = (float)(-frame->depths->nearest / range);
	}
	for (int i = 0; i < plan->step_count; i++) {
		const double length = plan->steps[i] / rays->ray_sampling_rate;
		block->steps[i][0] = (float)(length * voxel_length);
		block->steps[i][1] = (float)length;
		block->steps[i][2] = gz_plan_interleaves(plan, i, gz_ray_params_lit(rays))
					     ? 1.0F / GZ_TILE_PHASE_COUNT
					     : 0;
	}
}

void gz_gl_scene_forget(struct gz_gl_scene *scene)
{
	gz_gl_bricks_abandon(&scene->bricks);
	gz_detail_free(&scene->detail);
	gz_preintegration_free(&scene->preintegration);
	gz_faded_light_free(&scene->light);
	gz_cube_pictures_free(&scene->pictures);
	gz_workers_destroy(&scene->workers);
	free(scene->table);
	*scene = (struct gz_gl_scene) { 0 };
}

void gz_gl_scene_free(struct gz_gl_scene *scene)
{
	free_levels(scene);
	gz_gl_tables_free(&scene->tables);
	gz_gl_cube_free(&scene->cube);
	if (scene->occlusion.texture)
		glDeleteTextures(1, &scene->occlusion.texture);
	if (scene->arriving.texture)
		glDeleteTextures(1, &scene->arriving.texture);
	gz_gl_scene_forget(scene);
}
