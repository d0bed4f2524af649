/* gazebench accumulate: the gain of keeping earlier frames. */
#include "bench/gazebench/gazebench.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/command.h"
#include "base/log.h"
#include "base/order.h"
#include "base/result.h"
#include "bench/study/ask.h"
#include "bench/study/errors.h"
#include "bench/study/stage.h"
#include "bench/study/study.h"

#define GZ_LOG_MODULE "gazebench"

/* ---- measuring ---- */

/* Frames after which a picture is compared, while gaze and camera are still. Chosen: of each 4^k
 *  frames every shift below 2^k px comes once. */
#define STILL_ROWS 4

/* Frames of a camera that turns, after which its picture is compared. Chosen: what is older has
 *  next to no share left (.9^16 = .19, and rays take its place). */
#define TURNING_FRAMES 16

/* Rows of one variant: still and turning, each without and with earlier frames. */
#define ROWS (1 + STILL_ROWS + 2)

/* One picture. */
struct accumulation_row {
	bool turning;    /* the camera turns from frame to frame */
	int frames;      /* that are in it; 0: a frame by itself, as temporal.accumulate = no */
	double frame_ms; /* median of the frames since the row before */
	struct gz_study_errors errors; /* against the converged picture of the same camera */
};

/* What is measured. */
struct accumulation_request {
	const struct gz_study *study; /* asked for, without rows: gz_study_ask() */
	size_t scene, size, backend, variant, point;
	double turn_deg;   /* of the camera that turns, a frame */
	const char *cache; /* folder of converged pictures; NULL: none are kept */
};

/* Frames that keep nothing, of which the median's time counts; the first warms up. */
enum { ALONE_FRAMES = 6, TIMES_MAX = 64 };

static const int still_frames[STILL_ROWS] = { 1, 4, 16, 64 };

/* A variant in measuring. */
struct pictures {
	const struct accumulation_request *request;
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

/* One frame, as a viewer makes it, and its time. */
static enum gz_result accumulation_frame(struct pictures *pictures, bool kept)
{
	const struct gz_picture_request request = {
		.camera = &pictures->camera,
		.settings = &pictures->settings->rays,
		.foveation = &pictures->settings->foveation,
		.display = &pictures->display,
		.focus = gz_focus_at(pictures->gaze),
		.width = pictures->width,
		.height = pictures->height,
		.temporal = kept ? &pictures->params : NULL,
		.fresh_plan = true,
		.image = &pictures->image,
	};
	struct gz_image *image;
	struct gz_picture_cost cost;
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	const enum gz_result result = gz_picture_make(pictures->maker, &request, &image, &cost);
	if (result == GZ_OK)
		pictures->times_ms[pictures->time_count++ % TIMES_MAX] = cost.total_ms;
	return result;
}

static double take_median(struct pictures *pictures)
{
	const int count = pictures->time_count < TIMES_MAX ? pictures->time_count : TIMES_MAX;
	qsort(pictures->times_ms, (size_t)count, sizeof pictures->times_ms[0], gz_compare_doubles);
	pictures->time_count = 0;
	return count % 2 ? pictures->times_ms[count / 2]
			 : (pictures->times_ms[count / 2 - 1] + pictures->times_ms[count / 2]) / 2;
}

static enum gz_result find_converged(struct pictures *pictures)
{
	const struct accumulation_request *request = pictures->request;
	const struct gz_study *study = request->study;
	char program[2 * GZ_STUDY_TEXT_SIZE];
	snprintf(program, sizeof program, "%s %s", study->machine.program, study->machine.commit);
	const struct gz_reference_request reference = {
		.maker = pictures->stage->cpu,
		.data_hash = study->scenes[request->scene].data_hash,
		.program = program,
		.camera = &pictures->camera,
		.rays = &pictures->stage->scene.settings.rays,
		.display = &pictures->display,
		.width = pictures->width,
		.height = pictures->height,
		.cache = request->cache,
	};
	double db;
	bool made;
	return gz_reference_get(&reference, pictures->log, &pictures->converged,
				&pictures->half_step, &db, &made);
}

static enum gz_result end_row(struct pictures *pictures, bool turning, int frames,
			      struct accumulation_row *out_row)
{
	const double px_per_deg = fmin(fmax(gz_display_px_per_deg(&pictures->display), 1), 1000);
	const enum gz_result result =
		gz_error_maps_make(&pictures->maps, &pictures->converged, &pictures->image,
				   px_per_deg, pictures->workers);
	*out_row = (struct accumulation_row) { turning, frames, take_median(pictures),
					       gz_study_errors_unmeasured() };
	if (result == GZ_OK)
		out_row->errors = gz_error_maps_weigh(&pictures->maps, &pictures->weights);
	return result;
}

static enum gz_result measure_alone(struct pictures *pictures, bool turning,
				    struct accumulation_row *row)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < ALONE_FRAMES && result == GZ_OK; i++) {
		result = accumulation_frame(pictures, false);
		if (i == 0)
			pictures->time_count = 0;
	}
	return result == GZ_OK ? end_row(pictures, turning, 0, row) : result;
}

static enum gz_result measure_still(struct pictures *pictures, struct accumulation_row *rows)
{
	int made = 0;
	enum gz_result result = find_converged(pictures);
	if (result == GZ_OK)
		result = measure_alone(pictures, false, rows++);
	for (int i = 0; i < STILL_ROWS && result == GZ_OK; i++) {
		for (; made < still_frames[i] && result == GZ_OK; made++)
			result = accumulation_frame(pictures, true);
		if (result == GZ_OK)
			result = end_row(pictures, false, made, rows++);
	}
	return result;
}

/* The camera does not stop: the picture of its last place is compared. */
static enum gz_result measure_turning(struct pictures *pictures, struct accumulation_row rows[2])
{
	enum gz_result result = GZ_OK;
	gz_picture_maker_forget(pictures->maker);
	for (int i = 0; i < TURNING_FRAMES && result == GZ_OK; i++) {
		if (i > 0)
			gz_camera_turn(&pictures->camera, pictures->request->turn_deg);
		result = accumulation_frame(pictures, true);
	}
	if (result == GZ_OK)
		result = find_converged(pictures);
	if (result == GZ_OK)
		result = end_row(pictures, true, TURNING_FRAMES, &rows[1]);
	return result == GZ_OK ? measure_alone(pictures, true, &rows[0]) : result;
}

static enum gz_result begin_pictures(struct pictures *pictures)
{
	const struct accumulation_request *request = pictures->request;
	const struct gz_study *study = request->study;
	enum gz_result result = gz_stage_enter(pictures->stage, study, request->scene, NULL);
	if (result != GZ_OK)
		return result;
	if (pictures->stage->scene.volume.bricks) {
		gz_err(pictures->log,
		       "%s: a file of bricks cannot be measured, because it changes while it is "
		       "shown; use the volume itself",
		       study->scenes[request->scene].path);
		return GZ_ERR_UNSUPPORTED;
	}
	pictures->maker = pictures->stage->backends[request->backend];
	pictures->settings = &pictures->stage->variants[request->variant];
	pictures->params = pictures->stage->scene.settings.temporal;
	pictures->params.accumulate = true;
	pictures->gaze = study->points[request->point].gaze;
	pictures->camera =
		gz_study_camera(study, request->scene, study->points[request->point].camera);
	pictures->display = gz_study_display(study, request->scene, request->size);
	pictures->width = study->sizes[request->size][0];
	pictures->height = study->sizes[request->size][1];
	result = gz_workers_create(0, &pictures->workers);
	return result == GZ_OK ? gz_error_weights_make(&pictures->weights, &pictures->display,
						       pictures->gaze, pictures->width,
						       pictures->height, pictures->workers)
			       : result;
}

static void end_pictures(struct pictures *pictures)
{
	gz_workers_destroy(&pictures->workers);
	gz_image_free(&pictures->image);
	gz_image_free(&pictures->converged);
	gz_image_free(&pictures->half_step);
	gz_error_weights_free(&pictures->weights);
	gz_error_maps_free(&pictures->maps);
}

/* Measure a variant: the still rows first, each group by its number of frames. The scene's
 * temporal.weight holds; temporal.accumulate does not count. GZ_ERR_UNSUPPORTED: the scene is a
 * file of bricks; GZ_ERR_CANCELLED: SIGINT or SIGTERM has arrived, not logged. */
static enum gz_result measure_accumulation(const struct accumulation_request *request,
					   struct gz_stage *stage, const struct gz_log *log,
					   struct accumulation_row out_rows[ROWS])
{
	struct pictures *pictures = calloc(1, sizeof *pictures);
	if (!pictures)
		return GZ_ERR_NO_MEM;
	pictures->request = request;
	pictures->log = log;
	pictures->stage = stage;
	enum gz_result result = begin_pictures(pictures);
	if (result == GZ_OK)
		result = measure_still(pictures, out_rows);
	if (result == GZ_OK)
		result = measure_turning(pictures, out_rows + 1 + STILL_ROWS);
	if (result != GZ_OK && result != GZ_ERR_CANCELLED && result != GZ_ERR_UNSUPPORTED)
		gz_err(log, "%s at %dx%d: %s", request->study->variants[request->variant].text,
		       pictures->width, pictures->height, gz_result_text(result));
	end_pictures(pictures);
	free(pictures);
	return result;
}

/* ---- the command ---- */

enum { LIST_SIZE = 8192 };

struct settings {
	struct gz_command_common common;
	char gaze[GZ_NAME_SIZE];
	char methods[LIST_SIZE];
	int size[2];
	char backend[LIST_SIZE];
	double turn_deg;
	char cache[GZ_PATH_SIZE];
	bool json;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "gaze",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(gaze),
	  .max = GZ_NAME_SIZE,
	  .preset = "centre",
	  .help = "where the gaze rests: centre, or X,Y from 0,0 top left to 1,1" },
	{ .key = "methods",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(methods),
	  .max = LIST_SIZE,
	  .preset = "acuity,mdc,ddc",
	  .help = "methods beside standard, with options as for gazebench run" },
	{ .key = "size",
	  .type = GZ_OPTION_SIZE,
	  .offset = AT(size),
	  .min = 1,
	  .max = GZ_IMAGE_SIDE_MAX,
	  .preset = "1024x1024",
	  .help = "picture size, px" },
	{ .key = "backend",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(backend),
	  .max = LIST_SIZE,
	  .preset = "cpu",
	  .help = "backends, separated by commas, as for gazebench run" },
	{ .key = "turn",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(turn_deg),
	  .min = -180,
	  .max = 180,
	  .preset = "0.1",
	  .help = "degrees that the moving camera turns a frame" },
	{ .key = "cache",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(cache),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for converged pictures (default: gazecast/references in the user's "
		  "cache)" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(json),
	  .preset = "no",
	  .help = "print the table as JSON" },
};

/* A command's run. */
struct session {
	const struct settings *settings;
	const struct gz_log *log;
	struct gz_study study;
	struct gz_stage stage;
	const char *cache; /* NULL: none */
	json_t *list;      /* NULL: words */
};

static json_t *error_number(double value)
{
	return isfinite(value) ? json_real(value) : isnan(value) ? json_null() : json_string("inf");
}

static void add_accumulation_json(const struct session *session,
				  const struct accumulation_request *at,
				  const struct accumulation_row *row)
{
	const struct gz_study *study = &session->study;
	const struct gz_study_errors *errors = &row->errors;
	json_array_append_new(
		session->list,
		json_pack("{ss ss ss ss so so so so so so so so}", "scene",
			  study->scenes[at->scene].name, "transfer",
			  study->scenes[at->scene].transfer, "backend",
			  study->backends[at->backend], "variant",
			  study->variants[at->variant].text, "turn_deg",
			  error_number(row->turning ? at->turn_deg : 0), "frames",
			  json_integer(row->frames), "frame_ms", error_number(row->frame_ms),
			  "psnr_db", error_number(errors->psnr_db), "ssim",
			  error_number(errors->ssim), "flip", error_number(errors->flip),
			  "perceived_flip", error_number(errors->perceived_flip), "foveal_flip",
			  error_number(errors->foveal_flip)));
}

static void print_row(const struct accumulation_row *row)
{
	char frames[32] = "by itself";
	if (row->frames > 0)
		snprintf(frames, sizeof frames, "%d", row->frames);
	printf("  %-7s %9s %8.2f %9.2f %7.4f %15.4f\n", row->turning ? "turns" : "still", frames,
	       row->frame_ms, row->errors.psnr_db, row->errors.flip, row->errors.perceived_flip);
}

static enum gz_result accumulate_variant(struct session *session,
					 const struct accumulation_request *at)
{
	const struct gz_study *study = &session->study;
	struct accumulation_row rows[ROWS];
	const enum gz_result result = measure_accumulation(at, &session->stage, session->log, rows);
	if (result != GZ_OK)
		return result;
	if (!session->list)
		printf("%s, %s, %s, %s\n  %-7s %9s %8s %9s %7s %15s\n",
		       study->scenes[at->scene].name, study->scenes[at->scene].transfer,
		       study->backends[at->backend], study->variants[at->variant].text, "camera",
		       "frames", "ms", "PSNR, dB", "FLIP", "perceived FLIP");
	for (int i = 0; i < ROWS; i++)
		if (session->list)
			add_accumulation_json(session, at, &rows[i]);
		else
			print_row(&rows[i]);
	fflush(stdout);
	return GZ_OK;
}

static enum gz_result accumulate_all(struct session *session)
{
	const struct gz_study *study = &session->study;
	struct accumulation_request at = { .study = study,
					   .turn_deg = session->settings->turn_deg,
					   .cache = session->cache };
	enum gz_result result = GZ_OK;
	for (at.scene = 0; at.scene < study->scene_count; at.scene++)
		for (at.backend = 0; at.backend < study->backend_count; at.backend++)
			for (at.variant = 0; at.variant < study->variant_count && result == GZ_OK;
			     at.variant++)
				result = accumulate_variant(session, &at);
	return result;
}

static int measure_asked(struct session *session, const struct gz_study_request *request)
{
	if (gz_study_ask(request, &session->stage, session->log, &session->study) != GZ_OK)
		return GAZEBENCH_FAILED;
	const enum gz_result result = accumulate_all(session);
	if (session->list && result == GZ_OK) {
		json_dumpf(session->list, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
		printf("\n");
	}
	if (result == GZ_ERR_CANCELLED)
		gz_err(session->log,
		       "interrupted: the rows above are complete, the others are missing");
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

static bool check_accumulate(const struct settings *settings, const struct gz_operands *scenes,
			     const struct gz_study_request *request, const struct gz_log *log)
{
	if (scenes->count < 1)
		gz_err(log, "no scene: gazebench accumulate SCENE...");
	else if (strcmp(settings->gaze, "centre") != 0 && !strchr(settings->gaze, ','))
		gz_err(log, "--gaze %s: one place, centre or X,Y", settings->gaze);
	else
		return gz_study_check(request, log) == GZ_OK;
	return false;
}

static int run_accumulate(int argc, char *const *argv, const struct gz_log *log)
{
	static struct settings settings; /* of some size; a program runs one command */
	struct gz_operands scenes;
	char commit[GZ_STUDY_TEXT_SIZE], size[GZ_NAME_SIZE], cache[GZ_PATH_SIZE];
	int status = gz_command_read_arguments(&gazebench_accumulate, argc, argv, log, &settings,
					       &scenes);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	gz_study_identify(gazebench_commit, "/proc/self/exe", commit);
	snprintf(size, sizeof size, "%dx%d", settings.size[0], settings.size[1]);
	const struct gz_study_request request = {
		.scenes = scenes.items,
		.scene_count = (size_t)scenes.count,
		.methods = settings.methods,
		.sizes = size,
		.backends = settings.backend,
		.path = settings.gaze,
		.frames = 1,
		.shard_count = 1,
		.accuracy = GZ_STUDY_ACCURACY_ALL,
		.program = "gazebench " GAZECAST_VERSION,
		.commit = commit,
	};
	if (!check_accumulate(&settings, &scenes, &request, log))
		return GAZEBENCH_USAGE;
	struct session session = { .settings = &settings,
				   .log = log,
				   .stage = { .log = log },
				   .cache = gz_reference_cache(settings.cache, cache),
				   .list = settings.json ? json_array() : NULL };
	gz_command_catch_signals();
	status = measure_asked(&session, &request);
	json_decref(session.list);
	gz_stage_free(&session.stage);
	gz_study_free(&session.study);
	return status;
}

const struct gz_command gazebench_accumulate = {
	.program = "gazebench",
	.name = "accumulate",
	.operands = "SCENE...",
	.operands_max = -1,
	.summary = "measure what keeping earlier frames gains",
	.details = "Prints the time of a frame and the error of each method's picture against the "
		   "converged one, with\n"
		   "temporal.accumulate: after 1, 4, 16 and 64 frames while gaze and camera are "
		   "still, and for the\n"
		   "last of 16 frames while the camera turns. \"by itself\" is a frame that keeps "
		   "nothing.\n"
		   "gazebench run measures without accumulation.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_accumulate,
};
