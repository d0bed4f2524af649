#include "suite.h"

#include <math.h>

#include "render/picture/camera.h"

#define CLOSE(a, b) assert_float_equal((float)(a), (float)(b), 1e-5f)

static struct gz_camera camera_make(void)
{
	return (struct gz_camera) {
		.eye = { 0, -2, 0 }, .up = { 0, 0, 1 }, .fov_deg = 40, .height = 1.5
	};
}

static void ray_at(const struct gz_ray_frame *f, double x, double y, double origin[3],
		   double direction[3])
{
	for (int i = 0; i < 3; i++) {
		origin[i] = f->origin00[i] + x * f->origin_dx[i] + y * f->origin_dy[i];
		direction[i] = f->direction00[i] + x * f->direction_dx[i] + y * f->direction_dy[i];
	}
}

static void ray_of_the_centre_goes_to_look_at(void **state)
{
	(void)state;
	for (int projection = 0; projection < 2; projection++) {
		struct gz_camera c = camera_make();
		c.projection = (enum gz_projection)projection;
		struct gz_ray_frame f;
		double o[3], d[3];
		assert_int_equal(gz_camera_rays(&c, 101, 51, &f), GZ_OK);
		ray_at(&f, 50, 25, o, d);
		CLOSE(o[0], 0);
		CLOSE(o[1], -2);
		CLOSE(o[2], 0);
		CLOSE(d[0] / d[1], 0);
		CLOSE(d[2] / d[1], 0);
		assert_true(d[1] > 0);
	}
}

static void first_row_looks_up_and_first_column_left(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	struct gz_ray_frame f;
	double o[3], d[3];
	assert_int_equal(gz_camera_rays(&c, 200, 100, &f), GZ_OK);
	ray_at(&f, 0, 0, o, d);
	assert_true(d[0] < 0);
	assert_true(d[2] > 0);
}

/* The edges of the picture, half a pixel outside the centres of the first and last row, are
 * fov_deg apart. */
static void field_of_view_is_vertical_from_edge_to_edge(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	struct gz_ray_frame f;
	double o[3], top[3], bottom[3];
	assert_int_equal(gz_camera_rays(&c, 64, 48, &f), GZ_OK);
	ray_at(&f, 31.5, -0.5, o, top);
	ray_at(&f, 31.5, 47.5, o, bottom);
	double angle = atan2(top[2], top[1]) - atan2(bottom[2], bottom[1]);
	CLOSE(angle * 180 / 3.14159265358979, 40);
}

static void orthographic_view_is_as_high_as_asked(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	c.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	struct gz_ray_frame f;
	double top[3], bottom[3], d[3];
	assert_int_equal(gz_camera_rays(&c, 64, 48, &f), GZ_OK);
	ray_at(&f, 31.5, -0.5, top, d);
	ray_at(&f, 31.5, 47.5, bottom, d);
	CLOSE(top[2] - bottom[2], 1.5);
	CLOSE(top[1], -2);
	CLOSE(d[0], 0);
	CLOSE(d[1], 1);
}

static void pixels_are_square_at_any_shape_of_picture(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	struct gz_ray_frame f;
	assert_int_equal(gz_camera_rays(&c, 300, 20, &f), GZ_OK);
	double dx = f.direction_dx[0], dy = f.direction_dy[2];
	CLOSE(dx, -dy);
	assert_true(dx > 0);
}

/* A small generator, so that the test needs no seed from outside. */
static double next_number(uint32_t *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (double)(*seed >> 8) / (1 << 24) * 2 - 1;
}

static struct gz_camera random_camera(uint32_t *seed)
{
	struct gz_camera c = camera_make();
	for (int i = 0; i < 3; i++) {
		c.eye[i] = 3 * next_number(seed);
		c.look_at[i] = 0.3 * next_number(seed);
		c.up[i] = next_number(seed);
	}
	c.fov_deg = 70 + 60 * next_number(seed);
	c.height = 2 + next_number(seed);
	c.projection =
		next_number(seed) < 0 ? GZ_PROJECTION_PERSPECTIVE : GZ_PROJECTION_ORTHOGRAPHIC;
	return c;
}

static void project_undoes_the_rays(void **state)
{
	(void)state;
	uint32_t seed = 7;
	for (int round = 0; round < 2000; round++) {
		struct gz_camera c = random_camera(&seed);
		int width = 40 + round % 37, height = 20 + round % 53;
		double x = width * (0.5 + 0.7 * next_number(&seed));
		double y = height * (0.5 + 0.7 * next_number(&seed));
		double along = 1.5 + next_number(&seed), o[3], d[3], world[3];
		struct gz_ray_frame f;
		struct gz_point p = { -9, -9 };
		assert_int_equal(gz_camera_rays(&c, width, height, &f), GZ_OK);
		ray_at(&f, x, y, o, d);
		for (int i = 0; i < 3; i++)
			world[i] = o[i] + along * d[i];
		assert_true(gz_camera_project(&c, width, height, world, &p));
		CLOSE(p.x, (x + 0.5) / width);
		CLOSE(p.y, (y + 0.5) / height);
	}
}

static void point_behind_the_eye_is_not_projected(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	struct gz_point p = { 5, 6 };
	assert_false(gz_camera_project(&c, 10, 10, (double[3]) { 0, -3, 0 }, &p));
	assert_false(gz_camera_project(&c, 10, 10, (double[3]) { 1, -2, 0 }, &p));
	assert_false(gz_camera_project(&c, 10, 10, (double[3]) { NAN, 0, 0 }, &p));
	assert_true(p.x == 5 && p.y == 6);
}

static void up_along_the_view_or_zero_is_replaced(void **state)
{
	(void)state;
	static const double ups[][3] = { { 0, 1, 0 }, { 0, -5, 0 }, { 0, 0, 0 }, { 0, 1, 1e-9 } };
	for (size_t k = 0; k < 4; k++) {
		struct gz_camera c = camera_make();
		struct gz_ray_frame f;
		for (int i = 0; i < 3; i++)
			c.up[i] = ups[k][i];
		assert_int_equal(gz_camera_rays(&c, 10, 10, &f), GZ_OK);
		double length = 0;
		for (int i = 0; i < 3; i++)
			length += f.direction_dx[i] * f.direction_dx[i];
		CLOSE(sqrt(length), 2 * tan(20 * 3.14159265358979 / 180) / 10);
	}
}

static void invalid_cameras_are_refused(void **state)
{
	(void)state;
	struct gz_camera bad[10];
	for (int i = 0; i < 10; i++)
		bad[i] = camera_make();
	bad[0].look_at[1] = -2; /* the eye */
	bad[1].eye[2] = NAN;
	bad[2].up[0] = INFINITY;
	bad[3].fov_deg = 0;
	bad[4].fov_deg = 180;
	bad[5].fov_deg = NAN;
	bad[6].projection = GZ_PROJECTION_ORTHOGRAPHIC;
	bad[6].height = 0;
	bad[7].projection = GZ_PROJECTION_ORTHOGRAPHIC;
	bad[7].height = INFINITY;
	bad[8].projection = (enum gz_projection)2;
	bad[9].look_at[0] = INFINITY;
	struct gz_ray_frame f = { .origin00 = { 42 } };
	for (int i = 0; i < 10; i++)
		assert_int_equal(gz_camera_rays(&bad[i], 10, 10, &f), GZ_ERR_INVAL);
	struct gz_camera good = camera_make();
	assert_int_equal(gz_camera_rays(&good, 0, 10, &f), GZ_ERR_INVAL);
	assert_int_equal(gz_camera_rays(&good, 10, -1, &f), GZ_ERR_INVAL);
	assert_true(f.origin00[0] == 42);
}

static void turn_is_counter_clockwise_seen_from_up(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	gz_camera_turn(&c, 90);
	CLOSE(c.eye[0], 2);
	CLOSE(c.eye[1], 0);
	CLOSE(c.eye[2], 0);
	for (int i = 0; i < 3; i++)
		gz_camera_turn(&c, 90);
	CLOSE(c.eye[0], 0);
	CLOSE(c.eye[1], -2);
	gz_camera_turn(&c, NAN);
	CLOSE(c.eye[1], -2);
}

static void orbit_moves_the_object_with_the_mouse(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	const double front[3] = { 0, -0.5, 0 }; /* the point nearest to the eye */
	struct gz_point p;
	gz_camera_orbit(&c, 10, 0);
	assert_true(gz_camera_project(&c, 100, 100, front, &p));
	assert_true(p.x > 0.5f);
	c = camera_make();
	gz_camera_orbit(&c, 0, 10);
	assert_true(gz_camera_project(&c, 100, 100, front, &p));
	assert_true(p.y > 0.5f);
}

static void orbit_stops_short_of_the_poles(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	for (int i = 0; i < 20; i++)
		gz_camera_orbit(&c, 3, 30);
	assert_true(c.eye[2] > 1.99);
	assert_true(c.eye[2] < 2);
	for (int i = 0; i < 20; i++)
		gz_camera_orbit(&c, 3, -30);
	assert_true(c.eye[2] < -1.99);
	CLOSE(sqrt(c.eye[0] * c.eye[0] + c.eye[1] * c.eye[1] + c.eye[2] * c.eye[2]), 2);
}

static void zoom_scales_the_distance_or_the_height(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	gz_camera_zoom(&c, 0.5);
	CLOSE(c.eye[1], -1);
	CLOSE(c.height, 1.5);
	c.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	gz_camera_zoom(&c, 2);
	CLOSE(c.eye[1], -1);
	CLOSE(c.height, 3);
	gz_camera_zoom(&c, 0);
	gz_camera_zoom(&c, -1);
	gz_camera_zoom(&c, NAN);
	CLOSE(c.height, 3);
}

/* The offset of a world point from the picture's middle, in pixels of 100 x 100. */
static void offset_of(const struct gz_camera *c, const double world[3], double *out_x,
		      double *out_y)
{
	struct gz_point p;
	assert_true(gz_camera_project(c, 100, 100, world, &p));
	*out_x = 100 * ((double)p.x - 0.5);
	*out_y = 100 * ((double)p.y - 0.5);
}

static void pan_moves_what_is_looked_at_by_shares_of_the_height(void **state)
{
	(void)state;
	for (int projection = 0; projection < 2; projection++) {
		struct gz_camera c = camera_make();
		const double seen[3] = { 0, 0, 0 };
		double x, y;
		c.projection = (enum gz_projection)projection;
		gz_camera_pan(&c, 0.25, -0.125);
		offset_of(&c, seen, &x, &y);
		assert_float_equal((float)x, 25, 1e-3f);
		assert_float_equal((float)y, 12.5f, 1e-3f);
		CLOSE(c.look_at[1], 0);
		CLOSE(c.eye[1], -2);
		gz_camera_pan(&c, NAN, 0);
		gz_camera_pan(&c, -0.25, 0.125);
		CLOSE(c.look_at[0], 0);
		CLOSE(c.look_at[2], 0);
	}
}

static void roll_turns_the_picture_counter_clockwise(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	const double right_of_it[3] = { 0.3, 0, 0 };
	double x, y;
	offset_of(&c, right_of_it, &x, &y);
	assert_true(x > 10);
	gz_camera_roll(&c, 90);
	offset_of(&c, right_of_it, &x, &y);
	assert_float_equal((float)x, 0, 1e-3f);
	assert_true(y < -10);
	gz_camera_roll(&c, -90);
	CLOSE(c.up[0], 0);
	CLOSE(c.up[2], 1);
	/* An up that says nothing is the one that the picture has. */
	c.up[2] = 0;
	gz_camera_roll(&c, 0);
	assert_true(gz_camera_up_counts(&c));
}

static void other_projection_keeps_the_size_of_what_is_looked_at(void **state)
{
	(void)state;
	struct gz_camera c = camera_make();
	const double seen[3] = { 0.3, 0, 0.2 };
	double x, y, other_x, other_y;
	offset_of(&c, seen, &x, &y);
	gz_camera_set_projection(&c, GZ_PROJECTION_ORTHOGRAPHIC);
	assert_int_equal(c.projection, GZ_PROJECTION_ORTHOGRAPHIC);
	offset_of(&c, seen, &other_x, &other_y);
	assert_float_equal((float)x, (float)other_x, 1e-3f);
	assert_float_equal((float)y, (float)other_y, 1e-3f);
	gz_camera_zoom(&c, 0.5);
	gz_camera_set_projection(&c, GZ_PROJECTION_PERSPECTIVE);
	offset_of(&c, seen, &other_x, &other_y);
	assert_float_equal((float)(2 * x), (float)other_x, 1e-3f);
	assert_float_equal((float)(2 * y), (float)other_y, 1e-3f);
	CLOSE(c.eye[1], -1);
	CLOSE(c.fov_deg, 40);
}

static void axis_views_look_from_right_front_and_above_or_the_other_side(void **state)
{
	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		for (int other = 0; other < 2; other++) {
			struct gz_camera c = camera_make();
			c.look_at[0] = 0.5;
			c.eye[0] = 0.5;
			gz_camera_look_along(&c, axis, other);
			for (int i = 0; i < 3; i++)
				CLOSE(c.eye[i] - c.look_at[i], i != axis ? 0 : other ? -2 : 2);
			CLOSE(c.look_at[0], 0.5);
			assert_true(gz_camera_up_counts(&c));
			CLOSE(c.up[axis == 2 ? 1 : 2], 1);
		}
	}
	struct gz_camera c = camera_make();
	gz_camera_look_along(&c, 3, false);
	gz_camera_look_along(&c, -1, false);
	CLOSE(c.eye[1], -2);
}

TEST_SUITE(camera)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ray_of_the_centre_goes_to_look_at),
		cmocka_unit_test(first_row_looks_up_and_first_column_left),
		cmocka_unit_test(field_of_view_is_vertical_from_edge_to_edge),
		cmocka_unit_test(orthographic_view_is_as_high_as_asked),
		cmocka_unit_test(pixels_are_square_at_any_shape_of_picture),
		cmocka_unit_test(project_undoes_the_rays),
		cmocka_unit_test(point_behind_the_eye_is_not_projected),
		cmocka_unit_test(up_along_the_view_or_zero_is_replaced),
		cmocka_unit_test(invalid_cameras_are_refused),
		cmocka_unit_test(turn_is_counter_clockwise_seen_from_up),
		cmocka_unit_test(orbit_moves_the_object_with_the_mouse),
		cmocka_unit_test(orbit_stops_short_of_the_poles),
		cmocka_unit_test(zoom_scales_the_distance_or_the_height),
		cmocka_unit_test(pan_moves_what_is_looked_at_by_shares_of_the_height),
		cmocka_unit_test(roll_turns_the_picture_counter_clockwise),
		cmocka_unit_test(other_projection_keeps_the_size_of_what_is_looked_at),
		cmocka_unit_test(axis_views_look_from_right_front_and_above_or_the_other_side),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
