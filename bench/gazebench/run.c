/* gazebench run: measure; make a study. */
#include "bench/gazebench/gazebench.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text.h"
#include "bench/study/errors.h"
#include "bench/study/run.h"
#include "bench/study/study.h"

#define GZ_LOG_MODULE "gazebench"

enum { LIST_SIZE = 8192 };

struct settings {
	struct gz_command_common common;
	char out[GZ_PATH_SIZE];
	char path[GZ_PATH_SIZE];
	char methods[LIST_SIZE];
	char size[LIST_SIZE];
	char backend[LIST_SIZE];
	int frames, warm_up, seed, cameras;
	char camera_path[GZ_PATH_SIZE];
	char shard[GZ_NAME_SIZE];
	double min_move_px;
	bool per_cell;
	int accuracy;
	char cache[GZ_PATH_SIZE];
	double display_mm[2], display_distance_mm;
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
	  .help = "folder of the study: a new one, or one to resume" },
	{ .key = "path",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(path),
	  .max = GZ_PATH_SIZE,
	  .preset = "sweep:s:64",
	  .help = "where the gaze goes: sweep:s, sweep:s:N, grid:NxM, random:N, centre, X,Y, "
		  "FILE.csv (shares), FILE.csv:WxH (pixels), FILE.gzl (one point a fixation), "
		  "FILE.gzl:samples" },
	{ .key = "methods",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(methods),
	  .max = LIST_SIZE,
	  .preset = "acuity,mdc,ddc",
	  .help = "methods to compare with standard, separated by commas, each with options of "
		  "[foveation] and [render]: mdc:mdc_spacing=3:blend_px=20" },
	{ .key = "size",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(size),
	  .max = LIST_SIZE,
	  .preset = "1024x1024",
	  .help = "picture sizes, px, separated by commas" },
	{ .key = "backend",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(backend),
	  .max = LIST_SIZE,
	  .preset = "cpu",
	  .help = "backends, separated by commas: gl, cpu, cpu:threads=2, cpu:simd=avx2" },
	{ .key = "frames",
	  .type = GZ_OPTION_INT,
	  .offset = AT(frames),
	  .min = 1,
	  .max = GZ_STUDY_FRAMES_MAX,
	  .preset = "5",
	  .help = "counted frames of each method at each point" },
	{ .key = "warm-up",
	  .type = GZ_OPTION_INT,
	  .offset = AT(warm_up),
	  .min = 0,
	  .max = GZ_STUDY_FRAMES_MAX,
	  .preset = "1",
	  .help = "warm-up frames before those, not counted" },
	{ .key = "shard",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(shard),
	  .max = GZ_NAME_SIZE,
	  .preset = "1/1",
	  .help = "I/N measures part I of N; gazebench merge joins the parts" },
	{ .key = "seed",
	  .type = GZ_OPTION_INT,
	  .offset = AT(seed),
	  .min = 0,
	  .max = 2147483647,
	  .preset = "1",
	  .help = "seed for random gaze points and cameras" },
	{ .key = "cameras",
	  .type = GZ_OPTION_INT,
	  .offset = AT(cameras),
	  .min = 0,
	  .max = 100000,
	  .preset = "0",
	  .help = "number of random cameras around the object, taken in turn; 0 = the scene's "
		  "camera" },
	{ .key = "min-move",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(min_move_px),
	  .min = 0,
	  .max = 32768,
	  .preset = "0",
	  .help = "skip points closer than this to the previous one, px of the first size" },
	{ .key = "per-cell",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(per_cell),
	  .preset = "no",
	  .help = "keep one point in each cell of a 10x10 grid" },
	{ .key = "errors",
	  .type = GZ_OPTION_CHOICE,
	  .offset = AT(accuracy),
	  .choices = gz_study_accuracy_names,
	  .preset = "all",
	  .help = "reference for errors: all = standard and the converged picture" },
	{ .key = "camera-path",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(camera_path),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "file with a camera for each frame, 60 frames a second: also measure what the "
		  "eye sees come and go along it; lines of eye x y z, look_at x y z [up x y z "
		  "[fov_deg]], or frames.tsv of a session" },
	{ .key = "cache",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(cache),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for converged pictures (default: gazecast/references in the user's "
		  "cache)" },
	{ .key = "display-mm",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(display_mm),
	  .min = 1,
	  .max = 100000,
	  .count = 2,
	  .help = "width and height of the display that the picture fills, mm, as \"565 318\"" },
	{ .key = "distance-mm",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(display_distance_mm),
	  .min = 1,
	  .max = 100000,
	  .help = "from the eye to the display, mm" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = AT(json),
	  .preset = "no",
	  .help = "print the result as JSON" },
};

/* ---- progress ---- */

struct progress {
	bool terminal;
	int64_t next_ns; /* when the next line is due, where stderr is no terminal */
};

static void print_time(double seconds, char *text, size_t size)
{
	if (isnan(seconds))
		snprintf(text, size, "?");
	else if (seconds < 3600)
		snprintf(text, size, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
	else
		snprintf(text, size, "%dh%02d", (int)(seconds / 3600), (int)(seconds / 60) % 60);
}

/* One line that replaces itself on a terminal; else one each ten seconds. */
static void show_progress(void *user, const struct gz_study_progress *now)
{
	struct progress *progress = user;
	char left[32];
	const int64_t now_ns = gz_clock_now_ns();
	const bool end = now->done == now->units;
	print_time(now->left_s, left, sizeof left);
	if (progress->terminal) {
		if (end)
			fputs("\r\033[K", stderr);
		else
			fprintf(stderr, "\r\033[K%zu of %zu, %.0f %%, %s left: %.40s", now->done,
				now->units, 100 * now->share, left, now->what);
		fflush(stderr);
	} else if (!end && now_ns >= progress->next_ns) {
		if (progress->next_ns > 0)
			fprintf(stderr, "gazebench: %zu of %zu, %.0f %%, %s left: %s\n", now->done,
				now->units, 100 * now->share, left, now->what);
		progress->next_ns = now_ns + 10 * GZ_NS_PER_S;
	}
}

/* ---- the outcome ---- */

static void print_run(const struct settings *settings, const struct gz_study_outcome *outcome)
{
	if (settings->json) {
		json_t *json = json_pack(
			"{ss sb sI sI sI sI}", "out", settings->out, "complete", outcome->complete,
			"units", (json_int_t)outcome->units, "done", (json_int_t)outcome->done,
			"resumed", (json_int_t)outcome->resumed, "rows", (json_int_t)outcome->rows);
		json_dumpf(json, stdout, JSON_INDENT(1));
		printf("\n");
		json_decref(json);
		return;
	}
	printf("%s: %zu of %zu units, %zu rows%s\n", settings->out, outcome->done, outcome->units,
	       outcome->rows, outcome->complete ? "" : ", incomplete");
}

static int exit_of(enum gz_result result, const struct settings *settings,
		   const struct gz_study_outcome *outcome, const struct gz_log *log)
{
	if (result == GZ_OK)
		return GAZEBENCH_DONE;
	if (outcome->units == 0 || (result != GZ_ERR_CANCELLED && result != GZ_ERR_FULL))
		return result == GZ_ERR_CANCELLED ? GAZEBENCH_PARTIAL : GAZEBENCH_FAILED;
	gz_warn(log, "%s holds %zu of %zu units: run the same command again to resume",
		settings->out, outcome->done, outcome->units);
	return GAZEBENCH_PARTIAL;
}

/* ---- the command line ---- */

static bool parse_shard(const char *text, int *out_shard, int *out_count)
{
	char part[GZ_NAME_SIZE];
	long long shard, count;
	const char *slash = strchr(text, '/');
	if (!slash)
		return false;
	snprintf(part, sizeof part, "%.*s", (int)(slash - text), text);
	if (!gz_number_parse_whole(part, &shard) || !gz_number_parse_whole(slash + 1, &count) ||
	    count < 1 || count > 1000000 || shard < 1 || shard > count)
		return false;
	*out_shard = (int)shard - 1;
	*out_count = (int)count;
	return true;
}

static bool check_run(const struct settings *settings, const struct gz_operands *scenes,
		      const struct gz_log *log)
{
	if (scenes->count < 1)
		gz_err(log, "no scene: gazebench run SCENE... --out DIR");
	else if (!settings->out[0])
		gz_err(log, "no folder for the study: name one with --out DIR");
	else
		return true;
	return false;
}

static int run_run(int argc, char *const *argv, const struct gz_log *log)
{
	static struct settings settings; /* of some size; a program runs one command */
	struct gz_operands scenes;
	char commit[GZ_STUDY_TEXT_SIZE];
	int status = gz_command_read_arguments(&gazebench_run, argc, argv, log, &settings, &scenes);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	struct gz_study_request request = {
		.scenes = scenes.items,
		.scene_count = (size_t)scenes.count,
		.methods = settings.methods,
		.sizes = settings.size,
		.backends = settings.backend,
		.path = settings.path,
		.camera_path = settings.camera_path[0] ? settings.camera_path : NULL,
		.min_move_px = settings.min_move_px,
		.per_cell = settings.per_cell,
		.cameras = (uint32_t)settings.cameras,
		.seed = (uint64_t)settings.seed,
		.frames = settings.frames,
		.warm_up = settings.warm_up,
		.accuracy = (enum gz_study_accuracy)settings.accuracy,
		.display_distance_mm = settings.display_distance_mm,
		.program = "gazebench " GAZECAST_VERSION,
		.commit = commit,
	};
	gz_study_identify(gazebench_commit, "/proc/self/exe", commit);
	memcpy(request.display_mm, settings.display_mm, sizeof request.display_mm);
	if (!check_run(&settings, &scenes, log))
		return GAZEBENCH_USAGE;
	if (!parse_shard(settings.shard, &request.shard, &request.shard_count)) {
		gz_err(log, "--shard %s: write I/N, the I-th of N parts, I from 1 to N",
		       settings.shard);
		return GAZEBENCH_USAGE;
	}
	const enum gz_result called = gz_study_check(&request, log);
	if (called != GZ_OK)
		return called == GZ_ERR_INVAL ? GAZEBENCH_USAGE : GAZEBENCH_FAILED;
	char cache[GZ_PATH_SIZE];
	const char *kept = gz_reference_cache(settings.cache, cache);
	struct progress progress = { .terminal = isatty(STDERR_FILENO) };
	struct gz_study_outcome outcome;
	gz_command_catch_signals();
	const enum gz_result result = gz_study_run(
		&request, settings.out, kept,
		(struct gz_study_listener) { show_progress, &progress }, log, &outcome);
	if (progress.terminal && result != GZ_OK)
		fputs("\r\033[K", stderr);
	if (outcome.units > 0)
		print_run(&settings, &outcome);
	return exit_of(result, &settings, &outcome, log);
}

const struct gz_command gazebench_run = {
	.program = "gazebench",
	.name = "run",
	.operands = "SCENE...",
	.operands_max = -1,
	.summary = "measure methods on scenes: make a study",
	.details = "Replays a gaze path through standard and each method, on each backend, at each "
		   "size, and\n"
		   "writes a study: a folder with study.json and frames.csv, one row a frame.\n"
		   "Run the same command again to resume an interrupted study.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_run,
};
