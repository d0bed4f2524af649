/**
 * @file
 * Levels of detail of a volume in memory: each half as fine as the one before (Levoy and Whitaker,
 * Gaze-directed volume rendering, 1990, who take the level from the distance to the gaze), and
 * which of them a ray takes. Both backends ask here, so that they take the same.
 */
#ifndef GZ_RENDER_DATA_LEVELS_H
#define GZ_RENDER_DATA_LEVELS_H

#include "base/result.h"
#include "base/workers.h"
#include "render/data/brick_layout.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"

/** Most levels, the full volume counted in. Chosen: the last stands for 128 voxel lengths, more
 *  than GZ_SPACING_MAX pixels ever span on a picture that shows anything. */
#define GZ_LEVELS_MAX 8

/** One level. Voxel i spans [i, i + 1) of its own voxel coordinates, which are those of the full
 *  volume divided by factor (render/data/halve.h). */
struct gz_level {
	struct gz_volume volume; /**< of level 0 the voxels are borrowed */
	int factor[3];           /**< voxels of the full volume along an edge of one of these */
	double scale;            /**< edge of a voxel, in voxel lengths of the full volume */
};

/** The levels, finest first. Zero-initialised holds none. */
struct gz_levels {
	int count;
	struct gz_level level[GZ_LEVELS_MAX];
};

/** Start anew with @p volume as the only level, borrowed until gz_levels_free(); frees an earlier
 *  pyramid. */
void gz_levels_start(struct gz_levels *levels, const struct gz_volume *volume);

/**
 * Make the coarser levels of a started pyramid, down to one without an edge of more than
 * GZ_MACROCELL_EDGE voxels or to GZ_LEVELS_MAX. Where voxels are far from cubes, one halving leaves
 * more than an eighth of them; such a result is not kept, so that all levels together never take
 * more than a seventh of the volume (and rounding up of odd sizes). Does nothing when already made.
 *
 * @param workers  who halve; NULL for the calling thread alone. The same bits for any number
 * @retval GZ_ERR_NO_MEM  no room; the full volume stays the only level
 */
enum gz_result gz_levels_build(struct gz_levels *levels, struct gz_workers *workers);

/**
 * Add a level that a file of bricks has, finest first, without voxels.
 *
 * @return false where gz_levels_build() would not keep it, or there are GZ_LEVELS_MAX
 */
bool gz_levels_add(struct gz_levels *levels, const struct gz_brick_level *brick_level);

/** Free the coarser levels and zero the struct. */
void gz_levels_free(struct gz_levels *levels);

/**
 * How far apart the rays of neighbouring pixels are where they reach the box: voxel lengths.
 * Perspective: at the box's point nearest to the eye, so that nowhere they lie closer; 0 for an eye
 * in the box.
 *
 * @param camera  valid, see gz_camera_rays()
 * @param height  of the picture, px
 */
double gz_levels_pixel_lengths(const struct gz_volume *volume, const struct gz_camera *camera,
			       int height);

/**
 * The level for rays @p across voxel lengths apart with samples @p along voxel lengths apart: the
 * coarsest whose voxels are, at most, sqrt(2) times the smaller of both (the nearest power of two).
 * Level 0 for samples and rays less than sqrt(2) voxel lengths apart: wherever the plan has a
 * spacing and a step of 1, a picture finer than the data is not changed by levels.
 */
int gz_levels_choose(const struct gz_levels *levels, double across, double along);

#endif
