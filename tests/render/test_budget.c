/* A time to keep, against models of what frames cost. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "render/attention/budget.h"
#include "render/plan/method.h"
#include "render/plan/plan.h"
#include "sim/random.h"

/* ms = fixed + rays * each: rays of the fovea stay, the others go with the scale's square. */
struct cost {
	double fixed_ms;
	double fovea_ms;   /* rays in the fovea, as ms */
	double outside_ms; /* the others at full detail */
	double jitter;     /* frames vary by up to this share */
	double outliers;   /* share of frames that take twice as long */
};

static double cost_ms(const struct cost *cost, double scale, struct gz_random *random)
{
	double ms = cost->fixed_ms + cost->fovea_ms + cost->outside_ms / (scale * scale);
	ms *= 1 + cost->jitter * (2 * gz_random_uniform(random) - 1);
	return gz_random_uniform(random) < cost->outliers ? 2 * ms : ms;
}

struct run {
	int changes;   /* of the scale */
	int over;      /* frames above the budget */
	int last_over; /* the last of them; -1: none */
	double least, greatest;
	int told; /* that the budget is out of reach */
};

static struct run run(struct gz_budget *budget, const struct cost *cost, int frames,
		      struct gz_random *random)
{
	struct run run = { .last_over = -1, .least = INFINITY };
	double before = gz_budget_scale(budget);
	for (int i = 0; i < frames; i++) {
		double scale = gz_budget_scale(budget), ms = cost_ms(cost, scale, random);
		run.changes += scale != before;
		if (ms > budget->budget_ms) {
			run.over++;
			run.last_over = i;
		}
		run.least = fmin(run.least, scale);
		run.greatest = fmax(run.greatest, scale);
		before = scale;
		run.told += gz_budget_step(budget, ms);
	}
	return run;
}

static void without_a_budget_detail_is_always_full(void **state)
{
	(void)state;
	struct gz_budget budget;
	gz_budget_init(&budget, 0);
	for (int i = 0; i < 100; i++) {
		assert_false(gz_budget_step(&budget, 1e6));
		assert_true(gz_budget_scale(&budget) == 1);
	}
	assert_int_equal(budget.state, GZ_BUDGET_OFF);
}

static void frames_within_the_budget_stay_at_full_detail(void **state)
{
	(void)state;
	struct gz_budget budget;
	struct gz_random random;
	const struct cost cost = { 1, 1, 7, 0.05, 0.01 };
	random = gz_random_seeded(1, 0);
	gz_budget_init(&budget, 10);
	struct run held = run(&budget, &cost, 2000, &random);
	assert_true(held.greatest == 1);
	assert_int_equal(held.changes, 0);
}

static void slower_scene_gets_coarser_within_a_few_frames(void **state)
{
	(void)state;
	for (int times = 2; times <= 8; times++) {
		struct gz_budget budget;
		struct gz_random random;
		const struct cost cheap = { 1, 1, 7, 0.05, 0 };
		const struct cost dear = { 1, 1, 8.0 * times, 0.05, 0 };
		random = gz_random_seeded((uint64_t)times, 0);
		gz_budget_init(&budget, 10);
		run(&budget, &cheap, 100, &random);
		struct run answer = run(&budget, &dear, 400, &random);
		if (answer.over > 9 || answer.last_over > 12 || answer.told)
			fail_msg("%d times as dear: %d frames over, the last was %d", times,
				 answer.over, answer.last_over);
	}
}

static void percentile_is_kept_and_the_scale_comes_to_rest(void **state)
{
	(void)state;
	for (int k = 0; k < 60; k++) {
		struct gz_budget budget;
		struct gz_random random;
		const struct cost cost = { 0.2 * (k % 5), 0.5 * (k % 4), 5.0 + 3 * k,
					   0.02 * (k % 6), 0.01 * (k % 3) };
		random = gz_random_seeded((uint64_t)k, 0);
		gz_budget_init(&budget, 10);
		struct run first = run(&budget, &cost, 200, &random);
		struct run later = run(&budget, &cost, 2000, &random);
		if (later.over > 2000 / 20 || later.changes > (cost.outliers > 0 ? 8 : 2))
			fail_msg("model %d: first %d changes; then %d of 2000 frames over, %d "
				 "changes between %g and %g",
				 k, first.changes, later.over, later.changes, later.least,
				 later.greatest);
		/* Nor does it waste what there is: within two rungs of what would be enough. */
		double enough = cost.outside_ms / (10 - cost.fixed_ms - cost.fovea_ms);
		if (later.least > 1 && later.least > 1.9 * sqrt(enough) * (1 + cost.jitter))
			fail_msg("model %d: %g, though %g would do", k, later.least, sqrt(enough));
	}
}

/* The plan's own rays, 150 ns each, the gaze on its way about the picture. */
static void plans_of_every_method_keep_the_budget_while_the_gaze_moves(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_MDC, GZ_METHOD_DDC,
				       GZ_METHOD_MDC3 };
	const struct gz_display display = gz_display_default(960, 540);
	for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
		struct gz_foveation foveation = gz_foveation_default();
		struct gz_plan plan = { 0 };
		struct gz_budget budget;
		int over = 0, changes = 0;
		double full_ms = 0, before = 1;
		foveation.method = methods[m];
		for (int i = -1; i < 600; i++) {
			struct gz_point gaze = { 0.5f + 0.4f * (float)sin(i * 0.02),
						 0.5f + 0.3f * (float)sin(i * 0.031) };
			struct gz_plan_request request =
				gz_plan_request_make(&foveation, &display, gaze, 960, 540);
			request.scale = i < 0 ? 1 : gz_budget_scale(&budget);
			assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
			double ms = 0.2 + (double)plan.ray_count * 1.5e-4;
			if (i < 0) {
				full_ms = ms;
				gz_budget_init(&budget, full_ms / 2);
				continue;
			}
			over += i >= 60 && ms > full_ms / 2;
			changes += gz_budget_scale(&budget) != before;
			before = gz_budget_scale(&budget);
			assert_false(gz_budget_step(&budget, ms));
		}
		gz_plan_free(&plan);
		if (over > 540 / 20 || changes > (methods[m] == GZ_METHOD_ACUITY ? 4 : 20))
			fail_msg("%s: %d of 540 frames over, %d changes, %g at last",
				 gz_method_names[methods[m]], over, changes, before);
	}
}

static void faster_scene_regains_its_detail(void **state)
{
	(void)state;
	struct gz_budget budget;
	struct gz_random random;
	const struct cost dear = { 1, 1, 100, 0.05, 0 }, cheap = { 1, 1, 4, 0.05, 0 };
	random = gz_random_seeded(5, 0);
	gz_budget_init(&budget, 10);
	for (int round = 0; round < 5; round++) {
		run(&budget, &dear, 300, &random);
		assert_true(gz_budget_scale(&budget) > 3);
		struct run back = run(&budget, &cheap, 300, &random);
		if (gz_budget_scale(&budget) != 1 || back.over > 0)
			fail_msg("round %d: %g after 300 cheap frames", round,
				 gz_budget_scale(&budget));
	}
}

/* Spacings of whole pixels: a rung finer may cost twice as much, which no rule foresees. */
static double stair_ms(double scale)
{
	double spacing = floor(2 * scale);
	return 1 + 80 / (spacing * spacing);
}

static void failing_trials_become_rarer(void **state)
{
	(void)state;
	struct gz_budget budget;
	gz_budget_init(&budget, 9); /* 21 at spacing 2, 9.9 at 3, 6 at 4 */
	int over = 0, late_over = 0;
	for (int i = 0; i < 20000; i++) {
		double ms = stair_ms(gz_budget_scale(&budget));
		over += ms > 9;
		late_over += ms > 9 && i > 10000;
		assert_false(gz_budget_step(&budget, ms));
	}
	assert_in_range(over, 3, 60);
	assert_in_range(late_over, 0, 12);
}

static void unreachable_budget_is_reported_once(void **state)
{
	(void)state;
	struct gz_budget budget;
	struct gz_random random;
	const struct cost cost = { 20, 1, 50, 0.05, 0 }, cheap = { 1, 1, 1, 0, 0 };
	random = gz_random_seeded(9, 0);
	gz_budget_init(&budget, 10);
	struct run held = run(&budget, &cost, 1000, &random);
	assert_int_equal(held.told, 1);
	assert_int_equal(budget.state, GZ_BUDGET_LIMIT);
	assert_true(gz_budget_scale(&budget) == GZ_BUDGET_SCALE_MAX);
	struct run back = run(&budget, &cheap, 500, &random);
	assert_true(gz_budget_scale(&budget) == 1);
	assert_int_equal(budget.state, GZ_BUDGET_WITHIN);
	struct run again = run(&budget, &cost, 1000, &random);
	assert_int_equal(back.told + again.told, 0);
	assert_int_equal(budget.state, GZ_BUDGET_LIMIT);
}

static void budget_rests_after_a_window_without_a_finer_rung(void **state)
{
	(void)state;
	struct gz_budget budget;
	gz_budget_init(&budget, 10);
	assert_true(gz_budget_at_rest(&budget));
	for (int i = 0; i < 3; i++)
		gz_budget_step(&budget, 15);
	assert_true(gz_budget_scale(&budget) > 1);
	for (int i = 0; i < GZ_BUDGET_WINDOW; i++) {
		assert_false(gz_budget_at_rest(&budget));
		gz_budget_step(&budget, 8);
	}
	assert_true(gz_budget_scale(&budget) > 1);
	assert_true(gz_budget_at_rest(&budget));
	gz_budget_init(&budget, 0);
	assert_true(gz_budget_at_rest(&budget));
}

static void invalid_times_are_ignored(void **state)
{
	(void)state;
	struct gz_budget budget;
	gz_budget_init(&budget, 10);
	for (int i = 0; i < 100; i++) {
		gz_budget_step(&budget, NAN);
		gz_budget_step(&budget, INFINITY);
		gz_budget_step(&budget, -1);
	}
	assert_true(gz_budget_scale(&budget) == 1);
	assert_int_equal(budget.state, GZ_BUDGET_WITHIN);
	gz_budget_step(&budget, 11);
	assert_int_equal(budget.state, GZ_BUDGET_OVER);
}

static void one_slow_frame_in_a_second_changes_nothing(void **state)
{
	(void)state;
	struct gz_budget budget;
	gz_budget_init(&budget, 10);
	for (int i = 0; i < 6000; i++)
		gz_budget_step(&budget, i % 30 == 7 ? 80 : 8);
	assert_true(gz_budget_scale(&budget) == 1);
}

TEST_SUITE(budget)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_budget_detail_is_always_full),
		cmocka_unit_test(frames_within_the_budget_stay_at_full_detail),
		cmocka_unit_test(slower_scene_gets_coarser_within_a_few_frames),
		cmocka_unit_test(percentile_is_kept_and_the_scale_comes_to_rest),
		cmocka_unit_test(plans_of_every_method_keep_the_budget_while_the_gaze_moves),
		cmocka_unit_test(faster_scene_regains_its_detail),
		cmocka_unit_test(failing_trials_become_rarer),
		cmocka_unit_test(unreachable_budget_is_reported_once),
		cmocka_unit_test(budget_rests_after_a_window_without_a_finer_rung),
		cmocka_unit_test(invalid_times_are_ignored),
		cmocka_unit_test(one_slow_frame_in_a_second_changes_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
