/*
 * The loops of depth_blur.h, compiled once for each instruction set (plane_kernels.h). Nothing in
 * them is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_LOOPS_H

#include <stddef.h>
#include <string.h>

#include "render/illustration/depth_blur.h"

/* Columns that are summed up at once. Chosen: they stay in the first-level cache. */
enum { BLUR_COLUMNS = 64 };

/* An index of a plane whose border repeats. */
static int clamp_index(int index, int count)
{
	if (index < 0)
		return 0;
	return index < count ? index : count - 1;
}

/* Add both rows at equal distance, times their weight. */
static void add_row_pair(float *restrict sums, const float *before, const float *after,
			 float weight, int count)
{
	for (int i = 0; i < count; i++)
		sums[i] += weight * (before[i] + after[i]);
}

/* Columns from begin to before end, all at least a radius from both borders. */
static void blur_inner_columns(const struct gz_gaussian *gaussian, const float *in, float *out,
			       int begin, int end)
{
	for (int x = begin; x < end; x += BLUR_COLUMNS) {
		const int count = end - x < BLUR_COLUMNS ? end - x : BLUR_COLUMNS;
		float sums[BLUR_COLUMNS] = { 0 };
		for (int i = 0; i < count; i++)
			sums[i] = gaussian->weights[0] * in[x + i];
		for (int k = 1; k <= gaussian->radius; k++)
			add_row_pair(sums, in + x - k, in + x + k, gaussian->weights[k], count);
		memcpy(out + x, sums, (size_t)count * sizeof *sums);
	}
}

/* Columns that are nearer to a border. */
static void blur_border_columns(const struct gz_gaussian *gaussian, const float *in, float *out,
				int begin, int end, int width)
{
	for (int x = begin; x < end; x++) {
		float sum = gaussian->weights[0] * in[x];
		for (int k = 1; k <= gaussian->radius; k++)
			sum += gaussian->weights[k] *
			       (in[clamp_index(x - k, width)] + in[clamp_index(x + k, width)]);
		out[x] = sum;
	}
}

/* gz_blur_along_rows() */
static void blur_rows(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
		      const float *in, float *out)
{
	const int width = band->width, radius = gaussian->radius;
	const int left = radius < width ? radius : width;
	const int right = width - radius > left ? width - radius : left;
	for (int y = band->first; y < band->end; y++) {
		const float *from = in + (ptrdiff_t)y * width;
		float *to = out + (ptrdiff_t)y * width;
		blur_border_columns(gaussian, from, to, 0, left, width);
		blur_inner_columns(gaussian, from, to, left, right);
		blur_border_columns(gaussian, from, to, right, width, width);
	}
}

/* Some columns of one row. */
static void blur_column_span(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			     const float *in, float *out, int y, int x)
{
	const int count = band->width - x < BLUR_COLUMNS ? band->width - x : BLUR_COLUMNS;
	const ptrdiff_t width = band->width;
	float sums[BLUR_COLUMNS] = { 0 };
	for (int i = 0; i < count; i++)
		sums[i] = gaussian->weights[0] * in[y * width + x + i];
	for (int k = 1; k <= gaussian->radius; k++)
		add_row_pair(sums, in + clamp_index(y - k, band->height) * width + x,
			     in + clamp_index(y + k, band->height) * width + x,
			     gaussian->weights[k], count);
	memcpy(out + y * width + x, sums, (size_t)count * sizeof *sums);
}

/* gz_blur_along_columns() */
static void blur_columns(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			 const float *in, float *out)
{
	for (int x = 0; x < band->width; x += BLUR_COLUMNS)
		for (int y = band->first; y < band->end; y++)
			blur_column_span(gaussian, band, in, out, y, x);
}

#endif
