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
#include "base/order.h"
#include "base/workers.h"
#include "bench/metrics/metrics.h"
#include "render/frame/picture_maker.h"
#include "render/picture/image.h"
#include "render/plan/method.h"
#include "render/plan/plan.h"
#include "render/scene/scene.h"

enum { REPEATS_MAX = 101, KINDS = 3, COPY_PARTS = 64 };

/* ---- push-pull ---- */

/*
 * Push-pull reconstruction, to compare with: Gortler, Grzeszczuk, Szeliski and Cohen, "The
 * Lumigraph", 1996, section 5.3.
 */

enum { PUSH_PULL_LEVELS = 7 }; /* the coarsest has one point for 64 pixels each way */

/* Kept from picture to picture. */
struct push_pull {
	struct push_pull_level {
		int width, height;
		float (*points)[4]; /* red, green, blue and how sure, [0, 1] */
	} levels[PUSH_PULL_LEVELS];
};

typedef struct push_pull_level level_t;

struct job {
	level_t *fine, *coarse;
	struct gz_image *image;
};

/* Make room and take the pixels that the plan casts. */
static enum gz_result take_cast_pixels(struct push_pull *push_pull, const struct gz_plan *plan,
				       const struct gz_image *image)
{
	int width = image->width, height = image->height;
	for (int i = 0; i < PUSH_PULL_LEVELS; i++) {
		level_t *level = &push_pull->levels[i];
		if (level->width != width || level->height != height) {
			free(level->points);
			*level = (level_t) { width, height, NULL };
			level->points =
				malloc((size_t)width * (size_t)height * sizeof *level->points);
		}
		if (!level->points) {
			level->width = 0;
			return GZ_ERR_NO_MEM;
		}
		width = (width + 1) / 2;
		height = (height + 1) / 2;
	}
	const level_t *picture = &push_pull->levels[0];
	memset(picture->points, 0,
	       (size_t)image->width * (size_t)image->height * sizeof *picture->points);
	for (size_t t = 0; t < plan->tile_count; t++)
		for (int ray = 0; ray < GZ_TILE_EDGE * GZ_TILE_EDGE; ray++) {
			const struct gz_tile *tile = &plan->tiles[t];
			const int spacing = plan->layers[tile->layer].spacing;
			const int x = tile->x + gz_tile_columns[tile->pattern][ray] * spacing;
			const int y = tile->y + gz_tile_rows[ray] * spacing;
			if (x >= image->width || y >= image->height)
				continue;
			const size_t index = (size_t)y * (size_t)image->width + (size_t)x;
			for (int c = 0; c < 3; c++)
				picture->points[index][c] = image->pixels[4 * index + (size_t)c];
			picture->points[index][3] = 1;
		}
	return GZ_OK;
}

static float *point(const level_t *level, int x, int y)
{
	return level->points[(size_t)y * (size_t)level->width + (size_t)x];
}

static int within_level(int i, int count)
{
	return i < 0 ? 0 : i < count ? i : count - 1;
}

/* A coarse row: means of two by two points, weighted by how sure they are. */
static void pull_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int y = (int)row;
	for (int x = 0; x < job->coarse->width; x++) {
		float sum[4] = { 0 };
		for (int k = 0; k < 4; k++) {
			const int from_x = 2 * x + (k & 1), from_y = 2 * y + (k >> 1);
			if (from_x >= job->fine->width || from_y >= job->fine->height)
				continue;
			const float *from = point(job->fine, from_x, from_y);
			for (int c = 0; c < 3; c++)
				sum[c] += from[3] * from[c];
			sum[3] += from[3];
		}
		float *to = point(job->coarse, x, y);
		for (int c = 0; c < 3; c++)
			to[c] = sum[3] > 0 ? sum[c] / sum[3] : 0;
		to[3] = sum[3] < 1 ? sum[3] : 1;
	}
}

/* A fine row: unknown pixels come from the coarse level, bilinearly. */
static void push_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	const level_t *coarse = job->coarse;
	const int y = (int)row, near_y = y / 2;
	const int far_y = within_level(near_y + (y & 1 ? 1 : -1), coarse->height);
	for (int x = 0; x < job->fine->width; x++) {
		float *to = point(job->fine, x, y);
		if (to[3] >= 1)
			continue;
		const int near_x = x / 2,
			  far_x = within_level(near_x + (x & 1 ? 1 : -1), coarse->width);
		const float *from[4] = { point(coarse, near_x, near_y),
					 point(coarse, far_x, near_y), point(coarse, near_x, far_y),
					 point(coarse, far_x, far_y) };
		for (int c = 0; c < 3; c++) {
			const float filled =
				(9 * from[0][c] + 3 * from[1][c] + 3 * from[2][c] + from[3][c]) /
				16;
			to[c] = to[3] * to[c] + (1 - to[3]) * filled;
		}
		to[3] = 1;
	}
}

static void store_row(void *user, size_t row, int worker)
{
	(void)worker;
	const struct job *job = user;
	uint8_t *pixel = job->image->pixels + row * (size_t)job->image->width * 4;
	for (int x = 0; x < job->image->width; x++, pixel += 4)
		for (int c = 0; c < 3; c++)
			pixel[c] = (uint8_t)(point(job->fine, x, (int)row)[c] + 0.5F);
}

/* Fill all other pixels: means of what is known, fine to coarse, then what is not known, coarse to
 * fine, from the four nearest of the next coarser level. */
static void push_and_pull(struct push_pull *push_pull, struct gz_workers *workers,
			  struct gz_image *image)
{
	struct job job = { .image = image };
	for (int i = 0; i + 1 < PUSH_PULL_LEVELS; i++) {
		job.fine = &push_pull->levels[i];
		job.coarse = job.fine + 1;
		gz_workers_run(workers, pull_row, &job, (size_t)job.coarse->height);
	}
	for (int i = PUSH_PULL_LEVELS - 2; i >= 0; i--) {
		job.fine = &push_pull->levels[i];
		job.coarse = job.fine + 1;
		gz_workers_run(workers, push_row, &job, (size_t)job.fine->height);
	}
	gz_workers_run(workers, store_row, &job, (size_t)image->height);
}

static void free_push_pull(struct push_pull *push_pull)
{
	for (int i = 0; i < PUSH_PULL_LEVELS; i++)
		free(push_pull->levels[i].points);
	*push_pull = (struct push_pull) { 0 };
}

/* ---- the probe ---- */

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
	struct push_pull push_pull;
	struct series kinds[KINDS], copies;
	struct gz_map errors, ring;
	const char *prefix;
};

static double median_of(struct series *series, int count)
{
	qsort(series->time_ms, (size_t)count, sizeof series->time_ms[0], gz_compare_doubles);
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

/* One picture of a kind and the time to make it from the rays. */
static bool make_one(struct bench *bench, int kind, double *out_ms)
{
	const bool push_pull = kind == KINDS - 1;
	if (!render(bench, gz_method_find("acuity"), push_pull ? GZ_FILTER_BILINEAR : kind,
		    &bench->image, out_ms))
		return false;
	if (!push_pull)
		return true;
	if (take_cast_pixels(&bench->push_pull, &bench->plan, &bench->image) != GZ_OK)
		return false;
	const int64_t start_ns = gz_clock_now_ns();
	push_and_pull(&bench->push_pull, bench->workers, &bench->image);
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
	const double copy = median_of(copies, repeats), middle = median_of(series, repeats);
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
	bool done = make_one(bench, kind, &ms) &&
		    gz_squared_error(&bench->full, &bench->image, &bench->errors) == GZ_OK &&
		    gz_weights_ring(&bench->display, bench->gaze, bench->width, bench->height,
				    (const double[2]) { 5, 360 }, &bench->ring) == GZ_OK &&
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

static bool measure_one(struct bench *bench)
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
			if (!make_one(bench, kind, &ms))
				return false;
			const int k = i < 0 ? 0 : i;
			bench->kinds[kind].time_ms[k] = ms;
			if (kind == 0)
				bench->copies.time_ms[k] = copy_ms(bench);
		}
	printf("%dx%d  gaze %.3f %.3f  %s  copy %.2f ms\n", bench->width, bench->height,
	       (double)bench->gaze.x, (double)bench->gaze.y,
	       gz_picture_maker_describe(bench->maker), median_of(&bench->copies, bench->repeats));
	for (int kind = 0; kind < KINDS; kind++) {
		if (!print_errors(bench, kind))
			return false;
		print_times(&bench->kinds[kind], &bench->copies, bench->repeats);
	}
	return measure_regions(bench);
}

static bool measure_kinds(struct bench *bench, const char *sizes)
{
	for (const char *size = sizes; size; size = strchr(size, ',')) {
		size += *size == ',';
		if (sscanf(size, "%dx%d", &bench->width, &bench->height) != 2 ||
		    !measure_one(bench))
			return false;
	}
	return true;
}

static void release_all(struct bench *bench)
{
	gz_picture_maker_destroy(&bench->maker);
	gz_workers_destroy(&bench->workers);
	gz_scene_free(&bench->scene);
	gz_plan_free(&bench->plan);
	gz_image_free(&bench->full);
	gz_image_free(&bench->image);
	gz_image_free(&bench->copy);
	free_push_pull(&bench->push_pull);
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
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count =
		gz_scene_list_objects(&bench.scene, objects, sizeof objects / sizeof objects[0]);
	const bool done = gz_workers_create(0, &bench.workers) == GZ_OK &&
			  gz_picture_maker_create(&params, &bench.log, &bench.maker) == GZ_OK &&
			  gz_picture_maker_show(bench.maker, objects, count) == GZ_OK &&
			  measure_kinds(&bench, argv[2]);
	release_all(&bench);
	return done ? 0 : 1;
}
