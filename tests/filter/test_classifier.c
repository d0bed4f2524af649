/* The features of eye movements and the forests that read them. */
#include "suite.h"

#include "filter/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "filter/classifier/forest.h"
#include "filter/classifier/forest_lists.h"
#include "filter/classifier/whole.h"
#include "filter/pipeline.h"
#include "sim/tracker.h"

static const double RATES_HZ[] = { 60, 120, 250, 300, 500, 1000, 2000 };
enum { RATE_COUNT = sizeof RATES_HZ / sizeof RATES_HZ[0] };

static size_t feature_named(const char *name)
{
	for (size_t i = 0; i < GZ_MOVEMENT_FEATURES; i++)
		if (strcmp(gz_movement_feature_names[i], name) == 0)
			return i;
	fail_msg("no feature %s", name);
	return 0;
}

/* A display on which one degree near the centre is a hundredth of its width. */
static struct gz_display wide_display(void)
{
	return (struct gz_display) { { 1000, 1000 },
				     { 100 * 1000 / 57.295779513, 100 * 1000 / 57.295779513 },
				     1000 };
}

/* Feeds points at a constant rate; x and y in degrees from the centre. */
struct feed {
	struct gz_movement movement;
	struct gz_display display;
	double period_s, time_s;
	float features[GZ_MOVEMENT_FEATURES];
};

static void feed_open(struct feed *feed, double rate_hz)
{
	*feed = (struct feed) { .display = wide_display(), .period_s = 1 / rate_hz };
}

/* @param features  what comes of it; NULL: not wanted */
static void feed_point_to(struct feed *feed, double x_deg, double y_deg, bool valid,
			  float *features)
{
	const struct gz_movement_input input = {
		.time_ns = GZ_NS_PER_S + (int64_t)(feed->time_s * 1e9),
		.valid = valid,
		.point = { (float)(0.5 + x_deg / 100), (float)(0.5 + y_deg / 100) },
	};
	(void)gz_movement_step(&feed->movement, &feed->display, &input, features);
	feed->time_s += feed->period_s;
}

static void feed_point(struct feed *feed, double x_deg, double y_deg, bool valid)
{
	feed_point_to(feed, x_deg, y_deg, valid, feed->features);
}

static double feature_of(const struct feed *feed, const char *name)
{
	return (double)feed->features[feature_named(name)];
}

static void every_feature_has_a_name_of_its_own(void **state)
{
	(void)state;
	for (size_t i = 0; i < GZ_MOVEMENT_FEATURES; i++) {
		assert_non_null(gz_movement_feature_names[i]);
		assert_int_equal(feature_named(gz_movement_feature_names[i]), i);
	}
}

static void steady_movement_gives_the_same_features_at_any_rate(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		static struct feed feed;
		feed_open(&feed, RATES_HZ[i]);
		while (feed.time_s < 2) /* 6 degrees right and 8 down each second */
			feed_point(&feed, 6 * (feed.time_s - 2), 8 * (feed.time_s - 2), true);
		CHECK_BETWEEN(feature_of(&feed, "speed_0"), 9.8, 10.2);
		CHECK_BETWEEN(feature_of(&feed, "speed_7"), 9.8, 10.2);
		CHECK_BETWEEN(feature_of(&feed, "distance_16"), 0.157, 0.163);
		CHECK_BETWEEN(feature_of(&feed, "distance_448"), 4.4, 4.5);
		CHECK_BETWEEN(feature_of(&feed, "way_448"), 4.3, 4.7);
		CHECK_BETWEEN(feature_of(&feed, "down_64"), 0.50, 0.52);
		CHECK_BETWEEN(feature_of(&feed, "across_64"), 0.37, 0.39);
		CHECK_BETWEEN(feature_of(&feed, "turn_32"), 0.99, 1.0);
		CHECK_BETWEEN(feature_of(&feed, "slope"), 9.8, 10.2);
		CHECK_BETWEEN(feature_of(&feed, "residual"), 0, 0.02);
		CHECK_BETWEEN(feature_of(&feed, "noise"), 9.5, 10.5);
		CHECK_BETWEEN(feature_of(&feed, "flow_500"), 9.6, 10.0); /* 10 (1 - exp(-4)) */
		CHECK_BETWEEN(feature_of(&feed, "flow_2000"), 6.1, 6.5); /* 10 (1 - exp(-1)) */
		CHECK_BETWEEN(feature_of(&feed, "since_fast_ms"), 1000, 1000);
	}
}

static void a_resting_eye_has_no_movement(void **state)
{
	(void)state;
	static struct feed feed;
	feed_open(&feed, 500);
	while (feed.time_s < 1)
		feed_point(&feed, 3, -2, true);
	for (size_t i = 0; i < feature_named("noise"); i++)
		assert_true(feed.features[i] == 0);
	assert_true(feature_of(&feed, "slope") == 0);
}

/* A step of 5 degrees to the left within 20 ms. */
static void a_burst_is_measured(void **state)
{
	(void)state;
	for (int i = 2; i < RATE_COUNT; i++) {
		static struct feed feed;
		feed_open(&feed, RATES_HZ[i]);
		while (feed.time_s < 1)
			feed_point(&feed, -5 * fmax(0, fmin(1, (feed.time_s - 0.5) / 0.02)), 1,
				   true);
		CHECK_BETWEEN(feature_of(&feed, "burst_peak"), 225, 255);
		CHECK_BETWEEN(feature_of(&feed, "burst_deg"), 4.9, 5.1);
		CHECK_BETWEEN(feature_of(&feed, "burst_ms"), 14, 28);
		CHECK_BETWEEN(feature_of(&feed, "since_fast_ms"), 470, 482);
		CHECK_BETWEEN(feature_of(&feed, "stretch_ms"), 440, 460);
	}
}

/* 6 degrees a second to the right, and after a second 2 degrees at once in direction @p jump. */
static void feed_pursuit(struct feed *feed, double jump)
{
	feed_open(feed, 500);
	while (feed->time_s < 1.5)
		feed_point(feed,
			   6 * (feed->time_s - 1) +
				   2 * jump * fmax(0, fmin(1, (feed->time_s - 1) / 0.02)),
			   0, true);
}

static void slow_movement_is_followed_across_fast_ones(void **state)
{
	(void)state;
	static struct feed feed;
	feed_pursuit(&feed, 1); /* a saccade that catches up */
	CHECK_BETWEEN(feature_of(&feed, "flow_500"), 5.3, 6);
	CHECK_BETWEEN(feature_of(&feed, "flow_2000"), 2.9, 3.3); /* 6 (1 - exp(-1.5 / 2)) */
	CHECK_BETWEEN(feature_of(&feed, "burst_slope"), 0.9, 1);
	CHECK_BETWEEN(feature_of(&feed, "burst_last"), 0.9, 1);
	CHECK_BETWEEN(feature_of(&feed, "burst_flow"), 0.8, 1);
	feed_pursuit(&feed, -1);
	CHECK_BETWEEN(feature_of(&feed, "flow_500"), 5.3, 6);
	CHECK_BETWEEN(feature_of(&feed, "burst_slope"), -1, -0.9);
	CHECK_BETWEEN(feature_of(&feed, "burst_last"), -1, -0.9);
	CHECK_BETWEEN(feature_of(&feed, "burst_flow"), -1, -0.8);
}

/* Five degrees a second for 0.1 s, and back. */
static void what_goes_to_and_fro_goes_nowhere(void **state)
{
	(void)state;
	static struct feed feed;
	feed_open(&feed, 500);
	while (feed.time_s < 2)
		feed_point(&feed, 5 * fabs(fmod(feed.time_s, 0.2) - 0.1), 0, true);
	CHECK_BETWEEN(feature_of(&feed, "flow_500"), 0, 0.6);
	CHECK_BETWEEN(feature_of(&feed, "flow_2000"), 0, 0.2);
	CHECK_BETWEEN(feature_of(&feed, "speed_0"), 4.9, 5.1);
}

static void a_loss_is_measured_and_holds_the_place(void **state)
{
	(void)state;
	static struct feed feed;
	feed_open(&feed, 250);
	while (feed.time_s < 1)
		feed_point(&feed, 1, 1, feed.time_s < 0.5 || feed.time_s > 0.6);
	CHECK_BETWEEN(feature_of(&feed, "lost_ms"), 100, 108);
	CHECK_BETWEEN(feature_of(&feed, "since_lost_ms"), 385, 400);
	CHECK_BETWEEN(feature_of(&feed, "lost_448"), 0.10, 0.13);
	assert_true(feature_of(&feed, "distance_448") == 0);
}

static void any_samples_give_finite_features_and_the_same_again(void **state)
{
	(void)state;
	static struct feed feed, copy;
	struct gz_random random = gz_random_seeded(1, 1);
	feed_open(&feed, 500);
	for (int k = 0; k < 20000; k++) {
		uint64_t bits = gz_random_bits(&random);
		feed.period_s = bits % 5 == 0     ? 1e-9
				: bits % 101 == 0 ? 3
						  : 1e-3 * (double)(bits % 7);
		double x = gz_random_between(&random, -60, 60);
		double y = gz_random_between(&random, -60, 60);
		copy = feed;
		feed_point(&feed, x, y, bits & 1 << 20);
		feed_point(&copy, x, y, bits & 1 << 20);
		for (size_t i = 0; i < GZ_MOVEMENT_FEATURES; i++)
			assert_true(isfinite(feed.features[i]));
		assert_memory_equal(feed.features, copy.features, sizeof feed.features);
	}
}

static void samples_without_features_count_for_the_next_ones(void **state)
{
	(void)state;
	static struct feed all, some;
	struct gz_random random = gz_random_seeded(4, 4);
	feed_open(&all, 1200);
	feed_open(&some, 1200);
	for (int k = 0; k < 5000; k++) {
		double x = gz_random_normal(&random) * (k % 300 < 20 ? 5 : 0.05);
		bool valid = k % 700 > 40;
		feed_point(&all, x, x, valid);
		feed_point_to(&some, x, x, valid, k % 3 == 0 ? some.features : NULL);
		if (k % 3 == 0)
			assert_memory_equal(some.features, all.features, sizeof all.features);
	}
}

/* Forests are asked at most every 1.5 ms, but at once where something begins to be measured. */
static void forests_are_not_asked_more_often_than_they_learned(void **state)
{
	(void)state;
	static struct gz_classify_state classify;
	struct gz_classify_output out;
	const struct gz_classify_params params = gz_pipeline_default_params().classify;
	const struct gz_display display = wide_display();
	for (int i = 0; i < RATE_COUNT; i++) {
		int asked = 0, samples = (int)RATES_HZ[i];
		classify = (struct gz_classify_state) { .count = 0 };
		for (int k = 0; k < samples; k++) {
			int64_t time_ns = (int64_t)(1e9 * (k + 1) / RATES_HZ[i]);
			bool valid = k != samples / 2;
			const struct gz_classify_input input = {
				.seq = (uint64_t)k,
				.time_ns = time_ns,
				.valid = valid,
				.raw = { 0.5F, 0.5F },
				.point = { 0.5F, 0.5F },
				.confidence = 1,
			};
			gz_classify_step(&classify, &params, &display, &input, &out);
			bool now = classify.asked_ns == time_ns;
			if (k == 0 || k == samples / 2 + 1)
				assert_true(now);
			asked += now;
		}
		if (RATES_HZ[i] <= 500)
			assert_int_equal(asked, samples);
		else
			CHECK_BETWEEN(asked, 495, 670);
	}
}

/* At 1200 Hz the forest for certain labels is asked as often as the other one while a saccade may
 * be in what it labels, and at least every 7 ms in a steady fixation. */
static void certain_labels_of_a_calm_eye_are_asked_for_seldom(void **state)
{
	(void)state;
	static struct gz_classify_state classify;
	struct gz_classify_output out;
	const struct gz_classify_params params = gz_pipeline_default_params().classify;
	const struct gz_display display = wide_display();
	struct gz_random random = gz_random_seeded(7, 7);
	int calm[2] = { 0, 0 }, lively[2] = { 0, 0 };
	classify = (struct gz_classify_state) { .count = 0 };
	for (int k = 0; k < 1200; k++) {
		int64_t time_ns = (int64_t)(1e9 * (k + 1) / 1200);
		/* One saccade of 10 degrees in 30 ms, after half a second. */
		double part = fmin(1, fmax(0, (k - 600) / 36.0));
		float x = (float)(0.4 + 0.1 * part + 2e-4 * gz_random_normal(&random));
		const struct gz_classify_input input = {
			.seq = (uint64_t)k,
			.time_ns = time_ns,
			.valid = true,
			.raw = { x, 0.5F },
			.point = { x, 0.5F },
			.confidence = 1,
		};
		gz_classify_step(&classify, &params, &display, &input, &out);
		int *asked = k >= 300 && k < 600 ? calm : lively;
		if (k < 300 || k >= 620 + 60)
			continue;
		asked[0] += classify.asked_ns == time_ns;
		asked[1] += classify.asked_certain_ns == time_ns;
	}
	CHECK_BETWEEN(calm[0], 140, 160);
	CHECK_BETWEEN(calm[1], 35, 50);
	assert_true(lively[1] >= lively[0] - 3);
}

/* Lists of the questions give the scores of the trees: with the features of a resting eye, with
 * saccades and losses, and with features that are exactly at thresholds or beyond all of them. */
static void lists_of_questions_give_the_scores_of_the_trees(void **state)
{
	(void)state;
	enum { SAMPLES = 3000 };
	static const struct gz_forest *const forests[] = { &gz_forest_at_once, &gz_forest_certain };
	static struct feed feed;
	static struct gz_forest_walks walks[2];
	struct gz_random random = gz_random_seeded(3, 3);
	feed_open(&feed, 500);
	for (int k = 0; k < SAMPLES; k++) {
		double size = k % 100 < 10 ? 5 : 0.05;
		feed_point(&feed, size * gz_random_normal(&random),
			   size * gz_random_normal(&random), k % 300 > 20);
		for (int i = 0; i < 2; i++) {
			const struct gz_forest *forest = forests[i];
			const struct gz_forest_node *node =
				&forest->node[gz_random_bits(&random) % 4000];
			float features[GZ_MOVEMENT_FEATURES];
			int32_t by_trees[GZ_FOREST_CLASSES], by_lists[GZ_FOREST_CLASSES];
			memcpy(features, feed.features, sizeof features);
			if (k % 2)
				features[node->feature] = node->threshold;
			for (int f = 0; k % 5 == 0 && f < GZ_MOVEMENT_FEATURES; f++)
				features[f] = f % 2 ? 1e9F : -1e9F;
			const struct gz_forest_lists *lists = gz_forest_lists_of(forest);
			assert_non_null(lists);
			gz_forest_score(forest, features, by_trees);
			gz_forest_lists_score(lists, &walks[i], features, by_lists);
			assert_memory_equal(by_lists, by_trees, sizeof by_trees);
		}
	}
	assert_null(gz_forest_lists_of(&gz_forest_whole));
	assert_ptr_equal(gz_forest_lists_of(&gz_forest_certain),
			 gz_forest_lists_of(&gz_forest_certain));
}

/* Label samples of which one class each is the likeliest: f, s, p, n, r; '.' was not measured. */
static void label_each(const char *likeliest, char *out_labels)
{
	static const char classes[] = "fspnr";
	struct gz_forest_memory memory = { .any = false };
	size_t i = 0;
	for (; likeliest[i]; i++) {
		const char *place = strchr(classes, likeliest[i]);
		int32_t scores[GZ_FOREST_CLASSES] = { 2, 1, 0, -1, -2 };
		if (place)
			scores[place - classes] = 9999;
		out_labels[i] = classes[gz_forest_label(&memory, place ? scores : NULL, false)];
	}
	out_labels[i] = 0;
}

static void ringing_follows_saccades_only_and_else_is_the_next_likeliest(void **state)
{
	(void)state;
	char labels[16];
	label_each("fssrrpp", labels);
	assert_string_equal(labels, "fssrrpp");
	label_each("rfrrssrfr", labels);
	assert_string_equal(labels, "ffffssrff");
	label_each("ss.rrf", labels);
	assert_string_equal(labels, "ssnfff");
}

static void a_forest_that_does_not_know_ringing_never_finds_it(void **state)
{
	(void)state;
	const float features[GZ_MOVEMENT_FEATURES] = { 0 };
	int32_t scores[GZ_FOREST_CLASSES];
	assert_int_equal(gz_forest_at_once.class_count, GZ_FOREST_RINGING);
	assert_int_equal(gz_forest_certain.class_count, GZ_FOREST_CLASSES);
	gz_forest_score(&gz_forest_at_once, features, scores);
	for (int k = 0; k < GZ_FOREST_CLASSES; k++)
		assert_true((scores[k] == GZ_FOREST_NEVER) == (k == GZ_FOREST_RINGING));
}

static void features_and_forests_cost_a_few_microseconds(void **state)
{
	(void)state;
	static struct feed feed;
	struct gz_random random = gz_random_seeded(2, 2);
	enum { SAMPLES = 20000 };
	static double places[SAMPLES][2];
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < 2; i++)
			places[k][i] = gz_random_normal(&random) * (k % 400 < 20 ? 5 : 0.05);
	feed_open(&feed, 2000);
	int32_t scores[GZ_FOREST_CLASSES];
	int64_t sum = 0;
	clock_t begin = clock();
	for (int k = 0; k < SAMPLES; k++) {
		feed_point(&feed, places[k][0], places[k][1], true);
		gz_forest_score(&gz_forest_at_once, feed.features, scores);
		sum += scores[0];
		gz_forest_score(&gz_forest_certain, feed.features, scores);
		sum += scores[0];
	}
	double step_us = (double)(clock() - begin) / CLOCKS_PER_SEC * 1e6 / SAMPLES;
	print_message("%.2f us a sample (%lld)\n", step_us, (long long)sum);
	CHECK_BETWEEN(step_us, 0, 100); /* also holds with sanitizers on a busy machine */
}

TEST_SUITE(classifier)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_feature_has_a_name_of_its_own),
		cmocka_unit_test(steady_movement_gives_the_same_features_at_any_rate),
		cmocka_unit_test(a_resting_eye_has_no_movement),
		cmocka_unit_test(a_burst_is_measured),
		cmocka_unit_test(slow_movement_is_followed_across_fast_ones),
		cmocka_unit_test(what_goes_to_and_fro_goes_nowhere),
		cmocka_unit_test(a_loss_is_measured_and_holds_the_place),
		cmocka_unit_test(any_samples_give_finite_features_and_the_same_again),
		cmocka_unit_test(samples_without_features_count_for_the_next_ones),
		cmocka_unit_test(forests_are_not_asked_more_often_than_they_learned),
		cmocka_unit_test(certain_labels_of_a_calm_eye_are_asked_for_seldom),
		cmocka_unit_test(lists_of_questions_give_the_scores_of_the_trees),
		cmocka_unit_test(ringing_follows_saccades_only_and_else_is_the_next_likeliest),
		cmocka_unit_test(a_forest_that_does_not_know_ringing_never_finds_it),
		cmocka_unit_test(features_and_forests_cost_a_few_microseconds),
	};
	return cmocka_run_group_tests_name("filter.classifier", tests, NULL, NULL);
}
