#include <math.h>

#include "bench/metrics/metrics.h"

enum gz_result gz_squared_error(const struct gz_image *reference, const struct gz_image *test,
				struct gz_map *out_map)
{
	if (reference->width != test->width || reference->height != test->height)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_map_resize(out_map, test->width, test->height);
	if (result != GZ_OK)
		return result;
	const size_t count = (size_t)test->width * (size_t)test->height;
	for (size_t i = 0; i < count; i++) {
		int sum = 0;
		for (size_t channel = 0; channel < 3; channel++) {
			const int d =
				reference->pixels[4 * i + channel] - test->pixels[4 * i + channel];
			sum += d * d;
		}
		out_map->values[i] = (float)sum / (3 * 255 * 255);
	}
	return GZ_OK;
}

double gz_psnr_db(double mean_squared_error)
{
	return mean_squared_error > 0 ? -10 * log10(mean_squared_error) : INFINITY;
}
