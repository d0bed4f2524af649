/**
 * @file
 * How much longer steps change what rays through a volume see: measured on a few rays, so that
 * steps grow only where data and transfer function are smooth.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_STEP_ERRORS_H
#define GZ_RENDER_RAYCAST_SHARED_STEP_ERRORS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"
#include "render/data/volume.h"
#include "render/transfer/transfer_table.h"

/** Number of rays. Chosen: other rays mostly give growths that differ by a few hundredths
 * (docs/results.md), and the values of a volume of 256³ voxels are there in some milliseconds. The
 * time grows with the edge. */
#define GZ_STEP_ERROR_RAYS 256

/** Samples per voxel length of the finest steps. Chosen: finer ones change little. */
#define GZ_STEP_ERROR_FINEST 4

/** Step lengths that are measured; see gz_step_error_lengths. */
#define GZ_STEP_ERROR_LENGTHS 8

/** The lengths, voxel lengths, rising. */
extern const double gz_step_error_lengths[GZ_STEP_ERROR_LENGTHS];

/** The values of a volume along rays in all directions through places that fill its box evenly.
 *  Zero-initialised holds none. */
struct gz_ray_values {
	size_t first[GZ_STEP_ERROR_RAYS + 1]; /**< of each ray's values; the last is their number */
	float *stored;                        /**< 1 / GZ_STEP_ERROR_FINEST voxel lengths apart */
	int *entries;                         /**< room for as many entries of a table */
};

/** What steps of a length change. Light is the luminance (BT.709) of the picture's values, 0 to 1,
 *  in front of black. */
struct gz_step_error {
	double light;         /**< mean square of the change of light */
	double opacity;       /**< mean square of the change of opacity */
	double light_opacity; /**< mean product of both */
};

/** What was measured. Zero-initialised is nothing. */
struct gz_step_errors {
	bool known;            /**< enough rays see something */
	double light, opacity; /**< means over the rays that see something */
	struct gz_step_error at[GZ_STEP_ERROR_LENGTHS]; /**< of gz_step_error_lengths */
};

/**
 * Take the values of a volume along the rays, the same rays each time.
 *
 * @param volume   in memory
 * @param nearest  take the nearest voxel's value instead of interpolating
 * @param values   replaced; zeroed or from an earlier call. gz_ray_values_free()
 * @retval GZ_ERR_NO_MEM  @p values is empty
 *
 * Threads: any. Takes some milliseconds for edges of 256 voxels, and in proportion for others.
 */
enum gz_result gz_ray_values_take(const struct gz_volume *volume, bool nearest,
				  struct gz_ray_values *values);

/** Free and zero. */
void gz_ray_values_free(struct gz_ray_values *values);

/**
 * Measure what steps of each length change against the finest steps, without light and clip region.
 * A step has the value in its middle.
 *
 * @param values      not empty; its room for entries is written
 * @param table       of the same volume
 * @param[out] out_errors  not known if nearly all rays see nothing
 * @retval GZ_ERR_NO_MEM   @p out_errors is not written
 *
 * Threads: one at a time for each @p values.
 */
enum gz_result gz_step_errors_measure(struct gz_ray_values *values,
				      const struct gz_transfer_table *table,
				      struct gz_step_errors *out_errors);

/**
 * The change by steps of a length, root of the mean square, as a share of the picture's mean light.
 * Between the lengths that are measured it is a power of the length, and below them as well; beyond
 * the longest it is that of the longest.
 *
 * @param length      voxel lengths, above 0
 * @param background  the colour behind the volume, 0 to 1 each
 */
double gz_step_error_at(const struct gz_step_errors *errors, double length,
			const double background[3]);

/**
 * The longest steps that change what rays see by at most @p limit, as gz_step_error_at() has it,
 * and with them all shorter ones that are measured.
 *
 * @param errors      known
 * @param background  as above
 * @param limit       above 0
 * @return voxel lengths; infinite if the longest that is measured changes no more
 */
double gz_step_errors_longest(const struct gz_step_errors *errors, const double background[3],
			      double limit);

#endif
