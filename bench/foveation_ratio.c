/*
 * Whole frames at full resolution and foveated, in turn in one run, and the ratio of their medians.
 * The camera turns by 0.01 degrees a frame and nothing is reused.
 *
 *   foveation_ratio SCENE WIDTHxHEIGHT[,...] [METHOD] [PAIRS] [SIMD] [PICTURE.png]
 *
 * PICTURE is the last foveated frame.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/picture_plan.h"
#include "render/scene.h"

enum { PAIRS_MAX = 101 };

/* One kind of frame, measured over all pairs. */
struct series {
	struct gz_foveation foveation;
	double total_ms[PAIRS_MAX], plan_ms[PAIRS_MAX], cast_ms[PAIRS_MAX],
		reconstruct_ms[PAIRS_MAX];
	struct gz_frame_stats stats;
};

struct bench {
	struct gz_log log;
	struct gz_scene scene;
	struct gz_renderer *renderer;
	struct gz_plan plan;
	struct gz_image image;
	int pairs;
};

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(double *values, int count)
{
	qsort(values, (size_t)count, sizeof *values, compare);
	return values[count / 2];
}

static int frame(struct bench *bench, struct series *series, struct gz_point gaze, int width,
		 int height, int k)
{
	const struct gz_display display = bench->scene.has_display
						  ? bench->scene.settings.display
						  : gz_display_default(width, height);
	const int64_t start_ns = gz_clock_now_ns();
	const struct gz_picture_subject subject = {
		&bench->scene.volume,
		&bench->scene.settings.camera,
		&bench->scene.settings.rays,
	};
	if (gz_picture_plan_make(&subject, &series->foveation, &display, gaze, width, height,
				 &bench->plan) != GZ_OK)
		return -1;
	const int64_t plan_ns = gz_clock_now_ns();
	if (gz_renderer_render(bench->renderer, &bench->scene.settings.camera,
			       &bench->scene.settings.rays, &bench->plan, &bench->image,
			       &series->stats) != GZ_OK)
		return -1;
	if (k >= 0) {
		series->total_ms[k] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
		series->plan_ms[k] = gz_ns_to_ms(plan_ns - start_ns);
		series->cast_ms[k] = series->stats.cast_ms;
		series->reconstruct_ms[k] = series->stats.reconstruct_ms;
	}
	return 0;
}

static void print_series(const char *name, struct series *series, int pairs)
{
	printf("  %-9s total %8.2f ms  plan %6.3f  cast %8.2f  reconstruct %6.2f   rays %9llu  "
	       "samples %11llu\n",
	       name, median(series->total_ms, pairs), median(series->plan_ms, pairs),
	       median(series->cast_ms, pairs), median(series->reconstruct_ms, pairs),
	       (unsigned long long)series->stats.rays, (unsigned long long)series->stats.samples);
}

static int measure(struct bench *bench, const char *method, int width, int height)
{
	struct series full = { .foveation = bench->scene.settings.foveation };
	struct series foveated = full;
	full.foveation.method = GZ_METHOD_STANDARD;
	if (gz_option_parse(&gz_foveation_options[0], method, &foveated.foveation, NULL, 0) !=
	    GZ_OK) {
		fprintf(stderr, "no method '%s'\n", method);
		return -1;
	}
	struct gz_point gaze;
	const struct gz_camera *camera = &bench->scene.settings.camera;
	if (!gz_camera_project(camera, width, height, camera->look_at, &gaze))
		gaze = (struct gz_point) { 0.5F, 0.5F };
	for (int k = -1; k < bench->pairs; k++) { /* the first pair warms up */
		if (frame(bench, &full, gaze, width, height, k) != 0 ||
		    frame(bench, &foveated, gaze, width, height, k) != 0)
			return -1;
		gz_camera_turn(&bench->scene.settings.camera, 0.01);
	}
	printf("%dx%d  gaze %.3f %.3f  %s\n", width, height, (double)gaze.x, (double)gaze.y,
	       gz_renderer_describe(bench->renderer));
	print_series("standard", &full, bench->pairs);
	print_series(method, &foveated, bench->pairs);
	printf("  ratio %.2f\n",
	       median(full.total_ms, bench->pairs) / median(foveated.total_ms, bench->pairs));
	return 0;
}

static int measure_all(struct bench *bench, const char *sizes, const char *method)
{
	for (const char *size = sizes; size;) {
		int width, height;
		if (sscanf(size, "%dx%d", &width, &height) != 2 ||
		    measure(bench, method, width, height) != 0)
			return -1;
		size = strchr(size, ',');
		size += size != NULL;
	}
	return 0;
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fprintf(stderr,
			"usage: %s SCENE WIDTHxHEIGHT[,WIDTHxHEIGHT] [METHOD] [PAIRS] [SIMD] "
			"[PICTURE.png]\n",
			argv[0]);
		return 2;
	}
	struct bench bench = { .pairs = argc > 4 ? atoi(argv[4]) : 5 };
	if (bench.pairs < 1 || bench.pairs > PAIRS_MAX)
		bench.pairs = 5;
	gz_log_init(&bench.log, NULL, NULL, NULL);
	if (gz_scene_load(argv[1], NULL, &bench.log, &bench.scene) != GZ_OK)
		return 1;
	const struct gz_renderer_params params = { .simd = argc > 5 ? argv[5] : NULL };
	int failed = 1;
	if (gz_renderer_create(NULL, &params, &bench.log, &bench.renderer) == GZ_OK &&
	    gz_renderer_set_volume(bench.renderer, &bench.scene.volume) == GZ_OK &&
	    gz_renderer_set_transfer(bench.renderer, &bench.scene.transfer) == GZ_OK)
		failed = measure_all(&bench, argv[2], argc > 3 ? argv[3] : "acuity") != 0;
	if (argc > 6 && !failed)
		failed = gz_image_write_png(&bench.image, argv[6], &bench.log) != GZ_OK;
	gz_renderer_destroy(&bench.renderer);
	gz_scene_free(&bench.scene);
	gz_plan_free(&bench.plan);
	gz_image_free(&bench.image);
	return failed;
}
