#include <stdlib.h>

#include "bench/metrics/metrics.h"

enum gz_result gz_map_resize(struct gz_map *map, int width, int height)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	const size_t count = (size_t)width * (size_t)height;
	if (!map->values || count > (size_t)map->width * (size_t)map->height) {
		float *values = realloc(map->values, count * sizeof *values);
		if (!values)
			return GZ_ERR_NO_MEM;
		map->values = values;
	}
	map->width = width;
	map->height = height;
	return GZ_OK;
}

void gz_map_free(struct gz_map *map)
{
	free(map->values);
	*map = (struct gz_map) { 0 };
}

double gz_map_mean(const struct gz_map *map)
{
	const size_t count = (size_t)map->width * (size_t)map->height;
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += (double)map->values[i];
	return count ? sum / (double)count : 0;
}

double gz_map_weighted_mean(const struct gz_map *map, const struct gz_map *weights)
{
	const size_t count = (size_t)map->width * (size_t)map->height;
	double sum = 0, total = 0;
	for (size_t i = 0; i < count; i++) {
		sum += (double)map->values[i] * (double)weights->values[i];
		total += (double)weights->values[i];
	}
	return total > 0 ? sum / total : 0;
}
