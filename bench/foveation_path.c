/*
 * The gaze travels an S over the picture: what full resolution and foveated methods take at each
 * point, in turn in one run, and how far the pictures are apart. The camera turns by 0.01 degrees a
 * frame and nothing is reused.
 *
 *   foveation_path SCENE WIDTHxHEIGHT [METHOD,...] [POINTS] [REPEATS]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "bench/metrics/metrics.h"
#include "bench/study/gaze_path.h"
#include "bench/study/variant.h"
#include "render/picture_plan.h"
#include "render/scene.h"

enum { METHODS_MAX = 16, POINTS_MAX = 1000, REPEATS_MAX = 25 };

/* Errors against the full picture, each the mean over the path. */
struct errors {
	double flip, foveal_flip, perceived_flip, foveal_flip_most, perceived_flip_most, psnr_db;
};

/* One method over the path. */
struct series {
	char name[GZ_STUDY_TEXT_SIZE];
	struct gz_variant_settings settings;
	double time_ms[POINTS_MAX];
	double plan_ms, cast_ms, reconstruct_ms, rays, samples;
	struct errors errors;
};

struct bench {
	struct gz_log log;
	struct gz_scene scene;
	struct gz_renderer *renderer;
	struct gz_workers *workers;
	struct gz_plan plan;
	struct gz_display display;
	int width, height, points, repeats;
	int method_count; /* the first is full resolution */
	struct series series[METHODS_MAX];
	struct gz_image images[METHODS_MAX];
	struct gz_map map, weights;
};

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static int frame(struct bench *bench, int method, struct gz_point gaze, double *out_ms)
{
	struct series *series = &bench->series[method];
	struct gz_frame_stats stats;
	const int64_t start_ns = gz_clock_now_ns();
	const struct gz_picture_subject subject = {
		&bench->scene.volume,
		&bench->scene.settings.camera,
		&series->settings.rays,
	};
	if (gz_picture_plan_make(&subject, &series->settings.foveation, &bench->display, gaze,
				 bench->width, bench->height, &bench->plan) != GZ_OK)
		return -1;
	const int64_t plan_ns = gz_clock_now_ns();
	if (gz_renderer_render(bench->renderer, &bench->scene.settings.camera,
			       &series->settings.rays, &bench->plan, &bench->images[method],
			       &stats) != GZ_OK)
		return -1;
	*out_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	const double share = 1.0 / (bench->points * bench->repeats);
	series->plan_ms += gz_ns_to_ms(plan_ns - start_ns) * share;
	series->cast_ms += stats.cast_ms * share;
	series->reconstruct_ms += stats.reconstruct_ms * share;
	series->rays += (double)stats.rays * share;
	series->samples += (double)stats.samples * share;
	return 0;
}

/* All methods in turn, several times; the median of each. */
static int measure_point(struct bench *bench, int point, struct gz_point gaze)
{
	double times[METHODS_MAX][REPEATS_MAX];
	for (int k = 0; k < bench->repeats; k++) {
		for (int m = 0; m < bench->method_count; m++)
			if (frame(bench, m, gaze, &times[m][k]) != 0)
				return -1;
		gz_camera_turn(&bench->scene.settings.camera, 0.01);
	}
	for (int m = 0; m < bench->method_count; m++) {
		qsort(times[m], (size_t)bench->repeats, sizeof times[m][0], compare);
		bench->series[m].time_ms[point] = times[m][bench->repeats / 2];
	}
	return 0;
}

static int add_errors(struct bench *bench, int method, struct gz_point gaze)
{
	struct errors *errors = &bench->series[method].errors;
	const struct gz_image *reference = &bench->images[0], *test = &bench->images[method];
	const double share = 1.0 / bench->points;
	if (gz_squared_error(reference, test, &bench->map) != GZ_OK)
		return -1;
	errors->psnr_db += fmin(gz_psnr_db(gz_map_mean(&bench->map)), 99) * share;
	if (gz_flip(reference, test, gz_display_px_per_deg(&bench->display), bench->workers,
		    &bench->map) != GZ_OK)
		return -1;
	errors->flip += gz_map_mean(&bench->map) * share;
	if (gz_weights_ring(&bench->display, gaze, bench->width, bench->height, 0, GZ_FOVEA_DEG,
			    &bench->weights) != GZ_OK)
		return -1;
	const double foveal = gz_map_weighted_mean(&bench->map, &bench->weights);
	errors->foveal_flip += foveal * share;
	errors->foveal_flip_most = fmax(errors->foveal_flip_most, foveal);
	if (gz_weights_acuity(&bench->display, gaze, bench->width, bench->height,
			      &bench->weights) != GZ_OK)
		return -1;
	const double perceived = gz_map_weighted_mean(&bench->map, &bench->weights);
	errors->perceived_flip += perceived * share;
	errors->perceived_flip_most = fmax(errors->perceived_flip_most, perceived);
	return 0;
}

static void moments(const double *values, int count, double *out_mean, double *out_variance)
{
	double sum = 0, squares = 0;
	for (int i = 0; i < count; i++)
		sum += values[i] / count;
	for (int i = 0; i < count; i++)
		squares += (values[i] - sum) * (values[i] - sum) / count;
	*out_mean = sum;
	*out_variance = squares;
}

static void print_series(const struct bench *bench, const struct series *series)
{
	const double *full = bench->series[0].time_ms;
	double full_mean, mean, variance, least = INFINITY, ratios = 0;
	moments(full, bench->points, &full_mean, &variance);
	moments(series->time_ms, bench->points, &mean, &variance);
	for (int i = 0; i < bench->points; i++) {
		least = fmin(least, full[i] / series->time_ms[i]);
		ratios += full[i] / series->time_ms[i] / bench->points;
	}
	printf("%-20s %8.2f ms (variance %8.2f)  plan %6.3f  cast %8.2f  reconstruct %6.2f  "
	       "rays %5.2f %%  samples %10.0f\n",
	       series->name, mean, variance, series->plan_ms, series->cast_ms,
	       series->reconstruct_ms, 100 * series->rays / (bench->width * bench->height),
	       series->samples);
	if (series == bench->series)
		return;
	const struct errors *e = &series->errors;
	printf("%20s ratio of means %6.2f  mean of ratios %6.2f  least %6.2f\n", "",
	       full_mean / mean, ratios, least);
	printf("%20s FLIP %.4f  foveal %.4f (most %.4f)  perceived %.4f (most %.4f)  PSNR %.1f "
	       "dB\n",
	       "", e->flip, e->foveal_flip, e->foveal_flip_most, e->perceived_flip,
	       e->perceived_flip_most, e->psnr_db);
}

static int run(struct bench *bench)
{
	double unused;
	if (frame(bench, 0, gz_gaze_path_s(0.5), &unused) != 0) /* warms up */
		return -1;
	bench->series[0] = (struct series) { .settings = bench->series[0].settings };
	strcpy(bench->series[0].name, "standard");
	for (int i = 0; i < bench->points; i++) {
		const struct gz_point gaze = gz_gaze_path_s((i + 0.5) / bench->points);
		if (measure_point(bench, i, gaze) != 0)
			return -1;
		for (int m = 1; m < bench->method_count; m++)
			if (add_errors(bench, m, gaze) != 0)
				return -1;
	}
	printf("%dx%d, %d points of the S path, %s\n", bench->width, bench->height, bench->points,
	       gz_renderer_describe(bench->renderer));
	for (int m = 0; m < bench->method_count; m++)
		print_series(bench, &bench->series[m]);
	return 0;
}

static int parse_methods(struct bench *bench, const char *list)
{
	const struct gz_variant_settings scene = { bench->scene.settings.foveation,
						   bench->scene.settings.rays };
	char text[1024];
	snprintf(text, sizeof text, "standard,%s", list);
	const char *rest = text;
	char name[sizeof bench->series[0].name];
	while (gz_list_next(&rest, name, sizeof name)) {
		struct series *series = &bench->series[bench->method_count];
		if (bench->method_count == METHODS_MAX ||
		    gz_variant_parse(name, &scene, &bench->log, &series->settings) != GZ_OK)
			return -1;
		snprintf(series->name, sizeof series->name, "%s", name);
		bench->method_count++;
	}
	return 0;
}

static int set_up(struct bench *bench, int argc, char **argv)
{
	bench->points = argc > 4 ? atoi(argv[4]) : 13;
	bench->repeats = argc > 5 ? atoi(argv[5]) : 3;
	if (sscanf(argv[2], "%dx%d", &bench->width, &bench->height) != 2 || bench->points < 1 ||
	    bench->points > POINTS_MAX || bench->repeats < 1 || bench->repeats > REPEATS_MAX) {
		fprintf(stderr, "size is WIDTHxHEIGHT, points 1 to %d, repeats 1 to %d\n",
			POINTS_MAX, REPEATS_MAX);
		return -1;
	}
	gz_log_init(&bench->log, NULL, NULL, NULL);
	if (gz_scene_load(argv[1], NULL, &bench->log, &bench->scene) != GZ_OK ||
	    parse_methods(bench, argc > 3 ? argv[3] : "acuity") != 0)
		return -1;
	bench->display = bench->scene.has_display ? bench->scene.settings.display
						  : gz_display_default(bench->width, bench->height);
	if (gz_workers_create(0, &bench->workers) != GZ_OK ||
	    gz_renderer_create("cpu", NULL, &bench->log, &bench->renderer) != GZ_OK ||
	    gz_renderer_set_volume(bench->renderer, &bench->scene.volume) != GZ_OK ||
	    gz_renderer_set_transfer(bench->renderer, &bench->scene.transfer) != GZ_OK)
		return -1;
	return 0;
}

static void tear_down(struct bench *bench)
{
	gz_renderer_destroy(&bench->renderer);
	gz_workers_destroy(&bench->workers);
	gz_scene_free(&bench->scene);
	gz_plan_free(&bench->plan);
	for (int m = 0; m < METHODS_MAX; m++)
		gz_image_free(&bench->images[m]);
	gz_map_free(&bench->map);
	gz_map_free(&bench->weights);
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fprintf(stderr,
			"usage: %s SCENE WIDTHxHEIGHT [METHOD[:OPTION=VALUE],...] [POINTS] "
			"[REPEATS]\n",
			argv[0]);
		return 2;
	}
	static struct bench bench;
	const int failed = set_up(&bench, argc, argv) != 0 || run(&bench) != 0;
	tear_down(&bench);
	return failed;
}
