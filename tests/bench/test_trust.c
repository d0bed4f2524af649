#include "suite.h"

#include <math.h>

#include "bench/report/summary.h"
#include "bench/report/trust.h"
#include "made_study.h"
#include "sim/random.h"

enum { PAIRS = 400, STUDIES = 60 };

static void ratio_that_never_varies_has_an_interval_without_width(void **state)
{
	(void)state;
	const double over[] = { 10, 30, 20 }, under[] = { 1, 3, 2 };
	const struct gz_interval interval = gz_ratio_interval(over, under, 3);
	assert_true(fabs(interval.low - 10) < 1e-12 && fabs(interval.high - 10) < 1e-12);
}

static void interval_of_one_pair_is_not_known(void **state)
{
	(void)state;
	const double value = 1;
	assert_true(isnan(gz_ratio_interval(&value, &value, 1).low));
	assert_true(isnan(gz_ratio_interval(NULL, NULL, 0).high));
}

/* Times of which the true ratio is 4: of many studies, 95 % of the intervals are to hold it. */
static void intervals_hold_the_true_ratio_as_often_as_they_say(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(1, 0);
	double over[PAIRS], under[PAIRS], width = 0;
	int held = 0;
	for (int study = 0; study < STUDIES; study++) {
		for (int i = 0; i < PAIRS; i++) {
			over[i] = 40 * (1 + 0.1 * gz_random_normal(&random));
			under[i] = 10 * (1 + 0.2 * gz_random_normal(&random));
		}
		const struct gz_interval interval = gz_ratio_interval(over, under, PAIRS);
		held += interval.low <= 4 && interval.high >= 4;
		width += (interval.high - interval.low) / STUDIES;
	}
	assert_in_range(held, 0.88 * STUDIES, STUDIES);
	/* 2 * 1.96 standard deviations of the ratio of two means */
	const double expected = 2 * 1.96 * 4 * sqrt((0.1 * 0.1 + 0.2 * 0.2) / PAIRS);
	assert_true(width > 0.93 * expected && width < 1.07 * expected);
}

static void noise_is_that_of_times_of_one_kind(void **state)
{
	(void)state;
	struct gz_kind_time times[202];
	for (uint32_t i = 0; i < 101; i++) {
		times[2 * i] = (struct gz_kind_time) { 0, 100 + (i - 50.) / 5 };
		times[2 * i + 1] = (struct gz_kind_time) { 7, 1000 + 2 * (i - 50.) };
	}
	/* within ±10 % each, evenly: the middle nine tenths lie within ±9 % */
	assert_true(fabs(gz_noise_of(times, 202) - 0.09) < 0.001);
	struct gz_kind_time alone[] = { { 1, 5 }, { 2, 50 } };
	assert_true(isnan(gz_noise_of(alone, 2)));
	assert_true(isnan(gz_noise_of(NULL, 0)));
}

/* Standard takes 100 and 110 ms at two points, and 100, 100 and 130 ms at each. */
static void noisy(const struct gz_study *study, struct gz_study_row *row)
{
	(void)study;
	row->frame_ms = (row->point == 0 ? 100 : 110) * (row->frame == 2 ? 1.3 : 1);
}

static double noise_of_study(bool own_cameras, bool *out_of_frames)
{
	const struct made_study made = { .scenes = { "head" },
					 .variants = { "standard", "acuity" },
					 .backends = { "cpu" },
					 .sizes = { { 100, 100 } },
					 .size_count = 1,
					 .points = 2,
					 .frames = 3 };
	struct gz_study study;
	struct gz_summary summary;
	make_study(&made, &study);
	make_rows(&study, noisy);
	for (uint32_t i = 0; i < 2 && own_cameras; i++)
		study.points[i].camera = i;
	assert_int_equal(gz_summary_make(&study, &summary), GZ_OK);
	const double noise = summary.groups[0].noise;
	*out_of_frames = summary.groups[0].noise_of_frames;
	gz_summary_free(&summary);
	gz_study_free(&study);
	return noise;
}

static void noise_of_a_study_is_of_places_seen_by_one_camera(void **state)
{
	(void)state;
	bool of_frames;
	assert_true(fabs(noise_of_study(false, &of_frames) - 0.9 * 5 / 105) < 1e-9);
	assert_false(of_frames);
	assert_true(fabs(noise_of_study(true, &of_frames) - 0.15) < 1e-9);
	assert_true(of_frames);
}

TEST_SUITE(trust)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ratio_that_never_varies_has_an_interval_without_width),
		cmocka_unit_test(interval_of_one_pair_is_not_known),
		cmocka_unit_test(intervals_hold_the_true_ratio_as_often_as_they_say),
		cmocka_unit_test(noise_is_that_of_times_of_one_kind),
		cmocka_unit_test(noise_of_a_study_is_of_places_seen_by_one_camera),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
