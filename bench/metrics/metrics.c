#include "bench/metrics/metrics.h"

#include <math.h>
#include <stdlib.h>

#include "bench/metrics/convolve.h"

enum gz_result gz_map_resize(struct gz_map *map, int width, int height)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	const size_t count = (size_t)width * (size_t)height;
	if (!map->values || count > (size_t)map->width * (size_t)map->height) {
		float *values = realloc(map->values, count * sizeof *values);
		if (!values)
			return GZ_ERR_NO_MEM;
		map->values = values;
	}
	map->width = width;
	map->height = height;
	return GZ_OK;
}

void gz_map_free(struct gz_map *map)
{
	free(map->values);
	*map = (struct gz_map) { 0 };
}

double gz_map_mean(const struct gz_map *map)
{
	const size_t count = (size_t)map->width * (size_t)map->height;
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += (double)map->values[i];
	return count ? sum / (double)count : 0;
}

double gz_map_weighted_mean(const struct gz_map *map, const struct gz_map *weights)
{
	const size_t count = (size_t)map->width * (size_t)map->height;
	double sum = 0, total = 0;
	for (size_t i = 0; i < count; i++) {
		sum += (double)map->values[i] * (double)weights->values[i];
		total += (double)weights->values[i];
	}
	return total > 0 ? sum / total : 0;
}

/* ---- PSNR ---- */

enum gz_result gz_squared_error(const struct gz_image *reference, const struct gz_image *test,
				struct gz_map *out_map)
{
	if (reference->width != test->width || reference->height != test->height)
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_map_resize(out_map, test->width, test->height);
	if (result != GZ_OK)
		return result;
	const size_t count = (size_t)test->width * (size_t)test->height;
	for (size_t i = 0; i < count; i++) {
		int sum = 0;
		for (size_t channel = 0; channel < 3; channel++) {
			const int d =
				reference->pixels[4 * i + channel] - test->pixels[4 * i + channel];
			sum += d * d;
		}
		out_map->values[i] = (float)sum / (3 * 255 * 255);
	}
	return GZ_OK;
}

double gz_psnr_db(double mean_squared_error)
{
	return mean_squared_error > 0 ? -10 * log10(mean_squared_error) : INFINITY;
}

/* ---- weights ---- */

/* Half-resolution eccentricity of Geisler and Perry 1998, degrees. */
#define E2_DEG 2.3

static struct gz_point pixel_at(int x, int y, int width, int height)
{
	return (struct gz_point) { ((float)x + 0.5F) / (float)width,
				   ((float)y + 0.5F) / (float)height };
}

/* The weight of a pixel at an angle from the gaze, degrees. */
typedef float (*weight_at)(double angle_deg, const double ring_deg[2]);

static float weight_of_ring(double angle_deg, const double ring_deg[2])
{
	return angle_deg >= ring_deg[0] && angle_deg < ring_deg[1] ? 1 : 0;
}

static float weight_of_acuity(double angle_deg, const double ring_deg[2])
{
	(void)ring_deg;
	const double share = E2_DEG / (angle_deg + E2_DEG);
	return (float)(share * share);
}

static void fill_weights(const struct gz_display *display, struct gz_point gaze, struct gz_map *map,
			 weight_at weight, const double ring_deg[2])
{
	float *value = map->values;
	for (int y = 0; y < map->height; y++)
		for (int x = 0; x < map->width; x++) {
			const struct gz_point pixel = pixel_at(x, y, map->width, map->height);
			*value++ = weight(gz_display_angle_deg(display, gaze, pixel), ring_deg);
		}
}

enum gz_result gz_weights_ring(const struct gz_display *display, struct gz_point gaze, int width,
			       int height, const double ring_deg[2], struct gz_map *out_map)
{
	const enum gz_result result = gz_map_resize(out_map, width, height);
	if (result == GZ_OK)
		fill_weights(display, gaze, out_map, weight_of_ring, ring_deg);
	return result;
}

enum gz_result gz_weights_acuity(const struct gz_display *display, struct gz_point gaze, int width,
				 int height, struct gz_map *out_map)
{
	const enum gz_result result = gz_map_resize(out_map, width, height);
	if (result == GZ_OK)
		fill_weights(display, gaze, out_map, weight_of_acuity, NULL);
	return result;
}

/* ---- SSIM ---- */

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

static float *ssim_plane(const struct work *work, enum plane plane)
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
	float *out = ssim_plane(work, plane);
	const size_t count = (size_t)work->width * (size_t)work->height;
	for (size_t i = 0; i < count; i++)
		out[i] = (float)(image->pixels[4 * i + (size_t)channel] - MIDDLE);
}

/* The windowed mean of the product of two planes; @p b NULL for that of one. */
static void average_plane(const struct work *work, enum plane a, const enum plane *b,
			  enum plane out)
{
	const size_t count = (size_t)work->width * (size_t)work->height;
	const float *in = ssim_plane(work, a);
	if (b) {
		const float *other = ssim_plane(work, *b);
		float *product = ssim_plane(work, PRODUCT);
		for (size_t i = 0; i < count; i++)
			product[i] = in[i] * other[i];
		in = product;
	}
	gz_convolve(
		&(struct gz_convolution) {
			.in = in,
			.out = ssim_plane(work, out),
			.scratch = ssim_plane(work, SCRATCH),
			.width = work->width,
			.height = work->height,
			.across = &work->kernel,
			.down = &work->kernel,
			.scale = 1,
		},
		work->workers);
}

static double similarity(const struct work *work, size_t i)
{
	const double r = (double)ssim_plane(work, MEAN_R)[i],
		     t = (double)ssim_plane(work, MEAN_T)[i];
	const double rr = work->unbias * ((double)ssim_plane(work, MEAN_RR)[i] - r * r);
	const double tt = work->unbias * ((double)ssim_plane(work, MEAN_TT)[i] - t * t);
	const double rt = work->unbias * ((double)ssim_plane(work, MEAN_RT)[i] - r * t);
	const double mean_r = r + MIDDLE, mean_t = t + MIDDLE;
	return (2 * mean_r * mean_t + C1) * (2 * rt + C2) /
	       ((mean_r * mean_r + mean_t * mean_t + C1) * (rr + tt + C2));
}

static void add_channel(const struct work *work, struct gz_map *map)
{
	static const enum plane reference = REFERENCE, test = TEST;
	average_plane(work, REFERENCE, NULL, MEAN_R);
	average_plane(work, TEST, NULL, MEAN_T);
	average_plane(work, REFERENCE, &reference, MEAN_RR);
	average_plane(work, TEST, &test, MEAN_TT);
	average_plane(work, REFERENCE, &test, MEAN_RT);
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
