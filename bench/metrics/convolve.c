#include "bench/metrics/convolve.h"

#include <string.h>

#include "render/image.h"

/* Rows one thread takes at a time, and columns done at once: they stay in the first cache. */
enum { ROWS_A_PART = 16, COLUMNS = 1024 };

struct pass {
	const float *in;
	int width, height;
	const struct gz_kernel *kernel;
	float scale;
	bool add;
	float *out;
};

static int clamp(int value, int last)
{
	return value < 0 ? 0 : value > last ? last : value;
}

static void filter_row_across(const struct pass *pass, const float *in, float *out)
{
	const int radius = pass->kernel->radius;
	float padded[COLUMNS + 2 * GZ_KERNEL_RADIUS_MAX] = { 0 };
	for (int from = 0; from < pass->width; from += COLUMNS) {
		const int count = pass->width - from < COLUMNS ? pass->width - from : COLUMNS;
		for (int i = 0; i < count + 2 * radius; i++)
			padded[i] = in[clamp(from + i - radius, pass->width - 1)];
		memset(out + from, 0, (size_t)count * sizeof *out);
		for (int tap = 0; tap <= 2 * radius; tap++) {
			const float weight = pass->kernel->weights[tap];
			for (int i = 0; i < count; i++)
				out[from + i] += weight * padded[i + tap];
		}
	}
}

static void filter_row_down(const struct pass *pass, int y, float *out)
{
	const int radius = pass->kernel->radius;
	float sum[COLUMNS];
	for (int from = 0; from < pass->width; from += COLUMNS) {
		const int count = pass->width - from < COLUMNS ? pass->width - from : COLUMNS;
		memset(sum, 0, sizeof sum);
		for (int tap = 0; tap <= 2 * radius; tap++) {
			const float weight = pass->kernel->weights[tap] * pass->scale;
			const int row = clamp(y + tap - radius, pass->height - 1);
			const float *in = pass->in + (size_t)row * (size_t)pass->width + from;
			for (int i = 0; i < count; i++)
				sum[i] += weight * in[i];
		}
		for (int i = 0; i < count; i++)
			out[from + i] = pass->add ? out[from + i] + sum[i] : sum[i];
	}
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

void gz_convolve(const float *in, int width, int height, const struct gz_kernel *across,
		 const struct gz_kernel *down, float scale, bool add, struct gz_workers *workers,
		 float *scratch, float *out)
{
	const size_t parts = ((size_t)height + ROWS_A_PART - 1) / ROWS_A_PART;
	struct pass pass = { in, width, height, across, 1, false, scratch };
	gz_workers_run(workers, across_part, &pass, parts);
	pass = (struct pass) { scratch, width, height, down, scale, add, out };
	gz_workers_run(workers, down_part, &pass, parts);
}
