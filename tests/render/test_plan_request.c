/* How a budget, a lost gaze, sampling rates and repetition change a plan. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <string.h>

#include "render/picture/image.h"
#include "render/plan/method.h"
#include "render/plan/plan_context.h"
#include "small_scene.h"

enum { WIDTH = 1920, HEIGHT = 1080 };

static const struct gz_point centre = { 0.5F, 0.45F };

struct fixture {
	struct gz_foveation foveation;
	struct gz_display display;
	struct gz_plan_request request;
	struct gz_plan plan;
};

static void begin(struct fixture *f, int method, int width, int height)
{
	memset(f, 0, sizeof *f);
	f->foveation = small_scene_foveation();
	f->foveation.method = method;
	f->display = gz_display_default(width, height);
	f->request = gz_plan_request_make(&f->foveation, &f->display, centre, width, height);
}

static uint64_t rays(struct fixture *f)
{
	assert_int_equal(gz_plan_update(&f->request, &f->plan), GZ_OK);
	return f->plan.ray_count;
}

static double tile_spacing(const struct gz_plan *plan, const struct gz_tile *tile)
{
	return plan->layers[tile->layer].spacing *
	       (tile->pattern == GZ_TILE_QUINCUNX ? M_SQRT2 : 1);
}

/* Coarsest spacing and longest step of tiles that begin within some degrees of the gaze. */
static void most_within(const struct fixture *f, double deg, double *out_spacing, double *out_step)
{
	*out_spacing = 0;
	*out_step = 0;
	for (size_t i = 0; i < f->plan.tile_count; i++) {
		const struct gz_tile *tile = &f->plan.tiles[i];
		const struct gz_point at = { (tile->x + 0.5F) / (float)f->plan.width,
					     (tile->y + 0.5F) / (float)f->plan.height };
		if (!(gz_display_angle_deg(&f->display, f->request.gaze, at) < deg))
			continue;
		*out_spacing = fmax(*out_spacing, tile_spacing(&f->plan, tile));
		*out_step = fmax(*out_step, (double)f->plan.steps[tile->step]);
	}
}

static void greater_scale_never_costs_more_rays(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_TABLE,   GZ_METHOD_MDC,
				       GZ_METHOD_MDC3,   GZ_METHOD_UNIFORM, GZ_METHOD_DDC };
	for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
		struct fixture f;
		begin(&f, methods[m], WIDTH, HEIGHT);
		const uint64_t first = rays(&f);
		uint64_t before = first;
		for (double scale = 1; scale <= GZ_PLAN_SCALE_MAX; scale *= M_SQRT2) {
			f.request.scale = fmin(scale, GZ_PLAN_SCALE_MAX);
			const uint64_t now = rays(&f);
			if (now > before)
				fail_msg("%s at scale %g: %llu rays, %llu before",
					 gz_method_names[methods[m]], scale,
					 (unsigned long long)now, (unsigned long long)before);
			before = now;
		}
		if (before * 4 > first)
			fail_msg("%s: scale %d leaves %llu of %llu rays",
				 gz_method_names[methods[m]], GZ_PLAN_SCALE_MAX,
				 (unsigned long long)before, (unsigned long long)first);
		gz_plan_free(&f.plan);
	}
}

/* Until every pixel has a ray of the scene's own step; regions stay as their methods have them. */
static void finer_request_never_costs_fewer_rays(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_CONTRAST, GZ_METHOD_TABLE };
	for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++)
		for (int lost = 0; lost < 2; lost++) {
			struct fixture f;
			begin(&f, methods[m], WIDTH, HEIGHT);
			f.request.scale = 1.5;
			f.request.widen = 0.5 * lost;
			uint64_t before = rays(&f);
			assert_false(gz_plan_is_whole(&f.plan));
			for (f.request.finer = 1; f.request.finer < 64; f.request.finer *= 1.1) {
				const uint64_t now = rays(&f);
				if (now < before)
					fail_msg("%s, finer by %g: %llu rays, %llu before",
						 gz_method_names[methods[m]], f.request.finer,
						 (unsigned long long)now,
						 (unsigned long long)before);
				before = now;
			}
			f.request.finer = GZ_PLAN_FINER_MAX;
			/* Some lie beyond the picture's edges. */
			assert_true(rays(&f) >= (uint64_t)WIDTH * HEIGHT && rays(&f) >= before);
			assert_true(gz_plan_is_whole(&f.plan));
			/* A table says how long steps are, whatever the spacing. */
			assert_true(gz_plan_is_exact(&f.plan) == (methods[m] != GZ_METHOD_TABLE));
			gz_plan_free(&f.plan);
		}
}

/* Whether tiles stay where the gaze moves, if every pixel has a ray. */
static void finest_plan_follows_the_gaze_where_it_depends_on_it(void **state)
{
	(void)state;
	static const struct {
		int method, step_rule;
		bool stays;
	} cases[] = {
		{ GZ_METHOD_ACUITY, GZ_STEP_METHOD, true },
		{ GZ_METHOD_CONTRAST, GZ_STEP_METHOD, true },
		{ GZ_METHOD_ACUITY, GZ_STEP_DISTANCE, false },
		{ GZ_METHOD_TABLE, GZ_STEP_METHOD, false },
		{ GZ_METHOD_TABLE, GZ_STEP_NONE, true },
		{ GZ_METHOD_DDC, GZ_STEP_METHOD, false },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct fixture f;
		begin(&f, cases[i].method, WIDTH, HEIGHT);
		f.foveation.step_rule = cases[i].step_rule;
		f.request.finer = GZ_PLAN_FINER_MAX;
		rays(&f);
		const uint64_t serial = f.plan.serial;
		f.request.gaze.x = 0.8F;
		rays(&f);
		if ((f.plan.serial == serial) != cases[i].stays)
			fail_msg("case %zu", i);
		assert_true(gz_plan_can_grow(&f.foveation) == cases[i].stays);
		gz_plan_free(&f.plan);
	}
}

/* Twice as fine: the widest spacing is half as wide. */
static void finer_request_divides_spacings(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, WIDTH, HEIGHT);
	rays(&f);
	double spacing, step, finer_spacing, finer_step;
	most_within(&f, 180, &spacing, &step);
	f.request.finer = 2;
	rays(&f);
	most_within(&f, 180, &finer_spacing, &finer_step);
	assert_true(finer_spacing == spacing / 2);
	assert_true(finer_step < step);
	assert_false(gz_plan_is_whole(&f.plan));
	gz_plan_free(&f.plan);
}

/* Longer steps by another rule: every pixel has a ray, but the picture is not that of standard. */
static void whole_plan_with_longer_steps_is_not_exact(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_STANDARD, WIDTH, HEIGHT);
	rays(&f);
	assert_true(gz_plan_is_exact(&f.plan));
	f.foveation.step_rule = GZ_STEP_DISTANCE;
	rays(&f);
	assert_true(gz_plan_is_whole(&f.plan));
	assert_false(gz_plan_is_exact(&f.plan));
	gz_plan_free(&f.plan);
}

static void fovea_gives_way_last(void **state)
{
	(void)state;
	struct fixture f;
	double spacing, step;
	begin(&f, GZ_METHOD_ACUITY, WIDTH, HEIGHT);
	f.request.scale = GZ_PLAN_SCALE_OUTSIDE;
	rays(&f);
	most_within(&f, 2.5, &spacing, &step);
	if (spacing > 1 || step > 1)
		fail_msg("scale %g: spacing %g, step %g in the fovea", f.request.scale, spacing,
			 step);
	f.request.scale = GZ_PLAN_SCALE_MAX;
	rays(&f);
	most_within(&f, 2.5, &spacing, &step);
	if (spacing < 4)
		fail_msg("scale %g: still spacing %g in the fovea", f.request.scale, spacing);
	gz_plan_free(&f.plan);
}

static void standard_ignores_scale_and_widening(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_STANDARD, 317, 203);
	f.request.scale = GZ_PLAN_SCALE_MAX;
	f.request.widen = 1;
	assert_int_equal(rays(&f), 317 * 203);
	gz_plan_free(&f.plan);
}

static void widened_plan_is_uniform_and_costs_no_more(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_TABLE, GZ_METHOD_MDC,
				       GZ_METHOD_MDC3, GZ_METHOD_DDC };
	for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
		struct fixture f;
		begin(&f, methods[m], WIDTH, HEIGHT);
		const double narrow = (double)rays(&f);
		f.request.widen = 1;
		const double wide = (double)rays(&f);
		/* a rung is a factor of two in rays, and so is half of a spacing of 1 */
		if (wide > narrow * 1.03 || wide < narrow * 0.4)
			fail_msg("%s: %g rays became %g", gz_method_names[methods[m]], narrow,
				 wide);
		const double spacing = tile_spacing(&f.plan, &f.plan.tiles[0]);
		for (size_t i = 0; i < f.plan.tile_count; i++)
			if (tile_spacing(&f.plan, &f.plan.tiles[i]) != spacing)
				fail_msg("%s: tile %zu has spacing %g, not %g",
					 gz_method_names[methods[m]], i,
					 tile_spacing(&f.plan, &f.plan.tiles[i]), spacing);
		gz_plan_free(&f.plan);
	}
}

static void widening_keeps_the_cost_on_its_way(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, WIDTH, HEIGHT);
	const double narrow = (double)rays(&f);
	for (int i = 1; i < 20; i++) {
		f.request.widen = i / 20.0;
		const double now = (double)rays(&f);
		if (now > narrow * 1.25 || now < narrow * 0.4)
			fail_msg("widen %g: %g rays, %g without", f.request.widen, now, narrow);
	}
	gz_plan_free(&f.plan);
}

static void sizes_in_pixels_do_not_change_with_the_sampling_rate(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_MDC3, 1600, 1200);
	f.foveation.blend_px = 20;
	rays(&f);
	const struct gz_plan_layer layers[2] = { f.plan.layers[0], f.plan.layers[1] };
	f.request.width *= 2;
	f.request.height *= 2;
	f.request.rays_per_px = 2;
	rays(&f);
	for (int i = 0; i < 2; i++) {
		const struct gz_region *region = &f.plan.layers[i].region;
		assert_true(region->half_px[0] == 2 * layers[i].region.half_px[0]);
		assert_true(region->half_px[1] == 2 * layers[i].region.half_px[1]);
		assert_true(region->blend_px == 2 * layers[i].region.blend_px);
		assert_int_equal(f.plan.layers[i].spacing, layers[i].spacing);
	}
	gz_plan_free(&f.plan);
}

static void plan_is_made_again_only_after_a_change(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, 640, 480);
	rays(&f);
	uint64_t serial = f.plan.serial;
	assert_true(serial > 0);
	rays(&f);
	assert_int_equal(f.plan.serial, serial);
	f.request.gaze.x += 0.001F;
	rays(&f);
	assert_true(f.plan.serial > serial);
	serial = f.plan.serial;
	f.foveation.acuity_slope = 0.03;
	rays(&f);
	assert_true(f.plan.serial > serial);
	serial = f.plan.serial;
	f.display.distance_mm *= 2;
	rays(&f);
	assert_true(f.plan.serial > serial);
	serial = f.plan.serial;
	f.request.scale = 2;
	rays(&f);
	assert_true(f.plan.serial > serial);
	gz_plan_free(&f.plan);
}

static void standard_plan_does_not_depend_on_the_gaze(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_STANDARD, 640, 480);
	rays(&f);
	const uint64_t serial = f.plan.serial;
	f.request.gaze = (struct gz_point) { 0.1F, NAN };
	rays(&f);
	assert_int_equal(f.plan.serial, serial);
	/* but not where its steps follow the gaze */
	f.foveation.step_rule = GZ_STEP_DISTANCE;
	rays(&f);
	assert_true(f.plan.serial > serial);
	gz_plan_free(&f.plan);
}

static void refused_request_leaves_no_valid_plan(void **state)
{
	(void)state;
	static const double wrong[][3] = { { 0, 1, 0 },    { 1, 0.5, 0 }, { 1, 65, 0 },
					   { 1, 1, -0.1 }, { 1, 1, 1.1 }, { NAN, 1, 0 },
					   { 1, NAN, 0 },  { 1, 1, NAN }, { 17, 1, 0 } };
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, 64, 64);
	for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
		f.request.rays_per_px = wrong[i][0];
		f.request.scale = wrong[i][1];
		f.request.widen = wrong[i][2];
		assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	}
	f.request = gz_plan_request_make(&f.foveation, &f.display, centre, 64, 64);
	static const double wrong_finer[] = { 0, 0.99, 2 * GZ_PLAN_FINER_MAX, NAN };
	for (size_t i = 0; i < sizeof wrong_finer / sizeof wrong_finer[0]; i++) {
		f.request.finer = wrong_finer[i];
		assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	}
	f.request.finer = 1;
	f.foveation.method = GZ_METHOD_TABLE;
	f.foveation.table.count = 0;
	assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	gz_plan_free(&f.plan);
}

static void steps_of_a_table_are_never_longer_than_it_says(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_TABLE, WIDTH, HEIGHT);
	rays(&f);
	bool longer_than_one = false;
	for (size_t i = 0; i < f.plan.tile_count; i++) {
		const struct gz_tile *tile = &f.plan.tiles[i];
		const struct gz_point at = { (tile->x + 0.5F) / WIDTH, (tile->y + 0.5F) / HEIGHT };
		const double deg = gz_display_angle_deg(&f.display, centre, at);
		const double said = deg < 3 ? 1 : fmin(1 + (deg - 3) / 22 * 2, 3);
		const double step = (double)f.plan.steps[tile->step];
		longer_than_one |= step > 1;
		/* the last tiles of the coarsest lattices begin beyond their nearest point */
		if (step > said * 1.001)
			fail_msg("at %g degrees: step %g, table says %g", deg, step, said);
	}
	assert_true(longer_than_one);
	gz_plan_free(&f.plan);
}

static void largest_sizes_have_plans(void **state)
{
	(void)state;
	static const int sizes[][2] = { { GZ_IMAGE_SIDE_MAX, 3 }, { 2, GZ_IMAGE_SIDE_MAX } };
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
		for (int method = 0; method < GZ_METHOD_COUNT; method++) {
			struct fixture f;
			begin(&f, method, sizes[i][0], sizes[i][1]);
			assert_true(rays(&f) > 0);
			gz_plan_free(&f.plan);
		}
}

/* A share of the octaves of the longest steps; where rays go does not depend on it. */
static void steps_grow_as_fast_as_asked(void **state)
{
	(void)state;
	static const double longest[GZ_LADDER_RUNGS] = { 1, 1.4, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8 };
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_CONTRAST };
	for (int m = 0; m < 2; m++) {
		struct fixture f;
		begin(&f, methods[m], WIDTH, HEIGHT);
		const uint64_t preset = rays(&f);
		f.foveation.acuity_step_error = 1;
		for (int quarters = 0; quarters <= 4; quarters++) {
			f.foveation.acuity_step_growth = quarters / 4.0;
			assert_int_equal(rays(&f), preset);
			assert_int_equal(f.plan.step_count, GZ_LADDER_RUNGS);
			for (int i = 0; i < GZ_LADDER_RUNGS; i++) {
				const double step = (double)f.plan.steps[i];
				if (fabs(pow(step, 4) / pow(longest[i], quarters) - 1) > 1e-5)
					fail_msg("growth %d/4, rung %d: %g", quarters, i, step);
			}
		}
		gz_plan_free(&f.plan);
	}
}

/* What a technique knows of its content, unless every change is allowed. */
static void growth_of_steps_has_the_limit_of_the_content(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, WIDTH, HEIGHT);
	const uint64_t unknown = rays(&f);
	const int last = GZ_LADDER_RUNGS - 1;
	assert_true(fabs((double)f.plan.steps[last] - pow(8, GZ_PLAN_STEP_GROWTH)) < 1e-6);
	static const struct {
		double content, setting, error, wanted;
	} cases[] = {
		{ 0, 1, 0.01, 0 },    { 0.3, 1, 0.01, 0.3 }, { 1, 0.7, 0.01, 0.7 },
		{ 0.3, 0.7, 1, 0.7 }, { 1, 0, 0.01, 0 },     { 0, 1, 1, 1 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		f.request.step_growth = cases[i].content;
		f.foveation.acuity_step_growth = cases[i].setting;
		f.foveation.acuity_step_error = cases[i].error;
		assert_int_equal(rays(&f), unknown);
		assert_true(fabs((double)f.plan.steps[last] - pow(8, cases[i].wanted)) < 1e-6);
	}
	f.request.step_growth = 1.1;
	assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	f.request.step_growth = NAN;
	assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	/* The power by which the step at 8 px is the multiplier. */
	assert_true(gz_plan_step_growth(0) == 0 && gz_plan_step_growth(1) == 0);
	assert_true(fabs(gz_plan_step_growth(2) - 0.5) < 1e-9);
	assert_true(gz_plan_step_growth(4) == 1 && gz_plan_step_growth(1e9) == 1);
	f.foveation = gz_foveation_default();
	assert_true(gz_plan_steps_by_acuity(&f.foveation));
	f.foveation.step_rule = GZ_STEP_NONE;
	assert_false(gz_plan_steps_by_acuity(&f.foveation));
	gz_plan_free(&f.plan);
}

/* An eye in the volume has rays close together and steps as the scene's; nothing else changes. */
static void bound_on_steps_shortens_acuity_steps_and_moves_no_ray(void **state)
{
	(void)state;
	struct fixture f;
	begin(&f, GZ_METHOD_ACUITY, WIDTH, HEIGHT);
	const uint64_t unbounded = rays(&f), serial = f.plan.serial;
	float longest[GZ_PLAN_STEPS_MAX];
	memcpy(longest, f.plan.steps, sizeof longest);
	const int count = f.plan.step_count;
	assert_true(longest[count - 1] > 2);
	for (int exponent = -5; exponent <= 0; exponent++) {
		f.request.steps_per_px = ldexp(1, exponent);
		assert_int_equal(rays(&f), unbounded);
		assert_int_equal(f.plan.step_count, count);
		for (int i = 0; i < count; i++) {
			const double most = fmax(1, f.request.steps_per_px * gz_ladder_px[i]);
			const double wanted = fmin((double)longest[i], most);
			if (fabs((double)f.plan.steps[i] - wanted) > 1e-6)
				fail_msg("2^%d, rung %d: %g, not %g", exponent, i,
					 (double)f.plan.steps[i], wanted);
		}
	}
	assert_int_not_equal(f.plan.serial, serial);
	f.request.steps_per_px = 0;
	rays(&f);
	for (int i = 0; i < count; i++)
		assert_true(f.plan.steps[i] == 1);
	/* What a user's table or Bauer's rule says stays. */
	f.foveation.step_rule = GZ_STEP_DISTANCE;
	rays(&f);
	assert_true(f.plan.steps[f.plan.step_count - 1] > 3);
	f.request.steps_per_px = 1.5;
	assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	f.request.steps_per_px = NAN;
	assert_int_equal(gz_plan_update(&f.request, &f.plan), GZ_ERR_INVAL);
	gz_plan_free(&f.plan);
}

TEST_SUITE(plan_request)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_grow_as_fast_as_asked),
		cmocka_unit_test(growth_of_steps_has_the_limit_of_the_content),
		cmocka_unit_test(bound_on_steps_shortens_acuity_steps_and_moves_no_ray),
		cmocka_unit_test(greater_scale_never_costs_more_rays),
		cmocka_unit_test(finer_request_never_costs_fewer_rays),
		cmocka_unit_test(finest_plan_follows_the_gaze_where_it_depends_on_it),
		cmocka_unit_test(finer_request_divides_spacings),
		cmocka_unit_test(whole_plan_with_longer_steps_is_not_exact),
		cmocka_unit_test(fovea_gives_way_last),
		cmocka_unit_test(standard_ignores_scale_and_widening),
		cmocka_unit_test(widened_plan_is_uniform_and_costs_no_more),
		cmocka_unit_test(widening_keeps_the_cost_on_its_way),
		cmocka_unit_test(sizes_in_pixels_do_not_change_with_the_sampling_rate),
		cmocka_unit_test(plan_is_made_again_only_after_a_change),
		cmocka_unit_test(standard_plan_does_not_depend_on_the_gaze),
		cmocka_unit_test(refused_request_leaves_no_valid_plan),
		cmocka_unit_test(steps_of_a_table_are_never_longer_than_it_says),
		cmocka_unit_test(largest_sizes_have_plans),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
