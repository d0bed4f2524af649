#include "bench/study/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/command.h"
#include "bench/metrics/temporal.h"
#include "bench/study/errors.h"
#include "bench/study/stage.h"
#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "study"

/* Degrees that the camera turns between two rounds of frames, so that no frame equals the one
 * before by accident. */
#define TURN_DEG 0.01

/* Degrees a frame, and frames a second, of the camera that turns while changes over time are
 * measured. Chosen: 15 degrees a second, as somebody turns a volume slowly by the mouse. */
#define SEEN_TURN_DEG 0.25
#define SEEN_FPS      60

/* ---- measuring a unit ---- */

/* What a picture shows, except for its gaze. */
struct shown {
	size_t scene, size, backend;
	uint32_t camera;
};

struct measurer {
	const struct gz_log *log;
	const struct gz_study *study;
	struct gz_stage *stage;
	const char *cache;
	struct gz_workers *workers;
	struct gz_plan plans[GZ_STUDY_LIST_MAX]; /* by variant */
	struct gz_image frame;                   /* of frames that are timed */
	struct gz_image standard, test, trembled;
	struct gz_image converged, half_step;
	double reference_db;
	struct shown reference_of;  /* converged is of this scene, size and camera */
	bool has_reference;         /* converged is of something */
	struct gz_error_maps maps;  /* of the current variant */
	struct gz_error_maps whole; /* of standard against converged */
	struct shown whole_of;      /* what whole is of */
	bool has_whole;             /* whole is of something */
	struct gz_error_weights weights;
	struct gz_map scratch;
	struct gz_map response, standard_response;       /* to pictures while the camera turns */
	struct shown response_of;                        /* what standard_response is of */
	bool has_response;                               /* standard_response is of something */
	struct gz_map path_responses[GZ_STUDY_LIST_MAX]; /* by variant, while a path is followed */
};

/* A unit in the making. */
struct unit {
	struct shown shown;
	struct gz_point gaze;
	struct gz_camera camera;
	struct gz_display display;
	int width, height;
	struct gz_picture_maker *maker;
};

static enum gz_result measurer_create(const struct gz_study *study, struct gz_stage *stage,
				      const char *cache, const struct gz_log *log,
				      struct measurer **out_measurer)
{
	struct measurer *measurer = calloc(1, sizeof *measurer);
	if (!measurer || gz_workers_create(0, &measurer->workers) != GZ_OK) {
		gz_err(log, "no memory or threads to measure with");
		free(measurer);
		return GZ_ERR_NO_MEM;
	}
	measurer->log = log;
	measurer->study = study;
	measurer->stage = stage;
	measurer->cache = cache;
	*out_measurer = measurer;
	return GZ_OK;
}

static void measurer_destroy(struct measurer **measurer)
{
	struct measurer *self = *measurer;
	if (!self)
		return;
	gz_workers_destroy(&self->workers);
	for (size_t i = 0; i < GZ_STUDY_LIST_MAX; i++)
		gz_plan_free(&self->plans[i]);
	gz_image_free(&self->frame);
	gz_image_free(&self->standard);
	gz_image_free(&self->test);
	gz_image_free(&self->trembled);
	gz_image_free(&self->converged);
	gz_image_free(&self->half_step);
	gz_error_maps_free(&self->maps);
	gz_error_maps_free(&self->whole);
	gz_error_weights_free(&self->weights);
	gz_map_free(&self->scratch);
	gz_map_free(&self->response);
	gz_map_free(&self->standard_response);
	for (size_t i = 0; i < GZ_STUDY_LIST_MAX; i++)
		gz_map_free(&self->path_responses[i]);
	free(self);
	*measurer = NULL;
}

/* ---- frames ---- */

/* A variant's picture of a unit. */
struct asked_picture {
	size_t variant;
	const struct gz_camera *camera;
	struct gz_point gaze;
	bool on_device;
	struct gz_image *image;
};

static enum gz_result make_variant_picture(struct measurer *measurer, const struct unit *unit,
					   const struct asked_picture *asked,
					   struct gz_picture_cost *out_cost)
{
	const struct gz_variant_settings *settings = &measurer->stage->variants[asked->variant];
	const struct gz_picture_request request = {
		.camera = asked->camera,
		.settings = &settings->rays,
		.foveation = &settings->foveation,
		.display = &unit->display,
		.focus = gz_focus_at(asked->gaze),
		.width = unit->width,
		.height = unit->height,
		.on_device = asked->on_device,
		/* A viewer makes one plan for all frames where the gaze does not matter. */
		.fresh_plan = gz_foveation_follows_gaze(&settings->foveation),
		.plan = &measurer->plans[asked->variant],
		.image = asked->image,
	};
	struct gz_image *image;
	return gz_picture_make(unit->maker, &request, &image, out_cost);
}

/* One frame, as a viewer makes it. */
static enum gz_result time_frame(struct measurer *measurer, const struct unit *unit, size_t variant,
				 const struct gz_camera *camera, struct gz_study_row *row)
{
	const struct asked_picture asked = { variant, camera, unit->gaze, true, &measurer->frame };
	struct gz_picture_cost cost;
	const enum gz_result result = make_variant_picture(measurer, unit, &asked, &cost);
	if (result != GZ_OK)
		return result;
	row->plan_ms = cost.plan_ms;
	row->frame_ms = cost.total_ms;
	row->cast_ms = cost.stats.cast_ms;
	row->reconstruct_ms = cost.stats.reconstruct_ms;
	row->gpu_ms = cost.stats.gpu_ms;
	row->prepare_ms = cost.stats.prepare_ms;
	row->rays = cost.stats.rays;
	row->samples = cost.stats.samples;
	return GZ_OK;
}

/*
 * All rounds: warm-up rounds first, then counted ones. In a round each variant renders one frame,
 * and the camera turns before the next. A plan is made anew for each frame unless its method does
 * not ask for the gaze; nothing is accumulated. Where a backend can leave the picture on its
 * device, it does. Rows of a variant's frames follow each other.
 */
static enum gz_result time_frames(struct measurer *measurer, const struct unit *unit,
				  struct gz_study_row *rows)
{
	const struct gz_study *study = measurer->study;
	struct gz_camera camera = unit->camera;
	double prepared_ms[GZ_STUDY_LIST_MAX] = { 0 }; /* in warm-up frames, by variant */
	for (int round = -study->warm_up_frames; round < study->frames_per_point; round++) {
		for (size_t variant = 0; variant < study->variant_count; variant++) {
			struct gz_study_row unused;
			struct gz_study_row *row = &unused;
			if (round >= 0)
				row = &rows[variant * (size_t)study->frames_per_point +
					    (size_t)round];
			const enum gz_result result =
				gz_command_interrupted()
					? GZ_ERR_CANCELLED
					: time_frame(measurer, unit, variant, &camera, row);
			if (result != GZ_OK)
				return result;
			if (round < 0)
				prepared_ms[variant] += row->prepare_ms;
			else if (round == 0)
				row->prepare_ms += prepared_ms[variant];
		}
		gz_camera_turn(&camera, TURN_DEG);
	}
	return GZ_OK;
}

/* ---- errors of a unit ---- */

static bool same_picture(const struct shown *a, const struct shown *b)
{
	return a->scene == b->scene && a->size == b->size && a->camera == b->camera;
}

static double px_per_deg(const struct unit *unit)
{
	return fmin(fmax(gz_display_px_per_deg(&unit->display), 1), 1000);
}

static enum gz_result find_reference(struct measurer *measurer, const struct unit *unit)
{
	const struct gz_study *study = measurer->study;
	char program[2 * GZ_STUDY_TEXT_SIZE];
	if (measurer->has_reference && same_picture(&measurer->reference_of, &unit->shown))
		return GZ_OK;
	snprintf(program, sizeof program, "%s %s", study->machine.program, study->machine.commit);
	const struct gz_reference_request request = {
		.maker = measurer->stage->cpu,
		.data_hash = study->scenes[unit->shown.scene].data_hash,
		.program = program,
		.camera = &unit->camera,
		.rays = &measurer->stage->scene.settings.rays,
		.display = &unit->display,
		.width = unit->width,
		.height = unit->height,
		.cache = measurer->cache,
	};
	bool made;
	const enum gz_result result =
		gz_reference_get(&request, measurer->log, &measurer->converged,
				 &measurer->half_step, &measurer->reference_db, &made);
	measurer->has_reference = result == GZ_OK;
	measurer->reference_of = unit->shown;
	return result;
}

static enum gz_result still_picture(struct measurer *measurer, const struct unit *unit,
				    size_t variant, struct gz_point gaze, struct gz_image *image)
{
	const struct asked_picture asked = { variant, &unit->camera, gaze, false, image };
	return gz_command_interrupted() ? GZ_ERR_CANCELLED
					: make_variant_picture(measurer, unit, &asked, NULL);
}

/* Mean change while the gaze goes from its place by a pixel to the right, and by one down. */
static enum gz_result find_flicker(struct measurer *measurer, const struct unit *unit,
				   size_t variant, const struct gz_image *still,
				   double *out_flicker)
{
	double sum = 0;
	*out_flicker = 0;
	if (!gz_foveation_follows_gaze(&measurer->stage->variants[variant].foveation))
		return GZ_OK;
	for (int axis = 0; axis < 2; axis++) {
		struct gz_point gaze = unit->gaze;
		double change = 0;
		if (axis == 0)
			gaze.x += 1 / (float)unit->width;
		else
			gaze.y += 1 / (float)unit->height;
		enum gz_result result =
			still_picture(measurer, unit, variant, gaze, &measurer->trembled);
		if (result == GZ_OK)
			result = gz_errors_change(still, &measurer->trembled, &measurer->weights,
						  &measurer->scratch, &change);
		if (result != GZ_OK)
			return result;
		sum += change / 2;
	}
	*out_flicker = sum;
	return GZ_OK;
}

/* A response to no picture yet. */
static enum gz_result begin_response(const struct unit *unit, struct gz_map *response)
{
	const enum gz_result result = gz_map_resize(response, unit->width, unit->height);
	if (result == GZ_OK)
		memset(response->values, 0,
		       (size_t)unit->width * (size_t)unit->height * sizeof *response->values);
	return result;
}

/* Add a variant's picture to a response. */
static enum gz_result add_seen(struct measurer *measurer, const struct unit *unit, size_t variant,
			       const struct gz_camera *camera, double weight,
			       struct gz_map *response)
{
	const struct asked_picture asked = { variant, camera, unit->gaze, false,
					     &measurer->trembled };
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	const enum gz_result result = make_variant_picture(measurer, unit, &asked, NULL);
	if (result == GZ_OK)
		gz_map_add_luma(response, &measurer->trembled, weight);
	return result;
}

/* The response of the eye's transient channel to a variant's pictures while the camera turns. */
static enum gz_result find_response(struct measurer *measurer, const struct unit *unit,
				    size_t variant, struct gz_map *response)
{
	double weights[GZ_TEMPORAL_FRAMES];
	struct gz_camera camera = unit->camera;
	gz_temporal_weights(SEEN_FPS, weights);
	enum gz_result result = begin_response(unit, response);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES && result == GZ_OK; i++) {
		result = add_seen(measurer, unit, variant, &camera, weights[i], response);
		gz_camera_turn(&camera, SEEN_TURN_DEG);
	}
	return result;
}

/* The response to standard: the same wherever the gaze is. */
static enum gz_result find_standard_response(struct measurer *measurer, const struct unit *unit)
{
	if (measurer->has_response && same_picture(&measurer->response_of, &unit->shown) &&
	    measurer->response_of.backend == unit->shown.backend &&
	    !gz_foveation_follows_gaze(&measurer->stage->variants[0].foveation))
		return GZ_OK;
	const enum gz_result result =
		find_response(measurer, unit, 0, &measurer->standard_response);
	measurer->has_response = result == GZ_OK;
	measurer->response_of = unit->shown;
	return result;
}

static enum gz_result find_turning_error(struct measurer *measurer, const struct unit *unit,
					 size_t variant, double *out_error)
{
	enum gz_result result = find_standard_response(measurer, unit);
	if (result == GZ_OK)
		result = find_response(measurer, unit, variant, &measurer->response);
	if (result == GZ_OK)
		*out_error = gz_map_weighted_difference(&measurer->response,
							&measurer->standard_response,
							&measurer->weights.perceived);
	return result;
}

/* Responses of all variants to pictures by some cameras in a row. */
static enum gz_result find_path_responses(struct measurer *measurer, const struct unit *unit,
					  const struct gz_camera cameras[GZ_TEMPORAL_FRAMES])
{
	double weights[GZ_TEMPORAL_FRAMES];
	const size_t variants = measurer->study->variant_count;
	enum gz_result result = GZ_OK;
	gz_temporal_weights(SEEN_FPS, weights);
	for (size_t v = 0; v < variants && result == GZ_OK; v++)
		result = begin_response(unit, &measurer->path_responses[v]);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++)
		for (size_t v = 0; v < variants && result == GZ_OK; v++)
			result = add_seen(measurer, unit, v, &cameras[i], weights[i],
					  &measurer->path_responses[v]);
	return result;
}

/* The mean over the study's camera path, cut into as many pictures as a response is made of. */
static enum gz_result measure_camera_path(struct measurer *measurer, const struct unit *unit,
					  double out_errors[GZ_STUDY_LIST_MAX])
{
	const struct gz_study *study = measurer->study;
	const struct gz_camera_path *path = &study->camera_paths[unit->shown.scene];
	const size_t parts = path->count / GZ_TEMPORAL_FRAMES;
	struct gz_map *responses = measurer->path_responses;
	enum gz_result result = GZ_OK;
	for (size_t v = 0; v < study->variant_count; v++)
		out_errors[v] = 0;
	for (size_t part = 0; part < parts && result == GZ_OK; part++) {
		result = find_path_responses(measurer, unit,
					     path->cameras + part * GZ_TEMPORAL_FRAMES);
		for (size_t v = 1; v < study->variant_count && result == GZ_OK; v++)
			out_errors[v] += gz_map_weighted_difference(&responses[v], &responses[0],
								    &measurer->weights.perceived) /
					 (double)parts;
	}
	return result;
}

/* Standard against converged: the same maps wherever the gaze is. */
static enum gz_result measure_standard(struct measurer *measurer, const struct unit *unit,
				       struct gz_study_row *row)
{
	const bool converged = measurer->study->accuracy == GZ_STUDY_ACCURACY_ALL;
	const bool same = measurer->has_whole && same_picture(&measurer->whole_of, &unit->shown) &&
			  measurer->whole_of.backend == unit->shown.backend &&
			  !gz_foveation_follows_gaze(&measurer->stage->variants[0].foveation);
	enum gz_result result = GZ_OK;
	if (!same)
		result = still_picture(measurer, unit, 0, unit->gaze, &measurer->standard);
	if (result == GZ_OK && !same && converged)
		result = gz_error_maps_make(&measurer->whole, &measurer->converged,
					    &measurer->standard, px_per_deg(unit),
					    measurer->workers);
	if (result == GZ_OK)
		result = find_flicker(measurer, unit, 0, &measurer->standard, &row->flicker);
	if (result != GZ_OK)
		return result;
	measurer->has_whole = true;
	measurer->whole_of = unit->shown;
	const bool has_ssim = unit->width >= 11 && unit->height >= 11;
	row->standard = gz_errors_none(&measurer->weights, has_ssim);
	row->turning_error = 0;
	if (converged)
		row->converged = gz_error_maps_weigh(&measurer->whole, &measurer->weights);
	return GZ_OK;
}

static enum gz_result compare_with(struct measurer *measurer, const struct unit *unit,
				   const struct gz_image *reference,
				   struct gz_study_errors *out_errors)
{
	const enum gz_result result = gz_error_maps_make(
		&measurer->maps, reference, &measurer->test, px_per_deg(unit), measurer->workers);
	if (result == GZ_OK)
		*out_errors = gz_error_maps_weigh(&measurer->maps, &measurer->weights);
	return result;
}

static enum gz_result measure_variant(struct measurer *measurer, const struct unit *unit,
				      size_t variant, struct gz_study_row *row)
{
	if (variant == 0)
		return measure_standard(measurer, unit, row);
	enum gz_result result = still_picture(measurer, unit, variant, unit->gaze, &measurer->test);
	if (result == GZ_OK)
		result = compare_with(measurer, unit, &measurer->standard, &row->standard);
	if (result == GZ_OK && measurer->study->accuracy == GZ_STUDY_ACCURACY_ALL)
		result = compare_with(measurer, unit, &measurer->converged, &row->converged);
	if (result == GZ_OK)
		result = find_flicker(measurer, unit, variant, &measurer->test, &row->flicker);
	if (result == GZ_OK)
		result = find_turning_error(measurer, unit, variant, &row->turning_error);
	return result;
}

static enum gz_result measure_errors(struct measurer *measurer, const struct unit *unit,
				     struct gz_study_row *rows)
{
	const struct gz_study *study = measurer->study;
	double path_errors[GZ_STUDY_LIST_MAX] = { 0 };
	enum gz_result result = GZ_OK;
	if (study->accuracy == GZ_STUDY_ACCURACY_NONE)
		return GZ_OK;
	if (study->accuracy == GZ_STUDY_ACCURACY_ALL)
		result = find_reference(measurer, unit);
	if (result == GZ_OK)
		result = gz_error_weights_make(&measurer->weights, &unit->display, unit->gaze,
					       unit->width, unit->height, measurer->workers);
	if (result == GZ_OK && study->camera_paths)
		result = measure_camera_path(measurer, unit, path_errors);
	for (size_t variant = 0; variant < study->variant_count && result == GZ_OK; variant++) {
		struct gz_study_row *first = &rows[variant * (size_t)study->frames_per_point];
		if (study->accuracy == GZ_STUDY_ACCURACY_ALL)
			first->reference_db = measurer->reference_db;
		result = measure_variant(measurer, unit, variant, first);
		if (study->camera_paths)
			first->camera_path_error = path_errors[variant];
		for (int k = 1; k < study->frames_per_point; k++) {
			first[k].converged = first->converged;
			first[k].standard = first->standard;
			first[k].flicker = first->flicker;
			first[k].turning_error = first->turning_error;
			first[k].camera_path_error = first->camera_path_error;
			first[k].reference_db = first->reference_db;
		}
	}
	return result;
}

static struct unit unit_at(const struct measurer *measurer, const struct gz_study_row *row)
{
	const struct gz_study *study = measurer->study;
	const uint32_t camera = study->points[row->point].camera;
	return (struct unit) {
		.shown = { row->scene, row->size, row->backend, camera },
		.gaze = row->gaze,
		.camera = gz_study_camera(study, row->scene, camera),
		.display = gz_study_display(study, row->scene, row->size),
		.width = study->sizes[row->size][0],
		.height = study->sizes[row->size][1],
		.maker = measurer->stage->backends[row->backend],
	};
}

/* Time the frames of a unit, then compare one more frame of each variant with the camera not
 * turned. GZ_ERR_CANCELLED: SIGINT or SIGTERM has arrived; not logged. Else what gz_stage_enter()
 * and gz_picture_make() return; logged. */
static enum gz_result measurer_measure(struct measurer *measurer, size_t number,
				       struct gz_study_row *out_rows)
{
	const struct gz_study *study = measurer->study;
	for (size_t k = 0; k < gz_study_unit_rows(study); k++)
		out_rows[k] = gz_study_unit_row(study, number, k);
	enum gz_result result = gz_stage_enter(measurer->stage, study, out_rows->scene, NULL);
	if (result != GZ_OK)
		return gz_command_interrupted() ? GZ_ERR_CANCELLED : result;
	const struct unit unit = unit_at(measurer, out_rows);
	result = time_frames(measurer, &unit, out_rows);
	if (result == GZ_OK)
		result = measure_errors(measurer, &unit, out_rows);
	if (result != GZ_OK && result != GZ_ERR_CANCELLED)
		gz_err(measurer->log, "%s on %s at %dx%d: %s", study->scenes[unit.shown.scene].name,
		       study->backends[unit.shown.backend], unit.width, unit.height,
		       gz_result_text(result));
	return result;
}

/* ---- the run ---- */

/* A run on its way. */
struct run {
	const struct gz_log *log;
	struct gz_study *study;
	struct gz_stage stage;
	struct gz_study_writer *writer;
	struct measurer *measurer;
	struct gz_study_row *rows; /* of one unit */
	struct gz_study_outcome *outcome;
	struct gz_study_listener listener;
	int64_t start_ns;
	double work_before; /* of units that were there already */
};

static size_t unit_number(const struct run *run, size_t i)
{
	return (size_t)run->study->shard + i * (size_t)run->study->shard_count;
}

/* Work of the first units of the shard, measured by their pixels. */
static double work_of(const struct run *run, size_t count)
{
	double work = 0;
	for (size_t i = 0; i < count; i++) {
		const struct gz_study_row row =
			gz_study_unit_row(run->study, unit_number(run, i), 0);
		const int *size = run->study->sizes[row.size];
		work += (double)size[0] * size[1];
	}
	return work;
}

static void tell_progress(const struct run *run, size_t done)
{
	if (!run->listener.progress)
		return;
	const size_t units = run->outcome->units;
	const double all = work_of(run, units), now = work_of(run, done);
	const double spent_s = gz_ns_to_s(gz_clock_now_ns() - run->start_ns);
	const struct gz_study_row row =
		gz_study_unit_row(run->study, unit_number(run, done < units ? done : 0), 0);
	const struct gz_study_progress progress = {
		.units = units,
		.done = done,
		.share = all > 0 ? now / all : 1,
		.left_s = now > run->work_before ? spent_s * (all - now) / (now - run->work_before)
						 : NAN,
		.what = run->study->scenes[row.scene].name,
	};
	run->listener.progress(run->listener.user, &progress);
}

static enum gz_result run_units(struct run *run)
{
	struct gz_study_outcome *outcome = run->outcome;
	enum gz_result result = GZ_OK;
	run->start_ns = gz_clock_now_ns();
	run->work_before = work_of(run, outcome->done);
	while (outcome->done < outcome->units && result == GZ_OK) {
		tell_progress(run, outcome->done);
		result =
			measurer_measure(run->measurer, unit_number(run, outcome->done), run->rows);
		if (result == GZ_OK)
			result = gz_study_writer_add(run->writer, run->rows);
		if (result == GZ_OK) {
			outcome->done++;
			outcome->rows += gz_study_unit_rows(run->study);
		}
	}
	if (result == GZ_OK)
		result = gz_study_writer_finish(run->writer);
	outcome->complete = result == GZ_OK;
	tell_progress(run, outcome->done);
	return result;
}

/* The folder gets the descriptions of the renderers of the first unit. */
static enum gz_result describe_backends(struct run *run)
{
	if (gz_study_shard_unit_count(run->study) == 0) {
		gz_err(run->log, "shard %d of %d has nothing to measure: there are only %zu units",
		       run->study->shard + 1, run->study->shard_count,
		       gz_study_unit_count(run->study));
		return GZ_ERR_INVAL;
	}
	const struct gz_study_row row = gz_study_unit_row(run->study, unit_number(run, 0), 0);
	return gz_stage_enter(&run->stage, run->study, row.scene, run->study->machine.backends);
}

static enum gz_result begin_run(struct run *run, const char *folder, const char *cache)
{
	struct gz_study_outcome *outcome = run->outcome;
	size_t done;
	enum gz_result result = describe_backends(run);
	run->rows = calloc(gz_study_unit_rows(run->study), sizeof *run->rows);
	if (result == GZ_OK && !run->rows)
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = measurer_create(run->study, &run->stage, cache, run->log, &run->measurer);
	if (result == GZ_OK)
		result = gz_study_writer_open(folder, run->study, run->log, &run->writer, &done);
	if (result != GZ_OK)
		return result;
	*outcome = (struct gz_study_outcome) {
		.units = gz_study_shard_unit_count(run->study),
		.done = done,
		.resumed = done,
		.rows = done * gz_study_unit_rows(run->study),
	};
	return GZ_OK;
}

enum gz_result gz_study_run(const struct gz_study_request *request, const char *folder,
			    const char *cache, struct gz_study_listener listener,
			    const struct gz_log *log, struct gz_study_outcome *out_outcome)
{
	struct run run = {
		.log = log,
		.study = calloc(1, sizeof *run.study),
		.stage = { .log = log },
		.outcome = out_outcome,
		.listener = listener,
	};
	*out_outcome = (struct gz_study_outcome) { 0 };
	if (!run.study)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_study_folder_check(folder, log); /* before long work */
	if (result == GZ_OK)
		result = gz_study_ask(request, &run.stage, log, run.study);
	if (result == GZ_OK)
		result = begin_run(&run, folder, cache);
	if (result == GZ_OK)
		result = run_units(&run);
	gz_study_writer_destroy(&run.writer);
	measurer_destroy(&run.measurer);
	gz_stage_free(&run.stage);
	free(run.rows);
	gz_study_free(run.study);
	free(run.study);
	return gz_command_interrupted() && result != GZ_OK ? GZ_ERR_CANCELLED : result;
}
