/*
 * The loops of shading_parameters.h, compiled once for each instruction set: with the cast of rays
 * (cpu/illustrate_kernel.h) and the tiles of a shading map (shading_tile_loops.h). Nothing in them
 * is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_PARAMETER_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_SHADING_PARAMETER_LOOPS_H

#include <math.h>

#include "render/illustration/shading_parameters.h"

/* A number cut to a range. */
static inline float clamp_between(float value, float least, float most)
{
	value = value < least ? least : value;
	return value > most ? most : value;
}

/* gz_shading_main_light() */
static inline void main_light_loop(const struct gz_shading_vectors *normals, size_t count,
				   const float light[3], float *out_values)
{
	const float *restrict x = normals->x, *restrict y = normals->y, *restrict z = normals->z;
	const float lx = light[0], ly = light[1], lz = light[2];
	float *restrict values = out_values;
	for (size_t i = 0; i < count; i++)
		values[i] = 0.5F + 0.5F * (lx * x[i] + ly * y[i] + lz * z[i]);
}

#define PLAIN_AMBIENT GZ_SHADING_PLAIN_AMBIENT

/* gz_shading_plain_light() */
static inline void plain_light_loop(const struct gz_shading_vectors *normals, size_t count,
				    const float light[3], float *out_values)
{
	const float *restrict x = normals->x, *restrict y = normals->y, *restrict z = normals->z;
	const float lx = light[0], ly = light[1], lz = light[2];
	float *restrict values = out_values;
	for (size_t i = 0; i < count; i++) {
		const float facing = lx * x[i] + ly * y[i] + lz * z[i];
		values[i] = PLAIN_AMBIENT + (1 - PLAIN_AMBIENT) * (facing > 0 ? facing : 0);
	}
}

/* gz_shading_plateau_light() */
static inline void plateau_light_loop(const struct gz_shading_vectors *normals,
				      const struct gz_shading_vectors *viewer, size_t count,
				      float *out_values)
{
	const struct gz_shading_vectors n = *normals, v = *viewer;
	float *restrict values = out_values;
	for (size_t i = 0; i < count; i++) {
		const float facing = v.x[i] * n.x[i] + v.y[i] * n.y[i] + v.z[i] * n.z[i];
		values[i] = facing > 0 ? facing : 0;
	}
}

/* Add w (1/2 + 1/2 clamp(a l'.n)), where l' is the light in the tangent plane of the smoother
 * normal. */
static inline void add_grazing_level(const struct gz_shading_vectors *level, size_t count,
				     const struct gz_grazing_light *grazing, float weight,
				     float *restrict values)
{
	const struct gz_shading_vectors n = level[0], smooth = level[1];
	const float lx = grazing->light[0], ly = grazing->light[1], lz = grazing->light[2];
	const float exaggeration = grazing->exaggeration;
	for (size_t i = 0; i < count; i++) {
		const float sx = smooth.x[i], sy = smooth.y[i], sz = smooth.z[i];
		const float along = lx * sx + ly * sy + lz * sz;
		const float px = lx - sx * along, py = ly - sy * along, pz = lz - sz * along;
		const float length2 = px * px + py * py + pz * pz;
		const float dot = px * n.x[i] + py * n.y[i] + pz * n.z[i];
		const float cosine = length2 > GZ_SHADING_GRAZES_NOT ? dot / sqrtf(length2) : 0;
		values[i] += weight * (0.5F + 0.5F * clamp_between(exaggeration * cosine, -1, 1));
	}
}

/* gz_shading_grazing_light() */
static inline void grazing_light_loop(const struct gz_shading_vectors *normals, size_t count,
				      const struct gz_grazing_light *grazing, float *out_values)
{
	for (size_t i = 0; i < count; i++)
		out_values[i] = 0;
	for (int level = 0; level + 1 < grazing->levels; level++)
		add_grazing_level(&normals[level], count, grazing, grazing->weights[level],
				  out_values);
}

/* gz_shading_surface_shape() */
static inline void surface_shape_loop(const float *greatest, const float *least, size_t count,
				      float scale, float *out_values)
{
	float *restrict values = out_values;
	for (size_t i = 0; i < count; i++)
		values[i] = 0.5F + 0.5F * (greatest[i] + least[i]) /
					   (fabsf(greatest[i]) + fabsf(least[i]) + scale);
}

/* gz_shading_curvature_magnitude() */
static inline void curvature_magnitude_loop(const float *greatest, const float *least, size_t count,
					    float scale, float *out_values)
{
	float *restrict values = out_values;
	for (size_t i = 0; i < count; i++) {
		const float square = greatest[i] * greatest[i] + least[i] * least[i];
		values[i] = scale / (sqrtf(0.5F * square) + scale);
	}
}

/* gz_shading_mean() */
static inline void mean_loop(const struct gz_weighted_parameter *parameters, size_t parameter_count,
			     size_t count, float *out_values)
{
	float sum = 0, *restrict values = out_values;
	for (size_t k = 0; k < parameter_count; k++)
		sum += parameters[k].weight;
	for (size_t i = 0; i < count; i++)
		values[i] = sum > 0 ? 0 : 1;
	for (size_t k = 0; k < parameter_count; k++) {
		const float *restrict from = parameters[k].values;
		const float share = sum > 0 ? parameters[k].weight / sum : 0;
		for (size_t i = 0; share > 0 && i < count; i++)
			values[i] += share * from[i];
	}
}

/* gz_shading_unimportance() */
static inline void unimportance_loop(const uint32_t *ids, size_t count, const float *importances,
				     size_t objects, float *out_values)
{
	for (size_t i = 0; i < count; i++)
		out_values[i] = ids[i] > 0 && ids[i] <= objects ? 1 - importances[ids[i] - 1] : 1;
}

/* gz_shading_viewer_distance() */
static inline void viewer_distance_loop(const float *depth, size_t count, float near, float far,
					float *out_values)
{
	float *restrict values = out_values;
	const float scale = 1 / (far - near);
	for (size_t i = 0; i < count; i++) {
		const float share = (depth[i] - near) * scale;
		const float low = share < 0 ? 0 : share;
		values[i] = low < 1 ? low : 1; /* NaN becomes 1 */
	}
}

/* gz_shading_object_distance() */
static inline void object_distance_loop(const float *distances_mm, size_t count, float most_mm,
					float *out_values)
{
	viewer_distance_loop(distances_mm, count, 0, most_mm, out_values);
}

/* gz_shading_haze() */
static inline void haze_loop(const float *depth, size_t count, const struct gz_haze_table *table,
			     float *out_values)
{
	for (size_t i = 0; i < count; i++) {
		const float at = clamp_between(depth[i], 0, 1) * GZ_HAZE_TABLE_SIZE;
		const int cell = at < GZ_HAZE_TABLE_SIZE ? (int)at : GZ_HAZE_TABLE_SIZE - 1;
		const float low = table->values[cell], high = table->values[cell + 1];
		out_values[i] = low + (at - (float)cell) * (high - low);
	}
}

#endif
