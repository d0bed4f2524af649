/* The gl backend and volumes that the device does not hold whole: files of bricks, and volumes in
 * memory beyond its textures or its memory. What they show is what the cpu shows of the volume in
 * memory. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/data/brick_pool.h"
#include "render/data/format.h"
#include "render/plan/method.h"
#include "render/raycast/shared/raycaster.h"
#include "small_scene.h"
#include "volume_files.h"

enum { WIDTH = 160, HEIGHT = 120 };

/* Bytes of a brick of 8-bit voxels. */
#define BRICK_BYTES ((size_t)GZ_BRICK_VOXELS)

static struct gz_raycaster *renderer_of(const char *backend, const struct small_scene *scene,
					struct raycaster_params params, const struct gz_log *log)
{
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(raycaster_with(backend, &params, log, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	return renderer;
}

static struct gz_frame_stats render(const char *backend, const struct small_scene *scene,
				    struct raycaster_params params, struct gz_image *image)
{
	struct gz_frame_stats stats;
	struct gz_raycaster *renderer = renderer_of(backend, scene, params, NULL);
	small_scene_render(renderer, scene, WIDTH, HEIGHT, image, &stats);
	gz_raycaster_destroy(&renderer);
	return stats;
}

static long total_difference(const struct gz_image *a, const struct gz_image *b)
{
	long sum = 0;
	for (int i = 0; i < a->width * a->height * 4; i++)
		sum += labs((long)a->pixels[i] - b->pixels[i]);
	return sum;
}

/* The same scene with its volume as a file of bricks; the volume in memory stays the caller's. */
static struct small_scene as_bricks(const struct small_scene *scene, size_t brick_bytes)
{
	struct small_scene bricks = *scene;
	const char *path = files_path("scene.gzb");
	const struct gz_loading loading = { .brick_bytes = brick_bytes };
	assert_int_equal(gz_bricks_write(&scene->volume, path, NULL, NULL), GZ_OK);
	assert_int_equal(gz_volume_load(path, NULL, &loading, NULL, &bricks.volume), GZ_OK);
	return bricks;
}

/* The cpu's picture of the volume in memory, and gl's of @p other with the same settings. */
static void check_same(const struct small_scene *memory, const struct gz_volume *other,
		       struct raycaster_params params, const char *what)
{
	struct gz_image a = { 0 }, b = { 0 };
	struct small_scene shown = *memory;
	shown.volume = *other;
	params.backend.wait_for_bricks = true;
	render("cpu", memory, (struct raycaster_params) { 0 }, &a);
	const struct gz_frame_stats stats = render("gl", &shown, params, &b);
	assert_int_equal(stats.bricks_coming, 0);
	const int apart = image_pixels_apart(&a, &b);
	if (apart * 1000 > WIDTH * HEIGHT)
		fail_msg("%s: %d of %d pixels differ", what, apart, WIDTH * HEIGHT);
	gz_image_free(&a);
	gz_image_free(&b);
}

static void files_of_bricks_look_like_the_volume_in_memory(void **state)
{
	(void)state;
	static const struct {
		int dims[3];
		enum gz_voxel_type type;
		int interpolation;
	} cases[] = {
		{ { 70, 65, 50 }, GZ_VOXEL_U8, GZ_INTERPOLATION_TRILINEAR },
		{ { 64, 64, 64 }, GZ_VOXEL_U16, GZ_INTERPOLATION_TRILINEAR },
		{ { 33, 40, 97 }, GZ_VOXEL_F32, GZ_INTERPOLATION_TRILINEAR },
		{ { 70, 65, 50 }, GZ_VOXEL_U8, GZ_INTERPOLATION_NEAREST },
		{ { 70, 65, 50 }, GZ_VOXEL_U16, GZ_INTERPOLATION_NEAREST },
		{ { 40, 33, 70 }, GZ_VOXEL_F32, GZ_INTERPOLATION_NEAREST },
		{ { 50, 1, 40 }, GZ_VOXEL_U8, GZ_INTERPOLATION_TRILINEAR },
		{ { 1, 1, 1 }, GZ_VOXEL_U16, GZ_INTERPOLATION_TRILINEAR },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const int *d = cases[i].dims;
		struct small_scene scene = small_scene_waves(d[0], d[1], d[2], cases[i].type);
		scene.rays.interpolation = cases[i].interpolation;
		struct small_scene bricks = as_bricks(&scene, 0);
		const struct raycaster_params params = { 0 };
		check_same(&scene, &bricks.volume, params, "perspective");
		scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
		check_same(&scene, &bricks.volume, params, "orthographic");
		small_scene_free(&bricks);
		small_scene_free(&scene);
	}
}

static void volumes_beyond_the_textures_look_the_same(void **state)
{
	(void)state;
	/* Textures of 139 have 64 rooms; the bricks of all levels are 27. */
	const struct raycaster_params params = { .hooks.volume_edge_max = 139 };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int nearest = 0; nearest < 2; nearest++) {
			struct small_scene scene = small_scene_waves(140, 40, 35, type);
			scene.rays.interpolation =
				nearest ? GZ_INTERPOLATION_NEAREST : GZ_INTERPOLATION_TRILINEAR;
			check_same(&scene, &scene.volume, params, "beyond");
			small_scene_free(&scene);
		}
}

/* So long that its coarsest level is several bricks. */
static void every_brick_of_the_coarsest_level_is_looked_into(void **state)
{
	(void)state;
	const struct raycaster_params params = { .hooks.volume_edge_max = 1088 };
	struct small_scene scene = small_scene_waves(8192, 65, 65, GZ_VOXEL_U8);
	for (int axis = 0; axis < 3; axis++)
		scene.camera.eye[axis] = scene.camera.look_at[axis] = axis == 0 ? 0.4 : 0;
	scene.camera.eye[1] = -0.02;
	check_same(&scene, &scene.volume, params, "long");
	small_scene_free(&scene);
}

static void anisotropic_volumes_beyond_the_textures_look_the_same(void **state)
{
	(void)state;
	const struct raycaster_params params = { .hooks.volume_edge_max = 139 };
	struct small_scene scene = small_scene_waves(140, 60, 20, GZ_VOXEL_U16);
	scene.volume.spacing[2] = 5;
	scene.rays.levels = true;
	scene.foveation.method = GZ_METHOD_ACUITY;
	check_same(&scene, &scene.volume, params, "anisotropic");
	small_scene_free(&scene);
}

static void every_way_of_casting_works_by_bricks(void **state)
{
	(void)state;
	const struct raycaster_params beyond = { .hooks.volume_edge_max = 139 };
	struct small_scene scene = small_scene_waves(140, 40, 35, GZ_VOXEL_U16);
	struct small_scene bricks = as_bricks(&scene, 0);
	const struct gz_ray_params plain = scene.rays;
	for (int variant = 0; variant < 5; variant++) {
		scene.rays = plain;
		scene.rays.clip.least[0] = 0.2;
		scene.rays.clip.greatest[2] = 0.7;
		scene.rays.jitter = variant == 1 ? 7 : 0;
		scene.rays.shading = variant >= 2 ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
		scene.rays.light.occlusion = variant == 4 ? 0.6 : 0;
		scene.rays.integration =
			variant % 2 ? GZ_INTEGRATION_PREINTEGRATED : GZ_INTEGRATION_SAMPLED;
		check_same(&scene, &scene.volume, beyond, "beyond");
		if (variant < 4)
			check_same(&scene, &bricks.volume, (struct raycaster_params) { 0 },
				   "bricks");
	}
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void hidden_matter_is_as_bare_as_in_the_volume_in_memory(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_ball_in_hidden_matter();
	struct small_scene bricks = as_bricks(&scene, 0);
	check_same(&scene, &bricks.volume, (struct raycaster_params) { 0 }, "hidden matter");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* Whether a backend refuses the rays of a scene with a line that names a key. */
static void check_refused(const char *backend, const struct small_scene *scene, const char *key)
{
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_raycaster *renderer =
		renderer_of(backend, scene, (struct raycaster_params) { 0 }, &log.log);
	struct gz_plan plan = { 0 };
	struct gz_image image = { 0 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	assert_int_equal(
		gz_plan_make(&scene->foveation, &display, scene->gaze, WIDTH, HEIGHT, &plan),
		GZ_OK);
	assert_int_equal(
		gz_raycaster_render(renderer, &scene->camera, &scene->rays, &plan, &image, NULL),
		GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(log.last, key));
	gz_raycaster_destroy(&renderer);
	gz_plan_free(&plan);
	gz_image_free(&image);
}

static void occlusion_and_shadows_of_a_file_of_bricks_are_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 40, 40, GZ_VOXEL_U8);
	struct small_scene bricks = as_bricks(&scene, 0);
	bricks.rays.shading = GZ_SHADING_GRADIENT;
	bricks.rays.light.occlusion = 0.5;
	check_refused("gl", &bricks, "light.occlusion");
	check_refused("cpu", &bricks, "light.occlusion");
	bricks.rays.light.occlusion = 0;
	bricks.rays.light.shadow_steps = 8;
	check_refused("gl", &bricks, "light.shadow_steps");
	check_refused("cpu", &bricks, "light.shadow_steps");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* The volume is in memory, where the processor makes the grid of shadows. */
static void shadows_of_volumes_beyond_the_textures_look_the_same(void **state)
{
	(void)state;
	const struct raycaster_params beyond = { .hooks.volume_edge_max = 139 };
	struct small_scene scene = small_scene_waves(140, 40, 35, GZ_VOXEL_U8);
	scene.rays.light.shadow_steps = 8;
	scene.rays.levels = true;
	scene.foveation.method = GZ_METHOD_ACUITY;
	check_same(&scene, &scene.volume, beyond, "shadows by levels");
	small_scene_free(&scene);
}

static void levels_of_detail_are_those_of_the_cpu(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(150, 40, 43, GZ_VOXEL_U16);
	scene.rays.levels = true;
	scene.foveation.method = GZ_METHOD_ACUITY;
	scene.rays.ray_sampling_rate = 0.5;
	struct small_scene bricks = as_bricks(&scene, 0);
	const struct raycaster_params none = { 0 }, beyond = { .hooks.volume_edge_max = 149 };
	check_same(&scene, &bricks.volume, none, "acuity");
	check_same(&scene, &scene.volume, beyond, "acuity");
	/* From afar all rays take a coarse level. */
	for (int axis = 0; axis < 3; axis++)
		scene.camera.eye[axis] *= 4;
	check_same(&scene, &bricks.volume, none, "far");
	check_same(&scene, &scene.volume, beyond, "far");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

static void eye_inside_sees_the_same(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(100, 90, 80, GZ_VOXEL_U8);
	scene.camera.eye[0] = 0.1;
	scene.camera.eye[1] = 0.2;
	scene.camera.eye[2] = 0.05;
	scene.camera.fov_deg = 100;
	struct small_scene bricks = as_bricks(&scene, 0);
	check_same(&scene, &bricks.volume, (struct raycaster_params) { 0 }, "inside");
	small_scene_free(&bricks);
	small_scene_free(&scene);
}

/* Nothing like the picture of an empty box. */
static void check_whole(const struct gz_image *whole, const struct gz_image *image)
{
	struct gz_image none = { 0 };
	assert_int_equal(gz_image_resize(&none, WIDTH, HEIGHT), GZ_OK);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		memcpy(none.pixels + 4 * i, "\0\0\0\377", 4);
	const long empty = total_difference(whole, &none), off = total_difference(whole, image);
	if (4 * off > empty)
		fail_msg("the picture differs by %ld, an empty one by %ld", off, empty);
	gz_image_free(&none);
}

/* Make pictures until the next one lacks nothing; the last is to be @p resident, bit for bit. */
static void check_streamed(const struct small_scene *scene, struct raycaster_params params,
			   const struct gz_image *whole, const struct gz_image *resident)
{
	struct gz_image image = { 0 };
	struct gz_frame_stats stats = { 0 };
	struct gz_raycaster *renderer = renderer_of("gl", scene, params, NULL);
	small_scene_render(renderer, scene, WIDTH, HEIGHT, &image, &stats);
	assert_true(stats.bricks_coming > 0);
	assert_true(total_difference(whole, &image) > 0);
	check_whole(whole, &image);
	for (int frame = 0; stats.bricks_coming > 0; frame++) {
		assert_true(frame < 100000);
		small_scene_render(renderer, scene, WIDTH, HEIGHT, &image, &stats);
	}
	small_scene_render(renderer, scene, WIDTH, HEIGHT, &image, &stats);
	assert_int_equal(stats.bricks_coming, 0);
	assert_int_equal(total_difference(resident, &image), 0);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
}

static void streamed_picture_is_whole_at_once_and_ends_as_the_one_waited_for(void **state)
{
	(void)state;
	/* 34 MiB of bricks, more than half of which show something: one picture brings 16. */
	struct small_scene scene = small_scene_waves(230, 224, 128, GZ_VOXEL_F32);
	struct small_scene bricks = as_bricks(&scene, 0);
	const struct raycaster_params wait = { .hooks.volume_edge_max = 320,
					       .backend.wait_for_bricks = true };
	struct gz_image whole = { 0 }, resident = { 0 };
	render("cpu", &scene, (struct raycaster_params) { 0 }, &whole);
	render("gl", &bricks, wait, &resident);
	assert_true(image_pixels_apart(&whole, &resident) * 1000 <= WIDTH * HEIGHT);
	struct raycaster_params params = { .hooks.volume_edge_max = 320 };
	check_streamed(&bricks, params, &whole, &resident);
	small_scene_free(&bricks);
	/* The same volume from memory: cut by the same levels into the same bricks. 6³ rooms hold
	 * all that shows something. */
	params.hooks.volume_edge_max = 229;
	check_streamed(&scene, params, &whole, &resident);
	gz_image_free(&whole);
	gz_image_free(&resident);
	small_scene_free(&scene);
}

static void few_rooms_hold_what_weighs_most_and_the_picture_stays_whole(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(160, 160, 160, GZ_VOXEL_U8);
	scene.gaze = (struct gz_point) { 0.3F, 0.4F };
	struct gz_image whole = { 0 }, image = { 0 }, again = { 0 };
	render("cpu", &scene, (struct raycaster_params) { 0 }, &whole);
	for (size_t rooms = 1; rooms <= 64; rooms *= 4) {
		const struct raycaster_params params = { .backend.gl_memory_bytes =
								 rooms * BRICK_BYTES,
							 .backend.wait_for_bricks = true };
		struct gz_frame_stats stats;
		struct gz_raycaster *renderer = renderer_of("gl", &scene, params, NULL);
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, &stats);
		assert_int_equal(stats.bricks_coming, 0);
		/* With one room that is a brick of 5 voxels a side, of which little can be asked.
		 */
		if (rooms > 1)
			check_whole(&whole, &image);
		assert_true(total_difference(&whole, &image) > 0);
		/* Looked at again, rooms are not taken from each other in turns. */
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &again, &stats);
		assert_int_equal(total_difference(&again, &image), 0);
		gz_raycaster_destroy(&renderer);
	}
	long near = 0, far = 0, near_pixels = 0, far_pixels = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		const double off = hypot(i % WIDTH - 0.3 * WIDTH, i / WIDTH - 0.4 * HEIGHT);
		long difference = 0;
		for (int channel = 0; channel < 3; channel++)
			difference += labs((long)whole.pixels[4 * i + channel] -
					   image.pixels[4 * i + channel]);
		*(off < 12 ? &near : &far) += difference;
		*(off < 12 ? &near_pixels : &far_pixels) += 1;
	}
	print_message("a pixel near the gaze differs by %.3f, far from it by %.3f\n",
		      (double)near / (double)near_pixels, (double)far / (double)far_pixels);
	assert_true(near * far_pixels <= far * near_pixels);
	gz_image_free(&whole);
	gz_image_free(&image);
	gz_image_free(&again);
	small_scene_free(&scene);
}

static void rooms_go_to_what_is_looked_at_now(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(160, 160, 160, GZ_VOXEL_U8);
	const struct raycaster_params params = { .backend.gl_memory_bytes = 100 * BRICK_BYTES,
						 .backend.wait_for_bricks = true };
	struct gz_raycaster *renderer = renderer_of("gl", &scene, params, NULL);
	/* A close look at one corner, then at others: each needs less than there is room for. */
	scene.camera.fov_deg = 10;
	for (int corner = 0; corner < 8; corner++) {
		struct gz_image whole = { 0 }, image = { 0 };
		for (int axis = 0; axis < 3; axis++) {
			const double side = corner >> axis & 1 ? 1 : -1;
			scene.camera.look_at[axis] = 0.3 * side;
			scene.camera.eye[axis] = 0.62 * side;
		}
		render("cpu", &scene, (struct raycaster_params) { 0 }, &whole);
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
		const int apart = image_pixels_apart(&whole, &image);
		if (apart * 1000 > WIDTH * HEIGHT)
			fail_msg("corner %d: %d pixels differ", corner, apart);
		gz_image_free(&whole);
		gz_image_free(&image);
	}
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void new_transfer_function_shows_other_bricks(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(140, 40, 35, GZ_VOXEL_U8);
	const struct raycaster_params params = { .hooks.volume_edge_max = 139,
						 .backend.wait_for_bricks = true };
	struct gz_image a = { 0 }, b = { 0 };
	struct gz_raycaster *renderer = renderer_of("gl", &scene, params, NULL);
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &b, NULL);
	scene.transfer.points[0].opacity = 0.01;
	scene.transfer.points[1].opacity = 0.5;
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_OK);
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &b, NULL);
	render("cpu", &scene, params, &a);
	assert_true(image_pixels_apart(&a, &b) * 1000 <= WIDTH * HEIGHT);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&a);
	gz_image_free(&b);
	small_scene_free(&scene);
}

static void without_room_for_packed_voxels_they_have_their_own_size(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_F32; type++)
		for (int nearest = 0; nearest < 2; nearest++) {
			struct small_scene scene = small_scene_waves(50, 41, 60, type);
			const size_t voxels = gz_volume_voxel_count(&scene.volume);
			const struct raycaster_params params = {
				.backend.gl_memory_bytes = voxels * gz_voxel_size(type),
			};
			struct captured_log log;
			captured_log_init(&log, NULL);
			struct gz_raycaster *renderer = renderer_of("gl", &scene, params, &log.log);
			assert_int_equal(log.messages, 0); /* which would tell of bricks */
			gz_raycaster_destroy(&renderer);
			scene.rays.interpolation =
				nearest ? GZ_INTERPOLATION_NEAREST : GZ_INTERPOLATION_TRILINEAR;
			check_same(&scene, &scene.volume, params, "own size");
			scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
			check_same(&scene, &scene.volume, params, "own size, pre-integrated");
			small_scene_free(&scene);
		}
}

static void device_without_room_for_a_brick_is_refused_and_takes_what_fits_after(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(60, 50, 40, GZ_VOXEL_F32);
	struct small_scene small = small_scene_waves(8, 8, 8, GZ_VOXEL_U8);
	const struct raycaster_params params = { .backend.gl_memory_bytes = 2048 };
	struct captured_log log;
	struct gz_raycaster *renderer = NULL;
	captured_log_init(&log, NULL);
	assert_int_equal(raycaster_with("gl", &params, &log.log, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene.volume), GZ_ERR_NO_MEM);
	assert_int_equal(log.messages, 1);
	if (!strstr(log.last, "no room") || !strstr(log.last, "--backend cpu"))
		fail_msg("'%s' names neither reason nor remedy", log.last);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_ERR_INVAL);
	assert_int_equal(gz_raycaster_set_volume(renderer, &small.volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &small.transfer), GZ_OK);
	struct gz_image image = { 0 };
	small_scene_render(renderer, &small, WIDTH, HEIGHT, &image, NULL);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&image);
	small_scene_free(&scene);
	small_scene_free(&small);
}

TEST_SUITE(gl_bricks)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(files_of_bricks_look_like_the_volume_in_memory),
		cmocka_unit_test(volumes_beyond_the_textures_look_the_same),
		cmocka_unit_test(every_brick_of_the_coarsest_level_is_looked_into),
		cmocka_unit_test(anisotropic_volumes_beyond_the_textures_look_the_same),
		cmocka_unit_test(every_way_of_casting_works_by_bricks),
		cmocka_unit_test(hidden_matter_is_as_bare_as_in_the_volume_in_memory),
		cmocka_unit_test(occlusion_and_shadows_of_a_file_of_bricks_are_refused),
		cmocka_unit_test(shadows_of_volumes_beyond_the_textures_look_the_same),
		cmocka_unit_test(levels_of_detail_are_those_of_the_cpu),
		cmocka_unit_test(eye_inside_sees_the_same),
		cmocka_unit_test(streamed_picture_is_whole_at_once_and_ends_as_the_one_waited_for),
		cmocka_unit_test(few_rooms_hold_what_weighs_most_and_the_picture_stays_whole),
		cmocka_unit_test(rooms_go_to_what_is_looked_at_now),
		cmocka_unit_test(new_transfer_function_shows_other_bricks),
		cmocka_unit_test(without_room_for_packed_voxels_they_have_their_own_size),
		cmocka_unit_test(
			device_without_room_for_a_brick_is_refused_and_takes_what_fits_after),
	};
	setenv("GZ_TEST_BACKEND", "gl", 1);
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
