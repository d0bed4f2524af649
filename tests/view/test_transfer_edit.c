/* What is edited stays a valid transfer function, and every step can be taken back. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "view/panels/transfer_edit.h"

static const struct gz_transfer four = {
	.count = 4,
	.points = { { 0, { 0, 0, 0 }, 0 },
		    { 0.25, { 1, 0, 0 }, 0.1 },
		    { 0.5, { 0, 1, 0 }, 0.2 },
		    { 1, { 1, 1, 1 }, 1 } },
};

static struct gz_transfer_edit *begun(const struct gz_transfer *transfer)
{
	struct gz_transfer_edit *edit;
	assert_int_equal(gz_transfer_edit_create(transfer, &edit), GZ_OK);
	assert_false(gz_transfer_edit_differs(edit));
	assert_false(gz_transfer_edit_can_undo(edit));
	return edit;
}

static void assert_valid(const struct gz_transfer_edit *edit)
{
	const struct gz_transfer *now = gz_transfer_edit_now(edit);
	assert_true(now->count >= 1 && now->count <= GZ_TRANSFER_POINTS_MAX);
	for (size_t i = 0; i < now->count; i++) {
		const struct gz_transfer_point *p = &now->points[i];
		assert_true(p->value >= 0 && p->value <= 1 && p->opacity >= 0 && p->opacity <= 1);
		for (int k = 0; k < 3; k++)
			assert_true(p->rgb[k] >= 0 && p->rgb[k] <= 1);
		assert_true(i < 1 || p->value >= p[-1].value);
		assert_true(i < 2 || p->value > p[-2].value);
	}
}

static const struct gz_transfer_point *point(const struct gz_transfer_edit *edit, size_t i)
{
	return &gz_transfer_edit_now(edit)->points[i];
}

static void point_is_added_on_the_curve_with_its_colour(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	assert_int_equal(gz_transfer_edit_add(edit, 0.375, 0.7), 2);
	assert_int_equal(gz_transfer_edit_now(edit)->count, 5);
	assert_true(point(edit, 2)->value == 0.375 && point(edit, 2)->opacity == 0.7);
	assert_true(point(edit, 2)->rgb[0] == 0.5 && point(edit, 2)->rgb[1] == 0.5);
	assert_true(point(edit, 3)->value == 0.5);
	assert_true(gz_transfer_edit_differs(edit));
	assert_int_equal(gz_transfer_edit_add(edit, -3, 7), 1);
	assert_true(point(edit, 1)->value == 0 && point(edit, 1)->opacity == 1);
	assert_valid(edit);
	gz_transfer_edit_destroy(&edit);
	assert_null(edit);
}

static void third_point_of_a_value_and_one_too_many_are_refused(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	assert_int_equal(gz_transfer_edit_add(edit, 0.5, 0), 3);
	const uint64_t changes = gz_transfer_edit_changes(edit);
	assert_int_equal(gz_transfer_edit_add(edit, 0.5, 0), GZ_TRANSFER_EDIT_NONE);
	assert_int_equal(gz_transfer_edit_changes(edit), changes);
	for (int i = 0; gz_transfer_edit_now(edit)->count < GZ_TRANSFER_POINTS_MAX; i++) {
		assert_true(gz_transfer_edit_has_room(edit));
		assert_int_not_equal(gz_transfer_edit_add(edit, (i + 0.5) / 300, 0.5),
				     GZ_TRANSFER_EDIT_NONE);
	}
	assert_false(gz_transfer_edit_has_room(edit));
	assert_int_equal(gz_transfer_edit_add(edit, 0.999, 0), GZ_TRANSFER_EDIT_NONE);
	assert_valid(edit);
	gz_transfer_edit_destroy(&edit);
}

static void last_point_cannot_be_removed(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	assert_false(gz_transfer_edit_remove(edit, 4));
	assert_true(gz_transfer_edit_remove(edit, 1));
	assert_true(point(edit, 1)->value == 0.5);
	assert_true(gz_transfer_edit_remove(edit, 2));
	assert_true(gz_transfer_edit_remove(edit, 0));
	assert_false(gz_transfer_edit_remove(edit, 0));
	assert_int_equal(gz_transfer_edit_now(edit)->count, 1);
	gz_transfer_edit_destroy(&edit);
}

static void moved_point_stops_at_its_neighbours(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	gz_transfer_edit_move(edit, 1, 0.8, 0.3);
	assert_true(point(edit, 1)->value == 0.5 && point(edit, 1)->opacity == 0.3);
	gz_transfer_edit_move(edit, 1, -1, 2);
	assert_true(point(edit, 1)->value == 0 && point(edit, 1)->opacity == 1);
	gz_transfer_edit_move(edit, 1, 0.3, NAN);
	assert_true(point(edit, 1)->value == 0.3 && point(edit, 1)->opacity == 1);
	gz_transfer_edit_move(edit, 1, NAN, 0.5);
	assert_true(point(edit, 1)->value == 0.3 && point(edit, 1)->opacity == 0.5);
	gz_transfer_edit_move(edit, 9, 0.1, 0.1);
	assert_valid(edit);
	gz_transfer_edit_destroy(&edit);
}

static void pair_is_not_made_three(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	gz_transfer_edit_move(edit, 1, 0.5, 0.1); /* a step at 0.5 */
	assert_true(point(edit, 1)->value == point(edit, 2)->value);
	gz_transfer_edit_move(edit, 3, 0, 1);
	assert_true(point(edit, 3)->value == 0.5 + GZ_TRANSFER_EDIT_GAP);
	gz_transfer_edit_move(edit, 0, 1, 0);
	assert_true(point(edit, 0)->value == 0.5 - GZ_TRANSFER_EDIT_GAP);
	assert_valid(edit);
	gz_transfer_edit_destroy(&edit);
}

static void colour_is_brought_within_and_its_step_taken_back(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	gz_transfer_edit_colour(edit, 2, (const double[3]) { -1, 0.5, 2 });
	assert_true(point(edit, 2)->rgb[0] == 0 && point(edit, 2)->rgb[1] == 0.5 &&
		    point(edit, 2)->rgb[2] == 1);
	assert_true(gz_transfer_edit_undo(edit));
	assert_true(point(edit, 2)->rgb[1] == 1);
	assert_false(gz_transfer_edit_differs(edit));
	gz_transfer_edit_destroy(&edit);
}

static void drag_is_one_step_and_none_if_it_ends_where_it_began(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	gz_transfer_edit_begin(edit);
	for (int i = 0; i < 50; i++)
		gz_transfer_edit_move(edit, 1, 0.25 + i * 0.001, 0.1 + i * 0.01);
	gz_transfer_edit_end(edit);
	gz_transfer_edit_begin(edit);
	gz_transfer_edit_move(edit, 2, 0.7, 0.7);
	gz_transfer_edit_move(edit, 2, 0.5, 0.2);
	gz_transfer_edit_end(edit);
	gz_transfer_edit_begin(edit);
	gz_transfer_edit_end(edit);
	assert_true(gz_transfer_edit_undo(edit));
	assert_true(point(edit, 1)->value == 0.25 && point(edit, 1)->opacity == 0.1);
	assert_false(gz_transfer_edit_undo(edit));
	assert_true(gz_transfer_edit_redo(edit));
	assert_true(point(edit, 1)->value == 0.25 + 49 * 0.001);
	assert_false(gz_transfer_edit_redo(edit));
	gz_transfer_edit_destroy(&edit);
}

static void undo_within_a_drag_takes_the_drag_back(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	gz_transfer_edit_begin(edit);
	gz_transfer_edit_move(edit, 1, 0.3, 0.3);
	assert_true(gz_transfer_edit_undo(edit));
	assert_true(point(edit, 1)->value == 0.25);
	/* What still comes of that drag is a step of its own. */
	gz_transfer_edit_move(edit, 1, 0.35, 0.3);
	gz_transfer_edit_move(edit, 1, 0.4, 0.3);
	assert_true(gz_transfer_edit_undo(edit));
	assert_true(point(edit, 1)->value == 0.35);
	gz_transfer_edit_destroy(&edit);
}

static void hundred_steps_are_kept_and_a_new_one_ends_what_could_be_redone(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	for (int i = 1; i <= 130; i++)
		gz_transfer_edit_move(edit, 1, 0.25, i / 1000.0 + 0.2);
	int steps = 0;
	while (gz_transfer_edit_undo(edit))
		steps++;
	assert_int_equal(steps, GZ_TRANSFER_EDIT_STEPS);
	assert_true(point(edit, 1)->opacity == 30 / 1000.0 + 0.2);
	for (int i = 0; i < 40; i++)
		assert_true(gz_transfer_edit_redo(edit));
	assert_true(point(edit, 1)->opacity == 70 / 1000.0 + 0.2);
	gz_transfer_edit_interpolate(edit, GZ_TRANSFER_QUADRATIC);
	assert_false(gz_transfer_edit_can_redo(edit));
	assert_int_equal(gz_transfer_edit_now(edit)->interpolation, GZ_TRANSFER_QUADRATIC);
	for (int i = 0; i < 41; i++)
		assert_true(gz_transfer_edit_undo(edit));
	assert_true(point(edit, 1)->opacity == 30 / 1000.0 + 0.2);
	gz_transfer_edit_destroy(&edit);
}

static void range_is_set_taken_away_and_refused_if_it_is_none(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	static const double refused[][2] = { { 1, 1 }, { 2, 1 }, { NAN, 1 }, { 0, INFINITY } };
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
		assert_false(gz_transfer_edit_range(edit, refused[i]));
	assert_false(gz_transfer_edit_can_undo(edit));
	assert_true(gz_transfer_edit_range(edit, NULL));
	assert_false(gz_transfer_edit_can_undo(edit));
	assert_true(gz_transfer_edit_range(edit, (const double[2]) { -1000, 2000 }));
	assert_true(gz_transfer_edit_now(edit)->has_range);
	assert_true(gz_transfer_edit_now(edit)->range[1] == 2000);
	assert_true(gz_transfer_edit_differs(edit));
	assert_true(gz_transfer_edit_range(edit, NULL));
	assert_false(gz_transfer_edit_now(edit)->has_range);
	assert_false(gz_transfer_edit_differs(edit));
	gz_transfer_edit_destroy(&edit);
}

static void what_is_replaced_comes_back_and_what_is_saved_does_not_differ(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	const struct gz_transfer one = { .count = 1, .points = { { 0.5, { 1, 1, 1 }, 0.5 } } };
	gz_transfer_edit_replace(edit, &one);
	gz_transfer_edit_replace(edit, &one); /* nothing */
	assert_int_equal(gz_transfer_edit_now(edit)->count, 1);
	assert_true(gz_transfer_edit_differs(edit));
	gz_transfer_edit_saved(edit);
	assert_false(gz_transfer_edit_differs(edit));
	assert_true(gz_transfer_edit_undo(edit));
	assert_int_equal(gz_transfer_edit_now(edit)->count, 4);
	assert_true(gz_transfer_edit_differs(edit));
	const uint64_t changes = gz_transfer_edit_changes(edit);
	assert_true(gz_transfer_edit_is(edit, &four));
	assert_false(gz_transfer_edit_is(edit, &one));
	gz_transfer_edit_restart(edit, &one);
	assert_true(gz_transfer_edit_is(edit, &one));
	assert_int_not_equal(gz_transfer_edit_changes(edit), changes);
	assert_false(gz_transfer_edit_differs(edit) || gz_transfer_edit_can_undo(edit) ||
		     gz_transfer_edit_can_redo(edit));
	gz_transfer_edit_destroy(&edit);
}

static void assert_step_names(struct gz_transfer_edit *edit, const char *name)
{
	assert_string_equal(gz_transfer_edit_step_name(edit, false), name);
	assert_null(gz_transfer_edit_step_name(edit, true));
	assert_true(gz_transfer_edit_undo(edit));
	assert_string_equal(gz_transfer_edit_step_name(edit, true), name);
	assert_true(gz_transfer_edit_redo(edit));
}

static void step_is_named_by_what_it_does(void **state)
{
	(void)state;
	static const struct gz_transfer one = { .count = 1, .points = { { 0, { 0, 0, 0 }, 1 } } };
	static const double red[3] = { 1, 0, 0 }, range[2] = { -5, 7 };
	struct gz_transfer_edit *edit = begun(&four);
	assert_null(gz_transfer_edit_step_name(edit, false));
	assert_null(gz_transfer_edit_step_name(edit, true));
	gz_transfer_edit_add(edit, 0.375, 0.7);
	assert_step_names(edit, "point added");
	gz_transfer_edit_begin(edit);
	gz_transfer_edit_move(edit, 2, 0.4, 0.1);
	gz_transfer_edit_move(edit, 2, 0.4, 0.2);
	assert_step_names(edit, "point moved");
	gz_transfer_edit_colour(edit, 2, red);
	assert_step_names(edit, "point coloured");
	gz_transfer_edit_remove(edit, 2);
	assert_step_names(edit, "point removed");
	gz_transfer_edit_range(edit, range);
	assert_step_names(edit, "range");
	gz_transfer_edit_interpolate(edit, GZ_TRANSFER_QUADRATIC);
	assert_step_names(edit, "interpolation");
	gz_transfer_edit_replace(edit, &one);
	assert_step_names(edit, "points replaced");
	gz_transfer_edit_destroy(&edit);
}

static void nearest_point_is_found_within_reach(void **state)
{
	(void)state;
	struct gz_transfer_edit *edit = begun(&four);
	/* A plot of 400 times 100 px. */
	struct gz_transfer_place place = { 0.26, 0.15, 400, 100, false };
	assert_int_equal(gz_transfer_edit_nearest(edit, &place, 8), 1);
	place.height = 0.25;
	assert_int_equal(gz_transfer_edit_nearest(edit, &place, 8), GZ_TRANSFER_EDIT_NONE);
	place = (struct gz_transfer_place) { 0.25, gz_transfer_axis_of(0.1, true), 400, 100, true };
	assert_int_equal(gz_transfer_edit_nearest(edit, &place, 1), 1);
	gz_transfer_edit_destroy(&edit);
}

static void axis_of_opacity_leads_back_and_spreads_small_ones(void **state)
{
	(void)state;
	for (double a = 0; a <= 1; a += 1 / 64.0) {
		assert_float_equal(gz_transfer_axis_opacity(gz_transfer_axis_of(a, true), true), a,
				   1e-12);
		assert_true(gz_transfer_axis_opacity(gz_transfer_axis_of(a, false), false) == a);
	}
	assert_true(gz_transfer_axis_of(0, true) == 0 && gz_transfer_axis_of(1, true) == 1);
	assert_float_equal(gz_transfer_axis_of(0.01, true), 0.5, 0.01);
	assert_true(gz_transfer_axis_opacity(7, true) == 1 &&
		    gz_transfer_axis_opacity(-7, true) == 0);
}

TEST_SUITE(transfer_edit)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(point_is_added_on_the_curve_with_its_colour),
		cmocka_unit_test(third_point_of_a_value_and_one_too_many_are_refused),
		cmocka_unit_test(last_point_cannot_be_removed),
		cmocka_unit_test(moved_point_stops_at_its_neighbours),
		cmocka_unit_test(pair_is_not_made_three),
		cmocka_unit_test(colour_is_brought_within_and_its_step_taken_back),
		cmocka_unit_test(drag_is_one_step_and_none_if_it_ends_where_it_began),
		cmocka_unit_test(undo_within_a_drag_takes_the_drag_back),
		cmocka_unit_test(hundred_steps_are_kept_and_a_new_one_ends_what_could_be_redone),
		cmocka_unit_test(range_is_set_taken_away_and_refused_if_it_is_none),
		cmocka_unit_test(what_is_replaced_comes_back_and_what_is_saved_does_not_differ),
		cmocka_unit_test(step_is_named_by_what_it_does),
		cmocka_unit_test(nearest_point_is_found_within_reach),
		cmocka_unit_test(axis_of_opacity_leads_back_and_spreads_small_ones),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
