#include "suite.h"

#include "protocol/display.h"

#include "near.h"

static const double PI = 3.14159265358979323846;

static void display_default_is_50_4_degrees_wide(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(2560, 1440);
	assert_true(gz_display_valid(&display));
	double width_deg = gz_display_angle_deg(&display, (struct gz_point) { 0, 0.5f },
						(struct gz_point) { 1, 0.5f });
	assert_near(width_deg, 50.4, 1e-9);
	assert_near(display.mm[1] / display.mm[0], 1440.0 / 2560.0, 1e-12);
	assert_near(display.distance_mm, 600, 0);
}

static void display_field_out_of_range_is_not_valid(void **state)
{
	(void)state;
	const struct gz_display good = gz_display_default(1920, 1080);
	const double lengths[] = { 0, -1, NAN, INFINITY };
	for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
		struct gz_display display = good;
		display.mm[0] = lengths[i];
		assert_false(gz_display_valid(&display));
		display = good;
		display.mm[1] = lengths[i];
		assert_false(gz_display_valid(&display));
		display = good;
		display.distance_mm = lengths[i];
		assert_false(gz_display_valid(&display));
	}
	const int sides[] = { 0, -1, 32769 };
	for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
		struct gz_display display = good;
		display.px[i % 2] = sides[i];
		assert_false(gz_display_valid(&display));
	}
	struct gz_display largest = good;
	largest.px[0] = largest.px[1] = 32768;
	assert_true(gz_display_valid(&largest));
}

static void display_corner_is_up_and_left_of_its_centre(void **state)
{
	(void)state;
	struct gz_display display = { .px = { 400, 300 }, .mm = { 400, 300 }, .distance_mm = 500 };
	double mm[3];
	gz_display_to_mm(&display, (struct gz_point) { 0, 0 }, mm);
	assert_near(mm[0], -200, 0);
	assert_near(mm[1], -150, 0);
	assert_near(mm[2], 500, 0);
}

static void display_angle_keeps_a_ten_thousandth_of_a_degree(void **state)
{
	(void)state;
	struct gz_display display = { .px = { 100, 100 }, .mm = { 100, 100 }, .distance_mm = 1000 };
	float step = 0x1p-14f; /* of 100 mm: exact, 0.00035 degrees */
	double angle_deg = gz_display_angle_deg(&display, (struct gz_point) { 0.5f, 0.5f },
						(struct gz_point) { 0.5f + step, 0.5f });
	double expected_deg = atan2(100 * (double)step, 1000) * 180 / PI;
	assert_near(angle_deg / expected_deg, 1, 1e-9);
	assert_near(gz_display_angle_deg(&display, (struct gz_point) { 0.3f, 0.4f },
					 (struct gz_point) { 0.3f, 0.4f }),
		    0, 1e-12);
}

static void display_angle_of_an_unmeasured_point_is_nan(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(100, 100);
	struct gz_point known = { 0, 0 }, unknown = { NAN, 0 };
	assert_true(isnan(gz_display_angle_deg(&display, known, unknown)));
	assert_true(isnan(gz_display_angle_deg(&display, unknown, known)));
}

static void display_px_per_deg_is_that_of_the_centre(void **state)
{
	(void)state;
	struct gz_display display = { .px = { 1000, 10 }, .mm = { 500, 5 }, .distance_mm = 600 };
	double one_deg_mm = 600 * PI / 180;
	assert_near(gz_display_px_per_deg(&display), 2 * one_deg_mm, 1e-9);
}

TEST_SUITE(display)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(display_default_is_50_4_degrees_wide),
		cmocka_unit_test(display_field_out_of_range_is_not_valid),
		cmocka_unit_test(display_corner_is_up_and_left_of_its_centre),
		cmocka_unit_test(display_angle_keeps_a_ten_thousandth_of_a_degree),
		cmocka_unit_test(display_angle_of_an_unmeasured_point_is_nan),
		cmocka_unit_test(display_px_per_deg_is_that_of_the_centre),
	};
	return cmocka_run_group_tests_name("display", tests, NULL, NULL);
}
