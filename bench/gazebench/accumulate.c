/* gazebench accumulate: what keeping earlier frames gains. */
#include "bench/gazebench/gazebench.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/study/accumulation.h"
#include "bench/study/ask.h"
#include "bench/study/errors.h"
#include "bench/study/study.h"

#define GZ_LOG_MODULE "gazebench"

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

static void add_json(const struct session *session, const struct gz_accumulation_request *at,
		     const struct gz_accumulation_row *row)
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

static void print_row(const struct gz_accumulation_row *row)
{
	char frames[32] = "by itself";
	if (row->frames > 0)
		snprintf(frames, sizeof frames, "%d", row->frames);
	printf("  %-7s %9s %8.2f %9.2f %7.4f %15.4f\n", row->turning ? "turns" : "still", frames,
	       row->frame_ms, row->errors.psnr_db, row->errors.flip, row->errors.perceived_flip);
}

static enum gz_result accumulate_variant(struct session *session,
					 const struct gz_accumulation_request *at)
{
	const struct gz_study *study = &session->study;
	struct gz_accumulation_row rows[GZ_ACCUMULATION_ROWS];
	const enum gz_result result =
		gz_accumulation_measure(at, &session->stage, session->log, rows);
	if (result != GZ_OK)
		return result;
	if (!session->list)
		printf("%s, %s, %s, %s\n  %-7s %9s %8s %9s %7s %15s\n",
		       study->scenes[at->scene].name, study->scenes[at->scene].transfer,
		       study->backends[at->backend], study->variants[at->variant].text, "camera",
		       "frames", "ms", "PSNR, dB", "FLIP", "perceived FLIP");
	for (int i = 0; i < GZ_ACCUMULATION_ROWS; i++)
		if (session->list)
			add_json(session, at, &rows[i]);
		else
			print_row(&rows[i]);
	fflush(stdout);
	return GZ_OK;
}

static enum gz_result accumulate_all(struct session *session)
{
	const struct gz_study *study = &session->study;
	struct gz_accumulation_request at = { .study = study,
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
		gz_err(session->log, "interrupted: the rows above are whole, the others missing");
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
