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
 * Choose the axes to halve, so that voxels become more cubic: axes of more than one voxel whose
 * spacing is below sqrt(2) times the least spacing of such axes. The ratio of any two spacings is
 * then at most sqrt(2), or smaller than before.
 *
 * @param[out] out_axes  true for an axis to halve; all false for a single voxel
 */
void gz_halve_axes(const int dims[3], const double spacing[3], bool out_axes[3]);

/**
 * Make the half of @p volume.
 *
 * @param axes  the axes to halve; NULL for those of gz_halve_axes(). An axis of one voxel stays
 * @param[out] out_half  owned by the caller: gz_volume_free(). Colours are means by their weights
 * (gz_colour_mean()). Type, slope, intercept, stored_min
 * and stored_max are the volume's, so that a transfer function means the same for both. The spacing
 * of halved axes is doubled
 * @retval GZ_ERR_INVAL   no axis can be halved; not logged
 * @retval GZ_ERR_NO_MEM  not logged
 *
 * One pass over the voxels, a pair of slices at a time. The same bits each time.
 */
enum gz_result gz_volume_halve(const struct gz_volume *volume, const bool axes[3],
			       struct gz_volume *out_half);

/** The first part of gz_volume_halve(), with its results: allocate the half, whose voxels are not
 *  written yet. */
enum gz_result gz_volume_halve_begin(const struct gz_volume *volume, const bool axes[3],
				     struct gz_volume *out_half);

/** The second part: write slice @p z, 0 to half->dims[2] - 1, of the half that
 *  gz_volume_halve_begin() made of @p volume. Threads: any, for different slices. */
void gz_volume_halve_slice(const struct gz_volume *volume, const struct gz_volume *half, int z);

/**
 * Make one slice of the half from one or two slices of the full volume.
 *
 * @param type     of both
 * @param dims     columns and rows of the full slices
 * @param halves   whether columns and rows are halved
 * @param lower, upper  the two slices, x varying fastest; the same slice twice if the axis across
 * them is not halved, or if the last slice has no partner
 * @param[out] out_slice  columns and rows of the half
 *
 * Integers are rounded to the nearest, halves up.
 */
void gz_halve_slices(enum gz_voxel_type type, const int dims[2], const bool halves[2],
		     const void *lower, const void *upper, void *out_slice);

/** Most levels, including the full volume. Chosen: a voxel of the last is 128 voxel lengths wide,
 *  more than GZ_SPACING_MAX pixels span on any useful picture. */
#define GZ_LEVELS_MAX 8

/** One level. Its voxel coordinates are those of the full volume divided by factor. */
struct gz_level {
	struct gz_volume volume; /**< level 0 borrows its voxels */
	int factor[3];           /**< voxels of the full volume along an edge of one of these */
	double scale;            /**< edge of a voxel, in voxel lengths of the full volume */
};

/** A pyramid of levels, finest first. Zero-initialised is empty. */
struct gz_levels {
	int count;
	struct gz_level level[GZ_LEVELS_MAX];
};

/** Make a pyramid with @p volume as its only level, borrowed until gz_levels_free(). Frees what
 *  @p levels held before. */
void gz_levels_start(struct gz_levels *levels, const struct gz_volume *volume);

/**
 * Make the coarser levels, until no edge is longer than 8 voxels or there are GZ_LEVELS_MAX. If
 * voxels are far from cubic, one halving leaves more than an eighth of them; such a level is not
 * kept, so that all coarser levels together take at most a seventh of the volume (plus rounding of
 * odd sizes). Does nothing if they are already made.
 *
 * @param workers  share the work; NULL for the calling thread alone. The same bits for any number
 * @retval GZ_ERR_NO_MEM  the full volume stays the only level; not logged
 */
enum gz_result gz_levels_build(struct gz_levels *levels, struct gz_workers *workers);

/**
 * Add a level of a file of bricks, without voxels. Levels are added finest first.
 *
 * @return false if gz_levels_build() would not keep it, or there are GZ_LEVELS_MAX already
 */
bool gz_levels_add(struct gz_levels *levels, const struct gz_brick_level *brick_level);

/** Free the coarser levels and zero the struct. */
void gz_levels_free(struct gz_levels *levels);

/**
 * Distance between the rays of neighbouring pixels where they reach the box, voxel lengths. In
 * perspective: at the point of the box nearest to the eye, where they are closest; 0 for an eye
 * inside the box.
 *
 * @param camera  valid, see gz_camera_rays()
 * @param height  of the picture, px
 */
double gz_levels_pixel_lengths(const struct gz_volume *volume, const struct gz_camera *camera,
			       int height);

/**
 * The level for rays @p across voxel lengths apart with samples @p along voxel lengths apart: the
 * coarsest whose voxels are at most sqrt(2) times as wide as the smaller of both (the nearest power
 * of two). If rays or samples are less than sqrt(2) voxel lengths apart it is level 0, so that
 * levels do not change a picture finer than the data where spacing and step are 1.
 */
int gz_levels_choose(const struct gz_levels *levels, double across, double along);

#endif
