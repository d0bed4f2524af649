/* Importance by gaze: what is looked at is raised, one object at a time, without jumps. */
#include "suite.h"

#include <math.h>

#include "base/clock.h"
#include "render/attention/interest.h"

#define FRAME_NS (10 * GZ_NS_PER_MS)

static struct gz_attention_params all_of_it(void)
{
	struct gz_attention_params params = gz_attention_default();
	params.importance = 1;
	return params;
}

/* Look at something for some frames. */
static void look_at_thing(struct gz_interest *interest, const struct gz_looked_at *thing,
			  int frames)
{
	const struct gz_attention_params params = all_of_it();
	for (int i = 0; i < frames; i++)
		*interest =
			gz_interest_step(*interest, &params, thing, interest->now_ns + FRAME_NS);
}

static void look(struct gz_interest *interest, uint32_t object, int frames)
{
	look_at_thing(interest, &(struct gz_looked_at) { .id = object }, frames);
}

static struct gz_raised raised(const struct gz_interest *interest)
{
	const struct gz_attention_params params = all_of_it();
	return gz_interest_raised(interest, &params);
}

static void object_is_raised_after_a_look_and_fades_in(void **state)
{
	(void)state;
	struct gz_interest interest = { 0 };
	double before = 0;
	look(&interest, 0, 10);
	assert_true(gz_interest_at_rest(&interest));
	look(&interest, 7, 20); /* 190 ms since the first of them */
	assert_int_equal(raised(&interest).id, 0);
	assert_false(gz_interest_at_rest(&interest));
	look(&interest, 7, 1);
	for (int i = 1; i <= 20; i++) {
		look(&interest, 7, 1);
		const struct gz_raised now = raised(&interest);
		assert_int_equal(now.id, 7);
		/* The steepest part of the curve rises 1.5 times as fast as a line. */
		assert_true(now.share > before && now.share - before <= 1.5 / 20 + 1e-9);
		before = now.share;
		if (i == 10)
			assert_float_equal(now.share, 0.5, 1e-9);
	}
	assert_float_equal(before, 1, 1e-9);
	assert_true(gz_interest_at_rest(&interest));
}

static void one_object_fades_out_before_another_fades_in(void **state)
{
	(void)state;
	struct gz_interest interest = { 0 };
	look(&interest, 7, 60);
	look(&interest, 9, 15); /* a glance */
	assert_true(raised(&interest).id == 7 && raised(&interest).share == 1);
	look(&interest, 7, 5);
	look(&interest, 9, 21);
	double before = 1;
	for (int i = 0; i < 45; i++) {
		const struct gz_raised now = raised(&interest);
		assert_true(fabs(now.share - before) < 0.08);
		assert_true(now.id == 7 || now.id == 9 || now.share == 0);
		before = now.share;
		look(&interest, 9, 1);
	}
	assert_true(raised(&interest).id == 9 && before == 1);
	look(&interest, 0, 45);
	assert_int_equal(raised(&interest).id, 0);
	assert_true(gz_interest_at_rest(&interest));
}

static void time_that_stands_or_runs_back_changes_nothing(void **state)
{
	(void)state;
	const struct gz_attention_params params = all_of_it();
	struct gz_interest interest = { 0 };
	look(&interest, 7, 30);
	const struct gz_raised before = raised(&interest);
	const struct gz_looked_at seven = { .id = 7 };
	interest = gz_interest_step(interest, &params, &seven, interest.now_ns);
	interest = gz_interest_step(interest, &params, &seven, interest.now_ns - GZ_NS_PER_S);
	const struct gz_raised after = raised(&interest);
	assert_true(before.share > 0 && gz_raised_same(&before, &after));
}

static void share_of_the_setting_is_raised(void **state)
{
	(void)state;
	struct gz_attention_params params = all_of_it();
	struct gz_interest interest = { 0 };
	look(&interest, 7, 60);
	params.importance = 0.25;
	const struct gz_raised quarter = gz_interest_raised(&interest, &params);
	assert_float_equal(gz_raised_importance(0.2, quarter.share), 0.4, 1e-12);
	assert_float_equal(gz_raised_importance(0.2, 0), 0.2, 0);
	assert_float_equal(gz_raised_importance(0.2, 1), 1, 1e-12);
	params.importance = 0;
	assert_int_equal(gz_interest_raised(&interest, &params).id, 0);
}

static void values_that_look_alike_are_one_thing(void **state)
{
	(void)state;
	struct gz_interest interest = { 0 };
	const struct gz_looked_at skin = { 1, 0.3, 0.2, 0.4 }, more_skin = { 1, 0.39, 0.25, 0.5 };
	const struct gz_looked_at bone = { 1, 0.7, 0.5, 1 };
	look_at_thing(&interest, &skin, 60);
	assert_true(raised(&interest).share == 1 && raised(&interest).least == 0.2);
	/* Its range does not change while it is looked at. */
	look_at_thing(&interest, &more_skin, 60);
	assert_true(raised(&interest).greatest == 0.4 && gz_interest_at_rest(&interest));
	look_at_thing(&interest, &bone, 30);
	assert_true(raised(&interest).share < 1 && raised(&interest).greatest == 0.4);
	/* Back before bone has come: the skin comes again. */
	look_at_thing(&interest, &more_skin, 60);
	assert_true(raised(&interest).share == 1 && raised(&interest).greatest == 0.4);
	look_at_thing(&interest, &bone, 90);
	assert_true(raised(&interest).share == 1 && raised(&interest).least == 0.5);
	/* A value beside the range is another thing; so is an object of the same number. */
	look_at_thing(&interest, &(struct gz_looked_at) { 1, 0.45, 0.41, 0.499 }, 90);
	assert_true(raised(&interest).least == 0.41 && raised(&interest).share == 1);
	look(&interest, 1, 90);
	assert_true(raised(&interest).greatest == 0 && raised(&interest).share == 1);
}

TEST_SUITE(interest)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(object_is_raised_after_a_look_and_fades_in),
		cmocka_unit_test(one_object_fades_out_before_another_fades_in),
		cmocka_unit_test(time_that_stands_or_runs_back_changes_nothing),
		cmocka_unit_test(share_of_the_setting_is_raised),
		cmocka_unit_test(values_that_look_alike_are_one_thing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
