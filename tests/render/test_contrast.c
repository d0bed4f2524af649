/* Plans that are refined where neighbouring rays differ. */
#include "suite.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/workers.h"
#include "render/contrast/contrast.h"
#include "render/plan/method.h"
#include "render/plan/plan.h"
#include "render/reconstruct/cpu/lattice.h"
#include "small_scene.h"

static struct gz_plan_request request_for(const struct gz_foveation *foveation,
					  const struct gz_display *display, struct gz_point gaze)
{
	struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, display->px[0], display->px[1]);
	request.refines = true;
	return request;
}

static struct gz_foveation contrast_foveation(void)
{
	struct gz_foveation foveation = small_scene_foveation();
	foveation.method = GZ_METHOD_CONTRAST;
	return foveation;
}

/* Acuity with the finest rays that contrast may cast: a power of two of acuity's, so that this
 * rounds as the method does. */
static struct gz_foveation finest_foveation(const struct gz_foveation *contrast)
{
	struct gz_foveation foveation = *contrast;
	foveation.method = GZ_METHOD_ACUITY;
	foveation.acuity_slope *= contrast->contrast_finest;
	foveation.acuity_foveal_deg *= contrast->contrast_finest;
	return foveation;
}

/* Spacing that a tile's pattern has, px. */
static double spacing_of(const struct gz_plan *plan, const struct gz_tile *tile)
{
	return plan->layers[tile->layer].spacing *
	       (tile->pattern == GZ_TILE_QUINCUNX ? sqrt(2) : 1);
}

/* By pixel: the spacing of the tile that shows there; 0: none. */
static double *shown_spacings(const struct gz_plan *plan)
{
	double *spacings = calloc((size_t)plan->width * (size_t)plan->height, sizeof *spacings);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		if (tile->replaced)
			continue;
		const int down = GZ_TILE_EDGE * plan->layers[tile->layer].spacing;
		const int across = tile->pattern == GZ_TILE_QUINCUNX ? 2 * down : down;
		for (int y = tile->y; y < tile->y + down && y < plan->height; y++)
			for (int x = tile->x; x < tile->x + across && x < plan->width; x++) {
				double *spacing = &spacings[y * plan->width + x];
				if (*spacing > 0)
					fail_msg("two tiles show pixel %d %d", x, y);
				*spacing = spacing_of(plan, tile);
			}
	}
	return spacings;
}

/* Each pixel is shown by one tile, no coarser than before and no finer than the finest plan, and
 * the rays are counted. */
static void check_refined(const struct gz_plan *plan, const struct gz_plan *finest_plan,
			  double *before)
{
	double *spacings = shown_spacings(plan), *finest = shown_spacings(finest_plan);
	uint64_t rays = 0;
	for (size_t i = 0; i < plan->tile_count; i++)
		rays += (uint64_t)__builtin_popcount(gz_plan_tile_active(plan, &plan->tiles[i]));
	assert_int_equal(rays, plan->ray_count);
	for (int i = 0; i < plan->width * plan->height; i++) {
		if (spacings[i] == 0 || spacings[i] > before[i] || spacings[i] < finest[i])
			fail_msg("pixel %d %d: spacing %g, before %g, finest %g", i % plan->width,
				 i / plan->width, spacings[i], before[i], finest[i]);
		before[i] = spacings[i];
	}
	free(spacings);
	free(finest);
}

static float random_share(unsigned *seed)
{
	*seed = *seed * 1664525U + 1013904223U;
	const float share = (float)(*seed >> 8) / (float)(1 << 24);
	return share * share * share;
}

static void fill_contrasts(struct gz_node_contrast *contrasts, size_t count, unsigned *seed)
{
	for (size_t i = 0; i < count; i++) {
		const float most = random_share(seed);
		for (int cell = 0; cell < GZ_NODE_CELLS * GZ_NODE_CELLS; cell++) {
			const int row = cell / GZ_NODE_CELLS, column = cell % GZ_NODE_CELLS;
			contrasts[i].luminance[row][column] = most * random_share(seed);
			contrasts[i].colour[row][column] = most * random_share(seed);
		}
	}
}

/* The same contrast of luminance in all cells of a node, and no other. */
static struct gz_node_contrast even_contrast(float luminance)
{
	struct gz_node_contrast contrast = { 0 };
	for (int cell = 0; cell < GZ_NODE_CELLS * GZ_NODE_CELLS; cell++)
		contrast.luminance[cell / GZ_NODE_CELLS][cell % GZ_NODE_CELLS] = luminance;
	return contrast;
}

static void refined_plans_show_each_pixel_once_and_no_finer_than_allowed(void **state)
{
	(void)state;
	static const struct gz_point gazes[] = { { 0.5F, 0.5F },
						 { 0.03F, 0.97F },
						 { -0.2F, 0.4F } };
	static const int sizes[][2] = { { 1920, 1080 }, { 331, 217 }, { 7, 3 }, { 1, 1 } };
	unsigned seed = 1;
	for (size_t s = 0; s < 4; s++)
		for (size_t g = 0; g < 3; g++) {
			struct gz_foveation foveation = contrast_foveation();
			foveation.contrast_finest = g == 1 ? 0.5 : 1;
			const struct gz_foveation fine = finest_foveation(&foveation);
			const struct gz_display display =
				gz_display_default(sizes[s][0], sizes[s][1]);
			struct gz_plan plan = { 0 }, finest = { 0 };
			const struct gz_plan_request request =
				request_for(&foveation, &display, gazes[g]);
			assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
			assert_int_equal(gz_plan_make(&fine, &display, gazes[g], sizes[s][0],
						      sizes[s][1], &finest),
					 GZ_OK);
			double *before = shown_spacings(&plan);
			check_refined(&plan, &finest, before);
			for (int round = 0, first = 0; round < 3; round++) {
				const size_t count = plan.tile_count - (size_t)first;
				struct gz_node_contrast *contrasts =
					malloc((count + 1) * sizeof *contrasts);
				fill_contrasts(contrasts, count, &seed);
				assert_int_equal(gz_plan_refine(&plan, (size_t)first, contrasts),
						 GZ_OK);
				first += (int)count;
				check_refined(&plan, &finest, before);
				free(contrasts);
			}
			free(before);
			gz_plan_free(&plan);
			gz_plan_free(&finest);
		}
}

/* Finer than those of acuity, whose samples miss the place of an edge. */
static void full_contrast_takes_the_finest_tiles(void **state)
{
	(void)state;
	struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(1280, 720);
	const struct gz_point gaze = { 0.4F, 0.6F };
	struct gz_plan plan = { 0 }, acuity = { 0 }, finest = { 0 };
	const struct gz_plan_request request = request_for(&foveation, &display, gaze);
	/* An eye that sees everything, so that the finest spacing alone is the bound. */
	foveation.contrast_threshold = 0.0001;
	foveation.contrast_finest = 0.5;
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	const size_t first = plan.tile_count;
	assert_true(plan.ray_count > 0);
	struct gz_node_contrast *contrasts = malloc(first * sizeof *contrasts);
	for (size_t i = 0; i < first; i++)
		contrasts[i] = even_contrast(1);
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	const struct gz_foveation fine = finest_foveation(&foveation);
	assert_int_equal(gz_plan_make(&fine, &display, gaze, 1280, 720, &finest), GZ_OK);
	foveation.method = GZ_METHOD_ACUITY;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 1280, 720, &acuity), GZ_OK);
	assert_true(finest.ray_count > acuity.ray_count);
	double *made = shown_spacings(&plan), *wanted = shown_spacings(&finest);
	assert_memory_equal(made, wanted, 1280 * 720 * sizeof *made);
	free(made);
	free(wanted);
	free(contrasts);
	gz_plan_free(&plan);
	gz_plan_free(&acuity);
	gz_plan_free(&finest);
}

/* Then the fovea is cast in the first round, and only edges outside it get more. */
static void first_rays_may_be_those_of_acuity(void **state)
{
	(void)state;
	struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(1280, 720);
	const struct gz_point gaze = { 0.4F, 0.6F };
	struct gz_plan plan = { 0 }, acuity = { 0 };
	foveation.contrast_first = 1;
	const struct gz_plan_request request = request_for(&foveation, &display, gaze);
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_int_equal(gz_plan_rounds(&plan), 2);
	foveation.method = GZ_METHOD_ACUITY;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 1280, 720, &acuity), GZ_OK);
	assert_int_equal(plan.tile_count, acuity.tile_count);
	assert_int_equal(plan.ray_count, acuity.ray_count);
	double *made = shown_spacings(&plan), *wanted = shown_spacings(&acuity);
	assert_memory_equal(made, wanted, 1280 * 720 * sizeof *made);
	free(made);
	free(wanted);
	gz_plan_free(&plan);
	gz_plan_free(&acuity);
}

/* Rays of acuity's first round stay, but for those at edges. */
static void acuity_is_refined_at_edges_alone(void **state)
{
	(void)state;
	enum { WIDTH = 1280, HEIGHT = 720 };
	struct gz_foveation foveation = gz_foveation_default();
	foveation.edge_contrast = 0.7;
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_point gaze = { 0.4F, 0.6F };
	struct gz_plan plan = { 0 }, acuity = { 0 }, finest = { 0 };
	const struct gz_plan_request request = request_for(&foveation, &display, gaze);
	assert_int_equal(foveation.method, GZ_METHOD_ACUITY);
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, WIDTH, HEIGHT, &acuity), GZ_OK);
	assert_int_equal(gz_plan_rounds(&acuity), 1);
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_int_equal(gz_plan_rounds(&plan), 2);
	const size_t count = plan.tile_count;
	assert_int_equal(count, acuity.tile_count);
	assert_memory_equal(plan.tiles, acuity.tiles, count * sizeof *plan.tiles);
	double *before = shown_spacings(&plan);
	struct gz_node_contrast *contrasts = malloc(count * sizeof *contrasts);
	for (size_t i = 0; i < count; i++)
		contrasts[i] = even_contrast((float)foveation.edge_contrast - 0.01F);
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	assert_int_equal(plan.tile_count, count);
	for (size_t i = 0; i < count; i++)
		contrasts[i] = even_contrast(1);
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	struct gz_foveation fine = foveation;
	fine.acuity_slope *= foveation.edge_finest;
	fine.acuity_foveal_deg *= foveation.edge_finest;
	assert_int_equal(gz_plan_make(&fine, &display, gaze, WIDTH, HEIGHT, &finest), GZ_OK);
	double *made = shown_spacings(&plan), *wanted = shown_spacings(&finest);
	int finer = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		/* Tiles on the lattice of spacing 1 stay. */
		const double expected = before[i] < 2 ? before[i] : wanted[i];
		if (made[i] != expected)
			fail_msg("pixel %d %d: %g, not %g", i % WIDTH, i / WIDTH, made[i],
				 expected);
		finer += made[i] < before[i];
	}
	assert_true(finer > WIDTH * HEIGHT / 2);
	foveation.edge_contrast = 1;
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_int_equal(gz_plan_rounds(&plan), 1);
	free(made);
	free(wanted);
	free(before);
	free(contrasts);
	gz_plan_free(&plan);
	gz_plan_free(&acuity);
	gz_plan_free(&finest);
}

static void a_plan_made_again_forgets_its_further_rounds(void **state)
{
	(void)state;
	const struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(640, 360);
	const struct gz_plan_request request =
		request_for(&foveation, &display, (struct gz_point) { 0.5F, 0.5F });
	struct gz_plan plan = { 0 }, other = { 0 };
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_int_equal(gz_plan_update(&request, &other), GZ_OK);
	const uint64_t serial = plan.serial, rays = plan.ray_count;
	const size_t tiles = plan.tile_count;
	assert_true(gz_plan_same(&plan, &other));

	struct gz_node_contrast *contrasts = calloc(tiles, sizeof *contrasts);
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	assert_int_equal(plan.tile_count, tiles);
	assert_int_equal(plan.serial, serial);
	contrasts[0] = contrasts[1] = even_contrast(1);
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	assert_true(plan.tile_count > tiles && plan.ray_count > rays);
	assert_true(plan.serial > serial);
	assert_false(gz_plan_same(&plan, &other));
	assert_false(gz_plan_same(&other, &plan));

	const uint64_t refined = plan.serial;
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_true(plan.serial > refined);
	assert_int_equal(plan.tile_count, tiles);
	assert_int_equal(plan.ray_count, rays);
	assert_memory_equal(plan.tiles, other.tiles, tiles * sizeof *plan.tiles);
	free(contrasts);
	gz_plan_free(&plan);
	gz_plan_free(&other);
}

/* Where nothing refines, the method is acuity with other steps. */
static void a_technique_that_does_not_refine_takes_the_tiles_of_acuity(void **state)
{
	(void)state;
	struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(640, 360);
	const struct gz_point gaze = { 0.3F, 0.5F };
	struct gz_plan plan = { 0 }, acuity = { 0 }, lost = { 0 };
	struct gz_plan_request request = request_for(&foveation, &display, gaze);
	request.widen = 0.5;
	assert_int_equal(gz_plan_update(&request, &lost), GZ_OK);
	assert_int_equal(gz_plan_rounds(&lost), 1);
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 640, 360, &plan), GZ_OK);
	assert_int_equal(gz_plan_rounds(&plan), 1);
	foveation.method = GZ_METHOD_ACUITY;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 640, 360, &acuity), GZ_OK);
	assert_int_equal(plan.ray_count, acuity.ray_count);
	assert_int_equal(plan.tile_count, acuity.tile_count);
	gz_plan_free(&plan);
	gz_plan_free(&acuity);
	gz_plan_free(&lost);
}

/* Geisler and Perry's formula, the other way round: the contrast that is just seen at the spacing's
 * frequency is the one asked for. */
static void a_contrast_is_shown_as_finely_as_it_is_seen(void **state)
{
	(void)state;
	const struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(1920, 1080);
	const struct gz_point gaze = { 0.5F, 0.5F };
	const double contrasts[] = { 0.02, 0.1, 1 };
	for (int i = 0; i < 3; i++)
		for (int place = 0; place < 2; place++) {
			const struct gz_point at = { 0.5F + 0.3F * (float)place, 0.5F };
			const double spacing = gz_plan_contrast_spacing_px(
				&foveation, &display, contrasts[i], gaze, at, 1920, 1080);
			const struct gz_point next = { at.x + 1.0F / 1920, at.y };
			/* across the line of sight a pixel spans more: 1 / cosine */
			const double e = gz_display_angle_deg(&display, gaze, at);
			const double px_deg =
				gz_display_angle_deg(&display, at, next) / cos(e * M_PI / 180);
			const double f = 1 / (2 * spacing * px_deg);
			const double threshold = 1.0 / 64 * exp(0.106 * f * (e + 2.3) / 2.3);
			if (fabs(threshold / contrasts[i] - 1) > 0.01)
				fail_msg("contrast %g at %g degrees: spacing %g px, threshold %g",
					 contrasts[i], e, spacing, threshold);
		}
	assert_true(isinf(gz_plan_contrast_spacing_px(&foveation, &display, 1.0 / 64, gaze, gaze,
						      1920, 1080)));
	assert_true(isinf(
		gz_plan_contrast_spacing_px(&foveation, &display, 0, gaze, gaze, 1920, 1080)));
}

/* A first round whose points are those of a picture. */
struct shown {
	struct gz_plan plan;
	struct gz_lattices lattices;
	struct gz_contrasts contrasts;
	uint32_t *picture;
};

enum { SHOWN_WIDTH = 640, SHOWN_HEIGHT = 360 };

static uint32_t colour(double red, double green, double blue)
{
	return (uint32_t)lround(255 * red) | (uint32_t)lround(255 * green) << 8 |
	       (uint32_t)lround(255 * blue) << 16 | 0xFF000000U;
}

static uint32_t grey(double share)
{
	return colour(share, share, share);
}

/* Colour of a pixel; the curve of a display is a square. */
typedef uint32_t picture_function(int x, int y);

static struct shown show(picture_function *picture, int threads)
{
	struct shown shown = { 0 };
	const struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(SHOWN_WIDTH, SHOWN_HEIGHT);
	const struct gz_plan_request request =
		request_for(&foveation, &display, (struct gz_point) { 0.5F, 0.5F });
	struct gz_workers *workers;
	assert_int_equal(gz_plan_update(&request, &shown.plan), GZ_OK);
	shown.picture = aligned_alloc(64, (size_t)SHOWN_WIDTH * SHOWN_HEIGHT * 4);
	assert_int_equal(gz_lattices_prepare(&shown.lattices, &shown.plan, shown.picture), GZ_OK);
	for (size_t i = 0; i < shown.plan.tile_count; i++) {
		const struct gz_tile *tile = &shown.plan.tiles[i];
		const int spacing = shown.plan.layers[tile->layer].spacing;
		uint32_t pixels[GZ_TILE_EDGE * GZ_TILE_EDGE];
		for (int ray = 0; ray < GZ_TILE_EDGE * GZ_TILE_EDGE; ray++)
			pixels[ray] =
				picture(tile->x + gz_tile_columns[tile->pattern][ray] * spacing,
					tile->y + gz_tile_rows[ray] * spacing);
		gz_lattices_store(&shown.lattices, &shown.plan, tile,
				  gz_plan_tile_active(&shown.plan, tile), pixels);
	}
	assert_int_equal(gz_workers_create(threads, &workers), GZ_OK);
	assert_int_equal(
		gz_contrasts_measure(&shown.plan, 0, &shown.lattices, workers, &shown.contrasts),
		GZ_OK);
	gz_workers_destroy(&workers);
	return shown;
}

static void shown_free(struct shown *shown)
{
	gz_plan_free(&shown->plan);
	gz_lattices_free(&shown->lattices);
	gz_contrasts_free(&shown->contrasts);
	free(shown->picture);
}

static uint32_t flat(int x, int y)
{
	(void)x;
	(void)y;
	return grey(0.7);
}

static uint32_t slope(int x, int y)
{
	(void)y;
	return grey(sqrt(0.2 + 0.6 * x / 1000.0));
}

enum { EDGE_X = 301 };

/* Luminances .6 and .4: half of Michelson's contrast is .1. */
static uint32_t edge(int x, int y)
{
	(void)y;
	return grey(sqrt(x < EDGE_X ? 0.4 : 0.6));
}

/* Red and green, then blue and a dark yellow, of nearly one luminance. */
static uint32_t red_green_edge(int x, int y)
{
	(void)y;
	return x < EDGE_X ? colour(1, 0, 0) : colour(0, sqrt(0.2126 / 0.7152), 0);
}

static uint32_t blue_yellow_edge(int x, int y)
{
	(void)y;
	const double yellow = sqrt(0.0722 / (0.2126 + 0.7152));
	return x < EDGE_X ? colour(0, 0, 1) : colour(yellow, yellow, 0);
}

/* Whether a tile's contrast is measured: it is its node's first and may be replaced. */
static bool is_measured(const struct gz_tile *tile, int *out_level)
{
	return gz_plan_node_of(tile, out_level) && tile->layer > 0;
}

static float greatest(const float cells[GZ_NODE_CELLS][GZ_NODE_CELLS])
{
	float most = 0;
	for (int cell = 0; cell < GZ_NODE_CELLS * GZ_NODE_CELLS; cell++)
		most = fmaxf(most, cells[cell / GZ_NODE_CELLS][cell % GZ_NODE_CELLS]);
	return most;
}

/* At the picture's rim, where the slope ends, .6 / 1000 of white a pixel and 32 px between rays are
 * a contrast of .024. */
static void what_is_flat_or_rises_evenly_has_no_contrast(void **state)
{
	(void)state;
	static picture_function *const pictures[] = { flat, slope };
	for (int p = 0; p < 2; p++) {
		struct shown shown = show(pictures[p], 2);
		for (size_t i = 0; i < shown.plan.tile_count; i++) {
			const struct gz_node_contrast *contrast = &shown.contrasts.of[i];
			int level;
			if (!is_measured(&shown.plan.tiles[i], &level))
				continue;
			if (greatest(contrast->luminance) > (p == 0 ? 0 : 0.025F) ||
			    greatest(contrast->colour) > 0.001F)
				fail_msg("picture %d, tile at %d %d: %g, colour %g", p,
					 shown.plan.tiles[i].x, shown.plan.tiles[i].y,
					 (double)greatest(contrast->luminance),
					 (double)greatest(contrast->colour));
		}
		shown_free(&shown);
	}
}

/* Also where the neighbours' points lie farther apart than a tile's own. */
static void an_edge_is_found_by_every_tile_that_it_crosses(void **state)
{
	(void)state;
	struct shown shown = show(edge, 3);
	int crossed = 0, patterns[GZ_TILE_PATTERN_COUNT] = { 0 };
	for (size_t i = 0; i < shown.plan.tile_count; i++) {
		const struct gz_tile *tile = &shown.plan.tiles[i];
		int level;
		if (tile->y >= SHOWN_HEIGHT || !is_measured(tile, &level))
			continue;
		const int across = GZ_TILE_EDGE << level, beside = 4 << level;
		const float contrast = greatest(shown.contrasts.of[i].luminance);
		if (tile->x < EDGE_X && EDGE_X <= tile->x + across) {
			crossed++;
			patterns[tile->pattern]++;
			if (!(contrast > 0.08F && contrast < 0.115F))
				fail_msg("tile at %d %d: %g", tile->x, tile->y, (double)contrast);
		} else if (tile->x > EDGE_X + beside || tile->x + across < EDGE_X - beside) {
			if (contrast > 0.001F)
				fail_msg("tile at %d %d, beside the edge: %g", tile->x, tile->y,
					 (double)contrast);
		}
	}
	assert_true(crossed > 10 && patterns[GZ_TILE_SQUARE] > 0 && patterns[GZ_TILE_QUINCUNX] > 0);
	shown_free(&shown);
}

/* Only the cells beside it: the rest of the node may stay coarse. */
static void an_edge_is_found_by_the_cells_that_it_crosses(void **state)
{
	(void)state;
	struct shown shown = show(edge, 1);
	int crossed = 0, beside = 0;
	for (size_t i = 0; i < shown.plan.tile_count; i++) {
		const struct gz_tile *tile = &shown.plan.tiles[i];
		int level;
		if (tile->y >= SHOWN_HEIGHT || !is_measured(tile, &level))
			continue;
		for (int column = 0; column < GZ_NODE_CELLS; column++) {
			const int from = tile->x + (column << level), to = from + (1 << level);
			const float contrast = shown.contrasts.of[i].luminance[1][column];
			if (from < EDGE_X && EDGE_X <= to) {
				crossed++;
				assert_true(contrast > 0.08F);
			} else if (tile->x < EDGE_X &&
				   EDGE_X <= tile->x + (GZ_TILE_EDGE << level) &&
				   (from > EDGE_X + (2 << level) || to < EDGE_X - (2 << level))) {
				beside++;
				assert_true(contrast < 0.001F);
			}
		}
	}
	assert_true(crossed > 10 && beside > 10);
	shown_free(&shown);
}

/* Luminance alone did not tell them apart. */
static void edges_between_colours_of_one_luminance_are_found(void **state)
{
	(void)state;
	static picture_function *const pictures[] = { red_green_edge, blue_yellow_edge };
	for (int p = 0; p < 2; p++) {
		struct shown shown = show(pictures[p], 2);
		int crossed = 0;
		for (size_t i = 0; i < shown.plan.tile_count; i++) {
			const struct gz_tile *tile = &shown.plan.tiles[i];
			int level;
			if (tile->y >= SHOWN_HEIGHT || !is_measured(tile, &level))
				continue;
			if (!(tile->x < EDGE_X && EDGE_X <= tile->x + (GZ_TILE_EDGE << level)))
				continue;
			const struct gz_node_contrast *contrast = &shown.contrasts.of[i];
			crossed++;
			if (greatest(contrast->luminance) > 0.01F ||
			    greatest(contrast->colour) < 0.1F)
				fail_msg("picture %d, tile at %d %d: luminance %g, colour %g", p,
					 tile->x, tile->y, (double)greatest(contrast->luminance),
					 (double)greatest(contrast->colour));
		}
		assert_true(crossed > 10);
		shown_free(&shown);
	}
}

/* Rays of a plan all of whose nodes have one contrast. */
static uint64_t rays_for(const struct gz_node_contrast *contrast)
{
	const struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(1280, 720);
	const struct gz_plan_request request =
		request_for(&foveation, &display, (struct gz_point) { 0.5F, 0.5F });
	struct gz_plan plan = { 0 };
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	struct gz_node_contrast *contrasts = malloc(plan.tile_count * sizeof *contrasts);
	for (size_t i = 0; i < plan.tile_count; i++)
		contrasts[i] = *contrast;
	assert_int_equal(gz_plan_refine(&plan, 0, contrasts), GZ_OK);
	const uint64_t rays = plan.ray_count;
	free(contrasts);
	gz_plan_free(&plan);
	return rays;
}

static void a_cell_with_contrast_leaves_the_rest_of_its_node_coarser(void **state)
{
	(void)state;
	struct gz_node_contrast all = even_contrast(0.5F), one = even_contrast(0);
	const struct gz_node_contrast none = even_contrast(0);
	one.luminance[1][2] = 0.5F;
	assert_true(rays_for(&none) < rays_for(&one));
	if ((rays_for(&one) - rays_for(&none)) * 2 >= rays_for(&all) - rays_for(&none))
		fail_msg("%" PRIu64 " rays without, %" PRIu64 " with one cell, %" PRIu64
			 " with all",
			 rays_for(&none), rays_for(&one), rays_for(&all));
	/* seen less than luminance of the same contrast, but seen */
	struct gz_node_contrast coloured = none;
	memcpy(coloured.colour, all.luminance, sizeof coloured.colour);
	assert_true(rays_for(&none) < rays_for(&coloured));
	assert_true(rays_for(&coloured) < rays_for(&all));
}

/* What is thinner than the first rays are apart must not be missed where it is looked at. At this
 * size acuity alone would begin to leave pixels out at 1.6 degrees. */
static void each_pixel_of_the_fovea_has_a_ray_at_once(void **state)
{
	(void)state;
	enum { WIDTH = 3840, HEIGHT = 2160 };
	const struct gz_foveation foveation = contrast_foveation();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_point gaze = { 0.4F, 0.6F };
	const struct gz_plan_request request = request_for(&foveation, &display, gaze);
	struct gz_plan plan = { 0 };
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	int foveal = 0;
	for (size_t i = 0; i < plan.tile_count; i++) {
		const struct gz_tile *tile = &plan.tiles[i];
		const struct gz_point at = { ((float)tile->x + 0.5F) / WIDTH,
					     ((float)tile->y + 0.5F) / HEIGHT };
		if (gz_display_angle_deg(&display, gaze, at) > 2.49)
			continue;
		foveal++;
		assert_int_equal(tile->layer, 0);
		assert_true(plan.steps[tile->step] == 1);
	}
	assert_true(foveal > 1000);
	gz_plan_free(&plan);
}

/* Rays of a frame by a method, which is drawn twice by one plan, with another frame between. */
static uint64_t draw_twice(struct gz_raycaster *renderer, struct small_scene *scene, int method,
			   struct gz_image *image)
{
	enum { WIDTH = 900, HEIGHT = 700 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct gz_plan plan = { 0 };
	struct gz_image again = { 0 };
	struct gz_frame_stats stats, other, last;
	scene->foveation.method = method;
	small_scene_render_plan(renderer, scene, &display, WIDTH, HEIGHT, &plan, image, &stats);
	struct small_scene turned = *scene;
	turned.camera.eye[0] += 0.4;
	small_scene_render_plan(renderer, &turned, &display, WIDTH, HEIGHT, &plan, &again, &other);
	small_scene_render_plan(renderer, scene, &display, WIDTH, HEIGHT, &plan, &again, &last);
	assert_int_equal(stats.rays, last.rays);
	int x = 0, y = 0;
	if (image_difference(image, &again, &x, &y) > 0)
		fail_msg("%s: pixel %d %d differs the second time", gz_method_names[method], x, y);
	gz_plan_free(&plan);
	gz_image_free(&again);
	return stats.rays;
}

static double psnr_db(const struct gz_image *a, const struct gz_image *b)
{
	double squares = 0;
	for (int i = 0; i < a->width * a->height * 4; i++)
		squares += pow(a->pixels[i] - b->pixels[i], 2);
	return 10 * log10(255.0 * 255 / (squares / (a->width * a->height * 3)));
}

static void a_flat_picture_takes_the_first_rays_alone(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(20, 0);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image image = { 0 };
	scene.rays.background[1] = 0.5;
	const uint64_t acuity = draw_twice(renderer, &scene, GZ_METHOD_ACUITY, &image);
	const uint64_t contrast = draw_twice(renderer, &scene, GZ_METHOD_CONTRAST, &image);
	if (contrast * 3 > acuity)
		fail_msg("%llu rays, acuity %llu", (unsigned long long)contrast,
			 (unsigned long long)acuity);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void rays_go_where_there_is_contrast(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(48, 48, 48, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image full = { 0 }, first = { 0 }, image = { 0 };
	draw_twice(renderer, &scene, GZ_METHOD_STANDARD, &full);
	const uint64_t acuity = draw_twice(renderer, &scene, GZ_METHOD_ACUITY, &image);
	scene.foveation.contrast_rounds = 1;
	const uint64_t alone = draw_twice(renderer, &scene, GZ_METHOD_CONTRAST, &first);
	scene.foveation.contrast_rounds = 3;
	const uint64_t contrast = draw_twice(renderer, &scene, GZ_METHOD_CONTRAST, &image);
	assert_true(alone < contrast && contrast < acuity);
	const double gained = psnr_db(&full, &image) - psnr_db(&full, &first);
	if (gained < 1)
		fail_msg("%g dB gained by %llu rays beside %llu", gained,
			 (unsigned long long)(contrast - alone), (unsigned long long)alone);
	gz_image_free(&full);
	gz_image_free(&first);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

TEST_SUITE(contrast)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(refined_plans_show_each_pixel_once_and_no_finer_than_allowed),
		cmocka_unit_test(full_contrast_takes_the_finest_tiles),
		cmocka_unit_test(first_rays_may_be_those_of_acuity),
		cmocka_unit_test(acuity_is_refined_at_edges_alone),
		cmocka_unit_test(a_plan_made_again_forgets_its_further_rounds),
		cmocka_unit_test(a_technique_that_does_not_refine_takes_the_tiles_of_acuity),
		cmocka_unit_test(a_contrast_is_shown_as_finely_as_it_is_seen),
		cmocka_unit_test(what_is_flat_or_rises_evenly_has_no_contrast),
		cmocka_unit_test(an_edge_is_found_by_every_tile_that_it_crosses),
		cmocka_unit_test(an_edge_is_found_by_the_cells_that_it_crosses),
		cmocka_unit_test(edges_between_colours_of_one_luminance_are_found),
		cmocka_unit_test(a_cell_with_contrast_leaves_the_rest_of_its_node_coarser),
		cmocka_unit_test(each_pixel_of_the_fovea_has_a_ray_at_once),
		cmocka_unit_test(a_flat_picture_takes_the_first_rays_alone),
		cmocka_unit_test(rays_go_where_there_is_contrast),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
