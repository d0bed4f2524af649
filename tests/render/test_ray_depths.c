/* Depths in the fourth byte of pixels: how far away what a ray shows is. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "render/plan/method.h"
#include "small_scene.h"

enum { WIDTH = 96, HEIGHT = 64 };

/* A frame, told depths or not. */
static void draw(struct gz_raycaster *renderer, const struct small_scene *scene,
		 const struct gz_ray_depths *depths, const struct gz_ray_hits *hits,
		 struct gz_image *image)
{
	struct gz_plan plan = { 0 };
	struct gz_plan_request request = gz_plan_request_make(&scene->foveation, &scene->display,
							      scene->gaze, WIDTH, HEIGHT);
	assert_int_equal(gz_plan_update(&request, &plan), GZ_OK);
	struct gz_ray_hits own = { 0 };
	if (hits) { /* the same for each ray */
		assert_int_equal(gz_ray_hits_clear(&own, &plan), GZ_OK);
		for (size_t i = 0; i < plan.tile_count * GZ_HITS_A_TILE; i++) {
			own.depth[i] = hits->depth[0];
			own.pixels[i] = hits->pixels[0];
		}
	}
	const struct gz_shot shot = { .camera = &scene->camera,
				      .settings = &scene->rays,
				      .plan = &plan,
				      .depths = depths,
				      .hits = hits ? &own : NULL };
	assert_int_equal(gz_raycaster_draw(renderer, &shot, image, NULL), GZ_OK);
	gz_ray_hits_free(&own);
	gz_plan_free(&plan);
}

static struct small_scene box_scene(double opacity)
{
	struct small_scene scene = small_scene_constant(32, opacity);
	scene.display = gz_display_default(WIDTH, HEIGHT);
	scene.foveation.method = GZ_METHOD_STANDARD;
	scene.camera.eye[0] = 0;
	scene.camera.eye[1] = -2;
	scene.camera.eye[2] = 0;
	return scene;
}

static int depth_byte(const struct gz_image *image, int x, int y)
{
	return image->pixels[4 * (y * WIDTH + x) + 3];
}

/* The byte of a depth. */
static double expected_byte(const struct gz_ray_depths *depths, double depth)
{
	return 255 * (depth - depths->nearest) / (depths->farthest - depths->nearest);
}

/* For each set of instructions. */
static void for_each_set(void (*check)(const char *simd))
{
	for (const char *const *simd = small_scene_simd_sets(); *simd; simd++)
		check(*simd);
}

/* The box's near face is half an edge before its centre, which is two edges away. Nine tenths of
 * the light stay in the first voxel length, so the mean is about a tenth of one behind the face. */
static void check_face(const char *simd)
{
	struct small_scene scene = box_scene(0.98);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, simd);
	struct gz_image image = { 0 };
	for (int flat = 0; flat < 2; flat++) {
		scene.camera.projection =
			flat ? GZ_PROJECTION_ORTHOGRAPHIC : GZ_PROJECTION_PERSPECTIVE;
		const struct gz_ray_depths depths = gz_camera_ray_depths(&scene.camera);
		draw(renderer, &scene, &depths, NULL, &image);
		const double face = expected_byte(&depths, 1.5);
		const int byte = depth_byte(&image, WIDTH / 2, HEIGHT / 2);
		if (!(byte >= face - 0.5 && byte <= face + 3))
			fail_msg("%s: %d, %.2f at the face", simd, byte, face);
		assert_int_equal(depth_byte(&image, 0, 0), 128); /* beside the box */
	}
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void depth_of_a_face_is_where_it_lies(void **state)
{
	(void)state;
	for_each_set(check_face);
}

/* A fog that holds back little light alike everywhere is seen in its middle. */
static void check_fog(const char *simd)
{
	struct small_scene scene = box_scene(0.001);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, simd);
	struct gz_image image = { 0 };
	const struct gz_ray_depths depths = gz_camera_ray_depths(&scene.camera);
	for (int segments = 0; segments < 2; segments++) {
		scene.rays.integration =
			segments ? GZ_INTEGRATION_PREINTEGRATED : GZ_INTEGRATION_SAMPLED;
		draw(renderer, &scene, &depths, NULL, &image);
		const double middle = expected_byte(&depths, 2);
		const int byte = depth_byte(&image, WIDTH / 2, HEIGHT / 2);
		if (fabs(byte - middle) > 2)
			fail_msg("%s: %d, %.2f in the middle", simd, byte, middle);
	}
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void depth_of_a_fog_is_its_middle(void **state)
{
	(void)state;
	for_each_set(check_fog);
}

/* What the rays end at counts with the light that reaches it. */
static void check_hits(const char *simd)
{
	struct small_scene scene = box_scene(0.001);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, simd);
	struct gz_image image = { 0 };
	const struct gz_ray_depths depths = gz_camera_ray_depths(&scene.camera);
	float depth = 2.25F;
	uint32_t pixel = 0xFF204060;
	const struct gz_ray_hits hits = { &depth, &pixel, 1 };
	draw(renderer, &scene, &depths, &hits, &image);
	const double met = expected_byte(&depths, 2.25);
	for (int corner = 0; corner < 2; corner++) {
		const int byte = corner ? depth_byte(&image, 0, 0)
					: depth_byte(&image, WIDTH / 2, HEIGHT / 2);
		if (fabs(byte - met) > 3)
			fail_msg("%s: %d, %.2f", simd, byte, met);
	}
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void depth_of_what_rays_end_at_counts(void **state)
{
	(void)state;
	for_each_set(check_hits);
}

static void check_colours(const char *simd)
{
	struct small_scene scene = small_scene_waves(40, 44, 36, GZ_VOXEL_U8);
	scene.display = gz_display_default(WIDTH, HEIGHT);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, simd);
	struct gz_image told = { 0 }, alone = { 0 };
	const struct gz_ray_depths depths = gz_camera_ray_depths(&scene.camera);
	static const int methods[] = { GZ_METHOD_STANDARD, GZ_METHOD_ACUITY, GZ_METHOD_MDC };
	scene.foveation.acuity_slope = 0.15;
	scene.foveation.mdc_square_px = 30;
	for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
		int most = 0, spread = 0;
		scene.foveation.method = methods[i];
		draw(renderer, &scene, &depths, NULL, &told);
		draw(renderer, &scene, NULL, NULL, &alone);
		for (int k = 0; k < WIDTH * HEIGHT; k++) {
			for (int c = 0; c < 3; c++)
				most = (int)fmax(most, abs(told.pixels[4 * k + c] -
							   alone.pixels[4 * k + c]));
			assert_int_equal(alone.pixels[4 * k + 3], 255);
			spread = (int)fmax(spread, abs(told.pixels[4 * k + 3] - 128));
		}
		if (most > 0 || spread < 20)
			fail_msg("%s, %s: colours differ by %d, depths by %d", simd,
				 gz_method_names[methods[i]], most, spread);
	}
	gz_image_free(&told);
	gz_image_free(&alone);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void colours_do_not_depend_on_whether_depths_are_told(void **state)
{
	(void)state;
	for_each_set(check_colours);
}

/* Between rays depths are interpolated as colours are: a face that is not level has those of every
 * pixel. */
static void check_between(const char *simd)
{
	struct small_scene scene = box_scene(0.98);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, simd);
	struct gz_image full = { 0 }, foveated = { 0 };
	gz_camera_turn(&scene.camera, 35);
	scene.camera.fov_deg = 10; /* the edge between two faces is in the middle */
	gz_camera_turn(&scene.camera, 5);
	const struct gz_ray_depths depths = gz_camera_ray_depths(&scene.camera);
	draw(renderer, &scene, &depths, NULL, &full);
	scene.foveation.method = GZ_METHOD_ACUITY;
	scene.foveation.acuity_slope = 0.15;
	scene.foveation.step_rule = GZ_STEP_NONE;
	draw(renderer, &scene, &depths, NULL, &foveated);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			if (abs(depth_byte(&full, x, y) - depth_byte(&foveated, x, y)) > 3)
				fail_msg("%s: pixel %d %d: %d and %d", simd, x, y,
					 depth_byte(&full, x, y), depth_byte(&foveated, x, y));
	gz_image_free(&full);
	gz_image_free(&foveated);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void depths_are_interpolated_between_rays(void **state)
{
	(void)state;
	for_each_set(check_between);
}

TEST_SUITE(ray_depths)
{
	if (!small_scene_backend_runs())
		return 77;
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(depth_of_a_face_is_where_it_lies),
		cmocka_unit_test(depth_of_a_fog_is_its_middle),
		cmocka_unit_test(depth_of_what_rays_end_at_counts),
		cmocka_unit_test(colours_do_not_depend_on_whether_depths_are_told),
		cmocka_unit_test(depths_are_interpolated_between_rays),
	};
	return cmocka_run_group_tests_name("ray_depths", tests, NULL, NULL);
}
