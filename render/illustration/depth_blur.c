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
