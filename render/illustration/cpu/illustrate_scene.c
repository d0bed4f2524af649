#include "render/illustration/cpu/illustrate_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "render/illustration/shading_vertices.h"
#include "render/mesh/distance/mesh_distance.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "illustration"

static void free_items(struct gz_illustrate_scene *scene, size_t count)
{
	for (size_t i = 0; scene->items && i < count; i++)
		free(scene->items[i].vertices);
	free(scene->items);
	free(scene->listed);
	free(scene->importances);
	scene->items = NULL;
	scene->listed = NULL;
	scene->importances = NULL;
	scene->importance_count = 0;
	scene->measured_id = 0;
	scene->current = false;
}

static enum gz_result check_illustrated(const struct gz_object *objects,
					const struct gz_illustrated *each, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (objects[i].id < 1 || objects[i].id > GZ_ILLUSTRATE_ID_MAX)
			return GZ_ERR_INVAL;
		if (each && !(each[i].importance >= 0 && each[i].importance <= 1))
			return GZ_ERR_INVAL;
	}
	return count > 0 ? GZ_OK : GZ_ERR_INVAL;
}

static size_t greatest_id(const struct gz_object *objects, size_t count)
{
	size_t greatest = 0;
	for (size_t i = 0; i < count; i++)
		greatest = objects[i].id > greatest ? objects[i].id : greatest;
	return greatest;
}

enum gz_result gz_illustrate_scene_show(struct gz_illustrate_scene *scene,
					const struct gz_object *objects,
					const struct gz_illustrated *each, size_t count)
{
	enum gz_result result = check_illustrated(objects, each, count);
	if (result != GZ_OK)
		return result;
	const size_t ids = greatest_id(objects, count);
	struct gz_illustrate_item *items = calloc(count, sizeof *items);
	struct gz_illustrate_mesh *listed = calloc(count, sizeof *listed);
	float *importances = calloc(ids + 1, sizeof *importances);
	const size_t old_count = scene->meshes.count;
	result = items && listed && importances ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_surface_meshes_show(&scene->meshes, objects, count);
	if (result != GZ_OK) {
		free(items);
		free(listed);
		free(importances);
		return result;
	}
	free_items(scene, old_count);
	for (size_t i = 0; i < count; i++) {
		importances[objects[i].id - 1] = each ? (float)each[i].importance : 0.5F;
		items[i].input = each ? each[i].input : NULL;
	}
	scene->items = items;
	scene->listed = listed;
	scene->importances = importances;
	scene->importance_count = ids;
	return GZ_OK;
}

/* A ball around the box of all vertices. */
static void bound_scene(struct gz_illustrate_scene *scene)
{
	double least[3] = { INFINITY, INFINITY, INFINITY };
	double greatest[3] = { -INFINITY, -INFINITY, -INFINITY }, square = 0;
	for (size_t i = 0; i < scene->meshes.count; i++)
		gz_mesh_bound(&scene->meshes.shown[i], least, greatest);
	for (int axis = 0; axis < 3; axis++) {
		const bool any = least[axis] <= greatest[axis];
		const double half = any ? (greatest[axis] - least[axis]) / 2 : 0;
		scene->centre_mm[axis] = any ? least[axis] + half : 0;
		square += half * half;
	}
	scene->radius_mm = fmax(sqrt(square), 1e-6);
}

static void pack_vertex(const struct gz_shading_vertices *vertices, size_t i,
			struct gz_illustrate_vertex *packed)
{
	for (int level = 0; level < GZ_SHADING_LEVELS; level++)
		for (int axis = 0; axis < 3; axis++)
			packed->normals[level][axis] = (int16_t)lrintf(
				GZ_ILLUSTRATE_NORMAL_STEPS *
				gz_shading_vertices_level(vertices, level)[i][axis]);
	packed->greatest = vertices->greatest[i] / vertices->curvature_scale;
	packed->least = vertices->least[i] / vertices->curvature_scale;
	packed->distance_mm = INFINITY;
}

static enum gz_result pack_vertices(const struct gz_shading_vertices *vertices,
				    struct gz_illustrate_vertex **out_packed)
{
	struct gz_illustrate_vertex *packed = malloc((vertices->count + 1) * sizeof *packed);
	if (!packed)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < vertices->count; i++)
		pack_vertex(vertices, i, &packed[i]);
	*out_packed = packed;
	return GZ_OK;
}

/* Make the vertices of an object. Objects of one input keep files of their own. */
static enum gz_result prepare_item(struct gz_illustrate_scene *scene, size_t index,
				   struct gz_workers *workers)
{
	struct gz_illustrate_item *item = &scene->items[index];
	char ending[32];
	snprintf(ending, sizeof ending, "%u.shading",
		 (unsigned)scene->meshes.items[index].object.id);
	const struct gz_mesh_cache_place place = { item->input, ending };
	struct gz_shading_vertices vertices;
	free(item->vertices);
	item->vertices = NULL;
	enum gz_result result =
		gz_shading_vertices_make(&scene->meshes.shown[index], item->input ? &place : NULL,
					 workers, scene->log, &vertices);
	if (result != GZ_OK)
		return result;
	result = pack_vertices(&vertices, &item->vertices);
	gz_shading_vertices_free(&vertices);
	return result;
}

static void list_illustrated(struct gz_illustrate_scene *scene)
{
	for (size_t i = 0; i < scene->meshes.count; i++)
		scene->listed[i] = (struct gz_illustrate_mesh) {
			.triangles = (const uint32_t(*)[3])scene->meshes.shown[i].triangles,
			.vertices = scene->items[i].vertices,
			.id = scene->meshes.items[i].object.id,
		};
}

static enum gz_result measure_item(struct gz_illustrate_scene *scene, size_t index,
				   const struct gz_mesh *chosen, struct gz_workers *workers)
{
	const struct gz_mesh *mesh = &scene->meshes.shown[index];
	struct gz_illustrate_vertex *vertices = scene->items[index].vertices;
	float *distances_mm = calloc(mesh->vertex_count + 1, sizeof *distances_mm);
	if (!distances_mm)
		return GZ_ERR_NO_MEM;
	const enum gz_result result =
		gz_mesh_distances(chosen, (const float(*)[3])mesh->positions, mesh->vertex_count,
				  workers, scene->log, distances_mm);
	for (size_t i = 0; i < mesh->vertex_count && result == GZ_OK; i++)
		vertices[i].distance_mm = distances_mm[i];
	free(distances_mm);
	return result;
}

/* Find the distance of all vertices from the chosen object. */
static enum gz_result measure_scene(struct gz_illustrate_scene *scene, uint32_t chosen_id,
				    struct gz_workers *workers)
{
	static const struct gz_mesh none = { 0 };
	const struct gz_mesh *chosen = &none;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < scene->meshes.count; i++)
		if (scene->meshes.items[i].object.id == chosen_id)
			chosen = &scene->meshes.shown[i];
	scene->measured_id = 0;
	for (size_t i = 0; i < scene->meshes.count && result == GZ_OK; i++)
		result = measure_item(scene, i, chosen, workers);
	if (result == GZ_OK)
		scene->measured_id = chosen_id;
	scene->made++;
	return result;
}

enum gz_result gz_illustrate_scene_prepare(struct gz_illustrate_scene *scene, double isovalue,
					   uint32_t chosen_id, struct gz_workers *workers)
{
	bool new_meshes = false;
	enum gz_result result =
		gz_surface_meshes_make(&scene->meshes, isovalue, workers, &new_meshes);
	scene->current = scene->current && scene->meshes.listed && !new_meshes;
	if (result != GZ_OK)
		return result;
	if (!scene->current) {
		scene->measured_id = 0;
		for (size_t i = 0; i < scene->meshes.count && result == GZ_OK; i++)
			result = prepare_item(scene, i, workers);
		if (result == GZ_OK)
			result = gz_surface_tree_build(&scene->tree, scene->meshes.shown,
						       scene->meshes.count);
		if (result != GZ_OK)
			return result;
		bound_scene(scene);
		scene->made++;
		scene->current = true;
	}
	if (chosen_id > 0 && scene->measured_id != chosen_id)
		result = measure_scene(scene, chosen_id, workers);
	list_illustrated(scene);
	return result;
}

void gz_illustrate_scene_free(struct gz_illustrate_scene *scene)
{
	free_items(scene, scene->meshes.count);
	gz_surface_meshes_free(&scene->meshes);
	gz_surface_tree_close(&scene->tree);
}
