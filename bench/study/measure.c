#include "bench/study/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/command.h"
#include "bench/study/errors.h"
#include "bench/study/reference.h"

#define GZ_LOG_MODULE "study"

/* What a picture is of, but for its gaze. */
struct shown {
	size_t scene, size, backend;
	uint32_t camera;
};

struct gz_measurer {
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
	struct gz_error_maps maps;  /* of what is in the making */
	struct gz_error_maps whole; /* of standard against converged */
	struct shown whole_of;      /* what whole is of */
	bool has_whole;             /* whole is of something */
	struct gz_error_weights weights;
	struct gz_map scratch;
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

enum gz_result gz_measurer_create(const struct gz_study *study, struct gz_stage *stage,
				  const char *cache, const struct gz_log *log,
				  struct gz_measurer **out_measurer)
{
	struct gz_measurer *measurer = calloc(1, sizeof *measurer);
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

void gz_measurer_destroy(struct gz_measurer **measurer)
{
	struct gz_measurer *self = *measurer;
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

static enum gz_result make_picture(struct gz_measurer *measurer, const struct unit *unit,
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
static enum gz_result time_frame(struct gz_measurer *measurer, const struct unit *unit,
				 size_t variant, const struct gz_camera *camera,
				 struct gz_study_row *row)
{
	const struct asked_picture asked = { variant, camera, unit->gaze, true, &measurer->frame };
	struct gz_picture_cost cost;
	const enum gz_result result = make_picture(measurer, unit, &asked, &cost);
	if (result != GZ_OK)
		return result;
	row->plan_ms = cost.plan_ms;
	row->frame_ms = cost.total_ms;
	row->cast_ms = cost.stats.cast_ms;
	row->reconstruct_ms = cost.stats.reconstruct_ms;
	row->gpu_ms = cost.stats.gpu_ms;
	row->rays = cost.stats.rays;
	row->samples = cost.stats.samples;
	return GZ_OK;
}

/* All rounds. Rows of a variant's frames follow each other. */
static enum gz_result time_frames(struct gz_measurer *measurer, const struct unit *unit,
				  struct gz_study_row *rows)
{
	const struct gz_study *study = measurer->study;
	struct gz_camera camera = unit->camera;
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
		}
		gz_camera_turn(&camera, GZ_MEASURE_TURN_DEG);
	}
	return GZ_OK;
}

/* ---- errors ---- */

static bool same_picture(const struct shown *a, const struct shown *b)
{
	return a->scene == b->scene && a->size == b->size && a->camera == b->camera;
}

static double px_per_deg(const struct unit *unit)
{
	return fmin(fmax(gz_display_px_per_deg(&unit->display), 1), 1000);
}

static enum gz_result find_reference(struct gz_measurer *measurer, const struct unit *unit)
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

static enum gz_result picture(struct gz_measurer *measurer, const struct unit *unit, size_t variant,
			      struct gz_point gaze, struct gz_image *image)
{
	const struct asked_picture asked = { variant, &unit->camera, gaze, false, image };
	return gz_command_interrupted() ? GZ_ERR_CANCELLED
					: make_picture(measurer, unit, &asked, NULL);
}

/* Mean change while the gaze goes from its place by a pixel to the right, and by one down. */
static enum gz_result find_flicker(struct gz_measurer *measurer, const struct unit *unit,
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
		enum gz_result result = picture(measurer, unit, variant, gaze, &measurer->trembled);
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

/* Standard against converged: the same maps wherever the gaze is. */
static enum gz_result measure_standard(struct gz_measurer *measurer, const struct unit *unit,
				       struct gz_study_row *row)
{
	const bool converged = measurer->study->accuracy == GZ_STUDY_ACCURACY_ALL;
	const bool same = measurer->has_whole && same_picture(&measurer->whole_of, &unit->shown) &&
			  measurer->whole_of.backend == unit->shown.backend &&
			  !gz_foveation_follows_gaze(&measurer->stage->variants[0].foveation);
	enum gz_result result = GZ_OK;
	if (!same)
		result = picture(measurer, unit, 0, unit->gaze, &measurer->standard);
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
	if (converged)
		row->converged = gz_error_maps_weigh(&measurer->whole, &measurer->weights);
	return GZ_OK;
}

static enum gz_result compare(struct gz_measurer *measurer, const struct unit *unit,
			      const struct gz_image *reference, struct gz_study_errors *out_errors)
{
	const enum gz_result result = gz_error_maps_make(
		&measurer->maps, reference, &measurer->test, px_per_deg(unit), measurer->workers);
	if (result == GZ_OK)
		*out_errors = gz_error_maps_weigh(&measurer->maps, &measurer->weights);
	return result;
}

static enum gz_result measure_variant(struct gz_measurer *measurer, const struct unit *unit,
				      size_t variant, struct gz_study_row *row)
{
	if (variant == 0)
		return measure_standard(measurer, unit, row);
	enum gz_result result = picture(measurer, unit, variant, unit->gaze, &measurer->test);
	if (result == GZ_OK)
		result = compare(measurer, unit, &measurer->standard, &row->standard);
	if (result == GZ_OK && measurer->study->accuracy == GZ_STUDY_ACCURACY_ALL)
		result = compare(measurer, unit, &measurer->converged, &row->converged);
	if (result == GZ_OK)
		result = find_flicker(measurer, unit, variant, &measurer->test, &row->flicker);
	return result;
}

static enum gz_result measure_errors(struct gz_measurer *measurer, const struct unit *unit,
				     struct gz_study_row *rows)
{
	const struct gz_study *study = measurer->study;
	enum gz_result result = GZ_OK;
	if (study->accuracy == GZ_STUDY_ACCURACY_NONE)
		return GZ_OK;
	if (study->accuracy == GZ_STUDY_ACCURACY_ALL)
		result = find_reference(measurer, unit);
	if (result == GZ_OK)
		result = gz_error_weights_make(&measurer->weights, &unit->display, unit->gaze,
					       unit->width, unit->height, measurer->workers);
	for (size_t variant = 0; variant < study->variant_count && result == GZ_OK; variant++) {
		struct gz_study_row *first = &rows[variant * (size_t)study->frames_per_point];
		if (study->accuracy == GZ_STUDY_ACCURACY_ALL)
			first->reference_db = measurer->reference_db;
		result = measure_variant(measurer, unit, variant, first);
		for (int k = 1; k < study->frames_per_point; k++) {
			first[k].converged = first->converged;
			first[k].standard = first->standard;
			first[k].flicker = first->flicker;
			first[k].reference_db = first->reference_db;
		}
	}
	return result;
}

static struct unit unit_of(const struct gz_measurer *measurer, const struct gz_study_row *row)
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

enum gz_result gz_measurer_measure(struct gz_measurer *measurer, size_t number,
				   struct gz_study_row *out_rows)
{
	const struct gz_study *study = measurer->study;
	for (size_t k = 0; k < gz_study_unit_rows(study); k++)
		out_rows[k] = gz_study_unit_row(study, number, k);
	enum gz_result result = gz_stage_enter(measurer->stage, study, out_rows->scene, NULL);
	if (result != GZ_OK)
		return gz_command_interrupted() ? GZ_ERR_CANCELLED : result;
	const struct unit unit = unit_of(measurer, out_rows);
	result = time_frames(measurer, &unit, out_rows);
	if (result == GZ_OK)
		result = measure_errors(measurer, &unit, out_rows);
	if (result != GZ_OK && result != GZ_ERR_CANCELLED)
		gz_err(measurer->log, "%s on %s at %dx%d: %s", study->scenes[unit.shown.scene].name,
		       study->backends[unit.shown.backend], unit.width, unit.height,
		       gz_result_text(result));
	return result;
}
