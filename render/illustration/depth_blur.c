#include "render/illustration/depth_blur.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Columns that are summed up at once. Chosen: they stay in the first-level cache. */
enum { BLUR_COLUMNS = 64 };

void gz_gaussian_make(double deviation_px, struct gz_gaussian *out_gaussian)
{
	double weights[GZ_GAUSSIAN_RADIUS_MAX + 1] = { 1 }, sum = 1;
	const double reach = ceil(3 * deviation_px);
	const int radius = reach < GZ_GAUSSIAN_RADIUS_MAX ? (int)reach : GZ_GAUSSIAN_RADIUS_MAX;
	for (int i = 1; i <= radius; i++) {
		weights[i] = exp(-0.5 * (i / deviation_px) * (i / deviation_px));
		sum += 2 * weights[i];
	}
	*out_gaussian = (struct gz_gaussian) { .radius = radius };
	for (int i = 0; i <= radius; i++)
		out_gaussian->weights[i] = (float)(weights[i] / sum);
}

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

void gz_blur_along_rows(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
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

void gz_blur_along_columns(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			   const float *in, float *out)
{
	for (int x = 0; x < band->width; x += BLUR_COLUMNS)
		for (int y = band->first; y < band->end; y++)
			blur_column_span(gaussian, band, in, out, y, x);
}
