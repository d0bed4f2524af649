/* The metrics against values that their authors' programs, or arithmetic, give. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/metrics/approximate.h"
#include "bench/metrics/metrics.h"
#include "bench/metrics/temporal.h"

/* What FLIP was measured at: 0.7 m from a 0.7 m wide display of 3840 pixels. */
#define PX_PER_DEG 67.02064327658226

static struct gz_workers *workers;

static int start_workers(void **state)
{
	(void)state;
	return gz_workers_create(2, &workers) == GZ_OK ? 0 : -1;
}

static int end_workers(void **state)
{
	(void)state;
	gz_workers_destroy(&workers);
	return 0;
}

static void near(double value, double expected, double tolerance)
{
	if (!(fabs(value - expected) <= tolerance))
		fail_msg("%.9f is not %.9f to %.1e", value, expected, tolerance);
}

static struct gz_image plain(int width, int height, int red, int green, int blue)
{
	struct gz_image image = { 0 };
	assert_int_equal(gz_image_resize(&image, width, height), GZ_OK);
	for (int i = 0; i < width * height; i++) {
		const uint8_t pixel[4] = { (uint8_t)red, (uint8_t)green, (uint8_t)blue, 255 };
		memcpy(image.pixels + 4 * i, pixel, 4);
	}
	return image;
}

static struct gz_image read_data(const char *name)
{
	const char *data = getenv("GAZECAST_DATA");
	struct gz_image image = { 0 };
	char path[4096];
	if (!data) /* the rest of the file has run by then */
		skip();
	snprintf(path, sizeof path, "%s/metrics/%s", data, name);
	assert_int_equal(gz_image_read_png(path, NULL, &image), GZ_OK);
	return image;
}

static double flip_of(const struct gz_image *a, const struct gz_image *b)
{
	struct gz_map map = { 0 };
	assert_int_equal(gz_flip(a, b, PX_PER_DEG, workers, &map), GZ_OK);
	const double mean = gz_map_mean(&map);
	gz_map_free(&map);
	return mean;
}

static void flip_of_plain_colours_is_the_known_one(void **state)
{
	(void)state;
	static const struct {
		int a[3], b[3];
		double flip;
	} pairs[] = {
		{ { 0, 0, 0 }, { 255, 255, 255 }, 0.967380 },
		{ { 0, 255, 0 }, { 0, 0, 255 }, 1.000000 },
		{ { 255, 0, 0 }, { 0, 255, 0 }, 0.986662 },
		{ { 128, 128, 128 }, { 129, 129, 129 }, 0.029855 },
		{ { 7, 70, 200 }, { 7, 70, 200 }, 0 },
	};
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
		const int *a = pairs[i].a, *b = pairs[i].b;
		struct gz_image reference = plain(33, 20, a[0], a[1], a[2]);
		struct gz_image test = plain(33, 20, b[0], b[1], b[2]);
		near(flip_of(&reference, &test), pairs[i].flip, 2e-5);
		near(flip_of(&test, &reference), pairs[i].flip, 2e-5);
		gz_image_free(&reference);
		gz_image_free(&test);
	}
}

static int by_value(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* The value under which @p share of the sum of all values lies. */
static double weighted_percentile(struct gz_map *map, double share)
{
	const size_t count = (size_t)map->width * (size_t)map->height;
	qsort(map->values, count, sizeof *map->values, by_value);
	const double total = gz_map_mean(map) * (double)count;
	double sum = 0;
	for (size_t i = 0; i < count; i++) {
		sum += (double)map->values[i];
		if (sum >= share * total)
			return (double)map->values[i];
	}
	return 1;
}

static void flip_of_a_picture_is_the_known_one(void **state)
{
	(void)state;
	struct gz_image reference = read_data("tree-ref.png");
	struct gz_image test = read_data("tree-test.png");
	struct gz_map map = { 0 };
	assert_int_equal(gz_flip(&reference, &test, PX_PER_DEG, workers, &map), GZ_OK);
	near(gz_map_mean(&map), 0.133285, 1e-4);
	near(weighted_percentile(&map, 0.25), 0.184924, 1e-3);
	near(weighted_percentile(&map, 0.50), 0.333241, 1e-3);
	near(weighted_percentile(&map, 0.75), 0.503441, 1e-3);
	const size_t last = (size_t)map.width * (size_t)map.height - 1;
	near((double)map.values[0], 0, 1e-4);
	near((double)map.values[last], 0.983044, 1e-3);
	gz_map_free(&map);
	gz_image_free(&reference);
	gz_image_free(&test);
}

static void roots_and_powers_are_those_of_the_library(void **state)
{
	(void)state;
	assert_true(gz_power(0, 0.7F) == 0);
	assert_true(gz_power(1, 0.7F) == 1);
	for (int i = 1; i < 4000; i++) {
		const float x = ldexpf(1 + (float)(i * 37 % 1000) / 1000, i % 60 - 40);
		const float exponent = (float)(i % 101) / 100;
		near((double)gz_cube_root(x) / cbrt((double)x), 1, 4e-7);
		near((double)gz_power(x, exponent) / pow((double)x, (double)exponent), 1, 3e-6);
	}
}

static double ssim_of(const struct gz_image *a, const struct gz_image *b,
		      enum gz_ssim_window window)
{
	struct gz_map map = { 0 };
	assert_int_equal(gz_ssim(a, b, window, workers, &map), GZ_OK);
	const double mean = gz_map_mean(&map);
	gz_map_free(&map);
	return mean;
}

static void ssim_of_plain_greys_is_the_known_one(void **state)
{
	(void)state;
	struct gz_image a = plain(40, 30, 128, 128, 128), b = plain(40, 30, 129, 129, 129);
	near(ssim_of(&a, &b, GZ_SSIM_GAUSSIAN), 0.99996973, 5e-6);
	gz_image_free(&a);
	gz_image_free(&b);
	a = plain(40, 30, 100, 100, 100);
	b = plain(40, 30, 150, 150, 150);
	near(ssim_of(&a, &b, GZ_SSIM_GAUSSIAN), 0.92309231, 5e-6);
	near(ssim_of(&a, &b, GZ_SSIM_UNIFORM), 0.92309231, 5e-6);
	near(ssim_of(&a, &a, GZ_SSIM_UNIFORM), 1, 1e-6);
	gz_image_free(&a);
	gz_image_free(&b);
}

static void ssim_of_a_picture_is_the_known_one(void **state)
{
	(void)state;
	struct gz_image reference = read_data("camera.png");
	struct gz_image test = read_data("camera_noisy_seed5_sigma20.png");
	near(ssim_of(&reference, &test, GZ_SSIM_GAUSSIAN), 0.357959, 1e-4);
	near(ssim_of(&reference, &test, GZ_SSIM_UNIFORM), 0.3674518327910367, 5e-6);
	gz_image_free(&reference);
	gz_image_free(&test);
}

static void psnr_of_plain_greys_is_arithmetic(void **state)
{
	(void)state;
	struct gz_image a = plain(5, 7, 128, 128, 128), b = plain(5, 7, 129, 129, 129);
	struct gz_map map = { 0 };
	assert_int_equal(gz_squared_error(&a, &b, &map), GZ_OK);
	near(gz_psnr_db(gz_map_mean(&map)), 48.1308, 1e-4);
	assert_int_equal(gz_squared_error(&a, &a, &map), GZ_OK);
	assert_true(isinf(gz_psnr_db(gz_map_mean(&map))));
	gz_map_free(&map);
	gz_image_free(&a);
	gz_image_free(&b);
}

static void pictures_of_different_size_are_refused(void **state)
{
	(void)state;
	struct gz_image a = plain(20, 20, 1, 2, 3), b = plain(20, 21, 1, 2, 3);
	struct gz_image small = plain(10, 20, 1, 2, 3);
	struct gz_map map = { 0 };
	assert_int_equal(gz_squared_error(&a, &b, &map), GZ_ERR_INVAL);
	assert_int_equal(gz_ssim(&a, &b, GZ_SSIM_GAUSSIAN, workers, &map), GZ_ERR_INVAL);
	assert_int_equal(gz_ssim(&small, &small, GZ_SSIM_GAUSSIAN, workers, &map), GZ_ERR_INVAL);
	assert_int_equal(gz_flip(&a, &b, PX_PER_DEG, workers, &map), GZ_ERR_INVAL);
	assert_int_equal(gz_flip(&a, &a, NAN, workers, &map), GZ_ERR_INVAL);
	assert_int_equal(gz_flip(&a, &a, 1001, workers, &map), GZ_ERR_INVAL);
	assert_null(map.values);
	gz_image_free(&a);
	gz_image_free(&b);
	gz_image_free(&small);
}

static void every_number_of_threads_gives_the_same_bits(void **state)
{
	(void)state;
	struct gz_image a = plain(70, 50, 10, 200, 30), b = plain(70, 50, 10, 200, 30);
	for (int i = 0; i < 70 * 50; i++)
		b.pixels[4 * i + i % 3] = (uint8_t)(i * 37);
	struct gz_workers *one = NULL;
	struct gz_map x = { 0 }, y = { 0 };
	assert_int_equal(gz_workers_create(1, &one), GZ_OK);
	assert_int_equal(gz_flip(&a, &b, 30, one, &x), GZ_OK);
	assert_int_equal(gz_flip(&a, &b, 30, workers, &y), GZ_OK);
	assert_memory_equal(x.values, y.values, 70 * 50 * sizeof(float));
	assert_true(gz_map_mean(&x) > 0.05);
	gz_workers_destroy(&one);
	gz_map_free(&x);
	gz_map_free(&y);
	gz_image_free(&a);
	gz_image_free(&b);
}

static void weights_follow_the_eccentricity(void **state)
{
	(void)state;
	const struct gz_display display = gz_display_default(504, 300);
	const struct gz_point gaze = { 0.25F, 0.5F };
	struct gz_map acuity = { 0 }, fovea = { 0 }, rest = { 0 };
	assert_int_equal(gz_weights_acuity(&display, gaze, 504, 300, &acuity), GZ_OK);
	assert_int_equal(gz_weights_ring(&display, gaze, 504, 300,
					 (const double[2]) { 0, GZ_FOVEA_DEG }, &fovea),
			 GZ_OK);
	assert_int_equal(gz_weights_ring(&display, gaze, 504, 300,
					 (const double[2]) { GZ_FOVEA_DEG, 180 }, &rest),
			 GZ_OK);
	const size_t at_gaze = 150 * 504 + 126, far = 150 * 504 + 500;
	near((double)acuity.values[at_gaze], 1, 0.1);
	struct gz_point pixel = { 500.5F / 504, 150.5F / 300 };
	const double angle = gz_display_angle_deg(&display, gaze, pixel);
	near((double)acuity.values[far], pow(2.3 / (2.3 + angle), 2), 1e-6);
	near((double)fovea.values[at_gaze], 1, 0);
	near((double)fovea.values[far], 0, 0);
	near(gz_map_mean(&fovea) + gz_map_mean(&rest), 1, 1e-9);
	near(gz_map_weighted_mean(&fovea, &rest), 0, 0);
	near(gz_map_weighted_mean(&fovea, &fovea), 1, 0);
	gz_map_free(&acuity);
	gz_map_free(&fovea);
	gz_map_free(&rest);
}

/* Amplitude of the response to a sine, by pictures at 60 a second. */
static double response_to(double hertz)
{
	double weights[GZ_TEMPORAL_FRAMES], real = 0, imaginary = 0;
	gz_temporal_weights(60, weights);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++) {
		real += weights[i] * cos(2 * M_PI * hertz * i / 60);
		imaginary += weights[i] * sin(2 * M_PI * hertz * i / 60);
	}
	return hypot(real, imaginary);
}

static void eye_sees_changes_of_8_hertz_best_and_constants_not(void **state)
{
	(void)state;
	near(response_to(0), 0, 1e-12);
	near(response_to(8), 1, 0.02);
	assert_true(response_to(1) < 0.25);
	assert_true(response_to(3) < response_to(8) && response_to(20) < 0.5 * response_to(8));
	assert_true(response_to(30) < 0.1);
}

static void fill_map(struct gz_map *map, float even, float odd)
{
	assert_int_equal(gz_map_resize(map, 4, 3), GZ_OK);
	for (int i = 0; i < 12; i++)
		map->values[i] = i % 2 ? odd : even;
}

static void response_is_that_to_luma_frame_by_frame(void **state)
{
	(void)state;
	struct gz_image still = plain(4, 3, 200, 100, 50), other = plain(4, 3, 210, 100, 50);
	struct gz_map response = { 0 }, none = { 0 }, weights = { 0 };
	double frames[GZ_TEMPORAL_FRAMES];
	gz_temporal_weights(60, frames);
	fill_map(&response, 0, 0);
	fill_map(&none, 0, 0);
	fill_map(&weights, 1, 0);
	for (int i = 0; i < GZ_TEMPORAL_FRAMES; i++) {
		gz_map_add_luma(&none, &still, frames[i]);
		gz_map_add_luma(&response, i == 4 ? &other : &still, frames[i]);
	}
	near((double)none.values[0], 0, 1e-4);
	near(gz_map_weighted_difference(&response, &none, &weights), fabs(2.126 * frames[4]), 1e-4);
	fill_map(&response, 0, 9);
	fill_map(&none, 2, 0);
	near(gz_map_weighted_difference(&response, &none, &weights), 2, 0);
	gz_map_free(&response);
	gz_map_free(&none);
	gz_map_free(&weights);
	gz_image_free(&still);
	gz_image_free(&other);
}

TEST_SUITE(metrics)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(flip_of_plain_colours_is_the_known_one),
		cmocka_unit_test(flip_of_a_picture_is_the_known_one),
		cmocka_unit_test(roots_and_powers_are_those_of_the_library),
		cmocka_unit_test(ssim_of_plain_greys_is_the_known_one),
		cmocka_unit_test(ssim_of_a_picture_is_the_known_one),
		cmocka_unit_test(psnr_of_plain_greys_is_arithmetic),
		cmocka_unit_test(pictures_of_different_size_are_refused),
		cmocka_unit_test(every_number_of_threads_gives_the_same_bits),
		cmocka_unit_test(weights_follow_the_eccentricity),
		cmocka_unit_test(eye_sees_changes_of_8_hertz_best_and_constants_not),
		cmocka_unit_test(response_is_that_to_luma_frame_by_frame),
	};
	return cmocka_run_group_tests(tests, start_workers, end_workers);
}
