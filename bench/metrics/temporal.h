/**
 * @file
 * How much of a change over time the eye sees: the response of its transient channel to pictures in
 * a row. Errors that stay the same cause none; errors that come and go do.
 *
 * The impulse response is that of Watson, "Temporal sensitivity" (Handbook of Perception and Human
 * Performance, 1986, chapter 6): h(t) = h1(t) - h2(t), where h1 and h2 are cascades of 9 and 10
 * exponential filters with time constants of 4.94 ms and 1.33 times that, by Robson's measurements
 * (1966). What never changes has a response of 0 (his transience is 1).
 */
#ifndef GZ_BENCH_METRICS_TEMPORAL_H
#define GZ_BENCH_METRICS_TEMPORAL_H

#include "bench/metrics/metrics.h"

/** Pictures that a response is made of. Chosen: at 60 a second the impulse response has ended. */
#define GZ_TEMPORAL_FRAMES 8

/**
 * The weights of the last GZ_TEMPORAL_FRAMES pictures, the oldest first. Their sum is 0, and the
 * response to a sine of amplitude 1 at the frequency that the eye sees best has the amplitude 1.
 *
 * @param fps  pictures a second, 30 to 120
 */
void gz_temporal_weights(double fps, double out_weights[GZ_TEMPORAL_FRAMES]);

/**
 * Add a picture's luma (ITU-R BT.709, of the colours as they are stored), in levels of 255, times
 * @p weight to a map of its size.
 */
void gz_map_add_luma(struct gz_map *map, const struct gz_image *image, double weight);

/** Weighted mean of the absolute difference of two maps; all of one size. 0 where the weights sum
 *  up to 0. */
double gz_map_weighted_difference(const struct gz_map *a, const struct gz_map *b,
				  const struct gz_map *weights);

#endif
