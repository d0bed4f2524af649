#include "render/illustration/shading_vertices.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/mesh_curvature.h"
#include "render/mesh/mesh_mend.h"
#include "render/mesh/mesh_smooth.h"

#define GZ_LOG_MODULE "illustration"

_Static_assert(GZ_SHADING_LEVELS - 1 <= GZ_MESH_SMOOTH_LEVELS_MAX, "levels that can be made");

/* What the files hold. Another computation or another number of levels needs another text. */
static const char vertices_purpose[] = "shading vertices 1, 6 levels";

_Static_assert(GZ_SHADING_LEVELS == 6, "the purpose names the number of levels");

/* Arrays of a file, in this order. */
enum { ARRAY_NORMALS, ARRAY_ALONG, ARRAY_GREATEST, ARRAY_LEAST, ARRAY_COUNT };

static void list_arrays(const struct gz_shading_vertices *vertices,
			struct gz_mesh_cache_array out_arrays[ARRAY_COUNT])
{
	const size_t count = vertices->count;
	out_arrays[ARRAY_NORMALS] =
		(struct gz_mesh_cache_array) { (float *)vertices->normals,
					       3 * (size_t)GZ_SHADING_LEVELS * count };
	out_arrays[ARRAY_ALONG] =
		(struct gz_mesh_cache_array) { (float *)vertices->along, 3 * count };
	out_arrays[ARRAY_GREATEST] = (struct gz_mesh_cache_array) { vertices->greatest, count };
	out_arrays[ARRAY_LEAST] = (struct gz_mesh_cache_array) { vertices->least, count };
}

static bool allocate_vertices(size_t count, struct gz_shading_vertices *vertices)
{
	vertices->count = count;
	vertices->normals = calloc(GZ_SHADING_LEVELS * count + 1, sizeof *vertices->normals);
	vertices->along = calloc(count + 1, sizeof *vertices->along);
	vertices->greatest = calloc(count + 1, sizeof *vertices->greatest);
	vertices->least = calloc(count + 1, sizeof *vertices->least);
	return vertices->normals && vertices->along && vertices->greatest && vertices->least;
}

/* Fill in curvatures and normals of a mesh that is mended. */
static enum gz_result shape_vertices(const struct gz_mesh *mesh, struct gz_workers *workers,
				     struct gz_shading_vertices *vertices)
{
	struct gz_curvature *curvatures = calloc(mesh->vertex_count + 1, sizeof *curvatures);
	if (!curvatures)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_mesh_curvatures(mesh, curvatures);
	for (size_t v = 0; result == GZ_OK && v < mesh->vertex_count; v++) {
		vertices->greatest[v] = curvatures[v].greatest;
		vertices->least[v] = curvatures[v].least;
		memcpy(vertices->along[v], curvatures[v].along, sizeof curvatures[v].along);
	}
	free(curvatures);
	if (mesh->vertex_count > 0)
		memcpy(vertices->normals, mesh->normals,
		       mesh->vertex_count * sizeof *mesh->normals);
	return result == GZ_OK ? gz_mesh_smooth_normals(mesh, GZ_SHADING_LEVELS - 1, workers,
							vertices->normals + mesh->vertex_count)
			       : result;
}

/* Meshes are shared by others, so a copy is mended. */
static enum gz_result copy_and_mend(const struct gz_mesh *mesh, struct gz_mesh *out_copy)
{
	enum gz_result result = gz_mesh_copy(mesh, out_copy);
	if (result != GZ_OK)
		return result;
	result = gz_mesh_mend(out_copy, NULL);
	if (result != GZ_OK)
		gz_mesh_free(out_copy);
	return result;
}

static enum gz_result compute_vertices(const struct gz_mesh *mesh, struct gz_workers *workers,
				       struct gz_shading_vertices *vertices)
{
	struct gz_mesh copy = { 0 };
	enum gz_result result = copy_and_mend(mesh, &copy);
	if (result != GZ_OK)
		return result;
	result = shape_vertices(&copy, workers, vertices);
	gz_mesh_free(&copy);
	return result;
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* The median of the curvedness of all vertices; 1 if that is 0 or there are none. */
static enum gz_result find_scale(struct gz_shading_vertices *vertices)
{
	float *curvedness = calloc(vertices->count + 1, sizeof *curvedness);
	if (!curvedness)
		return GZ_ERR_NO_MEM;
	for (size_t v = 0; v < vertices->count; v++)
		curvedness[v] = sqrtf(0.5F * (vertices->greatest[v] * vertices->greatest[v] +
					      vertices->least[v] * vertices->least[v]));
	qsort(curvedness, vertices->count, sizeof *curvedness, compare_floats);
	const float median = curvedness[vertices->count / 2];
	vertices->curvature_scale = median > 0 && isfinite(median) ? median : 1;
	free(curvedness);
	return GZ_OK;
}

/* Read the vertices from the file of their mesh, or compute and write them. */
static enum gz_result load_or_compute(const struct gz_mesh *mesh,
				      const struct gz_mesh_cache_place *place,
				      struct gz_workers *workers, const struct gz_log *log,
				      struct gz_shading_vertices *vertices)
{
	struct gz_mesh_cache_array arrays[ARRAY_COUNT];
	struct gz_mesh_key key;
	list_arrays(vertices, arrays);
	enum gz_result result = place ? gz_mesh_key_make(mesh, vertices_purpose, &key) : GZ_OK;
	if (result != GZ_OK)
		return result;
	if (place && gz_mesh_cache_load(place, &key, arrays, ARRAY_COUNT, log) == GZ_OK)
		return GZ_OK;
	result = compute_vertices(mesh, workers, vertices);
	if (place && result == GZ_OK) /* a failure is logged, and only costs time */
		(void)gz_mesh_cache_store(place, &key, arrays, ARRAY_COUNT, log);
	return result;
}

enum gz_result gz_shading_vertices_make(const struct gz_mesh *mesh,
					const struct gz_mesh_cache_place *place,
					struct gz_workers *workers, const struct gz_log *log,
					struct gz_shading_vertices *out_vertices)
{
	struct gz_shading_vertices vertices = { 0 };
	enum gz_result result = GZ_ERR_NO_MEM;
	if (allocate_vertices(mesh->vertex_count, &vertices))
		result = load_or_compute(mesh, place, workers, log, &vertices);
	if (result == GZ_OK)
		result = find_scale(&vertices);
	if (result == GZ_OK) {
		*out_vertices = vertices;
		return GZ_OK;
	}
	gz_err(log, "%zu vertices and %zu triangles cannot be prepared for shading: %s",
	       mesh->vertex_count, mesh->triangle_count, gz_result_text(result));
	gz_shading_vertices_free(&vertices);
	return result;
}

void gz_shading_vertices_free(struct gz_shading_vertices *vertices)
{
	free(vertices->normals);
	free(vertices->along);
	free(vertices->greatest);
	free(vertices->least);
	*vertices = (struct gz_shading_vertices) { 0 };
}
