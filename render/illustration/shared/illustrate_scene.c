#include "render/illustration/shared/illustrate_scene.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/illustration/shading_vertices.h"
#include "render/mesh/distance/mesh_distance.h"
#include "render/mesh/mesh_read.h"

#define GZ_LOG_MODULE "illustration"

/* Most of an object's name that the name of its kept file holds. */
enum { KEPT_NAME_MAX = 48 };

/* Free what is known of items that are not shown any more. */
static void free_items(struct gz_illustrate_item *items, size_t count)
{
	for (size_t i = 0; items && i < count; i++) {
		free(items[i].vertices);
		free(items[i].along);
		gz_illustrate_marks_free(&items[i].marks);
	}
	free(items);
}

static void free_lists(struct gz_illustrate_scene *scene)
{
	free(scene->listed);
	free(scene->importances);
	free(scene->opacities);
	free(scene->looks);
	free(scene->templates);
	scene->listed = NULL;
	scene->importances = scene->opacities = NULL;
	scene->looks = NULL;
	scene->templates = NULL;
	scene->id_count = scene->template_count = 0;
}

static const struct gz_object_style *style_of(const struct gz_object *object)
{
	return object->style ? object->style : &gz_object_style_plain;
}

static bool is_share(double value)
{
	return value >= 0 && value <= 1;
}

static enum gz_result check_illustrated(const struct gz_object *objects, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		const struct gz_object_style *style = style_of(&objects[i]);
		if (objects[i].id < 1 || objects[i].id > GZ_ILLUSTRATE_ID_MAX ||
		    !is_share(style->importance) || !is_share(style->transparency) ||
		    !gz_illustration_said(style->drawing, style->hatch_direction))
			return GZ_ERR_INVAL;
	}
	return count > 0 ? GZ_OK : GZ_ERR_INVAL;
}

static size_t greatest_id(const struct gz_object *objects, size_t count)
{
	size_t greatest = 1;
	for (size_t i = 0; i < count; i++)
		greatest = objects[i].id > greatest ? objects[i].id : greatest;
	return greatest;
}

/* The number of a template in the list, to which it is added if it is new. */
static unsigned number_of_template(struct gz_illustrate_scene *lists,
				   const struct gz_shading_template *wanted)
{
	for (size_t i = 0; i < lists->template_count; i++)
		if (lists->templates[i].said == wanted)
			return (unsigned)i;
	lists->templates[lists->template_count].said = wanted;
	return (unsigned)lists->template_count++;
}

/* Make the lists by object, and note in the items what is said of them. */
static enum gz_result make_lists(const struct gz_object *objects, size_t count,
				 struct gz_illustrate_item *items,
				 struct gz_illustrate_scene *lists)
{
	const size_t ids = greatest_id(objects, count);
	lists->listed = calloc(count, sizeof *lists->listed);
	lists->importances = calloc(ids, sizeof *lists->importances);
	lists->opacities = calloc(ids, sizeof *lists->opacities);
	lists->looks = calloc(ids, sizeof *lists->looks);
	lists->templates = calloc(count + 1, sizeof *lists->templates);
	if (!lists->listed || !lists->importances || !lists->opacities || !lists->looks ||
	    !lists->templates)
		return GZ_ERR_NO_MEM;
	lists->id_count = ids;
	lists->template_count = 1;
	for (size_t i = 0; i < ids; i++)
		lists->opacities[i] = 1;
	for (size_t i = 0; i < count; i++) {
		const struct gz_object_style *style = style_of(&objects[i]);
		const size_t place = objects[i].id - 1;
		items[i].look = number_of_template(lists, objects[i].shading_template);
		items[i].opacity = (float)(1 - style->transparency);
		items[i].said_drawing = style->drawing;
		items[i].said_direction = style->hatch_direction;
		lists->importances[place] = (float)style->importance;
		lists->opacities[place] = items[i].opacity;
		lists->looks[place] = items[i].look;
		lists->transparent = lists->transparent || items[i].opacity < 1;
	}
	return GZ_OK;
}

static bool key_is_of(const struct gz_illustrate_key *key, const struct gz_object *object)
{
	return key->known && key->volume == object->volume && key->mesh == object->mesh &&
	       key->revision == object->data_revision;
}

/* Take over what is known of the objects that were shown before. Returns whether all stay where
 * they are. */
static bool take_known(struct gz_illustrate_scene *scene, const struct gz_object *objects,
		       struct gz_illustrate_item *items, size_t count)
{
	bool same = count == scene->count;
	for (size_t i = 0; i < count; i++) {
		size_t old =
			i < scene->count && key_is_of(&scene->items[i].key, &objects[i]) ? i : 0;
		while (old < scene->count && !key_is_of(&scene->items[old].key, &objects[i]))
			old++;
		same = same && old == i;
		if (old == scene->count)
			continue;
		struct gz_illustrate_item *from = &scene->items[old];
		items[i].key = from->key;
		items[i].vertices = from->vertices;
		items[i].along = from->along;
		items[i].marks = from->marks;
		items[i].keeps = from->keeps;
		from->key.known = false;
		from->vertices = NULL;
		from->along = NULL;
		from->marks = (struct gz_illustrate_marks) { 0 };
	}
	return same;
}

enum gz_result gz_illustrate_scene_show(struct gz_illustrate_scene *scene,
					const struct gz_object *objects, size_t count)
{
	struct gz_illustrate_scene lists = { 0 };
	enum gz_result result = check_illustrated(objects, count);
	if (result != GZ_OK)
		return result;
	struct gz_illustrate_item *items = calloc(count, sizeof *items);
	result = items ? make_lists(objects, count, items, &lists) : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_surface_meshes_show(&scene->meshes, objects, count);
	if (result != GZ_OK) {
		free(items);
		free_lists(&lists);
		return result;
	}
	const bool same = take_known(scene, objects, items, count);
	free_items(scene->items, scene->count);
	free_lists(scene);
	scene->items = items;
	scene->count = count;
	scene->listed = lists.listed;
	scene->importances = lists.importances;
	scene->opacities = lists.opacities;
	scene->looks = lists.looks;
	scene->id_count = lists.id_count;
	scene->templates = lists.templates;
	scene->template_count = lists.template_count;
	scene->transparent = lists.transparent;
	scene->built = scene->built && same;
	scene->measured_id = same ? scene->measured_id : 0;
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

static struct gz_illustrate_key key_of(const struct gz_illustrate_scene *scene, size_t index)
{
	const struct gz_surface_item *item = &scene->meshes.items[index];
	return (struct gz_illustrate_key) {
		.known = true,
		.volume = item->object.volume,
		.mesh = item->object.mesh,
		.revision = item->object.data_revision,
		.isovalue = item->object.mesh ? 0 : item->isovalue,
	};
}

static bool is_same_key(const struct gz_illustrate_key *a, const struct gz_illustrate_key *b)
{
	return a->known == b->known && a->volume == b->volume && a->mesh == b->mesh &&
	       a->revision == b->revision && a->isovalue == b->isovalue;
}

void gz_illustrate_kept_name(const struct gz_object *object, const char *what,
			     char out_ending[GZ_ILLUSTRATE_KEPT_SIZE])
{
	if (!object->name || !object->name[0]) {
		snprintf(out_ending, GZ_ILLUSTRATE_KEPT_SIZE, "%u.%s", (unsigned)object->id, what);
		return;
	}
	snprintf(out_ending, GZ_ILLUSTRATE_KEPT_SIZE, "%.*s.%s", KEPT_NAME_MAX, object->name, what);
	for (size_t i = 0; out_ending[i]; i++)
		if (!isalnum((unsigned char)out_ending[i]) && !strchr("._-", out_ending[i]))
			out_ending[i] = '_';
}

static void forget_item(struct gz_illustrate_item *item)
{
	free(item->vertices);
	free(item->along);
	item->vertices = NULL;
	item->along = NULL;
	gz_illustrate_marks_free(&item->marks);
	item->key.known = false;
}

/* Make the vertices of an object. What is made of meshes of files is kept, each of one input in a
 * file of its own. Of volumes only the surfaces of the first picture are: while an isovalue moves,
 * there is one for each, and few of them come again. Those files are the user's alone. */
static enum gz_result prepare_item(struct gz_illustrate_scene *scene, size_t index,
				   struct gz_workers *workers)
{
	struct gz_illustrate_item *item = &scene->items[index];
	const struct gz_object *object = &scene->meshes.items[index].object;
	char ending[GZ_ILLUSTRATE_KEPT_SIZE];
	gz_illustrate_kept_name(object, "shading", ending);
	const struct gz_mesh_cache_place place = { object->mesh ? object->input : NULL, ending };
	struct gz_shading_vertices vertices;
	forget_item(item);
	item->keeps = object->mesh ? object->input != NULL : scene->meshes_made == 0;
	enum gz_result result =
		gz_shading_vertices_make(&scene->meshes.shown[index], item->keeps ? &place : NULL,
					 workers, scene->log, &vertices);
	if (result != GZ_OK)
		return result;
	result = pack_vertices(&vertices, &item->vertices);
	item->along = vertices.along;
	vertices.along = NULL;
	gz_shading_vertices_free(&vertices);
	if (result == GZ_OK)
		item->key = key_of(scene, index);
	return result;
}

/* Make the vertices that are not known, and the ball if any of them is new. */
static enum gz_result prepare_items(struct gz_illustrate_scene *scene, struct gz_workers *workers)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < scene->count && result == GZ_OK; i++) {
		const struct gz_illustrate_key key = key_of(scene, i);
		if (is_same_key(&key, &scene->items[i].key))
			continue;
		scene->built = false;
		result = prepare_item(scene, i, workers);
	}
	if (result != GZ_OK || scene->built)
		return result;
	scene->measured_id = 0;
	bound_scene(scene);
	scene->made++;
	scene->meshes_made++;
	scene->built = true;
	return GZ_OK;
}

static void list_illustrated(struct gz_illustrate_scene *scene)
{
	for (size_t i = 0; i < scene->meshes.count; i++)
		scene->listed[i] = (struct gz_illustrate_mesh) {
			.triangles = (const uint32_t(*)[3])scene->meshes.shown[i].triangles,
			.vertices = scene->items[i].vertices,
			.id = scene->meshes.items[i].object.id,
			.look = scene->items[i].look,
			.transparent = scene->items[i].opacity < 1,
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

uint32_t gz_illustrate_shot_measured(const struct gz_illustrate_shot *shot)
{
	struct gz_shading_settings settings;
	gz_illustration_look_resolve(shot->look, NULL, &settings);
	return settings.object_distance > 0 ? shot->chosen_id : 0;
}

enum gz_result gz_illustrate_scene_prepare(struct gz_illustrate_scene *scene,
					   const struct gz_illustrate_shot *shot,
					   struct gz_workers *workers)
{
	bool new_meshes = false;
	if (scene->count < 1 || shot->plan->layer_count < 1 ||
	    !gz_illustration_look_valid(shot->look))
		return GZ_ERR_INVAL;
	enum gz_result result =
		gz_surface_meshes_make(&scene->meshes, shot->isovalue, workers, &new_meshes);
	if (result == GZ_OK)
		result = prepare_items(scene, workers);
	if (result != GZ_OK)
		return result;
	const uint32_t chosen_id = gz_illustrate_shot_measured(shot);
	if (chosen_id > 0 && scene->measured_id != chosen_id)
		result = measure_scene(scene, chosen_id, workers);
	list_illustrated(scene);
	bool new_marks = false;
	if (result == GZ_OK)
		result = gz_illustrate_marks_make(scene, shot, workers, &new_marks);
	scene->made += new_marks;
	return result;
}

void gz_illustrate_scene_free(struct gz_illustrate_scene *scene)
{
	if (scene->maker)
		gz_marks_maker_stop(scene->maker);
	(void)gz_marks_maker_end(&scene->maker, NULL);
	free_items(scene->items, scene->count);
	free_lists(scene);
	scene->items = NULL;
	scene->count = 0;
	gz_surface_meshes_free(&scene->meshes);
}
