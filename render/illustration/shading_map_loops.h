/*
 * The loops of shading_map.h, compiled once for each instruction set (plane_kernels.h). Nothing in
 * them is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_MAP_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_MAP_LOOPS_H

#include "render/illustration/feature_lines.h"
#include "render/illustration/shading_map.h"

/* Thresholds of lines: halfway between what gz_feature_lines() writes. */
#define ANY_LINE        (GZ_LINE_INNER / 2)
#define SILHOUETTE_ONLY ((GZ_LINE_INNER + GZ_LINE_SILHOUETTE) / 2)

/* Most pixels that are composed at once. Chosen: all planes of them stay in the first-level cache.
 */
enum { SPAN_MAX = 256 };

/* gz_shading_fade() */
static inline void fade_loop(float *restrict map, const float *restrict values, size_t count,
			     float weight)
{
	for (size_t i = 0; i < count; i++) {
		const float share = weight * values[i];
		map[i] = (1 - share) * map[i] + share;
	}
}

/* gz_shading_add_edge_light() */
static inline void add_edge_light_loop(float *restrict map, const float *restrict blurred,
				       const float *restrict depth, size_t count, float weight)
{
	for (size_t i = 0; i < count; i++) {
		const float mask = blurred[i] - depth[i];
		const float sum = map[i] + weight * (mask > 0 ? mask : 0);
		const float low = sum < 0 ? 0 : sum;
		map[i] = low > 1 ? 1 : low;
	}
}

/* gz_shading_add_overlap_shadow() */
static inline void add_overlap_shadow_loop(float *restrict map, const float *restrict blurred,
					   const float *restrict depth, size_t count, float weight)
{
	for (size_t i = 0; i < count; i++) {
		const float mask = blurred[i] - depth[i];
		map[i] *= 1 + weight * (mask < 0 ? mask : 0);
	}
}

/* gz_shading_add_haze() */
static inline void add_haze_loop(float *restrict map, const float *restrict haze, size_t count,
				 float weight, float background)
{
	for (size_t i = 0; i < count; i++) {
		const float share = weight * haze[i];
		map[i] = (1 - share) * map[i] + share * background;
	}
}

/* Lines of one width. */
static inline void draw_even_lines(float *restrict map, const float *restrict lines, size_t count,
				   float weight)
{
	for (size_t i = 0; i < count; i++) {
		const float ink = 1 - (lines[i] > ANY_LINE ? weight : 0);
		map[i] = ink < map[i] ? ink : map[i];
	}
}

/* gz_shading_draw_lines() */
static inline void draw_lines_loop(float *map, const struct gz_shading_lines *lines, size_t count,
				   float weight)
{
	if (!lines->thin || !lines->fade) {
		draw_even_lines(map, lines->strong, count, weight);
		return;
	}
	const float bound = lines->thin_silhouettes ? SILHOUETTE_ONLY : ANY_LINE;
	for (size_t i = 0; i < count; i++) {
		/* 1 where there is no line, without rounding */
		const float strong = lines->strong[i] > ANY_LINE ? 1.0F : 0.0F;
		const float thin = lines->thin[i] > bound ? 1.0F : 0.0F;
		const float drawn = (1 - lines->fade[i]) * strong + lines->fade[i] * thin;
		const float ink = 1 - weight * drawn;
		map[i] = ink < map[i] ? ink : map[i];
	}
}

/* The share of a pixel that scene information and haze fade, together. */
static inline void fade_of_lines(const struct gz_shading_layers *layers,
				 const struct gz_shading_weights *weights, size_t begin,
				 size_t count, float *restrict fade)
{
	for (size_t i = 0; i < count; i++)
		fade[i] = 1;
	for (size_t i = 0; layers->scene && i < count; i++)
		fade[i] *= 1 - weights->scene * layers->scene[begin + i];
	for (size_t i = 0; layers->haze && i < count; i++)
		fade[i] *= 1 - weights->haze * layers->haze[begin + i];
	for (size_t i = 0; i < count; i++)
		fade[i] = 1 - fade[i];
}

/* Lines of pixels of one object. */
static inline void draw_span_lines(const struct gz_shading_layers *layers,
				   const struct gz_shading_weights *weights, size_t begin,
				   size_t count, float *map)
{
	float *drawn = layers->apart ? layers->apart : map;
	float fade[SPAN_MAX];
	struct gz_shading_lines lines = {
		.strong = layers->strong_lines + begin,
		.fade = fade,
		.thin_silhouettes = layers->scene && weights->scene > 0,
	};
	if (layers->thin_lines)
		lines.thin = layers->thin_lines + begin;
	fade_of_lines(layers, weights, begin, count, fade);
	draw_lines_loop(drawn + begin, &lines, count, weights->lines);
}

/* Pixels of one object, at most SPAN_MAX. */
static inline void compose_span(const struct gz_shading_layers *layers,
				const struct gz_shading_weights *weights, size_t begin,
				size_t count, float *map)
{
	const float *depth = layers->depth + begin;
	if (layers->scene)
		fade_loop(map + begin, layers->scene + begin, count, weights->scene);
	if (layers->blurred_edge)
		add_edge_light_loop(map + begin, layers->blurred_edge + begin, depth, count,
				    weights->edge_light);
	if (layers->blurred_shadow)
		add_overlap_shadow_loop(map + begin, layers->blurred_shadow + begin, depth, count,
					weights->overlap_shadow);
	if (layers->haze)
		add_haze_loop(map + begin, layers->haze + begin, count, weights->haze,
			      weights->background);
	if (layers->strong_lines)
		draw_span_lines(layers, weights, begin, count, map);
}

/* gz_shading_map_compose() */
static inline void map_compose_loop(const struct gz_shading_layers *layers,
				    const struct gz_plane_band *band,
				    const struct gz_shading_weights *weights, size_t objects,
				    float *map)
{
	const size_t end = (size_t)band->end * (size_t)band->width;
	size_t begin = (size_t)band->first * (size_t)band->width;
	while (begin < end) {
		const uint32_t id = layers->ids[begin];
		size_t count = 1;
		while (count < SPAN_MAX && begin + count < end && layers->ids[begin + count] == id)
			count++;
		for (size_t i = 0; id == 0 && i < count; i++)
			map[begin + i] = 1;
		if (id != 0)
			compose_span(layers, &weights[id < objects ? id - 1 : objects - 1], begin,
				     count, map);
		begin += count;
	}
}

/* gz_shading_grey() */
static inline void grey_loop(const float *restrict map, size_t count, uint32_t *restrict out_pixels)
{
	for (size_t i = 0; i < count; i++) {
		const float low = map[i] > 0 ? map[i] : 0;
		const float value = low < 1 ? low : 1;
		const uint32_t grey = (uint32_t)(int)(value * 255 + 0.5F);
		out_pixels[i] = UINT32_C(0xFF000000) | grey << 16 | grey << 8 | grey;
	}
}

#endif
