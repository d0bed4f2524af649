/**
 * @file
 * Shading parameters of single points: what of a surface, and of its place in the scene, makes it
 * bright or dark (Pfisterer, "Parametrisierbare illustrative Darstellung von medizinischen
 * Oberflaechenmodellen mit Schattierungskarten", Magdeburg 2007, sections 2.2 and 3.2).
 *
 * All functions take arrays of any points, such as the pixels of a row or the rays of a tile, and
 * give numbers from 0 (dark) to 1 (bright). They do not allocate. Threads: any.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_PARAMETERS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_PARAMETERS_H

#include <stddef.h>
#include <stdint.h>

#include "render/illustration/shading_constants.h"

/** Most levels of normals, the surface's own included. */
#define GZ_SHADING_LEVELS_MAX 9

/** A unit vector for each of many points, one array for each component. */
struct gz_shading_vectors {
	const float *x, *y, *z;
};

/* ---- surface ---- */

/**
 * Main light, not cut off where the surface turns away, so that fill light is in it: 1/2 + 1/2 l.n
 * (Pfisterer 2007, eq. 2.2, after Gooch et al. 1998).
 *
 * @param light  unit vector towards the light
 */
void gz_shading_main_light(const struct gz_shading_vectors *normals, size_t count,
			   const float light[3], float *out_values);

/**
 * Plain light: 1/5 + 4/5 max(0, l.n), what a lamp does to a matte surface (Lambert) with a little
 * light from all around. For comparison with an illustration.
 *
 * @param light  unit vector towards the lamp
 */
void gz_shading_plain_light(const struct gz_shading_vectors *normals, size_t count,
			    const float light[3], float *out_values);

/**
 * Plateau light, a light at the viewer: max(0, v.n) (Pfisterer 2007, eq. 2.1).
 *
 * @param viewer  unit vector from each point towards the viewer
 */
void gz_shading_plateau_light(const struct gz_shading_vectors *normals,
			      const struct gz_shading_vectors *viewer, size_t count,
			      float *out_values);

/** What grazing light is made by. */
struct gz_grazing_light {
	float light[3];                           /**< unit vector towards the light */
	float exaggeration;                       /**< the factor a, above 0 */
	int levels;                               /**< of normals: 2 to GZ_SHADING_LEVELS_MAX */
	float weights[GZ_SHADING_LEVELS_MAX - 1]; /**< of the levels but the last; their sum is 1 */
};

/**
 * Weights of the levels of grazing light by detail frequency. Level i counts 4^(i (1 - 2 f)) as
 * much as level 0, so f = 0 stresses the widest forms, f = 1 the finest, and f = 1/2 all alike. (4
 * is chosen: with six levels the first counts a thousand times as much as the last, or the
 * reverse.)
 *
 * @param levels     of normals: 2 to GZ_SHADING_LEVELS_MAX
 * @param frequency  f, [0, 1]
 * @param[out] out_weights  @p levels - 1 weights, whose sum is 1
 */
void gz_grazing_weights(int levels, double frequency, float *out_weights);

/**
 * Grazing light (Rusinkiewicz, Burns and DeCarlo 2006; Pfisterer 2007, eq. 2.4 and 2.5). The light
 * is projected into the tangent plane of the next smoother level, so that it falls nearly
 * along the surface everywhere:
 *
 *     l_(i+1) = l - n_(i+1) (n_(i+1).l), then normalised
 *     I_i = 1/2 + 1/2 clamp(a l_(i+1).n_i, -1, 1)
 *
 * The value is the weighted sum of I_i. Where the light falls along n_(i+1), I_i is 1/2.
 *
 * @param normals  of each level; 0 is the surface's own, each further one is smoother
 */
void gz_shading_grazing_light(const struct gz_shading_vectors *normals, size_t count,
			      const struct gz_grazing_light *grazing, float *out_values);

/**
 * Surface shape: convex places bright, hollow ones dark, flat ones and saddles between (Kindlmann
 * et al. 2003, who draw their transfer function and give no formula):
 * 1/2 + 1/2 (k1 + k2) / (|k1| + |k2| + k0).
 *
 * @param greatest, least  principal curvatures k1 >= k2, 1/mm; convex is positive
 * @param scale            k0, the curvature that shows clearly, 1/mm, above 0
 */
void gz_shading_surface_shape(const float *greatest, const float *least, size_t count, float scale,
			      float *out_values);

/**
 * Curvature magnitude: the more the surface bends, either way, the darker (Hamel 2000):
 * k0 / (C + k0), with the curvedness C = sqrt((k1^2 + k2^2) / 2) (Koenderink and van Doorn 1992).
 * Parameters as for gz_shading_surface_shape().
 */
void gz_shading_curvature_magnitude(const float *greatest, const float *least, size_t count,
				    float scale, float *out_values);

/** One parameter and its weight. */
struct gz_weighted_parameter {
	const float *values;
	float weight; /**< 0 or more */
};

/**
 * The weighted mean of parameters: sum of w P over sum of w (Pfisterer 2007, eq. 3.3). Where no
 * parameter has a weight, all values are 1, white.
 */
void gz_shading_mean(const struct gz_weighted_parameter *parameters, size_t parameter_count,
		     size_t count, float *out_values);

/* ---- scene: 0 keeps the contrast of a point, 1 takes it away (gz_shading_fade()) ---- */

/**
 * Lack of importance, 1 - importance of the point's object.
 *
 * @param ids          object of each point, 0 where there is none
 * @param importances  of object 1 to @p objects, [0, 1]; points of no object and of others get 1
 */
void gz_shading_unimportance(const uint32_t *ids, size_t count, const float *importances,
			     size_t objects, float *out_values);

/**
 * Distance to the viewer, (z - near) / (far - near), cut to [0, 1]. What is not finite, such as the
 * background, is 1.
 *
 * @param depth      distance along the ray, in any unit
 * @param near, far  of the scene, in the same unit; far > near
 */
void gz_shading_viewer_distance(const float *depth, size_t count, float near, float far,
				float *out_values);

/**
 * Distance to a chosen object, d / most, cut to [0, 1]. What is not finite is 1.
 *
 * @param most_mm  distance that counts as far, mm, above 0
 */
void gz_shading_object_distance(const float *distances_mm, size_t count, float most_mm,
				float *out_values);

/** Entries of a haze table. Chosen: a step is not seen even where the exponent is 1/2. */
#define GZ_HAZE_TABLE_SIZE 4096

/** Atmospheric perspective by depth. */
struct gz_haze_table {
	float values[GZ_HAZE_TABLE_SIZE + 1]; /**< at depth i / GZ_HAZE_TABLE_SIZE */
};

/**
 * Tabulate atmospheric perspective: 0 up to @p near, 1 from @p far on, and
 * ((d0 - dn) / (df - dn))^f between (Pfisterer 2007, eq. 2.7, after Foley et al. 1995 and Ebert and
 * Rheingans 2000).
 *
 * @param near, far  depths dn < df, [0, 1]. If far is not above near, depths beyond near are 1
 * @param exponent   f, above 0
 */
void gz_haze_table_make(double near, double far, double exponent, struct gz_haze_table *out_table);

/** Atmospheric perspective of depths in [0, 1], between the entries of the table linearly. */
void gz_shading_haze(const float *depth, size_t count, const struct gz_haze_table *table,
		     float *out_values);

#endif
