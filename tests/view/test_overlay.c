/* A plan as coloured cells: each place has the colour of the tile that shows there. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/plan/method.h"
#include "view/draw/overlay.h"

enum { WIDTH = 650, HEIGHT = 402 };

static const struct gz_point gaze = { 0.25F, 0.5F };

static void make(int method, struct gz_plan *plan)
{
	struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	foveation.method = method;
	foveation.uniform_spacing = 3;
	foveation.mdc_square_px = 128;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, WIDTH, HEIGHT, plan), GZ_OK);
}

static const uint8_t *cell(const struct gz_plan_cells *cells, int x, int y)
{
	return cells->rgba + 4 * ((y / GZ_TILE_EDGE) * cells->columns + x / GZ_TILE_EDGE);
}

static void expect(const struct gz_plan_cells *cells, int x, int y, double value)
{
	uint8_t wanted[3];
	const uint8_t *got = cell(cells, x, y);
	gz_viridis(gz_plan_cells_share(value, cells->end), wanted);
	if (memcmp(wanted, got, 3) != 0)
		fail_msg("at %d %d: %d %d %d, not %d %d %d of %g", x, y, got[0], got[1], got[2],
			 wanted[0], wanted[1], wanted[2], value);
}

static void standard_has_one_colour_and_a_scale_that_shows_it_is_fine(void **state)
{
	(void)state;
	struct gz_plan plan = { 0 };
	struct gz_plan_cells cells = { 0 };
	make(GZ_METHOD_STANDARD, &plan);
	assert_int_equal(gz_plan_cells_make(&cells, &plan, GZ_OVERLAY_SPACING), GZ_OK);
	assert_int_equal(cells.columns, 163);
	assert_int_equal(cells.rows, 101);
	for (int y = 0; y < HEIGHT; y += GZ_TILE_EDGE)
		for (int x = 0; x < WIDTH; x += GZ_TILE_EDGE)
			expect(&cells, x, y, 1);
	assert_true(cells.least == 1 && cells.most == 1 && cells.end == GZ_PLAN_CELLS_SCALE_LEAST);
	gz_plan_cells_free(&cells);
	gz_plan_free(&plan);
}

static void uniform_has_its_spacing_everywhere_and_regions_theirs(void **state)
{
	(void)state;
	struct gz_plan plan = { 0 };
	struct gz_plan_cells cells = { 0 };
	make(GZ_METHOD_UNIFORM, &plan);
	assert_int_equal(gz_plan_cells_make(&cells, &plan, GZ_OVERLAY_SPACING), GZ_OK);
	expect(&cells, 0, 0, 3);
	expect(&cells, WIDTH - 1, HEIGHT - 1, 3);
	make(GZ_METHOD_MDC, &plan);
	assert_int_equal(gz_plan_cells_make(&cells, &plan, GZ_OVERLAY_SPACING), GZ_OK);
	const double outside = gz_foveation_default().mdc_spacing;
	expect(&cells, WIDTH / 4, HEIGHT / 2, 1);
	expect(&cells, WIDTH / 4 + 56, HEIGHT / 2 - 56, 1);
	expect(&cells, WIDTH / 4 + 80, HEIGHT / 2, outside);
	expect(&cells, WIDTH - 1, 0, outside);
	assert_true(cells.least == 1 && cells.most == outside);
	gz_plan_cells_free(&cells);
	gz_plan_free(&plan);
}

static int brightness(const uint8_t *rgb)
{
	return 2 * rgb[0] + 7 * rgb[1] + rgb[2];
}

static void acuity_grows_lighter_away_from_the_gaze(enum gz_view_overlay overlay)
{
	struct gz_plan plan = { 0 };
	struct gz_plan_cells cells = { 0 };
	make(GZ_METHOD_ACUITY, &plan);
	assert_int_equal(gz_plan_cells_make(&cells, &plan, overlay), GZ_OK);
	expect(&cells, WIDTH / 4, HEIGHT / 2, 1);
	int last = 0;
	for (int x = WIDTH / 4; x < WIDTH; x += GZ_TILE_EDGE) {
		const int now = brightness(cell(&cells, x, HEIGHT / 2));
		if (now < last)
			fail_msg("overlay %d is darker at %d: %d, before %d", (int)overlay, x, now,
				 last);
		last = now;
	}
	assert_true(last > brightness(cell(&cells, WIDTH / 4, HEIGHT / 2)));
	assert_true(cells.most > 1 && cells.most <= cells.end);
	gz_plan_cells_free(&cells);
	gz_plan_free(&plan);
}

static void acuity_grows_lighter_away_from_the_gaze_in_spacing_and_step(void **state)
{
	(void)state;
	acuity_grows_lighter_away_from_the_gaze(GZ_OVERLAY_SPACING);
	acuity_grows_lighter_away_from_the_gaze(GZ_OVERLAY_STEP);
}

static void no_method_leaves_a_place_without_a_colour(void **state)
{
	(void)state;
	struct gz_plan plan = { 0 };
	struct gz_plan_cells cells = { 0 };
	for (int method = 0; method < GZ_METHOD_TABLE; method++) {
		make(method, &plan);
		assert_int_equal(gz_plan_cells_make(&cells, &plan, GZ_OVERLAY_SPACING), GZ_OK);
		for (int y = 0; y < HEIGHT; y += GZ_TILE_EDGE)
			for (int x = 0; x < WIDTH; x += GZ_TILE_EDGE)
				if (brightness(cell(&cells, x, y)) == 0)
					fail_msg("%s has no tile at %d %d", gz_method_names[method],
						 x, y);
	}
	gz_plan_cells_free(&cells);
	gz_plan_free(&plan);
}

static void colours_grow_lighter_and_keep_to_their_ends(void **state)
{
	(void)state;
	uint8_t rgb[3], other[3];
	int last = 0;
	for (int i = 0; i <= 100; i++) {
		gz_viridis(i / 100.0, rgb);
		if (brightness(rgb) < last)
			fail_msg("share %d is darker: %d, before %d", i, brightness(rgb), last);
		last = brightness(rgb);
	}
	gz_viridis(1.5, other);
	assert_memory_equal(rgb, other, 3);
	gz_viridis(0, rgb);
	gz_viridis(-1, other);
	assert_memory_equal(rgb, other, 3);
	gz_viridis(NAN, other);
	assert_memory_equal(rgb, other, 3);
}

TEST_SUITE(overlay)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(standard_has_one_colour_and_a_scale_that_shows_it_is_fine),
		cmocka_unit_test(uniform_has_its_spacing_everywhere_and_regions_theirs),
		cmocka_unit_test(acuity_grows_lighter_away_from_the_gaze_in_spacing_and_step),
		cmocka_unit_test(no_method_leaves_a_place_without_a_colour),
		cmocka_unit_test(colours_grow_lighter_and_keep_to_their_ends),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
