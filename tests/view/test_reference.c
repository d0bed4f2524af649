/* The standard picture made beside the frames: the same as a frame's, and only of what was asked
 * for last. */
#include "suite.h"

#include <semaphore.h>
#include <string.h>

#include "render/frame/picture_maker.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "render/small_scene.h"
#include "view/frame/reference.h"

enum { WIDTH = 70, HEIGHT = 75 }; /* strips of which the last is lower */

struct bench {
	struct small_scene scene;
	struct gz_reference_worker *worker;
	sem_t finished;
	struct gz_image image;
};

static void finish(void *user)
{
	struct bench *bench = user;
	sem_post(&bench->finished);
}

static void start_with(struct bench *bench, const struct gz_technique *technique)
{
	memset(bench, 0, sizeof *bench);
	bench->scene = small_scene_waves(24, 20, 28, GZ_VOXEL_U8);
	bench->scene.foveation.method = GZ_METHOD_STANDARD;
	bench->scene.display = gz_display_default(WIDTH, HEIGHT);
	assert_int_equal(sem_init(&bench->finished, 0, 0), 0);
	const struct gz_object object = {
		.technique = technique,
		.id = 1,
		.volume = &bench->scene.volume,
	};
	const struct gz_reference_source source = {
		.objects = &object,
		.object_count = 1,
		.threads = 2,
		.finished = finish,
		.user = bench,
	};
	assert_int_equal(gz_reference_worker_start(&source, &bench->scene.transfer, &bench->worker),
			 GZ_OK);
}

static void start(struct bench *bench)
{
	start_with(bench, gz_techniques[0]);
}

static void stop(struct bench *bench)
{
	gz_reference_worker_stop(&bench->worker);
	assert_null(bench->worker);
	gz_image_free(&bench->image);
	small_scene_free(&bench->scene);
	sem_destroy(&bench->finished);
}

static void ask(struct bench *bench, double rate)
{
	struct gz_reference_view view;
	memset(&view, 0, sizeof view);
	memcpy(&view.camera, &bench->scene.camera, sizeof view.camera);
	memcpy(&view.rays, &bench->scene.rays, sizeof view.rays);
	view.image_sampling_rate = rate;
	view.width = WIDTH;
	view.height = HEIGHT;
	gz_reference_worker_ask(bench->worker, &view);
}

/* What was asked for last, however many were given up before. */
static void take(struct bench *bench)
{
	double share;
	do {
		assert_int_equal(sem_wait(&bench->finished), 0);
	} while (gz_reference_worker_busy(bench->worker, &share));
	assert_true(share == 1);
	assert_true(gz_reference_worker_take(bench->worker, &bench->image));
	assert_false(gz_reference_worker_take(bench->worker, &bench->image));
}

static void expect_frame(const struct bench *bench, double rate)
{
	struct gz_raycaster *renderer;
	struct gz_image cast = { 0 }, picture = { 0 };
	struct small_scene scene = bench->scene;
	const struct gz_backend_params params = { .threads = 1 };
	const int width = (int)(WIDTH * rate), height = (int)(HEIGHT * rate);
	int x, y;
	assert_int_equal(gz_raycaster_create("cpu", &params, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene.volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene.transfer), GZ_OK);
	small_scene_render(renderer, &scene, width, height, &cast, NULL);
	assert_int_equal(gz_image_resize(&picture, WIDTH, HEIGHT), GZ_OK);
	if (rate == 1)
		memcpy(picture.pixels, cast.pixels, 4 * (size_t)WIDTH * HEIGHT);
	else
		gz_image_resample(&cast, &picture);
	const int apart = image_difference(&picture, &bench->image, &x, &y);
	if (apart != 0)
		fail_msg("rate %g: %d levels apart at %d %d", rate, apart, x, y);
	gz_raycaster_destroy(&renderer);
	gz_image_free(&cast);
	gz_image_free(&picture);
}

static void strips_equal_one_frame_bit_for_bit(void **state)
{
	(void)state;
	struct bench bench;
	start(&bench);
	ask(&bench, 1);
	take(&bench);
	assert_int_equal(bench.image.width, WIDTH);
	assert_int_equal(bench.image.height, HEIGHT);
	expect_frame(&bench, 1);
	ask(&bench, 2);
	take(&bench);
	expect_frame(&bench, 2);
	bench.scene.rays.jitter = 7;
	bench.scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	ask(&bench, 1);
	take(&bench);
	expect_frame(&bench, 1);
	stop(&bench);
}

static void newest_request_wins(void **state)
{
	(void)state;
	struct bench bench;
	start(&bench);
	for (int i = 0; i < 20; i++) {
		gz_camera_turn(&bench.scene.camera, 5);
		ask(&bench, 1);
	}
	take(&bench);
	expect_frame(&bench, 1);
	stop(&bench);
}

static void equal_request_is_not_rendered_again(void **state)
{
	(void)state;
	struct bench bench;
	double share;
	start(&bench);
	assert_false(gz_reference_worker_busy(bench.worker, &share));
	ask(&bench, 1);
	assert_true(gz_reference_worker_busy(bench.worker, &share) || share == 1);
	take(&bench);
	ask(&bench, 1);
	gz_reference_worker_set_transfer(bench.worker, &bench.scene.transfer);
	assert_false(gz_reference_worker_busy(bench.worker, &share));
	assert_false(gz_reference_worker_take(bench.worker, &bench.image));
	stop(&bench);
}

static void new_transfer_function_renders_again(void **state)
{
	(void)state;
	struct bench bench;
	start(&bench);
	ask(&bench, 1);
	take(&bench);
	bench.scene.transfer.points[0].rgb[0] = 1 - bench.scene.transfer.points[0].rgb[0];
	bench.scene.transfer.points[1].opacity /= 2;
	gz_reference_worker_set_transfer(bench.worker, &bench.scene.transfer);
	take(&bench);
	expect_frame(&bench, 1);
	stop(&bench);
}

static void worker_can_stop_at_any_time(void **state)
{
	(void)state;
	struct bench bench;
	for (int i = 0; i < 8; i++) {
		start(&bench);
		if (i % 2)
			ask(&bench, 1);
		stop(&bench);
	}
	struct gz_reference_worker *none = NULL;
	gz_reference_worker_stop(&none);
	gz_reference_worker_stop(NULL);
}

static const struct gz_technique *named_technique(const char *name)
{
	size_t i = 0;
	while (strcmp(gz_techniques[i]->name, name) != 0)
		i++;
	return gz_techniques[i];
}

/* Tones of an illustration are equalised over all of its pixels. */
static void illustration_is_made_whole(void **state)
{
	(void)state;
	struct bench bench;
	struct gz_picture_maker *maker;
	struct gz_image *whole;
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	const struct gz_technique *illustrate = named_technique("illustrate");
	int x, y;
	if (illustrate->check("cpu", NULL, NULL) != GZ_OK)
		skip();
	start_with(&bench, illustrate);
	bench.scene.rays.surface.isovalue = 0.5;
	ask(&bench, 1);
	take(&bench);
	const struct gz_object object = { .technique = illustrate,
					  .id = 1,
					  .volume = &bench.scene.volume,
					  .transfer = &bench.scene.transfer };
	const struct gz_picture_request request = {
		.camera = &bench.scene.camera,
		.settings = &bench.scene.rays,
		.foveation = &full,
		.display = &bench.scene.display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = WIDTH,
		.height = HEIGHT,
	};
	assert_int_equal(gz_picture_maker_create(&params, NULL, &maker), GZ_OK);
	assert_int_equal(gz_picture_maker_show(maker, &object, 1), GZ_OK);
	assert_int_equal(gz_picture_make(maker, &request, &whole, NULL), GZ_OK);
	assert_int_equal(image_difference(whole, &bench.image, &x, &y), 0);
	gz_picture_maker_destroy(&maker);
	stop(&bench);
}

TEST_SUITE(reference)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(strips_equal_one_frame_bit_for_bit),
		cmocka_unit_test(newest_request_wins),
		cmocka_unit_test(equal_request_is_not_rendered_again),
		cmocka_unit_test(new_transfer_function_renders_again),
		cmocka_unit_test(worker_can_stop_at_any_time),
		cmocka_unit_test(illustration_is_made_whole),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
