#include "suite.h"

#include <math.h>

#include "drivers/psvr2/psvr2_packet.h"

static const struct gz_psvr2_screen_params flat = { .distance_mm = 600, .size_mm = { 500, 300 } };

static struct gz_psvr2_ray ray(float ox, float oy, float oz, float dx, float dy, float dz)
{
	return (struct gz_psvr2_ray) { true, true, { ox, oy, oz }, { dx, dy, dz } };
}

/* The ray from @p origin to a point. */
static struct gz_psvr2_ray towards(const float origin[3], double x, double y, double z)
{
	double d[3] = { x - (double)origin[0], y - (double)origin[1], z - (double)origin[2] };
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	return ray(origin[0], origin[1], origin[2], (float)(d[0] / length), (float)(d[1] / length),
		   (float)(d[2] / length));
}

static void require_point(const struct gz_psvr2_screen_params *params, struct gz_psvr2_ray from,
			  double x, double y)
{
	struct gz_point point = { NAN, NAN };
	struct gz_psvr2_screen screen = gz_psvr2_screen_make(params);
	assert_true(gz_psvr2_screen_meet(&screen, &from, &point));
	if (fabs((double)point.x - x) > 1e-5 || fabs((double)point.y - y) > 1e-5)
		fail_msg("%g %g, expected %g %g", (double)point.x, (double)point.y, x, y);
}

static void screen_straight_ahead_is_met_at_its_centre_and_corners(void **state)
{
	(void)state;
	const float eye[3] = { -32, 4, -7 };
	require_point(&flat, ray(0, 0, 0, 0, 0, 1), 0.5, 0.5);
	require_point(&flat, towards(eye, -250, -150, 600), 0, 0);
	require_point(&flat, towards(eye, 250, 150, 600), 1, 1);
	require_point(&flat, towards(eye, 500, 0, 600), 1.5, 0.5);
}

static void screen_that_is_offset_is_met_where_it_is(void **state)
{
	(void)state;
	struct gz_psvr2_screen_params params = flat;
	params.offset_mm[0] = 100;
	params.offset_mm[1] = -30;
	require_point(&params, ray(0, 0, 0, 0, 0, 1), 0.3, 0.6);
}

/* Yaw moves the right edge of a screen nearer, pitch the lower edge; roll is clockwise. */
static void screen_that_is_turned_is_met_where_it_is(void **state)
{
	(void)state;
	const float eye[3] = { 10, -5, 0 };
	struct gz_psvr2_screen_params params = flat;
	double c = cos(M_PI / 6), s = sin(M_PI / 6);
	params.turn_deg[0] = 30;
	require_point(&params, towards(eye, 250 * c, 0, 600 - 250 * s), 1, 0.5);
	require_point(&params, towards(eye, -250 * c, 150, 600 + 250 * s), 0, 1);
	params.turn_deg[0] = 0;
	params.turn_deg[1] = 30;
	require_point(&params, towards(eye, 0, 150 * c, 600 - 150 * s), 0.5, 1);
	params.turn_deg[1] = 0;
	params.turn_deg[2] = 30;
	require_point(&params, towards(eye, 250 * c, 250 * s, 600), 1, 0.5);
	params.turn_deg[2] = 90;
	require_point(&params, towards(eye, 0, 250, 600), 1, 0.5);
}

static void screen_is_not_met_by_a_ray_that_misses_its_plane(void **state)
{
	(void)state;
	struct gz_psvr2_screen screen = gz_psvr2_screen_make(&flat);
	struct gz_point untouched = { 7, 7 };
	struct gz_psvr2_ray rays[] = {
		ray(0, 0, 0, 0, 0, -1),                              /* away */
		ray(0, 0, 0, 1, 0, 0),                               /* along it */
		ray(0, 0, 0, 0.998f, 0, 0.0632f),                    /* nearly along it */
		ray(0, 0, 700, 0, 0, 1),                             /* behind it */
		ray(3e38f, 0, 0, 0, 0, 1),                           /* far beside it */
		{ .has_origin = true },                              /* no direction */
		{ .has_direction = true, .direction = { 0, 0, 1 } }, /* no origin */
	};
	for (size_t i = 0; i < sizeof rays / sizeof *rays; i++) {
		if (gz_psvr2_screen_meet(&screen, &rays[i], &untouched))
			fail_msg("ray %zu meets it at %g %g", i, (double)untouched.x,
				 (double)untouched.y);
		assert_true(untouched.x == 7 && untouched.y == 7);
	}
}

TEST_SUITE(psvr2_screen)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(screen_straight_ahead_is_met_at_its_centre_and_corners),
		cmocka_unit_test(screen_that_is_offset_is_met_where_it_is),
		cmocka_unit_test(screen_that_is_turned_is_met_where_it_is),
		cmocka_unit_test(screen_is_not_met_by_a_ray_that_misses_its_plane),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
