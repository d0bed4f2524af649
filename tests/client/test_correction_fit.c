/* The correction: exact if the errors allow it, and not claimed to help if they do not. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "client/gazectl/validate/correction.h"

#define CHECK_NEAR(got, wanted, within)                                          \
	do {                                                                     \
		double g_ = (got), w_ = (wanted);                                \
		if (!(fabs(g_ - w_) <= (within)))                                \
			fail_msg("%s is %.9g, not %.9g within %g", #got, g_, w_, \
				 (double)(within));                              \
	} while (0)

static const struct gz_display display = { { 1000, 1000 }, { 1000, 1000 }, 1000 };

static const struct gz_correct_params identity = { { 0, 1, 0 }, { 0, 0, 1 } };

/* The inverse of @map, by Cramer's rule. */
static struct gz_correct_params inverse_of(const struct gz_correct_params *map)
{
	const double *x = map->x, *y = map->y;
	double area = x[1] * y[2] - x[2] * y[1];
	return (struct gz_correct_params) {
		{ (x[2] * y[0] - y[2] * x[0]) / area, y[2] / area, -x[2] / area },
		{ (y[1] * x[0] - x[1] * y[0]) / area, -y[1] / area, x[1] / area },
	};
}

/* Three by three targets, measured with @error. */
static size_t grid(struct gz_fit_pair *pairs, const struct gz_correct_params *error)
{
	size_t n = 0;
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++) {
			struct gz_point target = { 0.1f + 0.4f * (float)column,
						   0.1f + 0.4f * (float)row };
			pairs[n++] =
				(struct gz_fit_pair) { target, gz_correct_point(error, target) };
		}
	return n;
}

static void check_map(const struct gz_correct_params *got, const struct gz_correct_params *wanted,
		      double within)
{
	for (int i = 0; i < 3; i++) {
		CHECK_NEAR(got->x[i], wanted->x[i], within);
		CHECK_NEAR(got->y[i], wanted->y[i], within);
	}
}

static void an_affine_error_is_undone_exactly(void **state)
{
	(void)state;
	const struct gz_correct_params error = { { 0.02, 1.06, -0.03 }, { -0.01, 0.04, 0.93 } };
	struct gz_correct_params wanted = inverse_of(&error);
	struct gz_fit_pair pairs[9];
	struct gz_fit fit;
	gz_fit_correction(&display, pairs, grid(pairs, &error), &fit);
	assert_int_equal(fit.model, GZ_FIT_AFFINE);
	assert_int_equal(fit.used_count, 9);
	check_map(&fit.map, &wanted, 1e-6);
	assert_true(fit.before_deg > 1);
	CHECK_NEAR(fit.after_deg, 0, 1e-4);
	CHECK_NEAR(fit.cross_deg, 0, 1e-4);
	assert_true(fit.helps);
}

static void no_error_needs_no_correction(void **state)
{
	(void)state;
	struct gz_fit_pair pairs[9];
	struct gz_fit fit;
	gz_fit_correction(&display, pairs, grid(pairs, &identity), &fit);
	check_map(&fit.map, &identity, 1e-6);
	assert_false(fit.helps);
}

/* Errors without a pattern: a map that follows them does not predict the next one. */
static void errors_without_a_rule_are_not_corrected(void **state)
{
	(void)state;
	static const float noise[9][2] = {
		{ 0.010f, -0.004f },  { -0.012f, 0.008f }, { 0.003f, 0.011f },
		{ -0.009f, -0.010f }, { 0.011f, 0.002f },  { -0.005f, -0.012f },
		{ 0.007f, 0.009f },   { 0.012f, -0.007f }, { -0.011f, 0.004f },
	};
	struct gz_fit_pair pairs[9];
	struct gz_fit fit;
	size_t count = grid(pairs, &identity);
	for (size_t i = 0; i < count; i++) {
		pairs[i].seen.x += noise[i][0];
		pairs[i].seen.y += noise[i][1];
	}
	gz_fit_correction(&display, pairs, count, &fit);
	assert_true(fit.after_deg <= fit.before_deg * 1.01); /* it follows the noise */
	assert_true(fit.cross_deg >= fit.before_deg * 0.9);  /* which does not help */
	assert_false(fit.helps);
}

static void a_target_that_nobody_looked_at_is_left_out(void **state)
{
	(void)state;
	const struct gz_correct_params error = { { 0.02, 1.03, 0 }, { 0.03, 0, 0.97 } };
	struct gz_correct_params wanted = inverse_of(&error);
	for (size_t bad = 0; bad < 9; bad++) {
		struct gz_fit_pair pairs[9];
		struct gz_fit fit;
		size_t count = grid(pairs, &error);
		pairs[bad].seen.x += 0.3f;
		pairs[bad].seen.y -= 0.1f;
		gz_fit_correction(&display, pairs, count, &fit);
		if (fit.used[bad] || fit.used_count != 8)
			fail_msg("target %zu is in, or %zu of 9 are", bad, fit.used_count);
		check_map(&fit.map, &wanted, 1e-5);
		assert_true(fit.helps);
	}
}

static void leave_one_out_of_three_shifts_is_as_by_hand(void **state)
{
	(void)state;
	struct gz_point middle = { 0.5f, 0.5f };
	const struct gz_fit_pair pairs[3] = {
		{ middle, { 0.49f, 0.5f } },
		{ middle, { 0.48f, 0.5f } },
		{ middle, { 0.47f, 0.5f } },
	};
	struct gz_fit fit;
	gz_fit_correction(&display, pairs, 3, &fit);
	assert_int_equal(fit.model, GZ_FIT_SHIFT);
	CHECK_NEAR(fit.map.x[0], 0.02, 1e-6);
	CHECK_NEAR(fit.map.y[0], 0, 1e-6);
	/* The shifts from the other two are 25, 20 and 15 mm: the errors left are 15, 0 and 15 mm
	 * at 1 m. */
	CHECK_NEAR(fit.cross_deg, 2.0 / 3 * atan(0.015) * 57.29577951308232, 1e-4);
	CHECK_NEAR(fit.after_deg, 2.0 / 3 * atan(0.010) * 57.29577951308232, 1e-4);
	assert_true(fit.helps);
}

static void targets_in_a_line_allow_a_shift_only(void **state)
{
	(void)state;
	struct gz_fit_pair pairs[9];
	for (int i = 0; i < 9; i++) {
		struct gz_point target = { 0.1f + 0.1f * (float)i, 0.2f + 0.05f * (float)i };
		pairs[i] = (struct gz_fit_pair) { target, { target.x + 0.03f, target.y - 0.02f } };
	}
	struct gz_fit fit;
	gz_fit_correction(&display, pairs, 9, &fit);
	assert_int_equal(fit.model, GZ_FIT_SHIFT);
	CHECK_NEAR(fit.map.x[0], -0.03, 1e-6);
	CHECK_NEAR(fit.map.y[0], 0.02, 1e-6);
	assert_true(fit.map.x[1] == 1 && fit.map.x[2] == 0);
	assert_true(fit.map.y[1] == 0 && fit.map.y[2] == 1);
	assert_true(fit.helps);
}

static void targets_close_together_allow_a_shift_only(void **state)
{
	(void)state;
	struct gz_fit_pair pairs[9];
	size_t count = grid(pairs, &identity);
	for (size_t i = 0; i < count; i++) {
		pairs[i].target.x = 0.5f + (pairs[i].target.x - 0.5f) / 20;
		pairs[i].target.y = 0.5f + (pairs[i].target.y - 0.5f) / 20;
		pairs[i].seen = (struct gz_point) { pairs[i].target.x * 1.5f, pairs[i].target.y };
	}
	struct gz_fit fit;
	gz_fit_correction(&display, pairs, count, &fit);
	assert_int_equal(fit.model, GZ_FIT_SHIFT);
}

static void too_few_targets_give_no_map(void **state)
{
	(void)state;
	const struct gz_fit_pair pairs[2] = {
		{ { 0.1f, 0.1f }, { 0.2f, 0.1f } },
		{ { 0.9f, 0.9f }, { 1.0f, 0.9f } },
	};
	struct gz_fit fit;
	for (size_t count = 0; count <= 2; count++) {
		gz_fit_correction(&display, pairs, count, &fit);
		assert_int_equal(fit.model, GZ_FIT_NONE);
		assert_memory_equal(&fit.map, &identity, sizeof identity);
		assert_false(fit.helps);
		assert_true(isnan(fit.cross_deg));
		assert_true(isnan(fit.before_deg) == (count == 0));
	}
}

static void targets_that_were_not_seen_do_not_count(void **state)
{
	(void)state;
	const struct gz_correct_params error = { { 0.02, 1.03, 0 }, { 0.03, 0, 0.97 } };
	struct gz_correct_params wanted = inverse_of(&error);
	struct gz_fit_pair pairs[9];
	struct gz_fit fit;
	size_t count = grid(pairs, &error);
	pairs[0].seen = (struct gz_point) { NAN, NAN };
	pairs[4].seen = (struct gz_point) { 0.5f, INFINITY };
	gz_fit_correction(&display, pairs, count, &fit);
	assert_int_equal(fit.used_count, 7);
	assert_false(fit.used[0] || fit.used[4]);
	check_map(&fit.map, &wanted, 1e-5);
	for (size_t i = 0; i < count; i++)
		pairs[i].seen.x = NAN;
	gz_fit_correction(&display, pairs, count, &fit);
	assert_int_equal(fit.model, GZ_FIT_NONE);
	assert_memory_equal(&fit.map, &identity, sizeof identity);
}

static void all_seen_in_one_place_gives_a_shift_that_does_not_help(void **state)
{
	(void)state;
	struct gz_fit_pair pairs[9];
	struct gz_fit fit;
	size_t count = grid(pairs, &identity);
	for (size_t i = 0; i < count; i++)
		pairs[i].seen = (struct gz_point) { 0.5f, 0.5f };
	gz_fit_correction(&display, pairs, count, &fit);
	assert_int_equal(fit.model, GZ_FIT_SHIFT);
	assert_false(fit.helps);
}

static void more_targets_than_there_is_room_for_are_not_looked_at(void **state)
{
	(void)state;
	static struct gz_fit_pair pairs[GZ_FIT_TARGETS_MAX + 10];
	static struct gz_fit fit;
	for (size_t i = 0; i < GZ_FIT_TARGETS_MAX + 10; i++) {
		struct gz_point target = { (float)(i % 16) / 16, (float)(i / 16) / 18 };
		pairs[i] = (struct gz_fit_pair) { target, { target.x + 0.05f, target.y } };
	}
	gz_fit_correction(&display, pairs, GZ_FIT_TARGETS_MAX + 10, &fit);
	assert_int_equal(fit.used_count, GZ_FIT_TARGETS_MAX);
	CHECK_NEAR(fit.map.x[0], -0.05, 1e-5);
}

static void composed_map_does_both_in_turn(void **state)
{
	(void)state;
	const struct gz_correct_params first = { { 0.1, 1.2, 0.3 }, { -0.2, 0.1, 0.9 } };
	const struct gz_correct_params second = { { -0.05, 0.8, -0.1 }, { 0.3, 0.2, 1.1 } };
	struct gz_correct_params both = gz_fit_compose(&first, &second);
	struct gz_point p = { 0.3f, 0.8f };
	struct gz_point q = gz_correct_point(&second, gz_correct_point(&first, p));
	struct gz_point r = gz_correct_point(&both, p);
	CHECK_NEAR(r.x, q.x, 1e-6);
	CHECK_NEAR(r.y, q.y, 1e-6);
	both = gz_fit_compose(&identity, &second);
	assert_memory_equal(&both, &second, sizeof both);
}

TEST_SUITE(correction_fit)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_affine_error_is_undone_exactly),
		cmocka_unit_test(no_error_needs_no_correction),
		cmocka_unit_test(errors_without_a_rule_are_not_corrected),
		cmocka_unit_test(a_target_that_nobody_looked_at_is_left_out),
		cmocka_unit_test(leave_one_out_of_three_shifts_is_as_by_hand),
		cmocka_unit_test(targets_in_a_line_allow_a_shift_only),
		cmocka_unit_test(targets_close_together_allow_a_shift_only),
		cmocka_unit_test(too_few_targets_give_no_map),
		cmocka_unit_test(targets_that_were_not_seen_do_not_count),
		cmocka_unit_test(all_seen_in_one_place_gives_a_shift_that_does_not_help),
		cmocka_unit_test(more_targets_than_there_is_room_for_are_not_looked_at),
		cmocka_unit_test(composed_map_does_both_in_turn),
	};
	return cmocka_run_group_tests_name("client.correction_fit", tests, NULL, NULL);
}
