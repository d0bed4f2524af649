/* gazebench techniques: the techniques compared. */
#include "bench/gazebench/gazebench.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"
#include "bench/comparison/comparison.h"
#include "bench/report/comparison_report.h"
#include "bench/study/errors.h"

#define GZ_LOG_MODULE "gazebench"

enum { LIST_SIZE = 8192 };

struct settings {
	struct gz_command_common common;
	char out[GZ_PATH_SIZE];
	char methods[LIST_SIZE];
	int size[2];
	char backend[LIST_SIZE], techniques[LIST_SIZE], effects[LIST_SIZE];
	int frames, warm_up;
	double turn_deg;
	char camera_path[GZ_PATH_SIZE];
	char isovalue[GZ_NAME_SIZE];
	bool errors;
	char cache[GZ_PATH_SIZE];
	bool json;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for the results, made if it is not there" },
	{ .key = "methods",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(methods),
	  .max = LIST_SIZE,
	  .preset = "acuity",
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
	  .preset = "",
	  .help = "backends, separated by commas (default: all that run here)" },
	{ .key = "techniques",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(techniques),
	  .max = LIST_SIZE,
	  .preset = "",
	  .help = "techniques, separated by commas (default: all)" },
	{ .key = "effects",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(effects),
	  .max = LIST_SIZE,
	  .preset = "",
	  .help = "effects, separated by commas: none, reflection, shadow, both, glass (default: "
		  "all)" },
	{ .key = "frames",
	  .type = GZ_OPTION_INT,
	  .offset = AT(frames),
	  .min = 0,
	  .max = GZ_STUDY_FRAMES_MAX,
	  .preset = "0",
	  .help = "counted frames of each method of each series; 0 = as many as --camera-path has, "
		  "or 6" },
	{ .key = "warm-up",
	  .type = GZ_OPTION_INT,
	  .offset = AT(warm_up),
	  .min = 1,
	  .max = GZ_STUDY_FRAMES_MAX,
	  .preset = "1",
	  .help = "frames before those, not counted" },
	{ .key = "turn",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(turn_deg),
	  .min = -180,
	  .max = 180,
	  .preset = "60",
	  .help = "degrees that the camera turns a frame" },
	{ .key = "camera-path",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(camera_path),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "file of a camera for each frame in place of turning: lines of eye x y z "
		  "look_at x y z [up x y z [fov_deg]], or frames.tsv of a session" },
	{ .key = "isovalue",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(isovalue),
	  .max = GZ_NAME_SIZE,
	  .preset = "",
	  .help = "data value of surfaces (default: the scene's)" },
	{ .key = "errors",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(errors),
	  .preset = "yes",
	  .help = "compare with the converged ray cast" },
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
	  .help = "print techniques.json instead of the table" },
};

static bool check_techniques(const struct settings *settings, const struct gz_operands *scenes,
			     double *out_isovalue, const struct gz_log *log)
{
	*out_isovalue = NAN;
	if (scenes->count < 1)
		gz_err(log, "no scene: gazebench techniques SCENE... --out DIR");
	else if (!settings->out[0])
		gz_err(log, "no folder for the results: name one with --out DIR");
	else if (settings->isovalue[0] && !gz_number_parse(settings->isovalue, out_isovalue))
		gz_err(log, "--isovalue %s: not a number", settings->isovalue);
	else
		return true;
	return false;
}

static enum gz_result write_all(const struct gz_comparison *comparison,
				const struct settings *settings, const struct gz_log *log)
{
	const enum gz_result result = gz_comparison_write(comparison, settings->out, log);
	if (result != GZ_OK)
		return result;
	if (!settings->json) {
		gz_comparison_print(comparison, stdout);
		printf("%s/report.html\n", settings->out);
		return GZ_OK;
	}
	json_t *json = gz_comparison_to_json(comparison);
	const bool printed =
		json && json_dumpf(json, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	json_decref(json);
	printf("\n");
	return printed ? GZ_OK : GZ_ERR_NO_MEM;
}

static int compare_and_write(const struct gz_comparison_request *request,
			     const struct settings *settings, const struct gz_log *log)
{
	struct gz_comparison comparison = { 0 };
	if (mkdir(settings->out, 0777) != 0 && errno != EEXIST) {
		gz_err(log, "%s: cannot be made: %s", settings->out, strerror(errno));
		return GAZEBENCH_FAILED;
	}
	gz_command_catch_signals();
	enum gz_result result = gz_comparison_run(request, log, &comparison);
	if (result == GZ_OK)
		result = write_all(&comparison, settings, log);
	else if (result == GZ_ERR_CANCELLED)
		gz_err(log, "interrupted: nothing is written");
	gz_comparison_free(&comparison);
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

static int run_techniques(int argc, char *const *argv, const struct gz_log *log)
{
	static struct settings settings; /* of some size; a program runs one command */
	struct gz_operands scenes;
	char commit[GZ_STUDY_TEXT_SIZE], cache[GZ_PATH_SIZE];
	double isovalue;
	const int status = gz_command_read_arguments(&gazebench_techniques, argc, argv, log,
						     &settings, &scenes);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (!check_techniques(&settings, &scenes, &isovalue, log))
		return GAZEBENCH_USAGE;
	gz_study_identify(gazebench_commit, "/proc/self/exe", commit);
	const struct gz_comparison_request request = {
		.scenes = scenes.items,
		.scene_count = (size_t)scenes.count,
		.methods = settings.methods,
		.backends = settings.backend,
		.techniques = settings.techniques,
		.effects = settings.effects,
		.width = settings.size[0],
		.height = settings.size[1],
		.frames = settings.frames,
		.warm_up = settings.warm_up,
		.turn_deg = settings.turn_deg,
		.camera_path = settings.camera_path[0] ? settings.camera_path : NULL,
		.isovalue = isovalue,
		.errors = settings.errors,
		.cache = gz_reference_cache(settings.cache, cache),
		.pictures = settings.out,
		.program = "gazebench " GAZECAST_VERSION,
		.commit = commit,
	};
	const enum gz_result called = gz_comparison_check(&request, log);
	if (called != GZ_OK)
		return called == GZ_ERR_INVAL ? GAZEBENCH_USAGE : GAZEBENCH_FAILED;
	return compare_and_write(&request, &settings, log);
}

const struct gz_command gazebench_techniques = {
	.program = "gazebench",
	.name = "techniques",
	.operands = "SCENE...",
	.operands_max = -1,
	.summary = "compare the techniques of drawing a volume",
	.details = "Draws the volume of each scene by each technique and backend, with no effect, "
		   "reflection, shadow\n"
		   "and both where they have them, and with 64, 128 and 512 slices; at every pixel "
		   "and by each method.\n"
		   "Writes techniques.json, frames.csv, charts, pictures and report.html, beside "
		   "printed times of others.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_techniques,
};
