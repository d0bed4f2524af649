#include "render/data/voxel_colour.h"

#include <string.h>

const char *const gz_opacity_source_names[] = { "auto", "luminance", "alpha", NULL };

uint8_t gz_colour_luminance(const uint8_t rgb[3])
{
	const unsigned sum = 2126U * rgb[0] + 7152U * rgb[1] + 722U * rgb[2];
	return (uint8_t)((sum + 5000) / 10000);
}

/* A number of 16 bits as one of 8, to the nearest. */
static uint8_t narrow_number(const uint8_t *bytes, bool swap)
{
	uint16_t number;
	memcpy(&number, bytes, sizeof number);
	number = swap ? __builtin_bswap16(number) : number;
	return (uint8_t)((number * 255U + 32767) / 65535);
}

static void take_channels(const struct gz_colour_conversion *conversion, const uint8_t *numbers,
			  uint8_t out[4])
{
	for (int i = 0; i < conversion->channels; i++)
		out[i] = conversion->bytes == 1 ? numbers[i]
						: narrow_number(numbers + 2 * i, conversion->swap);
}

void gz_colours_convert(const struct gz_colour_conversion *conversion, const uint8_t *numbers,
			size_t count, uint8_t *out_values, uint32_t *out_colours)
{
	const size_t size = (size_t)conversion->channels * (size_t)conversion->bytes;
	const bool by_alpha = conversion->colour == GZ_COLOUR_ALPHA;
	for (size_t i = 0; i < count; i++) {
		uint8_t rgba[4] = { 0, 0, 0, 255 };
		take_channels(conversion, numbers + i * size, rgba);
		out_values[i] = by_alpha ? rgba[3] : gz_colour_luminance(rgba);
		out_colours[i] = gz_colour_pack(rgba, by_alpha ? rgba[3] : 255);
	}
}

void gz_volume_take_luminance(struct gz_volume *volume)
{
	const size_t count = gz_volume_voxel_count(volume);
	uint8_t *values = volume->voxels;
	for (size_t i = 0; i < count; i++) {
		const uint32_t colour = volume->colours[i];
		const uint8_t rgb[3] = { gz_colour_byte(colour, 0), gz_colour_byte(colour, 1),
					 gz_colour_byte(colour, 2) };
		values[i] = gz_colour_luminance(rgb);
		volume->colours[i] = gz_colour_pack(rgb, 255);
	}
	volume->colour = GZ_COLOUR_LUMINANCE;
	gz_volume_find_range(volume);
}

uint32_t gz_colour_mean(const uint32_t colours[8])
{
	uint32_t sums[3] = { 0 }, alphas = 0;
	uint8_t rgb[3];
	for (int i = 0; i < 8; i++) {
		const uint32_t alpha = colours[i] >> 24;
		alphas += alpha;
		for (int channel = 0; channel < 3; channel++)
			sums[channel] += (alpha * GZ_COLOUR_WEIGHT_SHARE + 1) *
					 gz_colour_byte(colours[i], channel);
	}
	const uint32_t weights = alphas * GZ_COLOUR_WEIGHT_SHARE + 8;
	for (int channel = 0; channel < 3; channel++)
		rgb[channel] = (uint8_t)((sums[channel] + weights / 2) / weights);
	return gz_colour_pack(rgb, (uint8_t)((alphas + 4) / 8));
}

const char *gz_volume_colour_text(enum gz_volume_colour colour)
{
	return colour == GZ_COLOUR_ALPHA ? "alpha" : "luminance";
}
