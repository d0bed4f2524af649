/* The renderer as other programs have it: refusals, and that pictures follow what was set. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/library/render.h"

enum { EDGE = 12, WIDTH = 40, HEIGHT = 30, BYTES = WIDTH * HEIGHT * 4 };

static const int dims[3] = { EDGE, EDGE, EDGE };
static uint8_t voxels[EDGE * EDGE * EDGE], picture[BYTES];
static struct gz_renderer *renderer;

static int open_renderer(void **state)
{
	(void)state;
	for (int i = 0; i < EDGE * EDGE * EDGE; i++)
		voxels[i] = (uint8_t)(i % EDGE * 20);
	return gz_renderer_open("cpu", 1, &renderer);
}

static int close_renderer(void **state)
{
	(void)state;
	gz_renderer_close(&renderer);
	gz_renderer_close(&renderer);
	return renderer != NULL;
}

static enum gz_result set_ramp(void)
{
	return gz_renderer_set_volume(renderer, "uint8", dims, NULL, voxels, sizeof voxels);
}

static enum gz_result draw(void)
{
	return gz_renderer_draw(renderer, WIDTH, HEIGHT, NULL, picture, BYTES);
}

static void assert_said(const char *words)
{
	if (!strstr(gz_renderer_message(renderer), words))
		fail_msg("said \"%s\", not \"%s\"", gz_renderer_message(renderer), words);
}

static void renderer_without_a_volume_draws_nothing(void **state)
{
	(void)state;
	assert_int_equal(draw(), GZ_ERR_INVAL);
	assert_said("nothing is shown");
	assert_string_equal(gz_renderer_describe(renderer), "");
	for (size_t i = 0; gz_renderer_cost_name(i); i++)
		assert_true(isnan(gz_renderer_cost(renderer, i)));
}

static void volumes_that_contradict_themselves_are_refused(void **state)
{
	(void)state;
	const double flat[3] = { 1, 0, 1 };
	const int none[3] = { EDGE, 0, EDGE }, huge[3] = { 16385, 1, 1 };
	assert_int_equal(
		gz_renderer_set_volume(renderer, "uint9", dims, NULL, voxels, sizeof voxels),
		GZ_ERR_INVAL);
	assert_said("uint9");
	assert_int_equal(
		gz_renderer_set_volume(renderer, "uint16", dims, NULL, voxels, sizeof voxels),
		GZ_ERR_INVAL);
	assert_said("3456");
	assert_int_equal(gz_renderer_set_volume(renderer, "uint8", none, NULL, voxels, 0),
			 GZ_ERR_INVAL);
	assert_int_equal(gz_renderer_set_volume(renderer, "uint8", huge, NULL, voxels, 16385),
			 GZ_ERR_INVAL);
	assert_int_not_equal(
		gz_renderer_set_volume(renderer, "uint8", dims, flat, voxels, sizeof voxels),
		GZ_OK);
	assert_int_equal(draw(), GZ_ERR_INVAL);
}

static void keys_are_refused_with_the_remedy(void **state)
{
	(void)state;
	char text[64], small[2];
	assert_int_equal(gz_renderer_set(renderer, "camera.fov_degs", "40"), GZ_ERR_NOT_FOUND);
	assert_said("camera.fov_deg");
	assert_int_equal(gz_renderer_set(renderer, "transfer.file", "x.tf"), GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_renderer_set(renderer, "camera.fov_deg", "wide"), GZ_ERR_INVAL);
	assert_said("wide");
	assert_int_equal(gz_renderer_get(renderer, "camera.fov_deg", text, sizeof text), GZ_OK);
	assert_string_equal(text, "40");
	assert_int_equal(gz_renderer_get(renderer, "camera.eye", small, sizeof small), GZ_ERR_FULL);
	assert_int_equal(set_ramp(), GZ_OK);
	assert_int_equal(gz_renderer_set(renderer, "clip.least", "1 1 1"), GZ_OK);
	assert_int_equal(draw(), GZ_ERR_FORMAT);
	assert_said("clip");
	assert_int_equal(gz_renderer_set(renderer, "clip.least", "0 0 0"), GZ_OK);
	assert_int_equal(gz_renderer_set(renderer, "foveation.table", "/nonexistent"), GZ_OK);
	assert_int_equal(draw(), GZ_ERR_NOT_FOUND);
}

static void requests_out_of_range_are_refused(void **state)
{
	(void)state;
	const double nowhere[2] = { NAN, 0.5 }, outside[2] = { -3, 1.5 };
	assert_int_equal(set_ramp(), GZ_OK);
	assert_int_equal(gz_renderer_draw(renderer, WIDTH, HEIGHT, NULL, picture, BYTES - 1),
			 GZ_ERR_INVAL);
	assert_int_equal(gz_renderer_draw(renderer, 0, HEIGHT, NULL, picture, 0), GZ_ERR_INVAL);
	assert_int_equal(gz_renderer_draw(renderer, WIDTH, HEIGHT, nowhere, picture, BYTES),
			 GZ_ERR_INVAL);
	assert_int_equal(gz_renderer_draw(renderer, WIDTH, HEIGHT, outside, picture, BYTES), GZ_OK);
	struct gz_renderer *other = NULL;
	assert_int_equal(gz_renderer_open("abacus", 0, &other), GZ_ERR_INVAL);
	assert_int_equal(gz_renderer_open("cpu", 257, &other), GZ_ERR_INVAL);
	assert_null(other);
}

static void file_that_cannot_be_loaded_leaves_what_is_shown(void **state)
{
	(void)state;
	static uint8_t before[BYTES];
	assert_int_equal(set_ramp(), GZ_OK);
	assert_int_equal(draw(), GZ_OK);
	memcpy(before, picture, BYTES);
	assert_int_equal(gz_renderer_load(renderer, "/nonexistent.scene"), GZ_ERR_NOT_FOUND);
	assert_said("/nonexistent.scene");
	assert_int_equal(draw(), GZ_OK);
	assert_memory_equal(picture, before, BYTES);
	assert_string_equal(gz_renderer_message(renderer), "");
	assert_non_null(strstr(gz_renderer_describe(renderer), "cpu: "));
}

static void transfer_function_outlives_volumes_and_gives_way_to_none(void **state)
{
	(void)state;
	static uint8_t red[BYTES], made[BYTES];
	assert_int_equal(gz_renderer_set_transfer(renderer, "0 1 0 0 1\n1 1 0 0 1\n"), GZ_OK);
	assert_int_equal(set_ramp(), GZ_OK);
	assert_int_equal(draw(), GZ_OK);
	memcpy(red, picture, BYTES);
	const uint8_t *middle = red + ((size_t)HEIGHT / 2 * WIDTH + WIDTH / 2) * 4;
	assert_true(middle[0] > 240 && middle[1] == 0 && middle[3] == 255);
	assert_int_equal(set_ramp(), GZ_OK);
	assert_int_equal(draw(), GZ_OK);
	assert_memory_equal(picture, red, BYTES);
	assert_int_equal(gz_renderer_set_transfer(renderer, "0 1 0 0 7\n"), GZ_ERR_FORMAT);
	assert_int_equal(gz_renderer_set_transfer(renderer, NULL), GZ_OK);
	assert_int_equal(draw(), GZ_OK);
	memcpy(made, picture, BYTES);
	assert_memory_not_equal(made, red, BYTES);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, open_renderer, close_renderer)

TEST_SUITE(renderer)
{
	const struct CMUnitTest tests[] = {
		TEST(renderer_without_a_volume_draws_nothing),
		TEST(volumes_that_contradict_themselves_are_refused),
		TEST(keys_are_refused_with_the_remedy),
		TEST(requests_out_of_range_are_refused),
		TEST(file_that_cannot_be_loaded_leaves_what_is_shown),
		TEST(transfer_function_outlives_volumes_and_gives_way_to_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
