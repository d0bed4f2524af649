#include "render/raycast/cpu/cpu_raycaster.h"

#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/workers.h"
#include "render/contrast/contrast.h"
#include "render/light/cube_pictures.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/cpu/faded_light.h"
#include "render/raycast/cpu/fine_cells.h"
#include "render/raycast/cpu/volume_shade.h"
#include "render/raycast/shared/brick_stream.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/lighting.h"
#include "render/raycast/shared/preintegration.h"
#include "render/raycast/shared/ray_content.h"
#include "render/reconstruct/cpu/kept_picture.h"
#include "render/reconstruct/cpu/kept_tiles.h"
#include "render/reconstruct/cpu/lattice.h"
#include "render/reconstruct/cpu/reconstruct.h"

#define GZ_LOG_MODULE "cpu"

/* Tiles that a thread takes at a time. Chosen: enough to hide the cost of the counter, few enough
 * that all threads finish together. */
enum { TILES_A_PART = 16 };

#ifdef GZ_CAST_X86
static bool runs_avx512(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
	       __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

static bool runs_avx2(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}
#endif

const struct gz_cast_kernels *gz_cast_kernels_find(const char *name)
{
	const bool any = !name || strcmp(name, "auto") == 0;
#ifdef GZ_CAST_X86
	if ((any || strcmp(name, gz_cast_avx512.name) == 0) && runs_avx512())
		return &gz_cast_avx512;
	if ((any || strcmp(name, gz_cast_avx2.name) == 0) && runs_avx2())
		return &gz_cast_avx2;
#endif
	if (any || strcmp(name, gz_cast_portable.name) == 0)
		return &gz_cast_portable;
	return NULL;
}

void gz_cast_fill_voxels(const struct gz_volume *volume, struct gz_cast *cast)
{
	const int *dims = volume->dims;
	const int32_t strides[3] = { 1, dims[0], dims[0] * dims[1] };
	cast->voxels = volume->voxels;
	cast->colours = volume->colours;
	for (int axis = 0; axis < 3; axis++) {
		cast->dims[axis] = (float)dims[axis];
		cast->last[axis] = dims[axis] > 1 ? dims[axis] - 2 : 0;
		/* One voxel along an axis has no neighbour. */
		cast->stride[axis] = axis == 0 || dims[axis] > 1 ? strides[axis] : 0;
	}
}

void gz_cast_fill_table(const struct gz_transfer_table *table, struct gz_cast *cast)
{
	cast->entry_scale = (float)table->scale;
	cast->entry_bias = (float)table->bias;
	cast->entry_last = (float)(table->count - 1);
	cast->preintegrated_shift = __builtin_ctz(GZ_PREINTEGRATED_STRIDE((unsigned)table->count));
	cast->fine_entries = table->count > GZ_TRANSFER_TABLE_SIZE;
	cast->extinction = table->entries;
	cast->visible_before = table->visible_before;
}

/* A worker's own counts, in a cache line of their own. */
struct cast_count {
	alignas(64) uint64_t samples;
	uint64_t kept_rays;
};

struct cpu_raycaster {
	struct gz_raycaster base;
	struct gz_workers *workers;
	const struct gz_cast_kernels *kernels;
	const struct gz_volume *volume; /* borrowed */
	struct gz_detail detail;
	struct gz_fine_cells fine[GZ_LEVELS_MAX]; /* of each level in memory */
	struct gz_brick_stream stream;            /* for a volume of bricks */
	size_t bricks_coming;                     /* after the last picture */
	bool wait_for_bricks;
	bool has_transfer;
	struct gz_transfer_table *table;
	/* step tables, each with as many entries as the table, and their lengths, voxel lengths; 0
	 * = no table yet */
	double step_length[GZ_PLAN_STEPS_MAX];
	struct gz_transfer_entry *step_tables;
	struct gz_preintegration preintegration;
	struct gz_faded_light light;
	struct gz_cube_pictures pictures; /* of the surroundings, if they are wanted */
	struct gz_volume_shade shade;     /* on others in the picture */
	struct gz_lattices lattices;
	struct gz_contrasts contrasts; /* of the tiles of a round */
	struct gz_ray_content content; /* of the last picture */
	struct gz_kept_tiles kept;
	struct gz_kept_picture kept_picture;
	struct cast_count counts[GZ_WORKERS_MAX];
	char description[64];
};

/* Pixels of a tile's rays from its corner. */
struct tile_offsets {
	float x[GZ_TILE_RAYS], y[GZ_TILE_RAYS];
};

/* What the workers of a frame share. */
struct cast_job {
	struct gz_cast casts[GZ_LEVELS_MAX]; /* of each level of detail */
	int cast_count;
	const struct gz_detail *detail;
	const struct gz_ray_params *rays;
	double pixel_lengths; /* from gz_levels_pixel_lengths(); 0 if all take the full volume */
	const struct gz_plan *plan;
	size_t first;                   /* tile of this round */
	const struct gz_ray_hits *hits; /* where rays end; NULL: nowhere */
	struct gz_lattices *lattices;
	struct gz_kept_tiles *kept; /* NULL: every ray is cast */
	gz_cast_tile_function *tile;
	struct cast_count *counts;
	struct tile_offsets offsets[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	int jitter; /* seed */
	bool lit;   /* surfaces */
};

static struct cpu_raycaster *cpu_of(struct gz_raycaster *raycaster)
{
	return (struct cpu_raycaster *)raycaster;
}

static void free_fine_cells(struct cpu_raycaster *cpu)
{
	for (int i = 0; i < GZ_LEVELS_MAX; i++)
		gz_fine_cells_free(&cpu->fine[i]);
}

static void cpu_destroy(struct gz_raycaster *raycaster)
{
	struct cpu_raycaster *cpu = cpu_of(raycaster);
	gz_workers_destroy(&cpu->workers);
	gz_detail_free(&cpu->detail);
	free_fine_cells(cpu);
	gz_brick_stream_free(&cpu->stream);
	gz_faded_light_free(&cpu->light);
	gz_cube_pictures_free(&cpu->pictures);
	gz_lattices_free(&cpu->lattices);
	gz_contrasts_free(&cpu->contrasts);
	gz_kept_tiles_free(&cpu->kept);
	gz_kept_picture_free(&cpu->kept_picture);
	free(cpu->step_tables);
	free(cpu->table);
	gz_preintegration_free(&cpu->preintegration);
	free(cpu);
}

enum gz_result gz_cpu_raycaster_check(const struct gz_backend_params *params,
				      const struct gz_log *log)
{
	if (gz_cast_kernels_find(params->simd))
		return GZ_OK;
	gz_err(log, "this processor does not run '%s': take auto, portable, avx2 or avx512",
	       params->simd);
	return GZ_ERR_UNSUPPORTED;
}

static enum gz_result start_workers(struct cpu_raycaster *cpu,
				    const struct gz_backend_params *params)
{
	enum gz_result result = gz_cpu_raycaster_check(params, cpu->base.log);
	if (result != GZ_OK)
		return result;
	cpu->kernels = gz_cast_kernels_find(params->simd);
	result = gz_workers_create(params->threads, &cpu->workers);
	if (result != GZ_OK) {
		gz_err(cpu->base.log, "cannot start %d threads: %s", params->threads,
		       gz_result_text(result));
		return result;
	}
	snprintf(cpu->description, sizeof cpu->description, "%s, %d threads", cpu->kernels->name,
		 gz_workers_count(cpu->workers));
	return GZ_OK;
}

static enum gz_result cpu_create(const struct gz_backend_params *params, const struct gz_log *log,
				 struct gz_raycaster **out_raycaster)
{
	/* The counters are aligned, so the struct is. */
	struct cpu_raycaster *cpu = aligned_alloc(alignof(struct cpu_raycaster), sizeof *cpu);
	if (!cpu)
		return GZ_ERR_NO_MEM;
	memset(cpu, 0, sizeof *cpu);
	cpu->base = (struct gz_raycaster) { .ops = &gz_cpu_raycaster_ops, .log = log };
	cpu->wait_for_bricks = params->wait_for_bricks;
	/* Room for the finest tables; the system gives memory to what is used of it. */
	cpu->table = calloc(1, sizeof *cpu->table);
	cpu->step_tables = calloc((size_t)GZ_PLAN_STEPS_MAX * GZ_TRANSFER_TABLE_MOST,
				  sizeof *cpu->step_tables);
	const enum gz_result result =
		cpu->table && cpu->step_tables ? start_workers(cpu, params) : GZ_ERR_NO_MEM;
	if (result != GZ_OK) {
		cpu_destroy(&cpu->base);
		return result;
	}
	*out_raycaster = &cpu->base;
	return GZ_OK;
}

static enum gz_result cpu_set_volume(struct gz_raycaster *raycaster, const struct gz_volume *volume)
{
	struct cpu_raycaster *cpu = cpu_of(raycaster);
	cpu->volume = NULL;
	cpu->has_transfer = false;
	gz_ray_content_forget(&cpu->content);
	gz_faded_light_forget(&cpu->light);
	gz_brick_stream_forget(&cpu->stream);
	/* Gathers take signed indices of 32 bits. */
	if (!volume->bricks && gz_volume_voxel_count(volume) > INT32_MAX) {
		gz_err(raycaster->log,
		       "a volume of %d x %d x %d voxels in memory is beyond the cpu backend's "
		       "2^31; "
		       "write it as bricks (gazeview --write-volume) and show these",
		       volume->dims[0], volume->dims[1], volume->dims[2]);
		return GZ_ERR_UNSUPPORTED;
	}
	enum gz_result result = gz_detail_start(&cpu->detail, volume);
	free_fine_cells(cpu);
	if (result == GZ_OK && !volume->bricks)
		result = gz_fine_cells_build(volume, cpu->workers, &cpu->fine[0]);
	if (result != GZ_OK) {
		gz_err(raycaster->log, "no memory for the macrocells of the volume");
		return result;
	}
	cpu->volume = volume;
	return GZ_OK;
}

static void classify_fine_cells(struct cpu_raycaster *cpu, int level)
{
	if (cpu->fine[level].least)
		gz_fine_cells_classify(&cpu->fine[level], &cpu->detail.cells[level], cpu->table,
				       cpu->workers);
}

/* Make the levels of detail for a frame that needs them. Without memory for fine cells the kernels
 * use macrocells. */
static void make_levels(struct cpu_raycaster *cpu)
{
	gz_detail_make_levels(&cpu->detail, cpu->workers, cpu->table, cpu->base.log);
	for (int i = 1; i < cpu->detail.levels.count && !cpu->volume->bricks; i++)
		if (!cpu->fine[i].least &&
		    gz_fine_cells_build(&cpu->detail.levels.level[i].volume, cpu->workers,
					&cpu->fine[i]) == GZ_OK)
			classify_fine_cells(cpu, i);
}

/* Find what shows something by the present table. */
static void classify_cells(struct cpu_raycaster *cpu)
{
	gz_detail_classify(&cpu->detail, cpu->table);
	for (int i = 0; i < cpu->detail.levels.count; i++)
		classify_fine_cells(cpu, i);
	gz_brick_stream_forget(&cpu->stream);
}

static enum gz_result cpu_set_transfer(struct gz_raycaster *raycaster,
				       const struct gz_transfer *transfer)
{
	struct cpu_raycaster *cpu = cpu_of(raycaster);
	if (!cpu->volume)
		return GZ_ERR_INVAL;
	gz_ray_content_forget(&cpu->content);
	const int entries = cpu->has_transfer ? cpu->table->count : 0;
	const bool same_but_emphasis = gz_faded_light_set_transfer(&cpu->light, transfer);
	gz_transfer_table_bake(transfer, cpu->volume, cpu->table);
	/* What shows something does so with any emphasis, in the same entries. */
	if (!same_but_emphasis || entries != cpu->table->count)
		classify_cells(cpu);
	memset(cpu->step_length, 0, sizeof cpu->step_length);
	gz_preintegration_forget(&cpu->preintegration);
	cpu->has_transfer = true;
	return GZ_OK;
}

/* Fill in a level of detail, in its own voxel coordinates. */
static void fill_cast_volume(const struct cpu_raycaster *cpu, int index,
			     const struct gz_clip_region *clip, struct gz_cast *cast)
{
	static const double corner[3] = { 0, 0, 0 };
	const struct gz_level *level = &cpu->detail.levels.level[index];
	const struct gz_macrocells *cells = &cpu->detail.cells[index];
	const int32_t cell_strides[3] = { 1, cells->dims[0], cells->dims[0] * cells->dims[1] };
	struct gz_clip_bounds bounds;
	double half[3], box[3];
	gz_volume_half_extent(cpu->volume, half);
	for (int axis = 0; axis < 3; axis++)
		box[axis] = (double)cpu->volume->dims[axis] / level->factor[axis];
	gz_clip_region_place(clip, cpu->volume, box, corner, &bounds);
	gz_cast_fill_voxels(&level->volume, cast);
	cast->reach = cells->reach;
	for (int i = 0; i < 4; i++)
		cast->clip_plane[i] = (float)bounds.plane[i];
	for (int axis = 0; axis < 3; axis++) {
		cast->box[axis] = (float)box[axis];
		cast->clip_least[axis] = (float)bounds.least[axis];
		cast->clip_greatest[axis] = (float)bounds.greatest[axis];
		cast->cell_last[axis] = (float)(cells->dims[axis] - 1);
		cast->cell_stride[axis] = cell_strides[axis];
		cast->world_per_voxel[axis] = (float)(2 * half[axis] / box[axis]);
	}
}

static void fill_cast_fine_cells(const struct gz_fine_cells *cells, struct gz_cast *cast)
{
	for (int i = 0; i < GZ_FINE_GRIDS; i++) {
		const struct gz_fine_grid *from = &cells->grid[i];
		struct gz_cast_grid *grid = &cast->fine[i];
		grid->flags = from->flags;
		grid->cells_per_voxel = 1.0F / (float)(GZ_FINE_EDGE << i);
		int32_t stride = 1;
		for (int axis = 0; axis < 3; axis++) {
			grid->last[axis] = (float)(from->dims[axis] - 1);
			grid->stride[axis] = stride;
			stride *= from->dims[axis];
		}
	}
}

static void fill_cast_rays(const struct cpu_raycaster *cpu, int index,
			   const struct gz_ray_frame *rays, struct gz_cast *cast)
{
	struct gz_voxel_rays level_rays;
	gz_voxel_rays_make(cpu->volume, cpu->detail.levels.level[index].factor, rays, &level_rays);
	const struct gz_ray_frame *frame = &level_rays.frame;
	for (int axis = 0; axis < 3; axis++) {
		cast->origin00[axis] = (float)frame->origin00[axis];
		cast->origin_dx[axis] = (float)frame->origin_dx[axis];
		cast->origin_dy[axis] = (float)frame->origin_dy[axis];
		cast->direction00[axis] = (float)frame->direction00[axis];
		cast->direction_dx[axis] = (float)frame->direction_dx[axis];
		cast->direction_dy[axis] = (float)frame->direction_dy[axis];
	}
}

static void fill_cast_transfer(struct cpu_raycaster *cpu, const struct gz_plan *plan,
			       const struct gz_ray_params *rays, struct gz_cast *cast)
{
	const struct gz_transfer_table *table = cpu->table;
	gz_cast_fill_table(table, cast);
	for (int i = 0; i < plan->step_count; i++) {
		const double length = plan->steps[i] / rays->ray_sampling_rate;
		struct gz_transfer_entry *entries =
			cpu->step_tables + (size_t)i * (size_t)table->count;
		if (cpu->step_length[i] != length) {
			gz_transfer_table_step(table, length, entries);
			cpu->step_length[i] = length;
		}
		cast->step_table[i] = entries;
		cast->voxel_lengths[i] = (float)length;
		cast->step[i] = (float)(length * gz_volume_voxel_length(cpu->volume));
	}
	cast->end_transmittance = gz_ray_end_transmittance(rays);
}

/* Fill in the pre-integrated tables, if the frame uses them. After fill_cast_transfer(). */
static enum gz_result fill_preintegration(struct cpu_raycaster *cpu, const struct gz_plan *plan,
					  const struct gz_ray_params *rays, struct gz_cast *cast)
{
	cast->preintegrated_extinction = NULL;
	if (rays->integration != GZ_INTEGRATION_PREINTEGRATED)
		return GZ_OK;
	struct gz_preintegration *preintegration = &cpu->preintegration;
	const enum gz_result result = gz_preintegration_make(
		preintegration, cpu->table, cpu->step_length, plan->step_count, cpu->workers);
	if (result != GZ_OK)
		return result;
	cast->preintegrated_extinction = preintegration->extinction;
	for (int i = 0; i < plan->step_count; i++)
		cast->preintegrated[i] = preintegration->step[i];
	return GZ_OK;
}

/* Find the pixels of a tile's rays from its corner. */
static void fill_tile_offsets(struct cast_job *job)
{
	for (int layer = 0; layer < job->plan->layer_count; layer++)
		for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++) {
			struct tile_offsets *offsets = &job->offsets[layer][pattern];
			const int spacing = job->plan->layers[layer].spacing;
			for (int i = 0; i < GZ_TILE_RAYS; i++) {
				offsets->x[i] = (float)(gz_tile_columns[pattern][i] * spacing);
				offsets->y[i] = (float)(gz_tile_rows[i] * spacing);
			}
		}
}

/* Let a tile's rays end where they meet something. */
static void fill_cast_hits(const struct cast_job *job, const struct gz_tile *tile,
			   struct gz_cast_tile *out_rays)
{
	const ptrdiff_t first = (tile - job->plan->tiles) * GZ_TILE_RAYS;
	out_rays->hit_depth = job->hits ? job->hits->depth + first : NULL;
	out_rays->hit_pixels = job->hits ? job->hits->pixels + first : NULL;
}

/* Fill in a tile's rays, in pixels of the picture that the camera frames. */
static void fill_cast_tile(const struct cast_job *job, const struct gz_tile *tile, uint32_t active,
			   struct gz_cast_tile *out_rays)
{
	const struct tile_offsets *offsets = &job->offsets[tile->layer][tile->pattern];
	const int x = tile->x - job->plan->view.shift[0], y = tile->y - job->plan->view.shift[1];
	out_rays->step = tile->step;
	out_rays->active = active;
	const float phase = gz_plan_interleaves(job->plan, tile->step, job->lit)
				    ? 1.0F / GZ_TILE_PHASE_COUNT
				    : 0;
	for (int i = 0; i < GZ_TILE_RAYS; i++) {
		out_rays->x[i] = (float)x + offsets->x[i];
		out_rays->y[i] = (float)y + offsets->y[i];
		out_rays->jitter[i] = phase * gz_tile_phases[tile->pattern][i];
	}
	for (int i = 0; job->jitter != 0 && i < GZ_TILE_RAYS; i++)
		out_rays->jitter[i] =
			gz_ray_jitter((int)out_rays->x[i], (int)out_rays->y[i], job->jitter);
}

/* The level of detail that a tile takes. */
static int tile_level(const void *user, const struct gz_tile *tile)
{
	const struct cast_job *job = user;
	return gz_detail_choose(job->detail, job->plan, job->rays, job->pixel_lengths, tile);
}

/* Point the cast of a level to the bricks in memory. */
static void fill_cast_bricks(const struct gz_brick_layout *layout, int level,
			     const struct gz_brick_view *view, struct gz_cast *cast)
{
	struct gz_brick_lookup lookup;
	gz_brick_lookup_make(layout, level, &lookup);
	cast->voxels = view->voxels;
	cast->bricks.table = view->table + lookup.first;
	memcpy(cast->bricks.stride, lookup.stride, sizeof lookup.stride);
	memcpy(cast->bricks.last, lookup.last, sizeof lookup.last);
	memcpy(cast->bricks.scale, lookup.scale, sizeof lookup.scale);
}

/* Use the bricks in memory, and ask for those that the picture lacks. */
static enum gz_result take_bricks(struct cpu_raycaster *cpu, const struct gz_camera *camera,
				  const struct gz_ray_params *rays, struct cast_job *job)
{
	const struct gz_brick_file *file = gz_brick_pool_file(cpu->volume->bricks);
	const struct gz_brick_stream_frame frame = {
		.detail = &cpu->detail,
		.layout = &file->layout,
		.entries = file->entries,
		.table = cpu->table,
		.plan = job->plan,
		.key = gz_brick_stream_key_of(camera, rays, job->plan, job->pixel_lengths),
		.tile_level = job->pixel_lengths > 0 ? tile_level : NULL,
		.user = job,
	};
	const enum gz_result result = gz_brick_stream_find(&cpu->stream, &frame);
	if (result != GZ_OK)
		return result;
	struct gz_brick_view view;
	gz_brick_pool_turn(cpu->volume->bricks, cpu->stream.wants.want, cpu->stream.wants.count,
			   cpu->wait_for_bricks, &view);
	cpu->bricks_coming = view.coming;
	for (int i = 0; i < job->cast_count; i++)
		fill_cast_bricks(&file->layout, cpu->detail.brick_level[i], &view, &job->casts[i]);
	return GZ_OK;
}

/* Cast a tile's rays. */
static void cast_rays(const struct cast_job *job, const struct gz_tile *tile, uint32_t active,
		      int worker, uint32_t pixels[GZ_TILE_RAYS])
{
	struct gz_cast_tile rays;
	fill_cast_tile(job, tile, active, &rays);
	fill_cast_hits(job, tile, &rays);
	job->counts[worker].samples += job->tile(&job->casts[tile_level(job, tile)], &rays, pixels);
}

/* Cast a tile's rays, or take those of an earlier picture. */
static void cast_tile(const struct cast_job *job, const struct gz_tile *tile, int worker)
{
	uint32_t own[GZ_TILE_RAYS], *pixels = own;
	bool known = false;
	if (job->kept)
		pixels = gz_kept_tiles_take(job->kept, job->plan, tile, &known);
	const uint32_t active = gz_plan_tile_active(job->plan, tile);
	if (known)
		job->counts[worker].kept_rays += (uint64_t)__builtin_popcount(active);
	else
		cast_rays(job, tile, active, worker, pixels);
	gz_lattices_store(job->lattices, job->plan, tile, active, pixels);
}

static void cast_part(void *user, size_t part, int worker)
{
	const struct cast_job *job = user;
	const size_t from = job->first + part * TILES_A_PART;
	const size_t to = from + TILES_A_PART < job->plan->tile_count ? from + TILES_A_PART
								      : job->plan->tile_count;
	for (size_t i = from; i < to; i++)
		cast_tile(job, &job->plan->tiles[i], worker);
}

static void cast_tiles(struct cpu_raycaster *cpu, struct cast_job *job)
{
	gz_workers_run(cpu->workers, cast_part, job,
		       (job->plan->tile_count - job->first + TILES_A_PART - 1) / TILES_A_PART);
}

static void sum_counts(const struct cpu_raycaster *cpu, struct gz_frame_stats *stats)
{
	for (int i = 0; i < gz_workers_count(cpu->workers); i++) {
		stats->samples += cpu->counts[i].samples;
		stats->kept_rays += cpu->counts[i].kept_rays;
	}
}

/* Refine the plan where the last round's rays differ, and cast the new tiles, round by round. */
static enum gz_result cast_further_rounds(struct cpu_raycaster *cpu, struct gz_plan *plan,
					  struct cast_job *job)
{
	for (int round = 1; round < gz_plan_rounds(plan); round++) {
		const enum gz_result result = gz_contrasts_plan_round(
			plan, &job->first, &cpu->lattices, cpu->workers, &cpu->contrasts);
		if (result != GZ_OK || job->first == plan->tile_count)
			return result;
		gz_lattices_unmark(&cpu->lattices, plan, job->first);
		cast_tiles(cpu, job);
	}
	return GZ_OK;
}

static enum gz_result fill_casts(struct cpu_raycaster *cpu, const struct gz_camera *camera,
				 const struct gz_ray_frame *ray_frame,
				 const struct gz_ray_params *rays, struct cast_job *job)
{
	const double pixel_lengths =
		gz_levels_pixel_lengths(cpu->volume, camera, job->plan->view.height);
	const bool coarser = gz_detail_wanted(cpu->volume, job->plan, rays, pixel_lengths);
	if (coarser)
		make_levels(cpu);
	job->detail = &cpu->detail;
	job->rays = rays;
	job->pixel_lengths = coarser ? pixel_lengths : 0;
	fill_cast_transfer(cpu, job->plan, rays, &job->casts[0]);
	const enum gz_result result = fill_preintegration(cpu, job->plan, rays, &job->casts[0]);
	if (result != GZ_OK) {
		gz_err(cpu->base.log, "no memory for pre-integrated tables: take sampled");
		return result;
	}
	job->cast_count = coarser ? cpu->detail.levels.count : 1;
	for (int i = 0; i < job->cast_count; i++) {
		job->casts[i] = job->casts[0];
		fill_cast_volume(cpu, i, &rays->clip, &job->casts[i]);
		fill_cast_fine_cells(&cpu->fine[i], &job->casts[i]);
		fill_cast_rays(cpu, i, ray_frame, &job->casts[i]);
		gz_lighting_fill(&cpu->light.shown.lighting, cpu->detail.levels.level[i].factor,
				 rays, ray_frame, &job->casts[i].light);
	}
	return GZ_OK;
}

/* What lies around the volume, after gz_lighting_fill(). */
static void surround_casts(const struct cpu_raycaster *cpu, const struct gz_ray_params *rays,
			   struct cast_job *job)
{
	struct gz_seen_surroundings around;
	gz_ray_params_surroundings(rays, cpu->volume, &cpu->pictures.cube,
				   job->casts[0].light.towards, 1, &around);
	for (int i = 0; i < job->cast_count; i++)
		job->casts[i].around = around;
}

/* Tell depths, if the shot wants them. */
static void deepen_casts(const struct gz_shot *shot, struct cast_job *job)
{
	if (!shot->depths)
		return;
	const double length = shot->depths->farthest - shot->depths->nearest;
	for (int i = 0; i < job->cast_count; i++) {
		job->casts[i].depth_scale = (float)(1 / length);
		job->casts[i].depth_bias = (float)(-shot->depths->nearest / length);
	}
}

/* Make the grid of shadows, if the frame has them. */
static enum gz_result light_casts(struct cpu_raycaster *cpu, const struct gz_shot *shot,
				  const struct gz_ray_frame *ray_frame, struct cast_job *job)
{
	const struct gz_ray_params *rays = shot->settings;
	if (rays->light.shadow_steps == 0)
		return GZ_OK;
	/* What coarser levels show, and segments from end to end, may lie where no voxel does. */
	const struct gz_light_grid_request request = {
		.arriving = cpu->kernels->arriving,
		.rays = rays,
		.ray_frame = ray_frame,
		.cells = &cpu->detail.cells[0],
		.everywhere =
			job->cast_count > 1 || rays->integration == GZ_INTEGRATION_PREINTEGRATED,
		.shades = shot->shades,
		.shade_count = shot->shade_count,
		.workers = cpu->workers,
		.log = cpu->base.log,
	};
	const struct gz_light_grid *grid = &cpu->light.shown.light_grid;
	const enum gz_result result = gz_faded_light_make_grid(&cpu->light, &request);
	if (result != GZ_OK)
		return result;
	for (int i = 0; i < job->cast_count; i++)
		gz_cast_cells_fill(grid->cells, grid->dims, grid->edge,
				   cpu->detail.levels.level[i].factor,
				   &job->casts[i].light.shadow.arriving);
	return GZ_OK;
}

/* The tiles of earlier pictures that this one may take; NULL: none. Bricks arrive, and what others
 * show may change, while the volume's own settings stay the same. */
static struct gz_kept_tiles *find_kept_tiles(struct cpu_raycaster *cpu, const struct gz_shot *shot,
					     const struct gz_ray_frame *ray_frame)
{
	if (!shot->keeps_rays || cpu->volume->bricks || shot->hits || shot->shade_count > 0) {
		gz_kept_tiles_free(&cpu->kept);
		gz_kept_picture_free(&cpu->kept_picture);
		return NULL;
	}
	const uint64_t content =
		gz_ray_content_follow(&cpu->content, shot->plan, shot->settings, ray_frame,
				      shot->depths, cpu->pictures.serial);
	return gz_kept_tiles_begin(&cpu->kept, shot->plan, content, 1) ? &cpu->kept : NULL;
}

/* Cast the picture's rays, in one round or several, and fill the pixels between them. */
static enum gz_result cast_picture(struct cpu_raycaster *cpu, const struct gz_shot *shot,
				   struct cast_job *job, struct gz_image *image,
				   double *out_reconstruct_ms)
{
	cast_tiles(cpu, job);
	if (shot->refined && shot->plan->refines) {
		const enum gz_result result = cast_further_rounds(cpu, shot->refined, job);
		if (result != GZ_OK)
			return result;
	}
	const int64_t start_ns = gz_clock_now_ns();
	gz_reconstruct(shot->plan, &cpu->lattices, gz_row_filters_find(cpu->kernels->name),
		       cpu->workers, gz_image_words(image));
	*out_reconstruct_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	if (job->kept)
		gz_kept_picture_store(&cpu->kept_picture, shot->plan, job->kept->content,
				      cpu->workers, image);
	return GZ_OK;
}

/* Show the whole picture that was made before, if this one is the same. */
static bool take_kept_picture(struct cpu_raycaster *cpu, const struct cast_job *job,
			      struct gz_image *image)
{
	if (!job->kept || !gz_kept_picture_take(&cpu->kept_picture, job->plan, job->kept->content,
						cpu->workers, image))
		return false;
	cpu->counts[0].kept_rays = job->plan->ray_count;
	return true;
}

static enum gz_result cpu_draw(struct gz_raycaster *raycaster, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct cpu_raycaster *cpu = cpu_of(raycaster);
	const struct gz_camera *camera = shot->camera;
	const struct gz_ray_params *rays = shot->settings;
	const struct gz_plan *plan = shot->plan;
	if (!cpu->volume || !cpu->has_transfer)
		return GZ_ERR_INVAL;
	struct gz_ray_frame ray_frame;
	enum gz_result result =
		gz_camera_rays(camera, plan->view.width, plan->view.height, &ray_frame);
	if (result == GZ_OK)
		result = gz_image_resize(image, plan->width, plan->height);
	if (result == GZ_OK)
		result = gz_lattices_prepare(&cpu->lattices, plan, gz_image_words(image));
	if (result != GZ_OK)
		return result;

	double prepare_ms = 0;
	result = gz_cube_pictures_prepare(&cpu->pictures, &rays->environment, raycaster->log,
					  &prepare_ms);
	if (result == GZ_OK)
		result = gz_faded_light_prepare(&cpu->light, cpu->volume, cpu->table, rays,
						cpu->workers, raycaster->log);
	if (result != GZ_OK)
		return result;
	prepare_ms += gz_lighting_take_spent_ms(&cpu->light.shown.lighting);
	const int64_t start_ns = gz_clock_now_ns();
	const bool nearest = gz_ray_samples_nearest(rays, cpu->volume);
	const bool rich = gz_ray_params_lit(rays) || shot->depths ||
			  rays->integration == GZ_INTEGRATION_PREINTEGRATED;
	const enum gz_cast_variant variant = cpu->volume->colours ? GZ_CAST_COLOURED
					     : rich               ? GZ_CAST_RICH
								  : GZ_CAST_PLAIN;
	struct cast_job job = {
		.plan = plan,
		.hits = shot->hits,
		.lattices = &cpu->lattices,
		.tile = cpu->kernels->tile[variant][cpu->volume->type][nearest],
		.counts = cpu->counts,
		.jitter = rays->jitter,
		.lit = gz_ray_params_lit(rays),
	};
	result = fill_casts(cpu, camera, &ray_frame, rays, &job);
	if (result == GZ_OK && cpu->volume->bricks)
		result = take_bricks(cpu, camera, rays, &job);
	if (result == GZ_OK)
		result = light_casts(cpu, shot, &ray_frame, &job);
	if (result != GZ_OK)
		return result;
	surround_casts(cpu, rays, &job);
	deepen_casts(shot, &job);
	fill_tile_offsets(&job);
	job.kept = find_kept_tiles(cpu, shot, &ray_frame);
	memset(cpu->counts, 0, sizeof cpu->counts);
	double reconstruct_ms = 0;
	if (!take_kept_picture(cpu, &job, image))
		result = cast_picture(cpu, shot, &job, image, &reconstruct_ms);
	if (result != GZ_OK)
		return result;
	if (out_stats) {
		*out_stats = (struct gz_frame_stats) {
			.rays = plan->ray_count,
			.keeps_rays = job.kept != NULL,
			.prepare_ms = prepare_ms,
			.prepare_within_ms = prepare_ms,
			.cast_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns) - reconstruct_ms,
			.reconstruct_ms = reconstruct_ms,
			.gpu_ms = NAN,
			.bricks_coming = cpu->volume->bricks ? cpu->bricks_coming : 0,
		};
		sum_counts(cpu, out_stats);
	}
	return GZ_OK;
}

static enum gz_result cpu_shade(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				struct gz_shade *out_shade)
{
	struct cpu_raycaster *cpu = cpu_of(raycaster);
	const struct gz_ray_params *rays = shot->settings;
	struct gz_ray_frame ray_frame;
	if (!cpu->volume || !cpu->has_transfer)
		return GZ_ERR_INVAL;
	enum gz_result result = gz_camera_rays(shot->camera, shot->plan->view.width,
					       shot->plan->view.height, &ray_frame);
	if (result == GZ_OK)
		result = gz_faded_light_prepare(&cpu->light, cpu->volume, cpu->table, rays,
						cpu->workers, raycaster->log);
	return result == GZ_OK ? gz_volume_shade_make(&cpu->light.shown.lighting,
						      cpu->kernels->arriving, rays, &ray_frame,
						      raycaster->log, &cpu->shade, out_shade)
			       : result;
}

static bool cpu_refines(const struct gz_raycaster *raycaster)
{
	return !((const struct cpu_raycaster *)raycaster)->volume->bricks;
}

static const char *cpu_describe(const struct gz_raycaster *raycaster)
{
	return ((const struct cpu_raycaster *)raycaster)->description;
}

const struct gz_raycaster_ops gz_cpu_raycaster_ops = {
	.name = "cpu",
	.create = cpu_create,
	.set_volume = cpu_set_volume,
	.set_transfer = cpu_set_transfer,
	.draw = cpu_draw,
	.shade = cpu_shade,
	.refines = cpu_refines,
	.describe = cpu_describe,
	.destroy = cpu_destroy,
};
