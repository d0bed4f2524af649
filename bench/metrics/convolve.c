#include "bench/metrics/convolve.h"

#include <stddef.h>
#include <string.h>

#include "render/picture/image.h"

/* Rows one thread takes at a time, columns done at once, which stay in the first cache, and of them
 * those whose sums stay in registers, of any machine's width. */
enum { ROWS_A_PART = 16, COLUMNS = 1024, LANES = 4, GROUP = 8 * LANES };

typedef float lanes __attribute__((vector_size(LANES * 4), aligned(4), may_alias));

struct pass {
	const float *in;
	int width, height;
	const struct gz_kernel *kernel;
	float scale;
	bool add;
	float *out;
};

static int clamp_to_edge(int value, int last)
{
	return value < 0 ? 0 : value > last ? last : value;
}

/* Sums of GROUP neighbours, which stay in registers: memory is asked once a tap. */
static void sum_group(const float *const *taps, const float *weights, int count, int at,
		      float out[GROUP])
{
	lanes sums[GROUP / LANES] = { { 0 } };
	for (int tap = 0; tap < count; tap++) {
		const float *in = taps[tap] + at;
		for (int i = 0; i < GROUP / LANES; i++)
			sums[i] += weights[tap] * *(const lanes *)(in + (ptrdiff_t)i * LANES);
	}
	memcpy(out, sums, sizeof sums);
}

/* Weighted sums of the values at the same offset from each tap. */
static void sum_taps(const float *const *taps, const float *weights, int count, int width, bool add,
		     float *out)
{
	int x = 0;
	for (; x + GROUP <= width; x += GROUP) {
		float group[GROUP];
		sum_group(taps, weights, count, x, group);
		for (int i = 0; i < GROUP; i++)
			out[x + i] = add ? out[x + i] + group[i] : group[i];
	}
	for (; x < width; x++) {
		float sum = 0;
		for (int tap = 0; tap < count; tap++)
			sum += weights[tap] * taps[tap][x];
		out[x] = add ? out[x] + sum : sum;
	}
}

static void filter_row_across(const struct pass *pass, const float *in, float *out)
{
	const int radius = pass->kernel->radius, taps = 2 * radius + 1;
	float padded[COLUMNS + 2 * GZ_KERNEL_RADIUS_MAX];
	const float *from[2 * GZ_KERNEL_RADIUS_MAX + 1];
	for (int tap = 0; tap < taps; tap++)
		from[tap] = padded + tap;
	for (int x = 0; x < pass->width; x += COLUMNS) {
		const int count = pass->width - x < COLUMNS ? pass->width - x : COLUMNS;
		for (int i = 0; i < count + 2 * radius; i++)
			padded[i] = in[clamp_to_edge(x + i - radius, pass->width - 1)];
		sum_taps(from, pass->kernel->weights, taps, count, false, out + x);
	}
}

static void filter_row_down(const struct pass *pass, int y, float *out)
{
	const int radius = pass->kernel->radius, taps = 2 * radius + 1;
	const float *from[2 * GZ_KERNEL_RADIUS_MAX + 1];
	float weights[2 * GZ_KERNEL_RADIUS_MAX + 1];
	for (int tap = 0; tap < taps; tap++) {
		const int row = clamp_to_edge(y + tap - radius, pass->height - 1);
		from[tap] = pass->in + (size_t)row * (size_t)pass->width;
		weights[tap] = pass->kernel->weights[tap] * pass->scale;
	}
	sum_taps(from, weights, taps, pass->width, pass->add, out);
}

static int rows_end(const struct pass *pass, size_t part)
{
	const int end = ((int)part + 1) * ROWS_A_PART;
	return end < pass->height ? end : pass->height;
}

static void across_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct pass *pass = user;
	for (int y = (int)part * ROWS_A_PART; y < rows_end(pass, part); y++) {
		const size_t row = (size_t)y * (size_t)pass->width;
		filter_row_across(pass, pass->in + row, pass->out + row);
	}
}

static void down_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct pass *pass = user;
	for (int y = (int)part * ROWS_A_PART; y < rows_end(pass, part); y++)
		filter_row_down(pass, y, pass->out + (size_t)y * (size_t)pass->width);
}

void gz_convolve(const struct gz_convolution *of, struct gz_workers *workers)
{
	const size_t parts = ((size_t)of->height + ROWS_A_PART - 1) / ROWS_A_PART;
	struct pass pass = { of->in, of->width, of->height, of->across, 1, false, of->scratch };
	gz_workers_run(workers, across_part, &pass, parts);
	pass = (struct pass) { of->scratch, of->width, of->height, of->down,
			       of->scale,   of->add,   of->out };
	gz_workers_run(workers, down_part, &pass, parts);
}
