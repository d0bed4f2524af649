/**
 * @file
 * Floats whose range single precision cannot draw as it is: they are stored scaled and shifted, and
 * the volume's slope and intercept take that back, so that data values stay the same.
 */
#ifndef GZ_RENDER_DATA_FLOAT_SCALING_H
#define GZ_RENDER_DATA_FLOAT_SCALING_H

#include <stdbool.h>
#include <stddef.h>

#include "render/data/volume.h"

/** New stored value = (stored value - offset) * scale. */
struct gz_float_scaling {
	double offset; /**< 0 unless all values are alike in their leading digits */
	double scale;  /**< a power of two */
};

/**
 * Find how floats from @p least to @p greatest must be stored so that kernels and graphics devices
 * can draw them. Without this, a number of table entries per value above 2^128 is infinite,
 * denormal floats become 0 on many devices, differences of values above 2^127 are infinite, and a
 * range far from 0 leaves too few bits for the place within it.
 *
 * @param[out] out_scaling  written if the result is true
 * @return false if they can stay as they are: from 2^-80 to 2^100 at most, over a range of at least
 *         1/1024 of that; or all equal
 */
bool gz_float_scaling_find(double least, double greatest, struct gz_float_scaling *out_scaling);

/** Scale a value, rounded to single precision. */
float gz_float_scaled(const struct gz_float_scaling *scaling, float value);

/** Scale @p count values in place. */
void gz_float_scaling_apply(const struct gz_float_scaling *scaling, float *values, size_t count);

/** The part of a volume's or a brick file's header that scaling changes. */
struct gz_stored_values {
	double *slope, *intercept, *stored_min, *stored_max;
};

/** Change slope, intercept and range so that scaled values mean the same data values. */
void gz_float_scaling_take_back(const struct gz_float_scaling *scaling,
				const struct gz_stored_values *values);

/** Scale the voxels of a volume in memory if it needs that. Its range must be known; volumes of
 *  other types stay as they are. */
void gz_volume_scale_floats(struct gz_volume *volume);

#endif
