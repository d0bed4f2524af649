#include "render/raycast/shared/detail.h"

#include <math.h>

#include "render/data/brick_pool.h"

#define GZ_LOG_MODULE "render"

/* Take those levels of a file of bricks that a volume in memory would have, each with its
 * macrocells. */
static enum gz_result start_bricks(struct gz_detail *detail, const struct gz_volume *volume)
{
	const struct gz_brick_file *file = gz_brick_pool_file(volume->bricks);
	struct gz_macrocells finer = { 0 }, cells = { 0 };
	enum gz_result result = gz_macrocells_of_bricks(file, &detail->cells[0]);
	gz_levels_start(&detail->levels, volume);
	for (int i = 1; i < file->layout.level_count && result == GZ_OK; i++) {
		const int before = detail->levels.count - 1;
		const bool follows = detail->brick_level[before] == i - 1;
		result = gz_macrocells_of_coarser_bricks(
			file, i, follows ? &detail->cells[before] : &finer, &cells);
		gz_macrocells_free(&finer);
		if (result == GZ_OK && gz_levels_add(&detail->levels, &file->layout.levels[i])) {
			detail->brick_level[detail->levels.count - 1] = i;
			detail->cells[detail->levels.count - 1] = cells;
		} else {
			finer = cells;
		}
		cells = (struct gz_macrocells) { 0 };
	}
	gz_macrocells_free(&finer);
	return result;
}

enum gz_result gz_detail_start(struct gz_detail *detail, const struct gz_volume *volume)
{
	gz_detail_free(detail);
	if (volume->bricks) {
		const enum gz_result started = start_bricks(detail, volume);
		if (started != GZ_OK)
			gz_detail_free(detail);
		return started;
	}
	const enum gz_result result = gz_macrocells_build(volume, &detail->cells[0]);
	if (result == GZ_OK)
		gz_levels_start(&detail->levels, volume);
	return result;
}

void gz_detail_classify(struct gz_detail *detail, const struct gz_transfer_table *table)
{
	for (int i = 0; i < detail->levels.count; i++)
		gz_macrocells_classify(&detail->cells[i], table);
}

static enum gz_result build_levels(struct gz_detail *detail, struct gz_workers *workers,
				   const struct gz_transfer_table *table)
{
	enum gz_result result = gz_levels_build(&detail->levels, workers);
	for (int i = 1; i < detail->levels.count && result == GZ_OK; i++) {
		detail->brick_level[i] = i;
		result = gz_macrocells_build(&detail->levels.level[i].volume, &detail->cells[i]);
		if (result == GZ_OK && table)
			gz_macrocells_classify(&detail->cells[i], table);
	}
	return result;
}

void gz_detail_make_levels(struct gz_detail *detail, struct gz_workers *workers,
			   const struct gz_transfer_table *table, const struct gz_log *log)
{
	if (detail->levels.count != 1 || detail->failed || detail->levels.level[0].volume.bricks)
		return;
	if (build_levels(detail, workers, table) == GZ_OK)
		return;
	gz_warn(log, "no memory for coarser levels of the volume: all rays take the full one");
	detail->failed = true;
	const struct gz_volume volume = detail->levels.level[0].volume;
	gz_levels_start(&detail->levels, &volume);
	for (int i = 1; i < GZ_LEVELS_MAX; i++)
		gz_macrocells_free(&detail->cells[i]);
}

/* Distance between neighbouring rays of a tile, px. */
static double pixels_apart(const struct gz_plan *plan, int layer, int pattern)
{
	return (pattern == GZ_TILE_QUINCUNX ? M_SQRT2 : 1) * plan->layers[layer].spacing;
}

bool gz_detail_wanted(const struct gz_volume *volume, const struct gz_plan *plan,
		      const struct gz_ray_params *rays, double pixel_lengths)
{
	double across = 0, along = 0;
	if (!rays->levels || gz_ray_samples_nearest(rays, volume))
		return false;
	for (int i = 0; i < plan->layer_count; i++)
		across = fmax(across, pixels_apart(plan, i, GZ_TILE_QUINCUNX) * pixel_lengths);
	for (int i = 0; i < plan->step_count; i++)
		along = fmax(along, (double)plan->steps[i] / rays->ray_sampling_rate);
	return fmin(across, along) >= M_SQRT2;
}

int gz_detail_choose(const struct gz_detail *detail, const struct gz_plan *plan,
		     const struct gz_ray_params *rays, double pixel_lengths,
		     const struct gz_tile *tile)
{
	return gz_levels_choose(&detail->levels,
				pixels_apart(plan, tile->layer, tile->pattern) * pixel_lengths,
				(double)plan->steps[tile->step] / rays->ray_sampling_rate);
}

double gz_detail_steps_per_px(const struct gz_volume *volume, const struct gz_camera *camera,
			      const struct gz_ray_params *rays, int height)
{
	enum { STEP_PIXELS = 16, LEAST_EXPONENT = -5 };
	const double share = STEP_PIXELS * gz_levels_pixel_lengths(volume, camera, height) *
			     rays->ray_sampling_rate;
	if (!(share >= ldexp(1, LEAST_EXPONENT)))
		return 0; /* no rung's step is longer then */
	return fmin(1, ldexp(1, ilogb(share)));
}

void gz_detail_free(struct gz_detail *detail)
{
	gz_levels_free(&detail->levels);
	for (int i = 0; i < GZ_LEVELS_MAX; i++)
		gz_macrocells_free(&detail->cells[i]);
	*detail = (struct gz_detail) { 0 };
}
