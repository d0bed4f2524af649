/**
 * @file
 * Colours for numbers: from dark blue over green to yellow, lighter as the number rises, so that
 * they also tell it to people who see few colours, and in grey.
 */
#ifndef GZ_VIEW_DRAW_VIRIDIS_H
#define GZ_VIEW_DRAW_VIRIDIS_H

#include <stdint.h>

/**
 * The colour of a share of the scale, [0, 1] (what is beyond takes its end, NaN the beginning):
 * "viridis" of Stéfan van der Walt and Nathaniel Smith, "A Better Default Colormap for Matplotlib"
 * (SciPy 2015), at ten places, linear between them.
 */
void gz_viridis(double share, uint8_t out_rgb[3]);

#endif
