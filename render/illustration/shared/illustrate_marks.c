#include "render/illustration/shared/illustrate_marks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "render/illustration/cached_points.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/mesh/mesh_curvature.h"

#define GZ_LOG_MODULE "illustration"

/* Points of all objects together, shared out by area: this many, or twice, four times ... as many,
 * for pictures of so many pixels. Chosen: 320 000 for a screen of 1920 x 1080, of which a tenth
 * shows, and which are spread in a second. */
#define POINTS_IN_ALL_LEAST 20000
#define POINTS_IN_ALL_MOST  1280000
#define PIXELS_PER_POINT    6.5
/* Points whose distance strokes have, of those. Chosen: tracing takes three times as long. */
#define STROKES_PER_POINT 0.5
/* Fewest points of an object. Chosen: a small one has a tone, too. */
#define POINTS_LEAST 500

/* Distance of strokes in that of as many points. Measured: their densest tone is then as dark as
 * the map asks for. */
#define STROKE_DISTANCE 0.8
/* How far directions spread, in edges. Chosen by eye, on a skull. */
#define DIRECTION_PASSES 60

void gz_illustrate_marks_free(struct gz_illustrate_marks *marks)
{
	gz_stipple_points_free(&marks->points);
	for (int i = 0; i < GZ_HATCH_DIRECTIONS; i++)
		gz_hatch_strokes_free(&marks->strokes[i]);
	*marks = (struct gz_illustrate_marks) { 0 };
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

/* Directions of the vertices of a mesh. */
struct mesh_directions {
	float (*vertices)[3];
};

/* What making marks needs, for the workers. */
struct making_marks {
	struct gz_illustrate_scene *scene;
	struct gz_workers *workers;
	unsigned in_all; /* points of all objects */
	double *areas;   /* of the meshes, mm² */
	double area;     /* of all */
	/* While strokes are made: */
	struct gz_mesh_points *points;
	struct mesh_directions *directions; /* of each mesh */
	enum gz_result *results;            /* of each mesh and direction */
};

/* Points of all objects that suit a picture. */
static unsigned points_for(const struct gz_plan *plan)
{
	const double wanted = (double)plan->width * plan->height / PIXELS_PER_POINT;
	unsigned count = POINTS_IN_ALL_LEAST;
	while (count < POINTS_IN_ALL_MOST && count < wanted)
		count *= 2;
	return count;
}

static size_t points_of_item(const struct making_marks *making, size_t index, double share)
{
	const double part = making->area > 0 ? making->areas[index] / making->area : 0;
	return (size_t)fmax(POINTS_LEAST, making->in_all * share * part);
}

/* The points of an object's mesh. */
static enum gz_result spread_points(const struct making_marks *making, size_t index, double share,
				    struct gz_mesh_points *out_points)
{
	const size_t count = points_of_item(making, index, share);
	const struct gz_object *object = &making->scene->meshes.items[index].object;
	char what[GZ_ILLUSTRATE_WHAT_SIZE], ending[GZ_ILLUSTRATE_KEPT_SIZE];
	snprintf(what, sizeof what, "%zu.points", count);
	gz_illustrate_kept_name(object, what, ending);
	const struct gz_mesh_cache_place place = { object->input, ending };
	return gz_cached_points_make(&making->scene->meshes.shown[index], count,
				     object->mesh && object->input ? &place : NULL, making->workers,
				     making->scene->log, out_points);
}

static enum gz_result make_points(const struct making_marks *making, size_t index)
{
	struct gz_illustrate_marks *marks = &making->scene->items[index].marks;
	struct gz_mesh_points points = { 0 };
	gz_stipple_points_free(&marks->points);
	enum gz_result result = spread_points(making, index, 1, &points);
	if (result == GZ_OK)
		result = gz_stipple_points_make(&making->scene->meshes.shown[index], &points,
						&marks->points);
	gz_mesh_points_free(&points);
	marks->points_for = result == GZ_OK ? making->in_all : 0;
	return result;
}

static enum gz_result make_all_points(const struct making_marks *making)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < making->scene->count && result == GZ_OK; i++)
		if (making->scene->items[i].marks.points_for < making->in_all)
			result = make_points(making, i);
	return result;
}

static enum gz_result find_directions(const struct gz_mesh *mesh, float (*directions)[3])
{
	struct gz_curvature *curvatures = malloc((mesh->vertex_count + 1) * sizeof *curvatures);
	enum gz_result result = curvatures ? gz_mesh_curvatures(mesh, curvatures) : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_hatch_directions(mesh, curvatures, DIRECTION_PASSES, directions);
	free(curvatures);
	return result;
}

/* The strokes of one mesh in one direction. The second one's thread turns the directions. */
static enum gz_result trace_strokes(const struct making_marks *making, size_t index, size_t across)
{
	const struct gz_mesh *mesh = &making->scene->meshes.shown[index];
	const struct gz_mesh_points *points = &making->points[index];
	const float(*directions)[3] = (const float(*)[3])making->directions[index].vertices;
	struct gz_hatch_strokes *strokes = &making->scene->items[index].marks.strokes[across];
	const double distance_mm =
		STROKE_DISTANCE * sqrt(points->area_mm2 / fmax(1, (double)points->count));
	if (points->count == 0)
		return GZ_OK;
	if (across == 0)
		return gz_hatch_strokes_make(mesh, directions, points, distance_mm, strokes);
	float(*crossing)[3] = malloc((mesh->vertex_count + 1) * sizeof *crossing);
	if (!crossing)
		return GZ_ERR_NO_MEM;
	gz_hatch_cross_directions(mesh, directions, crossing);
	const enum gz_result result = gz_hatch_strokes_make(mesh, (const float(*)[3])crossing,
							    points, distance_mm, strokes);
	free(crossing);
	return result;
}

static void find_directions_part(void *user, size_t part, int worker)
{
	const struct making_marks *making = user;
	(void)worker;
	if (making->scene->items[part].marks.strokes_for < making->in_all)
		making->results[part] = find_directions(&making->scene->meshes.shown[part],
							making->directions[part].vertices);
}

static void trace_part(void *user, size_t part, int worker)
{
	const struct making_marks *making = user;
	const size_t index = part / GZ_HATCH_DIRECTIONS;
	(void)worker;
	if (making->scene->items[index].marks.strokes_for < making->in_all)
		making->results[part] = trace_strokes(making, index, part % GZ_HATCH_DIRECTIONS);
}

static enum gz_result first_failure(const struct making_marks *making, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (making->results[i] != GZ_OK)
			return making->results[i];
	return GZ_OK;
}

/* Points to start strokes from, and room for directions. */
static enum gz_result prepare_strokes(const struct making_marks *making)
{
	const size_t count = making->scene->count;
	for (size_t i = 0; i < count; i++) {
		if (making->scene->items[i].marks.strokes_for >= making->in_all)
			continue;
		for (int k = 0; k < GZ_HATCH_DIRECTIONS; k++)
			gz_hatch_strokes_free(&making->scene->items[i].marks.strokes[k]);
		const enum gz_result result =
			spread_points(making, i, STROKES_PER_POINT, &making->points[i]);
		if (result != GZ_OK)
			return result;
		making->directions[i].vertices =
			malloc((making->scene->meshes.shown[i].vertex_count + 1) *
			       sizeof *making->directions[i].vertices);
		if (!making->directions[i].vertices)
			return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

static enum gz_result make_all_strokes(struct making_marks *making)
{
	const size_t count = making->scene->count;
	making->points = calloc(count, sizeof *making->points);
	making->directions = calloc(count, sizeof *making->directions);
	making->results = calloc(count * GZ_HATCH_DIRECTIONS, sizeof *making->results);
	enum gz_result result = GZ_ERR_NO_MEM;
	if (making->points && making->directions && making->results)
		result = prepare_strokes(making);
	if (result == GZ_OK) {
		gz_workers_run(making->workers, find_directions_part, making, count);
		result = first_failure(making, count);
	}
	if (result == GZ_OK) {
		gz_workers_run(making->workers, trace_part, making, count * GZ_HATCH_DIRECTIONS);
		result = first_failure(making, count * GZ_HATCH_DIRECTIONS);
	}
	for (size_t i = 0; i < count; i++) {
		struct gz_illustrate_marks *marks = &making->scene->items[i].marks;
		if (marks->strokes_for < making->in_all)
			marks->strokes_for = result == GZ_OK ? making->in_all : 0;
		if (making->points)
			gz_mesh_points_free(&making->points[i]);
		if (making->directions)
			free(making->directions[i].vertices);
	}
	free(making->points);
	free(making->directions);
	free(making->results);
	return result;
}

static bool lacks_marks(const struct gz_illustrate_scene *scene,
			enum gz_illustration_drawing drawing, unsigned in_all)
{
	for (size_t i = 0; i < scene->count; i++) {
		const struct gz_illustrate_marks *marks = &scene->items[i].marks;
		if ((drawing == GZ_DRAWING_STIPPLES && marks->points_for < in_all) ||
		    (drawing == GZ_DRAWING_HATCHES && marks->strokes_for < in_all))
			return true;
	}
	return false;
}

enum gz_result gz_illustrate_marks_make(struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					struct gz_workers *workers, bool *out_new)
{
	const enum gz_illustration_drawing drawing = gz_illustration_look_drawing(shot->look);
	struct making_marks making = { .scene = scene,
				       .workers = workers,
				       .in_all = points_for(shot->plan) };
	/* a shot without pixels asks only what is at a place */
	if (shot->plan->width < 1 || !lacks_marks(scene, drawing, making.in_all))
		return GZ_OK;
	making.areas = calloc(scene->count, sizeof *making.areas);
	if (!making.areas)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < scene->count; i++) {
		making.areas[i] = area_of_mesh(&scene->meshes.shown[i]);
		making.area += making.areas[i];
	}
	const enum gz_result result = drawing == GZ_DRAWING_STIPPLES ? make_all_points(&making)
								     : make_all_strokes(&making);
	*out_new = true;
	free(making.areas);
	return result;
}
