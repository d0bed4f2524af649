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
	struct gz_macrocells cells[GZ_LEVELS_MAX]; /**< of each level there is */
	bool failed;                               /**< no memory for the coarser ones: said once */
	/** Which level of a file of bricks each one is; itself where the volume is in memory. */
	int brick_level[GZ_LEVELS_MAX];
};

/** Begin with a volume, borrowed, and its macrocells; frees what was. A volume of bricks has all
 * its levels at once, without voxels. GZ_ERR_NO_MEM: holds nothing. */
enum gz_result gz_detail_start(struct gz_detail *detail, const struct gz_volume *volume);

/** Classify the macrocells of all levels there are. */
void gz_detail_classify(struct gz_detail *detail, const struct gz_transfer_table *table);

/**
 * Make and classify the coarser levels unless they are there. Without memory for them the full
 * volume stays the only level, and @p log gets one line.
 *
 * @param table  NULL: gz_detail_classify() follows
 */
void gz_detail_make_levels(struct gz_detail *detail, struct gz_workers *workers,
			   const struct gz_transfer_table *table, const struct gz_log *log);

/**
 * Whether any tile of a plan may take a coarser level, as far as spacings and steps go.
 *
 * @param pixel_lengths  of gz_levels_pixel_lengths()
 */
bool gz_detail_wanted(const struct gz_plan *plan, const struct gz_ray_params *rays,
		      double pixel_lengths);

/**
 * The level that tiles of a kind take: gz_levels_choose() by how far their rays and samples lie
 * apart.
 *
 * @param layer, pattern, step  as in struct gz_tile
 * @param pixel_lengths         of gz_levels_pixel_lengths(); 0 for the full volume
 */
int gz_detail_choose(const struct gz_detail *detail, const struct gz_plan *plan,
		     const struct gz_ray_params *rays, double pixel_lengths, int layer, int pattern,
		     int step);

/**
 * How long steps may become before they show as bands where tiles of different steps meet: struct
 * gz_plan_request, steps_per_px. A step is no longer than 16 times (chosen) what its rays lie apart
 * where they reach the box; an eye in the box, to which shells of data are as wide as the picture,
 * has no longer steps at all. A power of two, so that a plan is not made anew for each camera; 1
 * while a voxel there spans less than some 16 pixels.
 *
 * @param height  of the rays' grid
 */
double gz_detail_steps_per_px(const struct gz_volume *volume, const struct gz_camera *camera,
			      const struct gz_ray_params *rays, int height);

/** Free and zero. */
void gz_detail_free(struct gz_detail *detail);

#endif
