/*
 * LDR-FLIP (Andersson et al. 2020): colours as the eye blurs them, compared, and sharpened by where
 * edges and points differ.
 */
#include <math.h>
#include <stdlib.h>

#include "bench/metrics/convolve.h"
#include "bench/metrics/flip_colour.h"
#include "bench/metrics/metrics.h"

/* The paper's constants: exponent, share and value of the knee of the colour difference (4.1),
 * width of the feature filters in degrees and their exponent (4.2). */
#define COLOUR_EXPONENT  0.7F
#define KNEE_SHARE       0.4F
#define KNEE_VALUE       0.95F
#define FEATURE_DEG      0.082
#define FEATURE_EXPONENT 0.5F

enum { ROWS_A_PART = 16 };

/* Contrast sensitivity of a channel as two Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in
 * degrees (the paper's table 1, after Johnson and Fairchild 2003). */
static const struct sensitivity {
	double a[2], b[2];
} sensitivities[3] = {
	{ { 1, 0 }, { 0.0047, 1e-5 } },
	{ { 1, 0 }, { 0.0053, 1e-5 } },
	{ { 34.1, 13.5 }, { 0.04, 0.025 } },
};

/* Planes of one picture: opponent colours, the same blurred, and what its features are made of. */
enum plane { OPPONENT, BLURRED = 3, EDGE_X = 6, EDGE_Y, POINT_X, POINT_Y, PLANES };

struct work {
	int width, height;
	double px_per_deg;
	struct gz_workers *workers;
	float *memory; /* both pictures' planes and a scratch plane */
	float colour_max;
	struct gz_kernel gaussian, edge, point;
	const struct gz_image *pictures[2];
	float linear[256];
	float *out;
};

static float *plane_of(const struct work *work, int picture, int plane)
{
	const size_t count = (size_t)work->width * (size_t)work->height;
	return work->memory + (size_t)(picture * PLANES + plane) * count;
}

static float *scratch_of(const struct work *work)
{
	return plane_of(work, 2, 0);
}

/* exp(-pi^2 x^2 / b); its sum. */
static double sensitivity_kernel(const struct work *work, double b, struct gz_kernel *kernel)
{
	/* Three standard deviations of the widest of all channels. */
	kernel->radius = (int)ceil(3 * sqrt(0.04 / (2 * M_PI * M_PI)) * work->px_per_deg);
	double sum = 0;
	for (int i = 0; i <= 2 * kernel->radius; i++) {
		const double x = (i - kernel->radius) / work->px_per_deg;
		const double weight = exp(-M_PI * M_PI * x * x / b);
		kernel->weights[i] = (float)weight;
		sum += weight;
	}
	return sum;
}

static void blur(const struct work *work, int picture, int channel)
{
	const struct sensitivity *s = &sensitivities[channel];
	struct gz_kernel kernels[2];
	double scale[2], total = 0;
	for (int i = 0; i < 2; i++) {
		const double sum = sensitivity_kernel(work, s->b[i], &kernels[i]);
		scale[i] = s->a[i] * sqrt(M_PI / s->b[i]);
		total += scale[i] * sum * sum;
	}
	for (int i = 0; i < 2; i++)
		if (scale[i] > 0)
			gz_convolve(plane_of(work, picture, OPPONENT + channel), work->width,
				    work->height, &kernels[i], &kernels[i],
				    (float)(scale[i] / total), i > 0, work->workers,
				    scratch_of(work), plane_of(work, picture, BLURRED + channel));
}

/* Positive and negative weights each add up to 1. */
static void balance(struct gz_kernel *kernel)
{
	double positive = 0, negative = 0;
	for (int i = 0; i <= 2 * kernel->radius; i++) {
		const double weight = (double)kernel->weights[i];
		*(weight > 0 ? &positive : &negative) += fabs(weight);
	}
	for (int i = 0; i <= 2 * kernel->radius; i++) {
		const double weight = (double)kernel->weights[i];
		kernel->weights[i] = (float)(weight / (weight > 0 ? positive : negative));
	}
}

/* A Gaussian and its first and second derivative. */
static void make_feature_kernels(struct work *work)
{
	const double sigma = 0.5 * FEATURE_DEG * work->px_per_deg;
	const int radius = (int)ceil(3 * sigma);
	double sum = 0;
	for (int i = 0; i <= 2 * radius; i++) {
		const double x = i - radius, bell = exp(-x * x / (2 * sigma * sigma));
		sum += bell;
		work->gaussian.weights[i] = (float)bell;
		work->edge.weights[i] = (float)(-x * bell);
		work->point.weights[i] = (float)((x * x / (sigma * sigma) - 1) * bell);
	}
	for (int i = 0; i <= 2 * radius; i++)
		work->gaussian.weights[i] = (float)((double)work->gaussian.weights[i] / sum);
	work->gaussian.radius = work->edge.radius = work->point.radius = radius;
	balance(&work->edge);
	balance(&work->point);
}

static void feature(const struct work *work, int picture, const struct gz_kernel *across,
		    const struct gz_kernel *down, enum plane out)
{
	/* Lightness as [0, 1]; what is added to all of it the balanced kernels do not see. */
	gz_convolve(plane_of(work, picture, OPPONENT), work->width, work->height, across, down,
		    1.0F / 116, false, work->workers, scratch_of(work),
		    plane_of(work, picture, out));
}

static void opponent_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct work *work = user;
	const size_t count = (size_t)work->width * (size_t)work->height;
	const size_t from = part * ROWS_A_PART * (size_t)work->width;
	const size_t to = from + ROWS_A_PART * (size_t)work->width;
	for (int picture = 0; picture < 2; picture++)
		for (size_t i = from; i < to && i < count; i++) {
			const uint8_t *pixel = work->pictures[picture]->pixels + 4 * i;
			const float rgb[3] = { work->linear[pixel[0]], work->linear[pixel[1]],
					       work->linear[pixel[2]] };
			float opponent[3];
			gz_opponent_of_linear(rgb, opponent);
			for (int channel = 0; channel < 3; channel++)
				plane_of(work, picture, OPPONENT + channel)[i] = opponent[channel];
		}
}

static void seen_colour(const struct work *work, int picture, size_t i, float out_lab[3])
{
	float opponent[3], rgb[3];
	for (int channel = 0; channel < 3; channel++)
		opponent[channel] = plane_of(work, picture, BLURRED + channel)[i];
	gz_linear_of_opponent(opponent, rgb);
	gz_hunt_lab_of_linear(rgb, out_lab);
}

static float colour_difference(const struct work *work, size_t i)
{
	float a[3], b[3];
	seen_colour(work, 0, i, a);
	seen_colour(work, 1, i, b);
	const float difference = powf(gz_hyab(a, b), COLOUR_EXPONENT);
	const float knee = KNEE_SHARE * work->colour_max;
	if (difference < knee)
		return KNEE_VALUE / knee * difference;
	return KNEE_VALUE + (difference - knee) / (work->colour_max - knee) * (1 - KNEE_VALUE);
}

static float feature_strength(const struct work *work, int picture, int plane, size_t i)
{
	return hypotf(plane_of(work, picture, plane)[i], plane_of(work, picture, plane + 1)[i]);
}

static float feature_difference(const struct work *work, size_t i)
{
	const float edge =
		fabsf(feature_strength(work, 0, EDGE_X, i) - feature_strength(work, 1, EDGE_X, i));
	const float point = fabsf(feature_strength(work, 0, POINT_X, i) -
				  feature_strength(work, 1, POINT_X, i));
	return powf(fmaxf(edge, point) * (float)M_SQRT1_2, FEATURE_EXPONENT);
}

static void compare_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct work *work = user;
	const size_t count = (size_t)work->width * (size_t)work->height;
	const size_t from = part * ROWS_A_PART * (size_t)work->width;
	const size_t to = from + ROWS_A_PART * (size_t)work->width;
	for (size_t i = from; i < to && i < count; i++) {
		const float colour = colour_difference(work, i);
		work->out[i] = colour > 0 ? powf(colour, 1 - feature_difference(work, i)) : 0;
	}
}

/* The greatest colour difference: green to blue. */
static float greatest_difference(void)
{
	const float green[3] = { 0, 1, 0 }, blue[3] = { 0, 0, 1 };
	float a[3], b[3];
	gz_hunt_lab_of_linear(green, a);
	gz_hunt_lab_of_linear(blue, b);
	return powf(gz_hyab(a, b), COLOUR_EXPONENT);
}

static void compare(struct work *work)
{
	const size_t parts = ((size_t)work->height + ROWS_A_PART - 1) / ROWS_A_PART;
	gz_workers_run(work->workers, opponent_part, work, parts);
	for (int picture = 0; picture < 2; picture++) {
		for (int channel = 0; channel < 3; channel++)
			blur(work, picture, channel);
		feature(work, picture, &work->edge, &work->gaussian, EDGE_X);
		feature(work, picture, &work->gaussian, &work->edge, EDGE_Y);
		feature(work, picture, &work->point, &work->gaussian, POINT_X);
		feature(work, picture, &work->gaussian, &work->point, POINT_Y);
	}
	gz_workers_run(work->workers, compare_part, work, parts);
}

enum gz_result gz_flip(const struct gz_image *reference, const struct gz_image *test,
		       double px_per_deg, struct gz_workers *workers, struct gz_map *out_map)
{
	struct work work = {
		.width = test->width,
		.height = test->height,
		.px_per_deg = px_per_deg,
		.workers = workers,
		.pictures = { reference, test },
		.colour_max = greatest_difference(),
	};
	if (reference->width != test->width || reference->height != test->height ||
	    !(px_per_deg >= 1 && px_per_deg <= 1000))
		return GZ_ERR_INVAL;
	const enum gz_result result = gz_map_resize(out_map, work.width, work.height);
	if (result != GZ_OK)
		return result;
	const size_t count = (size_t)work.width * (size_t)work.height;
	work.memory = malloc((2 * PLANES + 1) * count * sizeof *work.memory);
	if (!work.memory)
		return GZ_ERR_NO_MEM;
	for (int i = 0; i < 256; i++)
		work.linear[i] = gz_linear_of_srgb((uint8_t)i);
	work.out = out_map->values;
	make_feature_kernels(&work);
	compare(&work);
	free(work.memory);
	return GZ_OK;
}
