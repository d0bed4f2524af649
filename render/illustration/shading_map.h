/**
 * @file
 * The composition of a shading map, the brightness that every pixel of an illustration is to have
 * (Pfisterer 2007, section 3.4.1). The order of the steps is:
 *
 *  1. the weighted mean of the surface parameters (gz_shading_mean()), its histogram equalised
 *     (tone_curve.h)
 *  2. scene information fades contrast (eq. 3.5)
 *  3. edge light and overlap shadow (eq. 3.6 and 3.7)
 *  4. atmospheric perspective (eq. 3.8)
 *  5. lines (eq. 3.9 and 3.10)
 *
 * Each step is a function over any pixels; gz_shading_map_compose() does steps 2 to 5 for a band of
 * rows, with weights of each object's own. Nothing allocates. Threads: any, for different pixels.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_MAP_H
#define GZ_RENDER_ILLUSTRATION_SHADING_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/illustration/depth_blur.h"

/**
 * Take contrast away: M' = (1 - w P) M + w P (eq. 3.5). What P = 1 marks becomes white at w = 1.
 *
 * @param[in,out] map  brightness of @p count pixels, [0, 1]
 * @param values       P, [0, 1]
 * @param weight       w, [0, 1]
 */
void gz_shading_fade(float *map, const float *values, size_t count, float weight);

/**
 * Add edge light: M' = clamp(M + w P, 0, 1), where P is the positive part of blurred depth less
 * depth (eq. 3.6; Luft et al. 2006). Near objects become brighter along their edges.
 *
 * @param blurred, depth  [0, 1]
 */
void gz_shading_add_edge_light(float *map, const float *blurred, const float *depth, size_t count,
			       float weight);

/**
 * Add overlap shadow: M' = (1 + w P) M, where P is the negative part of blurred depth less depth
 * (eq. 3.7; Luft et al. 2006). What lies behind something becomes darker around it.
 */
void gz_shading_add_overlap_shadow(float *map, const float *blurred, const float *depth,
				   size_t count, float weight);

/**
 * Add atmospheric perspective: M' = (1 - w P) M + w P B (eq. 3.8).
 *
 * @param haze        P, [0, 1]
 * @param background  B, the brightness of what is far, [0, 1]
 */
void gz_shading_add_haze(float *map, const float *haze, size_t count, float weight,
			 float background);

/** Lines of two widths, and what fades from one to the other. */
struct gz_shading_lines {
	const float *strong;   /**< as gz_feature_lines() makes them */
	const float *thin;     /**< NULL: the strong ones everywhere */
	const float *fade;     /**< 0: the strong lines, 1: the thin ones; NULL: the strong ones
				    everywhere */
	bool thin_silhouettes; /**< of the thin lines only the silhouettes count */
};

/**
 * Draw lines: M' = min((1 - F) (1 - w S) + F (1 - w T), M), with the strong lines S, the thin lines
 * T and the fade F (eq. 3.10); without thin lines M' = min(1 - w S, M) (eq. 3.9). Inner lines and
 * silhouettes are alike dark.
 */
void gz_shading_draw_lines(float *map, const struct gz_shading_lines *lines, size_t count,
			   float weight);

/** The planes of a picture, of one size. Those that are NULL leave their step out. */
struct gz_shading_layers {
	const uint32_t *ids;         /**< of objects, 0 is the background; not NULL */
	const float *depth;          /**< 0 (near) to 1 (far); not NULL */
	const float *scene;          /**< scene information, [0, 1] */
	const float *blurred_edge;   /**< depth blurred for edge light */
	const float *blurred_shadow; /**< depth blurred for overlap shadow */
	const float *haze;           /**< atmospheric perspective, [0, 1] */
	const float *strong_lines, *thin_lines;
	float *apart; /**< lines are drawn here, onto white, and not into the map; NULL: into it */
};

/** How much each step counts for one object, [0, 1]. */
struct gz_shading_weights {
	float scene, edge_light, overlap_shadow, haze, lines;
	float background; /**< brightness of what is far */
};

/**
 * Do steps 2 to 5 for a band of rows. Lines go from strong to thin as scene information and
 * atmospheric perspective fade the object: F = 1 - (1 - w_s P_s) (1 - w_h P_h), which is either of
 * them where the other is 0. With scene information the thin lines are silhouettes only. The
 * background becomes 1, white.
 *
 * @param weights        of object 1 to @p objects; higher ids have those of the last one
 * @param objects        1 or more
 * @param[in,out] map    step 1; the brightness to draw
 */
void gz_shading_map_compose(const struct gz_shading_layers *layers,
			    const struct gz_plane_band *band,
			    const struct gz_shading_weights *weights, size_t objects, float *map);

#endif
