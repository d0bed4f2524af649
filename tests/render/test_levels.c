/* Levels of detail: what they hold, which is taken, and that it stands where the full volume does.
 */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "oracle.h"
#include "render/data/levels.h"
#include "render/plan/method.h"
#include "render/raycast/shared/detail.h"
#include "small_scene.h"

static const char *const sets[] = { "portable", "avx2", "avx512" };

static bool runs_here(const char *set)
{
	const struct gz_backend_params params = { .threads = 1, .simd = set };
	struct gz_raycaster *renderer = NULL;
	const bool runs = gz_raycaster_create("cpu", &params, NULL, &renderer) == GZ_OK;
	gz_raycaster_destroy(&renderer);
	return runs;
}

static void levels_halve_until_nothing_is_left_and_take_at_most_a_seventh(void **state)
{
	(void)state;
	static const struct {
		int dims[3];
		double spacing[3];
		double second_scale; /* of level 1 */
	} cases[] = {
		{ { 128, 128, 128 }, { 1, 1, 1 }, 2 }, { { 130, 64, 32 }, { 1, 1, 1 }, 2 },
		{ { 128, 128, 64 }, { 1, 1, 2 }, 4 },  { { 1, 200, 200 }, { 1, 1, 1 }, 4 },
		{ { 1, 1, 300 }, { 1, 1, 1 }, 8 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const int *dims = cases[i].dims;
		struct small_scene scene =
			small_scene_waves(dims[0], dims[1], dims[2], GZ_VOXEL_U8);
		memcpy(scene.volume.spacing, cases[i].spacing, sizeof scene.volume.spacing);
		struct gz_levels levels = { 0 };
		gz_levels_start(&levels, &scene.volume);
		assert_int_equal(levels.count, 1);
		assert_int_equal(gz_levels_build(&levels, NULL), GZ_OK);
		assert_true(levels.count > 1);
		size_t coarser = 0;
		for (int level = 1; level < levels.count; level++) {
			const struct gz_level *is = &levels.level[level], *before = is - 1;
			assert_true(is->scale >= 2 * before->scale);
			coarser += gz_volume_voxel_count(&is->volume);
			for (int axis = 0; axis < 3; axis++)
				assert_int_equal(is->volume.dims[axis],
						 (dims[axis] + is->factor[axis] - 1) /
							 is->factor[axis]);
		}
		if (levels.level[1].scale != cases[i].second_scale)
			fail_msg("case %zu: scale %g", i, levels.level[1].scale);
		const double share = (double)coarser / (double)gz_volume_voxel_count(&scene.volume);
		if (share > 1.0 / 7 + 0.02)
			fail_msg("case %zu: %g of the volume", i, share);
		gz_levels_free(&levels);
		small_scene_free(&scene);
	}
}

static void levels_are_the_same_bits_for_any_number_of_workers(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(61, 50, 47, GZ_VOXEL_U16);
	struct gz_levels alone = { 0 }, shared = { 0 };
	struct gz_workers *workers = NULL;
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	gz_levels_start(&alone, &scene.volume);
	gz_levels_start(&shared, &scene.volume);
	assert_int_equal(gz_levels_build(&alone, NULL), GZ_OK);
	assert_int_equal(gz_levels_build(&shared, workers), GZ_OK);
	assert_int_equal(alone.count, shared.count);
	for (int level = 1; level < alone.count; level++)
		assert_memory_equal(alone.level[level].volume.voxels,
				    shared.level[level].volume.voxels,
				    2 * gz_volume_voxel_count(&alone.level[level].volume));
	gz_workers_destroy(&workers);
	gz_levels_free(&alone);
	gz_levels_free(&shared);
	small_scene_free(&scene);
}

static void levels_of_a_large_volume_are_made_in_one_pass_each(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(256, 0.1);
	struct gz_levels levels = { 0 };
	gz_levels_start(&levels, &scene.volume);
	const int64_t start_ns = gz_clock_now_ns();
	assert_int_equal(gz_levels_build(&levels, NULL), GZ_OK);
	print_message("levels of 256^3 bytes: %.1f ms on one core\n",
		      gz_ns_to_ms(gz_clock_now_ns() - start_ns));
	assert_int_equal(levels.count, 6); /* 256 to 8 */
	for (int level = 1; level < levels.count; level++) {
		const struct gz_volume *volume = &levels.level[level].volume;
		const uint8_t *voxels = volume->voxels;
		assert_int_equal(volume->dims[0], 256 >> level);
		assert_int_equal(voxels[gz_volume_voxel_count(volume) - 1], 128);
	}
	gz_levels_free(&levels);
	small_scene_free(&scene);
}

static void level_follows_the_smaller_of_spacing_and_step(void **state)
{
	(void)state;
	const struct gz_levels levels = {
		.count = 4,
		.level = { { .scale = 1 }, { .scale = 2 }, { .scale = 4 }, { .scale = 8 } },
	};
	static const struct {
		double across, along;
		int level;
	} cases[] = {
		{ 1, 1, 0 },  { 0, 100, 0 }, { 1.4, 1.4, 0 }, { 1.5, 1.5, 1 }, { 16, 1, 0 },
		{ 1, 16, 0 }, { 2.9, 8, 2 }, { 8, 2.9, 2 },   { 4, 4, 2 },     { 1e9, 1e9, 3 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const int level = gz_levels_choose(&levels, cases[i].across, cases[i].along);
		if (level != cases[i].level)
			fail_msg("%g across, %g along: level %d, not %d", cases[i].across,
				 cases[i].along, level, cases[i].level);
	}
}

/* 64 voxels and a picture as high as the box at its near face: a voxel spans height / 64 pixels. */
static void steps_are_bounded_where_the_eye_is_close_and_not_from_afar(void **state)
{
	(void)state;
	const struct gz_volume volume = { .dims = { 64, 64, 64 }, .spacing = { 1, 1, 1 } };
	struct gz_camera camera = { .eye = { 0, -1, 0 }, .up = { 0, 0, 1 }, .fov_deg = 90 };
	const struct gz_ray_params rays = { .ray_sampling_rate = 1 };
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 64) == 1);
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 15 * 64) == 1);
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 17 * 64) == 0.5);
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 60 * 64) == 0.25);
	camera.eye[1] = -0.5 - 1e-9;
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 64) == 0);
	camera.eye[1] = 0.2;
	assert_true(gz_detail_steps_per_px(&volume, &camera, &rays, 64) == 0);
}

static void pixels_footprint_is_that_of_the_nearest_point_of_the_box(void **state)
{
	(void)state;
	const struct gz_volume volume = { .dims = { 100, 50, 50 }, .spacing = { 1, 1, 1 } };
	struct gz_camera camera = { .eye = { 2.5, 0, 0 }, .fov_deg = 90, .height = 2 };
	/* 2 from the face at 0.5: the view is 4 high there, a voxel length is 0.01 */
	assert_true(fabs(gz_levels_pixel_lengths(&volume, &camera, 100) - 4) < 1e-9);
	camera.eye[0] = 0.2;
	assert_true(gz_levels_pixel_lengths(&volume, &camera, 100) == 0);
	camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	assert_true(fabs(gz_levels_pixel_lengths(&volume, &camera, 100) - 2) < 1e-9);
}

/* A scene seen from so far, with steps so long, that level 1 is taken: 2.5 voxel lengths. */
static void see_from_afar(struct small_scene *scene, int height)
{
	scene->camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	scene->camera.height = 2.5 * gz_volume_voxel_length(&scene->volume) * height;
	scene->rays.ray_sampling_rate = 1 / 2.5;
	scene->rays.levels = true;
	scene->foveation.method = GZ_METHOD_STANDARD;
}

static void check_against_oracle(struct small_scene *scene, const char *set, int side)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, set);
	struct gz_image image = { 0 };
	struct gz_levels levels = { 0 };
	gz_levels_start(&levels, &scene->volume);
	assert_int_equal(gz_levels_build(&levels, NULL), GZ_OK);
	small_scene_render(renderer, scene, side, side, &image, NULL);
	int different = 0; /* pixels that the full volume would have shown otherwise */
	for (int i = 0; i < side * side; i++) {
		double rgb[3], full[3];
		oracle_level_pixel(&scene->volume, &levels.level[1], &scene->transfer,
				   &scene->camera, &scene->rays, side, side, i % side, i / side,
				   rgb);
		oracle_pixel(&scene->volume, &scene->transfer, &scene->camera, &scene->rays, side,
			     side, i % side, i / side, full);
		different += fabs(255 * (full[0] - rgb[0])) > 1.5;
		for (int channel = 0; channel < 3; channel++)
			/* half a grey level is rounding; what the tables add grows with the step */
			if (fabs(image.pixels[4 * i + channel] - 255 * rgb[channel]) > 1.25)
				fail_msg("%s: pixel %d %d channel %d: %d, oracle %.3f",
					 set == NULL ? "own set" : set, i % side, i / side, channel,
					 image.pixels[4 * i + channel], 255 * rgb[channel]);
	}
	assert_true(different > 0);
	gz_levels_free(&levels);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
}

static void cast_of_a_coarser_level_equals_the_oracle(void **state)
{
	(void)state;
	static const int dims[][3] = { { 80, 64, 72 }, { 81, 63, 71 } };
	for (size_t d = 0; d < 2; d++)
		for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
			for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
				if (!runs_here(sets[i]))
					continue;
				struct small_scene scene =
					small_scene_waves(dims[d][0], dims[d][1], dims[d][2],
							  (enum gz_voxel_type)type);
				see_from_afar(&scene, 36);
				check_against_oracle(&scene, sets[i], 36);
				small_scene_free(&scene);
			}
}

static void cast_of_coarser_levels_of_anisotropic_voxels_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(96, 90, 31, GZ_VOXEL_U8);
	scene.volume.spacing[2] = 3;
	see_from_afar(&scene, 36);
	/* level 1 is two halvings along x and y: voxels of 4, 4 and 3 lengths */
	scene.camera.height *= 1.4;
	scene.rays.ray_sampling_rate /= 1.4;
	check_against_oracle(&scene, NULL, 36);
	small_scene_free(&scene);
}

static void cast_of_a_coarser_level_with_clip_box_and_jitter_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(81, 63, 71, GZ_VOXEL_U8);
	see_from_afar(&scene, 36);
	memcpy(scene.rays.clip.least, (double[3]) { 0.21, 0.33, 0.1 },
	       sizeof scene.rays.clip.least);
	memcpy(scene.rays.clip.greatest, (double[3]) { 0.9, 0.77, 0.83 },
	       sizeof scene.rays.clip.greatest);
	scene.rays.jitter = 7;
	check_against_oracle(&scene, NULL, 36);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	check_against_oracle(&scene, NULL, 36);
	small_scene_free(&scene);
}

static void levels_change_no_bit_where_data_are_coarser_than_pixels(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(64, 64, 64, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		struct gz_image without = { 0 }, with = { 0 };
		scene.foveation.method = method;
		scene.rays.levels = false;
		small_scene_render(renderer, &scene, 300, 200, &without, NULL);
		scene.rays.levels = true;
		small_scene_render(renderer, &scene, 300, 200, &with, NULL);
		if (method == GZ_METHOD_STANDARD)
			assert_memory_equal(without.pixels, with.pixels, 300 * 200 * 4);
		else /* the nearest voxel is that of the data, and the fovea is fine */
			assert_memory_equal(without.pixels + (100 * 300 + 150) * 4,
					    with.pixels + (100 * 300 + 150) * 4, 4);
		scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
		small_scene_render(renderer, &scene, 300, 200, &with, NULL);
		scene.rays.levels = false;
		small_scene_render(renderer, &scene, 300, 200, &without, NULL);
		assert_memory_equal(without.pixels, with.pixels, 300 * 200 * 4);
		scene.rays.interpolation = GZ_INTERPOLATION_TRILINEAR;
		gz_image_free(&without);
		gz_image_free(&with);
	}
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void constant_box_keeps_size_and_brightness_at_every_level(void **state)
{
	(void)state;
	/* An odd size: the box of a coarser level would be larger. */
	struct small_scene scene = small_scene_constant(77, 0.013);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	scene.rays.levels = true;
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	for (double lengths = 1; lengths < 20; lengths *= 2) {
		struct gz_image full = { 0 }, image = { 0 };
		int x = 0, y = 0;
		scene.camera.height = lengths / 77 * 40;
		scene.rays.ray_sampling_rate = 4;
		small_scene_render(renderer, &scene, 40, 40, &full, NULL);
		scene.rays.ray_sampling_rate = 1 / lengths;
		small_scene_render(renderer, &scene, 40, 40, &image, NULL);
		if (image_difference(&full, &image, &x, &y) > 1)
			fail_msg("%g voxel lengths: pixel %d %d differs", lengths, x, y);
		gz_image_free(&full);
		gz_image_free(&image);
	}
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void levels_follow_a_new_transfer_function_and_a_new_volume(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(64, 64, 64, GZ_VOXEL_U8);
	struct small_scene other = small_scene_waves(50, 80, 40, GZ_VOXEL_U16);
	see_from_afar(&scene, 40);
	see_from_afar(&other, 40);
	struct gz_raycaster *used = small_scene_renderer(&scene, 2, NULL);
	struct gz_image first = { 0 }, second = { 0 };
	small_scene_render(used, &scene, 40, 40, &first, NULL);
	/* what was empty shows now */
	scene.transfer.points[0].opacity = other.transfer.points[0].opacity = 0.1;
	struct small_scene *const scenes[] = { &scene, &other };
	for (int i = 0; i < 2; i++) {
		struct gz_raycaster *fresh = small_scene_renderer(scenes[i], 2, NULL);
		small_scene_render(fresh, scenes[i], 40, 40, &first, NULL);
		if (i == 1)
			assert_int_equal(gz_raycaster_set_volume(used, &other.volume), GZ_OK);
		assert_int_equal(gz_raycaster_set_transfer(used, &scenes[i]->transfer), GZ_OK);
		small_scene_render(used, scenes[i], 40, 40, &second, NULL);
		assert_memory_equal(first.pixels, second.pixels, 40 * 40 * 4);
		gz_raycaster_destroy(&fresh);
	}
	gz_image_free(&first);
	gz_image_free(&second);
	gz_raycaster_destroy(&used);
	small_scene_free(&scene);
	small_scene_free(&other);
}

TEST_SUITE(levels)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_are_bounded_where_the_eye_is_close_and_not_from_afar),
		cmocka_unit_test(levels_halve_until_nothing_is_left_and_take_at_most_a_seventh),
		cmocka_unit_test(levels_are_the_same_bits_for_any_number_of_workers),
		cmocka_unit_test(levels_of_a_large_volume_are_made_in_one_pass_each),
		cmocka_unit_test(level_follows_the_smaller_of_spacing_and_step),
		cmocka_unit_test(pixels_footprint_is_that_of_the_nearest_point_of_the_box),
		cmocka_unit_test(cast_of_a_coarser_level_equals_the_oracle),
		cmocka_unit_test(cast_of_coarser_levels_of_anisotropic_voxels_equals_the_oracle),
		cmocka_unit_test(
			cast_of_a_coarser_level_with_clip_box_and_jitter_equals_the_oracle),
		cmocka_unit_test(levels_change_no_bit_where_data_are_coarser_than_pixels),
		cmocka_unit_test(constant_box_keeps_size_and_brightness_at_every_level),
		cmocka_unit_test(levels_follow_a_new_transfer_function_and_a_new_volume),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
