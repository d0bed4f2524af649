#include <math.h>
#include <stdlib.h>

#include "bench/metrics/convolve.h"
#include "bench/metrics/metrics.h"

/* (K1 L)^2 and (K2 L)^2 with K1 = .01, K2 = .03, L = 255. */
#define C1 (0.01 * 255 * 0.01 * 255)
#define C2 (0.03 * 255 * 0.03 * 255)

/* Taken off each value, so that differences of squares keep their digits in single precision. */
#define MIDDLE 128

/* Planes: both pictures, their means, squares and product, and what gz_convolve() needs. */
enum plane { REFERENCE, TEST, PRODUCT, MEAN_R, MEAN_T, MEAN_RR, MEAN_TT, MEAN_RT, SCRATCH, PLANES };

struct work {
	int width, height, radius;
	double unbias; /* of the covariances */
	struct gz_kernel kernel;
	struct gz_workers *workers;
	float *memory;
};

static float *plane_of(const struct work *work, enum plane plane)
{
	return work->memory + (size_t)plane * (size_t)work->width * (size_t)work->height;
}

static void set_kernel(struct work *work, enum gz_ssim_window window)
{
	const double sigma = 1.5;
	const int size = 2 * work->radius + 1;
	double sum = 0;
	for (int i = 0; i < size; i++) {
		const double x = i - work->radius;
		const double weight =
			window == GZ_SSIM_UNIFORM ? 1 : exp(-x * x / (2 * sigma * sigma));
		work->kernel.weights[i] = (float)weight;
		sum += weight;
	}
	for (int i = 0; i < size; i++)
		work->kernel.weights[i] = (float)((double)work->kernel.weights[i] / sum);
	work->kernel.radius = work->radius;
	work->unbias = window == GZ_SSIM_UNIFORM ? size * size / (size * size - 1.0) : 1;
}

static void take_channel(const struct work *work, const struct gz_image *image, int channel,
			 enum plane plane)
{
	float *out = plane_of(work, plane);
	const size_t count = (size_t)work->width * (size_t)work->height;
	for (size_t i = 0; i < count; i++)
		out[i] = (float)(image->pixels[4 * i + (size_t)channel] - MIDDLE);
}

/* The windowed mean of the product of two planes; @p b NULL for that of one. */
static void average(const struct work *work, enum plane a, const enum plane *b, enum plane out)
{
	const size_t count = (size_t)work->width * (size_t)work->height;
	const float *in = plane_of(work, a);
	if (b) {
		const float *other = plane_of(work, *b);
		float *product = plane_of(work, PRODUCT);
		for (size_t i = 0; i < count; i++)
			product[i] = in[i] * other[i];
		in = product;
	}
	gz_convolve(in, work->width, work->height, &work->kernel, &work->kernel, 1, false,
		    work->workers, plane_of(work, SCRATCH), plane_of(work, out));
}

static double similarity(const struct work *work, size_t i)
{
	const double r = (double)plane_of(work, MEAN_R)[i], t = (double)plane_of(work, MEAN_T)[i];
	const double rr = work->unbias * ((double)plane_of(work, MEAN_RR)[i] - r * r);
	const double tt = work->unbias * ((double)plane_of(work, MEAN_TT)[i] - t * t);
	const double rt = work->unbias * ((double)plane_of(work, MEAN_RT)[i] - r * t);
	const double mean_r = r + MIDDLE, mean_t = t + MIDDLE;
	return (2 * mean_r * mean_t + C1) * (2 * rt + C2) /
	       ((mean_r * mean_r + mean_t * mean_t + C1) * (rr + tt + C2));
}

static void add_channel(const struct work *work, struct gz_map *map)
{
	static const enum plane reference = REFERENCE, test = TEST;
	average(work, REFERENCE, NULL, MEAN_R);
	average(work, TEST, NULL, MEAN_T);
	average(work, REFERENCE, &reference, MEAN_RR);
	average(work, TEST, &test, MEAN_TT);
	average(work, REFERENCE, &test, MEAN_RT);
	float *value = map->values;
	for (int y = work->radius; y < work->height - work->radius; y++)
		for (int x = work->radius; x < work->width - work->radius; x++)
			*value++ += (float)(similarity(work, (size_t)y * (size_t)work->width +
								     (size_t)x) /
					    3);
}

enum gz_result gz_ssim(const struct gz_image *reference, const struct gz_image *test,
		       enum gz_ssim_window window, struct gz_workers *workers,
		       struct gz_map *out_map)
{
	struct work work = {
		.width = test->width,
		.height = test->height,
		.radius = window == GZ_SSIM_UNIFORM ? 3 : 5,
		.workers = workers,
	};
	if (reference->width != test->width || reference->height != test->height)
		return GZ_ERR_INVAL;
	const enum gz_result result =
		gz_map_resize(out_map, work.width - 2 * work.radius, work.height - 2 * work.radius);
	if (result != GZ_OK)
		return result;
	const size_t count = (size_t)work.width * (size_t)work.height;
	work.memory = malloc(PLANES * count * sizeof *work.memory);
	if (!work.memory)
		return GZ_ERR_NO_MEM;
	set_kernel(&work, window);
	const size_t inside = (size_t)out_map->width * (size_t)out_map->height;
	for (size_t i = 0; i < inside; i++)
		out_map->values[i] = 0;
	for (int channel = 0; channel < 3; channel++) {
		take_channel(&work, reference, channel, REFERENCE);
		take_channel(&work, test, channel, TEST);
		add_channel(&work, out_map);
	}
	free(work.memory);
	return GZ_OK;
}
