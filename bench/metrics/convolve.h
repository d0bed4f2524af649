/**
 * @file
 * Separable filters over planes of floats. Not for users of the metrics.
 */
#ifndef GZ_BENCH_METRICS_CONVOLVE_H
#define GZ_BENCH_METRICS_CONVOLVE_H

#include <stdbool.h>

#include "base/workers.h"

/** Longest kernel's radius, pixels: FLIP's at 1000 pixels a degree. */
#define GZ_KERNEL_RADIUS_MAX 136

/** Weights from -radius to radius. */
struct gz_kernel {
	int radius;
	float weights[2 * GZ_KERNEL_RADIUS_MAX + 1];
};

/**
 * Filter a plane across, then down. Beyond its edges a plane goes on with its outermost values.
 *
 * @param in, out        width * height values; different planes
 * @param scratch        as large, overwritten
 * @param scale          of the result
 * @param add            add to what @p out holds, instead of overwriting it
 */
void gz_convolve(const float *in, int width, int height, const struct gz_kernel *across,
		 const struct gz_kernel *down, float scale, bool add, struct gz_workers *workers,
		 float *scratch, float *out);

#endif
