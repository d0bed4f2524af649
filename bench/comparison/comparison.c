#include "bench/comparison/comparison.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/comparison/comparison_measure.h"
#include "bench/study/camera_path.h"
#include "bench/study/stage.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "techniques"

/* Counted frames of a method without a camera path. Chosen: once round the volume by the preset. */
enum { FRAMES_WITHOUT_PATH = 6 };

/* Places at which a transfer function is searched. Chosen: as many as a CT has values. */
enum { TRANSFER_PLACES = 4096 };

/* A run. */
struct running {
	const struct gz_comparison_request *request;
	const struct gz_log *log;
	struct gz_comparison *comparison;
	struct gz_stage stage;
	struct gz_workers *workers;
	struct gz_foveation *methods; /* of the scene */
	struct gz_camera_path path;   /* of the scene; empty: the camera turns */
};

/* ---- what is asked ---- */

static bool some_technique_has(const char *backend)
{
	for (size_t i = 0; gz_techniques[i]; i++)
		if (gz_technique_has_backend(gz_techniques[i], backend))
			return true;
	return false;
}

static bool is_a_technique(const char *name)
{
	for (size_t i = 0; gz_techniques[i]; i++)
		if (strcmp(gz_techniques[i]->name, name) == 0)
			return gz_techniques[i]->shows & GZ_OBJECT_VOLUME;
	return false;
}

static bool is_an_effect(const char *name)
{
	for (size_t i = 0; i < GZ_EFFECT_COUNT; i++)
		if (strcmp(gz_effects[i].name, name) == 0)
			return true;
	return false;
}

/* Check each name of a list. */
static enum gz_result check_names(const char *list, bool (*is_known)(const char *name),
				  const char *what, const struct gz_log *log)
{
	char name[GZ_NAME_SIZE];
	const char *rest = list[0] ? list : NULL;
	while (gz_list_next(&rest, name, sizeof name))
		if (!is_known(name)) {
			gz_err(log, "'%s': %s", name, what);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

static enum gz_result add_method(struct gz_comparison *comparison, const char *text,
				 const struct gz_log *log)
{
	struct gz_variant_settings settings = { gz_foveation_default(), gz_ray_params_default() };
	const enum gz_result result = gz_variant_parse(text, &settings, log, &settings);
	if (result != GZ_OK)
		return result;
	if (gz_method_of(&settings.foveation)->needs_table) {
		gz_err(log, "%s: spacing tables cannot be compared here; use gazebench run", text);
		return GZ_ERR_INVAL;
	}
	for (size_t i = 0; i < comparison->method_count; i++)
		if (strcmp(comparison->methods[i], text) == 0)
			return GZ_OK;
	if (comparison->method_count == GZ_STUDY_LIST_MAX) {
		gz_err(log, "more than %d methods", GZ_STUDY_LIST_MAX);
		return GZ_ERR_INVAL;
	}
	snprintf(comparison->methods[comparison->method_count++], GZ_STUDY_TEXT_SIZE, "%s", text);
	return GZ_OK;
}

static enum gz_result list_methods(const char *methods, const struct gz_log *log,
				   struct gz_comparison *comparison)
{
	char text[GZ_STUDY_TEXT_SIZE];
	const char *rest = methods[0] ? methods : NULL;
	comparison->methods = calloc(GZ_STUDY_LIST_MAX, sizeof comparison->methods[0]);
	if (!comparison->methods)
		return GZ_ERR_NO_MEM;
	enum gz_result result = add_method(comparison, gz_method_names[0], log);
	while (result == GZ_OK && gz_list_next(&rest, text, sizeof text))
		result = add_method(comparison, text, log);
	return result;
}

enum gz_result gz_comparison_check(const struct gz_comparison_request *request,
				   const struct gz_log *log)
{
	struct gz_comparison comparison = { 0 };
	enum gz_result result =
		check_names(request->backends, some_technique_has,
			    "no technique has this backend; there are cpu and gl", log);
	if (result == GZ_OK)
		result = check_names(request->techniques, is_a_technique,
				     "no technique of volumes; there are raycast, isosurface and "
				     "slices",
				     log);
	if (result == GZ_OK)
		result = check_names(request->effects, is_an_effect,
				     "no effect; there are none, reflection, shadow, both and "
				     "glass",
				     log);
	if (result == GZ_OK)
		result = list_methods(request->methods, log, &comparison);
	gz_comparison_free(&comparison);
	return result;
}

/* ---- the isovalue ---- */

double gz_comparison_isovalue(double own, const double range[2], const struct gz_transfer *transfer)
{
	const double *ends = transfer->has_range ? transfer->range : range;
	double greatest = 0, rgba[4];
	if (own > range[0] && own < range[1])
		return own;
	for (int i = 0; i <= TRANSFER_PLACES; i++) {
		gz_transfer_evaluate(transfer, (double)i / TRANSFER_PLACES, rgba);
		greatest = fmax(greatest, rgba[3]);
	}
	for (int i = 0; i <= TRANSFER_PLACES; i++) {
		const double share = (double)i / TRANSFER_PLACES;
		gz_transfer_evaluate(transfer, share, rgba);
		if (greatest > 0 && rgba[3] >= greatest / 2)
			return ends[0] + share * (ends[1] - ends[0]);
	}
	return (range[0] + range[1]) / 2; /* nothing is opaque */
}

static void data_range(const struct gz_volume *volume, double out_range[2])
{
	const double a = volume->slope * volume->stored_min + volume->intercept;
	const double b = volume->slope * volume->stored_max + volume->intercept;
	out_range[0] = fmin(a, b);
	out_range[1] = fmax(a, b);
}

/* Matter that is opaque from the isovalue on, in the colour of surfaces. */
static struct gz_transfer opaque_from(double isovalue, const double range[2],
				      const double colour[3])
{
	struct gz_transfer transfer = { .count = 2, .interpolation = GZ_TRANSFER_LINEAR };
	const double span = range[1] - range[0];
	const double share = span > 0 ? (isovalue - range[0]) / span : 0;
	for (int i = 0; i < 2; i++) {
		struct gz_transfer_point *point = &transfer.points[i];
		point->value = fmin(fmax(share, 0), 1);
		point->opacity = i;
		memcpy(point->rgb, colour, sizeof point->rgb);
	}
	return transfer;
}

/* ---- the camera path ---- */

/* How many frames a row has. All scenes have the same, because they share one path. */
static enum gz_result count_frames(struct running *running)
{
	const struct gz_comparison_request *request = running->request;
	const size_t recorded = running->path.count;
	const size_t asked = (size_t)request->frames;
	const size_t frames = asked > 0              ? asked
			      : request->camera_path ? recorded
						     : FRAMES_WITHOUT_PATH;
	if (request->camera_path && frames > recorded)
		gz_err(running->log, "%s has %zu cameras, fewer than the %zu frames asked for",
		       request->camera_path, recorded, frames);
	else if (frames > GZ_STUDY_FRAMES_MAX)
		gz_err(running->log,
		       "%s has %zu cameras, and a series at most %d frames; take some by --frames",
		       request->camera_path, recorded, GZ_STUDY_FRAMES_MAX);
	else {
		running->comparison->frames = (int)frames;
		return GZ_OK;
	}
	return GZ_ERR_INVAL;
}

/* Read the path for a scene: what its lines do not name is that of the scene's camera. */
static enum gz_result read_path(struct running *running)
{
	const struct gz_camera *first = &running->stage.scene.settings.camera;
	enum gz_result result = GZ_OK;
	gz_camera_path_free(&running->path);
	if (running->request->camera_path)
		result = gz_camera_path_read(running->request->camera_path, first, running->log,
					     &running->path);
	return result == GZ_OK ? count_frames(running) : result;
}

/* ---- a scene ---- */

static enum gz_result check_scene(const struct running *running)
{
	const struct gz_scene *scene = &running->stage.scene;
	if (scene->meshes || scene->labels)
		gz_err(running->log,
		       "%s: a scene with meshes cannot be compared: not every technique draws them",
		       running->stage.path);
	else if (scene->volume.bricks)
		gz_err(running->log,
		       "%s: a file of bricks cannot be compared; use the volume itself",
		       running->stage.path);
	else
		return GZ_OK;
	return GZ_ERR_UNSUPPORTED;
}

static enum gz_result parse_methods(struct running *running)
{
	const struct gz_scene_settings *settings = &running->stage.scene.settings;
	const struct gz_comparison *comparison = running->comparison;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < comparison->method_count && result == GZ_OK; i++) {
		struct gz_variant_settings variant = { settings->foveation, settings->rays };
		result = gz_variant_parse(comparison->methods[i], &variant, running->log, &variant);
		running->methods[i] = variant.foveation;
	}
	return result;
}

static enum gz_result add_rows(struct running *running, size_t scene,
			       const struct gz_comparison_list *list)
{
	struct gz_comparison *comparison = running->comparison;
	const size_t count = list->count * comparison->method_count;
	struct gz_comparison_row *rows =
		realloc(comparison->rows, (comparison->row_count + count + 1) * sizeof *rows);
	if (!rows)
		return GZ_ERR_NO_MEM;
	comparison->rows = rows;
	for (size_t i = 0; i < count; i++) {
		const struct gz_comparison_series *series =
			&list->series[i / comparison->method_count];
		struct gz_comparison_row *row = &rows[comparison->row_count];
		*row = (struct gz_comparison_row) {
			.scene = scene,
			.technique = series->technique,
			.backend = series->backend,
			.effect = &gz_effects[series->effect],
			.slices = series->slices,
			.method = i % comparison->method_count,
			.frames = calloc((size_t)comparison->frames, sizeof *row->frames),
			.converged = gz_study_errors_unmeasured(),
			.standard = gz_study_errors_unmeasured(),
		};
		if (!row->frames)
			return GZ_ERR_NO_MEM;
		comparison->row_count++;
	}
	return GZ_OK;
}

static enum gz_result add_gaps(struct running *running, size_t scene,
			       const struct gz_comparison_list *list)
{
	struct gz_comparison *comparison = running->comparison;
	struct gz_comparison_gap *gaps = realloc(
		comparison->gaps, (comparison->gap_count + list->gap_count + 1) * sizeof *gaps);
	if (!gaps)
		return GZ_ERR_NO_MEM;
	comparison->gaps = gaps;
	for (size_t i = 0; i < list->gap_count; i++) {
		gaps[comparison->gap_count] = list->gaps[i];
		gaps[comparison->gap_count++].scene = scene;
	}
	return GZ_OK;
}

static enum gz_result describe_scene(struct running *running, size_t index)
{
	const struct gz_scene *loaded = &running->stage.scene;
	struct gz_comparison_scene *scene = &running->comparison->scenes[index];
	double range[2];
	data_range(&loaded->volume, range);
	gz_study_file_name(scene->path, ".scene", scene->name);
	memcpy(scene->dims, loaded->volume.dims, sizeof scene->dims);
	scene->reference_db = NAN;
	scene->isovalue = running->request->isovalue;
	if (isnan(scene->isovalue))
		scene->isovalue = gz_comparison_isovalue(loaded->settings.rays.surface.isovalue,
							 range, &loaded->transfer);
	return gz_stage_data_hash(&running->stage, &loaded->transfer, scene->data_hash);
}

/* Series and rows of a scene are there: measure them. */
static enum gz_result measure_scene(struct running *running, size_t index,
				    const struct gz_comparison_stage *stage,
				    struct gz_comparison_list *list)
{
	struct gz_comparison *comparison = running->comparison;
	double range[2];
	char hash[GZ_STUDY_HASH_SIZE], program[2 * GZ_STUDY_TEXT_SIZE];
	data_range(stage->volume, range);
	const struct gz_transfer surface =
		opaque_from(comparison->scenes[index].isovalue, range, stage->rays->surface.colour);
	snprintf(program, sizeof program, "%s %s", comparison->machine.program,
		 comparison->machine.commit);
	const size_t first = comparison->row_count;
	enum gz_result result = gz_stage_data_hash(&running->stage, &surface, hash);
	if (result == GZ_OK)
		result = add_rows(running, index, list);
	if (result == GZ_OK)
		result = add_gaps(running, index, list);
	if (result != GZ_OK)
		return result;
	const struct gz_comparison_job job = {
		.request = running->request,
		.stage = stage,
		.list = list,
		.methods = running->methods,
		.method_count = comparison->method_count,
		.frames = comparison->frames,
		.cameras = running->path.cameras,
		.scene = &comparison->scenes[index],
		.surface_hash = hash,
		.surface = &surface,
		.program = program,
		.workers = running->workers,
		.log = running->log,
		.rows = &comparison->rows[first],
	};
	result = gz_comparison_time(&job);
	return result == GZ_OK ? gz_comparison_compare(&job) : result;
}

static enum gz_result compare_scene(struct running *running, size_t index)
{
	struct gz_comparison *comparison = running->comparison;
	struct gz_comparison_list list = { 0 };
	snprintf(comparison->scenes[index].path, sizeof comparison->scenes[index].path, "%s",
		 running->request->scenes[index]);
	enum gz_result result = gz_stage_load(&running->stage, running->request->scenes[index]);
	if (result == GZ_OK)
		result = check_scene(running);
	if (result == GZ_OK)
		result = read_path(running);
	if (result == GZ_OK)
		result = describe_scene(running, index);
	if (result == GZ_OK)
		result = parse_methods(running);
	if (result != GZ_OK)
		return result;
	const struct gz_scene *scene = &running->stage.scene;
	struct gz_ray_params rays = scene->settings.rays;
	rays.surface.isovalue = comparison->scenes[index].isovalue;
	struct gz_display display = gz_display_default(comparison->width, comparison->height);
	if (scene->has_display) {
		display = scene->settings.display;
		display.px[0] = comparison->width;
		display.px[1] = comparison->height;
	}
	const struct gz_comparison_stage stage = {
		.volume = &scene->volume,
		.transfer = &scene->transfer,
		.camera = &scene->settings.camera,
		.display = &display,
		.rays = &rays,
	};
	result = gz_comparison_list_make(&stage, running->request, &list);
	if (result == GZ_OK)
		result = measure_scene(running, index, &stage, &list);
	gz_comparison_list_free(&list);
	return result;
}

/* ---- all ---- */

static void describe_run(struct running *running)
{
	const struct gz_comparison_request *request = running->request;
	struct gz_comparison *comparison = running->comparison;
	comparison->width = request->width;
	comparison->height = request->height;
	comparison->warm_up = request->warm_up;
	comparison->turn_deg = request->turn_deg;
	if (request->camera_path)
		snprintf(comparison->camera_path, sizeof comparison->camera_path, "%s",
			 request->camera_path);
	gz_study_machine_describe(&comparison->machine);
	snprintf(comparison->machine.program, sizeof comparison->machine.program, "%s",
		 request->program);
	snprintf(comparison->machine.commit, sizeof comparison->machine.commit, "%s",
		 request->commit);
}

static enum gz_result begin_run(struct running *running)
{
	const struct gz_comparison_request *request = running->request;
	struct gz_comparison *comparison = running->comparison;
	describe_run(running);
	enum gz_result result = list_methods(request->methods, running->log, comparison);
	if (result != GZ_OK)
		return result;
	comparison->scenes = calloc(request->scene_count, sizeof *comparison->scenes);
	running->methods = calloc(comparison->method_count, sizeof *running->methods);
	if (!comparison->scenes || !running->methods)
		return GZ_ERR_NO_MEM;
	comparison->scene_count = request->scene_count;
	return gz_workers_create(0, &running->workers);
}

enum gz_result gz_comparison_run(const struct gz_comparison_request *request,
				 const struct gz_log *log, struct gz_comparison *out_comparison)
{
	struct gz_comparison comparison = { 0 };
	struct running running = {
		.request = request, .log = log, .comparison = &comparison, .stage = { .log = log }
	};
	enum gz_result result = begin_run(&running);
	for (size_t i = 0; i < comparison.scene_count && result == GZ_OK; i++)
		result = compare_scene(&running, i);
	gz_workers_destroy(&running.workers);
	gz_stage_free(&running.stage);
	gz_camera_path_free(&running.path);
	free(running.methods);
	if (result == GZ_OK)
		*out_comparison = comparison;
	else
		gz_comparison_free(&comparison);
	return result;
}

void gz_comparison_free(struct gz_comparison *comparison)
{
	for (size_t i = 0; i < comparison->row_count; i++)
		free(comparison->rows[i].frames);
	free(comparison->rows);
	free(comparison->gaps);
	free(comparison->methods);
	free(comparison->scenes);
	*comparison = (struct gz_comparison) { 0 };
}
