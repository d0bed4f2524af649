/* When an isovalue rests that the user changes. */
#include "suite.h"

#include "view/frame/isovalue_rest.h"

#define LONG_NS (10 * GZ_ISOVALUE_REST_NS)

static void first_isovalue_of_a_scene_rests_at_once(void **state)
{
	(void)state;
	struct gz_isovalue_rest rest = { 0 };
	assert_false(gz_isovalue_rest_step(&rest, 7, false, 5));
	assert_false(gz_isovalue_rest_step(&rest, 7, true, LONG_NS));
}

static void changed_isovalue_moves_until_it_has_stayed_for_a_while(void **state)
{
	(void)state;
	struct gz_isovalue_rest rest = { 0 };
	gz_isovalue_rest_step(&rest, 7, false, 0);
	assert_true(gz_isovalue_rest_step(&rest, 8, false, LONG_NS));
	assert_int_equal(gz_isovalue_rest_left_ns(&rest, LONG_NS + 1), GZ_ISOVALUE_REST_NS - 1);
	/* each change begins again, back to the first value too */
	const int64_t again_ns = LONG_NS + GZ_ISOVALUE_REST_NS - 1;
	assert_true(gz_isovalue_rest_step(&rest, 7, false, again_ns));
	assert_true(gz_isovalue_rest_step(&rest, 7, false, again_ns + GZ_ISOVALUE_REST_NS - 1));
	assert_false(gz_isovalue_rest_step(&rest, 7, false, again_ns + GZ_ISOVALUE_REST_NS));
	assert_false(gz_isovalue_rest_step(&rest, 7, false, again_ns + LONG_NS));
}

static void isovalue_of_a_slider_that_is_held_does_not_rest(void **state)
{
	(void)state;
	struct gz_isovalue_rest rest = { 0 };
	gz_isovalue_rest_step(&rest, 7, true, 0);
	assert_true(gz_isovalue_rest_step(&rest, 8, true, 1));
	assert_true(gz_isovalue_rest_step(&rest, 8, true, LONG_NS));
	assert_int_equal(gz_isovalue_rest_left_ns(&rest, LONG_NS), 0);
	assert_false(gz_isovalue_rest_step(&rest, 8, false, LONG_NS));
}

TEST_SUITE(isovalue_rest)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(first_isovalue_of_a_scene_rests_at_once),
		cmocka_unit_test(changed_isovalue_moves_until_it_has_stayed_for_a_while),
		cmocka_unit_test(isovalue_of_a_slider_that_is_held_does_not_rest),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
