#include "render/illustration/depth_blur.h"

#include <math.h>

#include "render/illustration/plane_kernels.h"

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

/* Least standard deviation of a Gaussian of cells. Chosen: with 2 the error is twice as large, with
 * 4 the time. */
#define DEVIATION_LEAST 2.5

/* The mean of f by f pixels adds a variance of (f² - 1) / 12 px², bilinear enlargement one of
 * f² / 6: that of a triangle that reaches f pixels to either side. */
void gz_depth_blur_make(double deviation_px, struct gz_depth_blur *out_blur)
{
	int level = 0;
	while (level < GZ_BLUR_LEVELS_MAX && deviation_px / (2 << level) >= DEVIATION_LEAST)
		level++;
	const double factor = 1 << level, cells = deviation_px / factor;
	const double added = level > 0 ? (1 - 1 / (factor * factor)) / 12 + 1.0 / 6 : 0;
	out_blur->level = level;
	gz_gaussian_make(sqrt(cells * cells - added), &out_blur->gaussian);
}

void gz_depth_share(const void *depth, const uint32_t *ids, int count,
		    const struct gz_depth_range *range, float *out_shares)
{
	gz_plane_kernels_find()->share_depth(depth, ids, count, range, out_shares);
}

void gz_depth_halve(const float *upper, const float *lower, int width, float *out_cells)
{
	gz_plane_kernels_find()->halve_rows(upper, lower, width, out_cells);
}

void gz_depth_enlarge(const float *cells, int width, int height, int level, int x, int y,
		      float *out_pixels)
{
	gz_plane_kernels_find()->enlarge_cells(cells, width, height, level, x, y, out_pixels);
}

void gz_blur_along_rows(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			const float *in, float *out)
{
	gz_plane_kernels_find()->blur_rows(gaussian, band, in, out);
}

void gz_blur_along_columns(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			   const float *in, float *out)
{
	gz_plane_kernels_find()->blur_columns(gaussian, band, in, out);
}
