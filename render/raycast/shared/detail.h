/**
 * @file
 * The levels of detail of a backend: the pyramid of volumes with the macrocells of each.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_DETAIL_H
#define GZ_RENDER_RAYCAST_SHARED_DETAIL_H

#include "base/log.h"
#include "render/data/levels.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/macrocells.h"
#include "render/raycast/shared/ray_params.h"

/** Zero-initialised holds nothing. Coarser levels are made when a frame first asks for one. */
struct gz_detail {
	struct gz_levels levels;
	struct gz_macrocells cells[GZ_LEVELS_MAX]; /**< of each level */
	bool failed;                               /**< no memory for coarser levels; logged once */
	/** The level of the file of bricks that each one is; for a volume in memory the level
	 * itself. */
	int brick_level[GZ_LEVELS_MAX];
};

/** Begin with @p volume, which is borrowed, and build its macrocells; frees the earlier content. A
 *  volume of bricks has all its levels at once, without voxels. GZ_ERR_NO_MEM: holds nothing. */
enum gz_result gz_detail_start(struct gz_detail *detail, const struct gz_volume *volume);

/** Classify the macrocells of all levels that exist. */
void gz_detail_classify(struct gz_detail *detail, const struct gz_transfer_table *table);

/**
 * Make and classify the coarser levels unless they exist. Without memory for them the full volume
 * stays the only level, which is logged once.
 *
 * @param table  NULL if gz_detail_classify() follows
 */
void gz_detail_make_levels(struct gz_detail *detail, struct gz_workers *workers,
			   const struct gz_transfer_table *table, const struct gz_log *log);

/**
 * Whether spacings and steps of a plan allow any tile to take a coarser level of a volume.
 *
 * @param pixel_lengths  from gz_levels_pixel_lengths()
 */
bool gz_detail_wanted(const struct gz_volume *volume, const struct gz_plan *plan,
		      const struct gz_ray_params *rays, double pixel_lengths);

/**
 * The level that a tile takes: gz_levels_choose() for the distances between its rays and between
 * its samples.
 *
 * @param pixel_lengths  from gz_levels_pixel_lengths(); 0 for the full volume
 * @param tile           only layer, pattern and step are read
 */
int gz_detail_choose(const struct gz_detail *detail, const struct gz_plan *plan,
		     const struct gz_ray_params *rays, double pixel_lengths,
		     const struct gz_tile *tile);

/**
 * The limit on step lengths beyond which bands show where tiles of different steps meet:
 * steps_per_px of struct gz_plan_request. A step is at most 16 times (chosen) as long as the
 * distance between its rays where they reach the box. For an eye within the box, to which shells of
 * data are as wide as the picture, the limit is 0: no longer steps.
 *
 * @param height  rows of the grid of rays
 * @return a power of two, so that a moving camera seldom changes the plan; 1 while a voxel spans
 * less than about 16 pixels there
 */
double gz_detail_steps_per_px(const struct gz_volume *volume, const struct gz_camera *camera,
			      const struct gz_ray_params *rays, int height);

/** Free and zero. */
void gz_detail_free(struct gz_detail *detail);

#endif
