/* Accumulation over frames: what it converges to, and when its history is dropped. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/accumulate/temporal.h"
#include "render/plan/method.h"
#include "small_scene.h"

enum { WIDTH = 230, HEIGHT = 150 };

/* A scene with accumulation, and the same scene without. */
struct bench {
	struct small_scene scene;
	struct gz_raycaster *renderer;
	struct gz_temporal temporal;
	struct gz_temporal_params params;
	struct gz_temporal_content content;
	struct gz_plan plan;
	struct gz_image kept, alone, full;
	bool flat; /* pixels tell no depths */
};

static void begin(struct bench *bench)
{
	memset(bench, 0, sizeof *bench);
	bench->scene = small_scene_waves(40, 44, 36, GZ_VOXEL_U8);
	bench->scene.display = gz_display_default(WIDTH, HEIGHT);
	/* Small pixels and an eye that loses acuity fast, so that a small picture has all spacings.
	 */
	bench->scene.display.mm[0] = 0.1 * WIDTH;
	bench->scene.display.mm[1] = 0.1 * HEIGHT;
	bench->scene.display.distance_mm = 300;
	bench->scene.foveation.acuity_slope = 0.15;
	bench->scene.foveation.acuity_full_deg = 0; /* the fovea is as wide as the picture */
	bench->scene.foveation.edge_contrast = 1;   /* keep_frame() has one round */
	bench->scene.gaze = (struct gz_point) { 0.4F, 0.45F };
	bench->scene.foveation.method = GZ_METHOD_ACUITY;
	bench->scene.foveation.step_rule = GZ_STEP_NONE;
	bench->renderer = small_scene_renderer(&bench->scene, 2, NULL);
	bench->params = gz_temporal_default();
	bench->params.accumulate = true;
}

static void end(struct bench *bench)
{
	gz_temporal_free(&bench->temporal);
	gz_plan_free(&bench->plan);
	gz_image_free(&bench->kept);
	gz_image_free(&bench->alone);
	gz_image_free(&bench->full);
	gz_raycaster_destroy(&bench->renderer);
	small_scene_free(&bench->scene);
}

static void keep_frame(struct bench *bench)
{
	const struct small_scene *scene = &bench->scene;
	bench->content.camera = scene->camera;
	struct gz_display display = scene->display;
	struct gz_plan_request request = gz_plan_request_make(&scene->foveation, &scene->display,
							      scene->gaze, WIDTH, HEIGHT);
	assert_int_equal(gz_temporal_begin(&bench->temporal, &bench->content, &request, &display),
			 GZ_OK);
	assert_int_equal(gz_plan_update(&request, &bench->plan), GZ_OK);
	gz_temporal_place(&bench->temporal, &bench->plan);
	const struct gz_ray_depths depths = gz_camera_ray_depths(&scene->camera);
	const struct gz_shot shot = { .camera = &scene->camera,
				      .settings = &scene->rays,
				      .plan = &bench->plan,
				      .depths = bench->flat ? NULL : &depths };
	bench->content.deep = !bench->flat;
	assert_int_equal(
		gz_raycaster_draw(bench->renderer, &shot, &bench->temporal.frame_image, NULL),
		GZ_OK);
	assert_int_equal(gz_temporal_end(&bench->temporal, &bench->params, &bench->content,
					 &bench->plan, &bench->kept),
			 GZ_OK);
	assert_int_equal(bench->kept.width, WIDTH);
	assert_int_equal(bench->kept.height, HEIGHT);
}

static void render_full(struct bench *bench)
{
	struct small_scene full = bench->scene;
	full.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(bench->renderer, &full, WIDTH, HEIGHT, &bench->full, NULL);
}

/* Root of the mean squared difference, grey levels. */
static double error(const struct gz_image *a, const struct gz_image *b)
{
	double sum = 0;
	for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
		sum += (a->pixels[i] - b->pixels[i]) * (a->pixels[i] - b->pixels[i]);
	return sqrt(sum / (3 * WIDTH * HEIGHT));
}

static void check_still_picture(int method)
{
	struct bench bench;
	begin(&bench);
	bench.scene.foveation.method = method;
	bench.scene.foveation.ddc_inner_px[0] = bench.scene.foveation.ddc_inner_px[1] = 30;
	bench.scene.foveation.ddc_middle_px[0] = bench.scene.foveation.ddc_middle_px[1] = 60;
	bench.scene.foveation.mdc_square_px = 50;
	render_full(&bench);
	double last = INFINITY, first = 0;
	/* On gl rays of a shifted lattice are rounded otherwise, by a level here and there. */
	const double rounding = strcmp(small_scene_backend(), "gl") == 0 ? 0.02 : 0;
	for (int frame = 0; frame < GZ_TEMPORAL_SHIFTS * GZ_TEMPORAL_SHIFTS; frame++) {
		keep_frame(&bench);
		const double now = error(&bench.kept, &bench.full);
		first = frame == 0 ? now : first;
		if (frame % 32 == 0) {
			if (now > last + rounding)
				fail_msg("frame %d: error %.4f, before %.4f", frame, now, last);
			last = now;
		}
	}
	int x, y;
	const int most = image_difference(&bench.kept, &bench.full, &x, &y);
	if (first < 0.1 || most > (rounding > 0))
		fail_msg("%s: first error %.3f; at the end pixel %d %d differs by %d",
			 gz_method_names[method], first, x, y, most);
	assert_false(gz_temporal_settling(&bench.temporal));
	end(&bench);
}

static void still_picture_converges_to_standard(void **state)
{
	(void)state;
	check_still_picture(GZ_METHOD_ACUITY);
}

static void still_picture_of_regions_converges_to_standard_beside_their_borders(void **state)
{
	(void)state;
	check_still_picture(GZ_METHOD_DDC);
	check_still_picture(GZ_METHOD_MDC);
}

static void fovea_is_that_of_standard_in_every_frame(void **state)
{
	(void)state;
	struct bench bench;
	begin(&bench);
	for (int frame = 0; frame < 12; frame++) {
		if (frame >= 6)
			gz_camera_turn(&bench.scene.camera, 1);
		render_full(&bench);
		keep_frame(&bench);
		const int centre_x = (int)(0.4 * WIDTH), centre_y = (int)(0.45 * HEIGHT);
		for (int y = centre_y - 4; y < centre_y + 4; y++)
			assert_memory_equal(bench.kept.pixels + 4 * (y * WIDTH + centre_x - 4),
					    bench.full.pixels + 4 * (y * WIDTH + centre_x - 4),
					    4 * 8);
	}
	end(&bench);
}

/* What may change between two frames that share nothing. */
static void change(struct bench *bench, int what)
{
	struct small_scene *scene = &bench->scene;
	switch (what) {
	case 0:
		scene->rays.background[0] = 0.5;
		break;
	case 1:
		scene->rays.clip.least[0] = 0.5;
		break;
	case 2:
		scene->rays.interpolation = GZ_INTERPOLATION_NEAREST;
		break;
	case 3:
		scene->foveation.filter = GZ_FILTER_BILINEAR;
		break;
	case 4:
		scene->foveation.method = GZ_METHOD_MDC;
		break;
	default: /* volume or transfer function */
		break;
	}
	bench->content.serial++;
}

static void any_change_drops_the_history(void **state)
{
	(void)state;
	for (int what = 0; what < 6; what++) {
		struct bench bench, fresh;
		begin(&bench);
		begin(&fresh);
		for (int frame = 0; frame < 5; frame++)
			keep_frame(&bench);
		change(&bench, what);
		change(&fresh, what);
		for (int frame = 0; frame < 3; frame++) {
			keep_frame(&bench);
			keep_frame(&fresh);
			int x, y;
			const int most = image_difference(&bench.kept, &fresh.kept, &x, &y);
			if (most != 0)
				fail_msg("change %d, frame %d: pixel %d %d differs by %d", what,
					 frame, x, y, most);
		}
		end(&bench);
		end(&fresh);
	}
}

/* Scenes of turns: a cloud, in which many depths are seen at once, and a surface in light that
 * moves with the camera. */
enum turned { TURNED_CLOUD, TURNED_SURFACE, TURNED_COUNT };

static void begin_turn(struct bench *bench, enum turned turned)
{
	begin(bench);
	if (turned == TURNED_CLOUD)
		return;
	struct small_scene *scene = &bench->scene;
	scene->transfer.points[1].opacity = 0;
	scene->transfer.points[2].opacity = scene->transfer.points[3].opacity = 0.98;
	scene->rays.shading = GZ_SHADING_GRADIENT;
	assert_int_equal(gz_raycaster_set_transfer(bench->renderer, &scene->transfer), GZ_OK);
}

/* The last frame without what was kept. */
static void frame_by_itself(const struct bench *bench, struct gz_image *image)
{
	const struct gz_image *frame = &bench->temporal.frame_image;
	assert_int_equal(gz_image_resize(image, WIDTH, HEIGHT), GZ_OK);
	for (int y = 0; y < HEIGHT; y++) {
		const uint8_t *row =
			frame->pixels + 4 * ((y + bench->temporal.shift[1]) * frame->width +
					     bench->temporal.shift[0]);
		memcpy(image->pixels + 4 * y * WIDTH, row, 4 * WIDTH);
		for (int x = 0; x < WIDTH; x++)
			image->pixels[4 * (y * WIDTH + x) + 3] = 255;
	}
}

/* Errors with and without what earlier frames saw while the camera turns. */
struct turn_errors {
	double kept, alone; /* means over the frames; alone: without accumulation */
	double worst;       /* of a frame: with, as a share of the same frame without */
};

static struct turn_errors turn(enum turned turned, double deg)
{
	enum { FRAMES = 20 };
	struct bench bench;
	struct turn_errors errors = { 0 };
	begin_turn(&bench, turned);
	for (int frame = 0; frame < FRAMES; frame++) {
		gz_camera_turn(&bench.scene.camera, deg);
		keep_frame(&bench);
		render_full(&bench);
		const double kept = error(&bench.kept, &bench.full);
		errors.kept += kept / FRAMES;
		frame_by_itself(&bench, &bench.alone);
		errors.worst = fmax(errors.worst, kept / error(&bench.alone, &bench.full));
		small_scene_render(bench.renderer, &bench.scene, WIDTH, HEIGHT, &bench.alone, NULL);
		errors.alone += error(&bench.alone, &bench.full) / FRAMES;
	}
	end(&bench);
	return errors;
}

static void earlier_frames_never_hurt_while_the_camera_turns(void **state)
{
	(void)state;
	/* By speed: the share of the mean error that may be left, and how many times as much error
	 * as by itself a frame may have. At 5 degrees a frame, a quarter of a turn in .3 s, a frame
	 * has what it is compared with by chance now and then. */
	static const struct {
		double deg, share, most;
	} cases[] = {
		{ 0.01, 0.95, 1.001 }, { 0.1, 0.95, 1.001 }, { 0.3, 0.95, 1.001 },
		{ 1, 0.98, 1.01 },     { 5, 1.02, 1.1 },
	};
	for (int turned = 0; turned < TURNED_COUNT; turned++)
		for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
			const struct turn_errors errors = turn(turned, cases[i].deg);
			if (errors.kept >= cases[i].share * errors.alone ||
			    errors.worst > cases[i].most)
				fail_msg("scene %d, %g degrees a frame: error %.4f with, %.4f "
					 "without, in one frame %.3f times as much",
					 turned, cases[i].deg, errors.kept, errors.alone,
					 errors.worst);
		}
}

/* Without depths nobody knows where to look in earlier frames. */
static void frames_stand_alone_without_depths_while_the_camera_turns(void **state)
{
	(void)state;
	struct bench bench;
	begin(&bench);
	bench.flat = true;
	for (int frame = 0; frame < 4; frame++) {
		gz_camera_turn(&bench.scene.camera, 0.1);
		keep_frame(&bench);
		int x, y;
		frame_by_itself(&bench, &bench.alone);
		assert_int_equal(image_difference(&bench.kept, &bench.alone, &x, &y), 0);
	}
	end(&bench);
}

static void jump_of_the_camera_leaves_no_ghost(void **state)
{
	(void)state;
	struct bench bench;
	begin(&bench);
	for (int frame = 0; frame < 5; frame++)
		keep_frame(&bench);
	gz_camera_turn(&bench.scene.camera, 70);
	render_full(&bench);
	small_scene_render(bench.renderer, &bench.scene, WIDTH, HEIGHT, &bench.alone, NULL);
	for (int frame = 0; frame < 4; frame++) {
		keep_frame(&bench);
		const double kept = error(&bench.kept, &bench.full);
		const double alone = error(&bench.alone, &bench.full);
		if (kept > 1.1 * alone)
			fail_msg("frame %d: error %.3f, %.3f without", frame, kept, alone);
	}
	end(&bench);
}

static void picture_too_large_to_be_shifted_is_refused(void **state)
{
	(void)state;
	struct bench bench;
	begin(&bench);
	struct gz_display display = bench.scene.display;
	struct gz_plan_request request =
		gz_plan_request_make(&bench.scene.foveation, &bench.scene.display, bench.scene.gaze,
				     GZ_IMAGE_SIDE_MAX, 10);
	assert_int_equal(gz_temporal_begin(&bench.temporal, &bench.content, &request, &display),
			 GZ_ERR_INVAL);
	assert_int_equal(request.width, GZ_IMAGE_SIDE_MAX);
	end(&bench);
}

TEST_SUITE(temporal)
{
	if (!small_scene_backend_runs())
		return 77;
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(still_picture_converges_to_standard),
		cmocka_unit_test(
			still_picture_of_regions_converges_to_standard_beside_their_borders),
		cmocka_unit_test(fovea_is_that_of_standard_in_every_frame),
		cmocka_unit_test(any_change_drops_the_history),
		cmocka_unit_test(earlier_frames_never_hurt_while_the_camera_turns),
		cmocka_unit_test(frames_stand_alone_without_depths_while_the_camera_turns),
		cmocka_unit_test(jump_of_the_camera_leaves_no_ghost),
		cmocka_unit_test(picture_too_large_to_be_shifted_is_refused),
	};
	return cmocka_run_group_tests_name("temporal", tests, NULL, NULL);
}
