/* The kernels: against the oracle, against each other, and over threads. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "oracle_check.h"
#include "render/plan/method.h"
#include "small_scene.h"

static void cast_of_8_bit_data_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 33, 27, GZ_VOXEL_U8);
	oracle_check(&scene, 61, 47);
}

static void cast_of_16_bit_data_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 33, 27, GZ_VOXEL_U16);
	oracle_check(&scene, 61, 47);
}

static void cast_of_float_data_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 33, 27, GZ_VOXEL_F32);
	oracle_check(&scene, 61, 47);
}

static void cast_over_a_bright_background_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	scene.rays.background[0] = 1;
	scene.rays.background[1] = 0.7;
	scene.rays.background[2] = 0.2;
	oracle_check(&scene, 40, 40);
}

static void cast_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces(void **state)
{
	(void)state;
	/* Where a sample lies within rounding of a face, either voxel is right: count, not forbid.
	 */
	struct small_scene scene = small_scene_waves(20, 20, 20, GZ_VOXEL_U8);
	scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	oracle_check_but(&scene, 64, 64, 4);
	small_scene_free(&scene);
}

static void cast_of_rays_any_distance_apart_equals_the_oracle(void **state)
{
	(void)state;
	/* From half a voxel from ray to ray to forty: what blocks, wide blocks and neither hold,
	 * and more than the largest of fine cells. */
	static const int sizes[][2] = { { 24, 470 }, { 24, 260 }, { 30, 170 }, { 60, 60 },
					{ 33, 21 },  { 17, 13 },  { 9, 7 } };
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
		for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
			struct small_scene scene =
				small_scene_waves(230, 70, 50, (enum gz_voxel_type)type);
			scene.transfer.points[1].value = 0.45; /* more of it is empty */
			oracle_check(&scene, sizes[i][0], sizes[i][1]);
		}
}

static void cast_orthographic_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 30, 18, GZ_VOXEL_U8);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	oracle_check(&scene, 50, 38);
}

static void cast_along_an_axis_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U8);
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	memcpy(scene.camera.eye, (double[3]) { 0, -2, 0 }, sizeof scene.camera.eye);
	scene.camera.height = 1.0937; /* no ray on a voxel's face */
	oracle_check(&scene, 41, 41);
}

static void cast_from_inside_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 30, 30, GZ_VOXEL_U8);
	memcpy(scene.camera.eye, (double[3]) { 0.13, 0.21, 0.07 }, sizeof scene.camera.eye);
	memcpy(scene.camera.look_at, (double[3]) { -0.3, -0.2, 0.1 }, sizeof scene.camera.look_at);
	oracle_check(&scene, 40, 40);
}

static void cast_from_a_face_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(30, 30, 30, GZ_VOXEL_U8);
	memcpy(scene.camera.eye, (double[3]) { 0.5, 0.03, 0.04 }, sizeof scene.camera.eye);
	oracle_check(&scene, 40, 40);
}

static void cast_of_anisotropic_voxels_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(32, 32, 8, GZ_VOXEL_U8);
	scene.volume.spacing[2] = 10;
	oracle_check(&scene, 48, 48);
}

static void cast_of_flat_and_single_voxels_equals_the_oracle(void **state)
{
	(void)state;
	static const int dims[][3] = { { 1, 1, 1 },   { 1, 1, 40 },  { 40, 1, 1 },
				       { 1, 40, 40 }, { 40, 40, 1 }, { 2, 2, 2 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene scene =
			small_scene_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		/* Constant data is all "least": let that show. */
		scene.transfer.points[0].opacity = 0.2;
		oracle_check(&scene, 37, 31);
	}
}

static void cast_with_a_given_range_and_falling_slope_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(24, 24, 24, GZ_VOXEL_U16);
	scene.volume.slope = -0.25;
	scene.volume.intercept = 9000;
	scene.transfer.has_range = true;
	scene.transfer.range[0] = -2000;
	scene.transfer.range[1] = 8000;
	oracle_check(&scene, 40, 40);
}

static void cast_of_opaque_and_of_transparent_matter_equals_the_oracle(void **state)
{
	(void)state;
	struct small_scene opaque = small_scene_constant(20, 1);
	oracle_check(&opaque, 33, 33);
	struct small_scene transparent = small_scene_constant(20, 0);
	transparent.rays.background[1] = 0.5;
	oracle_check(&transparent, 33, 33);
}

static void cast_is_the_same_bits_for_any_number_of_threads(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(50, 41, 60, GZ_VOXEL_U8);
	for (int method = 0; method < GZ_METHOD_COUNT; method++) {
		struct gz_image first = { 0 };
		uint64_t samples = 0;
		scene.foveation.method = method;
		for (int threads = 1; threads <= 7; threads += 2) {
			struct gz_raycaster *renderer = small_scene_renderer(&scene, threads, NULL);
			struct gz_image image = { 0 };
			struct gz_frame_stats stats;
			small_scene_render(renderer, &scene, 317, 203, &image, &stats);
			if (threads == 1) {
				first = image;
				samples = stats.samples;
			} else {
				assert_memory_equal(first.pixels, image.pixels, 317 * 203 * 4);
				assert_int_equal(stats.samples, samples);
				gz_image_free(&image);
			}
			gz_raycaster_destroy(&renderer);
		}
		gz_image_free(&first);
	}
	small_scene_free(&scene);
}

static void cast_by_every_instruction_set_agrees_within_one_grey_level(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(50, 41, 60, GZ_VOXEL_U8);
	small_scene_sets_agree(&scene);
	small_scene_free(&scene);
}

/* The share of samples that rays a pixel apart take in a box of which a layer shows. */
static void samples_are_taken_in_fine_cells_that_show_alone(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(64, 64, 64, GZ_VOXEL_U8);
	uint8_t *voxels = scene.volume.voxels;
	struct gz_image image = { 0 };
	struct gz_frame_stats all, layer;
	scene.transfer = (struct gz_transfer) {
		.count = 2,
		.points = { { 0.5, { 1, 1, 1 }, 0 }, { 1, { 1, 1, 1 }, 0.001 } },
		.has_range = true,
		.range = { 0, 200 },
	};
	memset(voxels, 200, (size_t)64 * 64 * 64);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 256, 256, &image, &all);
	gz_raycaster_destroy(&renderer);
	/* A sheet two voxels thick lies in one layer of cells, or two. */
	memset(voxels, 0, (size_t)64 * 64 * 64);
	memset(voxels + (size_t)64 * 64 * 17, 200, (size_t)64 * 64 * 2);
	renderer = small_scene_renderer(&scene, 1, NULL);
	small_scene_render(renderer, &scene, 256, 256, &image, &layer);
	/* OpenGL asks macrocells alone. */
	const unsigned share = strcmp(small_scene_backend(), "gl") == 0 ? 6 : 12;
	gz_raycaster_destroy(&renderer);
	assert_true(layer.samples > 0);
	if (layer.samples * share > all.samples)
		fail_msg("%llu samples of %llu", (unsigned long long)layer.samples,
			 (unsigned long long)all.samples);
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void empty_space_takes_no_samples(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(64, 0);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
	struct gz_image image = { 0 };
	struct gz_frame_stats stats;
	small_scene_render(renderer, &scene, 64, 64, &image, &stats);
	assert_int_equal(stats.samples, 0);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
	small_scene_free(&scene);
}

/* Of matter that lets 1/1024 through after 20 voxels, a ray through 40 takes half its samples. */
static void ray_without_early_termination_takes_all_samples_and_shows_the_same(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(40, 1 - pow(1.0 / 1024, 1.0 / 20));
	scene.rays.background[0] = 1;
	for (int integration = 0; integration < 2; integration++) {
		struct gz_raycaster *renderer = small_scene_renderer(&scene, 1, NULL);
		struct gz_image images[2] = { 0 };
		struct gz_frame_stats stats[2];
		scene.rays.integration = integration;
		for (int early = 0; early < 2; early++) {
			scene.rays.early_termination = early;
			small_scene_render(renderer, &scene, 9, 9, &images[early], &stats[early]);
		}
		if (!(stats[0].samples > 1.5 * (double)stats[1].samples))
			fail_msg("%llu samples without, %llu with early termination",
				 (unsigned long long)stats[0].samples,
				 (unsigned long long)stats[1].samples);
		int x, y;
		assert_in_range(image_difference(&images[0], &images[1], &x, &y), 0, 1);
		scene.rays.early_termination = false;
		oracle_check_but(&scene, 9, 9, 0);
		scene.rays.early_termination = true;
		for (int i = 0; i < 2; i++)
			gz_image_free(&images[i]);
		gz_raycaster_destroy(&renderer);
	}
	small_scene_free(&scene);
}

static void unknown_backend_and_instruction_set_are_refused(void **state)
{
	(void)state;
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(gz_raycaster_create("quantum", NULL, NULL, &renderer), GZ_ERR_NOT_FOUND);
	const struct gz_backend_params params = { .simd = "mmx" };
	assert_int_equal(gz_raycaster_create("cpu", &params, NULL, &renderer), GZ_ERR_UNSUPPORTED);
	const struct gz_backend_params threads = { .threads = 100000 };
	assert_int_equal(gz_raycaster_create("cpu", &threads, NULL, &renderer), GZ_ERR_INVAL);
	assert_null(renderer);
}

static void render_without_volume_or_with_bad_parameters_is_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(8, 8, 8, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = NULL;
	struct gz_image image = { 0 };
	struct gz_plan plan = { 0 };
	const struct gz_display display = gz_display_default(16, 16);
	assert_int_equal(gz_plan_make(&scene.foveation, &display, scene.gaze, 16, 16, &plan),
			 GZ_OK);
	assert_int_equal(gz_raycaster_create(NULL, NULL, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_ERR_INVAL);
	assert_int_equal(
		gz_raycaster_render(renderer, &scene.camera, &scene.rays, &plan, &image, NULL),
		GZ_ERR_INVAL);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene.volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_OK);
	struct gz_camera camera = scene.camera;
	camera.fov_deg = NAN;
	assert_int_equal(gz_raycaster_render(renderer, &camera, &scene.rays, &plan, &image, NULL),
			 GZ_ERR_INVAL);
	struct gz_ray_params rays = scene.rays;
	rays.ray_sampling_rate = NAN;
	assert_int_equal(gz_raycaster_render(renderer, &scene.camera, &rays, &plan, &image, NULL),
			 GZ_ERR_INVAL);
	gz_plan_free(&plan);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

TEST_SUITE(cast)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cast_of_8_bit_data_equals_the_oracle),
		cmocka_unit_test(cast_of_16_bit_data_equals_the_oracle),
		cmocka_unit_test(cast_of_float_data_equals_the_oracle),
		cmocka_unit_test(cast_over_a_bright_background_equals_the_oracle),
		cmocka_unit_test(cast_by_nearest_voxel_equals_the_oracle_but_on_voxel_faces),
		cmocka_unit_test(cast_of_rays_any_distance_apart_equals_the_oracle),
		cmocka_unit_test(cast_orthographic_equals_the_oracle),
		cmocka_unit_test(cast_along_an_axis_equals_the_oracle),
		cmocka_unit_test(cast_from_inside_equals_the_oracle),
		cmocka_unit_test(cast_from_a_face_equals_the_oracle),
		cmocka_unit_test(cast_of_anisotropic_voxels_equals_the_oracle),
		cmocka_unit_test(cast_of_flat_and_single_voxels_equals_the_oracle),
		cmocka_unit_test(cast_with_a_given_range_and_falling_slope_equals_the_oracle),
		cmocka_unit_test(cast_of_opaque_and_of_transparent_matter_equals_the_oracle),
		cmocka_unit_test(cast_is_the_same_bits_for_any_number_of_threads),
		cmocka_unit_test(cast_by_every_instruction_set_agrees_within_one_grey_level),
		cmocka_unit_test(samples_are_taken_in_fine_cells_that_show_alone),
		cmocka_unit_test(empty_space_takes_no_samples),
		cmocka_unit_test(
			ray_without_early_termination_takes_all_samples_and_shows_the_same),
		cmocka_unit_test(unknown_backend_and_instruction_set_are_refused),
		cmocka_unit_test(render_without_volume_or_with_bad_parameters_is_refused),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
