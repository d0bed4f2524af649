/**
 * @file
 * Voxels with colours of their own: how a colour is kept, and the value that it gives.
 *
 * Beside its colour each voxel has a value, which is what transfer functions, gradients, empty
 * space and histograms refer to: the luminance of its colour, or its alpha.
 */
#ifndef GZ_RENDER_DATA_VOXEL_COLOUR_H
#define GZ_RENDER_DATA_VOXEL_COLOUR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/data/volume.h"

/** One divided by what is added to the weights of colours. Chosen: too little to be seen beside a
 *  weight of 1. */
#define GZ_COLOUR_WEIGHT_SHARE 64

/**
 * A colour as a word: red, green, blue and weight, 8 bits each, from the lowest on.
 *
 * Between voxels colours count by their weights (Wittenbrink, Malzbender and Goss, Opacity-weighted
 * color interpolation for volume sampling, 1998), so that the colour of transparent voxels does not
 * show at the rim of opaque ones. The weight is the alpha; if values are luminance, all weights are
 * 255. A little is added to each (GZ_COLOUR_WEIGHT_SHARE), so that a sample among voxels of weight
 * 0 has a colour, too.
 */
static inline uint32_t gz_colour_pack(const uint8_t rgb[3], uint8_t weight)
{
	return rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16 | (uint32_t)weight << 24;
}

/** Byte @p channel of a word: 0 red, 1 green, 2 blue, 3 weight. */
static inline uint8_t gz_colour_byte(uint32_t colour, int channel)
{
	return (uint8_t)(colour >> 8 * channel);
}

/** The luminance of a colour as it is stored, to the nearest whole number: 0.2126 red + 0.7152
 *  green + 0.0722 blue (ITU-R BT.709-6, 3.2). Grey keeps its value. */
uint8_t gz_colour_luminance(const uint8_t rgb[3]);

/** How the numbers of a file become colours and values. */
struct gz_colour_conversion {
	int channels; /**< numbers of a voxel: 3 red, green and blue; 4 alpha too */
	int bytes;    /**< of a number: 1; or 2, whose 65535 becomes 255, rounded to the nearest */
	bool swap;    /**< the byte order of a number is not the host's */
	enum gz_volume_colour colour; /**< what values are; GZ_COLOUR_ALPHA needs 4 channels */
};

/**
 * Convert @p count voxels.
 *
 * @param numbers          of the file; need not be aligned
 * @param[out] out_values  @p count values
 * @param[out] out_colours @p count words
 */
void gz_colours_convert(const struct gz_colour_conversion *conversion, const uint8_t *numbers,
			size_t count, uint8_t *out_values, uint32_t *out_colours);

/** Make the values of a volume in memory those of the luminance, from its colours, and all weights
 *  equal. Its range is found again. */
void gz_volume_take_luminance(struct gz_volume *volume);

/** The mean of eight colours by their weights, and of the weights. */
uint32_t gz_colour_mean(const uint32_t colours[8]);

/** "auto", "luminance", "alpha"; NULL-terminated, in the order of enum gz_opacity_source. */
extern const char *const gz_opacity_source_names[];

/** What the values of a coloured volume are, in words, for people: "luminance" or "alpha". */
const char *gz_volume_colour_text(enum gz_volume_colour colour);

#endif
