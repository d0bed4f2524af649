/*
 * How near the cast comes to what memory allows: samples per second and core of whole frames of the
 * cpu backend, against a bare loop over the same rays, voxels and steps that gathers and
 * interpolates every sample and does nothing else: no look-up of colour, no skipping, no
 * compositing. Processor time of one thread; the two in turn, the least of all rounds. What a new
 * volume and a new transfer function take before the next frame is printed too.
 *
 *   cast_limit SCENE [WIDTHxHEIGHT] [ROUNDS] [SIMD]
 */
#include "bench/probes/cast_limit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render/raycast/shared/ray_params.h"
#include "render/raycast/shared/raycaster.h"
#include "render/scene/scene.h"

enum { ROUNDS_MAX = 1000 };

/* A frame or a loop, its least time. */
struct timing {
	uint64_t samples;
	double least_ns;
};

struct bench {
	struct gz_log log;
	struct gz_scene scene;
	struct gz_raycaster *renderer;
	struct gz_plan plan[2]; /* standard, acuity */
	struct gz_image image;
	int width, height;
	gz_limit_function *limit;
	struct gz_cast cast; /* for the loop: no cells, no colours */
	float sum;           /* keeps the compiler from removing the loop */
};

static double processor_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static void note(struct timing *timing, double started_ns, uint64_t samples)
{
	const double ns = processor_ns() - started_ns;
	timing->samples = samples;
	if (timing->least_ns <= 0 || ns < timing->least_ns)
		timing->least_ns = ns;
}

/* The cast's view of volume and rays. */
static void fill_cast(struct bench *bench)
{
	const struct gz_volume *volume = &bench->scene.volume;
	struct gz_cast *cast = &bench->cast;
	struct gz_ray_frame world;
	struct gz_voxel_rays rays;
	gz_camera_rays(&bench->scene.settings.camera, bench->width, bench->height, &world);
	gz_voxel_rays_make(volume, (const int[3]) { 1, 1, 1 }, &world, &rays);
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, volume->dims[axis] * volume->spacing[axis]);
	cast->voxels = volume->voxels;
	int stride = 1;
	for (int axis = 0; axis < 3; axis++) {
		cast->box[axis] = cast->dims[axis] = (float)volume->dims[axis];
		cast->clip_greatest[axis] = cast->box[axis]; /* the least is 0 */
		cast->last[axis] = volume->dims[axis] > 1 ? volume->dims[axis] - 2 : 0;
		cast->stride[axis] = axis == 0 || volume->dims[axis] > 1 ? stride : 0;
		stride *= volume->dims[axis];
		cast->world_per_voxel[axis] = (float)(volume->spacing[axis] / longest);
		cast->origin00[axis] = (float)rays.frame.origin00[axis];
		cast->origin_dx[axis] = (float)rays.frame.origin_dx[axis];
		cast->origin_dy[axis] = (float)rays.frame.origin_dy[axis];
		cast->direction00[axis] = (float)rays.frame.direction00[axis];
		cast->direction_dx[axis] = (float)rays.frame.direction_dx[axis];
		cast->direction_dy[axis] = (float)rays.frame.direction_dy[axis];
	}
	cast->clip_plane[3] = 1; /* the other numbers are 0: no plane */
	cast->step[0] = (float)(gz_volume_voxel_length(volume) /
				bench->scene.settings.rays.ray_sampling_rate);
}

static void time_limit(struct bench *bench, struct timing *timing)
{
	uint64_t samples = 0;
	const double started_ns = processor_ns();
	for (int y = 0; y < bench->height; y += GZ_TILE_EDGE)
		for (int x = 0; x < bench->width; x += GZ_TILE_EDGE) {
			struct gz_cast_tile tile = { .active = 0xFFFF };
			for (int i = 0; i < GZ_TILE_RAYS; i++) {
				tile.x[i] = (float)(x + i % GZ_TILE_EDGE);
				tile.y[i] = (float)(y + i / GZ_TILE_EDGE);
			}
			float sums[GZ_TILE_RAYS];
			samples +=
				bench->limit(&bench->cast, &tile, bench->scene.volume.type, sums);
			bench->sum += sums[0];
		}
	note(timing, started_ns, samples);
}

static int time_cast(struct bench *bench, int which, struct timing *timing)
{
	struct gz_frame_stats stats;
	const double started_ns = processor_ns();
	if (gz_raycaster_render(bench->renderer, &bench->scene.settings.camera,
				&bench->scene.settings.rays, &bench->plan[which], &bench->image,
				&stats) != GZ_OK)
		return -1;
	note(timing, started_ns, stats.samples);
	return 0;
}

static int measure_casts(struct bench *bench, int rounds, struct timing frames[2],
			 struct timing *limit)
{
	for (int round = 0; round < rounds; round++) {
		for (int which = 0; which < 2; which++)
			if (time_cast(bench, which, &frames[which]) != 0)
				return -1;
		time_limit(bench, limit);
	}
	return 0;
}

static void print(const char *name, const struct timing *timing, const struct timing *limit)
{
	const double rate = (double)timing->samples / timing->least_ns;
	printf("  %-9s %9.2f ms  %11llu samples  %7.1f million a second and core  %5.2f ns "
	       "each  ratio to the loop %.2f\n",
	       name, timing->least_ns / 1e6, (unsigned long long)timing->samples, rate * 1e3,
	       1 / rate, rate * limit->least_ns / (double)limit->samples);
}

static int choose_set(struct bench *bench)
{
	const char *set = gz_raycaster_describe(bench->renderer);
	bench->limit = gz_limit_portable;
#ifdef GZ_CAST_X86
	if (strncmp(set, "avx512", 6) == 0)
		bench->limit = gz_limit_avx512;
	else if (strncmp(set, "avx2", 4) == 0)
		bench->limit = gz_limit_avx2;
#endif
	printf("%dx%d  %s\n", bench->width, bench->height, set);
	return 0;
}

static int make_plans(struct bench *bench)
{
	const struct gz_foveation foveations[2] = { gz_foveation_full(), gz_foveation_default() };
	const struct gz_display display = bench->scene.has_display
						  ? bench->scene.settings.display
						  : gz_display_default(bench->width, bench->height);
	for (int which = 0; which < 2; which++) {
		if (gz_plan_make(&foveations[which], &display, (struct gz_point) { 0.5F, 0.5F },
				 bench->width, bench->height, &bench->plan[which]) != GZ_OK)
			return -1;
	}
	return 0;
}

/* Cost of a new volume and of a new transfer function before the next frame. */
static int measure_changes(struct bench *bench, int rounds)
{
	struct timing volume = { 0 }, transfer = { 0 };
	for (int round = 0; round < rounds; round++) {
		double started_ns = processor_ns();
		if (gz_raycaster_set_volume(bench->renderer, &bench->scene.volume) != GZ_OK)
			return -1;
		note(&volume, started_ns, 0);
		started_ns = processor_ns();
		if (gz_raycaster_set_transfer(bench->renderer, &bench->scene.transfer) != GZ_OK)
			return -1;
		note(&transfer, started_ns, 0);
	}
	printf("  new volume %.2f ms, new transfer function %.2f ms\n", volume.least_ns / 1e6,
	       transfer.least_ns / 1e6);
	return 0;
}

static int run(struct bench *bench, int rounds)
{
	struct timing frames[2] = { 0 }, limit = { 0 };
	if (make_plans(bench) != 0 || choose_set(bench) != 0)
		return -1;
	fill_cast(bench);
	if (measure_casts(bench, rounds, frames, &limit) != 0)
		return -1;
	print("bare loop", &limit, &limit);
	print("standard", &frames[0], &limit);
	print("acuity", &frames[1], &limit);
	return limit.samples > 0 && isfinite(bench->sum) ? 0 : -1;
}

int main(int argc, char **argv)
{
	struct bench bench = { .width = 1024, .height = 1024 };
	const int rounds = argc > 3 ? atoi(argv[3]) : 3;
	if (argc < 2 || rounds < 1 || rounds > ROUNDS_MAX ||
	    (argc > 2 && sscanf(argv[2], "%dx%d", &bench.width, &bench.height) != 2)) {
		fprintf(stderr, "usage: %s SCENE [WIDTHxHEIGHT] [ROUNDS] [SIMD]\n", argv[0]);
		return 2;
	}
	gz_log_init(&bench.log, NULL, NULL, NULL);
	if (gz_scene_load(argv[1], NULL, &bench.log, &bench.scene) != GZ_OK)
		return 1;
	if (bench.scene.volume.bricks) {
		fprintf(stderr, "%s: a file of bricks; name a scene whose volume is in memory\n",
			argv[1]);
		gz_scene_free(&bench.scene);
		return 1;
	}
	const struct gz_backend_params params = { .threads = 1, .simd = argc > 4 ? argv[4] : NULL };
	int failed = 1;
	if (gz_raycaster_create("cpu", &params, &bench.log, &bench.renderer) == GZ_OK &&
	    measure_changes(&bench, rounds) == 0)
		failed = run(&bench, rounds) != 0;
	gz_raycaster_destroy(&bench.renderer);
	gz_scene_free(&bench.scene);
	for (int which = 0; which < 2; which++)
		gz_plan_free(&bench.plan[which]);
	gz_image_free(&bench.image);
	return failed;
}
