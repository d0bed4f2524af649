/**
 * @file
 * The loops of segment_kernels.h, to be compiled for each instruction set.
 */
#ifndef GZ_RENDER_TRANSFER_SEGMENT_LOOPS_H
#define GZ_RENDER_TRANSFER_SEGMENT_LOOPS_H

#include <string.h>

#include "render/transfer/segment_kernels.h"

/* The greatest power below which exp2_minus() is exact enough; all above is opaque. */
#define POWER_MOST 126.0F

/* 2^-x for x from 0 to POWER_MOST, error 2e-7: the same polynomial as the kernels'
 * (render/raycast/cpu/cast_shade.h). */
static inline float exp2_minus(float x)
{
	union {
		int32_t bits;
		float power;
	} whole;
	const int32_t nearest = (int32_t)(x + 0.5F);
	const float f = ((float)nearest - x) * 0.693147180559945F;
	float p = 1.0F / 720;
	p = p * f + 1.0F / 120;
	p = p * f + 1.0F / 24;
	p = p * f + 1.0F / 6;
	p = p * f + 0.5F;
	p = p * f + 1;
	p = p * f + 1;
	whole.bits = (127 - nearest) << 23;
	return p * whole.power;
}

/* A power that exp2_minus() takes. */
static inline float limit_power(float x)
{
	return x < POWER_MOST ? x : POWER_MOST;
}

/* A share of a colour as a whole number, 0 to levels. */
static inline uint32_t pack_channel(float share, float levels)
{
	/* Rounding may take a difference of sums above 1. */
	const float level = share * levels + 0.5F;
	return (uint32_t)(int32_t)(level < levels ? level : levels);
}

/* The word of a colour: 11 bits of red, 11 of green, 10 of blue. */
static inline uint32_t pack_float_colour(float red, float green, float blue)
{
	return pack_channel(red, 2047) << 21 | pack_channel(green, 2047) << 10 |
	       pack_channel(blue, 1023);
}

/* Mean extinction over the entries [from, to), and their mean colour weighted by extinction. */
static inline void average_stretch(const struct gz_transfer_sums *sums, int from, int to,
				   float *out_extinction, float out_rgb[3])
{
	const double *low = sums->sum[from], *high = sums->sum[to];
	const double sum = high[0] - low[0];
	const double share = sum > 0 ? 1 / sum : 0;
	*out_extinction = (float)(sum / (to - from));
	for (int channel = 0; channel < 3; channel++)
		out_rgb[channel] = (float)((high[1 + channel] - low[1 + channel]) * share);
}

/* struct gz_segment_kernels, average */
static void average_segments(const struct gz_transfer_sums *sums, int low, int count,
			     struct gz_segment_means *out_means)
{
	const int stride = GZ_PREINTEGRATED_STRIDE(sums->count);
	const int from = low * stride + stride / 2;
	for (int part = 0; part < GZ_SEGMENT_PARTS; part++)
		for (int i = 0; i < count; i++) {
			const int width = (i + 1) * (stride / GZ_SEGMENT_PARTS);
			float rgb[3];
			average_stretch(sums, from + part * width, from + (part + 1) * width,
					&out_means->extinction[part][i], rgb);
			for (int channel = 0; channel < 3; channel++)
				out_means->rgb[part][channel][i] = rgb[channel];
		}
}

/* Opacities and colours of a row, apart, so that compilers vectorise the loops. */
struct segment_row {
	float part[GZ_SEGMENT_PARTS][GZ_PREINTEGRATED_SIZE]; /* opacity of each part */
	union {
		float opacity[GZ_PREINTEGRATED_SIZE];
		uint32_t opacity_bits[GZ_PREINTEGRATED_SIZE];
	};
	uint32_t colour[GZ_PREINTEGRATED_SIZE];
	uint64_t words[GZ_PREINTEGRATED_SIZE]; /* both, as entries have them */
};

/* Where the opacity is in the word of an entry. */
enum { OPACITY_SHIFT = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? 0 : 32 };

_Static_assert(sizeof(struct gz_transfer_entry) == sizeof(uint64_t), "an entry is a word");

/* Blend the parts of one segment front to back, from part `first` on by `step`. */
static inline void blend_segment(const struct gz_segment_means *restrict means,
				 struct segment_row *restrict row, int i, int first, int step)
{
	float through = 1, red = 0, green = 0, blue = 0;
	for (int k = 0; k < GZ_SEGMENT_PARTS; k++) {
		const int part = first + k * step;
		const float weight = through * row->part[part][i];
		red += weight * means->rgb[part][0][i];
		green += weight * means->rgb[part][1][i];
		blue += weight * means->rgb[part][2][i];
		through -= weight;
	}
	const float all = 1 - through, share = 1 / (all > 1e-30F ? all : 1e-30F);
	row->opacity[i] = all;
	row->colour[i] = pack_float_colour(red * share, green * share, blue * share);
}

/* Write opacities and colours together. */
static inline void store_segments(struct segment_row *row, int count,
				  struct gz_transfer_entry *out_entries)
{
	for (int i = 0; i < count; i++)
		row->words[i] = (uint64_t)row->opacity_bits[i] << OPACITY_SHIFT |
				(uint64_t)row->colour[i] << (32 - OPACITY_SHIFT);
	memcpy(out_entries, row->words, (size_t)count * sizeof *out_entries);
}

/* struct gz_segment_kernels, blend */
static void blend_segments(const struct gz_segment_means *means, int count, float length,
			   struct gz_transfer_entry *out_rising,
			   struct gz_transfer_entry *out_falling)
{
	struct segment_row row;
	for (int part = 0; part < GZ_SEGMENT_PARTS; part++)
		for (int i = 0; i < count; i++)
			row.part[part][i] = limit_power(means->extinction[part][i] * length);
	for (int part = 0; part < GZ_SEGMENT_PARTS; part++)
		for (int i = 0; i < count; i++)
			row.part[part][i] = 1 - exp2_minus(row.part[part][i]);
	for (int i = 0; i < count; i++)
		blend_segment(means, &row, i, 0, 1);
	store_segments(&row, count, out_rising);
	for (int i = 0; i < count; i++)
		blend_segment(means, &row, i, GZ_SEGMENT_PARTS - 1, -1);
	store_segments(&row, count, out_falling);
}

/* struct gz_segment_kernels, mix */
static void mix_segments(const struct gz_transfer_sums *sums, int low, int count,
			 struct gz_transfer_entry *out_entries)
{
	const int stride = GZ_PREINTEGRATED_STRIDE(sums->count);
	const int from = low * stride + stride / 2;
	for (int i = 0; i < count; i++) {
		float extinction, rgb[3];
		average_stretch(sums, from, from + (i + 1) * stride, &extinction, rgb);
		out_entries[i].extinction = -extinction;
		out_entries[i].colour = pack_float_colour(rgb[0], rgb[1], rgb[2]);
	}
}

/* struct gz_segment_kernels, mix_in_cell */
static void mix_in_cell(const struct gz_transfer_sums *sums, int cell,
			struct gz_transfer_entry *out_entry)
{
	const int stride = GZ_PREINTEGRATED_STRIDE(sums->count);
	float extinction, rgb[3];
	average_stretch(sums, cell * stride, (cell + 1) * stride, &extinction, rgb);
	out_entry->extinction = -extinction;
	out_entry->colour = pack_float_colour(rgb[0], rgb[1], rgb[2]);
}

/* struct gz_segment_kernels, segment_in_cell */
static void segment_in_cell(const struct gz_transfer_sums *sums, int cell, float length,
			    struct gz_transfer_entry *out_entry)
{
	mix_in_cell(sums, cell, out_entry);
	out_entry->opacity =
		1 - exp2_minus(limit_power(-out_entry->extinction * GZ_SEGMENT_PARTS * length));
}

#endif
