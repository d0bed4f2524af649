#include <math.h>

#include "bench/metrics/metrics.h"

/* Half-resolution eccentricity of Geisler and Perry 1998, degrees. */
#define E2_DEG 2.3

static struct gz_point pixel_at(int x, int y, int width, int height)
{
	return (struct gz_point) { ((float)x + 0.5F) / (float)width,
				   ((float)y + 0.5F) / (float)height };
}

enum gz_result gz_weights_ring(const struct gz_display *display, struct gz_point gaze, int width,
			       int height, double from_deg, double to_deg, struct gz_map *out_map)
{
	const enum gz_result result = gz_map_resize(out_map, width, height);
	if (result != GZ_OK)
		return result;
	float *value = out_map->values;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const double angle =
				gz_display_angle_deg(display, gaze, pixel_at(x, y, width, height));
			*value++ = angle >= from_deg && angle < to_deg ? 1 : 0;
		}
	return GZ_OK;
}

enum gz_result gz_weights_acuity(const struct gz_display *display, struct gz_point gaze, int width,
				 int height, struct gz_map *out_map)
{
	const enum gz_result result = gz_map_resize(out_map, width, height);
	if (result != GZ_OK)
		return result;
	float *value = out_map->values;
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const double angle =
				gz_display_angle_deg(display, gaze, pixel_at(x, y, width, height));
			const double share = E2_DEG / (angle + E2_DEG);
			*value++ = (float)(share * share);
		}
	return GZ_OK;
}
