#include "suite.h"

#include "filter/check.h"

#include <math.h>
#include <string.h>

#include "filter/combine.h"
#include "filter/pipeline.h"

static struct gz_pipeline_params presets;

static int setup(void **state)
{
	(void)state;
	presets = gz_pipeline_default_params();
	return 0;
}

static void presets_change_no_bit(void **state)
{
	(void)state;
	for (int i = 0; i < 1000; i++) {
		struct gz_point p = { (float)sin(i) * 1.3f, (float)cos(7 * i) / 3 };
		struct gz_point q = gz_correct_point(&presets.correct, p);
		assert_memory_equal(&p, &q, sizeof p);
	}
}

static void a_point_is_moved_turned_and_scaled(void **state)
{
	(void)state;
	struct gz_correct_params params = { { 0.1, 2, 0.5 }, { -0.2, 0.25, 4 } };
	struct gz_point p = gz_correct_point(&params, (struct gz_point) { 0.5f, 0.25f });
	CHECK_BETWEEN(p.x, 1.2249999, 1.2250001);
	CHECK_BETWEEN(p.y, 0.9249999, 0.9250001);
}

static void a_point_that_was_not_measured_stays_as_it_is(void **state)
{
	(void)state;
	struct gz_correct_params params = { { 0.1, 1, 1 }, { 0.1, 1, 2 } };
	struct gz_point p = gz_correct_point(&params, (struct gz_point) { 0.5f, NAN });
	assert_true(p.x == 0.5f && isnan(p.y));
	p = gz_correct_point(&params, (struct gz_point) { INFINITY, 0.5f });
	assert_true(isinf(p.x) && p.y == 0.5f);
}

static void a_map_without_area_or_not_finite_is_refused(void **state)
{
	(void)state;
	static const struct gz_correct_params refused[] = {
		{ { 0, 0, 0 }, { 0, 0, 1 } },   { { 0, 1, 0 }, { 0, 1, 0 } },
		{ { 0, 2, 4 }, { 0, 1, 2 } },   { { 0, 0.05, 0 }, { 0, 0, 0.1 } },
		{ { NAN, 1, 0 }, { 0, 0, 1 } }, { { 0, 1, 0 }, { 0, INFINITY, 1 } },
	};
	char message[256];
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
		struct gz_pipeline_params params = presets;
		params.correct = refused[i];
		message[0] = '\0';
		assert_false(gz_correct_usable(&refused[i]));
		assert_int_equal(gz_pipeline_check_params(&params, message, sizeof message),
				 GZ_ERR_INVAL);
		assert_non_null(strstr(message, "pipeline.correction"));
	}
	assert_int_equal(gz_pipeline_check_params(&presets, message, sizeof message), GZ_OK);
	struct gz_correct_params mirror = { { 1, -1, 0 }, { 0, 0, 1 } };
	assert_true(gz_correct_usable(&mirror));
}

static struct gz_sample both_eyes(float x, float y)
{
	struct gz_sample sample = gz_sample_unmeasured();
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		sample.eye[i].point = (struct gz_point) { x, y };
		sample.eye[i].valid = true;
	}
	sample.host_ns = 1000000000;
	return sample;
}

static void eyes_and_common_point_come_out_of_the_pipeline_corrected(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline_params params = presets;
	params.correct = (struct gz_correct_params) { { 0.01, 1.1, 0 }, { 0, 0, 0.9 } };
	struct gz_pipeline pipeline;
	struct gz_pipeline_output out;
	struct gz_sample sample = both_eyes(0.5f, 0.5f);
	gz_pipeline_init(&pipeline, &params, &display);
	gz_pipeline_step(&pipeline, &sample, &out);
	CHECK_BETWEEN(out.gaze.raw.x, 0.55999, 0.56001);
	CHECK_BETWEEN(out.gaze.point.y, 0.44999, 0.45001);
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		CHECK_BETWEEN(out.gaze.eye[i].point.x, 0.55999, 0.56001);
	sample = gz_sample_unmeasured();
	sample.point = (struct gz_point) { 0.5f, 0.5f };
	sample.valid = true;
	sample.host_ns = 1000000000;
	gz_pipeline_init(&pipeline, &params, &display);
	gz_pipeline_step(&pipeline, &sample, &out);
	CHECK_BETWEEN(out.gaze.raw.x, 0.55999, 0.56001);
}

static void validity_is_judged_before_correction(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline_params params = presets;
	params.correct = (struct gz_correct_params) { { -5, 1, 0 }, { 0, 0, 1 } };
	struct gz_pipeline pipeline;
	struct gz_pipeline_output out;
	struct gz_sample sample = both_eyes(0.5f, 0.5f);
	gz_pipeline_init(&pipeline, &params, &display);
	gz_pipeline_step(&pipeline, &sample, &out);
	assert_int_equal(out.rejection, GZ_REJECT_NONE);
	CHECK_BETWEEN(out.gaze.point.x, -4.5001, -4.4999);
	sample = both_eyes(5.5f, 0.5f); /* the correction would move it back inside */
	sample.host_ns += 1000000000;
	gz_pipeline_step(&pipeline, &sample, &out);
	assert_int_equal(out.rejection, GZ_REJECT_OFF_SCREEN);
}

TEST_SUITE(correct)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(presets_change_no_bit),
		cmocka_unit_test(a_point_is_moved_turned_and_scaled),
		cmocka_unit_test(a_point_that_was_not_measured_stays_as_it_is),
		cmocka_unit_test(a_map_without_area_or_not_finite_is_refused),
		cmocka_unit_test(eyes_and_common_point_come_out_of_the_pipeline_corrected),
		cmocka_unit_test(validity_is_judged_before_correction),
	};
	return cmocka_run_group_tests_name("filter.correct", tests, setup, NULL);
}
