/* Prints how long illustrations of a scene take: what is prepared, first with nothing kept and then
 * again from files, and frames with every weight above 0 ("all buffers"):
 *
 *     illustration_speed SCENE [--isovalue N] [--size 1920x1080] [--runs 25] [--threads 0]
 *                        [--kinds 4]
 *
 * The kinds of frames are drawn in turn, so on a busy machine their ratios can still be told.
 * Processor time is that of all threads: it hardly depends on what else runs. The gaze is in the
 * middle, and the camera turns by 0.01 degrees a frame. */
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "render/illustration/cpu/illustrate_caster.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"

enum { RUNS_MAX = 1000 };

#define TURN_DEG 0.01
#define PI       3.14159265358979323846

/* The command line. */
struct speed_request {
	int size[2], runs, threads, kinds;
	double isovalue;
};

#define AT(field) offsetof(struct speed_request, field)

static const struct gz_option speed_options[] = {
	{ "size", GZ_OPTION_SIZE, AT(size), 16, 8192, .preset = "1920x1080",
	  .help = "of the picture" },
	{ "runs", GZ_OPTION_INT, AT(runs), 1, RUNS_MAX, .preset = "25", .help = "frames" },
	{ "threads", GZ_OPTION_INT, AT(threads), 0, 256, .preset = "0",
	  .help = "0: one for each processor" },
	{ "kinds", GZ_OPTION_INT, AT(kinds), 1, 4, .preset = "4",
	  .help = "how many kinds of frames, in this order: grey, stipples, hatches, every pixel "
		  "grey" },
	{ "isovalue", GZ_OPTION_DOUBLE, AT(isovalue), -1e30, 1e30, .preset = "-1e30",
	  .help = "of volumes, in place of the scene's" },
};

enum { SPEED_OPTIONS = sizeof speed_options / sizeof speed_options[0] };

/* The kinds of frames. */
static const struct {
	const char *name;
	enum gz_illustration_drawing drawing;
	bool full; /* every pixel is cast */
} kinds[] = {
	{ "grey, foveated", GZ_DRAWING_GREY, false },
	{ "stipples, foveated", GZ_DRAWING_STIPPLES, false },
	{ "hatches, foveated", GZ_DRAWING_HATCHES, false },
	{ "grey, every pixel", GZ_DRAWING_GREY, true },
};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* What is drawn, and with what. */
struct speed_stage {
	struct gz_scene scene;
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	size_t count;
	struct gz_camera camera;
	struct gz_illustration_look look;
	struct gz_plan plans[2]; /* foveated, every pixel */
	struct gz_image image;
	double isovalue;
};

/* What one kind of frames took. */
struct speed_times {
	double total_ms[RUNS_MAX], cast_ms[RUNS_MAX], processor_ms[RUNS_MAX];
};

/* All parameters, each with some weight. */
static enum gz_result fill_look(struct gz_illustration_look *look)
{
	struct gz_option_binding bindings[GZ_ILLUSTRATION_BINDINGS];
	enum gz_result result = GZ_OK;
	gz_illustration_look_bind(look, bindings);
	for (int i = 0; i < GZ_ILLUSTRATION_BINDINGS && result == GZ_OK; i++)
		result = gz_options_preset(&bindings[i]);
	struct gz_shading_settings *single = &look->single;
	look->source = GZ_ILLUSTRATION_SINGLE;
	single->surface_shape = single->curvature = 0.3;
	single->plain_light = 0.1;
	single->importance = single->viewer_distance = single->object_distance = 0.2;
	return result;
}

static enum gz_result set_up_speed(const struct speed_request *request, const char *path,
				   const struct gz_log *log, struct speed_stage *stage)
{
	enum gz_result result = gz_scene_load(path, NULL, log, &stage->scene);
	if (result == GZ_OK)
		result = fill_look(&stage->look);
	if (result != GZ_OK)
		return result;
	const struct gz_scene_settings *settings = &stage->scene.settings;
	const struct gz_display display = gz_display_default(request->size[0], request->size[1]);
	stage->count = gz_scene_list_objects(&stage->scene, stage->objects, GZ_SCENE_LISTED_MAX);
	stage->camera = settings->camera;
	stage->isovalue =
		request->isovalue > -1e30 ? request->isovalue : settings->rays.surface.isovalue;
	for (int i = 0; i < 2 && result == GZ_OK; i++) {
		struct gz_foveation foveation = settings->foveation;
		if (i > 0)
			foveation.method = gz_method_full();
		result = gz_plan_make(&foveation, &display, (struct gz_point) { 0.5F, 0.5F },
				      request->size[0], request->size[1], &stage->plans[i]);
	}
	return result;
}

static enum gz_result draw_kind(struct speed_stage *stage, struct gz_illustrate_caster *caster,
				int kind, struct gz_frame_stats *out_stats)
{
	const struct gz_illustrate_shot shot = {
		.camera = &stage->camera,
		.plan = &stage->plans[kinds[kind].full],
		.look = &stage->look,
		.clip = &stage->scene.settings.rays.clip,
		.isovalue = stage->isovalue,
		.chosen_id = stage->objects[0].id,
	};
	stage->look.drawing = kinds[kind].drawing;
	return gz_illustrate_caster_draw(caster, &shot, &stage->image, NULL, out_stats);
}

static enum gz_result open_caster(const struct speed_request *request, struct speed_stage *stage,
				  const struct gz_log *log,
				  struct gz_illustrate_caster **out_caster)
{
	const struct gz_backend_params params = { .threads = request->threads,
						  .wait_for_bricks = true };
	enum gz_result result = gz_illustrate_caster_create(&params, log, out_caster);
	if (result == GZ_OK)
		result = gz_illustrate_caster_show(*out_caster, stage->objects, stage->count);
	return result;
}

/* Draw one picture of each kind, and print what was prepared for it. */
static enum gz_result prepare_kinds(const struct speed_request *request, struct speed_stage *stage,
				    struct gz_illustrate_caster *caster, const char *how)
{
	enum gz_result result = GZ_OK;
	for (int kind = 0; kind < KINDS - 1 && kind < request->kinds && result == GZ_OK; kind++) {
		struct gz_frame_stats stats;
		result = draw_kind(stage, caster, kind, &stats);
		if (result == GZ_OK)
			printf("prepared %s: %s %.0f ms\n", how,
			       kind == 0   ? "surface, curvature, normals, distances"
			       : kind == 1 ? "points"
					   : "strokes",
			       stats.prepare_ms);
	}
	return result;
}

/* Turn the camera a little about the upright axis. */
static void turn_camera(struct gz_camera *camera)
{
	const double turn = TURN_DEG * PI / 180, x = camera->eye[0], y = camera->eye[1];
	camera->eye[0] = cos(turn) * x - sin(turn) * y;
	camera->eye[1] = sin(turn) * x + cos(turn) * y;
}

static void print_times(const struct speed_request *request, struct speed_times *times)
{
	double grey_ms = 0;
	printf("%-20s %10s %10s %10s %10s %13s %10s\n", "frames", "best_ms", "median_ms", "per_s",
	       "cast_ms", "processor_ms", "of grey");
	for (int kind = 0; kind < request->kinds; kind++) {
		const size_t middle = (size_t)request->runs / 2;
		qsort(times[kind].total_ms, (size_t)request->runs, sizeof(double),
		      gz_compare_doubles);
		qsort(times[kind].cast_ms, (size_t)request->runs, sizeof(double),
		      gz_compare_doubles);
		qsort(times[kind].processor_ms, (size_t)request->runs, sizeof(double),
		      gz_compare_doubles);
		const double median_ms = times[kind].total_ms[middle];
		grey_ms = kind == 0 ? median_ms : grey_ms;
		printf("%-20s %10.2f %10.2f %10.1f %10.2f %13.2f %10.2f\n", kinds[kind].name,
		       times[kind].total_ms[0], median_ms, 1000 / median_ms,
		       times[kind].cast_ms[middle], times[kind].processor_ms[middle],
		       median_ms / grey_ms);
	}
}

/* What all threads of the process have computed so far. */
static double processor_now_ms(void)
{
	struct timespec now;
	(void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static enum gz_result draw_frames(const struct speed_request *request, struct speed_stage *stage,
				  struct gz_illustrate_caster *caster)
{
	static struct speed_times times[KINDS];
	enum gz_result result = GZ_OK;
	for (int run = 0; run < request->runs && result == GZ_OK; run++) {
		turn_camera(&stage->camera);
		for (int kind = 0; kind < request->kinds && result == GZ_OK; kind++) {
			struct gz_frame_stats stats = { 0 };
			const double processor_ms = processor_now_ms();
			const int64_t start_ns = gz_clock_now_ns();
			result = draw_kind(stage, caster, kind, &stats);
			times[kind].total_ms[run] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
			times[kind].processor_ms[run] = processor_now_ms() - processor_ms;
			times[kind].cast_ms[run] = stats.cast_ms;
		}
	}
	if (result == GZ_OK)
		print_times(request, times);
	return result;
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *at)
{
	(void)status;
	(void)kind;
	(void)at;
	return remove(path);
}

/* Prepare twice, the second time from files of a folder of our own, and draw frames. */
static enum gz_result measure_stage(const struct speed_request *request, struct speed_stage *stage,
				    const struct gz_log *log)
{
	struct gz_illustrate_caster *caster = NULL;
	char folder[] = "/tmp/illustration_speed_XXXXXX";
	if (!mkdtemp(folder) || setenv("XDG_CACHE_HOME", folder, 1) != 0)
		return GZ_ERR_IO;
	enum gz_result result = open_caster(request, stage, log, &caster);
	if (result == GZ_OK)
		result = prepare_kinds(request, stage, caster, "anew");
	gz_illustrate_caster_destroy(&caster);
	if (result == GZ_OK)
		result = open_caster(request, stage, log, &caster);
	if (result == GZ_OK)
		result = prepare_kinds(request, stage, caster, "from files");
	if (result == GZ_OK)
		printf("%s, %llu rays foveated, %llu triangles\n",
		       gz_illustrate_caster_describe(caster),
		       (unsigned long long)stage->plans[0].ray_count,
		       (unsigned long long)gz_illustrate_caster_triangles(caster));
	if (result == GZ_OK)
		result = draw_frames(request, stage, caster);
	gz_illustrate_caster_destroy(&caster);
	(void)nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
	return result;
}

int main(int argc, char **argv)
{
	static struct speed_request request;
	static struct speed_stage stage;
	struct gz_option_binding binding = { speed_options, SPEED_OPTIONS, &request, NULL };
	struct gz_operands operands;
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, "*:warn");
	enum gz_result result = gz_options_preset(&binding);
	if (result == GZ_OK)
		result = gz_options_read_arguments(&binding, 1, argc, argv, &operands, &log);
	if (result == GZ_OK && operands.count != 1) {
		fputs("illustration_speed SCENE [options]\n", stderr);
		result = GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = set_up_speed(&request, operands.items[0], &log, &stage);
	if (result == GZ_OK)
		result = measure_stage(&request, &stage, &log);
	for (int i = 0; i < 2; i++)
		gz_plan_free(&stage.plans[i]);
	gz_image_free(&stage.image);
	gz_scene_free(&stage.scene);
	if (result != GZ_OK)
		fprintf(stderr, "illustration_speed: %s\n", gz_result_text(result));
	return result == GZ_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
