/**
 * @file
 * Colour spaces of FLIP (Andersson et al. 2020, 4.1), many pixels at a time. Not for users of the
 * metrics.
 */
#ifndef GZ_BENCH_METRICS_FLIP_COLOUR_H
#define GZ_BENCH_METRICS_FLIP_COLOUR_H

#include <stddef.h>
#include <stdint.h>

/** What takes colours from space to space; D65 is white. */
struct gz_flip_colours {
	float linear_of_srgb[256]; /**< IEC 61966-2-1 */
	float opponent[3][3]; /**< linear RGB to opponent colours, but for the -16 of the first */
	float linear[3][4];   /**< back, from opponent colours and 1 */
	float share[3][3];    /**< linear RGB to shares of white's X, Y and Z */
};

/** Fill the tables. */
void gz_flip_colours_set(struct gz_flip_colours *colours);

/** Pixels of RGBA, 8 bits sRGB, to opponent colours (YCxCz, linearised CIELAB): a plane each. */
void gz_opponents_of_srgb(const struct gz_flip_colours *colours, const uint8_t *pixels,
			  size_t count, float *const out_opponents[3]);

/** Opponent colours to linear RGB within [0, 1]. @p out_rgb are other planes. */
void gz_linear_of_opponents(const struct gz_flip_colours *colours, const float *const opponents[3],
			    size_t count, float *const out_rgb[3]);

/** Linear RGB, in place, to CIELAB with both chroma axes scaled by .01 of the lightness (Hunt's
 *  effect). */
void gz_hunt_labs_of_linear(const struct gz_flip_colours *colours, size_t count,
			    float *const rgb[3]);

#endif
