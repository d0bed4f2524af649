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

/** A separable filter and the planes it goes over: width * height values each, all different. */
struct gz_convolution {
	const float *in;
	float *out, *scratch; /**< scratch is overwritten */
	int width, height;
	const struct gz_kernel *across, *down;
	float scale; /**< of the result */
	bool add;    /**< add to what @p out holds, instead of overwriting it */
};

/** Filter a plane across, then down. Its edge values continue beyond its edges. */
void gz_convolve(const struct gz_convolution *convolution, struct gz_workers *workers);

#endif
