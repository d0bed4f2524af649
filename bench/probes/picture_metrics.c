/*
 * Times of the metrics of bench/metrics/ on two pictures of noise, which differ in every pixel.
 *
 *   picture_metrics [WIDTHxHEIGHT] [THREADS] [ROUNDS]
 */
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/order.h"
#include "bench/metrics/metrics.h"

/* The viewing conditions of FLIP's authors: bench/gazebench/compare.c. */
#define PX_PER_DEG 67.0206

enum { ROUNDS_MAX = 101 };

struct bench {
	struct gz_image pictures[2];
	struct gz_workers *workers;
	struct gz_map map;
	int rounds;
};

static enum gz_result measure_psnr(struct bench *bench)
{
	return gz_squared_error(&bench->pictures[0], &bench->pictures[1], &bench->map);
}

static enum gz_result measure_ssim(struct bench *bench)
{
	return gz_ssim(&bench->pictures[0], &bench->pictures[1], GZ_SSIM_GAUSSIAN, bench->workers,
		       &bench->map);
}

static enum gz_result measure_flip(struct bench *bench)
{
	return gz_flip(&bench->pictures[0], &bench->pictures[1], PX_PER_DEG, bench->workers,
		       &bench->map);
}

static int print_metric(struct bench *bench, const char *name,
			enum gz_result (*metric)(struct bench *))
{
	double ms[ROUNDS_MAX] = { 0 };
	for (int i = -1; i < bench->rounds; i++) { /* the first warms up */
		const int64_t start_ns = gz_clock_now_ns();
		if (metric(bench) != GZ_OK) {
			fprintf(stderr, "%s: cannot be measured\n", name);
			return -1;
		}
		if (i >= 0)
			ms[i] = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	}
	qsort(ms, (size_t)bench->rounds, sizeof *ms, gz_compare_doubles);
	printf("%-5s least %7.1f ms  median %7.1f ms  mean value %.6f\n", name, ms[0],
	       ms[bench->rounds / 2], gz_map_mean(&bench->map));
	return 0;
}

/* The same noise each time. */
static enum gz_result make_pictures(struct bench *bench, int width, int height)
{
	uint32_t state = 1;
	for (int k = 0; k < 2; k++) {
		struct gz_image *picture = &bench->pictures[k];
		const enum gz_result result = gz_image_resize(picture, width, height);
		if (result != GZ_OK)
			return result;
		for (size_t i = 0; i < (size_t)width * (size_t)height * 4; i++) {
			state = state * 1664525U + 1013904223U; /* Knuth, TAOCP 2, 3.3.4 */
			picture->pixels[i] = i % 4 == 3 ? 255 : (uint8_t)(state >> 24);
		}
	}
	return GZ_OK;
}

int main(int argc, char **argv)
{
	struct bench bench = { .rounds = argc > 3 ? atoi(argv[3]) : 5 };
	const int threads = argc > 2 ? atoi(argv[2]) : 2;
	int width = 1920, height = 1080;
	if ((argc > 1 && sscanf(argv[1], "%dx%d", &width, &height) != 2) || bench.rounds < 1 ||
	    bench.rounds > ROUNDS_MAX || threads < 1) {
		fprintf(stderr, "usage: %s [WIDTHxHEIGHT] [THREADS] [ROUNDS, 1 to %d]\n", argv[0],
			ROUNDS_MAX);
		return 2;
	}
	int failed = make_pictures(&bench, width, height) != GZ_OK ||
		     gz_workers_create(threads, &bench.workers) != GZ_OK;
	if (!failed) {
		printf("%dx%d, %d threads\n", width, height, threads);
		failed = print_metric(&bench, "psnr", measure_psnr) != 0 ||
			 print_metric(&bench, "ssim", measure_ssim) != 0 ||
			 print_metric(&bench, "flip", measure_flip) != 0;
	}
	gz_workers_destroy(&bench.workers);
	gz_image_free(&bench.pictures[0]);
	gz_image_free(&bench.pictures[1]);
	gz_map_free(&bench.map);
	return failed;
}
