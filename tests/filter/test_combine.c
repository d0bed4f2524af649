#include "suite.h"

#include "filter/check.h"

#include <math.h>

#include "filter/combine.h"
#include "filter/pipeline.h"
#include "sim/random.h"

static struct gz_display display;
static struct gz_combine_params params;

static int setup(void **state)
{
	(void)state;
	display = gz_display_default(1920, 1080);
	params = gz_pipeline_default_params().combine;
	return 0;
}

static struct gz_point join(struct gz_combine_state *state, int64_t time_ns, bool right_good,
			    bool left_good, struct gz_point right, struct gz_point left)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.host_ns = time_ns;
	sample.eye[GZ_EYE_RIGHT].point = right;
	sample.eye[GZ_EYE_LEFT].point = left;
	sample.eye[GZ_EYE_RIGHT].confidence = 0.8f;
	sample.eye[GZ_EYE_LEFT].confidence = 1;
	struct gz_validate_output valid = { .eye_good = { right_good, left_good } };
	struct gz_combine_output out = gz_combine_step(state, &params, &display, &sample, &valid);
	double wanted = right_good && left_good ? 0.9 : right_good ? 0.8 : 1;
	CHECK_BETWEEN(out.confidence, wanted - 1e-6, wanted + 1e-6);
	return out.point;
}

static void equal_eyes_give_their_mean(void **state)
{
	(void)state;
	struct gz_combine_state s = { .eye = { { .seen = false } } };
	struct gz_point p = join(&s, 1000000, true, true, (struct gz_point) { 0.4f, 0.5f },
				 (struct gz_point) { 0.5f, 0.7f });
	CHECK_BETWEEN(p.x, 0.4499, 0.4501);
	CHECK_BETWEEN(p.y, 0.5999, 0.6001);
}

static void steadier_eye_counts_more(void **state)
{
	(void)state;
	struct gz_combine_state s = { .eye = { { .seen = false } } };
	struct gz_random random = gz_random_seeded(1, 1);
	double off2 = 0, steady2 = 0;
	for (int k = 0; k < 5000; k++) {
		float right = (float)(0.001 * gz_random_normal(&random));
		float left = (float)(0.004 * gz_random_normal(&random));
		struct gz_point p = join(&s, (k + 1) * INT64_C(2000000), true, true,
					 (struct gz_point) { 0.5f + right, 0.5f },
					 (struct gz_point) { 0.5f + left, 0.5f });
		if (k < 2000)
			continue;
		off2 += pow(p.x - 0.5, 2);
		steady2 += pow(right, 2);
	}
	/* The best weights give 0.97 of the noise of the steadier eye; equal weights would
	 * give 2.06. */
	CHECK_BETWEEN(sqrt(off2 / steady2), 0.9, 1.02);
}

static void point_stays_when_an_eye_leaves_and_returns(void **state)
{
	(void)state;
	for (int leaver = 0; leaver < 2; leaver++) {
		struct gz_combine_state s = { .eye = { { .seen = false } } };
		struct gz_point right = { 0.40f, 0.52f }, left = { 0.44f, 0.48f };
		for (int k = 0; k < 3000; k++) {
			bool away = k % 300 > 150;
			struct gz_point p =
				join(&s, (k + 1) * INT64_C(2000000), !(away && leaver == 0),
				     !(away && leaver == 1), right, left);
			CHECK_BETWEEN(p.x, 0.4199, 0.4201);
			CHECK_BETWEEN(p.y, 0.4999, 0.5001);
		}
	}
}

static void second_eye_coming_in_later_does_not_move_the_point_at_once(void **state)
{
	(void)state;
	struct gz_combine_state s = { .eye = { { .seen = false } } };
	struct gz_point right = { 0.40f, 0.5f }, left = { 0.50f, 0.5f }, p, last = right;
	for (int k = 0; k < 2000; k++) {
		p = join(&s, (k + 1) * INT64_C(2000000), true, k > 100, right, left);
		CHECK_BETWEEN(fabsf(p.x - last.x), 0, 0.002);
		last = p;
	}
	CHECK_BETWEEN(p.x, 0.4499, 0.4501); /* and reaches the mean in the end */
}

static void common_point_passes_through(void **state)
{
	(void)state;
	struct gz_combine_state s = { .eye = { { .seen = false } } };
	struct gz_sample sample = gz_sample_unmeasured();
	sample.point = (struct gz_point) { 0.1f, 0.9f };
	struct gz_validate_output valid = { .combined = true };
	struct gz_combine_output out = gz_combine_step(&s, &params, &display, &sample, &valid);
	assert_true(out.point.x == 0.1f && out.point.y == 0.9f && out.confidence == 1);
}

TEST_SUITE(combine)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(equal_eyes_give_their_mean),
		cmocka_unit_test(steadier_eye_counts_more),
		cmocka_unit_test(point_stays_when_an_eye_leaves_and_returns),
		cmocka_unit_test(second_eye_coming_in_later_does_not_move_the_point_at_once),
		cmocka_unit_test(common_point_passes_through),
	};
	return cmocka_run_group_tests_name("filter.combine", tests, setup, NULL);
}
