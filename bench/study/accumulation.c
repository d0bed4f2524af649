#include "bench/study/accumulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/command.h"
#include "bench/study/errors.h"

#define GZ_LOG_MODULE "study"

/* Frames that keep nothing, of which the median's time counts; the first warms up. */
enum { ALONE_FRAMES = 6, TIMES_MAX = 64 };

const int gz_accumulation_still_frames[GZ_ACCUMULATION_STILL_ROWS] = { 1, 4, 16, 64 };

/* A variant in measuring. */
struct run {
	const struct gz_accumulation_request *request;
	const struct gz_log *log;
	struct gz_stage *stage;
	struct gz_picture_maker *maker;
	struct gz_variant_settings *settings;
	struct gz_temporal_params params;
	struct gz_point gaze;
	struct gz_camera camera;
	struct gz_display display;
	int width, height;
	struct gz_workers *workers;
	struct gz_image image, converged, half_step;
	struct gz_error_weights weights;
	struct gz_error_maps maps;
	double times_ms[TIMES_MAX]; /* of frames since the last row */
	int time_count;
};

/* One frame, as a viewer makes it, and what it takes. */
static enum gz_result frame(struct run *run, bool kept)
{
	const struct gz_picture_request request = {
		.camera = &run->camera,
		.settings = &run->settings->rays,
		.foveation = &run->settings->foveation,
		.display = &run->display,
		.focus = gz_focus_at(run->gaze),
		.width = run->width,
		.height = run->height,
		.temporal = kept ? &run->params : NULL,
		.fresh_plan = true,
		.image = &run->image,
	};
	struct gz_image *image;
	struct gz_picture_cost cost;
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	const enum gz_result result = gz_picture_make(run->maker, &request, &image, &cost);
	if (result == GZ_OK)
		run->times_ms[run->time_count++ % TIMES_MAX] = cost.total_ms;
	return result;
}

static int compare_frame_times(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double take_median(struct run *run)
{
	const int count = run->time_count < TIMES_MAX ? run->time_count : TIMES_MAX;
	qsort(run->times_ms, (size_t)count, sizeof run->times_ms[0], compare_frame_times);
	run->time_count = 0;
	return count % 2 ? run->times_ms[count / 2]
			 : (run->times_ms[count / 2 - 1] + run->times_ms[count / 2]) / 2;
}

static enum gz_result find_converged(struct run *run)
{
	const struct gz_accumulation_request *request = run->request;
	const struct gz_study *study = request->study;
	char program[2 * GZ_STUDY_TEXT_SIZE];
	snprintf(program, sizeof program, "%s %s", study->machine.program, study->machine.commit);
	const struct gz_reference_request reference = {
		.maker = run->stage->cpu,
		.data_hash = study->scenes[request->scene].data_hash,
		.program = program,
		.camera = &run->camera,
		.rays = &run->stage->scene.settings.rays,
		.display = &run->display,
		.width = run->width,
		.height = run->height,
		.cache = request->cache,
	};
	double db;
	bool made;
	return gz_reference_get(&reference, run->log, &run->converged, &run->half_step, &db, &made);
}

static enum gz_result end_row(struct run *run, bool turning, int frames,
			      struct gz_accumulation_row *out_row)
{
	const double px_per_deg = fmin(fmax(gz_display_px_per_deg(&run->display), 1), 1000);
	const enum gz_result result = gz_error_maps_make(&run->maps, &run->converged, &run->image,
							 px_per_deg, run->workers);
	*out_row = (struct gz_accumulation_row) { turning, frames, take_median(run),
						  gz_study_errors_unmeasured() };
	if (result == GZ_OK)
		out_row->errors = gz_error_maps_weigh(&run->maps, &run->weights);
	return result;
}

static enum gz_result measure_alone(struct run *run, bool turning, struct gz_accumulation_row *row)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < ALONE_FRAMES && result == GZ_OK; i++) {
		result = frame(run, false);
		if (i == 0)
			run->time_count = 0;
	}
	return result == GZ_OK ? end_row(run, turning, 0, row) : result;
}

static enum gz_result measure_still(struct run *run, struct gz_accumulation_row *rows)
{
	int made = 0;
	enum gz_result result = find_converged(run);
	if (result == GZ_OK)
		result = measure_alone(run, false, rows++);
	for (int i = 0; i < GZ_ACCUMULATION_STILL_ROWS && result == GZ_OK; i++) {
		for (; made < gz_accumulation_still_frames[i] && result == GZ_OK; made++)
			result = frame(run, true);
		if (result == GZ_OK)
			result = end_row(run, false, made, rows++);
	}
	return result;
}

/* The camera comes to rest nowhere: what is compared is the picture of its last place. */
static enum gz_result measure_turning(struct run *run, struct gz_accumulation_row rows[2])
{
	enum gz_result result = GZ_OK;
	gz_picture_maker_forget(run->maker);
	for (int i = 0; i < GZ_ACCUMULATION_TURNING_FRAMES && result == GZ_OK; i++) {
		if (i > 0)
			gz_camera_turn(&run->camera, run->request->turn_deg);
		result = frame(run, true);
	}
	if (result == GZ_OK)
		result = find_converged(run);
	if (result == GZ_OK)
		result = end_row(run, true, GZ_ACCUMULATION_TURNING_FRAMES, &rows[1]);
	return result == GZ_OK ? measure_alone(run, true, &rows[0]) : result;
}

static enum gz_result begin_pictures(struct run *run)
{
	const struct gz_accumulation_request *request = run->request;
	const struct gz_study *study = request->study;
	enum gz_result result = gz_stage_enter(run->stage, study, request->scene, NULL);
	if (result != GZ_OK)
		return result;
	if (run->stage->scene.volume.bricks) {
		gz_err(run->log,
		       "%s: frames are not kept with a file of bricks, which changes while it is "
		       "looked at; take the volume itself",
		       study->scenes[request->scene].path);
		return GZ_ERR_UNSUPPORTED;
	}
	run->maker = run->stage->backends[request->backend];
	run->settings = &run->stage->variants[request->variant];
	run->params = run->stage->scene.settings.temporal;
	run->params.accumulate = true;
	run->gaze = study->points[request->point].gaze;
	run->camera = gz_study_camera(study, request->scene, study->points[request->point].camera);
	run->display = gz_study_display(study, request->scene, request->size);
	run->width = study->sizes[request->size][0];
	run->height = study->sizes[request->size][1];
	result = gz_workers_create(0, &run->workers);
	return result == GZ_OK ? gz_error_weights_make(&run->weights, &run->display, run->gaze,
						       run->width, run->height, run->workers)
			       : result;
}

static void end_pictures(struct run *run)
{
	gz_workers_destroy(&run->workers);
	gz_image_free(&run->image);
	gz_image_free(&run->converged);
	gz_image_free(&run->half_step);
	gz_error_weights_free(&run->weights);
	gz_error_maps_free(&run->maps);
}

enum gz_result gz_accumulation_measure(const struct gz_accumulation_request *request,
				       struct gz_stage *stage, const struct gz_log *log,
				       struct gz_accumulation_row out_rows[GZ_ACCUMULATION_ROWS])
{
	struct run *run = calloc(1, sizeof *run);
	if (!run)
		return GZ_ERR_NO_MEM;
	run->request = request;
	run->log = log;
	run->stage = stage;
	enum gz_result result = begin_pictures(run);
	if (result == GZ_OK)
		result = measure_still(run, out_rows);
	if (result == GZ_OK)
		result = measure_turning(run, out_rows + 1 + GZ_ACCUMULATION_STILL_ROWS);
	if (result != GZ_OK && result != GZ_ERR_CANCELLED && result != GZ_ERR_UNSUPPORTED)
		gz_err(log, "%s at %dx%d: %s", request->study->variants[request->variant].text,
		       run->width, run->height, gz_result_text(result));
	end_pictures(run);
	free(run);
	return result;
}
