/*
 * LDR-FLIP (Andersson et al. 2020): colours as the eye blurs them, compared, and sharpened by where
 * edges and points differ.
 */
#include <math.h>
#include <stdlib.h>

#include "bench/metrics/approximate.h"
#include "bench/metrics/convolve.h"
#include "bench/metrics/metrics.h"

/* The paper's constants: exponent, share and value of the knee of the colour difference (4.1),
 * width of the feature filters in degrees (4.2). */
#define COLOUR_EXPONENT 0.7F
#define KNEE_SHARE      0.4F
#define KNEE_VALUE      0.95F
#define FEATURE_DEG     0.082

/* ---- colour spaces (4.1), many pixels at a time ---- */

/* Matrices and tables between colour spaces; white is D65. */
struct flip_colours {
	float linear_of_srgb[256]; /* IEC 61966-2-1 */
	float opponent[3][3]; /* linear RGB to opponent colours, but for the -16 of the first */
	float linear[3][4];   /* back, from opponent colours and 1 */
	float share[3][3];    /* linear RGB to shares of white's X, Y and Z */
};

/* sRGB to XYZ, from the primaries and white of ITU-R BT.709, as exact fractions. */
static const double xyz_of_rgb[3][3] = {
	{ 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794 },
	{ 2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897 },
	{ 1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382 },
};

/* Its inverse. */
static const double rgb_of_xyz[3][3] = {
	{ 3.241003275, -1.537398934, -0.498615861 },
	{ -0.969224334, 1.875930071, 0.041554224 },
	{ 0.055639423, -0.204011202, 1.057148933 },
};

static void multiply(const double matrix[3][3], const double in[3], double out[3])
{
	for (int row = 0; row < 3; row++)
		out[row] = matrix[row][0] * in[0] + matrix[row][1] * in[1] + matrix[row][2] * in[2];
}

static float linear_of_srgb(int channel)
{
	const double c = channel / 255.0;
	return (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
}

/* The matrix from linear RGB to X, Y and Z relative to white. */
static void shares_of_rgb(double out[3][3])
{
	static const double white[3] = { 1, 1, 1 };
	double of_white[3];
	multiply(xyz_of_rgb, white, of_white);
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++)
			out[row][column] = xyz_of_rgb[row][column] / of_white[row];
}

static void set_opponents(const double shares[3][3], struct flip_colours *colours)
{
	for (int i = 0; i < 3; i++) {
		colours->opponent[0][i] = (float)(116 * shares[1][i]);
		colours->opponent[1][i] = (float)(500 * (shares[0][i] - shares[1][i]));
		colours->opponent[2][i] = (float)(200 * (shares[1][i] - shares[2][i]));
	}
}

/* The way back, from each opponent colour and, last, from 1. */
static void set_linear(struct flip_colours *colours)
{
	static const double white[3] = { 1, 1, 1 };
	static const double shares[4][3] = {
		{ 1.0 / 116, 1.0 / 116, 1.0 / 116 },
		{ 1.0 / 500, 0, 0 },
		{ 0, 0, -1.0 / 200 },
		{ 16.0 / 116, 16.0 / 116, 16.0 / 116 },
	};
	double of_white[3];
	multiply(xyz_of_rgb, white, of_white);
	for (int i = 0; i < 4; i++) {
		double xyz[3], rgb[3];
		for (int k = 0; k < 3; k++)
			xyz[k] = shares[i][k] * of_white[k];
		multiply(rgb_of_xyz, xyz, rgb);
		for (int k = 0; k < 3; k++)
			colours->linear[k][i] = (float)rgb[k];
	}
}

static void set_flip_colours(struct flip_colours *colours)
{
	double shares[3][3];
	shares_of_rgb(shares);
	set_opponents(shares, colours);
	set_linear(colours);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			colours->share[i][k] = (float)shares[i][k];
	for (int i = 0; i < 256; i++)
		colours->linear_of_srgb[i] = linear_of_srgb(i);
}

/* Pixels of RGBA, 8 bits sRGB, to opponent colours (YCxCz, linearised CIELAB): a plane each. */
static void opponents_of_srgb(const struct flip_colours *colours, const uint8_t *pixels,
			      size_t count, float *const out_opponents[3])
{
	const float *linear = colours->linear_of_srgb;
	for (size_t i = 0; i < count; i++, pixels += 4) {
		const float r = linear[pixels[0]], g = linear[pixels[1]], b = linear[pixels[2]];
		for (int k = 0; k < 3; k++) {
			const float *row = colours->opponent[k];
			const float sum = row[0] * r + row[1] * g + row[2] * b;
			out_opponents[k][i] = k == 0 ? sum - 16 : sum;
		}
	}
}

static inline float unit(float value)
{
	const float above = value > 0 ? value : 0;
	return above < 1 ? above : 1;
}

static inline float lab_root(float share)
{
	const float delta = 6.0F / 29, cube = delta * delta * delta;
	/* The maximum with the bound keeps it a normal number. */
	const float root = gz_cube_root(share > cube ? share : cube);
	const float line = share * (1 / (3 * delta * delta)) + 4.0F / 29;
	return share > cube ? root : line;
}

/* Linear RGB, in place, to CIELAB with both chroma axes scaled by .01 of the lightness (Hunt's
 * effect). */
static void hunt_labs_of_linear(const struct flip_colours *colours, size_t count,
				float *const rgb[3])
{
	const float(*share)[3] = colours->share;
	float *restrict red = rgb[0], *restrict green = rgb[1], *restrict blue = rgb[2];
	for (size_t i = 0; i < count; i++) {
		const float r = red[i], g = green[i], b = blue[i];
		const float x = lab_root(share[0][0] * r + share[0][1] * g + share[0][2] * b);
		const float y = lab_root(share[1][0] * r + share[1][1] * g + share[1][2] * b);
		const float z = lab_root(share[2][0] * r + share[2][1] * g + share[2][2] * b);
		const float lightness = 116 * y - 16;
		red[i] = lightness;
		green[i] = 0.01F * lightness * 500 * (x - y);
		blue[i] = 0.01F * lightness * 200 * (y - z);
	}
}

/* Opponent colours to linear RGB within [0, 1]. out_rgb are other planes. */
static void linear_of_opponents(const struct flip_colours *colours, const float *const opponents[3],
				size_t count, float *const out_rgb[3])
{
	const float *restrict a = opponents[0], *restrict b = opponents[1],
			      *restrict c = opponents[2];
	for (int k = 0; k < 3; k++) {
		const float *row = colours->linear[k];
		float *restrict out = out_rgb[k];
		for (size_t i = 0; i < count; i++)
			out[i] = unit(row[0] * a[i] + row[1] * b[i] + row[2] * c[i] + row[3]);
	}
}

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

/* Planes of one picture: opponent colours, blurred ones, and the derivatives of its features. */
enum plane { OPPONENT, BLURRED = 3, EDGE_X = 6, EDGE_Y, POINT_X, POINT_Y, PLANES };

struct work {
	int width, height;
	double px_per_deg;
	struct gz_workers *workers;
	float *memory; /* both pictures' planes and a scratch plane */
	float colour_max;
	struct gz_kernel gaussian, edge, point;
	const struct gz_image *pictures[2];
	struct flip_colours colours;
	float *out;
};

static float *flip_plane(const struct work *work, int picture, int plane)
{
	const size_t count = (size_t)work->width * (size_t)work->height;
	return work->memory + (size_t)(picture * PLANES + plane) * count;
}

static float *scratch_of(const struct work *work)
{
	return flip_plane(work, 2, 0);
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
			gz_convolve(
				&(struct gz_convolution) {
					.in = flip_plane(work, picture, OPPONENT + channel),
					.out = flip_plane(work, picture, BLURRED + channel),
					.scratch = scratch_of(work),
					.width = work->width,
					.height = work->height,
					.across = &kernels[i],
					.down = &kernels[i],
					.scale = (float)(scale[i] / total),
					.add = i > 0,
				},
				work->workers);
}

/* Positive and negative weights each add up to 1. */
static void balance_kernel(struct gz_kernel *kernel)
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
	balance_kernel(&work->edge);
	balance_kernel(&work->point);
}

static void feature(const struct work *work, int picture, const struct gz_kernel *across,
		    const struct gz_kernel *down, enum plane out)
{
	/* Lightness as [0, 1]; the balanced kernels ignore a constant offset. */
	gz_convolve(
		&(struct gz_convolution) {
			.in = flip_plane(work, picture, OPPONENT),
			.out = flip_plane(work, picture, (int)out),
			.scratch = scratch_of(work),
			.width = work->width,
			.height = work->height,
			.across = across,
			.down = down,
			.scale = 1.0F / 116,
		},
		work->workers);
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
			planes[channel] = flip_plane(work, picture, OPPONENT + channel) + from;
		opponents_of_srgb(&work->colours, work->pictures[picture]->pixels + 4 * from, count,
				  planes);
	}
}

/* A run of pixels as a picture's blurred colours look. */
static void see(const struct work *work, int picture, size_t from, size_t count,
		float lab[3][PIXELS])
{
	const float *blurred[3];
	float *const planes[3] = { lab[0], lab[1], lab[2] };
	for (int channel = 0; channel < 3; channel++)
		blurred[channel] = flip_plane(work, picture, BLURRED + channel) + from;
	linear_of_opponents(&work->colours, blurred, count, planes);
	hunt_labs_of_linear(&work->colours, count, planes);
}

static inline float squared(float value)
{
	return value * value;
}

/* HyAB (Abasi et al. 2020) to the paper's exponent. */
static void colour_differences(float a[3][PIXELS], float b[3][PIXELS], size_t count, float *out)
{
	for (size_t i = 0; i < count; i++) {
		const float hyab = fabsf(a[0][i] - b[0][i]) +
				   sqrtf(squared(a[1][i] - b[1][i]) + squared(a[2][i] - b[2][i]));
		out[i] = gz_power(hyab, COLOUR_EXPONENT);
	}
}

/* Differences below the knee take most of the range. */
static inline float bend(float difference, float most)
{
	const float knee = KNEE_SHARE * most;
	const float low = KNEE_VALUE / knee * difference;
	const float high = KNEE_VALUE + (difference - knee) * ((1 - KNEE_VALUE) / (most - knee));
	return difference < knee ? low : high;
}

/* Difference of the strengths of a pair of features. */
static void feature_differences(const struct work *work, enum plane x, size_t from, size_t count,
				float *out)
{
	const float *restrict ax = flip_plane(work, 0, (int)x) + from;
	const float *restrict ay = flip_plane(work, 0, (int)x + 1) + from;
	const float *restrict bx = flip_plane(work, 1, (int)x) + from;
	const float *restrict by = flip_plane(work, 1, (int)x + 1) + from;
	for (size_t i = 0; i < count; i++)
		out[i] = fabsf(sqrtf(squared(ax[i]) + squared(ay[i])) -
			       sqrtf(squared(bx[i]) + squared(by[i])));
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
static float greatest_difference(const struct flip_colours *colours)
{
	float green[3][PIXELS] = { { 0 }, { 1 }, { 0 } }, blue[3][PIXELS] = { { 0 }, { 0 }, { 1 } };
	float difference;
	hunt_labs_of_linear(colours, 1, (float *const[3]) { green[0], green[1], green[2] });
	hunt_labs_of_linear(colours, 1, (float *const[3]) { blue[0], blue[1], blue[2] });
	colour_differences(green, blue, 1, &difference);
	return difference;
}

static void compare_by_flip(struct work *work)
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
	set_flip_colours(&work.colours);
	work.colour_max = greatest_difference(&work.colours);
	work.out = out_map->values;
	make_feature_kernels(&work);
	compare_by_flip(&work);
	free(work.memory);
	return GZ_OK;
}
