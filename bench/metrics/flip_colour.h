/**
 * @file
 * Colour spaces of FLIP (Andersson et al. 2020, section 4.1). White is D65, as sRGB's. Not for
 * users of the metrics.
 */
#ifndef GZ_BENCH_METRICS_FLIP_COLOUR_H
#define GZ_BENCH_METRICS_FLIP_COLOUR_H

#include <stdint.h>

/** An sRGB channel of 8 bits as linear light, [0, 1] (IEC 61966-2-1). */
float gz_linear_of_srgb(uint8_t channel);

/** Linear RGB to the opponent space YCxCz. */
void gz_opponent_of_linear(const float rgb[3], float out_opponent[3]);

/** YCxCz back to linear RGB, each channel clamped to [0, 1]. */
void gz_linear_of_opponent(const float opponent[3], float out_rgb[3]);

/** Linear RGB to CIELab with the chroma adjusted to the lightness (Hunt 1952): a and b times
 *  .01 L. */
void gz_hunt_lab_of_linear(const float rgb[3], float out_lab[3]);

/** HyAB distance of two such colours (Abasi, Tehran and Fairchild 2020). */
float gz_hyab(const float a[3], const float b[3]);

#endif
