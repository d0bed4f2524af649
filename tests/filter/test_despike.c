#include "suite.h"

#include "filter/check.h"

#include <math.h>

#include "filter/despike.h"
#include "filter/pipeline.h"
#include "sim/viewer.h"

static struct gz_display display;
static struct gz_despike_params params;

static int setup(void **state)
{
	(void)state;
	display = gz_display_default(1920, 1080);
	params = gz_pipeline_default_params().despike;
	return 0;
}

/* Run x through the step at @p period_us; y is constant. */
static void run(const float *x, float *out_x, int count, int64_t period_us)
{
	struct gz_despike_state s = { .started = false };
	for (int i = 0; i < count; i++) {
		struct gz_point p = { x[i], 0.5f };
		out_x[i] =
			gz_despike_step(&s, &params, &display, (i + 1) * period_us * 1000, p, false)
				.x;
	}
}

static void one_sample_spike_is_taken_out(void **state)
{
	(void)state;
	float x[40], out[40];
	for (int i = 0; i < 40; i++)
		x[i] = 0.5f + 0.0003f * (float)(i % 3);
	x[20] = 0.6f;
	run(x, out, 40, 2000);
	for (int i = 0; i < 40; i++)
		CHECK_BETWEEN(out[i], 0.4999, 0.501);
	assert_true(out[21] == x[21]);
}

/* Some trackers of 250 Hz tell times in whole milliseconds: a step is 4 or 5 ms. */
static void spike_is_taken_out_where_times_are_rounded(void **state)
{
	(void)state;
	for (int at = 10; at < 30; at++) {
		struct gz_despike_state s = { .started = false };
		for (int i = 0; i < 40; i++) {
			const struct gz_point p = { i == at ? 0.6f
							    : 0.5f + 0.0003f * (float)(i % 3),
						    0.5f };
			const int64_t time_ns = ((int64_t)i * 25 / 6 + 1) * 1000000; /* 240 Hz */
			const float x = gz_despike_step(&s, &params, &display, time_ns, p, false).x;
			CHECK_BETWEEN(x, 0.4999, 0.501);
		}
	}
}

static void two_sample_spike_is_taken_out(void **state)
{
	(void)state;
	float x[40], out[40];
	for (int i = 0; i < 40; i++)
		x[i] = 0.5f + 0.0003f * (float)(i % 3);
	x[20] = 0.6f;
	x[21] = 0.605f;
	run(x, out, 40, 1000);
	for (int i = 0; i < 40; i++)
		CHECK_BETWEEN(out[i], 0.4999, 0.501);
	assert_true(out[22] == x[22]);
}

static void a_step_that_stays_passes_within_the_delay(void **state)
{
	(void)state;
	static const int64_t periods_us[] = { 500, 833, 1000, 2000, 3333, 4000, 8333, 33333 };
	for (size_t k = 0; k < sizeof periods_us / sizeof periods_us[0]; k++) {
		float x[40], out[40];
		for (int i = 0; i < 40; i++)
			x[i] = i < 20 ? 0.5f : 0.6f;
		run(x, out, 40, periods_us[k]);
		int held = 0;
		while (20 + held < 40 && out[20 + held] != 0.6f)
			held++;
		CHECK_BETWEEN((double)held * (double)periods_us[k], 0, 5000);
		for (int i = 20 + held; i < 40; i++)
			assert_true(out[i] == 0.6f);
	}
}

static void a_saccade_passes_with_one_sample_of_delay_at_most(void **state)
{
	(void)state;
	static const double rates_hz[] = { 250, 500, 1000, 2000 };
	for (size_t k = 0; k < 4; k++) {
		struct gz_viewer_params viewer_params = { .fixation_ms = 250, .saccade_deg = 8 };
		struct gz_viewer viewer;
		struct gz_despike_state s = { .started = false };
		gz_viewer_init(&viewer, &viewer_params, &display, NULL, 3, 0);
		int64_t period_ns = (int64_t)(1e9 / rates_hz[k]);
		struct gz_point last = { 0.5f, 0.5f };
		int held = 0, longest = 0;
		for (int64_t i = 1; i < 20000; i++) {
			struct gz_point p = gz_viewer_advance(&viewer, i * period_ns).point;
			struct gz_point out =
				gz_despike_step(&s, &params, &display, i * period_ns, p, false);
			bool delayed = out.x != p.x || out.y != p.y;
			if (delayed)
				assert_true(out.x == last.x || held > 0);
			held = delayed ? held + 1 : 0;
			longest = held > longest ? held : longest;
			last = p;
		}
		CHECK_BETWEEN(longest, 0, 1);
	}
}

static void slow_trackers_pass_untouched(void **state)
{
	(void)state;
	float x[40], out[40];
	for (int i = 0; i < 40; i++)
		x[i] = i % 7 == 0 ? 0.7f : 0.5f;
	run(x, out, 40, 8333);
	for (int i = 0; i < 40; i++)
		assert_true(out[i] == x[i]);
}

static void after_a_gap_nothing_is_held(void **state)
{
	(void)state;
	struct gz_despike_state s = { .started = false };
	for (int i = 1; i < 20; i++)
		(void)gz_despike_step(&s, &params, &display, i * 1000000,
				      (struct gz_point) { 0.5f, 0.5f }, false);
	struct gz_point p = gz_despike_step(&s, &params, &display, 300000000,
					    (struct gz_point) { 0.9f, 0.1f }, true);
	assert_true(p.x == 0.9f && p.y == 0.1f);
}

TEST_SUITE(despike)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_sample_spike_is_taken_out),
		cmocka_unit_test(spike_is_taken_out_where_times_are_rounded),
		cmocka_unit_test(two_sample_spike_is_taken_out),
		cmocka_unit_test(a_step_that_stays_passes_within_the_delay),
		cmocka_unit_test(a_saccade_passes_with_one_sample_of_delay_at_most),
		cmocka_unit_test(slow_trackers_pass_untouched),
		cmocka_unit_test(after_a_gap_nothing_is_held),
	};
	return cmocka_run_group_tests_name("filter.despike", tests, setup, NULL);
}
