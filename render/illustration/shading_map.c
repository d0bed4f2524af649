#include "render/illustration/shading_map.h"

#include "render/illustration/shading_map_loops.h"

void gz_shading_fade(float *map, const float *values, size_t count, float weight)
{
	fade_loop(map, values, count, weight);
}

void gz_shading_add_edge_light(float *map, const float *blurred, const float *depth, size_t count,
			       float weight)
{
	add_edge_light_loop(map, blurred, depth, count, weight);
}

void gz_shading_add_overlap_shadow(float *map, const float *blurred, const float *depth,
				   size_t count, float weight)
{
	add_overlap_shadow_loop(map, blurred, depth, count, weight);
}

void gz_shading_add_haze(float *map, const float *haze, size_t count, float weight,
			 float background)
{
	add_haze_loop(map, haze, count, weight, background);
}

void gz_shading_draw_lines(float *map, const struct gz_shading_lines *lines, size_t count,
			   float weight)
{
	draw_lines_loop(map, lines, count, weight);
}

void gz_shading_map_compose(const struct gz_shading_layers *layers,
			    const struct gz_plane_band *band,
			    const struct gz_shading_weights *weights, size_t objects, float *map)
{
	map_compose_loop(layers, band, weights, objects, map);
}
