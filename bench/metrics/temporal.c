#include "bench/metrics/temporal.h"

#include <math.h>

/* ---- impulse response ---- */

static const double time_constant_s = 0.00494;
static const double slower = 1.33;
enum { STAGES = 9, SLOWER_STAGES = 10 };

/* Impulse response of a cascade of exponential filters of area 1. */
static double cascade(double t_s, double constant_s, int stages)
{
	const double u = t_s / constant_s;
	return exp((stages - 1) * log(u) - u - lgamma(stages)) / constant_s;
}

/* Amplitude of the response to a sine of amplitude 1. */
static double gain_at(const double weights[GZ_TEMPORAL_FRAMES], double radians_a_frame)
{
	double real = 0, imaginary = 0;
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++) {
		real += weights[i] * cos(i * radians_a_frame);
		imaginary += weights[i] * sin(i * radians_a_frame);
	}
	return hypot(real, imaginary);
}

static double best_gain(const double weights[GZ_TEMPORAL_FRAMES])
{
	enum { FREQUENCIES = 512 }; /* chosen: the peak is missed by less than 1e-4 */
	double best = 0;
	for (int i = 1; i <= FREQUENCIES; i++)
		best = fmax(best, gain_at(weights, i * M_PI / FREQUENCIES));
	return best;
}

void gz_temporal_weights(double fps, double out_weights[GZ_TEMPORAL_FRAMES])
{
	double sum = 0;
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++) {
		/* The middle of the time that the picture is shown. */
		const double t_s = (GZ_TEMPORAL_FRAMES - i - 0.5) / fps;
		out_weights[i] = cascade(t_s, time_constant_s, STAGES) -
				 cascade(t_s, slower * time_constant_s, SLOWER_STAGES);
		sum += out_weights[i];
	}
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++)
		out_weights[i] -= sum / GZ_TEMPORAL_FRAMES;
	const double gain = best_gain(out_weights);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++)
		out_weights[i] /= gain;
}

/* ---- maps ---- */

void gz_map_add_luma(struct gz_map *map, const struct gz_image *image, double weight)
{
	const float red = (float)(0.2126 * weight), green = (float)(0.7152 * weight),
		    blue = (float)(0.0722 * weight);
	const size_t count = (size_t)map->width * (size_t)map->height;
	for (size_t i = 0; i < count; i++) {
		const uint8_t *pixel = image->pixels + 4 * i;
		map->values[i] += red * pixel[0] + green * pixel[1] + blue * pixel[2];
	}
}

double gz_map_weighted_difference(const struct gz_map *a, const struct gz_map *b,
				  const struct gz_map *weights)
{
	const size_t count = (size_t)a->width * (size_t)a->height;
	double sum = 0, weight = 0;
	for (size_t i = 0; i < count; i++) {
		sum += (double)weights->values[i] * fabs((double)a->values[i] - b->values[i]);
		weight += (double)weights->values[i];
	}
	return weight > 0 ? sum / weight : 0;
}
