/* Cameras as text: read back to the same bits, and anything else refused. */
#include "suite.h"

#include <string.h>

#include "render/scene/view_settings.h"

static struct gz_camera camera_make(void)
{
	return (struct gz_camera) {
		.eye = { 0.1, -2.0 / 3, 1e-7 },
		.look_at = { 0, 0.25, -0.5 },
		.up = { 0, 0, 1 },
		.fov_deg = 40.1,
		.height = 1.0 / 7,
	};
}

static void expect_same(const struct gz_camera *a, const struct gz_camera *b)
{
	for (int i = 0; i < 3; i++)
		if (a->eye[i] != b->eye[i] || a->look_at[i] != b->look_at[i] ||
		    a->up[i] != b->up[i])
			fail_msg("axis %d: eye %.17g %.17g, look_at %.17g %.17g, up %.17g %.17g", i,
				 a->eye[i], b->eye[i], a->look_at[i], b->look_at[i], a->up[i],
				 b->up[i]);
	assert_int_equal(a->projection, b->projection);
	assert_true(a->fov_deg == b->fov_deg && a->height == b->height);
}

static void both_projections_are_read_back_to_the_same_bits(void **state)
{
	(void)state;
	for (int projection = 0; projection < 2; projection++) {
		struct gz_camera camera = camera_make(), read = { 0 };
		char text[GZ_SAVED_VIEW_SIZE];
		camera.projection = (enum gz_projection)projection;
		gz_saved_view_print(&camera, text);
		read.fov_deg = camera.fov_deg; /* the one that is not told stays */
		read.height = camera.height;
		if (gz_saved_view_parse(text, &read) != GZ_OK)
			fail_msg("refused: %s", text);
		expect_same(&camera, &read);
	}
}

static void longest_numbers_have_room(void **state)
{
	(void)state;
	struct gz_camera camera = camera_make(), read = { .height = camera.height };
	char text[GZ_SAVED_VIEW_SIZE];
	for (int i = 0; i < 3; i++) {
		camera.eye[i] = -1.2345678901234567e-101 * (i + 1);
		camera.look_at[i] = -9.8765432109876543e+101 / (i + 3);
		camera.up[i] = -1.1111111111111112e-301 * (i + 1);
	}
	camera.up[0] = 1;
	camera.fov_deg = 1.2345678901234567e-100;
	gz_saved_view_print(&camera, text);
	if (gz_saved_view_parse(text, &read) != GZ_OK)
		fail_msg("refused: %s", text);
	expect_same(&camera, &read);
}

static void plain_numbers_are_printed_plainly(void **state)
{
	(void)state;
	const struct gz_camera camera = {
		.eye = { 0, -2, 0.5 }, .up = { 0, 0, 1 }, .fov_deg = 40, .height = 1.5
	};
	char text[GZ_SAVED_VIEW_SIZE];
	gz_saved_view_print(&camera, text);
	assert_string_equal(text, "eye 0 -2 0.5 look_at 0 0 0 up 0 0 1 fov_deg 40");
}

static void other_texts_are_refused_and_the_camera_stays(void **state)
{
	(void)state;
	static const char *const texts[] = {
		"",
		"eye 0 -2 0",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1 fov_deg",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1 fov_deg 40 more",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1 fov_deg 40x",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1 fov_deg 180",
		"eye 0 -2 0 look_at 0 0 0 up 0 0 1 height 0",
		"eye 0 0 0 look_at 0 0 0 up 0 0 1 fov_deg 40",
		"eye 0 nan 0 look_at 0 0 0 up 0 0 1 fov_deg 40",
		"eye 0 -2 look_at 0 0 0 up 0 0 1 fov_deg 40",
		"look_at 0 0 0 eye 0 -2 0 up 0 0 1 fov_deg 40",
		"eyes 0 -2 0 look_at 0 0 0 up 0 0 1 fov_deg 40",
	};
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		struct gz_camera camera = camera_make();
		const struct gz_camera before = camera;
		if (gz_saved_view_parse(texts[i], &camera) != GZ_ERR_FORMAT)
			fail_msg("accepted: \"%s\"", texts[i]);
		expect_same(&camera, &before);
	}
}

static void views_of_a_scene_may_be_empty_but_not_wrong(void **state)
{
	(void)state;
	char views[GZ_SAVED_VIEWS][GZ_SAVED_VIEW_SIZE] = { "" };
	assert_int_equal(gz_saved_views_check(views, "test", NULL), GZ_OK);
	strcpy(views[7], "  eye 0 -2 0  look_at 0 0 0\tup 0 0 1 height 2 ");
	assert_int_equal(gz_saved_views_check(views, "test", NULL), GZ_OK);
	strcpy(views[2], "from the left");
	assert_int_equal(gz_saved_views_check(views, "test", NULL), GZ_ERR_FORMAT);
}

TEST_SUITE(saved_view)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(both_projections_are_read_back_to_the_same_bits),
		cmocka_unit_test(longest_numbers_have_room),
		cmocka_unit_test(plain_numbers_are_printed_plainly),
		cmocka_unit_test(other_texts_are_refused_and_the_camera_stays),
		cmocka_unit_test(views_of_a_scene_may_be_empty_but_not_wrong),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
