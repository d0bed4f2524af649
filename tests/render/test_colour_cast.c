/* Volumes with colours of their own, drawn: against the oracle, kernel against kernel, and by every
 * method. This suite runs over each backend. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle.h"
#include "oracle_check.h"
#include "render/data/levels.h"
#include "render/data/voxel_colour.h"
#include "render/plan/method.h"
#include "small_scene.h"

static const enum gz_volume_colour colours[] = { GZ_COLOUR_LUMINANCE, GZ_COLOUR_ALPHA };

static void cast_of_colours_equals_the_oracle(void **state)
{
	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct small_scene scene = small_scene_coloured(40, 33, 27, colours[i]);
		oracle_check(&scene, 61, 47);
	}
}

static void cast_of_colours_over_a_background_and_clipped_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(24, 31, 24, GZ_COLOUR_ALPHA);
	scene.rays.background[0] = 1;
	scene.rays.background[2] = 0.3;
	scene.rays.clip.least[0] = 0.37;
	scene.rays.clip.greatest[2] = 0.81;
	oracle_check(&scene, 40, 40);
}

static void cast_of_colours_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(20, 20, 20, GZ_COLOUR_ALPHA);
	scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	oracle_check_but(&scene, 64, 64, 4);
	small_scene_free(&scene);
}

static void cast_of_colours_of_rays_any_distance_apart_equals_the_oracle(void **state)
{
	(void)state;
	/* What blocks, wide blocks and neither hold. */
	static const int sizes[][2] = { { 24, 470 }, { 30, 170 }, { 60, 60 }, { 17, 13 } };
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		struct small_scene scene = small_scene_coloured(230, 70, 50, GZ_COLOUR_ALPHA);
		oracle_check(&scene, sizes[i][0], sizes[i][1]);
	}
}

static void cast_of_colours_with_light_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(30, 28, 26, GZ_COLOUR_ALPHA);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	oracle_check(&scene, 48, 40);
}

/* The table gives the opacity of a segment, its middle the colour. */
static void pre_integrated_cast_of_colours_equals_the_oracle(void **state)
{
	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct small_scene scene = small_scene_coloured(30, 28, 26, colours[i]);
		scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
		oracle_check(&scene, 48, 40);
	}
}

static void cast_of_colours_of_flat_and_single_voxels_equals_the_oracle(void **state)
{
	(void)state;
	static const int dims[][3] = { { 1, 1, 1 },   { 1, 1, 40 },  { 40, 1, 1 },
				       { 1, 40, 40 }, { 40, 40, 1 }, { 2, 2, 2 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene scene =
			small_scene_coloured(dims[i][0], dims[i][1], dims[i][2], GZ_COLOUR_ALPHA);
		scene.transfer.points[0].opacity = 0.2;
		oracle_check(&scene, 37, 31);
	}
}

/* A red ball of alpha 255 in black of alpha 0: black must not show at its rim. */
static void colour_of_transparent_voxels_does_not_show(void **state)
{
	(void)state;
	enum { EDGE = 24 };
	struct small_scene scene = small_scene_coloured(EDGE, EDGE, EDGE, GZ_COLOUR_ALPHA);
	const uint8_t red[3] = { 255, 0, 0 }, black[3] = { 0, 0, 0 };
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const double x = i % EDGE - 11.5, y = i / EDGE % EDGE - 11.5;
		const double z = i / EDGE / EDGE - 11.5; // NOLINT(bugprone-integer-division)
		const bool inside = x * x + y * y + z * z < 64;
		((uint8_t *)scene.volume.voxels)[i] = inside ? 255 : 0;
		scene.volume.colours[i] =
			inside ? gz_colour_pack(red, 255) : gz_colour_pack(black, 0);
	}
	gz_volume_find_range(&scene.volume);
	scene.transfer = (struct gz_transfer) {
		.count = 2,
		.points = { { 0, { 1, 1, 1 }, 0 }, { 1, { 1, 1, 1 }, 0.9 } },
	};
	for (int c = 0; c < 3; c++)
		scene.rays.background[c] = c == 0 ? 1 : 0;
	scene.foveation.method = GZ_METHOD_STANDARD;
	for (const char *const *set = small_scene_simd_sets(); *set; set++) {
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, *set);
		struct gz_image image = { 0 };
		small_scene_render(renderer, &scene, 96, 96, &image, NULL);
		/* On red nothing else than red may be seen. */
		for (int i = 0; i < 96 * 96; i++)
			if (image.pixels[4 * i] < 254)
				fail_msg("%s: pixel %d is %d", *set, i, image.pixels[4 * i]);
		gz_image_free(&image);
		gz_raycaster_destroy(&renderer);
	}
	small_scene_free(&scene);
}

static void colours_are_the_same_bits_for_any_number_of_threads(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(50, 41, 60, GZ_COLOUR_ALPHA);
	scene.foveation.method = GZ_METHOD_ACUITY;
	struct gz_image images[2] = { 0 };
	for (int i = 0; i < 2; i++) {
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1 + 3 * i, NULL);
		small_scene_render(renderer, &scene, 317, 203, &images[i], NULL);
		gz_raycaster_destroy(&renderer);
	}
	assert_memory_equal(images[0].pixels, images[1].pixels, 317 * 203 * 4);
	gz_image_free(&images[0]);
	gz_image_free(&images[1]);
	small_scene_free(&scene);
}

static void colours_by_every_instruction_set_agree_within_one_grey_level(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_coloured(50, 41, 60, GZ_COLOUR_ALPHA);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	small_scene_sets_agree(&scene);
	small_scene_free(&scene);
}

/* Near the gaze point methods that are sharp there cast every pixel's ray as `standard` does. */
static void colours_at_the_gaze_point_equal_those_of_standard(void **state)
{
	(void)state;
	enum { WIDTH = 900, HEIGHT = 700, REACH = 12 };
	struct small_scene scene = small_scene_coloured(48, 48, 48, GZ_COLOUR_ALPHA);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image full = { 0 }, image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &full, NULL);
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		if (!gz_methods[method].sharp_at_gaze)
			continue;
		scene.foveation.method = method;
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
		for (int y = HEIGHT / 2 - REACH; y < HEIGHT / 2 + REACH; y++) {
			const size_t at = 4 * ((size_t)y * WIDTH + WIDTH / 2 - REACH);
			assert_memory_equal(full.pixels + at, image.pixels + at, 8 * REACH);
		}
	}
	gz_image_free(&full);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

/* Rays and samples far apart take a coarser level, colours too. */
static void colours_of_a_coarser_level_equal_the_oracle(void **state)
{
	(void)state;
	enum { WIDTH = 24, HEIGHT = 20 };
	struct small_scene scene = small_scene_coloured(96, 90, 100, GZ_COLOUR_ALPHA);
	struct gz_levels levels = { 0 };
	struct gz_image image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.levels = true;
	scene.rays.ray_sampling_rate = 0.25;
	gz_levels_start(&levels, &scene.volume);
	assert_int_equal(gz_levels_build(&levels, NULL), GZ_OK);
	const double across = gz_levels_pixel_lengths(&scene.volume, &scene.camera, HEIGHT);
	const int level = gz_levels_choose(&levels, across, 4);
	assert_true(level > 0);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double rgb[3];
			oracle_level_pixel(&scene.volume, &levels.level[level], &scene.transfer,
					   &scene.camera, &scene.rays, WIDTH, HEIGHT, x, y, rgb);
			for (int c = 0; c < 3; c++)
				if (fabs(image.pixels[4 * (y * WIDTH + x) + c] - 255 * rgb[c]) > 1)
					fail_msg("pixel %d %d channel %d: %d, oracle %.2f", x, y, c,
						 image.pixels[4 * (y * WIDTH + x) + c],
						 255 * rgb[c]);
		}
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
	gz_levels_free(&levels);
	small_scene_free(&scene);
}

TEST_SUITE(colour_cast)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cast_of_colours_equals_the_oracle),
		cmocka_unit_test(cast_of_colours_over_a_background_and_clipped_equals_the_oracle),
		cmocka_unit_test(
			cast_of_colours_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces),
		cmocka_unit_test(cast_of_colours_of_rays_any_distance_apart_equals_the_oracle),
		cmocka_unit_test(cast_of_colours_with_light_equals_the_oracle),
		cmocka_unit_test(pre_integrated_cast_of_colours_equals_the_oracle),
		cmocka_unit_test(cast_of_colours_of_flat_and_single_voxels_equals_the_oracle),
		cmocka_unit_test(colour_of_transparent_voxels_does_not_show),
		cmocka_unit_test(colours_are_the_same_bits_for_any_number_of_threads),
		cmocka_unit_test(colours_by_every_instruction_set_agree_within_one_grey_level),
		cmocka_unit_test(colours_at_the_gaze_point_equal_those_of_standard),
		cmocka_unit_test(colours_of_a_coarser_level_equal_the_oracle),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
