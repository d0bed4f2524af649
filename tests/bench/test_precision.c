/* Precision in fixations and lags (bench/filter/precision.h), where the truth is made. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "bench/filter/precision.h"
#include "bench/filter/stillness.h"
#include "bench/filter/track.h"
#include "sim/random.h"

/* A sample each 2 ms. */
enum { STEP_MS = 2, COUNT = 5000 };

static struct gz_gaze_track track;

static int set_up(void **state)
{
	(void)state;
	const struct gz_display display = gz_display_default(1920, 1080);
	if (gz_gaze_track_start(COUNT, &display, &track) != GZ_OK)
		return 1;
	for (size_t i = 0; i < COUNT; i++) {
		track.sample[i].host_ns = (int64_t)i * STEP_MS * 1000000;
		track.raw[i] = track.point[i] = (struct gz_point) { 0.5f, 0.5f };
		track.label[i] = GZ_EVENT_FIXATION;
	}
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	gz_gaze_track_free(&track);
	return 0;
}

static void check_close(double is, double wanted, double tolerance)
{
	if (!(fabs(is - wanted) <= tolerance))
		fail_msg("%.9g, not %.9g to %.9g", is, wanted, tolerance);
}

/* A point so many degrees right of the middle, as precision counts them there. */
static struct gz_point right_of_middle(double deg)
{
	const double mm = deg / 57.29577951308232 * track.display.distance_mm;
	return (struct gz_point) { (float)(0.5 + mm / track.display.mm[0]), 0.5f };
}

static struct gz_precision precision_of_part(bool raw, enum gz_precision_part part)
{
	struct gz_precision precision;
	assert_true(gz_precision_of(&track, 1, raw, part, &precision));
	return precision;
}

static void white_noise_has_the_precision_of_its_deviation(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(7, 7);
	for (size_t i = 0; i < COUNT; i++) {
		const double deg = 0.2 * gz_random_normal(&random);
		track.raw[i] = right_of_middle(deg);
		track.point[i] = right_of_middle(deg / 4);
	}
	const struct gz_precision raw = precision_of_part(true, GZ_PRECISION_WHOLE);
	const struct gz_precision ours = precision_of_part(false, GZ_PRECISION_WHOLE);
	assert_int_equal(raw.windows, COUNT * STEP_MS / GZ_PRECISION_WINDOW_MS);
	check_close(raw.step_deg, 0.2 * sqrt(2), 0.006); /* of two samples */
	check_close(raw.spread_deg, 0.2, 0.005);
	check_close(raw.step_median_deg, 0.2 * sqrt(2), 0.02);
	check_close(raw.spread_median_deg, 0.2, 0.01);
	check_close(ours.step_deg / raw.step_deg, 0.25, 1e-3);
	check_close(ours.spread_deg / raw.spread_deg, 0.25, 1e-3);
}

static void drift_along_a_line_is_no_spread(void **state)
{
	(void)state;
	for (size_t i = 0; i < COUNT; i++)
		track.raw[i] = right_of_middle(-2 + 4.0 * (double)i / COUNT);
	const struct gz_precision raw = precision_of_part(true, GZ_PRECISION_WHOLE);
	check_close(raw.step_deg, 4.0 / COUNT, 1e-5);
	check_close(raw.spread_deg, 0, 1e-5);
}

static void one_jump_weighs_on_all_windows_but_not_on_their_median(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(8, 8);
	for (size_t i = 0; i < COUNT; i++)
		track.raw[i] = right_of_middle(0.01 * gz_random_normal(&random) +
					       (i > COUNT / 2 + 20 ? 3 : 0));
	const struct gz_precision raw = precision_of_part(true, GZ_PRECISION_WHOLE);
	check_close(raw.step_deg, 3 / sqrt(COUNT), 0.005);
	check_close(raw.step_median_deg, 0.01 * sqrt(2), 0.001);
	assert_true(raw.spread_deg > 10 * raw.spread_median_deg);
}

static void inner_part_leaves_out_both_ends(void **state)
{
	(void)state;
	enum { BEGIN = 1000, END = 1300 };
	for (size_t i = 0; i < COUNT; i++) {
		const bool ends = i < BEGIN + 18 || i >= END - 8;
		track.label[i] = i < BEGIN || i >= END ? GZ_EVENT_SACCADE : GZ_EVENT_FIXATION;
		track.raw[i] = right_of_middle(ends ? (double)(i % 2) : 0);
	}
	assert_true(precision_of_part(true, GZ_PRECISION_WHOLE).step_deg > 0.2);
	assert_true(precision_of_part(true, GZ_PRECISION_INNER).step_deg == 0);
	assert_int_equal(precision_of_part(true, GZ_PRECISION_INNER).windows, 3);
	for (size_t i = BEGIN; i < END; i++)
		track.label[i] = GZ_EVENT_SACCADE;
	assert_true(isnan(precision_of_part(true, GZ_PRECISION_INNER).step_deg));
}

static void lost_samples_count_in_no_measure(void **state)
{
	(void)state;
	for (size_t i = 0; i < COUNT; i++) {
		const bool lost = i % 50 < 10;
		track.raw[i] = lost ? (struct gz_point) { NAN, NAN } : right_of_middle(0);
		track.point[i] = right_of_middle(lost ? 5 : 0);
	}
	const struct gz_precision ours = precision_of_part(false, GZ_PRECISION_WHOLE);
	assert_true(ours.windows > 10);
	check_close(ours.step_deg, 0, 1e-9);
	check_close(ours.spread_deg, 0, 1e-9);
}

static void step_across_a_gap_in_the_recording_does_not_count(void **state)
{
	(void)state;
	for (size_t i = COUNT / 2; i < COUNT; i++) {
		track.sample[i].host_ns += 1000000000;
		track.raw[i] = right_of_middle(10);
	}
	assert_int_equal(gz_gaze_stretch_end(&track, 7), COUNT / 2);
	assert_true(precision_of_part(true, GZ_PRECISION_WHOLE).step_deg == 0);
	const struct gz_stillness still = gz_stillness_of(&track, 1);
	assert_int_equal(still.fixations, 2);
	assert_true(isnan(still.jitter)); /* neither of them has a step */
}

/* A saccade of 6 degrees in 40 ms each 400 ms, to and fro. */
static void make_saccades(void)
{
	double deg = -3, way_deg = 6;
	for (size_t i = 0; i < COUNT; i++) {
		const bool moving = i % 200 >= 180;
		if (i % 200 == 0 && i > 0)
			way_deg = -way_deg;
		deg += moving ? way_deg / 20 : 0;
		track.label[i] = moving ? GZ_EVENT_SACCADE : GZ_EVENT_FIXATION;
		track.raw[i] = track.point[i] = right_of_middle(deg);
	}
}

static void late_point_has_its_delay_as_lag_and_no_overshoot(void **state)
{
	(void)state;
	enum { DELAY = 3 };
	struct gz_lags lags;
	make_saccades();
	for (size_t i = DELAY; i < COUNT; i++)
		track.point[i] = track.raw[i - DELAY];
	assert_true(gz_lags_of(&track, 1, &lags));
	assert_in_range(lags.saccades, 20, 25);
	check_close(lags.onset_median, DELAY, 0.05);
	check_close(lags.onset_mean, DELAY, 0.05);
	check_close(lags.onset_90, DELAY, 0.05);
	check_close(lags.overshoot_deg, 0, 0.001);
	assert_true(isnan(lags.pursuit_ms));
}

static void point_that_goes_too_far_has_overshoot(void **state)
{
	(void)state;
	struct gz_lags lags;
	make_saccades();
	for (size_t i = 0; i < COUNT; i++)
		if (i % 200 == 199) /* the last sample of a saccade */
			track.point[i].x += 2 * (track.raw[i].x - track.raw[i - 1].x);
	assert_true(gz_lags_of(&track, 1, &lags));
	check_close(lags.overshoot_deg, 0.6, 0.02);
	check_close(lags.onset_median, 0, 0.01);
}

static void late_point_in_a_pursuit_has_its_delay_as_lag(void **state)
{
	(void)state;
	enum { DELAY = 7 };
	struct gz_lags lags;
	for (size_t i = 0; i < COUNT; i++) {
		const double t_s = (double)i * STEP_MS / 1000;
		track.label[i] = GZ_EVENT_PURSUIT;
		track.raw[i] = track.point[i] = right_of_middle(5 * sin(2 * t_s));
	}
	for (size_t i = DELAY; i < COUNT; i++)
		track.point[i] = track.raw[i - DELAY];
	assert_true(gz_lags_of(&track, 1, &lags));
	check_close(lags.pursuit_ms, DELAY * STEP_MS, 0.1);
	assert_int_equal(lags.saccades, 0);
	assert_true(isnan(lags.onset_median));
}

TEST_SUITE(precision)
{
#define ON_A_TRACK(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
	const struct CMUnitTest tests[] = {
		ON_A_TRACK(white_noise_has_the_precision_of_its_deviation),
		ON_A_TRACK(drift_along_a_line_is_no_spread),
		ON_A_TRACK(one_jump_weighs_on_all_windows_but_not_on_their_median),
		ON_A_TRACK(inner_part_leaves_out_both_ends),
		ON_A_TRACK(lost_samples_count_in_no_measure),
		ON_A_TRACK(step_across_a_gap_in_the_recording_does_not_count),
		ON_A_TRACK(late_point_has_its_delay_as_lag_and_no_overshoot),
		ON_A_TRACK(point_that_goes_too_far_has_overshoot),
		ON_A_TRACK(late_point_in_a_pursuit_has_its_delay_as_lag),
	};
	return cmocka_run_group_tests_name("bench.precision", tests, NULL, NULL);
}
