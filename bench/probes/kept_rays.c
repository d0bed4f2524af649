/* Prints what frames cost while the gaze follows a path and nothing else moves, with the rays of
 * earlier frames kept (temporal.keep_rays) and without, and how many pixels differ:
 *
 *     kept_rays SCENE PATH [--size 2263x1306] [--methods acuity] [--turn 0] [--standard-every 20]
 *
 * PATH is one of gazebench's, such as sweep:s, FILE.csv:WxH and FILE.gzl:samples. The two kinds of
 * frames are made in turn. Pictures of `standard` are made at some places; they depend on none. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "bench/study/gaze_path.h"
#include "bench/study/stage.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"

/* The command line. */
struct kept_request {
	int size[2], standard_every;
	double turn_deg;
	char methods[256];
};

#define AT(field) offsetof(struct kept_request, field)

static const struct gz_option kept_options[] = {
	{ "size", GZ_OPTION_SIZE, AT(size), 16, 8192, .preset = "2263x1306",
	  .help = "of the picture" },
	{ "methods", GZ_OPTION_STRING, AT(methods), 0, sizeof((struct kept_request *)0)->methods,
	  .preset = "acuity", .help = "as gazebench run takes them" },
	{ "turn", GZ_OPTION_DOUBLE, AT(turn_deg), -360, 360, .preset = "0",
	  .help = "angle by which the camera turns each frame, degrees" },
	{ "standard-every", GZ_OPTION_INT, AT(standard_every), 1, 1000000, .preset = "20",
	  .help = "places from one picture of standard to the next" },
};

enum { KEPT_OPTIONS = sizeof kept_options / sizeof kept_options[0] };

/* Frames in turn: all rays cast, and those of earlier frames kept. */
enum { BARE, KEPT, KINDS };

/* Times of whole frames. */
struct frame_times {
	size_t count;
	double *ms;
};

struct kept_stage {
	struct gz_log log;
	struct gz_scene scene;
	struct gz_display display;
	struct gz_gaze_path path;
	struct gz_camera camera;
	int width, height;
	struct gz_picture_maker *makers[KINDS];
	struct gz_plan plans[KINDS];
	struct gz_image images[KINDS];
	struct frame_times times[KINDS], standard;
	uint64_t rays, kept_rays, differing; /* of one method */
	uint64_t all_differing;
};

static enum gz_result open_makers(struct kept_stage *stage)
{
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count =
		gz_scene_list_objects(&stage->scene, objects, sizeof objects / sizeof objects[0]);
	enum gz_result result = GZ_OK;
	for (int kind = 0; kind < KINDS && result == GZ_OK; kind++) {
		result = gz_picture_maker_create(&params, &stage->log, &stage->makers[kind]);
		if (result == GZ_OK)
			result = gz_picture_maker_show(stage->makers[kind], objects, count);
	}
	return result;
}

static enum gz_result make_frame(struct kept_stage *stage, int kind,
				 const struct gz_variant_settings *settings, struct gz_point gaze,
				 struct gz_picture_cost *out_cost)
{
	struct gz_temporal_params temporal = gz_temporal_default();
	temporal.keep_rays = kind == KEPT;
	const struct gz_picture_request request = {
		.camera = &stage->camera,
		.settings = &settings->rays,
		.foveation = &settings->foveation,
		.display = &stage->display,
		.focus = gz_focus_at(gaze),
		.width = stage->width,
		.height = stage->height,
		.temporal = &temporal,
		.fresh_plan = true,
		.plan = &stage->plans[kind],
		.image = &stage->images[kind],
	};
	struct gz_image *image;
	return gz_picture_make(stage->makers[kind], &request, &image, out_cost);
}

static uint64_t count_differing(const struct gz_image *a, const struct gz_image *b)
{
	const uint32_t *left = (const uint32_t *)(const void *)a->pixels;
	const uint32_t *right = (const uint32_t *)(const void *)b->pixels;
	const size_t pixels = (size_t)a->width * (size_t)a->height;
	uint64_t differing = 0;
	for (size_t i = 0; i < pixels; i++)
		differing += left[i] != right[i];
	return differing;
}

static enum gz_result follow_path(struct kept_stage *stage,
				  const struct gz_variant_settings *settings,
				  const struct kept_request *request)
{
	struct gz_variant_settings full = *settings;
	struct gz_picture_cost cost;
	enum gz_result result = GZ_OK;
	full.foveation.method = gz_method_full();
	stage->camera = stage->scene.settings.camera;
	for (size_t i = 0; i < stage->path.count && result == GZ_OK; i++) {
		const struct gz_point gaze = stage->path.points[i].gaze;
		for (int kind = 0; kind < KINDS; kind++) {
			result = make_frame(stage, kind, settings, gaze, &cost);
			if (result != GZ_OK)
				return result;
			stage->times[kind].ms[stage->times[kind].count++] = cost.total_ms;
		}
		stage->rays += cost.stats.rays;
		stage->kept_rays += cost.stats.kept_rays;
		stage->differing += count_differing(&stage->images[BARE], &stage->images[KEPT]);
		if (i % (size_t)request->standard_every == 0) {
			result = make_frame(stage, BARE, &full, gaze, &cost);
			stage->standard.ms[stage->standard.count++] = cost.total_ms;
		}
		gz_camera_turn(&stage->camera, request->turn_deg);
	}
	return result;
}

static double mean_of(const struct frame_times *times)
{
	double sum = 0;
	for (size_t i = 0; i < times->count; i++)
		sum += times->ms[i];
	return sum / (double)times->count;
}

/* Sorts. */
static double share_of(struct frame_times *times, double share)
{
	qsort(times->ms, times->count, sizeof times->ms[0], gz_compare_doubles);
	return times->ms[(size_t)(share * (double)(times->count - 1))];
}

static void print_kind(struct kept_stage *stage, const char *name, struct frame_times *times)
{
	const double mean = mean_of(times);
	printf("  %-10s mean %7.2f ms, median %7.2f, 95th percentile %7.2f; %5.1f times standard\n",
	       name, mean, share_of(times, 0.5), share_of(times, 0.95),
	       mean_of(&stage->standard) / mean);
}

static enum gz_result measure_method(struct kept_stage *stage, const char *text,
				     const struct kept_request *request)
{
	const struct gz_variant_settings scene = { stage->scene.settings.foveation,
						   stage->scene.settings.rays };
	struct gz_variant_settings settings;
	enum gz_result result = gz_variant_parse(text, &scene, &stage->log, &settings);
	stage->standard.count = stage->times[BARE].count = stage->times[KEPT].count = 0;
	stage->rays = stage->kept_rays = stage->differing = 0;
	if (result == GZ_OK)
		result = follow_path(stage, &settings, request);
	if (result != GZ_OK)
		return result;
	printf("%s, %dx%d, %zu places, standard %.1f ms: %.1f %% of rays kept, %llu pixels "
	       "differ\n",
	       text, stage->width, stage->height, stage->path.count, mean_of(&stage->standard),
	       100 * (double)stage->kept_rays / (double)stage->rays,
	       (unsigned long long)stage->differing);
	/* Frames whose plan grows have more rays than bare ones. */
	if (settings.foveation.still_growth <= 0)
		stage->all_differing += stage->differing;
	print_kind(stage, "all cast", &stage->times[BARE]);
	print_kind(stage, "kept", &stage->times[KEPT]);
	return GZ_OK;
}

static enum gz_result make_room(struct kept_stage *stage)
{
	struct frame_times *all[] = { &stage->times[BARE], &stage->times[KEPT], &stage->standard };
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
		all[i]->ms = calloc(stage->path.count, sizeof *all[i]->ms);
		if (!all[i]->ms)
			return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

static enum gz_result set_up(const struct kept_request *request, const char *scene,
			     const char *path, struct kept_stage *stage)
{
	stage->width = request->size[0];
	stage->height = request->size[1];
	const struct gz_gaze_path_settings settings = {
		.text = path,
		.seed = 1,
		.size = { stage->width, stage->height },
	};
	enum gz_result result = gz_scene_load(scene, NULL, &stage->log, &stage->scene);
	if (result == GZ_OK)
		result = gz_gaze_path_make(&settings, &stage->log, &stage->path);
	stage->display = gz_display_default(stage->width, stage->height);
	if (result == GZ_OK)
		result = make_room(stage);
	return result == GZ_OK ? open_makers(stage) : result;
}

static void clean_up(struct kept_stage *stage)
{
	for (int kind = 0; kind < KINDS; kind++) {
		gz_picture_maker_destroy(&stage->makers[kind]);
		gz_plan_free(&stage->plans[kind]);
		gz_image_free(&stage->images[kind]);
		free(stage->times[kind].ms);
	}
	free(stage->standard.ms);
	gz_gaze_path_free(&stage->path);
	gz_scene_free(&stage->scene);
}

static enum gz_result measure_methods(const struct kept_request *request, struct kept_stage *stage)
{
	const char *list = request->methods;
	char method[sizeof request->methods];
	enum gz_result result = GZ_OK;
	while (result == GZ_OK && gz_list_next(&list, method, sizeof method))
		result = measure_method(stage, method, request);
	return result;
}

int main(int argc, char **argv)
{
	static struct kept_request request;
	static struct kept_stage stage;
	struct gz_option_binding binding = { kept_options, KEPT_OPTIONS, &request, NULL };
	struct gz_operands operands;
	gz_log_init(&stage.log, NULL, NULL, "*:warn");
	enum gz_result result = gz_options_preset(&binding);
	if (result == GZ_OK)
		result = gz_options_read_arguments(&binding, 1, argc, argv, &operands, &stage.log);
	if (result == GZ_OK && operands.count != 2) {
		fputs("kept_rays SCENE PATH [options]\n", stderr);
		result = GZ_ERR_INVAL;
	}
	if (result == GZ_OK)
		result = set_up(&request, operands.items[0], operands.items[1], &stage);
	if (result == GZ_OK)
		result = measure_methods(&request, &stage);
	const bool equal = stage.all_differing == 0;
	clean_up(&stage);
	if (result != GZ_OK)
		fprintf(stderr, "kept_rays: %s\n", gz_result_text(result));
	return result == GZ_OK && equal ? EXIT_SUCCESS : EXIT_FAILURE;
}
