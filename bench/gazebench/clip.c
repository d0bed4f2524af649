/* gazebench clip: sequences of pictures for metrics of moving pictures. */
#include "bench/clip/clip.h"

#include <stdio.h>

#include "bench/gazebench/gazebench.h"
#include "bench/study/study.h"

#define GZ_LOG_MODULE "gazebench"

enum { LIST_SIZE = 8192 };

/* Pictures that are compared with. */
enum { REFERENCE_STANDARD, REFERENCE_CONVERGED };
static const char *const reference_names[] = { "standard", "converged", NULL };

struct settings {
	struct gz_command_common common;
	char out[GZ_PATH_SIZE];
	char methods[LIST_SIZE];
	int size[2];
	char backend[LIST_SIZE];
	char path[GZ_PATH_SIZE];
	char camera_path[GZ_PATH_SIZE];
	int frames;
	double fps, turn_deg;
	int reference;
	double display_mm[2], display_distance_mm;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for the clip, made if it is not there; it must be empty" },
	{ .key = "methods",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(methods),
	  .max = LIST_SIZE,
	  .preset = "acuity",
	  .help = "methods, separated by commas, with options as for gazebench run" },
	{ .key = "size",
	  .type = GZ_OPTION_SIZE,
	  .offset = AT(size),
	  .min = 1,
	  .max = GZ_IMAGE_SIDE_MAX,
	  .preset = "1920x1080",
	  .help = "picture size, px" },
	{ .key = "backend",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(backend),
	  .max = LIST_SIZE,
	  .preset = "cpu",
	  .help = "backend, as for gazebench run" },
	{ .key = "path",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(path),
	  .max = GZ_PATH_SIZE,
	  .preset = "centre",
	  .help = "where the gaze goes, as for gazebench run: one point a frame, and it rests at "
		  "the last one" },
	{ .key = "frames",
	  .type = GZ_OPTION_INT,
	  .offset = AT(frames),
	  .min = 0,
	  .max = GZ_CLIP_FRAMES_MAX,
	  .preset = "0",
	  .help = "frames; 0 = as many as --camera-path has, or 24" },
	{ .key = "fps",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(fps),
	  .min = 1,
	  .max = 1000,
	  .preset = "60",
	  .help = "frames a second" },
	{ .key = "turn",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(turn_deg),
	  .min = -180,
	  .max = 180,
	  .preset = "0.25",
	  .help = "degrees that the camera turns a frame" },
	{ .key = "camera-path",
	  .type = GZ_OPTION_STRING,
	  .offset = AT(camera_path),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "file with the camera of each frame, instead of --turn: lines of eye x y z, "
		  "look_at x y z [up x y z [fov_deg]], or frames.tsv of a session" },
	{ .key = "reference",
	  .type = GZ_OPTION_CHOICE,
	  .offset = AT(reference),
	  .choices = reference_names,
	  .preset = "standard",
	  .help = "what methods are compared with: standard, or the converged picture" },
	{ .key = "display-mm",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(display_mm),
	  .min = 1,
	  .max = 100000,
	  .count = 2,
	  .help = "width and height of the display that the picture fills, mm" },
	{ .key = "distance-mm",
	  .type = GZ_OPTION_DOUBLE,
	  .offset = AT(display_distance_mm),
	  .min = 1,
	  .max = 100000,
	  .help = "distance from the eye to the display, mm" },
};

static struct gz_clip_request clip_request(const struct settings *settings,
					   const struct gz_operands *scenes, const char *size,
					   const char *commit)
{
	return (struct gz_clip_request) {
		.study = { .scenes = scenes->items,
			   .scene_count = (size_t)scenes->count,
			   .methods = settings->methods,
			   .sizes = size,
			   .backends = settings->backend,
			   .path = settings->path,
			   .frames = 1,
			   .shard_count = 1,
			   .accuracy = GZ_STUDY_ACCURACY_NONE,
			   .display_mm = { settings->display_mm[0], settings->display_mm[1] },
			   .display_distance_mm = settings->display_distance_mm,
			   .program = "gazebench " GAZECAST_VERSION,
			   .commit = commit },
		.frames = settings->frames,
		.fps = settings->fps,
		.turn_deg = settings->turn_deg,
		.camera_path = settings->camera_path[0] ? settings->camera_path : NULL,
		.converged = settings->reference == REFERENCE_CONVERGED,
	};
}

/* How published metrics judge the clip. ColorVideoVDP has no place for the gaze. */
static void print_commands(const struct settings *settings, const struct gz_clip_outcome *outcome)
{
	const char *out = settings->out;
	printf("%s: %d frames of a reference and %zu more; judge them by FovVideoVDP with\n"
	       "/usr/bin/python3 bench/peers/fovvideovdp.py --metric FovVideoVDP %s\n",
	       out, outcome->frames, outcome->tests, out);
	if (outcome->tests == 0)
		return;
	printf("or by ColorVideoVDP, which sees colours but takes the eye for looking everywhere, "
	       "with\n"
	       "cvvdp --test '%s/%s/frame-%%04d.png' --ref '%s/reference/frame-%%04d.png' "
	       "--display standard_fhd --pix-per-deg %.1f --fps %g\n",
	       out, outcome->first_test, out, outcome->px_per_deg, settings->fps);
}

static int run_clip(int argc, char *const *argv, const struct gz_log *log)
{
	static struct settings settings; /* of some size; a program runs one command */
	struct gz_operands scenes;
	char commit[GZ_STUDY_TEXT_SIZE], size[GZ_NAME_SIZE];
	const int status =
		gz_command_read_arguments(&gazebench_clip, argc, argv, log, &settings, &scenes);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	gz_study_identify(gazebench_commit, "/proc/self/exe", commit);
	snprintf(size, sizeof size, "%dx%d", settings.size[0], settings.size[1]);
	const struct gz_clip_request request = clip_request(&settings, &scenes, size, commit);
	if (scenes.count != 1) {
		gz_err(log, "give one scene: gazebench clip SCENE --out DIR");
		return GAZEBENCH_USAGE;
	}
	if (!settings.out[0]) {
		gz_err(log, "no folder for the clip: name one with --out DIR");
		return GAZEBENCH_USAGE;
	}
	if (gz_study_check(&request.study, log) != GZ_OK)
		return GAZEBENCH_USAGE;
	struct gz_clip_outcome outcome;
	gz_command_catch_signals();
	const enum gz_result result = gz_clip_write(&request, settings.out, log, &outcome);
	if (result == GZ_ERR_CANCELLED)
		gz_err(log, "interrupted: the clip is not complete");
	if (result != GZ_OK)
		return GAZEBENCH_FAILED;
	print_commands(&settings, &outcome);
	return GAZEBENCH_DONE;
}

const struct gz_command gazebench_clip = {
	.program = "gazebench",
	.name = "clip",
	.operands = "SCENE",
	.operands_max = 1,
	.summary = "write sequences of pictures for metrics of moving pictures",
	.details = "Writes what someone sees while the camera moves: PNG pictures of each frame by "
		   "standard, the\n"
		   "reference, and by each method, and clip.json with the gaze, the camera and the "
		   "display. Prints the\n"
		   "commands that judge them by FovVideoVDP (Mantiuk et al. 2021) and by "
		   "ColorVideoVDP "
		   "(Mantiuk et al.\n"
		   "2024), which their authors publish; the latter knows no gaze.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_clip,
};
