/*
 * LDR-FLIP (Andersson et al. 2020): colours as the eye blurs them, compared, and sharpened by where
 * edges and points differ.
 */
#include <math.h>
#include <stdlib.h>

#include "bench/metrics/approximate.h"
#include "bench/metrics/convolve.h"
#include "bench/metrics/flip_colour.h"
#include "bench/metrics/metrics.h"

/* The paper's constants: exponent, share and value of the knee of the colour difference (4.1),
 * width of the feature filters in degrees (4.2). */
#define COLOUR_EXPONENT 0.7F
#define KNEE_SHARE      0.4F
#define KNEE_VALUE      0.95F
#define FEATURE_DEG     0.082

/* Rows one thread takes at a time, and pixels whose numbers stay in the first cache. */
enum { ROWS_A_PART = 16, PIXELS = 256 };

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
	struct gz_flip_colours colours;
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

/* Pixels of a part of the picture. */
static size_t part_of(const struct work *work, size_t part, size_t *out_from)
{
	const size_t count = (size_t)work->width * (size_t)work->height;
	const size_t size = ROWS_A_PART * (size_t)work->width;
	*out_from = part * size;
	return *out_from + size < count ? size : count - *out_from;
}

static void opponent_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct work *work = user;
	size_t from;
	const size_t count = part_of(work, part, &from);
	for (int picture = 0; picture < 2; picture++) {
		float *planes[3];
		for (int channel = 0; channel < 3; channel++)
			planes[channel] = plane_of(work, picture, OPPONENT + channel) + from;
		gz_opponents_of_srgb(&work->colours, work->pictures[picture]->pixels + 4 * from,
				     count, planes);
	}
}

/* A run of pixels as a picture's blurred colours look. */
static void see(const struct work *work, int picture, size_t from, size_t count,
		float lab[3][PIXELS])
{
	const float *blurred[3];
	float *const planes[3] = { lab[0], lab[1], lab[2] };
	for (int channel = 0; channel < 3; channel++)
		blurred[channel] = plane_of(work, picture, BLURRED + channel) + from;
	gz_linear_of_opponents(&work->colours, blurred, count, planes);
	gz_hunt_labs_of_linear(&work->colours, count, planes);
}

static inline float square(float value)
{
	return value * value;
}

/* HyAB (Abasi et al. 2020) to the paper's exponent. */
static void colour_differences(float a[3][PIXELS], float b[3][PIXELS], size_t count, float *out)
{
	for (size_t i = 0; i < count; i++) {
		const float hyab = fabsf(a[0][i] - b[0][i]) +
				   sqrtf(square(a[1][i] - b[1][i]) + square(a[2][i] - b[2][i]));
		out[i] = gz_power(hyab, COLOUR_EXPONENT);
	}
}

/* What of it is below the knee takes most of the range. */
static inline float bend(float difference, float most)
{
	const float knee = KNEE_SHARE * most;
	const float low = KNEE_VALUE / knee * difference;
	const float high = KNEE_VALUE + (difference - knee) * ((1 - KNEE_VALUE) / (most - knee));
	return difference < knee ? low : high;
}

/* How far the strengths of a pair of features are apart. */
static void feature_differences(const struct work *work, enum plane x, size_t from, size_t count,
				float *out)
{
	const float *restrict ax = plane_of(work, 0, (int)x) + from;
	const float *restrict ay = plane_of(work, 0, (int)x + 1) + from;
	const float *restrict bx = plane_of(work, 1, (int)x) + from;
	const float *restrict by = plane_of(work, 1, (int)x + 1) + from;
	for (size_t i = 0; i < count; i++)
		out[i] = fabsf(sqrtf(square(ax[i]) + square(ay[i])) -
			       sqrtf(square(bx[i]) + square(by[i])));
}

static void compare_pixels(const struct work *work, size_t from, size_t count)
{
	float a[3][PIXELS], b[3][PIXELS], colour[PIXELS], edge[PIXELS], point[PIXELS];
	float *restrict out = work->out + from;
	see(work, 0, from, count, a);
	see(work, 1, from, count, b);
	colour_differences(a, b, count, colour);
	feature_differences(work, EDGE_X, from, count, edge);
	feature_differences(work, POINT_X, from, count, point);
	for (size_t i = 0; i < count; i++) {
		const float strength = edge[i] > point[i] ? edge[i] : point[i];
		/* To the paper's exponent (4.2), 1/2. */
		const float feature = sqrtf(strength * (float)M_SQRT1_2);
		out[i] = gz_power(bend(colour[i], work->colour_max), 1 - feature);
	}
}

static void compare_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct work *work = user;
	size_t from;
	const size_t count = part_of(work, part, &from);
	for (size_t i = 0; i < count; i += PIXELS)
		compare_pixels(work, from + i, count - i < PIXELS ? count - i : PIXELS);
}

/* The greatest colour difference: green to blue. */
static float greatest_difference(const struct gz_flip_colours *colours)
{
	float green[3][PIXELS] = { { 0 }, { 1 }, { 0 } }, blue[3][PIXELS] = { { 0 }, { 0 }, { 1 } };
	float difference;
	gz_hunt_labs_of_linear(colours, 1, (float *const[3]) { green[0], green[1], green[2] });
	gz_hunt_labs_of_linear(colours, 1, (float *const[3]) { blue[0], blue[1], blue[2] });
	colour_differences(green, blue, 1, &difference);
	return difference;
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
	gz_flip_colours_set(&work.colours);
	work.colour_max = greatest_difference(&work.colours);
	work.out = out_map->values;
	make_feature_kernels(&work);
	compare(&work);
	free(work.memory);
	return GZ_OK;
}
