#include "render/cpu/reconstruct.h"

#include <math.h>
#include <string.h>

struct job {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	uint32_t *pixels;
	const struct gz_row_filters *filters;
	int square_columns;
};

enum { ROWS_A_PART = 16 };

static void fill_square(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	gz_reconstruct_square(job->plan, job->lattices, job->filters,
			      (int)part % job->square_columns, (int)part / job->square_columns);
}

static void reconstruct_pyramid(struct job *job, struct gz_workers *workers)
{
	int rows;
	gz_reconstruct_squares(job->plan, &job->square_columns, &rows);
	gz_workers_run(workers, fill_square, job, (size_t)job->square_columns * (size_t)rows);
}

static void fill_row(const struct job *job, int y, int layer, int x0, int x1, uint32_t *out);

/* What one lattice says of some pixels of a row. */
static void fill_from_layer(const struct job *job, int y, int layer, int x0, int x1, uint32_t *out)
{
	const struct gz_lattice *lattice = &job->lattices->layers[layer];
	if (lattice->points != job->pixels) {
		gz_reconstruct_span(lattice, y, x0, x1, out);
		return;
	}
	const uint32_t *cast = job->pixels + (size_t)y * (size_t)job->plan->width + x0;
	if (cast != out)
		memcpy(out, cast, (size_t)(x1 - x0) * sizeof *out);
}

/* Mean of two pixels, the first with `weight` of 256. */
static uint32_t blend(uint32_t a, uint32_t b, uint32_t weight)
{
	const uint32_t channels = 0x00FF00FFU, half = 0x00800080U;
	const uint32_t even = (a & channels) * weight + (b & channels) * (256 - weight) + half;
	const uint32_t odd =
		(a >> 8 & channels) * weight + (b >> 8 & channels) * (256 - weight) + half;
	return (even >> 8 & channels) | (odd & ~channels);
}

/* Pixels where a layer fades into those behind it. */
static void fill_band(const struct job *job, int y, int layer, int x0, int x1, uint32_t *out)
{
	enum { CHUNK = 64 };
	const struct gz_region *region = &job->plan->layers[layer].region;
	for (int x = x0; x < x1; x += CHUNK) {
		const int to = x + CHUNK < x1 ? x + CHUNK : x1;
		uint32_t own[CHUNK], behind[CHUNK];
		/* Both before anything is written: one of them may lie where it goes. */
		fill_row(job, y, layer + 1, x, to, behind);
		fill_from_layer(job, y, layer, x, to, own);
		for (int i = 0; i < to - x; i++) {
			const double weight = gz_region_weight(region, x + i, y);
			out[x - x0 + i] = blend(own[i], behind[i], (uint32_t)(weight * 256 + 0.5));
		}
	}
}

/* The columns of [from, to) that a layer does not share; the region's bands are at both ends. */
static void unshared_columns(const struct gz_region *region, int y, int *from, int *to)
{
	if (region->shape == GZ_REGION_ALL || region->blend_px <= 0)
		return;
	/* Weights rise to the middle and fall again, so halving finds where they reach 1. */
	const int middle = (int)fmin(fmax(round(region->centre_px[0]), *from), *to - 1);
	if (gz_region_weight(region, middle, y) < 1) {
		*from = *to;
		return;
	}
	int outside = *from - 1, inside = middle;
	while (inside - outside > 1) {
		const int x = outside + (inside - outside) / 2;
		*(gz_region_weight(region, x, y) < 1 ? &outside : &inside) = x;
	}
	*from = inside;
	inside = middle;
	outside = *to;
	while (outside - inside > 1) {
		const int x = inside + (outside - inside) / 2;
		*(gz_region_weight(region, x, y) < 1 ? &outside : &inside) = x;
	}
	*to = outside;
}

/* One row from layer to layer: the first takes its columns, the next what is left on both sides,
 * and what the first shares. */
static void fill_row(const struct job *job, int y, int layer, int x0, int x1, uint32_t *out)
{
	if (x0 >= x1 || layer >= job->plan->layer_count)
		return;
	const struct gz_region *region = &job->plan->layers[layer].region;
	int from, to;
	gz_region_columns(&job->plan->layers[layer].region, y, job->plan->width, &from, &to);
	from = from < x0 ? x0 : from;
	to = to > x1 ? x1 : to;
	if (from >= to) {
		fill_row(job, y, layer + 1, x0, x1, out);
		return;
	}
	int core_from = from, core_to = to;
	unshared_columns(region, y, &core_from, &core_to);
	fill_row(job, y, layer + 1, x0, from, out);
	fill_band(job, y, layer, from, core_from, out + (from - x0));
	if (core_from < core_to) {
		fill_from_layer(job, y, layer, core_from, core_to, out + (core_from - x0));
		fill_band(job, y, layer, core_to, to, out + (core_to - x0));
	}
	fill_row(job, y, layer + 1, to, x1, out + (to - x0));
}

static void fill_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < job->plan->height; y++)
		fill_row(job, y, 0, 0, job->plan->width,
			 job->pixels + (size_t)y * (size_t)job->plan->width);
}

void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    struct gz_image *image)
{
	struct job job = {
		.plan = plan,
		.lattices = lattices,
		.filters = filters,
		.pixels = (uint32_t *)(void *)image->pixels,
	};
	switch (plan->reconstruction) {
	case GZ_RECONSTRUCT_DIRECT:
		return;
	case GZ_RECONSTRUCT_PYRAMID:
		reconstruct_pyramid(&job, workers);
		return;
	case GZ_RECONSTRUCT_REGIONS:
		gz_workers_run(workers, fill_rows, &job,
			       ((size_t)plan->height + ROWS_A_PART - 1) / ROWS_A_PART);
		return;
	}
}
