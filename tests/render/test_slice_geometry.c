/* Slices of a box, and the lattices on which they are drawn. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/layers/raster_layers.h"
#include "render/plan/method.h"
#include "render/slices/gl/slice_cut.h"
#include "small_scene.h"

enum { WIDTH = 200, HEIGHT = 150 };

/* A box that is no cube, seen by a camera. */
static struct gz_slice_request request_of(const struct gz_camera *camera, int count)
{
	struct gz_slice_request request = {
		.half = { 0.5, 0.3, 0.4 },
		.shown = { .least = { -0.5, -0.3, -0.4 },
			   .greatest = { 0.5, 0.3, 0.4 },
			   .plane = { 0, 0, 0, 1 } },
		.count = count,
	};
	assert_int_equal(gz_camera_rays(camera, WIDTH, HEIGHT, &request.rays), GZ_OK);
	return request;
}

static struct gz_camera camera_at(double x, double y, double z, enum gz_projection projection)
{
	return (struct gz_camera) {
		.eye = { x, y, z },
		.up = { 0, 0, 1 },
		.fov_deg = 40,
		.height = 1.5,
		.projection = projection,
	};
}

/* Pixel and world place of a corner. */
static void place_corner(const struct gz_slice_cut *cut, const struct gz_slice_corner *corner,
			 double out_pixel[2], double out_world[3])
{
	const struct gz_ray_frame *rays = &cut->made_for.rays;
	const double depth = cut->near + corner->depth;
	out_pixel[0] = corner->x / corner->w;
	out_pixel[1] = corner->y / corner->w;
	for (int axis = 0; axis < 3; axis++) {
		const double origin = rays->origin00[axis] + out_pixel[0] * rays->origin_dx[axis] +
				      out_pixel[1] * rays->origin_dy[axis];
		const double direction = rays->direction00[axis] +
					 out_pixel[0] * rays->direction_dx[axis] +
					 out_pixel[1] * rays->direction_dy[axis];
		out_world[axis] = origin + depth * direction;
	}
}

static double triangle_area(double corners[3][3])
{
	double a[3], b[3];
	for (int axis = 0; axis < 3; axis++) {
		a[axis] = corners[1][axis] - corners[0][axis];
		b[axis] = corners[2][axis] - corners[0][axis];
	}
	return 0.5 * hypot(hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]),
			   a[0] * b[1] - a[1] * b[0]);
}

/* The area of a slice, in world units, whose corners must lie on the box. */
static double slice_area(const struct gz_slice_cut *cut, int slice)
{
	double area = 0;
	const int first = cut->first[slice], end = cut->first[slice + 1];
	assert_true((end - first) % 3 == 0 && end - first <= 3 * (GZ_SLICE_CORNERS_MAX - 2));
	for (int i = first; i < end; i += 3) {
		double corners[3][3], pixel[2];
		for (int k = 0; k < 3; k++) {
			place_corner(cut, &cut->corners[i + k], pixel, corners[k]);
			for (int axis = 0; axis < 3; axis++)
				assert_true(fabs(corners[k][axis]) <
					    cut->made_for.half[axis] + 1e-4);
		}
		area += triangle_area(corners);
	}
	return area;
}

/* What slices cover, each as thick as they are apart, is the box. */
static void slices_of_a_box_add_up_to_its_volume(void **state)
{
	(void)state;
	static const double eyes[][3] = { { 0, -2, 0 },     { 0.7, -1.1, 0.9 }, { -3, 0.2, -0.4 },
					  { 1, 1, 1 },      { 0, 0, 5 },        { 2, -2, 0 },
					  { 300, 400, 100 } };
	struct gz_slice_cut cut = { 0 };
	for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
		const struct gz_camera camera =
			camera_at(eyes[i][0], eyes[i][1], eyes[i][2], GZ_PROJECTION_ORTHOGRAPHIC);
		const struct gz_slice_request request = request_of(&camera, 500);
		assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
		assert_int_equal(cut.count, 500);
		const double *along = request.rays.direction00;
		const double length =
			sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
		double volume = 0;
		for (int slice = 0; slice < cut.count; slice++)
			volume += slice_area(&cut, slice) * cut.distance * length;
		const double expected = 8 * 0.5 * 0.3 * 0.4;
		if (fabs(volume - expected) > 1e-3 * expected)
			fail_msg("eye %zu: %.6f, not %.6f", i, volume, expected);
	}
	gz_slice_cut_free(&cut);
}

/* Every pixel's ray meets just the slices whose depth lies between where it enters and leaves. */
static void slice_covers_the_pixels_whose_rays_cross_the_box_there(void **state)
{
	(void)state;
	const struct gz_camera camera = camera_at(0.9, -1.2, 0.6, GZ_PROJECTION_PERSPECTIVE);
	const struct gz_slice_request request = request_of(&camera, 40);
	struct gz_slice_cut cut = { 0 };
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	for (int slice = 0; slice < cut.count; slice++)
		for (int i = cut.first[slice]; i < cut.first[slice + 1]; i += 3) {
			/* the middle of a triangle is within the box, so its ray is */
			double pixel[2], world[3], middle[3] = { 0, 0, 0 };
			for (int k = 0; k < 3; k++) {
				place_corner(&cut, &cut.corners[i + k], pixel, world);
				for (int axis = 0; axis < 3; axis++)
					middle[axis] += world[axis] / 3;
				assert_true(fabs(cut.corners[i + k].depth -
						 (slice + 0.5) * cut.distance) < 1e-5);
			}
			for (int axis = 0; axis < 3; axis++)
				assert_true(fabs(middle[axis]) <= request.half[axis] + 1e-4);
		}
	gz_slice_cut_free(&cut);
}

static void slices_begin_at_an_eye_within_the_box_and_end_behind_it(void **state)
{
	(void)state;
	struct gz_slice_cut cut = { 0 };
	struct gz_camera camera = camera_at(0.1, 0.1, 0.1, GZ_PROJECTION_PERSPECTIVE);
	struct gz_slice_request request = request_of(&camera, 64);
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	assert_int_equal(cut.count, 64);
	assert_true(cut.near == 0 && cut.distance > 0);
	for (int i = 0; i < cut.first[cut.count]; i++)
		assert_true(cut.corners[i].w > 0);
	camera = camera_at(0, -2, 0, GZ_PROJECTION_PERSPECTIVE);
	camera.look_at[1] = -4;
	request = request_of(&camera, 64);
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	assert_int_equal(cut.count, 0); /* all of it is behind the eye */
	request.count = 0;
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_ERR_INVAL);
	memset(&request.rays.direction_dx, 0, sizeof request.rays.direction_dx);
	request.count = 2;
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_ERR_INVAL);
	gz_slice_cut_free(&cut);
}

static void box_is_cut_again_only_for_another_view(void **state)
{
	(void)state;
	struct gz_slice_cut cut = { 0 };
	const struct gz_camera camera = camera_at(0.9, -1.2, 0.6, GZ_PROJECTION_PERSPECTIVE);
	struct gz_slice_request request = request_of(&camera, 10);
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	const uint64_t revision = cut.revision;
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	assert_int_equal(cut.revision, revision);
	const double distance = cut.distance, before = slice_area(&cut, 5);
	request.shown.greatest[2] = 0; /* a clip box leaves the slices where they are */
	assert_int_equal(gz_slice_cut_make(&request, &cut), GZ_OK);
	assert_int_not_equal(cut.revision, revision);
	assert_true(cut.distance == distance);
	assert_true(slice_area(&cut, 5) < before);
	gz_slice_cut_free(&cut);
}

/* Slices of a plane through the box's middle and of its back leave together what is there. */
static void plane_leaves_its_side_of_each_slice(void **state)
{
	(void)state;
	for (int projection = 0; projection < 2; projection++) {
		const struct gz_camera camera =
			camera_at(0.9, -1.2, 0.6, (enum gz_projection)projection);
		struct gz_slice_request request = request_of(&camera, 24);
		struct gz_slice_cut whole = { 0 }, sides[2] = { { 0 }, { 0 } };
		assert_int_equal(gz_slice_cut_make(&request, &whole), GZ_OK);
		for (int side = 0; side < 2; side++) {
			static const double plane[4] = { 0.3, 1, -0.6, 0.05 };
			for (int i = 0; i < 4; i++)
				request.shown.plane[i] = side ? -plane[i] : plane[i];
			assert_int_equal(gz_slice_cut_make(&request, &sides[side]), GZ_OK);
			for (int i = 0; i < sides[side].first[24]; i++) {
				double pixel[2], world[3];
				place_corner(&sides[side], &sides[side].corners[i], pixel, world);
				assert_true(gz_clip_beyond(&request.shown, world) < 1e-5);
			}
		}
		double total = 0;
		for (int slice = 0; slice < 24; slice++) {
			const double area = slice_area(&whole, slice);
			const double kept = slice_area(&sides[0], slice);
			const double other = slice_area(&sides[1], slice);
			assert_float_equal(kept + other, area, 1e-5);
			total += fmin(kept, other);
		}
		assert_true(total > 0.5);
		gz_slice_cut_free(&whole);
		gz_slice_cut_free(&sides[0]);
		gz_slice_cut_free(&sides[1]);
	}
}

/* ---- lattices ---- */

static bool is_within(int value, int from, int to)
{
	return value >= from && value < to;
}

/* How much of a layer a pixel shows: as join.comp has it, but without the ramp. */
static bool is_solid(const struct gz_raster_layer *layer, int x, int y)
{
	return is_within(x, layer->solid[0][0], layer->solid[1][0]) &&
	       is_within(y, layer->solid[0][1], layer->solid[1][1]);
}

static bool is_shown(const struct gz_raster_layer *layer, int x, int y)
{
	const int band = layer->band;
	return is_within(x, layer->solid[0][0] - band, layer->solid[1][0] + band) &&
	       is_within(y, layer->solid[0][1] - band, layer->solid[1][1] + band);
}

/* The points around a pixel are drawn. */
static void check_points(const struct gz_raster_layer *layer, int x, int y, const char *what)
{
	for (int corner = 0; corner < 4; corner++) {
		int point[2];
		bool used = true;
		for (int axis = 0; axis < 2; axis++) {
			const int offset = (axis ? y : x) - layer->from[axis];
			point[axis] = offset / layer->spacing;
			/* beyond a point that the pixel lies on, the weight is 0 */
			if (corner >> axis & 1) {
				used = used && offset % layer->spacing > 0;
				point[axis]++;
			}
		}
		const bool hidden = is_within(point[0], layer->hidden[0][0], layer->hidden[1][0]) &&
				    is_within(point[1], layer->hidden[0][1], layer->hidden[1][1]);
		if (used && (hidden || !is_within(point[0], 0, layer->points[0]) ||
			     !is_within(point[1], 0, layer->points[1])))
			fail_msg("%s: pixel %d %d needs point %d %d of spacing %d", what, x, y,
				 point[0], point[1], layer->spacing);
	}
}

static void check_layers(const struct gz_plan *plan, const char *what, uint64_t *out_drawn)
{
	struct gz_raster_layer layers[GZ_PLAN_RECTANGLES_MAX];
	const int count = gz_raster_layers_make(plan, layers);
	assert_in_range(count, 1, GZ_PLAN_RECTANGLES_MAX);
	for (int y = 0; y < plan->height; y++)
		for (int x = 0; x < plan->width; x++) {
			int behind = count - 1; /* the finest layer that hides those behind it */
			while (behind > 0 && !is_solid(&layers[behind], x, y))
				behind--;
			for (int i = behind; i < count; i++)
				if (i == behind || is_shown(&layers[i], x, y))
					check_points(&layers[i], x, y, what);
		}
	for (int i = 0; i < count; i++)
		*out_drawn += gz_raster_layer_drawn(&layers[i]);
}

static void every_pixel_lies_between_points_that_are_drawn(void **state)
{
	(void)state;
	static const struct gz_point gazes[] = { { 0.5F, 0.5F }, { 0, 0 }, { 0.95F, 0.2F } };
	struct gz_foveation foveation = small_scene_foveation();
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	foveation.acuity_slope = 0.2; /* so that a small picture has all spacings */
	foveation.acuity_far_share = 1;
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		for (size_t i = 0; i < sizeof gazes / sizeof gazes[0]; i++) {
			struct gz_plan plan = { 0 };
			uint64_t drawn = 0;
			foveation.method = method;
			assert_int_equal(
				gz_plan_make(&foveation, &display, gazes[i], WIDTH, HEIGHT, &plan),
				GZ_OK);
			check_layers(&plan, gz_method_names[method], &drawn);
			if (method == gz_method_full())
				assert_int_equal(drawn, WIDTH * HEIGHT);
			if (method == GZ_METHOD_ACUITY)
				assert_in_range(drawn, 1, WIDTH * HEIGHT / 4);
			gz_plan_free(&plan);
		}
}

TEST_SUITE(slice_geometry)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(slices_of_a_box_add_up_to_its_volume),
		cmocka_unit_test(slice_covers_the_pixels_whose_rays_cross_the_box_there),
		cmocka_unit_test(slices_begin_at_an_eye_within_the_box_and_end_behind_it),
		cmocka_unit_test(box_is_cut_again_only_for_another_view),
		cmocka_unit_test(plane_leaves_its_side_of_each_slice),
		cmocka_unit_test(every_pixel_lies_between_points_that_are_drawn),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
