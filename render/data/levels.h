/**
 * @file
 * Levels of detail of a volume: halving its resolution, the pyramid of levels in memory (Levoy and
 * Whitaker, Gaze-directed volume rendering, 1990, who choose the level by the distance to the
 * gaze), and which level a ray takes. Both backends use these functions, so that they choose the
 * same level.
 *
 * Where data sit: voxel i of a halved axis is the mean of voxels 2i and 2i + 1, so its datum lies
 * between them, at 2i + 1 in the voxel coordinates of the full volume (voxel i spans [i, i + 1)).
 * Coordinates of the half are those of the full volume divided by two, without an offset. An axis
 * of n voxels becomes one of (n + 1) / 2. With n odd, the last voxel of the half stands for voxel n
 * - 1 alone, as if that voxel were repeated outside the box; the box of the half then extends one
 * full voxel beyond the volume's, so rays are clipped at the box of the full volume.
 */
#ifndef GZ_RENDER_DATA_LEVELS_H
#define GZ_RENDER_DATA_LEVELS_H

#include <stdbool.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/brick_file.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"

/**
 * Which axes to halve so that voxels tend to cubes: those of more than one voxel whose spacing is
 * below sqrt(2) times the least of such axes, which makes the ratio of any two spacings at most
 * sqrt(2), or smaller than it was.
 *
 * @param[out] out_axes  set to what is halved; all false for a single voxel
 */
void gz_halve_axes(const int dims[3], const double spacing[3], bool out_axes[3]);

/**
 * Make the half of @p volume.
 *
 * @param axes  which axes to halve; NULL for gz_halve_axes(). One of a single voxel stays as it is
 * @param[out] out_half  owned by the caller: gz_volume_free(). Type, slope and intercept are the
 * volume's; so are stored_min and stored_max, so that a transfer function means the same to both.
 * The spacing of halved axes is doubled
 * @retval GZ_ERR_INVAL   nothing to halve
 * @retval GZ_ERR_NO_MEM  no room
 *
 * One pass over the voxels, a pair of slices at a time. Threads: any; the same bits each time.
 */
enum gz_result gz_volume_halve(const struct gz_volume *volume, const bool axes[3],
			       struct gz_volume *out_half);

/** The first part of gz_volume_halve(): allocate, voxels not yet written. Its returns. */
enum gz_result gz_volume_halve_begin(const struct gz_volume *volume, const bool axes[3],
				     struct gz_volume *out_half);

/** The other part, for one slice of the half that gz_volume_halve_begin() made of @p volume: slices
 *  may be written by several threads at once. @p z is 0 to half->dims[2] - 1. */
void gz_volume_halve_slice(const struct gz_volume *volume, const struct gz_volume *half, int z);

/**
 * One slice of the half from one or two slices of the full volume, for data that are never in
 * memory as a whole.
 *
 * @param type     of both
 * @param dims     columns and rows of the full slices
 * @param halves   whether columns and rows are halved
 * @param lower, upper  the two slices, x varying fastest; the same one twice where the axis across
 * them is not halved or has no partner left
 * @param[out] out_slice  columns and rows of the half
 *
 * Whole numbers are rounded to the nearest, halves up.
 */
void gz_halve_slices(enum gz_voxel_type type, const int dims[2], const bool halves[2],
		     const void *lower, const void *upper, void *out_slice);

/** Most levels, the full volume counted in. Chosen: the last stands for 128 voxel lengths, more
 *  than GZ_SPACING_MAX pixels ever span on a picture that shows anything. */
#define GZ_LEVELS_MAX 8

/** One level. Voxel i spans [i, i + 1) of its own voxel coordinates, which are those of the full
 *  volume divided by factor. */
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
