#include "render/illustration/cached_points.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "render/illustration/kept_numbers.h"

/* Floats of a point: its triangle, across[0] and across[1]. */
enum { POINT_FLOATS = 3 };

/* What a file holds. Another way to spread points needs another number in the purpose. */
struct kept_points {
	float *points;
	float area[GZ_KEPT_DOUBLE_FLOATS];
	struct gz_mesh_cache_array arrays[2];
};

static bool allocate_kept(size_t count, struct kept_points *kept)
{
	kept->points = malloc(POINT_FLOATS * count * sizeof *kept->points);
	kept->arrays[0] = (struct gz_mesh_cache_array) { kept->points, POINT_FLOATS * count };
	kept->arrays[1] = (struct gz_mesh_cache_array) { kept->area, GZ_KEPT_DOUBLE_FLOATS };
	return kept->points != NULL;
}

static void keep_points(const struct gz_mesh_points *points, struct kept_points *kept)
{
	gz_keep_double(points->area_mm2, kept->area);
	for (size_t i = 0; i < points->count; i++) {
		float *floats = kept->points + POINT_FLOATS * i;
		floats[0] = (float)points->points[i].triangle;
		floats[1] = points->points[i].across[0];
		floats[2] = points->points[i].across[1];
	}
}

/* Whether three floats are a point of the mesh. */
static bool read_point(const struct gz_mesh *mesh, const float floats[POINT_FLOATS],
		       struct gz_mesh_point *out_point)
{
	const bool good = floats[0] >= 0 && floats[0] < (float)mesh->triangle_count &&
			  floats[1] >= 0 && floats[2] >= 0 && floats[1] + floats[2] <= 1.00001F;
	if (good)
		*out_point =
			(struct gz_mesh_point) { (uint32_t)floats[0], { floats[1], floats[2] } };
	return good;
}

static bool read_kept(const struct gz_mesh *mesh, size_t count, const struct kept_points *kept,
		      struct gz_mesh_points *out_points)
{
	struct gz_mesh_points points = { .count = count, .area_mm2 = gz_kept_double(kept->area) };
	bool good = true;
	points.points = malloc(count * sizeof *points.points);
	if (!points.points)
		return false;
	for (size_t i = 0; i < count && good; i++)
		good = read_point(mesh, kept->points + POINT_FLOATS * i, &points.points[i]);
	if (good)
		*out_points = points;
	else
		gz_mesh_points_free(&points);
	return good;
}

enum gz_result gz_cached_points_make(const struct gz_mesh *mesh, size_t count,
				     const struct gz_mesh_cache_place *place,
				     struct gz_workers *workers, const atomic_bool *stop,
				     const struct gz_log *log, struct gz_mesh_points *out_points)
{
	struct kept_points kept = { 0 };
	struct gz_mesh_key key;
	char purpose[64];
	snprintf(purpose, sizeof purpose, "mesh points 1, %zu", count);
	const bool keeps = place && count > 0 && count <= GZ_MESH_POINTS_MAX &&
			   mesh->triangle_count <= GZ_KEPT_WHOLE_MAX &&
			   allocate_kept(count, &kept) &&
			   gz_mesh_key_make(mesh, purpose, &key) == GZ_OK;
	enum gz_result result = GZ_OK;
	if (!keeps || gz_mesh_cache_load(place, &key, kept.arrays, 2, log) != GZ_OK ||
	    !read_kept(mesh, count, &kept, out_points)) {
		result = gz_mesh_points_make(mesh, count, workers, stop, out_points);
		if (keeps && result == GZ_OK && out_points->count == count) {
			keep_points(out_points, &kept);
			/* a failure is logged, and only costs time */
			(void)gz_mesh_cache_store(place, &key, kept.arrays, 2, log);
		}
	}
	free(kept.points);
	return result;
}
