#include "suite.h"

#include "filter/check.h"

#include <math.h>
#include <string.h>

#include "filter/pipeline.h"
#include "filter/validate.h"

static struct gz_display display;
static struct gz_validate_params params;

static int setup(void **state)
{
	(void)state;
	display = gz_display_default(1920, 1080);
	params = gz_pipeline_default_params().validate;
	return 0;
}

/* Both eyes are good and at the same place. */
static struct gz_sample good_sample(int64_t time_ms, float x, float y)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = time_ms * 1000000;
	sample.valid = true;
	sample.point = (struct gz_point) { x, y };
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		sample.eye[i].valid = true;
		sample.eye[i].confidence = 1;
		sample.eye[i].point = sample.point;
	}
	return sample;
}

static enum gz_rejection judge(struct gz_validate_state *state, const struct gz_sample *sample)
{
	return gz_validate_step(state, &params, &display, sample).rejection;
}

static void good_sample_passes_with_both_eyes(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(1, 0.5f, 0.5f);
	struct gz_validate_output out = gz_validate_step(&s, &params, &display, &sample);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	assert_true(out.eye_good[0] && out.eye_good[1] && !out.combined);
}

static void sample_not_newer_is_refused_and_changes_nothing(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(5, 0.5f, 0.5f);
	assert_int_equal(judge(&s, &sample), GZ_REJECT_NONE);
	struct gz_validate_state before = s;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_TIME);
	sample.host_ns -= 1;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_TIME);
	assert_memory_equal(&s, &before, sizeof s);
}

/* Rejected for @p reason if both eyes are like the changed one; accepted while one is good. */
static void check_reason(struct gz_sample bad, enum gz_rejection reason)
{
	struct gz_validate_state both = { .started = false }, one = { .started = false };
	bad.eye[1] = bad.eye[0];
	enum gz_rejection got = judge(&both, &bad);
	if (got != reason)
		fail_msg("%s instead of %s", gz_rejection_name(got), gz_rejection_name(reason));
	bad.eye[1] = good_sample(1, 0.5f, 0.5f).eye[1];
	struct gz_validate_output out = gz_validate_step(&one, &params, &display, &bad);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	assert_true(!out.eye_good[0] && out.eye_good[1]);
}

static void each_fault_of_an_eye_has_its_reason(void **state)
{
	(void)state;
	struct gz_sample sample = good_sample(1, 0.5f, 0.5f);
	sample.eye[0].valid = false;
	check_reason(sample, GZ_REJECT_TRACKER);
	sample = good_sample(1, 0.5f, 0.5f);
	sample.eye[0].confidence = 0.3f;
	check_reason(sample, GZ_REJECT_CONFIDENCE);
	sample = good_sample(1, 0.5f, 0.5f);
	sample.eye[0].point.y = INFINITY;
	check_reason(sample, GZ_REJECT_NOT_FINITE);
	sample.eye[0].point.y = NAN;
	check_reason(sample, GZ_REJECT_NOT_FINITE);
	sample = good_sample(1, 0.5f, 0.5f);
	sample.eye[0].point.x = 1.3f;
	check_reason(sample, GZ_REJECT_OFF_SCREEN);
}

static void point_within_the_margin_passes(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(1, -0.24f, 1.24f);
	assert_int_equal(judge(&s, &sample), GZ_REJECT_NONE);
}

static void confidence_that_was_not_measured_passes(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(1, 0.5f, 0.5f);
	sample.eye[0].confidence = sample.eye[1].confidence = NAN;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_NONE);
}

static void too_fast_a_jump_is_refused_until_time_allows_it(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(1, 0.2f, 0.5f);
	assert_int_equal(judge(&s, &sample), GZ_REJECT_NONE);
	int refused = 0;
	for (int64_t ms = 2; ms < 60; ms++) { /* about 30 degrees away, permanently */
		sample = good_sample(ms, 0.8f, 0.5f);
		enum gz_rejection r = judge(&s, &sample);
		if (r == GZ_REJECT_NONE)
			break;
		assert_int_equal(r, GZ_REJECT_VELOCITY);
		refused++;
	}
	CHECK_BETWEEN(refused, 20, 40);
}

static void fastest_saccade_passes(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	float per_ms = (float)(0.9 / 57.3 * display.distance_mm / display.mm[0]); /* 900 deg/s */
	for (int ms = 0; ms < 30; ms++) {
		struct gz_sample sample = good_sample(ms + 1, 0.3f + per_ms * (float)ms, 0.5f);
		assert_int_equal(judge(&s, &sample), GZ_REJECT_NONE);
	}
}

static void sudden_disparity_is_refused_and_a_lasting_one_learnt(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	int refused = 0, first = -1;
	for (int ms = 1; ms < 5000; ms++) {
		struct gz_sample sample = good_sample(ms, 0.5f, 0.5f);
		if (ms > 100)
			sample.eye[1].point.x += 0.15f; /* some 8 degrees */
		struct gz_validate_output out = gz_validate_step(&s, &params, &display, &sample);
		if (out.rejection == GZ_REJECT_NONE || ms < 100 + 20)
			continue; /* at first it is too fast for that eye */
		assert_int_equal(out.rejection, GZ_REJECT_DISPARITY);
		first = first < 0 ? ms : first;
		refused++;
	}
	CHECK_BETWEEN(first, 101, 130);
	CHECK_BETWEEN(refused, 50, 2000);
}

static void common_point_is_judged_where_no_eye_was_measured(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = 1;
	sample.valid = true;
	sample.point = (struct gz_point) { 0.4f, 0.4f };
	struct gz_validate_output out = gz_validate_step(&s, &params, &display, &sample);
	assert_true(out.combined);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	sample.host_ns = 2;
	sample.point.x = 9;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_OFF_SCREEN);
	sample.host_ns = 3;
	sample.point.x = NAN;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_NOT_FINITE);
	sample.host_ns = 4;
	sample.valid = false;
	assert_int_equal(judge(&s, &sample), GZ_REJECT_TRACKER);
}

static void an_eye_that_is_not_selected_is_ignored(void **state)
{
	(void)state;
	struct gz_validate_state s = { .started = false };
	struct gz_sample sample = good_sample(1, 0.5f, 0.5f);
	params.eyes = GZ_VALIDATE_EYES_LEFT;
	struct gz_validate_output out = gz_validate_step(&s, &params, &display, &sample);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	assert_true(out.eye_good[GZ_EYE_LEFT] && !out.eye_good[GZ_EYE_RIGHT]);
	params.eyes = GZ_VALIDATE_EYES_RIGHT;
	sample = good_sample(2, 0.5f, 0.5f);
	sample.eye[GZ_EYE_RIGHT].valid = false; /* the left eye does not replace it */
	assert_int_equal(judge(&s, &sample), GZ_REJECT_TRACKER);
	sample = good_sample(3, 0.5f, 0.5f);
	sample.eye[GZ_EYE_LEFT].point.x = 5; /* and its faults do not count */
	out = gz_validate_step(&s, &params, &display, &sample);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	assert_true(out.eye_good[GZ_EYE_RIGHT] && !out.eye_good[GZ_EYE_LEFT]);
	params.eyes = GZ_VALIDATE_EYES_BOTH;
}

static void a_tracker_with_one_point_for_both_eyes_is_used_with_any_choice(void **state)
{
	(void)state;
	for (int eyes = GZ_VALIDATE_EYES_BOTH; eyes <= GZ_VALIDATE_EYES_RIGHT; eyes++) {
		struct gz_validate_state s = { .started = false };
		struct gz_sample sample = gz_sample_unmeasured();
		sample.host_ns = 1000000;
		sample.valid = true;
		sample.point = (struct gz_point) { 0.5f, 0.5f };
		params.eyes = eyes;
		struct gz_validate_output out = gz_validate_step(&s, &params, &display, &sample);
		assert_true(out.combined && out.rejection == GZ_REJECT_NONE);
	}
	params.eyes = GZ_VALIDATE_EYES_BOTH;
}

TEST_SUITE(validate)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_sample_passes_with_both_eyes),
		cmocka_unit_test(sample_not_newer_is_refused_and_changes_nothing),
		cmocka_unit_test(each_fault_of_an_eye_has_its_reason),
		cmocka_unit_test(point_within_the_margin_passes),
		cmocka_unit_test(confidence_that_was_not_measured_passes),
		cmocka_unit_test(too_fast_a_jump_is_refused_until_time_allows_it),
		cmocka_unit_test(fastest_saccade_passes),
		cmocka_unit_test(sudden_disparity_is_refused_and_a_lasting_one_learnt),
		cmocka_unit_test(common_point_is_judged_where_no_eye_was_measured),
		cmocka_unit_test(an_eye_that_is_not_selected_is_ignored),
		cmocka_unit_test(a_tracker_with_one_point_for_both_eyes_is_used_with_any_choice),
	};
	return cmocka_run_group_tests_name("filter.validate", tests, setup, NULL);
}
