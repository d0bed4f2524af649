/* Letters: which side of the patient is at which edge of the picture. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "view/draw/letters.h"

static void assert_letters(const struct gz_camera *camera, const char *left, const char *right,
			   const char *top, const char *bottom)
{
	struct gz_letters letters;
	assert_int_equal(gz_letters_of_camera(camera, &letters), GZ_OK);
	assert_string_equal(letters.left, left);
	assert_string_equal(letters.right, right);
	assert_string_equal(letters.top, top);
	assert_string_equal(letters.bottom, bottom);
}

static struct gz_camera camera_at(double x, double y, double z)
{
	return (struct gz_camera) {
		.eye = { x, y, z }, .up = { 0, 0, 1 }, .fov_deg = 40, .height = 1
	};
}

static void views_along_the_axes_have_the_letters_of_an_atlas(void **state)
{
	(void)state;
	for (int parallel = 0; parallel < 2; parallel++) {
		struct gz_camera behind = camera_at(0, -2, 0), front = camera_at(0, 2, 0);
		struct gz_camera right = camera_at(2, 0, 0), above = camera_at(0, 0, 2);
		struct gz_camera *all[] = { &behind, &front, &right, &above };
		for (size_t i = 0; i < 4; i++)
			all[i]->projection =
				parallel ? GZ_PROJECTION_ORTHOGRAPHIC : GZ_PROJECTION_PERSPECTIVE;
		assert_letters(&behind, "L", "R", "S", "I");
		assert_letters(&front, "R", "L", "S", "I"); /* face to face */
		assert_letters(&right, "P", "A", "S", "I");
		above.up[1] = 1;
		above.up[2] = 0;
		assert_letters(&above, "L", "R", "A", "P");
	}
}

static void oblique_directions_have_the_strongest_first(void **state)
{
	(void)state;
	static const struct {
		double direction[3];
		const char *letters;
	} cases[] = {
		{ { 3, 2, 0 }, "RA" },   { { -2, -3, 0 }, "PL" },   { { 1, 2, 3 }, "SA" },
		{ { 4, 5, -6 }, "IAR" }, { { 10, 3, 0 }, "R" },     { { 0, 0, 0 }, "" },
		{ { NAN, 0, 1 }, "" },   { { 1e-200, 0, 0 }, "R" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char letters[GZ_LETTERS_SIZE];
		gz_letters_of(cases[i].direction, letters);
		assert_string_equal(letters, cases[i].letters);
	}
}

static void camera_that_is_none_has_no_letters(void **state)
{
	(void)state;
	struct gz_camera camera = camera_at(0, 0, 0);
	struct gz_letters letters;
	assert_int_equal(gz_letters_of_camera(&camera, &letters), GZ_ERR_INVAL);
}

/* Pixels as light as letters in a part of the picture. */
static int light_pixels(const struct gz_image *image, int left, int top, int right, int bottom)
{
	int count = 0;
	for (int y = top; y < bottom; y++)
		for (int x = left; x < right; x++)
			count += image->pixels[4 * ((size_t)y * (size_t)image->width + (size_t)x)] >
				 200;
	return count;
}

static void letters_stand_at_their_edges_and_nowhere_else(void **state)
{
	(void)state;
	const struct gz_letters letters = { "L", "RAS", "S", "I" };
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, 640, 360), GZ_OK);
	memset(image.pixels, 90, (size_t)4 * 640 * 360);
	gz_letters_draw(&letters, &image);
	int left = light_pixels(&image, 0, 160, 60, 200);
	int right = light_pixels(&image, 560, 160, 640, 200);
	int top = light_pixels(&image, 300, 0, 340, 50);
	int bottom = light_pixels(&image, 300, 310, 340, 360);
	assert_true(left > 5 && top > 5 && bottom > 5 && right > 3 * left);
	assert_int_equal(light_pixels(&image, 0, 0, 640, 360), left + right + top + bottom);
	gz_image_free(&image);
}

static void picture_without_room_is_left_alone(void **state)
{
	(void)state;
	const struct gz_letters letters = { "LPI", "RAS", "SAR", "IPL" };
	for (int side = 1; side < 60; side++) {
		struct gz_image image = { 0 };
		assert_int_equal(gz_image_resize(&image, side, 61 - side), GZ_OK);
		gz_letters_draw(&letters, &image); /* a sanitizer sees what it would spoil */
		gz_image_free(&image);
	}
}

TEST_SUITE(letters)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(views_along_the_axes_have_the_letters_of_an_atlas),
		cmocka_unit_test(oblique_directions_have_the_strongest_first),
		cmocka_unit_test(camera_that_is_none_has_no_letters),
		cmocka_unit_test(letters_stand_at_their_edges_and_nowhere_else),
		cmocka_unit_test(picture_without_room_is_left_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
