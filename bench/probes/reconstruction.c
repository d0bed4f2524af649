/*
 * How pixels between rays are made: each filter's error against `standard`, over the whole picture
 * and beyond 5 degrees of the gaze, and its time beside that of a plain copy of the finished
 * picture by as many threads, medians and, for a machine that does other things too, the least.
 * Then the times of regions, hard and with bands.
 *
 *   reconstruction SCENE WIDTHxHEIGHT[,...] [REPEATS] [PREFIX]
 *
 * With PREFIX every picture goes to PREFIX-NAME.png.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "bench/metrics/metrics.h"
#include "bench/probes/push_pull.h"
#include "render/frame/picture_maker.h"
#include "render/plan/method.h"
#include "render/scene/scene.h"

enum { REPEATS_MAX = 101, KINDS = 3, COPY_PARTS = 64 };

/* A filter of the renderer's, or push-pull behind them. */
static const char *const kinds[KINDS] = { "catmull_rom", "bilinear", "push_pull" };

struct series {
	double time_ms[REPEATS_MAX];
};

struct bench {
	struct gz_log log;
	struct gz_scene scene;
	struct gz_picture_maker *maker;
	struct gz_workers *workers;
	struct gz_display display;
	struct gz_point gaze;
	int width, height, repeats;
	struct gz_plan plan;
	struct gz_image full, image, copy;
	struct gz_push_pull push_pull;
	struct series kinds[KINDS], copies;
	struct gz_map errors, ring;
	const char *prefix;
};

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(struct series *series, int count)
{
	qsort(series->time_ms, (size_t)count, sizeof series->time_ms[0], compare);
	return series->time_ms[count / 2];
}

static bool render(struct bench *bench, int method, int filter, struct gz_image *image,
		   double *out_ms)
{
	struct gz_foveation *foveation = &bench->scene.settings.foveation;
	foveation->method = method;
	foveation->filter = filter;
	const struct gz_picture_request request = {
		.camera = &bench->scene.settings.camera,
		.settings = &bench->scene.settings.rays,
		.foveation = foveation,
		.display = &bench->display,
		.focus = gz_focus_at(bench->gaze),
		.width = bench->width,
		.height = bench->height,
		.plan = &bench->plan,
		.image = image,
	};
	struct gz_image *made;
	struct gz_picture_cost cost;
	if (gz_picture_make(bench->maker, &request, &made, &cost) != GZ_OK)
		return false;
	*out_ms = cost.stats.reconstruct_ms;
	return true;
}

/* One picture of a kind and what making it of the rays took. */
static bool make(struct bench *bench, int kind, double *out_ms)
{
	const bool push_pull = kind == KINDS - 1;
	if (!render(bench, gz_method_find("acuity"), push_pull ? GZ_FILTER_BILINEAR : kind,
		    &bench->image, out_ms))
		return false;
	if (!push_pull)
		return true;
	if (gz_push_pull_take(&bench->push_pull, &bench->plan, &bench->image) != GZ_OK)
		return false;
	const int64_t start_ns = gz_clock_now_ns();
	gz_push_pull_fill(&bench->push_pull, bench->workers, &bench->image);
	*out_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return true;
}

struct region_plan {
	const char *name;
	const char *method;
	double blend_px;
};

static const struct region_plan region_plans[] = {
	{ "mdc", "mdc", 0 },           { "mdc, 16 px", "mdc", 16 }, { "mdc3", "mdc3", 0 },
	{ "mdc3, 16 px", "mdc3", 16 }, { "ddc", "ddc", 0 },         { "ddc, 16 px", "ddc", 16 },
};

static void copy_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct bench *bench = user;
	const size_t size = (size_t)bench->width * (size_t)bench->height * 4;
	const size_t from = size / COPY_PARTS * part;
	const size_t to = part + 1 == COPY_PARTS ? size : from + size / COPY_PARTS;
	memcpy(bench->copy.pixels + from, bench->image.pixels + from, to - from);
}

static double copy_ms(struct bench *bench)
{
	const int64_t start_ns = gz_clock_now_ns();
	gz_workers_run(bench->workers, copy_part, bench, COPY_PARTS);
	return gz_ns_to_ms(gz_clock_now_ns() - start_ns);
}

static void print_times(struct series *series, struct series *copies, int repeats)
{
	const double copy = median(copies, repeats), middle = median(series, repeats);
	printf("  %6.2f ms, %5.2f copies; at best %6.2f ms, %5.2f copies\n", middle, middle / copy,
	       series->time_ms[0], series->time_ms[0] / copies->time_ms[0]);
}

/* Each kind of regions in turn with copies of its picture. */
static bool measure_regions(struct bench *bench)
{
	for (size_t k = 0; k < sizeof region_plans / sizeof region_plans[0]; k++) {
		static struct series times, copies;
		bench->scene.settings.foveation.blend_px = region_plans[k].blend_px;
		for (int i = -1; i < bench->repeats; i++) { /* the first round warms up */
			const int place = i < 0 ? 0 : i;
			if (!render(bench, gz_method_find(region_plans[k].method), 0, &bench->image,
				    &times.time_ms[place]))
				return false;
			copies.time_ms[place] = copy_ms(bench);
		}
		printf("  %-12s", region_plans[k].name);
		print_times(&times, &copies, bench->repeats);
	}
	return true;
}

static bool print_errors(struct bench *bench, int kind)
{
	double ms;
	struct gz_map ssim = { 0 };
	bool done = make(bench, kind, &ms) &&
		    gz_squared_error(&bench->full, &bench->image, &bench->errors) == GZ_OK &&
		    gz_weights_ring(&bench->display, bench->gaze, bench->width, bench->height, 5,
				    360, &bench->ring) == GZ_OK &&
		    gz_ssim(&bench->full, &bench->image, GZ_SSIM_GAUSSIAN, bench->workers, &ssim) ==
			    GZ_OK;
	if (done)
		printf("  %-12s PSNR %6.2f dB  beyond 5 deg %6.2f dB  SSIM %.5f", kinds[kind],
		       gz_psnr_db(gz_map_mean(&bench->errors)),
		       gz_psnr_db(gz_map_weighted_mean(&bench->errors, &bench->ring)),
		       gz_map_mean(&ssim));
	gz_map_free(&ssim);
	char path[1024];
	if (!done || !bench->prefix)
		return done;
	snprintf(path, sizeof path, "%s-%s.png", bench->prefix, kinds[kind]);
	return gz_image_write_png(&bench->image, path, &bench->log) == GZ_OK;
}

static bool measure(struct bench *bench)
{
	const struct gz_camera *camera = &bench->scene.settings.camera;
	bench->display = bench->scene.has_display ? bench->scene.settings.display
						  : gz_display_default(bench->width, bench->height);
	if (!gz_camera_project(camera, bench->width, bench->height, camera->look_at, &bench->gaze))
		bench->gaze = (struct gz_point) { 0.5F, 0.5F };
	double ms;
	if (!render(bench, gz_method_full(), 0, &bench->full, &ms) ||
	    gz_image_resize(&bench->copy, bench->width, bench->height) != GZ_OK)
		return false;
	for (int i = -1; i < bench->repeats; i++) /* the first round warms up */
		for (int kind = 0; kind < KINDS; kind++) {
			if (!make(bench, kind, &ms))
				return false;
			const int k = i < 0 ? 0 : i;
			bench->kinds[kind].time_ms[k] = ms;
			if (kind == 0)
				bench->copies.time_ms[k] = copy_ms(bench);
		}
	printf("%dx%d  gaze %.3f %.3f  %s  copy %.2f ms\n", bench->width, bench->height,
	       (double)bench->gaze.x, (double)bench->gaze.y,
	       gz_picture_maker_describe(bench->maker), median(&bench->copies, bench->repeats));
	for (int kind = 0; kind < KINDS; kind++) {
		if (!print_errors(bench, kind))
			return false;
		print_times(&bench->kinds[kind], &bench->copies, bench->repeats);
	}
	return measure_regions(bench);
}

static bool measure_all(struct bench *bench, const char *sizes)
{
	for (const char *size = sizes; size; size = strchr(size, ',')) {
		size += *size == ',';
		if (sscanf(size, "%dx%d", &bench->width, &bench->height) != 2 || !measure(bench))
			return false;
	}
	return true;
}

static void release(struct bench *bench)
{
	gz_picture_maker_destroy(&bench->maker);
	gz_workers_destroy(&bench->workers);
	gz_scene_free(&bench->scene);
	gz_plan_free(&bench->plan);
	gz_image_free(&bench->full);
	gz_image_free(&bench->image);
	gz_image_free(&bench->copy);
	gz_push_pull_free(&bench->push_pull);
	gz_map_free(&bench->errors);
	gz_map_free(&bench->ring);
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fprintf(stderr, "usage: %s SCENE WIDTHxHEIGHT[,WIDTHxHEIGHT] [REPEATS] [PREFIX]\n",
			argv[0]);
		return 2;
	}
	static struct bench bench;
	bench.repeats = argc > 3 ? atoi(argv[3]) : 11;
	if (bench.repeats < 1 || bench.repeats > REPEATS_MAX)
		bench.repeats = 11;
	bench.prefix = argc > 4 ? argv[4] : NULL;
	gz_log_init(&bench.log, NULL, NULL, NULL);
	if (gz_scene_load(argv[1], NULL, &bench.log, &bench.scene) != GZ_OK)
		return 1;
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct gz_object objects[GZ_SCENE_OBJECTS_MAX + 1];
	const size_t count =
		gz_scene_list_objects(&bench.scene, objects, sizeof objects / sizeof objects[0]);
	const bool done = gz_workers_create(0, &bench.workers) == GZ_OK &&
			  gz_picture_maker_create(&params, &bench.log, &bench.maker) == GZ_OK &&
			  gz_picture_maker_show(bench.maker, objects, count) == GZ_OK &&
			  measure_all(&bench, argv[2]);
	release(&bench);
	return done ? 0 : 1;
}
