/*
 * Pictures of a procedural scene by every method, against those in this folder: what changes a
 * picture on purpose changes them too. GAZECAST_UPDATE_GOLDEN=1 writes them anew; look at them
 * before they are committed.
 */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <stdio.h>
#include <stdlib.h>

#include "render/plan/method.h"
#include "render/raycast/shared/raycaster.h"
#include "render/scene/scene.h"

/* Kernels of different instruction sets may differ by one grey level; between lattice points, means
 * of such values do so too. */
enum { WIDTH = 320, HEIGHT = 240, TOLERANCE = 2 };

static void render(const struct gz_scene *scene, int method, struct gz_image *image)
{
	struct gz_foveation foveation = scene->settings.foveation;
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct gz_raycaster *renderer = NULL;
	struct gz_plan plan = { 0 };
	foveation.method = method;
	/* the regions of mdc and ddc are meant for a whole screen */
	foveation.mdc_square_px = 60;
	foveation.mdc3_square_px = 150;
	foveation.blend_px = method == GZ_METHOD_MDC3 ? 12 : 0;
	foveation.table = (struct gz_spacing_table) {
		.count = 3,
		.rows = { { 0, 1, 1 }, { 6, 1.5, 1 }, { 20, 9, 3 } },
	};
	foveation.ddc_inner_px[0] = 40;
	foveation.ddc_inner_px[1] = 30;
	foveation.ddc_middle_px[0] = 90;
	foveation.ddc_middle_px[1] = 70;
	foveation.acuity_slope = 0.2; /* as if the eye were worse, so that every rung is taken */
	struct gz_plan_request request = gz_plan_request_make(
		&foveation, &display, (struct gz_point) { 0.4F, 0.55F }, WIDTH, HEIGHT);
	request.refines = true;
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	assert_int_equal(gz_raycaster_create("cpu", NULL, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	const struct gz_shot shot = { .camera = &scene->settings.camera,
				      .settings = &scene->settings.rays,
				      .plan = &plan,
				      .refined = &plan };
	assert_int_equal(gz_raycaster_draw(renderer, &shot, image, NULL), GZ_OK);
	gz_raycaster_destroy(&renderer);
	gz_plan_free(&plan);
}

static void compare(const struct gz_image *image, const char *path)
{
	struct gz_image golden = { 0 };
	assert_int_equal(gz_image_read_png(path, NULL, &golden), GZ_OK);
	assert_int_equal(golden.width, image->width);
	assert_int_equal(golden.height, image->height);
	for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
		if (abs(image->pixels[i] - golden.pixels[i]) > TOLERANCE)
			fail_msg("%s: pixel %d %d is %d, was %d", path, i / 4 % WIDTH,
				 i / 4 / WIDTH, image->pixels[i], golden.pixels[i]);
	gz_image_free(&golden);
}

static void check(const struct gz_scene *scene, int method, const char *name,
		  const struct gz_log *log)
{
	struct gz_image image = { 0 };
	char path[1024];
	snprintf(path, sizeof path, "%s/%s.png", GOLDEN_FOLDER, name);
	render(scene, method, &image);
	if (getenv("GAZECAST_UPDATE_GOLDEN"))
		assert_int_equal(gz_image_write_png(&image, path, log), GZ_OK);
	compare(&image, path);
	gz_image_free(&image);
}

static void picture_in_the_light_and_cut_open_stays_what_it_was(void **state)
{
	(void)state;
	struct gz_log log;
	struct gz_scene scene;
	gz_log_init(&log, NULL, NULL, NULL);
	assert_int_equal(gz_scene_load(SCENE, NULL, &log, &scene), GZ_OK);
	struct gz_ray_params *rays = &scene.settings.rays;
	rays->shading = GZ_SHADING_GRADIENT;
	rays->light.occlusion = 0.8;
	rays->integration = GZ_INTEGRATION_PREINTEGRATED;
	rays->clip.greatest[0] = 0.6;
	/* the outer shells as walls */
	for (size_t i = 0; i < scene.transfer.count; i++)
		if (scene.transfer.points[i].value > 0.4 && scene.transfer.points[i].opacity > 0)
			scene.transfer.points[i].opacity = 0.9;
	check(&scene, GZ_METHOD_STANDARD, "light", &log);
	gz_scene_free(&scene);
}

static void pictures_of_every_method_stay_what_they_were(void **state)
{
	(void)state;
	struct gz_log log;
	struct gz_scene scene;
	gz_log_init(&log, NULL, NULL, NULL);
	assert_int_equal(gz_scene_load(SCENE, NULL, &log, &scene), GZ_OK);
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		check(&scene, method, gz_method_names[method], &log);
	gz_scene_free(&scene);
}

TEST_SUITE(pictures)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pictures_of_every_method_stay_what_they_were),
		cmocka_unit_test(picture_in_the_light_and_cut_open_stays_what_it_was),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
