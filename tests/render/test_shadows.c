/* Soft shadows on the kernels: against the oracle, against light that is followed in small steps,
 * and against what a formula says of even matter. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "oracle.h"
#include "oracle_check.h"
#include "oracle_light.h"
#include "render/plan/method.h"
#include "render/raycast/cpu/light_grid.h"
#include "render/raycast/shared/lighting.h"

static struct small_scene shadowed_waves(int nx, int ny, int nz, enum gz_voxel_type type)
{
	struct small_scene scene = small_scene_waves(nx, ny, nz, type);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.light.shadow_steps = 5;
	scene.rays.light.direction[0] = -0.8;
	return scene;
}

static void shadows_of_every_voxel_type_equal_the_oracle(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct small_scene scene = shadowed_waves(30, 33, 27, (enum gz_voxel_type)type);
		oracle_check(&scene, 31, 27);
	}
}

static void shadows_without_surfaces_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(30, 33, 27, GZ_VOXEL_U8);
	scene.rays.shading = GZ_SHADING_NONE;
	scene.rays.light.ambient = 0;
	oracle_check(&scene, 31, 27);
}

static void shadows_of_any_number_of_steps_equal_the_oracle(void **state)
{
	(void)state;
	/* from steps that all read voxels to one that reads the coarsest cells */
	static const int steps[] = { 1, 2, 8, 64 };
	for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
		struct small_scene scene = shadowed_waves(34, 30, 27, GZ_VOXEL_U16);
		scene.rays.light.shadow_steps = steps[i];
		scene.rays.light.occlusion = i == 2 ? 0.7 : 0;
		scene.rays.light.shadow_reach = i == 2 ? 12 : 256;
		oracle_check(&scene, 23, 21);
	}
}

static void shadows_by_a_light_along_an_axis_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(24, 20, 27, GZ_VOXEL_U8);
	scene.rays.light.frame = GZ_LIGHT_WORLD;
	memcpy(scene.rays.light.direction, (double[3]) { 0, 0, 2 }, 3 * sizeof(double));
	oracle_check(&scene, 31, 27);
}

static void shadows_with_clip_and_jitter_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(24, 24, 24, GZ_VOXEL_U8);
	memcpy(scene.rays.clip.least, (double[3]) { 0.2, 0.1, 0.2 }, 3 * sizeof(double));
	memcpy(scene.rays.clip.greatest, (double[3]) { 0.8, 0.9, 0.7 }, 3 * sizeof(double));
	scene.rays.jitter = 3;
	oracle_check(&scene, 31, 27);
}

/* With the light before the plane, behind it and along it. */
static void shadows_with_a_clip_plane_equal_the_oracle(void **state)
{
	(void)state;
	static const double normals[][3] = { { -0.4, 0.6, 1 }, { 0.4, -0.6, -1 }, { 0.9, 0.6, 0 } };
	for (size_t i = 0; i < sizeof normals / sizeof normals[0]; i++) {
		struct small_scene scene = shadowed_waves(24, 24, 24, GZ_VOXEL_U8);
		scene.rays.clip.plane = true;
		memcpy(scene.rays.clip.normal, normals[i], sizeof normals[i]);
		scene.rays.clip.offset = 0.55;
		scene.rays.light.frame = GZ_LIGHT_WORLD;
		memcpy(scene.rays.light.direction, (double[3]) { -0.4, 0.6, 1 },
		       3 * sizeof(double));
		oracle_check(&scene, 31, 27);
	}
}

static void shadows_of_anisotropic_and_flat_volumes_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(32, 30, 8, GZ_VOXEL_U8);
	scene.volume.spacing[2] = 3;
	oracle_check(&scene, 31, 27);
	static const int dims[][3] = { { 1, 1, 1 }, { 1, 1, 40 }, { 40, 1, 1 }, { 1, 40, 40 } };
	for (size_t i = 0; i < sizeof dims / sizeof dims[0]; i++) {
		struct small_scene flat =
			shadowed_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		flat.transfer.points[0].opacity = 0.2;
		oracle_check(&flat, 23, 21);
	}
}

static void shadows_of_segments_colours_and_nearest_voxels_equal_the_oracle(void **state)
{
	(void)state;
	struct small_scene segments = shadowed_waves(30, 33, 27, GZ_VOXEL_F32);
	segments.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	oracle_check(&segments, 23, 21);
	struct small_scene nearest = shadowed_waves(20, 23, 17, GZ_VOXEL_U8);
	nearest.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	oracle_check_but(&nearest, 23, 21, 8); /* a sample on a voxel's face goes either way */
	small_scene_free(&nearest);
	struct small_scene coloured = small_scene_coloured(20, 23, 17, GZ_COLOUR_ALPHA);
	coloured.rays.light.shadow_steps = 4;
	oracle_check(&coloured, 23, 21);
}

/* Bodies far apart in empty space, where the grid has cells that nobody looks up. */
static void shadows_of_bodies_far_apart_equal_the_oracle(void **state)
{
	(void)state;
	enum { EDGE = 44, BODY = 9 };
	struct small_scene scene = shadowed_waves(EDGE, EDGE, EDGE, GZ_VOXEL_U8);
	uint8_t *voxels = scene.volume.voxels;
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const int at[3] = { i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE };
		bool first = true, second = true;
		for (int axis = 0; axis < 3; axis++) {
			first = first && at[axis] >= 1 && at[axis] < 1 + BODY;
			second = second && at[axis] >= EDGE - BODY && at[axis] < EDGE;
		}
		voxels[i] = first || second ? 100 + voxels[i] / 2 : 0;
	}
	gz_volume_find_range(&scene.volume);
	scene.transfer.points[1].opacity = 0.3;
	scene.rays.light.frame = GZ_LIGHT_WORLD;
	memcpy(scene.rays.light.direction, (double[3]) { 1, 1, 1 }, 3 * sizeof(double));
	scene.rays.light.ambient = 0.1;
	oracle_check(&scene, 23, 21);
}

static void grid_of_a_large_volume_has_longer_cells(void **state)
{
	(void)state;
	const struct gz_shadow_cells shadows = {
		.count = 3,
		.level = { { { 300, 300, 100 }, { 2, 2, 1 }, 0 },
			   { { 150, 150, 100 }, { 4, 4, 1 }, 0 },
			   { { 75, 75, 50 }, { 8, 8, 2 }, 0 } },
	};
	struct gz_light_grid grid = { 0 };
	assert_int_equal(gz_light_grid_lay_out(&shadows, &grid), 150 * 150 * 100);
	assert_int_equal(grid.dims[2], 100);
	assert_int_equal(grid.edge[0], 4);
	assert_int_equal(grid.edge[2], 1);
}

static void walk_through_more_voxels_than_kernels_count_is_refused(void **state)
{
	(void)state;
	const struct gz_volume volume = { .dims = { 2048, 2048, 513 }, .type = GZ_VOXEL_U8 };
	const struct gz_lighting lighting = { .volume = &volume };
	const struct gz_ray_params rays = gz_ray_params_default();
	const struct gz_ray_frame frame = { 0 };
	struct gz_light_walk walk;
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_light_walk_make(&lighting, gz_cast_portable.arriving, &rays, &frame,
					    &log.log, &walk),
			 GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(log.last, "2048 x 2048 x 513"));
	assert_non_null(strstr(log.last, "light.shadow_steps"));
}

static void render_shadows(const struct small_scene *scene, int side, struct gz_image *image)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, NULL);
	small_scene_render(renderer, scene, side, side, image, NULL);
	gz_raycaster_destroy(&renderer);
}

/* Mean difference, in grey levels, to a picture with light followed in small steps. */
static double error_of_steps(struct small_scene *scene, int steps)
{
	enum { SIDE = 24 };
	struct gz_image image = { 0 };
	const struct oracle_occlusion exact = { .exact_shadows = true };
	double sum = 0;
	scene->rays.light.shadow_steps = steps;
	render_shadows(scene, SIDE, &image);
	scene->rays.light.shadow_steps = 1; /* for the oracle: on */
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			double rgb[3];
			oracle_pixel_occluded(&scene->volume, &scene->transfer, &scene->camera,
					      &scene->rays, &exact, SIDE, SIDE, x, y, rgb);
			for (int channel = 0; channel < 3; channel++)
				sum += fabs(image.pixels[4 * (y * SIDE + x) + channel] -
					    255 * rgb[channel]);
		}
	gz_image_free(&image);
	return sum / (SIDE * SIDE * 3);
}

static void more_steps_come_closer_to_light_followed_in_small_steps(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(30, 33, 27, GZ_VOXEL_U8);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.ray_sampling_rate = 0.5;
	scene.rays.light.ambient = 0;
	const double off = error_of_steps(&scene, 0), few = error_of_steps(&scene, 3);
	const double eight = error_of_steps(&scene, 8), many = error_of_steps(&scene, 64);
	printf("mean error of 0, 3, 8 and 64 steps: %.3f %.3f %.3f %.3f grey levels\n", off, few,
	       eight, many);
	/* what is left is the grid's: it spans a fifteenth of the volume */
	assert_true(many < 0.7 && eight < 0.7);
	assert_true(eight < few && few < 1 && off > 5);
	small_scene_free(&scene);
}

/* Seen along the light, matter that keeps back s of the light per voxel length has the colour
 *
 *   c * integral over depth d of s e^(-s d) (ambient + (1 - ambient) e^(-s max(d - 3, 0)))
 */
static void even_matter_is_as_dark_as_the_formula_says(void **state)
{
	(void)state;
	enum { EDGE = 40, SIDE = 16 };
	const double opacity = 0.05, ambient = 0.2;
	struct small_scene scene = small_scene_constant(EDGE, opacity);
	struct gz_image image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	scene.camera.height = 0.5;
	memcpy(scene.camera.eye, (double[3]) { 0, -2, 0 }, 3 * sizeof(double));
	memcpy(scene.rays.light.direction, (double[3]) { 0, 0, 1 }, 3 * sizeof(double));
	scene.rays.light.ambient = ambient;
	scene.rays.ray_sampling_rate = 2;
	const double s = -log(1 - opacity), first = exp(-s * 3);
	const double shaded = 1 - first + (first - exp(-s * (2 * EDGE - 3))) / 2;
	const double all = 1 - exp(-s * EDGE);
	const double expected = ambient * all + (1 - ambient) * shaded;
	/* Even matter is the same to any number of steps. */
	for (int steps = 1; steps <= 16; steps *= 4) {
		scene.rays.light.shadow_steps = steps;
		render_shadows(&scene, SIDE, &image);
		const uint8_t *pixel = image.pixels + 4 * (SIDE / 2 * SIDE + SIDE / 2);
		const double colour[3] = { 0.9, 0.6, 0.3 };
		for (int channel = 0; channel < 3; channel++)
			if (fabs(pixel[channel] - 255 * colour[channel] * expected) > 1.5)
				fail_msg("%d steps: %d, not %.2f", steps, pixel[channel],
					 255 * colour[channel] * expected);
	}
	gz_image_free(&image);
	small_scene_free(&scene);
}

static void shadows_are_the_same_bits_for_any_number_of_threads_and_any_tile(void **state)
{
	(void)state;
	enum { SIDE = 96 };
	struct small_scene scene = shadowed_waves(50, 41, 60, GZ_VOXEL_U8);
	struct gz_raycaster *one = small_scene_renderer(&scene, 1, NULL);
	struct gz_raycaster *five = small_scene_renderer(&scene, 5, NULL);
	struct gz_image full = { 0 }, other = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(one, &scene, SIDE, SIDE, &full, NULL);
	small_scene_render(five, &scene, SIDE, SIDE, &other, NULL);
	assert_memory_equal(full.pixels, other.pixels, (size_t)SIDE * SIDE * 4);
	scene.foveation.method = GZ_METHOD_UNIFORM;
	scene.foveation.uniform_spacing = 3;
	small_scene_render(one, &scene, SIDE, SIDE, &other, NULL);
	for (int y = 0; y < SIDE; y += 3)
		for (int x = 0; x < SIDE; x += 3)
			assert_memory_equal(full.pixels + 4 * (y * SIDE + x),
					    other.pixels + 4 * (y * SIDE + x), 4);
	gz_image_free(&full);
	gz_image_free(&other);
	gz_raycaster_destroy(&one);
	gz_raycaster_destroy(&five);
	small_scene_free(&scene);
}

static void shadows_follow_a_new_transfer_function_and_clip_box(void **state)
{
	(void)state;
	enum { SIDE = 32 };
	struct small_scene scene = shadowed_waves(30, 33, 27, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image changed = { 0 }, fresh = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, SIDE, SIDE, &changed, NULL);
	scene.transfer.points[2].opacity = 0.9;
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_OK);
	small_scene_render(renderer, &scene, SIDE, SIDE, &changed, NULL);
	render_shadows(&scene, SIDE, &fresh);
	assert_memory_equal(changed.pixels, fresh.pixels, (size_t)SIDE * SIDE * 4);
	scene.rays.clip.greatest[2] = 0.6;
	small_scene_render(renderer, &scene, SIDE, SIDE, &changed, NULL);
	render_shadows(&scene, SIDE, &fresh);
	assert_memory_equal(changed.pixels, fresh.pixels, (size_t)SIDE * SIDE * 4);
	gz_image_free(&changed);
	gz_image_free(&fresh);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

/* How many pixels of a picture change when shadows change, drawn by one ray caster, of which none
 * may differ from those of a new one. */
static int count_changed(struct gz_raycaster *renderer, const struct small_scene *scene,
			 struct gz_image *image)
{
	enum { SIDE = 32 };
	struct gz_image before = *image, fresh = { 0 };
	int changed = 0;
	*image = (struct gz_image) { 0 };
	small_scene_render(renderer, scene, SIDE, SIDE, image, NULL);
	render_shadows(scene, SIDE, &fresh);
	assert_memory_equal(image->pixels, fresh.pixels, (size_t)SIDE * SIDE * 4);
	for (int i = 0; before.pixels && i < SIDE * SIDE; i++)
		changed += memcmp(before.pixels + 4 * i, image->pixels + 4 * i, 4) != 0;
	gz_image_free(&before);
	gz_image_free(&fresh);
	return changed;
}

static void shadows_follow_the_light_its_steps_and_their_reach(void **state)
{
	(void)state;
	struct small_scene scene = shadowed_waves(30, 33, 27, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.rays.shading = GZ_SHADING_NONE;
	(void)count_changed(renderer, &scene, &image);
	assert_int_equal(count_changed(renderer, &scene, &image), 0);
	scene.rays.light.direction[0] = 0.6;
	assert_true(count_changed(renderer, &scene, &image) > 100);
	scene.rays.light.shadow_steps = 2;
	assert_true(count_changed(renderer, &scene, &image) > 100);
	scene.rays.light.shadow_reach = 6;
	assert_true(count_changed(renderer, &scene, &image) > 100);
	scene.camera.eye[0] += 0.7; /* and the light turns with the camera */
	assert_true(count_changed(renderer, &scene, &image) > 100);
	scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	assert_true(count_changed(renderer, &scene, &image) > 100);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void shadows_beyond_their_range_are_refused(void **state)
{
	(void)state;
	struct gz_ray_params rays = gz_ray_params_default();
	rays.light.shadow_steps = GZ_SHADOW_STEPS_MAX + 1;
	assert_false(gz_ray_params_valid(&rays));
	rays = gz_ray_params_default();
	rays.light.shadow_reach = 3;
	assert_false(gz_ray_params_valid(&rays));
	rays.light.shadow_reach = NAN;
	assert_false(gz_ray_params_valid(&rays));
}

TEST_SUITE(shadows)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shadows_of_every_voxel_type_equal_the_oracle),
		cmocka_unit_test(shadows_without_surfaces_equal_the_oracle),
		cmocka_unit_test(shadows_of_any_number_of_steps_equal_the_oracle),
		cmocka_unit_test(shadows_by_a_light_along_an_axis_equal_the_oracle),
		cmocka_unit_test(shadows_with_clip_and_jitter_equal_the_oracle),
		cmocka_unit_test(shadows_with_a_clip_plane_equal_the_oracle),
		cmocka_unit_test(shadows_of_anisotropic_and_flat_volumes_equal_the_oracle),
		cmocka_unit_test(shadows_of_segments_colours_and_nearest_voxels_equal_the_oracle),
		cmocka_unit_test(more_steps_come_closer_to_light_followed_in_small_steps),
		cmocka_unit_test(even_matter_is_as_dark_as_the_formula_says),
		cmocka_unit_test(shadows_are_the_same_bits_for_any_number_of_threads_and_any_tile),
		cmocka_unit_test(shadows_follow_a_new_transfer_function_and_clip_box),
		cmocka_unit_test(shadows_of_bodies_far_apart_equal_the_oracle),
		cmocka_unit_test(grid_of_a_large_volume_has_longer_cells),
		cmocka_unit_test(walk_through_more_voxels_than_kernels_count_is_refused),
		cmocka_unit_test(shadows_follow_the_light_its_steps_and_their_reach),
		cmocka_unit_test(shadows_beyond_their_range_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
