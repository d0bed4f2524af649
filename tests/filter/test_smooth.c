#include "suite.h"

#include "filter/check.h"

#include <math.h>

#include "filter/median.h"
#include "filter/pipeline.h"
#include "filter/smooth.h"
#include "sim/random.h"

static struct gz_display display;
static struct gz_smooth_params params;

static int setup(void **state)
{
	(void)state;
	display = gz_display_default(1920, 1080);
	params = gz_pipeline_default_params().smooth;
	return 0;
}

static struct gz_point step(struct gz_smooth_state *s, enum gz_event event, int k, bool valid,
			    float x)
{
	const struct gz_smooth_input input = {
		event, (int64_t)(k + 1) * 2000000, valid, { x, 0.5f }
	};
	return gz_smooth_step(s, &params, &display, &input);
}

static void nothing_known_is_the_centre(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	struct gz_point p = step(&s, GZ_EVENT_LOST, 0, false, NAN);
	assert_true(p.x == 0.5f && p.y == 0.5f);
}

static void fixation_becomes_steadier_the_longer_it_lasts(void **state)
{
	(void)state;
	double off2[2] = { 0, 0 };
	struct gz_random random = gz_random_seeded(2, 2);
	for (int trial = 0; trial < 300; trial++) {
		struct gz_smooth_state s = { .started = false };
		for (int k = 0; k < 100; k++) {
			float noise = (float)(0.002 * gz_random_normal(&random));
			struct gz_point p = step(&s, GZ_EVENT_FIXATION, k, true, 0.3f + noise);
			if (k == 9 || k == 99)
				off2[k == 99] += pow((p.x - 0.3) / 0.002, 2) / 300;
		}
	}
	CHECK_BETWEEN(sqrt(off2[0]), 0.3, 0.7); /* 20 ms */
	CHECK_BETWEEN(sqrt(off2[1]), 0.05, 0.2);
}

static void saccade_passes_unsmoothed(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	for (int k = 0; k < 50; k++)
		(void)step(&s, GZ_EVENT_FIXATION, k, true, 0.3f);
	for (int k = 50; k < 70; k++) {
		float x = 0.3f + 0.01f * (float)(k - 49);
		float given = step(&s, GZ_EVENT_SACCADE, k, true, x).x;
		if (x < 0.32f) /* the first degree may still be noise */
			CHECK_BETWEEN(given, 0.3, x);
		else if (x > 0.33f)
			assert_true(given == x);
	}
	CHECK_BETWEEN(step(&s, GZ_EVENT_FIXATION, 70, true, 0.501f).x, 0.5, 0.501);
}

static void false_alarm_of_a_saccade_does_not_move_the_point(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	float noise[] = { 0.001f, -0.0012f, 0.0008f, -0.0006f, 0 };
	for (int k = 0; k < 100; k++)
		(void)step(&s, GZ_EVENT_FIXATION, k, true, 0.3f + noise[k % 5]);
	for (int k = 100; k < 110; k++)
		CHECK_BETWEEN(step(&s, GZ_EVENT_SACCADE, k, true, 0.3f + noise[k % 5]).x, 0.2996,
			      0.3004);
}

static void noise_label_where_the_eye_rests_does_not_move_the_point(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	float noise[] = { 0.001f, -0.0012f, 0.0008f, -0.0006f, 0 };
	for (int k = 0; k < 100; k++)
		(void)step(&s, GZ_EVENT_FIXATION, k, true, 0.3f + noise[k % 5]);
	for (int k = 100; k < 110; k++)
		CHECK_BETWEEN(step(&s, GZ_EVENT_BLINK, k, true, 0.3f + noise[k % 5]).x, 0.2996,
			      0.3004);
	/* Half a degree away what was measured is shown, as nobody knows what it is. */
	assert_true(step(&s, GZ_EVENT_BLINK, 110, true, 0.31f).x == 0.31f);
	assert_true(step(&s, GZ_EVENT_BLINK, 111, true, 0.3f).x == 0.3f);
}

static void drift_within_the_limit_hardly_moves_the_point(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	struct gz_point from = { 0, 0 }, to = { 0, 0 };
	for (int k = 0; k < 250; k++)
		from = step(&s, GZ_EVENT_FIXATION, k, true, 0.3f);
	for (int k = 250; k < 350; k++) /* 0.15 degrees in 200 ms */
		to = step(&s, GZ_EVENT_FIXATION, k, true, 0.3f + 0.003f * (float)(k - 250) / 100);
	CHECK_BETWEEN(to.x - from.x, 0, 0.3 * 0.003);
	for (int k = 350; k < 450; k++) /* a degree in 200 ms more */
		to = step(&s, GZ_EVENT_FIXATION, k, true, 0.303f + 0.02f * (float)(k - 350) / 100);
	CHECK_BETWEEN(to.x, 0.316, 0.323); /* no more than 0.35 degrees behind */
}

static void pursuit_is_followed_without_steady_lag(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	struct gz_point p = { 0, 0 };
	float x = 0;
	for (int k = 0; k < 400; k++) {
		x = 0.2f + 0.001f * (float)k;
		p = step(&s, GZ_EVENT_PURSUIT, k, true, x);
	}
	CHECK_BETWEEN(p.x - x, -1e-5, 1e-5);
}

static void the_mean_lets_go_of_an_unnoticed_movement(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	struct gz_point p = { 0, 0 };
	for (int k = 0; k < 100; k++)
		(void)step(&s, GZ_EVENT_FIXATION, k, true, 0.3f + 0.0005f * (float)(k % 3));
	for (int k = 100; k < 130; k++) /* 60 ms */
		p = step(&s, GZ_EVENT_FIXATION, k, true, 0.35f);
	CHECK_BETWEEN(p.x, 0.345, 0.3501);
}

static void invalid_sample_holds_the_place(void **state)
{
	(void)state;
	struct gz_smooth_state s = { .started = false };
	struct gz_point held = step(&s, GZ_EVENT_FIXATION, 0, true, 0.3f);
	for (int k = 1; k < 100; k++)
		assert_true(step(&s, GZ_EVENT_BLINK, k, false, NAN).x == held.x);
	assert_true(step(&s, GZ_EVENT_FIXATION, 100, true, 0.7f).x == 0.7f);
}

static void median_of_a_stream_is_found_and_followed(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(4, 4);
	struct gz_median median = { .value = 0 };
	gz_median_follow(&median, -1, 0.01); /* not counted */
	gz_median_follow(&median, 0, 0.01);
	gz_median_follow(&median, NAN, 0.01);
	assert_true(median.count == 0);
	for (int k = 0; k < 3000; k++)
		gz_median_follow(&median, gz_random_exponential(&random), 0.01);
	CHECK_BETWEEN(median.value, 0.55, 0.85); /* ln 2 */
	for (int k = 0; k < 3000; k++)
		gz_median_follow(&median, 100 * gz_random_exponential(&random), 0.01);
	CHECK_BETWEEN(median.value, 55, 85);
}

TEST_SUITE(smooth)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_known_is_the_centre),
		cmocka_unit_test(fixation_becomes_steadier_the_longer_it_lasts),
		cmocka_unit_test(saccade_passes_unsmoothed),
		cmocka_unit_test(false_alarm_of_a_saccade_does_not_move_the_point),
		cmocka_unit_test(noise_label_where_the_eye_rests_does_not_move_the_point),
		cmocka_unit_test(drift_within_the_limit_hardly_moves_the_point),
		cmocka_unit_test(pursuit_is_followed_without_steady_lag),
		cmocka_unit_test(the_mean_lets_go_of_an_unnoticed_movement),
		cmocka_unit_test(invalid_sample_holds_the_place),
		cmocka_unit_test(median_of_a_stream_is_found_and_followed),
	};
	return cmocka_run_group_tests_name("filter.smooth", tests, setup, NULL);
}
