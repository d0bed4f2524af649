/* Values of a volume that fade in and out: light is blended, and pictures do not depend on what was
 * shown before. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "render/raycast/cpu/faded_light.h"
#include "small_scene.h"

enum { SIDE = 96 };

static struct small_scene lit_scene(void)
{
	struct small_scene scene = small_scene_waves(40, 32, 24, GZ_VOXEL_U8);
	scene.rays.shading = GZ_SHADING_GRADIENT;
	scene.rays.light.occlusion = 0.9;
	scene.rays.light.occlusion_radius = 6;
	scene.rays.light.shadow_steps = 6;
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	return scene;
}

static void emphasise(struct small_scene *scene, double share, double least, double greatest)
{
	scene->transfer.emphasis = (struct gz_transfer_emphasis) { share, least, greatest };
}

/* A picture of the scene by a renderer that has shown something else is that of a new one. */
static void check_as_new(struct gz_raycaster *renderer, const struct small_scene *scene)
{
	struct gz_raycaster *fresh = small_scene_renderer(scene, 2, NULL);
	struct gz_image of_old = { 0 }, of_new = { 0 };
	int x, y;
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	small_scene_render(renderer, scene, SIDE, SIDE, &of_old, NULL);
	small_scene_render(fresh, scene, SIDE, SIDE, &of_new, NULL);
	if (image_difference(&of_old, &of_new, &x, &y) > 0)
		fail_msg("share %g of %g to %g: pixel %d, %d differs from that of a new renderer",
			 scene->transfer.emphasis.share, scene->transfer.emphasis.least,
			 scene->transfer.emphasis.greatest, x, y);
	gz_image_free(&of_old);
	gz_image_free(&of_new);
	gz_raycaster_destroy(&fresh);
}

static void pictures_of_a_fade_do_not_depend_on_what_was_before(void **state)
{
	static const double fades[][3] = {
		{ 0.3, 0.5, 0.7 }, { 0.8, 0.5, 0.7 }, { 1, 0.5, 0.7 },
		{ 0.6, 0.5, 0.7 }, { 0, 0, 0 },       { 0.6, 0.8, 1 },
		{ 1, 0.8, 1 },     { 1, 0.5, 0.7 },   { 0.4, 0.8, 1 },
	};
	(void)state;
	struct small_scene scene = lit_scene();
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	check_as_new(renderer, &scene);
	for (size_t i = 0; i < sizeof fades / sizeof fades[0]; i++) {
		emphasise(&scene, fades[i][0], fades[i][1], fades[i][2]);
		check_as_new(renderer, &scene);
	}
	/* While it fades, the light and the function change. */
	scene.rays.light.occlusion_radius = 8;
	check_as_new(renderer, &scene);
	scene.rays.light.direction[0] += 0.5;
	check_as_new(renderer, &scene);
	scene.transfer.points[2].opacity = 0.2;
	check_as_new(renderer, &scene);
	/* A range so narrow that the table becomes finer. */
	emphasise(&scene, 0.4, 0.6, 0.6001);
	check_as_new(renderer, &scene);
	emphasise(&scene, 0, 0, 0);
	check_as_new(renderer, &scene);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void another_volume_has_light_of_its_own(void **state)
{
	(void)state;
	struct small_scene scene = lit_scene();
	struct small_scene other = small_scene_waves(24, 40, 32, GZ_VOXEL_U8);
	other.rays = scene.rays;
	emphasise(&scene, 0.5, 0.5, 0.7);
	emphasise(&other, 0.5, 0.5, 0.7);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	check_as_new(renderer, &scene);
	assert_int_equal(gz_raycaster_set_volume(renderer, &other.volume), GZ_OK);
	check_as_new(renderer, &other);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
	small_scene_free(&other);
}

/* Take the occlusion of a share. */
static const struct gz_occlusion *occlusion_of(struct gz_faded_light *light,
					       struct small_scene *scene, double share,
					       struct gz_transfer_table *table)
{
	emphasise(scene, share, 0.5, 0.7);
	gz_transfer_table_bake(&scene->transfer, &scene->volume, table);
	(void)gz_faded_light_set_transfer(light, &scene->transfer);
	assert_int_equal(
		gz_faded_light_prepare(light, &scene->volume, table, &scene->rays, NULL, NULL),
		GZ_OK);
	return &light->shown.lighting.occlusion;
}

static uint16_t *copy_cells(const struct gz_occlusion *occlusion, size_t count)
{
	uint16_t *cells = malloc(count * sizeof *cells);
	assert_non_null(cells);
	memcpy(cells, occlusion->cells, count * sizeof *cells);
	return cells;
}

static void occlusion_fades_in_a_straight_line_between_exact_ends(void **state)
{
	(void)state;
	struct small_scene scene = lit_scene();
	struct gz_faded_light light = { 0 };
	struct gz_transfer_table *table = calloc(1, sizeof *table);
	struct gz_occlusion exact = { 0 };
	assert_non_null(table);
	const struct gz_occlusion *at = occlusion_of(&light, &scene, 0, table);
	const size_t count = (size_t)at->dims[0] * (size_t)at->dims[1] * (size_t)at->dims[2];
	uint16_t *plain = copy_cells(at, count);
	at = occlusion_of(&light, &scene, 0.25, table);
	uint16_t *blended = copy_cells(at, count);
	at = occlusion_of(&light, &scene, 1, table);
	assert_int_equal(gz_occlusion_make(&scene.volume, table, scene.rays.light.occlusion_radius,
					   &scene.rays.clip, NULL, &exact),
			 GZ_OK);
	assert_memory_equal(at->cells, exact.cells, count * sizeof *exact.cells);
	int changed = 0;
	for (size_t i = 0; i < count; i++) {
		assert_float_equal(blended[i], 0.75 * plain[i] + 0.25 * at->cells[i], 0.5 + 1e-9);
		changed += at->cells[i] != plain[i];
	}
	assert_true(changed > (int)count / 4);
	free(plain);
	free(blended);
	free(table);
	gz_occlusion_free(&exact);
	gz_faded_light_free(&light);
	small_scene_free(&scene);
}

static void further_frames_of_a_fade_make_no_grid_anew(void **state)
{
	(void)state;
	struct small_scene scene = lit_scene();
	struct gz_faded_light light = { 0 };
	struct gz_transfer_table *table = calloc(1, sizeof *table);
	assert_non_null(table);
	(void)occlusion_of(&light, &scene, 0, table);
	(void)occlusion_of(&light, &scene, 0.25, table);
	const uint64_t plain = light.ends[0].lighting.serial;
	const uint64_t raised = light.ends[1].lighting.serial;
	for (int i = 0; i < 6; i++) {
		const uint64_t before = light.shown.lighting.serial;
		(void)occlusion_of(&light, &scene, 0.3 + 0.1 * i, table);
		assert_true(light.shown.lighting.serial > before);
		assert_int_equal(light.ends[0].lighting.serial, plain);
		assert_int_equal(light.ends[1].lighting.serial, raised);
	}
	free(table);
	gz_faded_light_free(&light);
	small_scene_free(&scene);
}

TEST_SUITE(faded_light)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pictures_of_a_fade_do_not_depend_on_what_was_before),
		cmocka_unit_test(another_volume_has_light_of_its_own),
		cmocka_unit_test(occlusion_fades_in_a_straight_line_between_exact_ends),
		cmocka_unit_test(further_frames_of_a_fade_make_no_grid_anew),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
