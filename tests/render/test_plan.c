/* Where rays go. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture/image.h"
#include "render/plan/method.h"
#include "render/plan/plan.h"
#include "small_scene.h"

static struct gz_plan make(int method, struct gz_point gaze, int width, int height)
{
	struct gz_foveation foveation = small_scene_foveation();
	const struct gz_display display = gz_display_default(width, height);
	struct gz_plan plan = { 0 };
	foveation.method = method;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, width, height, &plan), GZ_OK);
	return plan;
}

/* How often each point of each lattice is cast. */
static void check_tiles(const struct gz_plan *plan)
{
	/* coarser lattices reach beyond the finer ones */
	enum { MARGIN = 4 * GZ_TILE_EDGE * GZ_PYRAMID_SPACING_MAX };
	uint8_t *cast[GZ_PLAN_LAYERS_MAX];
	uint64_t rays = 0;
	for (int i = 0; i < plan->layer_count; i++)
		cast[i] = calloc((size_t)(plan->layers[i].columns + MARGIN) *
					 (size_t)(plan->layers[i].rows + MARGIN),
				 1);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		assert_in_range(tile->layer, 0, plan->layer_count - 1);
		assert_in_range(tile->step, 0, plan->step_count - 1);
		const struct gz_plan_layer *layer = &plan->layers[tile->layer];
		assert_int_equal(tile->x % (layer->spacing * GZ_TILE_EDGE), 0);
		assert_int_equal(tile->y % (layer->spacing * GZ_TILE_EDGE), 0);
		const uint32_t active = gz_plan_tile_active(plan, tile);
		for (int ray = 0; ray < 16; ray++) {
			if (!(active >> ray & 1))
				continue;
			const int column =
				tile->x / layer->spacing + gz_tile_columns[tile->pattern][ray];
			const int row = tile->y / layer->spacing + gz_tile_rows[ray];
			assert_in_range(column, 0, layer->columns + MARGIN - 1);
			assert_in_range(row, 0, layer->rows + MARGIN - 1);
			uint8_t *count =
				&cast[tile->layer][row * (layer->columns + MARGIN) + column];
			if (++*count != 1)
				fail_msg("layer %d point %d %d cast twice", tile->layer, column,
					 row);
			rays++;
		}
	}
	assert_int_equal(rays, plan->ray_count);
	for (int i = 0; i < plan->layer_count; i++)
		free(cast[i]);
}

static void every_point_is_cast_at_most_once_for_any_size_and_gaze(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 1, 1 },    { 7, 3 },   { 64, 64 },   { 65, 63 },
					{ 8191, 1 }, { 1, 700 }, { 317, 203 }, { 1920, 1080 } };
	static const struct gz_point gazes[] = { { 0.5F, 0.5F }, { 0, 0 },     { 1, 1 },
						 { -3, 0.2F },   { 0.3F, 40 }, { NAN, 0.5F },
						 { INFINITY, 0 } };
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
			for (size_t j = 0; j < sizeof gazes / sizeof gazes[0]; j++) {
				struct gz_plan plan =
					make(method, gazes[j], sizes[i][0], sizes[i][1]);
				check_tiles(&plan);
				gz_plan_free(&plan);
			}
}

static void standard_casts_each_pixel(void **state)
{
	(void)state;
	struct gz_plan plan = make(GZ_METHOD_STANDARD, (struct gz_point) { 0.5F, 0.5F }, 317, 203);
	assert_int_equal(plan.ray_count, 317 * 203);
	gz_plan_free(&plan);
}

/* The share of what the eye resolves at an eccentricity that acuity's rays may be apart. */
static double share_of_resolved(const struct gz_foveation *foveation, double eccentricity_deg)
{
	const double beyond_deg = fmax(eccentricity_deg - foveation->acuity_far_deg, 0);
	const double less =
		beyond_deg * foveation->acuity_slope * (1 - foveation->acuity_far_share);
	return 1 -
	       less / (foveation->acuity_foveal_deg + eccentricity_deg * foveation->acuity_slope);
}

static void acuity_is_never_coarser_than_the_eye_resolves(void **state)
{
	(void)state;
	const struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = gz_display_default(1920, 1080);
	bool far = false;
	const struct gz_point gazes[] = { { 0.5F, 0.45F }, { 0.02F, 0.97F }, { 1.2F, 0.5F } };
	for (size_t g = 0; g < 3; g++) {
		struct gz_plan plan = make(GZ_METHOD_ACUITY, gazes[g], 1920, 1080);
		for (size_t i = 0; i < plan.tile_count; i++) {
			const struct gz_tile *tile = &plan.tiles[i];
			const int lattice = plan.layers[tile->layer].spacing;
			const double spacing =
				lattice * (tile->pattern == GZ_TILE_QUINCUNX ? M_SQRT2 : 1);
			for (int ray = 0; ray < 16; ray++) {
				const double x =
					tile->x + gz_tile_columns[tile->pattern][ray] * lattice;
				const double y = tile->y + gz_tile_rows[ray] * lattice;
				const struct gz_point at = { (float)((x + 0.5) / 1920),
							     (float)((y + 0.5) / 1080) };
				const double resolved = gz_acuity_spacing_px(
					&foveation, &display, gazes[g], at, 1920, 1080);
				const double share = share_of_resolved(
					&foveation, gz_display_angle_deg(&display, gazes[g], at));
				far = far || share < 0.6;
				if (spacing > 1 && spacing > resolved * share * 1.001)
					fail_msg("at %g %g: spacing %g, %g of the eye's %g", x, y,
						 spacing, share, resolved);
			}
		}
		gz_plan_free(&plan);
	}
	assert_true(far);
}

static void acuity_is_full_resolution_where_the_display_limits_the_eye(void **state)
{
	(void)state;
	/* The eye resolves 2 px on the default display from 4.1 degrees on at 1920 px, 3.4 at
	 * 2263, 1.6 at 3840: the flat screen has fewer pixels a degree at its centre than on
	 * average. */
	static const struct {
		int width, height;
		double until_deg;
	} cases[] = { { 1920, 1080, 4.15 }, { 2263, 1306, 3.4 }, { 3840, 2160, 1.6 } };
	for (size_t i = 0; i < 3; i++) {
		const struct gz_foveation foveation = gz_foveation_default();
		const struct gz_display display =
			gz_display_default(cases[i].width, cases[i].height);
		const struct gz_point gaze = { 0.5F, 0.5F };
		const double px_per_deg = gz_display_px_per_deg(&display);
		for (int side = 0; side < 2; side++) {
			const double deg = cases[i].until_deg + (side ? 0.15 : -0.15);
			const struct gz_point at = {
				0.5F + (float)(deg * px_per_deg / cases[i].width), 0.5F
			};
			const double spacing = gz_acuity_spacing_px(
				&foveation, &display, gaze, at, cases[i].width, cases[i].height);
			if (side ? spacing < 2 : spacing >= 2)
				fail_msg("%d px: %g px at %g degrees", cases[i].width, spacing,
					 deg);
		}
	}
}

/* Tiles with a place within some degrees of the gaze, and how many of them leave pixels out. */
static void check_fovea(int method, double full_deg, struct gz_point gaze, bool whole)
{
	enum { WIDTH = 3840, HEIGHT = 2160 };
	struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct gz_plan plan = { 0 };
	foveation.method = method;
	foveation.acuity_full_deg = full_deg;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, WIDTH, HEIGHT, &plan), GZ_OK);
	int within = 0, coarse = 0;
	for (size_t i = 0; i < plan.tile_count; i++) {
		const struct gz_tile *tile = &plan.tiles[i];
		const struct gz_point at = { ((float)tile->x + 0.5F) / WIDTH,
					     ((float)tile->y + 0.5F) / HEIGHT };
		if (gz_display_angle_deg(&display, gaze, at) >= 2.499) /* floats */
			continue;
		within++;
		coarse += plan.layers[tile->layer].spacing > 1 || tile->pattern != GZ_TILE_SQUARE ||
			  plan.steps[tile->step] > 1;
	}
	assert_true(within > 100);
	if ((coarse == 0) != whole)
		fail_msg("%d of %d tiles within 2.5 degrees are coarse", coarse, within);
	gz_plan_free(&plan);
}

static void fovea_is_whole_on_a_fine_display(void **state)
{
	(void)state;
	const struct gz_point gazes[] = { { 0.5F, 0.5F }, { 0.03F, 0.95F } };
	for (int i = 0; i < 2; i++) {
		check_fovea(GZ_METHOD_ACUITY, 2.5, gazes[i], true);
		check_fovea(GZ_METHOD_ACUITY, 0, gazes[i], false);
	}
}

static void acuity_takes_few_rays(void **state)
{
	(void)state;
	/* Where rays are as far apart as the eye resolves, a ladder of powers of two takes 10.5 %
	 * at 1080p, and one without a rung between 1 and 2 8.5 %; the quincunx rungs must do
	 * better. The preset casts more far from the gaze. */
	static const struct {
		double far_share;
		int width, height;
		double most; /* of the pixels */
	} cases[] = { { 1, 1920, 1080, 0.077 },
		      { 1, 3840, 2160, 0.029 },
		      { 0.5, 1920, 1080, 0.108 },
		      { 0.5, 3840, 2160, 0.037 } };
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_foveation foveation = gz_foveation_default();
		foveation.acuity_far_share = cases[i].far_share;
		const int width = cases[i].width, height = cases[i].height;
		const struct gz_display display = gz_display_default(width, height);
		struct gz_plan plan = { 0 };
		assert_int_equal(gz_plan_make(&foveation, &display,
					      (struct gz_point) { 0.5F, 0.45F }, width, height,
					      &plan),
				 GZ_OK);
		if ((double)plan.ray_count > cases[i].most * width * height)
			fail_msg("case %zu: %llu rays", i, (unsigned long long)plan.ray_count);
		gz_plan_free(&plan);
	}
}

static void mdc_casts_a_quarter_outside_its_square(void **state)
{
	(void)state;
	struct gz_plan plan = make(GZ_METHOD_MDC, (struct gz_point) { 0.5F, 0.5F }, 1600, 1200);
	const double expected = 350 * 350 + (1600 * 1200 - 350 * 350) / 4.0;
	if (fabs((double)plan.ray_count / expected - 1) > 0.03)
		fail_msg("%llu rays, about %g expected", (unsigned long long)plan.ray_count,
			 expected);
	gz_plan_free(&plan);
}

static void distance_rule_lengthens_steps_up_to_its_floor(void **state)
{
	(void)state;
	struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = gz_display_default(1000, 1000);
	struct gz_plan plan = { 0 };
	foveation.method = GZ_METHOD_STANDARD;
	foveation.step_rule = GZ_STEP_DISTANCE;
	assert_int_equal(
		gz_plan_make(&foveation, &display, (struct gz_point) { 0, 0 }, 1000, 1000, &plan),
		GZ_OK);
	const double diagonal = hypot(1000, 1000);
	for (size_t i = 0; i < plan.tile_count; i++) {
		/* the gaze lies on the corner of the first pixel, positions are of pixel centres */
		const double d = hypot(plan.tiles[i].x + 0.5, plan.tiles[i].y + 0.5);
		const double step = (double)plan.steps[plan.tiles[i].step];
		const double allowed = 1 / fmax(1 - d / diagonal, 0.25);
		/* one rung of the ladder, 4^(1/31), is the most it may fall short */
		if (step > allowed * 1.0001 || step < allowed / 1.06)
			fail_msg("at %g px: step %g, rule says %g", d, step, allowed);
		if (d <= 10)
			assert_true(step == 1);
	}
	assert_true(fabs((double)plan.steps[plan.step_count - 1] - 4) < 1e-5);
	gz_plan_free(&plan);
}

static void plan_refuses_what_is_out_of_range(void **state)
{
	(void)state;
	struct gz_foveation foveation = gz_foveation_default();
	struct gz_display display = gz_display_default(10, 10);
	const struct gz_point gaze = { 0.5F, 0.5F };
	struct gz_plan plan = { 0 };
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 0, 10, &plan), GZ_ERR_INVAL);
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 10, GZ_IMAGE_SIDE_MAX + 1, &plan),
			 GZ_ERR_INVAL);
	foveation.acuity_slope = NAN;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 10, 10, &plan), GZ_ERR_INVAL);
	foveation = gz_foveation_default();
	foveation.method = GZ_METHOD_DDC;
	foveation.ddc_spacing[2] = 0;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 10, 10, &plan), GZ_ERR_INVAL);
	foveation = gz_foveation_default();
	display.distance_mm = 0;
	assert_int_equal(gz_plan_make(&foveation, &display, gaze, 10, 10, &plan), GZ_ERR_INVAL);
	gz_plan_free(&plan);
}

static void plan_does_not_depend_on_the_locale(void **state)
{
	(void)state;
	/* An application may have set a locale whose decimal point is a comma. */
	static const char *const commas[] = { "de_DE.UTF-8", "de_DE", "fr_FR.UTF-8",
					      "nl_NL.UTF-8" };
	const char *found = NULL;
	for (size_t i = 0; !found && i < sizeof commas / sizeof *commas; i++)
		found = setlocale(LC_NUMERIC, commas[i]);
	if (!found)
		skip();
	struct gz_plan plan = make(GZ_METHOD_ACUITY, (struct gz_point) { 0.5F, 0.5F }, 64, 64);
	setlocale(LC_NUMERIC, "C");
	assert_true(plan.tile_count > 0);
	gz_plan_free(&plan);
}

static void trembling_gaze_moves_no_lattice(void **state)
{
	(void)state;
	struct gz_plan a = make(GZ_METHOD_ACUITY, (struct gz_point) { 0.5F, 0.5F }, 1920, 1080);
	struct gz_plan b = make(GZ_METHOD_ACUITY, (struct gz_point) { 0.5005F, 0.5F }, 1920, 1080);
	size_t same = 0, j = 0;
	for (size_t i = 0; i < a.tile_count; i++)
		for (size_t k = j; k < b.tile_count && k < j + 40; k++)
			if (memcmp(&a.tiles[i], &b.tiles[k], sizeof a.tiles[i]) == 0) {
				same++;
				j = k + 1;
				break;
			}
	if (same < a.tile_count * 9 / 10)
		fail_msg("only %zu of %zu tiles stay", same, a.tile_count);
	gz_plan_free(&a);
	gz_plan_free(&b);
}

/* For each pixel, the spacing of the finest tile that it lies in. The caller frees it. */
static uint8_t *finest_spacings(const struct gz_plan *plan)
{
	const size_t width = (size_t)plan->width;
	uint8_t *finest = malloc(width * (size_t)plan->height);
	assert_non_null(finest);
	memset(finest, UINT8_MAX, width * (size_t)plan->height);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const int spacing = plan->layers[tile->layer].spacing;
		const int down = GZ_TILE_EDGE * spacing;
		const int across = tile->pattern == GZ_TILE_QUINCUNX ? 2 * down : down;
		for (int y = tile->y; y < tile->y + down && y < plan->height; y++)
			for (int x = tile->x; x < tile->x + across && x < plan->width; x++) {
				uint8_t *here = &finest[(size_t)y * width + (size_t)x];
				*here = spacing < *here ? (uint8_t)spacing : *here;
			}
	}
	return finest;
}

/* The spacing that a plan of regions has at a pixel: of the first layer whose region holds it. */
static int region_spacing_at(const struct gz_plan *plan, int x, int y)
{
	int layer = 0;
	while (!gz_region_holds(&plan->layers[layer].region, x, y))
		layer++;
	return plan->layers[layer].spacing;
}

static bool rectangle_holds(const struct gz_plan_rectangle *rectangle, int x, int y)
{
	return x >= rectangle->from[0] && x < rectangle->to[0] && y >= rectangle->from[1] &&
	       y < rectangle->to[1];
}

static void check_nested(const struct gz_plan *plan, const struct gz_plan_rectangle *rectangles,
			 int count)
{
	assert_in_range(count, 1, GZ_PLAN_RECTANGLES_MAX);
	const int size[2] = { plan->width, plan->height };
	for (int axis = 0; axis < 2; axis++) {
		assert_int_equal(rectangles[0].from[axis], 0);
		assert_int_equal(rectangles[0].to[axis], size[axis]);
	}
	for (int i = 0; i < count; i++)
		for (int axis = 0; axis < 2; axis++) {
			assert_int_equal(rectangles[i].from[axis] % rectangles[i].spacing, 0);
			assert_true(rectangles[i].from[axis] < rectangles[i].to[axis]);
			if (i == 0)
				continue;
			assert_true(rectangles[i].spacing < rectangles[i - 1].spacing);
			assert_true(rectangles[i].from[axis] >= rectangles[i - 1].from[axis]);
			assert_true(rectangles[i].to[axis] <= rectangles[i - 1].to[axis]);
		}
}

static void check_rectangles(const struct gz_plan *plan, const char *name)
{
	struct gz_plan_rectangle rectangles[GZ_PLAN_RECTANGLES_MAX];
	const int count = gz_plan_rectangles(plan, rectangles);
	const bool regions = plan->reconstruction == GZ_RECONSTRUCT_REGIONS;
	uint8_t *tiles = finest_spacings(plan);
	check_nested(plan, rectangles, count);
	for (int y = 0; y < plan->height; y++)
		for (int x = 0; x < plan->width; x++) {
			int last = 0, finest = tiles[y * plan->width + x];
			for (int i = 0; i < count; i++)
				if (rectangle_holds(&rectangles[i], x, y))
					last = i;
			assert_int_not_equal(finest, UINT8_MAX); /* tiles lie on every pixel */
			if (rectangles[last].spacing > finest)
				fail_msg("%s: pixel %d %d has spacing %d, its tile %d", name, x, y,
					 rectangles[last].spacing, finest);
			if (regions && rectangles[last].spacing > region_spacing_at(plan, x, y))
				fail_msg("%s: pixel %d %d has spacing %d, its region %d", name, x,
					 y, rectangles[last].spacing,
					 region_spacing_at(plan, x, y));
		}
	free(tiles);
}

static void rectangles_are_nested_and_as_fine_as_the_tiles(void **state)
{
	(void)state;
	static const struct gz_point gazes[] = {
		{ 0.5F, 0.5F }, { 0.9F, 0.1F }, { -0.3F, 0.5F }, { NAN, NAN }
	};
	static const struct {
		double scale, widen;
	} coarser[] = { { 1, 0 }, { 3, 0 }, { GZ_PLAN_SCALE_MAX, 0 }, { 1, 0.4 }, { 2, 1 } };
	enum { WIDTH = 500, HEIGHT = 301 };
	struct gz_foveation foveation = small_scene_foveation();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	foveation.blend_px = 12;
	for (foveation.method = 0; foveation.method < GZ_METHOD_COUNT; foveation.method++)
		for (size_t g = 0; g < sizeof gazes / sizeof gazes[0]; g++)
			for (size_t c = 0; c < sizeof coarser / sizeof coarser[0]; c++) {
				struct gz_plan plan = { 0 };
				struct gz_plan_request request = gz_plan_request_make(
					&foveation, &display, gazes[g], WIDTH, HEIGHT);
				request.scale = coarser[c].scale;
				request.widen = coarser[c].widen;
				assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
				check_rectangles(&plan, gz_method_name(&foveation));
				gz_plan_free(&plan);
			}
	struct gz_plan plan = make(GZ_METHOD_STANDARD, gazes[0], WIDTH, HEIGHT);
	struct gz_plan_rectangle rectangles[GZ_PLAN_RECTANGLES_MAX];
	assert_int_equal(gz_plan_rectangles(&plan, rectangles), 1);
	assert_int_equal(rectangles[0].spacing, 1);
	gz_plan_free(&plan);
}

/* Without this every method could be covered by one rectangle of full resolution. */
static void rectangles_are_coarser_away_from_the_gaze(void **state)
{
	(void)state;
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		struct gz_plan_rectangle rectangles[GZ_PLAN_RECTANGLES_MAX];
		struct gz_plan plan = make(method, (struct gz_point) { 0.5F, 0.5F }, 1920, 1080);
		const int count = gz_plan_rectangles(&plan, rectangles);
		double samples = 0;
		for (int i = 0; i < count; i++) {
			const struct gz_plan_rectangle *one = &rectangles[i];
			samples += (one->to[0] - one->from[0]) / (double)one->spacing *
				   (one->to[1] - one->from[1]) / one->spacing;
		}
		/* rectangles enclose ellipses and overlap, and a quincunx counts twice: measured
		 * 2.15 for acuity */
		if (samples > 2.2 * (double)plan.ray_count)
			fail_msg("%s: %g samples for %llu rays", gz_method_names[method], samples,
				 (unsigned long long)plan.ray_count);
		gz_plan_free(&plan);
	}
}

static void each_method_is_planned_in_one_way_and_found_by_its_name(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_METHOD_COUNT; i++) {
		const struct gz_method *method = &gz_methods[i];
		assert_true(method->is_pyramid == (method->set_curves != NULL));
		assert_true(method->is_pyramid == (method->add_regions == NULL));
		assert_non_null(method->help);
		assert_int_equal(gz_method_find(gz_method_names[i]), i);
	}
	assert_null(gz_method_names[GZ_METHOD_COUNT]);
	assert_int_equal(gz_method_find("none"), -1);
	const struct gz_foveation full = gz_foveation_full();
	assert_false(gz_foveation_follows_gaze(&full));
	struct gz_foveation steps = full;
	steps.step_rule = GZ_STEP_DISTANCE;
	assert_true(gz_foveation_follows_gaze(&steps));
}

static void phases_of_a_tile_are_sixteen_and_neighbours_share_no_quarter(void **state)
{
	(void)state;
	for (int pattern = 0; pattern < GZ_TILE_PATTERN_COUNT; pattern++) {
		unsigned seen = 0;
		for (int i = 0; i < GZ_TILE_PHASE_COUNT; i++)
			seen |= 1U << gz_tile_phases[pattern][i];
		assert_int_equal(seen, 0xFFFF);
	}
	/* Squares of four rays, also those that tiles share. */
	for (int y = 0; y < GZ_TILE_EDGE; y++)
		for (int x = 0; x < GZ_TILE_EDGE; x++) {
			unsigned quarters = 0;
			for (int k = 0; k < 4; k++) {
				const int column = (x + k % 2) % GZ_TILE_EDGE;
				const int row = (y + k / 2) % GZ_TILE_EDGE;
				quarters |= 1U << gz_tile_phases[GZ_TILE_SQUARE]
								[row * GZ_TILE_EDGE + column] /
							  4;
			}
			assert_int_equal(quarters, 0xF);
		}
}

static void only_longer_steps_are_interleaved(void **state)
{
	(void)state;
	struct gz_foveation foveation = gz_foveation_default();
	const struct gz_display display = gz_display_default(640, 360);
	struct gz_plan plan = { 0 };
	foveation.acuity_slope = 0.2;
	for (int phase = 0; gz_step_phase_names[phase]; phase++) {
		foveation.step_phase = phase;
		assert_int_equal(gz_plan_make(&foveation, &display,
					      (struct gz_point) { 0.5F, 0.5F }, 640, 360, &plan),
				 GZ_OK);
		assert_true(plan.steps[0] == 1 && plan.steps[1] > 1);
		for (int lit = 0; lit < 2; lit++) {
			assert_false(gz_plan_interleaves(&plan, 0, lit));
			assert_int_equal(gz_plan_interleaves(&plan, 1, lit),
					 phase == GZ_STEP_PHASE_INTERLEAVED ||
						 (phase == GZ_STEP_PHASE_LIT && lit));
		}
	}
	gz_plan_free(&plan);
}

TEST_SUITE(plan)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_point_is_cast_at_most_once_for_any_size_and_gaze),
		cmocka_unit_test(standard_casts_each_pixel),
		cmocka_unit_test(acuity_is_never_coarser_than_the_eye_resolves),
		cmocka_unit_test(acuity_is_full_resolution_where_the_display_limits_the_eye),
		cmocka_unit_test(fovea_is_whole_on_a_fine_display),
		cmocka_unit_test(acuity_takes_few_rays),
		cmocka_unit_test(mdc_casts_a_quarter_outside_its_square),
		cmocka_unit_test(distance_rule_lengthens_steps_up_to_its_floor),
		cmocka_unit_test(plan_refuses_what_is_out_of_range),
		cmocka_unit_test(plan_does_not_depend_on_the_locale),
		cmocka_unit_test(trembling_gaze_moves_no_lattice),
		cmocka_unit_test(rectangles_are_nested_and_as_fine_as_the_tiles),
		cmocka_unit_test(rectangles_are_coarser_away_from_the_gaze),
		cmocka_unit_test(each_method_is_planned_in_one_way_and_found_by_its_name),
		cmocka_unit_test(phases_of_a_tile_are_sixteen_and_neighbours_share_no_quarter),
		cmocka_unit_test(only_longer_steps_are_interleaved),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
