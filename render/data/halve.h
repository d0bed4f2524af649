/**
 * @file
 * A volume at half its resolution: the step from one level of detail to the next.
 *
 * Where data sit: voxel i of a halved axis is the mean of voxels 2i and 2i + 1, so its datum lies
 * in their middle, at 2i + 1 in the voxel coordinates of the full volume (voxel i spans [i, i +
 * 1)): coordinates of the half are those of the full volume divided by two, without an offset. An
 * axis of n voxels has (n + 1) / 2 of them halved. With n odd the last one stands for voxel n - 1
 * alone, as if that were repeated beyond the box, and the box of the half reaches one full voxel
 * farther than the volume's; who casts through it cuts rays by the box of the full volume.
 */
#ifndef GZ_RENDER_DATA_HALVE_H
#define GZ_RENDER_DATA_HALVE_H

#include <stdbool.h>

#include "base/result.h"
#include "render/data/volume.h"

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

#endif
