#include "suite.h"

#include <math.h>
#include <png.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sim/targets.h"

enum { WIDTH = 300, HEIGHT = 200 };

static enum gz_result parse(const char *text, struct gz_targets *out_targets)
{
	return gz_targets_parse("list", text, strlen(text), NULL, out_targets);
}

static void list_with_comments_is_read(void **state)
{
	(void)state;
	struct gz_targets targets;
	assert_int_equal(parse("# places\n\n0.25 0.5\n 1.2\t-0.1 3 # past the edge\r\n", &targets),
			 GZ_OK);
	assert_int_equal(targets.count, 2);
	assert_true(targets.target[0].point.x == 0.25f && targets.target[0].weight == 1);
	assert_true(targets.target[1].point.y == -0.1f && targets.target[1].weight == 3);
}

static void faulty_lists_are_refused_and_nothing_is_written(void **state)
{
	(void)state;
	static const char *const faulty[] = {
		"",          "# none\n",   "0.5\n",         "0.5 0.5 1 1\n", "0.5 0.5 1 1 1\n",
		"0.5 nan\n", "0.5 inf\n",  "0.5 0.5 0\n",   "0.5 0.5 -1\n",  "0.5x 0.5\n",
		"2 0.5\n",   "0.5 -0.6\n", "0.5 0.5 1e9\n", "half half\n",   "0.5,0.5\n",
	};
	for (size_t i = 0; i < sizeof faulty / sizeof faulty[0]; i++) {
		struct gz_targets targets = { .count = 77 };
		if (parse(faulty[i], &targets) != GZ_ERR_FORMAT || targets.count != 77)
			fail_msg("accepted: %s", faulty[i]);
	}
	struct gz_targets targets;
	assert_int_equal(gz_targets_parse("list", "0.5 0.5\0\n", 9, NULL, &targets), GZ_ERR_FORMAT);
}

static void too_many_targets_are_refused(void **state)
{
	(void)state;
	char *text = calloc(GZ_TARGETS_MAX + 2, 8);
	assert_non_null(text);
	struct gz_targets targets;
	for (int i = 0; i < GZ_TARGETS_MAX; i++)
		strcat(text, ".5 .5\n");
	assert_int_equal(parse(text, &targets), GZ_OK);
	assert_int_equal(targets.count, GZ_TARGETS_MAX);
	strcat(text, ".5 .5\n");
	assert_int_equal(parse(text, &targets), GZ_ERR_FORMAT);
	free(text);
}

static void missing_file_is_refused(void **state)
{
	(void)state;
	struct gz_targets targets;
	assert_int_equal(gz_targets_load("/nonexistent/x", NULL, &targets), GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_targets_from_png("/nonexistent/x", NULL, &targets), GZ_ERR_NOT_FOUND);
}

/* A uniform picture with two bright discs, the left one brighter. */
static float *make_picture(void)
{
	float *picture = malloc(sizeof *picture * WIDTH * HEIGHT);
	assert_non_null(picture);
	for (int y = 0; y < HEIGHT; y++) {
		for (int x = 0; x < WIDTH; x++) {
			int left = (x - 60) * (x - 60) + (y - 50) * (y - 50);
			int right = (x - 240) * (x - 240) + (y - 150) * (y - 150);
			picture[y * WIDTH + x] = left < 64 ? 1.0f : right < 64 ? 0.7f : 0.2f;
		}
	}
	return picture;
}

static void check_two_discs(const struct gz_targets *targets)
{
	static const float wanted[2][2] = { { 60.0f / WIDTH, 50.0f / HEIGHT },
					    { 240.0f / WIDTH, 150.0f / HEIGHT } };
	assert_true(targets->count >= 2);
	for (int i = 0; i < 2; i++) {
		struct gz_point p = targets->target[i].point;
		if (fabsf(p.x - wanted[i][0]) > 0.03f || fabsf(p.y - wanted[i][1]) > 0.03f)
			fail_msg("target %d is at %g %g", i, (double)p.x, (double)p.y);
	}
	assert_true(targets->target[0].weight > targets->target[1].weight);
}

static void bright_discs_are_salient_the_brighter_first(void **state)
{
	(void)state;
	float *picture = make_picture();
	struct gz_targets targets;
	assert_int_equal(gz_targets_from_luminance(picture, WIDTH, HEIGHT, &targets), GZ_OK);
	check_two_discs(&targets);
	free(picture);
}

static void picture_file_gives_the_same_targets(void **state)
{
	(void)state;
	float *picture = make_picture();
	png_byte *grey = malloc(WIDTH * HEIGHT);
	assert_non_null(grey);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		grey[i] = (png_byte)(picture[i] * 255);
	char path[] = "/tmp/gazecast-targets-XXXXXX";
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	close(fd);
	png_image image = { .version = PNG_IMAGE_VERSION,
			    .width = WIDTH,
			    .height = HEIGHT,
			    .format = PNG_FORMAT_GRAY };
	assert_true(png_image_write_to_file(&image, path, 0, grey, 0, NULL));
	struct gz_targets targets;
	assert_int_equal(gz_targets_from_png(path, NULL, &targets), GZ_OK);
	check_two_discs(&targets);

	assert_int_equal(truncate(path, 60), 0);
	assert_int_equal(gz_targets_from_png(path, NULL, &targets), GZ_ERR_FORMAT);
	assert_int_equal(truncate(path, 0), 0);
	assert_int_equal(gz_targets_from_png(path, NULL, &targets), GZ_ERR_FORMAT);
	unlink(path);
	free(grey);
	free(picture);
}

static void flat_picture_gives_its_centre(void **state)
{
	(void)state;
	static const float flat[4] = { 0.3f, 0.3f, 0.3f, 0.3f };
	struct gz_targets targets;
	assert_int_equal(gz_targets_from_luminance(flat, 2, 2, &targets), GZ_OK);
	assert_int_equal(targets.count, 1);
	assert_true(targets.target[0].point.x == 0.5f && targets.target[0].weight == 1);
}

static void picture_without_pixels_is_refused(void **state)
{
	(void)state;
	static const float flat[1] = { 0 };
	struct gz_targets targets;
	assert_int_equal(gz_targets_from_luminance(flat, 0, 1, &targets), GZ_ERR_INVAL);
	assert_int_equal(gz_targets_from_luminance(flat, 1, 20000, &targets), GZ_ERR_INVAL);
}

TEST_SUITE(targets)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(list_with_comments_is_read),
		cmocka_unit_test(faulty_lists_are_refused_and_nothing_is_written),
		cmocka_unit_test(too_many_targets_are_refused),
		cmocka_unit_test(missing_file_is_refused),
		cmocka_unit_test(bright_discs_are_salient_the_brighter_first),
		cmocka_unit_test(picture_file_gives_the_same_targets),
		cmocka_unit_test(flat_picture_gives_its_centre),
		cmocka_unit_test(picture_without_pixels_is_refused),
	};
	return cmocka_run_group_tests_name("sim.targets", tests, NULL, NULL);
}
