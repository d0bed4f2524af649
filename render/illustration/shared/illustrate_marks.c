#include "render/illustration/shared/illustrate_marks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "render/illustration/shared/illustrate_scene.h"

/* Points of all objects together, shared out by area: this many, or twice, four times ... as many,
 * for pictures of so many pixels. Chosen: 320 000 for a screen of 1920 x 1080, of which a tenth
 * shows, and which are spread in a second. */
#define POINTS_IN_ALL_LEAST 20000
#define POINTS_IN_ALL_MOST  1280000
#define PIXELS_PER_POINT    6.5
/* Points whose distance strokes have, of those. Chosen: tracing takes three times as long. */
#define STROKES_PER_POINT 0.5
/* Several objects hide parts of each other, so that the marks of what is seen are few. They have
 * more points, by the area of all for the area of the box around them, up to so many times. Chosen:
 * the 116 regions of an atlas have four times as many. */
#define CROWD_MOST 4.0
/* Fewest points of an object. Chosen: a small one has a tone, too. */
#define POINTS_LEAST 500

enum gz_illustration_drawing gz_illustrate_item_asks(const struct gz_illustrate_item *item,
						     const struct gz_illustration_look *look)
{
	return gz_illustration_look_drawing(look, item->said_drawing);
}

static unsigned made_for(const struct gz_illustrate_marks *marks, enum gz_illustration_drawing kind)
{
	return kind == GZ_DRAWING_STIPPLES ? marks->points_for : marks->strokes_for;
}

enum gz_illustration_drawing gz_illustrate_item_drawn(const struct gz_illustrate_item *item,
						      const struct gz_illustration_look *look)
{
	const enum gz_illustration_drawing kind = gz_illustrate_item_asks(item, look);
	return kind != GZ_DRAWING_GREY && made_for(&item->marks, kind) > 0 ? kind : GZ_DRAWING_GREY;
}

enum gz_hatch_direction gz_illustrate_item_direction(const struct gz_illustrate_item *item,
						     const struct gz_illustration_look *look)
{
	return item->said_direction > 0 ? (enum gz_hatch_direction)(item->said_direction - 1)
					: (enum gz_hatch_direction)look->hatch_direction;
}

static double area_of_mesh(const struct gz_mesh *mesh)
{
	double area = 0;
	for (size_t i = 0; i < mesh->triangle_count; i++) {
		const uint32_t *corners = mesh->triangles[i];
		double side[2][3], normal[3];
		for (int k = 0; k < 2; k++)
			for (int axis = 0; axis < 3; axis++)
				side[k][axis] = (double)mesh->positions[corners[k + 1]][axis] -
						(double)mesh->positions[corners[0]][axis];
		gz_cross3(side[0], side[1], normal);
		area += 0.5 * sqrt(gz_dot3(normal, normal));
	}
	return area;
}

/* Points of all objects that suit a picture. */
static unsigned points_for(const struct gz_plan *plan)
{
	const double wanted = (double)plan->width * plan->height / PIXELS_PER_POINT;
	unsigned count = POINTS_IN_ALL_LEAST;
	while (count < POINTS_IN_ALL_MOST && count < wanted)
		count *= 2;
	return count;
}

static bool item_lacks_marks(const struct gz_illustrate_item *item,
			     const struct gz_illustration_look *look, unsigned in_all)
{
	const enum gz_illustration_drawing kind = gz_illustrate_item_asks(item, look);
	return kind != GZ_DRAWING_GREY && made_for(&item->marks, kind) < in_all;
}

static bool any_lacks_marks(const struct gz_illustrate_scene *scene,
			    const struct gz_illustration_look *look, unsigned in_all)
{
	for (size_t i = 0; i < scene->count; i++)
		if (item_lacks_marks(&scene->items[i], look, in_all))
			return true;
	return false;
}

/* ---- orders ---- */

/* The curvatures of an object's vertices, as shares of its scale. */
static struct gz_curvature *copy_curvatures(const struct gz_illustrate_item *item, size_t count)
{
	struct gz_curvature *curvatures = malloc((count + 1) * sizeof *curvatures);
	for (size_t i = 0; i < count && curvatures; i++) {
		curvatures[i].greatest = item->vertices[i].greatest;
		curvatures[i].least = item->vertices[i].least;
		memcpy(curvatures[i].along, item->along[i], sizeof curvatures[i].along);
	}
	return curvatures;
}

/* Write down what is to be made of an object. What was written is freed with the order. */
static enum gz_result fill_task(const struct gz_illustrate_scene *scene, size_t index,
				struct gz_marks_task *task)
{
	const struct gz_illustrate_item *item = &scene->items[index];
	const struct gz_object *object = &scene->meshes.items[index].object;
	const struct gz_mesh *mesh = &scene->meshes.shown[index];
	char name[GZ_ILLUSTRATE_KEPT_SIZE];
	gz_illustrate_kept_name(object, "", name);
	name[strlen(name) - 1] = '\0'; /* the dot */
	task->item = index;
	task->keeps = item->keeps;
	task->name = strdup(name);
	task->input = object->mesh && object->input ? strdup(object->input) : NULL;
	if (!task->name || (object->mesh && object->input && !task->input))
		return GZ_ERR_NO_MEM;
	if (task->kind == GZ_DRAWING_HATCHES) {
		task->curvatures = copy_curvatures(item, mesh->vertex_count);
		if (!task->curvatures)
			return GZ_ERR_NO_MEM;
	}
	if (scene->waits_for_marks) {
		task->mesh = *mesh;
		return GZ_OK;
	}
	return gz_mesh_copy(mesh, &task->mesh);
}

/* The area of the box around all objects. */
static double area_around(const struct gz_illustrate_scene *scene)
{
	float least[3] = { INFINITY, INFINITY, INFINITY };
	float greatest[3] = { -INFINITY, -INFINITY, -INFINITY };
	double edge[3];
	for (size_t i = 0; i < scene->count; i++) {
		const struct gz_mesh *mesh = &scene->meshes.shown[i];
		for (size_t k = 0; k < mesh->vertex_count; k++)
			for (int axis = 0; axis < 3; axis++) {
				const float at = mesh->positions[k][axis];
				least[axis] = fminf(least[axis], at);
				greatest[axis] = fmaxf(greatest[axis], at);
			}
	}
	for (int axis = 0; axis < 3; axis++)
		edge[axis] = fmax(0, (double)greatest[axis] - (double)least[axis]);
	return 2 * (edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0]);
}

/* How many times as many points several objects have as one. */
static double crowd_of(const struct gz_illustrate_scene *scene, double area)
{
	const double around = scene->count > 1 ? area_around(scene) : 0;
	return around > 0 ? fmin(fmax(area / around, 1), CROWD_MOST) : 1;
}

/* How many points each task has: by its share of the area of all objects. */
static enum gz_result share_points(const struct gz_illustrate_scene *scene,
				   struct gz_marks_order *order)
{
	double *areas = calloc(scene->count, sizeof *areas), area = 0;
	if (!areas)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < scene->count; i++) {
		areas[i] = area_of_mesh(&scene->meshes.shown[i]);
		area += areas[i];
	}
	const double in_all = order->in_all * crowd_of(scene, area);
	for (size_t i = 0; i < order->count; i++) {
		struct gz_marks_task *task = &order->tasks[i];
		const double part = area > 0 ? areas[task->item] / area : 0;
		const double share = task->kind == GZ_DRAWING_STIPPLES ? 1 : STROKES_PER_POINT;
		task->points = (size_t)fmax(POINTS_LEAST, in_all * share * part);
	}
	free(areas);
	return GZ_OK;
}

static enum gz_result write_order(const struct gz_illustrate_scene *scene,
				  const struct gz_illustration_look *look, unsigned in_all,
				  struct gz_marks_order *order)
{
	enum gz_result result = GZ_OK;
	order->log = scene->log;
	order->in_all = in_all;
	order->owns_meshes = !scene->waits_for_marks;
	order->tasks = calloc(scene->count, sizeof *order->tasks);
	if (!order->tasks)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < scene->count && result == GZ_OK; i++) {
		if (!item_lacks_marks(&scene->items[i], look, in_all))
			continue;
		struct gz_marks_task *task = &order->tasks[order->count++];
		task->kind = gz_illustrate_item_asks(&scene->items[i], look);
		result = fill_task(scene, i, task);
	}
	return result == GZ_OK ? share_points(scene, order) : result;
}

/* Move what was made to the objects. */
static void take_marks(struct gz_illustrate_scene *scene, struct gz_marks_order *order)
{
	for (size_t i = 0; i < order->count; i++) {
		struct gz_marks_task *task = &order->tasks[i];
		struct gz_illustrate_marks *marks = &scene->items[task->item].marks;
		if (made_for(&task->made, task->kind) == 0)
			continue;
		if (task->kind == GZ_DRAWING_STIPPLES) {
			gz_stipple_points_free(&marks->points);
			marks->points = task->made.points;
			marks->points_for = task->made.points_for;
			task->made.points = (struct gz_stipple_points) { 0 };
			continue;
		}
		for (int k = 0; k < GZ_HATCH_DIRECTIONS; k++) {
			gz_hatch_strokes_free(&marks->strokes[k]);
			marks->strokes[k] = task->made.strokes[k];
			task->made.strokes[k] = (struct gz_hatch_strokes) { 0 };
		}
		marks->strokes_for = task->made.strokes_for;
	}
}

static enum gz_result make_now(struct gz_illustrate_scene *scene, struct gz_marks_order *order,
			       struct gz_workers *workers, bool *out_new)
{
	const enum gz_result result = gz_marks_order_make(order, workers);
	if (result == GZ_OK) {
		take_marks(scene, order);
		*out_new = true;
	}
	return result;
}

/* Take what a thread has made, if it is done. Meshes that have changed since have no use for it. */
static enum gz_result take_when_done(struct gz_illustrate_scene *scene, bool *out_new)
{
	struct gz_marks_order order = { 0 };
	if (!scene->maker)
		return GZ_OK;
	const bool wanted = scene->maker_for == scene->meshes_made;
	if (!wanted)
		gz_marks_maker_stop(scene->maker);
	if (!gz_marks_maker_done(scene->maker))
		return GZ_OK;
	enum gz_result result = gz_marks_maker_end(&scene->maker, &order);
	if (result == GZ_OK && wanted) {
		take_marks(scene, &order);
		*out_new = true;
	}
	gz_marks_order_free(&order);
	return wanted ? result : GZ_OK;
}

enum gz_result gz_illustrate_marks_make(struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					struct gz_workers *workers, bool *out_new)
{
	const unsigned in_all = points_for(shot->plan);
	if (shot->plan->width < 1) /* it asks only what is at a place */
		return GZ_OK;
	enum gz_result result = take_when_done(scene, out_new);
	scene->marks_coming = false;
	if (result != GZ_OK || !any_lacks_marks(scene, shot->look, in_all))
		return result;
	scene->marks_coming = !scene->waits_for_marks;
	if (scene->maker)
		return GZ_OK;
	struct gz_marks_order order = { 0 };
	result = write_order(scene, shot->look, in_all, &order);
	if (result == GZ_OK && scene->waits_for_marks) {
		result = make_now(scene, &order, workers, out_new);
	} else if (result == GZ_OK) {
		scene->maker_for = scene->meshes_made;
		result = gz_marks_maker_start(&order, gz_workers_count(workers), &scene->maker);
	}
	gz_marks_order_free(&order);
	return result;
}
