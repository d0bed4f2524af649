#include "render/illustration/shared/illustrate_making.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "render/illustration/cached_points.h"
#include "render/illustration/cached_strokes.h"

/* Distance of strokes in that of as many points. Measured: their densest tone is then as dark as
 * the map asks for. */
#define STROKE_DISTANCE 0.8
/* How far directions spread, in edges. Chosen by eye, on a skull. */
#define DIRECTION_PASSES 60

/* Bytes of the ending of a kept file. */
enum { ENDING_SIZE = 128 };

void gz_illustrate_marks_free(struct gz_illustrate_marks *marks)
{
	gz_stipple_points_free(&marks->points);
	for (int i = 0; i < GZ_HATCH_DIRECTIONS; i++)
		gz_hatch_strokes_free(&marks->strokes[i]);
	*marks = (struct gz_illustrate_marks) { 0 };
}

/* The file that keeps @p what of a task. */
static struct gz_mesh_cache_place place_of(const struct gz_marks_task *task, const char *what,
					   char out_ending[ENDING_SIZE])
{
	snprintf(out_ending, ENDING_SIZE, "%s.%zu.%s", task->name, task->points, what);
	return (struct gz_mesh_cache_place) { task->input, out_ending };
}

static enum gz_result spread_points(const struct gz_marks_order *order, struct gz_marks_task *task,
				    struct gz_workers *workers, struct gz_mesh_points *out_points)
{
	char ending[ENDING_SIZE];
	const struct gz_mesh_cache_place place = place_of(task, "points", ending);
	return gz_cached_points_make(&task->mesh, task->points, task->keeps ? &place : NULL,
				     workers, &order->stopped, order->log, out_points);
}

static enum gz_result make_points(const struct gz_marks_order *order, struct gz_marks_task *task,
				  struct gz_workers *workers)
{
	struct gz_mesh_points points = { 0 };
	enum gz_result result = spread_points(order, task, workers, &points);
	if (result == GZ_OK)
		result = gz_stipple_points_make(&task->mesh, &points, &task->made.points);
	gz_mesh_points_free(&points);
	if (result == GZ_OK)
		task->made.points_for = order->in_all;
	return result;
}

/* ---- strokes ---- */

static struct gz_cached_strokes_kind kind_of(const struct gz_marks_task *task, int direction)
{
	return (struct gz_cached_strokes_kind) { task->points, DIRECTION_PASSES, STROKE_DISTANCE,
						 direction };
}

static const char *const direction_endings[GZ_HATCH_DIRECTIONS] = { "strokes", "around" };

/* Read the strokes of a task from files. */
static bool load_strokes(const struct gz_marks_order *order, struct gz_marks_task *task)
{
	bool all = task->keeps;
	for (int i = 0; i < GZ_HATCH_DIRECTIONS && all; i++) {
		char ending[ENDING_SIZE];
		const struct gz_mesh_cache_place place =
			place_of(task, direction_endings[i], ending);
		const struct gz_cached_strokes_kind kind = kind_of(task, i);
		all = gz_cached_strokes_load(&task->mesh, &kind, &place, order->log,
					     &task->made.strokes[i]) == GZ_OK;
	}
	if (all)
		task->made.strokes_for = order->in_all;
	else
		for (int i = 0; i < GZ_HATCH_DIRECTIONS; i++)
			gz_hatch_strokes_free(&task->made.strokes[i]);
	return all;
}

static enum gz_result trace_strokes(const struct gz_marks_order *order, struct gz_marks_task *task,
				    int direction)
{
	const struct gz_mesh *mesh = &task->mesh;
	const float(*directions)[3] = (const float(*)[3])task->directions;
	struct gz_hatch_strokes *strokes = &task->made.strokes[direction];
	const double distance_mm =
		STROKE_DISTANCE * sqrt(task->starts.area_mm2 / fmax(1, (double)task->starts.count));
	if (task->starts.count == 0)
		return GZ_OK;
	float(*around)[3] = NULL;
	if (direction > 0) {
		around = malloc((mesh->vertex_count + 1) * sizeof *around);
		if (!around)
			return GZ_ERR_NO_MEM;
		gz_hatch_cross_directions(mesh, directions, around);
		directions = (const float(*)[3])around;
	}
	const enum gz_result result = gz_hatch_strokes_make(mesh, directions, &task->starts,
							    distance_mm, &order->stopped, strokes);
	free(around);
	if (result == GZ_OK && task->keeps) {
		char ending[ENDING_SIZE];
		const struct gz_mesh_cache_place place =
			place_of(task, direction_endings[direction], ending);
		const struct gz_cached_strokes_kind kind = kind_of(task, direction);
		/* a failure is logged, and only costs time */
		(void)gz_cached_strokes_store(mesh, &kind, &place, order->log, strokes);
	}
	return result;
}

/* Whether strokes of a task are still to be traced. */
static bool lacks_strokes(const struct gz_marks_task *task)
{
	return task->kind == GZ_DRAWING_HATCHES && task->directions;
}

static void find_directions_part(void *user, size_t part, int worker)
{
	struct gz_marks_order *order = user;
	struct gz_marks_task *task = &order->tasks[part];
	(void)worker;
	if (lacks_strokes(task) && !atomic_load(&order->stopped))
		task->results[0] =
			gz_hatch_directions(&task->mesh, task->curvatures, DIRECTION_PASSES,
					    &order->stopped, task->directions);
}

static void trace_part(void *user, size_t part, int worker)
{
	struct gz_marks_order *order = user;
	struct gz_marks_task *task = &order->tasks[part / GZ_HATCH_DIRECTIONS];
	const int direction = (int)(part % GZ_HATCH_DIRECTIONS);
	(void)worker;
	if (lacks_strokes(task) && !atomic_load(&order->stopped))
		task->results[direction] = trace_strokes(order, task, direction);
}

static enum gz_result first_failure(const struct gz_marks_order *order)
{
	for (size_t i = 0; i < order->count; i++)
		for (int k = 0; k < GZ_HATCH_DIRECTIONS; k++)
			if (order->tasks[i].results[k] != GZ_OK)
				return order->tasks[i].results[k];
	return GZ_OK;
}

/* Points to start strokes from, and room for directions. */
static enum gz_result prepare_strokes(const struct gz_marks_order *order,
				      struct gz_marks_task *task, struct gz_workers *workers)
{
	if (load_strokes(order, task))
		return GZ_OK;
	const enum gz_result result = spread_points(order, task, workers, &task->starts);
	if (result != GZ_OK)
		return result;
	task->directions = malloc((task->mesh.vertex_count + 1) * sizeof *task->directions);
	return task->directions ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_marks_order_make(struct gz_marks_order *order, struct gz_workers *workers)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < order->count && result == GZ_OK && !atomic_load(&order->stopped);
	     i++)
		result = order->tasks[i].kind == GZ_DRAWING_STIPPLES
				 ? make_points(order, &order->tasks[i], workers)
				 : prepare_strokes(order, &order->tasks[i], workers);
	if (result == GZ_OK) {
		gz_workers_run(workers, find_directions_part, order, order->count);
		result = first_failure(order);
	}
	if (result == GZ_OK) {
		gz_workers_run(workers, trace_part, order, order->count * GZ_HATCH_DIRECTIONS);
		result = first_failure(order);
	}
	for (size_t i = 0; i < order->count && result == GZ_OK && !atomic_load(&order->stopped);
	     i++)
		if (order->tasks[i].kind == GZ_DRAWING_HATCHES)
			order->tasks[i].made.strokes_for = order->in_all;
	return result == GZ_ERR_CANCELLED ? GZ_OK : result;
}

void gz_marks_order_free(struct gz_marks_order *order)
{
	for (size_t i = 0; i < order->count; i++) {
		struct gz_marks_task *task = &order->tasks[i];
		if (order->owns_meshes)
			gz_mesh_free(&task->mesh);
		gz_illustrate_marks_free(&task->made);
		gz_mesh_points_free(&task->starts);
		free(task->directions);
		free(task->curvatures);
		free(task->input);
		free(task->name);
	}
	free(order->tasks);
	order->tasks = NULL;
	order->count = 0;
}

/* ---- in the background ---- */

struct gz_marks_maker {
	pthread_t thread;
	int threads;
	struct gz_marks_order order;
	enum gz_result result;
	atomic_bool done; /* and result is written */
};

static void *run_marks_maker(void *user)
{
	struct gz_marks_maker *maker = user;
	struct gz_workers *workers = NULL;
	maker->result = gz_workers_create(maker->threads, &workers);
	if (maker->result == GZ_OK)
		maker->result = gz_marks_order_make(&maker->order, workers);
	gz_workers_destroy(&workers);
	atomic_store(&maker->done, true);
	return NULL;
}

/* Move an order; atomics cannot be assigned as part of a struct. */
static void move_order(struct gz_marks_order *from, struct gz_marks_order *to)
{
	to->log = from->log;
	to->in_all = from->in_all;
	to->count = from->count;
	to->tasks = from->tasks;
	to->owns_meshes = from->owns_meshes;
	atomic_store(&to->stopped, atomic_load(&from->stopped));
	from->tasks = NULL;
	from->count = 0;
}

enum gz_result gz_marks_maker_start(struct gz_marks_order *order, int threads,
				    struct gz_marks_maker **out_maker)
{
	struct gz_marks_maker *maker = calloc(1, sizeof *maker);
	if (!maker)
		return GZ_ERR_NO_MEM;
	maker->threads = threads;
	move_order(order, &maker->order);
	if (pthread_create(&maker->thread, NULL, run_marks_maker, maker) != 0) {
		move_order(&maker->order, order);
		free(maker);
		return GZ_ERR_NO_MEM;
	}
	*out_maker = maker;
	return GZ_OK;
}

bool gz_marks_maker_done(const struct gz_marks_maker *maker)
{
	return atomic_load(&maker->done);
}

void gz_marks_maker_stop(struct gz_marks_maker *maker)
{
	atomic_store(&maker->order.stopped, true);
}

enum gz_result gz_marks_maker_end(struct gz_marks_maker **maker, struct gz_marks_order *out_order)
{
	struct gz_marks_maker *self = *maker;
	if (!self)
		return GZ_OK;
	(void)pthread_join(self->thread, NULL);
	const enum gz_result result = self->result;
	if (out_order)
		move_order(&self->order, out_order);
	gz_marks_order_free(&self->order);
	free(self);
	*maker = NULL;
	return result;
}
