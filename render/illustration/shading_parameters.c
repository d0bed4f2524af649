#include "render/illustration/shading_parameters.h"

#include <math.h>

#include "render/illustration/shading_parameter_loops.h"

void gz_shading_main_light(const struct gz_shading_vectors *normals, size_t count,
			   const float light[3], float *out_values)
{
	main_light_loop(normals, count, light, out_values);
}

void gz_shading_plain_light(const struct gz_shading_vectors *normals, size_t count,
			    const float light[3], float *out_values)
{
	plain_light_loop(normals, count, light, out_values);
}

void gz_shading_plateau_light(const struct gz_shading_vectors *normals,
			      const struct gz_shading_vectors *viewer, size_t count,
			      float *out_values)
{
	plateau_light_loop(normals, viewer, count, out_values);
}

void gz_grazing_weights(int levels, double frequency, float *out_weights)
{
	const double ratio = exp2(2 * (1 - 2 * frequency));
	double sum = 0, weight = 1;
	for (int i = 0; i + 1 < levels; i++, weight *= ratio)
		sum += weight;
	weight = 1;
	for (int i = 0; i + 1 < levels; i++, weight *= ratio)
		out_weights[i] = (float)(weight / sum);
}

void gz_shading_grazing_light(const struct gz_shading_vectors *normals, size_t count,
			      const struct gz_grazing_light *grazing, float *out_values)
{
	grazing_light_loop(normals, count, grazing, out_values);
}

void gz_shading_surface_shape(const float *greatest, const float *least, size_t count, float scale,
			      float *out_values)
{
	surface_shape_loop(greatest, least, count, scale, out_values);
}

void gz_shading_curvature_magnitude(const float *greatest, const float *least, size_t count,
				    float scale, float *out_values)
{
	curvature_magnitude_loop(greatest, least, count, scale, out_values);
}

void gz_shading_mean(const struct gz_weighted_parameter *parameters, size_t parameter_count,
		     size_t count, float *out_values)
{
	mean_loop(parameters, parameter_count, count, out_values);
}

void gz_shading_unimportance(const uint32_t *ids, size_t count, const float *importances,
			     size_t objects, float *out_values)
{
	unimportance_loop(ids, count, importances, objects, out_values);
}

void gz_shading_viewer_distance(const float *depth, size_t count, float near, float far,
				float *out_values)
{
	viewer_distance_loop(depth, count, near, far, out_values);
}

void gz_shading_object_distance(const float *distances_mm, size_t count, float most_mm,
				float *out_values)
{
	object_distance_loop(distances_mm, count, most_mm, out_values);
}

void gz_haze_table_make(double near, double far, double exponent, struct gz_haze_table *out_table)
{
	for (int i = 0; i <= GZ_HAZE_TABLE_SIZE; i++) {
		const double depth = (double)i / GZ_HAZE_TABLE_SIZE;
		double share = depth > near ? 1 : 0;
		if (far > near)
			share = fmin(fmax((depth - near) / (far - near), 0), 1);
		out_table->values[i] = (float)pow(share, exponent);
	}
}

void gz_shading_haze(const float *depth, size_t count, const struct gz_haze_table *table,
		     float *out_values)
{
	haze_loop(depth, count, table, out_values);
}
