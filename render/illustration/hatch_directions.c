#include "render/illustration/hatch_strokes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PASSES_MAX = 1000 };

static float dot_of(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross_of(const float a[3], const float b[3], float out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

void gz_hatch_cross_directions(const struct gz_mesh *mesh, const float (*directions)[3],
			       float (*out_directions)[3])
{
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		float across[3];
		cross_of(mesh->normals[i], directions[i], across);
		memcpy(out_directions[i], across, sizeof across);
	}
}

/* The direction of the least curvature, as long as the curvatures differ: 0 on a ball, 1 on a
 * tube. */
static void start_direction(const struct gz_curvature *curvature, const float normal[3],
			    float out[3])
{
	const float sum = fabsf(curvature->greatest) + fabsf(curvature->least);
	const float differ = curvature->greatest - curvature->least;
	const float weight = sum > 0 ? differ / sum : 0;
	cross_of(normal, curvature->along, out);
	for (int axis = 0; axis < 3; axis++)
		out[axis] = isfinite(weight * out[axis]) ? weight * out[axis] : 0;
}

/* Adds to a sum of directions one of them, turned round if it points the other way. */
static void add_direction(const float from[3], const float like[3], float sum[3])
{
	const float sign = dot_of(from, like) < 0 ? -1 : 1;
	for (int axis = 0; axis < 3; axis++)
		sum[axis] += sign * from[axis];
}

/* Puts a direction into the plane across a normal, no longer than 1. Steps make strong directions
 * stronger, so that they win over those of flat places. */
static void settle_direction(const float normal[3], float direction[3])
{
	const float up = dot_of(direction, normal);
	for (int axis = 0; axis < 3; axis++)
		direction[axis] -= up * normal[axis];
	const float length = sqrtf(dot_of(direction, direction));
	for (int axis = 0; axis < 3 && length > 1; axis++)
		direction[axis] /= length;
}

/* One step: each direction becomes the sum of its own and its neighbours', over triangles. */
static void spread_directions(const struct gz_mesh *mesh, const float (*from)[3], float (*to)[3])
{
	memcpy(to, from, mesh->vertex_count * sizeof *to);
	for (size_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *corners = mesh->triangles[i];
		for (int corner = 0; corner < 3; corner++) {
			const uint32_t own = corners[corner];
			for (int other = 1; other < 3; other++) {
				const float *neighbour = from[corners[(corner + other) % 3]];
				const float *like =
					dot_of(to[own], to[own]) > 0 ? to[own] : neighbour;
				float added[3] = { 0 };
				add_direction(neighbour, like, added);
				for (int axis = 0; axis < 3; axis++)
					to[own][axis] += added[axis] / 4;
			}
		}
	}
	for (size_t i = 0; i < mesh->vertex_count; i++)
		settle_direction(mesh->normals[i], to[i]);
}

enum gz_result gz_hatch_directions(const struct gz_mesh *mesh,
				   const struct gz_curvature *curvatures, int passes,
				   float (*out_directions)[3])
{
	if (passes < 0 || passes > PASSES_MAX)
		return GZ_ERR_INVAL;
	if (mesh->vertex_count == 0)
		return GZ_OK;
	float(*now)[3] = malloc(mesh->vertex_count * sizeof *now);
	float(*next)[3] = malloc(mesh->vertex_count * sizeof *next);
	if (!now || !next) {
		free(now);
		free(next);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < mesh->vertex_count; i++)
		start_direction(&curvatures[i], mesh->normals[i], now[i]);
	for (int pass = 0; pass < passes; pass++) {
		spread_directions(mesh, (const float(*)[3])now, next);
		float(*swap)[3] = now;
		now = next;
		next = swap;
	}
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		const float length = sqrtf(dot_of(now[i], now[i]));
		for (int axis = 0; axis < 3; axis++)
			out_directions[i][axis] = length > 1e-6F ? now[i][axis] / length : 0;
	}
	free(now);
	free(next);
	return GZ_OK;
}
