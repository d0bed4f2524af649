/* Accuracy, precision and loss against values computed by hand. */
#include "suite.h"

#include <math.h>

#include "client/gazectl/validate/gaze_quality.h"

#define CHECK_NEAR(got, wanted, within)                                          \
	do {                                                                     \
		double g_ = (got), w_ = (wanted);                                \
		if (!(fabs(g_ - w_) <= (within)))                                \
			fail_msg("%s is %.9g, not %.9g within %g", #got, g_, w_, \
				 (double)(within));                              \
	} while (0)

/* A display as far from the eye as it is wide. */
static const struct gz_display display = { { 1000, 1000 }, { 1000, 1000 }, 1000 };
static const struct gz_point middle = { 0.5f, 0.5f };

/* float places are exact to 3e-8 of the display, which is 2 millionths of a degree. */
static const double EXACT_DEG = 1e-5;

enum { SAMPLES_MAX = 64 };

static struct gz_quality_sample samples[SAMPLES_MAX];

/* @right degrees to the right of the middle, @down below it; along one axis only it is exact. */
static struct gz_point at_deg(double right, double down)
{
	const double deg = 3.14159265358979323846 / 180;
	return (struct gz_point) { (float)(0.5 + tan(right * deg)),
				   (float)(0.5 + tan(down * deg)) };
}

static void put(size_t i, int64_t host_ms, struct gz_point point)
{
	samples[i] = (struct gz_quality_sample) { .host_ns = host_ms * 1000000,
						  .seq = i,
						  .point = { point, point, point },
						  .fixating = true };
}

static struct gz_quality measure(size_t count, int64_t end_ms, int64_t period_ms)
{
	const struct gz_quality_input input = {
		.display = &display,
		.target = middle,
		.samples = samples,
		.count = count,
		.begin_ns = 0,
		.end_ns = end_ms * 1000000,
		.period_ns = period_ms * 1000000,
	};
	struct gz_quality quality;
	gz_quality_measure(&input, GZ_TRACE_BOTH, &quality);
	return quality;
}

static void samples_along_a_line_have_the_values_of_the_formulas(void **state)
{
	(void)state;
	static const double right[] = { 1, 1, 3, 3 };
	for (size_t i = 0; i < 4; i++)
		put(i, 10 * (int64_t)i, at_deg(right[i], 0));
	struct gz_quality q = measure(4, 40, 10);
	assert_int_equal(q.used, 4);
	CHECK_NEAR(q.accuracy_deg, 2, EXACT_DEG); /* (1 + 1 + 3 + 3) / 4 */
	CHECK_NEAR(q.offset_deg[0], 2, EXACT_DEG);
	CHECK_NEAR(q.offset_deg[1], 0, EXACT_DEG);
	CHECK_NEAR(q.sd_axis_deg[0], sqrt(4.0 / 3), EXACT_DEG); /* four ones over n - 1 */
	CHECK_NEAR(q.sd_axis_deg[1], 0, EXACT_DEG);
	CHECK_NEAR(q.sd_deg, sqrt(4.0 / 3), EXACT_DEG);
	CHECK_NEAR(q.rms_s2s_deg, sqrt(4.0 / 3), EXACT_DEG); /* steps 0, 2, 0 */
	CHECK_NEAR(q.bcea_deg2, 0, EXACT_DEG);
	CHECK_NEAR(q.loss, 0, 0);
}

static void samples_round_the_target_have_no_offset_but_spread(void **state)
{
	(void)state;
	put(0, 0, at_deg(1, 0));
	put(1, 10, at_deg(0, 1));
	put(2, 20, at_deg(-1, 0));
	put(3, 30, at_deg(0, -1));
	struct gz_quality q = measure(4, 40, 10);
	CHECK_NEAR(q.accuracy_deg, 1, EXACT_DEG);
	CHECK_NEAR(q.offset_deg[0], 0, EXACT_DEG);
	CHECK_NEAR(q.offset_deg[1], 0, EXACT_DEG);
	CHECK_NEAR(q.sd_deg, sqrt(4.0 / 3), EXACT_DEG);
	CHECK_NEAR(q.bcea_deg2, 4.772858, 1e-4);  /* 2 * 1.139434 * pi * 2 / 3 */
	CHECK_NEAR(q.rms_s2s_deg, sqrt(2), 1e-3); /* slightly less on a sphere than on a plane */
}

static void samples_on_a_slope_span_no_area(void **state)
{
	(void)state;
	for (size_t i = 0; i < 5; i++)
		put(i, 10 * (int64_t)i, at_deg(0.01 * (double)i, 0.02 * (double)i));
	CHECK_NEAR(measure(5, 50, 10).bcea_deg2, 0, 1e-6);
}

static void offset_has_the_angle_as_its_length_all_over_the_display(void **state)
{
	(void)state;
	static const struct gz_point corner = { 0.1f, 0.95f };
	for (int i = 0; i < 8; i++) {
		struct gz_point p = { corner.x + 0.02f * (float)cos(i),
				      corner.y + 0.02f * (float)sin(i) };
		double deg[2];
		gz_quality_offset_deg(&display, corner, p, deg);
		CHECK_NEAR(sqrt(deg[0] * deg[0] + deg[1] * deg[1]),
			   gz_display_angle_deg(&display, corner, p), 1e-9);
		assert_true((deg[0] > 0) == (p.x > corner.x));
	}
}

static void missing_and_unmeasured_samples_are_loss(void **state)
{
	(void)state;
	size_t count = 0;
	for (int64_t ms = 0; ms < 100; ms += 10)
		if (ms != 50)
			put(count++, ms, at_deg(1, 0));
	samples[3].point[GZ_TRACE_BOTH] = (struct gz_point) { NAN, NAN };
	struct gz_quality q = measure(count, 100, 10);
	assert_int_equal(q.expected, 10);
	assert_int_equal(q.measured, 8);
	CHECK_NEAR(q.loss, 0.2, 1e-12);
}

static void samples_missing_at_both_ends_are_loss(void **state)
{
	(void)state;
	for (size_t i = 0; i < 5; i++)
		put(i, 30 + 10 * (int64_t)i, at_deg(1, 0));
	assert_int_equal(measure(5, 100, 10).expected, 10);
}

static void no_phase_of_the_tracker_counts_as_loss(void **state)
{
	(void)state;
	for (int64_t phase_ms = 0; phase_ms < 10; phase_ms++) {
		for (size_t i = 0; i < 10; i++)
			put(i, phase_ms + 10 * (int64_t)i, middle);
		assert_int_equal(measure(10, 100, 10).expected, 10);
	}
}

static void steps_across_a_gap_or_a_saccade_are_no_noise(void **state)
{
	(void)state;
	put(0, 0, at_deg(0, 0));
	put(1, 10, at_deg(0.1, 0));
	put(2, 40, at_deg(2, 0)); /* two samples are missing before it */
	put(3, 50, at_deg(2.1, 0));
	put(4, 60, at_deg(5, 0));
	samples[4].fixating = false;
	put(5, 70, at_deg(7, 0));
	struct gz_quality q = measure(6, 80, 10);
	CHECK_NEAR(q.rms_s2s_deg, 0.1, EXACT_DEG);
	assert_int_equal(q.used, 5);
	assert_int_equal(q.measured, 6);
}

static void too_few_samples_give_nan_and_no_number(void **state)
{
	(void)state;
	struct gz_quality q = measure(0, 100, 10);
	assert_true(isnan(q.accuracy_deg) && isnan(q.sd_deg) && isnan(q.rms_s2s_deg));
	CHECK_NEAR(q.loss, 1, 0);
	put(0, 0, at_deg(1, 0));
	q = measure(1, 10, 10);
	CHECK_NEAR(q.accuracy_deg, 1, EXACT_DEG);
	assert_true(isnan(q.sd_deg) && isnan(q.rms_s2s_deg) && isnan(q.bcea_deg2));
	q = measure(0, 0, 0);
	assert_true(isnan(q.loss));
}

static void summary_is_the_mean_of_the_targets_that_have_samples(void **state)
{
	(void)state;
	struct gz_quality targets[3] = {
		{ .expected = 10,
		  .measured = 10,
		  .used = 10,
		  .accuracy_deg = 1,
		  .offset_deg = { 1, 0 },
		  .rms_s2s_deg = 0.1,
		  .sd_deg = 0.2,
		  .bcea_deg2 = 0.3 },
		{ .expected = 10,
		  .measured = 5,
		  .used = 5,
		  .accuracy_deg = 3,
		  .offset_deg = { -3, 0.5 },
		  .rms_s2s_deg = 0.3,
		  .sd_deg = 0.4,
		  .bcea_deg2 = 0.5 },
	};
	const struct gz_quality_input none = { .display = &display, .target = middle };
	gz_quality_measure(&none, GZ_TRACE_BOTH, &targets[2]);
	struct gz_quality_summary s;
	gz_quality_summarise(targets, 3, &s);
	assert_int_equal(s.targets, 2);
	CHECK_NEAR(s.accuracy_deg, 2, 1e-12);
	CHECK_NEAR(s.accuracy_sd_deg, sqrt(2), 1e-12);
	CHECK_NEAR(s.worst_deg, 3, 0);
	CHECK_NEAR(s.offset_deg[0], -1, 1e-12);
	CHECK_NEAR(s.rms_s2s_deg, 0.2, 1e-12);
	CHECK_NEAR(s.sd_deg, 0.3, 1e-12);
	CHECK_NEAR(s.bcea_deg2, 0.4, 1e-12);
	CHECK_NEAR(s.loss, 0.25, 1e-12);
	gz_quality_summarise(targets, 0, &s);
	assert_true(isnan(s.accuracy_deg) && isnan(s.loss) && isnan(s.worst_deg));
}

static void period_is_the_median_and_unmoved_by_gaps(void **state)
{
	(void)state;
	static const int64_t ms[] = { 0, 10, 20, 60, 70, 80, 90 };
	for (size_t i = 0; i < 7; i++)
		put(i, ms[i], middle);
	assert_int_equal(gz_quality_period_ns(samples, 7), 10000000);
	assert_int_equal(gz_quality_period_ns(samples, 1), 0);
	assert_int_equal(gz_quality_period_ns(samples, 0), 0);
}

TEST_SUITE(gaze_quality)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(samples_along_a_line_have_the_values_of_the_formulas),
		cmocka_unit_test(samples_round_the_target_have_no_offset_but_spread),
		cmocka_unit_test(samples_on_a_slope_span_no_area),
		cmocka_unit_test(offset_has_the_angle_as_its_length_all_over_the_display),
		cmocka_unit_test(missing_and_unmeasured_samples_are_loss),
		cmocka_unit_test(samples_missing_at_both_ends_are_loss),
		cmocka_unit_test(no_phase_of_the_tracker_counts_as_loss),
		cmocka_unit_test(steps_across_a_gap_or_a_saccade_are_no_noise),
		cmocka_unit_test(too_few_samples_give_nan_and_no_number),
		cmocka_unit_test(summary_is_the_mean_of_the_targets_that_have_samples),
		cmocka_unit_test(period_is_the_median_and_unmoved_by_gaps),
	};
	return cmocka_run_group_tests_name("client.gaze_quality", tests, NULL, NULL);
}
