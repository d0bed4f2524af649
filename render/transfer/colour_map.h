/**
 * @file
 * Perceptually uniform colour maps: equal steps of the value look like equal steps of the colour,
 * also to most people with a colour vision deficiency and in greys.
 */
#ifndef GZ_RENDER_TRANSFER_COLOUR_MAP_H
#define GZ_RENDER_TRANSFER_COLOUR_MAP_H

#include "render/transfer/transfer.h"

/** The maps; all go from dark to bright. */
enum gz_colour_map {
	GZ_COLOUR_MAP_VIRIDIS, /**< violet, green, yellow */
	GZ_COLOUR_MAP_MAGMA,   /**< black, violet, cream */
	GZ_COLOUR_MAP_INFERNO, /**< black, red, pale yellow */
	GZ_COLOUR_MAP_PLASMA,  /**< blue, pink, yellow */
	GZ_COLOUR_MAP_CIVIDIS, /**< blue, grey, yellow: alike with and without red-green blindness
				*/
	GZ_COLOUR_MAP_COUNT,
};

/** Names: "viridis", … NULL-terminated, in the order of enum gz_colour_map. */
extern const char *const gz_colour_map_names[];

/** The colour of @p value, which is clamped to 0 to 1. @param[out] out_rgb  0 to 1, as in .tf files
 */
void gz_colour_map_at(enum gz_colour_map map, double value, double out_rgb[3]);

/**
 * Give a transfer function the colours of a map over its whole range. Opacity stays, jumps too. The
 * function gets points between its own; one of curves (GZ_TRANSFER_QUADRATIC) becomes one of
 * straight lines close to them. If it would get more than GZ_TRANSFER_POINTS_MAX points, the rest
 * is left out.
 */
void gz_transfer_colour(struct gz_transfer *transfer, enum gz_colour_map map);

#endif
