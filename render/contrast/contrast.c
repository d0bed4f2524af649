#include "render/contrast/contrast.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	TILES_A_PART = 64,
	RIM = 1,
	POINTS = GZ_TILE_EDGE + 1, /* along an axis: the node's, and the first of the next */
	WINDOW = POINTS + 2 * RIM, /* with a neighbour on both sides */
	ROW = 8,                   /* whole vectors */
};

/* Luminances of a node's points and their neighbours. */
struct window {
	float at[WINDOW][ROW];
};

struct measure_job {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	size_t from;
	float *contrasts;
};

/* Chosen: a display's black with the light of a dim room on it. Darker things look alike. */
static const float black = 1.0F / 200;

/* Luminance of a pixel, white = 1: a square stands for the curve of sRGB, from which it differs by
 * less than a sixth of a stop where eyes tell shades apart. */
static float luminance(uint32_t pixel)
{
	const float red = (float)(pixel & 255), green = (float)(pixel >> 8 & 255);
	const float blue = (float)(pixel >> 16 & 255);
	const float value = 0.2126F * red + 0.7152F * green + 0.0722F * blue;
	return black + value * value * (1.0F / (255 * 255));
}

/* The level whose lattice has its points cast at a point of a finer or equal level. */
static int level_at(const struct gz_lattices *lattices, int level, int column, int row)
{
	const int block = gz_lattices_block(lattices, (column << level) / GZ_BLOCK_EDGE,
					    (row << level) / GZ_BLOCK_EDGE);
	return (block + 1) / 2; /* a pair of quincunx tiles fills the next coarser lattice */
}

static float luminance_of(const struct gz_lattice *lattice, int column, int row)
{
	return luminance(lattice->points[(size_t)row * lattice->stride + (size_t)column]);
}

/* Luminance at a point of a level. Outside the lattice that of its rim; in a coarser tile, whose
 * corners may be those of still coarser ones, between its points. */
static float luminance_at(const struct gz_lattices *lattices, int level, int column, int row)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	column = column < 0 ? 0 : column < lattice->columns ? column : lattice->columns - 1;
	row = row < 0 ? 0 : row < lattice->rows ? row : lattice->rows - 1;
	const int cast = level_at(lattices, level, column, row), shift = cast - level;
	if (shift <= 0)
		return luminance_of(lattice, column, row);
	const int x = column >> shift, y = row >> shift;
	const float u = (float)(column - (x << shift)) / (float)(1 << shift);
	const float v = (float)(row - (y << shift)) / (float)(1 << shift);
	const float above = luminance_at(lattices, cast, x, y) * (1 - u) +
			    luminance_at(lattices, cast, x + 1, y) * u;
	const float below = luminance_at(lattices, cast, x, y + 1) * (1 - u) +
			    luminance_at(lattices, cast, x + 1, y + 1) * u;
	return above * (1 - v) + below * v;
}

/* Whether the window lies within the lattice and in tiles that are no coarser. */
static bool is_plain(const struct gz_lattices *lattices, int level, int column, int row)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	const int right = column + WINDOW - 1, bottom = row + WINDOW - 1;
	if (column < 0 || row < 0 || right >= lattice->columns || bottom >= lattice->rows)
		return false;
	/* Nodes are as wide as the window's middle, or finer. */
	const int middle = column + RIM + 1, centre = row + RIM + 1;
	return level_at(lattices, level, column, row) <= level &&
	       level_at(lattices, level, middle, row) <= level &&
	       level_at(lattices, level, right, row) <= level &&
	       level_at(lattices, level, column, centre) <= level &&
	       level_at(lattices, level, right, centre) <= level &&
	       level_at(lattices, level, column, bottom) <= level &&
	       level_at(lattices, level, middle, bottom) <= level &&
	       level_at(lattices, level, right, bottom) <= level;
}

static void fill_window(const struct gz_lattices *lattices, int level, int column, int row,
			struct window *window)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	const bool plain = is_plain(lattices, level, column, row);
	for (int y = 0; y < WINDOW; y++) {
		const uint32_t *points = lattice->points +
					 (ptrdiff_t)(row + y) * (ptrdiff_t)lattice->stride + column;
		for (int x = 0; x < WINDOW; x++)
			window->at[y][x] =
				plain ? luminance(points[x])
				      : luminance_at(lattices, level, column + x, row + y);
	}
}

/* Contrast of a point with the mean of two neighbours on opposite sides. */
static float contrast_between(float one, float point, float other)
{
	return fabsf(one + other - 2 * point) / (one + other + 2 * point);
}

static float window_contrast(const struct window *window)
{
	float most[ROW] = { 0 };
	for (int y = RIM; y < RIM + POINTS; y++)
		for (int x = RIM; x < RIM + POINTS; x++) {
			const float *at = &window->at[y][x];
			const float along_x = contrast_between(at[-1], at[0], at[1]);
			const float along_y = contrast_between(at[-ROW], at[0], at[ROW]);
			const float both = along_x > along_y ? along_x : along_y;
			most[x] = both > most[x] ? both : most[x];
		}
	float contrast = 0;
	for (int x = RIM; x < RIM + POINTS; x++)
		contrast = most[x] > contrast ? most[x] : contrast;
	return contrast;
}

/* The points that quincunx tiles add lie in the middle of four of the node's. */
static float quincunx_contrast(const struct measure_job *job, const struct gz_tile *tile,
			       const struct window *window)
{
	const struct gz_lattice *lattice = &job->lattices->layers[tile->layer];
	const int column = tile->x / lattice->spacing, row = tile->y / lattice->spacing;
	float contrast = 0;
	for (int y = 0; y < GZ_TILE_EDGE; y++)
		for (int x = 0; x < GZ_TILE_EDGE; x++) {
			const float *at = &window->at[RIM + y][RIM + x];
			const int at_x = column + 2 * x + 1, at_y = row + 2 * y + 1;
			if (at_x >= lattice->columns || at_y >= lattice->rows)
				continue;
			const float middle = luminance_of(lattice, at_x, at_y);
			const float down = contrast_between(at[0], middle, at[ROW + 1]);
			const float up = contrast_between(at[1], middle, at[ROW]);
			contrast = fmaxf(contrast, fmaxf(down, up));
		}
	return contrast;
}

static float tile_contrast(const struct measure_job *job, const struct gz_tile *tile)
{
	int level;
	struct window window;
	if (!gz_plan_node_of(tile, &level) || tile->layer == 0)
		return 0;
	fill_window(job->lattices, level, (tile->x >> level) - RIM, (tile->y >> level) - RIM,
		    &window);
	const float contrast = window_contrast(&window);
	return tile->pattern == GZ_TILE_QUINCUNX
		       ? fmaxf(contrast, quincunx_contrast(job, tile, &window))
		       : contrast;
}

static void measure_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct measure_job *job = user;
	const size_t first = job->from + part * TILES_A_PART;
	for (size_t i = first; i < first + TILES_A_PART && i < job->plan->tile_count; i++)
		job->contrasts[i - job->from] = tile_contrast(job, &job->plan->tiles[i]);
}

enum gz_result gz_contrasts_measure(const struct gz_plan *plan, size_t from,
				    const struct gz_lattices *lattices, struct gz_workers *workers,
				    struct gz_contrasts *out_contrasts)
{
	const size_t count = plan->tile_count - from;
	if (count > out_contrasts->capacity) {
		float *grown = realloc(out_contrasts->of, count * sizeof *grown);
		if (!grown)
			return GZ_ERR_NO_MEM;
		out_contrasts->of = grown;
		out_contrasts->capacity = count;
	}
	struct measure_job job = {
		.plan = plan,
		.lattices = lattices,
		.from = from,
		.contrasts = out_contrasts->of,
	};
	gz_workers_run(workers, measure_part, &job, (count + TILES_A_PART - 1) / TILES_A_PART);
	return GZ_OK;
}

void gz_contrasts_free(struct gz_contrasts *contrasts)
{
	free(contrasts->of);
	*contrasts = (struct gz_contrasts) { 0 };
}
