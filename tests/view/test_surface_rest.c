/* When a surface rests that the user changes. */
#include "suite.h"

#include "view/frame/surface_rest.h"

#define LONG_NS (10 * GZ_SURFACE_REST_NS)

static bool take(struct gz_surface_rest *rest, double isovalue, bool held, int64_t now_ns)
{
	const struct gz_surface_state state = { .isovalue = isovalue };
	return gz_surface_rest_step(rest, &state, held, now_ns);
}

static void first_isovalue_of_a_scene_rests_at_once(void **state)
{
	(void)state;
	struct gz_surface_rest rest = { 0 };
	assert_false(take(&rest, 7, false, 5));
	assert_false(take(&rest, 7, true, LONG_NS));
}

static void changed_isovalue_moves_until_it_has_stayed_for_a_while(void **state)
{
	(void)state;
	struct gz_surface_rest rest = { 0 };
	take(&rest, 7, false, 0);
	assert_true(take(&rest, 8, false, LONG_NS));
	assert_int_equal(gz_surface_rest_left_ns(&rest, LONG_NS + 1), GZ_SURFACE_REST_NS - 1);
	/* each change begins again, back to the first value too */
	const int64_t again_ns = LONG_NS + GZ_SURFACE_REST_NS - 1;
	assert_true(take(&rest, 7, false, again_ns));
	assert_true(take(&rest, 7, false, again_ns + GZ_SURFACE_REST_NS - 1));
	assert_false(take(&rest, 7, false, again_ns + GZ_SURFACE_REST_NS));
	assert_false(take(&rest, 7, false, again_ns + LONG_NS));
}

static void isovalue_of_a_slider_that_is_held_does_not_rest(void **state)
{
	(void)state;
	struct gz_surface_rest rest = { 0 };
	take(&rest, 7, true, 0);
	assert_true(take(&rest, 8, true, 1));
	assert_true(take(&rest, 8, true, LONG_NS));
	assert_int_equal(gz_surface_rest_left_ns(&rest, LONG_NS), 0);
	assert_false(take(&rest, 8, false, LONG_NS));
}

static void surface_of_another_time_point_moves_too(void **state)
{
	(void)state;
	struct gz_surface_rest rest = { 0 };
	struct gz_surface_state surface = { .isovalue = 7, .time_point = 1 };
	assert_false(gz_surface_rest_step(&rest, &surface, false, 0));
	surface.time_point = 2;
	assert_true(gz_surface_rest_step(&rest, &surface, false, LONG_NS));
	assert_false(gz_surface_rest_step(&rest, &surface, false, 2 * LONG_NS));
}

TEST_SUITE(surface_rest)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(first_isovalue_of_a_scene_rests_at_once),
		cmocka_unit_test(changed_isovalue_moves_until_it_has_stayed_for_a_while),
		cmocka_unit_test(isovalue_of_a_slider_that_is_held_does_not_rest),
		cmocka_unit_test(surface_of_another_time_point_moves_too),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
