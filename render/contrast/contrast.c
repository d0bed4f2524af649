#include "render/contrast/contrast.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"

enum {
	TILES_A_PART = 64,
	RIM = 1,
	POINTS = GZ_TILE_EDGE + 1, /* along an axis: the node's, and the first of the next */
	WINDOW = POINTS + 2 * RIM, /* with a neighbour on both sides */
	ROW = 8,                   /* whole vectors */
};

/* The channels in which eyes see contrast. */
enum { LUMINANCE, RED_GREEN, BLUE_YELLOW, CHANNELS };

/* A colour in these channels. */
struct opponent {
	float of[CHANNELS];
};

/* Channels of a node's points and their neighbours. */
struct window {
	float at[CHANNELS][WINDOW][ROW];
};

struct measure_job {
	const struct gz_plan *plan;
	const struct gz_lattices *lattices;
	size_t from;
	int channels; /* that are compared */
	float least;  /* contrasts below may be taken for 0 */
	struct gz_node_contrast *contrasts;
};

/* Chosen: a display's black with the light of a dim room on it. Darker things look alike. */
static const float black = 1.0F / 200;

/*
 * A colour of sRGB, white = 1, in channels. A square stands for the curve of sRGB, from which it
 * differs by less than a sixth of a stop where eyes tell shades apart.
 *
 * With the cones' shares of white l, m and s (Smith and Pokorny's, by the primaries of sRGB):
 * luminance, 3 (l - m), and (s - (l + m) / 2) / 10. The factors are chosen: cones tell a difference
 * between l and m of a third of what they need to see a luminance (Chaparro et al., "Colour is what
 * the eye sees best", 1993, has a fifth to a ninth, of larger spots), and s alone is seen least.
 */
static inline struct opponent opponent_of(uint32_t pixel)
{
	const float red = (float)(pixel & 255) * (1.0F / 255);
	const float green = (float)(pixel >> 8 & 255) * (1.0F / 255);
	const float blue = (float)(pixel >> 16 & 255) * (1.0F / 255);
	const float r = red * red, g = green * green, b = blue * blue;
	return (struct opponent) { {
		[LUMINANCE] = black + 0.2126F * r + 0.7152F * g + 0.0722F * b,
		[RED_GREEN] = 0.476F * r - 0.355F * g - 0.121F * b,
		[BLUE_YELLOW] = 0.0806F * b - 0.0589F * g - 0.0217F * r,
	} };
}

/* The level whose lattice has its points cast at a point of a finer or equal level. */
static int level_at(const struct gz_lattices *lattices, int level, int column, int row)
{
	const int block = gz_lattices_block(lattices, (column << level) / GZ_BLOCK_EDGE,
					    (row << level) / GZ_BLOCK_EDGE);
	return (block + 1) / 2; /* a pair of quincunx tiles fills the next coarser lattice */
}

static struct opponent colour_of(const struct gz_lattice *lattice, int column, int row)
{
	return opponent_of(lattice->points[(size_t)row * lattice->stride + (size_t)column]);
}

static struct opponent mixed(struct opponent a, struct opponent b, float share)
{
	for (int i = 0; i < CHANNELS; i++)
		a.of[i] = a.of[i] * (1 - share) + b.of[i] * share;
	return a;
}

/* Colour at a point of a level. Outside the lattice that of its rim; in a coarser tile, whose
 * corners may be those of still coarser ones, between its points. */
static struct opponent colour_at(const struct gz_lattices *lattices, int level, int column, int row)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	column = column < 0 ? 0 : column < lattice->columns ? column : lattice->columns - 1;
	row = row < 0 ? 0 : row < lattice->rows ? row : lattice->rows - 1;
	const int cast = level_at(lattices, level, column, row), shift = cast - level;
	if (shift <= 0)
		return colour_of(lattice, column, row);
	const int x = column >> shift, y = row >> shift;
	const float u = (float)(column - (x << shift)) / (float)(1 << shift);
	const float v = (float)(row - (y << shift)) / (float)(1 << shift);
	const struct opponent above =
		mixed(colour_at(lattices, cast, x, y), colour_at(lattices, cast, x + 1, y), u);
	const struct opponent below = mixed(colour_at(lattices, cast, x, y + 1),
					    colour_at(lattices, cast, x + 1, y + 1), u);
	return mixed(above, below, v);
}

/* Whether the window lies within the lattice and in tiles that are no coarser. */
static bool is_plain(const struct gz_lattices *lattices, int level, int column, int row)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	const int right = column + ROW - 1, bottom = row + WINDOW - 1;
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

/* Whole rows, so that loops become vectors; the last column is a neighbour's neighbour. */
static inline void fill_plain(const uint32_t *points, size_t stride, int channels,
			      struct window *window)
{
	for (int y = 0; y < WINDOW; y++, points += stride)
		for (int x = 0; x < ROW; x++) {
			const struct opponent colour = opponent_of(points[x]);
			for (int i = 0; i < channels; i++)
				window->at[i][y][x] = colour.of[i];
		}
}

static inline void fill_window(const struct gz_lattices *lattices, int level, int column, int row,
			       int channels, struct window *window)
{
	const struct gz_lattice *lattice = &lattices->layers[level];
	if (is_plain(lattices, level, column, row)) {
		fill_plain(lattice->points + (size_t)row * lattice->stride + (size_t)column,
			   lattice->stride, channels, window);
		return;
	}
	for (int y = 0; y < WINDOW; y++)
		for (int x = 0; x < ROW; x++) {
			const struct opponent colour =
				colour_at(lattices, level, column + x, row + y);
			for (int i = 0; i < channels; i++)
				window->at[i][y][x] = colour.of[i];
		}
}

static inline float greater(float a, float b)
{
	return a > b ? a : b;
}

/* Contrast of a point with the mean of two neighbours on opposite sides. */
static inline float contrast_between(float one, float point, float other, float sum)
{
	return fabsf(one + other - 2 * point) / sum;
}

/* Contrast of each of a node's points along x or along y, whichever is greater. */
static void channel_contrasts(const struct window *window, int channel,
			      float out_contrasts[POINTS][ROW])
{
	for (int y = 0; y < POINTS; y++)
		for (int x = 0; x < POINTS; x++) {
			const float *at = &window->at[channel][RIM + y][RIM + x];
			const float *light = &window->at[LUMINANCE][RIM + y][RIM + x];
			const float along_x = contrast_between(at[-1], at[0], at[1],
							       light[-1] + light[1] + 2 * light[0]);
			const float along_y = contrast_between(
				at[-ROW], at[0], at[ROW], light[-ROW] + light[ROW] + 2 * light[0]);
			out_contrasts[y][x] = along_x > along_y ? along_x : along_y;
		}
}

/* Raise the contrasts of a node's cells to those of their corners. */
static void raise_cells(float cells[GZ_NODE_CELLS][GZ_NODE_CELLS],
			const float contrasts[POINTS][ROW])
{
	for (int y = 0; y < GZ_NODE_CELLS; y++)
		for (int x = 0; x < GZ_NODE_CELLS; x++) {
			const float *at = &contrasts[y][x];
			const float above = greater(at[0], at[1]);
			const float below = greater(at[ROW], at[ROW + 1]);
			cells[y][x] = greater(cells[y][x], greater(above, below));
		}
}

/* Whether no contrast of luminance in the window can reach @p least: none is greater than that of
 * the brightest point with the darkest. */
static bool is_even(const struct window *window, float least)
{
	float low[ROW], high[ROW];
	memcpy(low, window->at[LUMINANCE][0], sizeof low);
	memcpy(high, low, sizeof high);
	for (int y = 1; y < WINDOW; y++)
		for (int x = 0; x < ROW; x++) {
			const float light = window->at[LUMINANCE][y][x];
			low[x] = light < low[x] ? light : low[x];
			high[x] = light > high[x] ? light : high[x];
		}
	float darkest = low[0], brightest = high[0];
	for (int x = 1; x < ROW; x++) {
		darkest = low[x] < darkest ? low[x] : darkest;
		brightest = greater(brightest, high[x]);
	}
	return brightest - darkest < least * (brightest + darkest);
}

static void measure_window(const struct window *window, int channels, float least,
			   struct gz_node_contrast *out_contrast)
{
	float contrasts[POINTS][ROW];
	*out_contrast = (struct gz_node_contrast) { 0 };
	if (channels == 1 && is_even(window, least))
		return;
	channel_contrasts(window, LUMINANCE, contrasts);
	raise_cells(out_contrast->luminance, contrasts);
	for (int i = LUMINANCE + 1; i < channels; i++) {
		channel_contrasts(window, i, contrasts);
		raise_cells(out_contrast->colour, contrasts);
	}
}

/* Contrast of a point in the middle of four, (x, y) being the first of these, along a diagonal. */
static float diagonal_contrast(const struct window *window, int channel, int x, int y,
			       const struct opponent *middle)
{
	const float *at = &window->at[channel][RIM + y][RIM + x];
	const float *light = &window->at[LUMINANCE][RIM + y][RIM + x];
	const float twice = 2 * middle->of[LUMINANCE];
	return greater(contrast_between(at[0], middle->of[channel], at[ROW + 1],
					light[0] + light[ROW + 1] + twice),
		       contrast_between(at[1], middle->of[channel], at[ROW],
					light[1] + light[ROW] + twice));
}

/* The points that quincunx tiles add lie in the middle of the node's cells. */
static void add_quincunx(const struct measure_job *job, const struct gz_tile *tile,
			 const struct window *window, int channels,
			 struct gz_node_contrast *contrast)
{
	const struct gz_lattice *lattice = &job->lattices->layers[tile->layer];
	const int column = tile->x / lattice->spacing, row = tile->y / lattice->spacing;
	for (int y = 0; y < GZ_NODE_CELLS; y++)
		for (int x = 0; x < GZ_NODE_CELLS; x++) {
			const int at_x = column + 2 * x + 1, at_y = row + 2 * y + 1;
			if (at_x >= lattice->columns || at_y >= lattice->rows)
				continue;
			const struct opponent middle = colour_of(lattice, at_x, at_y);
			float *luminance = &contrast->luminance[y][x];
			float *colour = &contrast->colour[y][x];
			*luminance = greater(*luminance,
					     diagonal_contrast(window, LUMINANCE, x, y, &middle));
			for (int i = LUMINANCE + 1; i < channels; i++)
				*colour = greater(*colour,
						  diagonal_contrast(window, i, x, y, &middle));
		}
}

/* Always inline, so that nothing is computed of channels that are not compared. */
static inline __attribute__((always_inline)) void measure_channels(const struct measure_job *job,
								   const struct gz_tile *tile,
								   int level, int channels,
								   struct gz_node_contrast *out)
{
	struct window window;
	fill_window(job->lattices, level, (tile->x >> level) - RIM, (tile->y >> level) - RIM,
		    channels, &window);
	measure_window(&window, channels, job->least, out);
	if (tile->pattern == GZ_TILE_QUINCUNX)
		add_quincunx(job, tile, &window, channels, out);
}

static void measure_tile(const struct measure_job *job, const struct gz_tile *tile,
			 struct gz_node_contrast *out_contrast)
{
	int level;
	if (!gz_plan_node_of(tile, &level) || tile->layer == 0)
		return;
	if (job->channels == 1)
		measure_channels(job, tile, level, 1, out_contrast);
	else
		measure_channels(job, tile, level, CHANNELS, out_contrast);
}

static void measure_part(void *user, size_t part, int worker)
{
	(void)worker;
	const struct measure_job *job = user;
	const size_t first = job->from + part * TILES_A_PART;
	for (size_t i = first; i < first + TILES_A_PART && i < job->plan->tile_count; i++)
		measure_tile(job, &job->plan->tiles[i], &job->contrasts[i - job->from]);
}

enum gz_result gz_contrasts_measure(const struct gz_plan *plan, size_t from,
				    const struct gz_lattices *lattices, struct gz_workers *workers,
				    struct gz_contrasts *out_contrasts)
{
	const size_t count = plan->tile_count - from;
	const struct gz_foveation *foveation = &plan->made_for.foveation;
	const bool edges = gz_method_of(foveation)->refines_edges;
	if (count > out_contrasts->capacity) {
		struct gz_node_contrast *grown = realloc(out_contrasts->of, count * sizeof *grown);
		if (!grown)
			return GZ_ERR_NO_MEM;
		out_contrasts->of = grown;
		out_contrasts->capacity = count;
	}
	struct measure_job job = {
		.plan = plan,
		.lattices = lattices,
		.from = from,
		.channels = edges ? 1 : CHANNELS,
		.least = edges ? (float)foveation->edge_contrast : 0,
		.contrasts = out_contrasts->of,
	};
	gz_workers_run(workers, measure_part, &job, (count + TILES_A_PART - 1) / TILES_A_PART);
	return GZ_OK;
}

enum gz_result gz_contrasts_plan_round(struct gz_plan *plan, size_t *first,
				       const struct gz_lattices *lattices,
				       struct gz_workers *workers, struct gz_contrasts *contrasts)
{
	const size_t tiles = plan->tile_count;
	enum gz_result result = gz_contrasts_measure(plan, *first, lattices, workers, contrasts);
	if (result == GZ_OK)
		result = gz_plan_refine(plan, *first, contrasts->of);
	if (result == GZ_OK)
		*first = tiles;
	return result;
}

void gz_contrasts_free(struct gz_contrasts *contrasts)
{
	free(contrasts->of);
	*contrasts = (struct gz_contrasts) { 0 };
}
