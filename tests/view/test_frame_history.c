/* Costs of the last frames: newest first, oldest dropped, quantiles. */
#include "suite.h"

#include <math.h>

#include "view/frame/stats.h"

static void add(struct gz_frame_history *history, double cast_ms)
{
	const struct gz_frame_cost cost = {
		.shown_ns = 1,
		.ms = { [GZ_FRAME_PLAN] = 1, [GZ_FRAME_CAST] = cast_ms, [GZ_FRAME_REST] = 2 },
	};
	gz_frame_history_add(history, &cost);
}

static void empty_history_costs_nothing(void **state)
{
	(void)state;
	const struct gz_frame_history history = { 0 };
	assert_null(gz_frame_history_at(&history, 0));
	assert_true(gz_frame_history_quantile_ms(&history, GZ_FRAME_PARTS, 0.5) == 0);
}

static void newest_frame_is_first_and_oldest_are_dropped(void **state)
{
	(void)state;
	struct gz_frame_history history = { 0 };
	for (int i = 0; i < GZ_FRAME_HISTORY_SIZE + 3; i++) {
		add(&history, i);
		assert_true(gz_frame_history_at(&history, 0)->ms[GZ_FRAME_CAST] == i);
	}
	assert_int_equal(history.count, GZ_FRAME_HISTORY_SIZE);
	assert_true(gz_frame_history_at(&history, GZ_FRAME_HISTORY_SIZE - 1)->ms[GZ_FRAME_CAST] ==
		    3);
	assert_null(gz_frame_history_at(&history, GZ_FRAME_HISTORY_SIZE));
}

static void quantiles_use_nearest_rank(void **state)
{
	(void)state;
	struct gz_frame_history history = { 0 };
	add(&history, 7);
	assert_true(gz_frame_history_quantile_ms(&history, GZ_FRAME_CAST, 0.5) == 7);
	assert_true(gz_frame_history_quantile_ms(&history, GZ_FRAME_PARTS, 0.95) == 10);
	history = (struct gz_frame_history) { 0 };
	/* 1 to 100 in another order: 37 has no common divisor with 101. */
	for (int i = 1; i <= 100; i++)
		add(&history, i * 37 % 101);
	static const struct {
		double share, value;
	} cases[] = { { 0.01, 1 }, { 0.5, 50 }, { 0.95, 95 }, { 1, 100 } };
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const double got =
			gz_frame_history_quantile_ms(&history, GZ_FRAME_CAST, cases[i].share);
		if (got != cases[i].value)
			fail_msg("share %g: %g, not %g", cases[i].share, got, cases[i].value);
	}
}

static void negative_and_nan_parts_count_as_zero(void **state)
{
	(void)state;
	struct gz_frame_history history = { 0 };
	const struct gz_frame_cost cost = {
		.ms = { [GZ_FRAME_PLAN] = -1, [GZ_FRAME_CAST] = NAN, [GZ_FRAME_REST] = 2 },
	};
	gz_frame_history_add(&history, &cost);
	assert_true(gz_frame_cost_total_ms(gz_frame_history_at(&history, 0)) == 2);
}

TEST_SUITE(frame_history)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(empty_history_costs_nothing),
		cmocka_unit_test(newest_frame_is_first_and_oldest_are_dropped),
		cmocka_unit_test(quantiles_use_nearest_rank),
		cmocka_unit_test(negative_and_nan_parts_count_as_zero),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
