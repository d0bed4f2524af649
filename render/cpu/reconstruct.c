#include "render/cpu/reconstruct.h"

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

/* One row from layer to layer: the first takes its columns, the next what is left on both sides. */
static void fill_row(const struct job *job, int y, int layer, int x0, int x1)
{
	if (x0 >= x1 || layer >= job->plan->layer_count)
		return;
	int from, to;
	gz_region_columns(&job->plan->layers[layer].region, y, job->plan->width, &from, &to);
	from = from < x0 ? x0 : from;
	to = to > x1 ? x1 : to;
	if (from >= to) {
		fill_row(job, y, layer + 1, x0, x1);
		return;
	}
	const struct gz_lattice *lattice = &job->lattices->layers[layer];
	if (lattice->points != job->pixels)
		gz_reconstruct_span(lattice, y, from, to,
				    job->pixels + (size_t)y * (size_t)job->plan->width);
	fill_row(job, y, layer + 1, x0, from);
	fill_row(job, y, layer + 1, to, x1);
}

static void fill_rows(void *user, size_t part, int worker)
{
	(void)worker;
	const struct job *job = user;
	const int from = (int)part * ROWS_A_PART;
	for (int y = from; y < from + ROWS_A_PART && y < job->plan->height; y++)
		fill_row(job, y, 0, 0, job->plan->width);
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
