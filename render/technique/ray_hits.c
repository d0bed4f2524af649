#include "render/technique/ray_hits.h"

#include <math.h>
#include <stdlib.h>

enum gz_result gz_ray_hits_clear(struct gz_ray_hits *hits, const struct gz_plan *plan)
{
	const size_t count = plan->tile_count * GZ_HITS_A_TILE;
	if (count > hits->capacity) {
		float *depth = malloc(count * sizeof *depth);
		uint32_t *pixels = malloc(count * sizeof *pixels);
		if (!depth || !pixels) {
			free(depth);
			free(pixels);
			return GZ_ERR_NO_MEM;
		}
		gz_ray_hits_free(hits);
		hits->depth = depth;
		hits->pixels = pixels;
		hits->capacity = count;
	}
	for (size_t i = 0; i < count; i++)
		hits->depth[i] = INFINITY;
	return GZ_OK;
}

void gz_ray_hits_free(struct gz_ray_hits *hits)
{
	free(hits->depth);
	free(hits->pixels);
	*hits = (struct gz_ray_hits) { 0 };
}
