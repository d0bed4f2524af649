#include "render/cpu/reconstruct.h"

#include <math.h>
#include <string.h>

struct job {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	uint32_t *pixels;
	int level; /* pyramid: the lattice being filled */
};

enum {
	TILES_A_PART = 64, /* chosen: some tens of microseconds of work */
	ROWS_A_PART = 16,
};

/* What a pass over the tiles does with each. */
typedef void tile_pass(const struct job *job, const struct gz_tile *tile);

static void fill_from_coarser(const struct job *job, const struct gz_tile *tile)
{
	const struct gz_lattice *fine = &job->lattices->layers[job->level];
	if (tile->layer <= job->level)
		return;
	const int edge = GZ_TILE_EDGE << (tile->layer - job->level);
	const int x = tile->x / fine->spacing, y = tile->y / fine->spacing;
	gz_reconstruct_block(fine + 1, fine, x, y, edge);
	if (tile->pattern == GZ_TILE_QUINCUNX) /* twice as wide as high */
		gz_reconstruct_block(fine + 1, fine, x + edge, y, edge);
}

static void fill_quincunx(const struct job *job, const struct gz_tile *tile)
{
	const struct gz_lattice *lattice = &job->lattices->layers[job->level];
	if (tile->layer == job->level && tile->pattern == GZ_TILE_QUINCUNX)
		gz_reconstruct_quincunx(lattice, tile->x / lattice->spacing,
					tile->y / lattice->spacing, 2 * GZ_TILE_EDGE, GZ_TILE_EDGE);
}

static void pass_over_tiles(const struct job *job, size_t part, tile_pass *pass)
{
	const size_t from = part * TILES_A_PART;
	const size_t to = from + TILES_A_PART < job->plan->tile_count ? from + TILES_A_PART
								      : job->plan->tile_count;
	for (size_t i = from; i < to; i++)
		pass(job, &job->plan->tiles[i]);
}

static void fill_from_coarser_part(void *user, size_t part, int worker)
{
	(void)worker;
	pass_over_tiles(user, part, fill_from_coarser);
}

static void fill_quincunx_part(void *user, size_t part, int worker)
{
	(void)worker;
	pass_over_tiles(user, part, fill_quincunx);
}

/* From the coarsest lattice down: first what is coarser than this one, then what is half of it. */
static void reconstruct_pyramid(struct job *job, struct gz_workers *workers)
{
	const size_t parts = (job->plan->tile_count + TILES_A_PART - 1) / TILES_A_PART;
	for (job->level = job->plan->layer_count - 1; job->level >= 0; job->level--) {
		if (job->level + 1 < job->plan->layer_count)
			gz_workers_run(workers, fill_from_coarser_part, job, parts);
		gz_workers_run(workers, fill_quincunx_part, job, parts);
	}
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
		    struct gz_workers *workers, struct gz_image *image)
{
	struct job job = {
		.plan = plan,
		.lattices = lattices,
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
