/* How much longer steps change: the measure agrees with pictures, and plans follow it. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/frame/picture_maker.h"
#include "render/plan/method.h"
#include "render/raycast/raycast.h"
#include "render/raycast/shared/step_errors.h"
#include "small_scene.h"

enum { SIDE = 160 };

static const double black[3] = { 0, 0, 0 }, white[3] = { 1, 1, 1 };

/* A peak a hundredth of the range wide. */
static const struct gz_transfer peak = {
	.count = 5,
	.points = {
		{ 0, { 0.2, 0.4, 0.9 }, 0 },
		{ 0.595, { 0.9, 0.6, 0.2 }, 0 },
		{ 0.6, { 0.9, 0.6, 0.2 }, 0.9 },
		{ 0.605, { 0.9, 0.6, 0.2 }, 0 },
		{ 1, { 0.2, 0.4, 0.9 }, 0 },
	},
};

static struct gz_step_errors measure(const struct gz_volume *volume,
				     const struct gz_transfer *transfer, bool nearest)
{
	static struct gz_transfer_table table;
	struct gz_ray_values values = { 0 };
	struct gz_step_errors errors;
	gz_transfer_table_bake(transfer, volume, &table);
	assert_int_equal(gz_ray_values_take(volume, nearest, &values), GZ_OK);
	assert_int_equal(gz_step_errors_measure(&values, &table, &errors), GZ_OK);
	gz_ray_values_free(&values);
	assert_null(values.stored);
	return errors;
}

static double light_at(const struct gz_image *image, size_t i)
{
	const uint8_t *pixel = image->pixels + 4 * i;
	return (0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]) / 255;
}

static void draw_by_steps(struct small_scene *scene, double length, struct gz_image *image)
{
	struct gz_raycaster *renderer = small_scene_renderer(scene, 2, NULL);
	scene->rays.ray_sampling_rate = 1 / length;
	small_scene_render(renderer, scene, SIDE, SIDE, image, NULL);
	gz_raycaster_destroy(&renderer);
}

/* Change of light in relation to the mean light of pixels that show something. */
static double change_between(const struct gz_image *fine, const struct gz_image *coarse)
{
	double squares = 0, light = 0;
	int seen = 0;
	for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
		const double one = light_at(fine, i), other = light_at(coarse, i);
		if (one < 0.01)
			continue;
		seen++;
		squares += (other - one) * (other - one);
		light += one;
	}
	assert_true(seen > 500);
	return sqrt(squares / seen) / (light / seen);
}

/* The pictures are drawn by the ray caster, from a camera that the measure does not know. */
static void measure_agrees_with_pictures(void **state)
{
	(void)state;
	static const double lengths[] = { 1, 2, 4, 8 };
	struct gz_image fine = { 0 }, coarse = { 0 };
	for (int sharp = 0; sharp < 2; sharp++) {
		struct small_scene scene = small_scene_waves(64, 56, 48, GZ_VOXEL_U8);
		scene.foveation.method = GZ_METHOD_STANDARD;
		scene.rays.jitter = 1;
		if (sharp)
			scene.transfer = peak;
		const struct gz_step_errors errors = measure(&scene.volume, &scene.transfer, false);
		assert_true(errors.known);
		draw_by_steps(&scene, 1.0 / GZ_STEP_ERROR_FINEST, &fine);
		for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
			draw_by_steps(&scene, lengths[i], &coarse);
			const double drawn = change_between(&fine, &coarse);
			const double measured = gz_step_error_at(&errors, lengths[i], black);
			/* 8 bits change a pixel by some thousandths. */
			if (measured < 0.5 * drawn - 0.003 || measured > 2 * drawn + 0.003)
				fail_msg("%s, steps of %g: measured %.4f, drawn %.4f",
					 sharp ? "peak" : "slope", lengths[i], measured, drawn);
		}
		small_scene_free(&scene);
	}
	gz_image_free(&fine);
	gz_image_free(&coarse);
}

static void errors_rise_with_length_and_depend_on_the_background(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(64, 56, 48, GZ_VOXEL_U16);
	const struct gz_step_errors errors = measure(&scene.volume, &scene.transfer, false);
	const double longest = gz_step_error_lengths[GZ_STEP_ERROR_LENGTHS - 1];
	assert_true(gz_step_error_at(&errors, longest, black) >
		    5 * gz_step_error_at(&errors, gz_step_error_lengths[0], black));
	assert_true(gz_step_error_at(&errors, 0.1, black) < gz_step_error_at(&errors, 0.2, black));
	assert_true(gz_step_error_at(&errors, 100, black) ==
		    gz_step_error_at(&errors, longest, black));
	/* A dark volume changes a white picture by a smaller share. */
	assert_true(gz_step_error_at(&errors, 2, white) < gz_step_error_at(&errors, 2, black));
	small_scene_free(&scene);
}

static void longest_steps_are_those_of_the_limit(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(64, 56, 48, GZ_VOXEL_F32);
	const struct gz_step_errors errors = measure(&scene.volume, &scene.transfer, false);
	for (double limit = 0.0001; limit < 10; limit *= 1.3) {
		const double longest = gz_step_errors_longest(&errors, black, limit);
		if (isinf(longest))
			continue;
		const double at = gz_step_error_at(&errors, longest, black);
		if (fabs(at / limit - 1) > 1e-6)
			fail_msg("limit %g: steps of %g change %g", limit, longest, at);
		for (double length = longest; length > 0.05; length *= 0.9)
			assert_true(gz_step_error_at(&errors, length, black) < 1.000001 * limit);
	}
	assert_true(gz_step_errors_longest(&errors, black, 1e-9) < 0.01);
	assert_true(isinf(gz_step_errors_longest(&errors, black, 10)));
	small_scene_free(&scene);
}

/* Between labels 0 and 200 lies no label 100 unless values are interpolated. */
static void nearest_values_know_none_between(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(40, 40, 40, GZ_VOXEL_U8);
	uint8_t *voxels = scene.volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&scene.volume); i++)
		voxels[i] = voxels[i] > 100 ? 200 : 0;
	gz_volume_find_range(&scene.volume);
	const struct gz_transfer between = {
		.count = 4,
		.points = { { 0.3, { 1, 1, 1 }, 0 },
			    { 0.4, { 1, 1, 1 }, 0.9 },
			    { 0.6, { 1, 1, 1 }, 0.9 },
			    { 0.7, { 1, 1, 1 }, 0 } },
	};
	assert_true(measure(&scene.volume, &between, false).known);
	assert_false(measure(&scene.volume, &between, true).known);
	small_scene_free(&scene);
}

/* However thin a volume is, rays go through it, and longer steps change what they see. */
static void flat_volumes_are_measured(void **state)
{
	(void)state;
	static const int dims[][3] = { { 64, 1, 1 }, { 48, 48, 1 }, { 2, 3, 200 } };
	for (size_t i = 0; i < sizeof dims / sizeof *dims; i++) {
		struct small_scene scene =
			small_scene_waves(dims[i][0], dims[i][1], dims[i][2], GZ_VOXEL_U8);
		const struct gz_step_errors errors = measure(&scene.volume, &scene.transfer, false);
		assert_true(errors.known);
		for (int k = 0; k < GZ_STEP_ERROR_LENGTHS; k++)
			assert_true(isfinite(errors.at[k].light) && errors.at[k].light > 0);
		small_scene_free(&scene);
	}
	struct small_scene voxel = small_scene_constant(1, 0.5);
	const struct gz_step_errors errors = measure(&voxel.volume, &voxel.transfer, false);
	assert_true(errors.known);
	for (int k = 0; k < GZ_STEP_ERROR_LENGTHS; k++)
		assert_true(errors.at[k].light < 1e-10);
	small_scene_free(&voxel);
}

/* A picture maker and the plan of its last picture. */
struct stage {
	struct small_scene scene;
	struct gz_display display;
	struct gz_object object;
	struct gz_picture_maker *maker;
	struct gz_plan plan;
	struct gz_image image;
	struct gz_picture_cost cost; /* of the last picture */
};

static void set_up(struct stage *stage)
{
	const struct gz_picture_maker_params params = { .backend = small_scene_backend() };
	*stage = (struct stage) { .scene = small_scene_waves(64, 56, 48, GZ_VOXEL_U8),
				  .display = gz_display_default(SIDE, SIDE) };
	stage->scene.foveation.method = GZ_METHOD_ACUITY;
	stage->scene.foveation.acuity_slope = 0.1;
	stage->object = (struct gz_object) {
		.technique = &gz_raycast_technique,
		.id = 1,
		.volume = &stage->scene.volume,
		.transfer = &stage->scene.transfer,
	};
	assert_int_equal(gz_picture_maker_create(&params, NULL, &stage->maker), GZ_OK);
}

static void take_down(struct stage *stage)
{
	gz_picture_maker_destroy(&stage->maker);
	gz_plan_free(&stage->plan);
	gz_image_free(&stage->image);
	small_scene_free(&stage->scene);
}

/* The longest step of the next picture's plan. */
static double longest_step(struct stage *stage)
{
	const struct gz_picture_request request = {
		.camera = &stage->scene.camera,
		.settings = &stage->scene.rays,
		.foveation = &stage->scene.foveation,
		.display = &stage->display,
		.focus = gz_focus_at(stage->scene.gaze),
		.width = SIDE,
		.height = SIDE,
		.plan = &stage->plan,
		.image = &stage->image,
	};
	struct gz_image *image;
	assert_int_equal(gz_picture_maker_show(stage->maker, &stage->object, 1), GZ_OK);
	assert_int_equal(gz_picture_make(stage->maker, &request, &image, &stage->cost), GZ_OK);
	return (double)stage->plan.steps[stage->plan.step_count - 1];
}

static void steps_grow_where_data_and_function_are_smooth(void **state)
{
	(void)state;
	if (!small_scene_backend_runs())
		skip();
	struct stage stage;
	struct gz_foveation *foveation = &stage.scene.foveation;
	set_up(&stage);
	stage.scene.rays.ray_sampling_rate = 4;
	const double smooth = longest_step(&stage);
	assert_true(smooth > 1.5);
	/* A longer step of the scene's own leaves less room. */
	stage.scene.rays.ray_sampling_rate = 1;
	assert_true(longest_step(&stage) < smooth);
	stage.scene.rays.ray_sampling_rate = 4;
	assert_true(longest_step(&stage) == smooth);
	foveation->acuity_step_error = 0.002;
	const double careful = longest_step(&stage);
	assert_true(careful < smooth);
	/* Half the change is allowed where surfaces are lit. */
	foveation->acuity_step_error = 0.004;
	stage.scene.rays.shading = GZ_SHADING_GRADIENT;
	assert_true(fabs(longest_step(&stage) - careful) < 1e-6);
	stage.scene.rays.shading = GZ_SHADING_NONE;
	/* The new function counts, and the old one again. */
	foveation->acuity_step_error = 0.0125;
	const struct gz_transfer function = stage.scene.transfer;
	stage.scene.transfer = peak;
	stage.object.transfer_revision++;
	assert_true(longest_step(&stage) == 1);
	stage.scene.transfer = function;
	stage.object.transfer_revision++;
	assert_true(longest_step(&stage) == smooth);
	/* What is emphasised for a while changes no step. */
	stage.scene.transfer.emphasis = (struct gz_transfer_emphasis) { 0.5, 0.4, 0.6 };
	stage.object.transfer_revision++;
	assert_true(longest_step(&stage) == smooth);
	assert_true(stage.cost.stats.prepare_within_ms == 0);
	/* Voxels that are not interpolated have walls. */
	stage.scene.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	assert_true(longest_step(&stage) < smooth);
	foveation->acuity_step_error = 1;
	foveation->acuity_step_growth = 1;
	assert_true(longest_step(&stage) > 7.9);
	take_down(&stage);
}

/* New voxels in the same volume are measured anew. */
static void steps_follow_new_data(void **state)
{
	(void)state;
	if (!small_scene_backend_runs())
		skip();
	struct stage stage;
	set_up(&stage);
	stage.scene.rays.ray_sampling_rate = 1;
	stage.scene.foveation.acuity_step_error = 0.04;
	const double before = longest_step(&stage);
	uint8_t *voxels = stage.scene.volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&stage.scene.volume); i++)
		voxels[i] = (uint8_t)(i * 2654435761U >> 24);
	gz_volume_find_range(&stage.scene.volume);
	stage.object.data_revision++;
	const double after = longest_step(&stage);
	if (!(before > 2 && after < before / 2))
		fail_msg("%g, then %g", before, after);
	take_down(&stage);
}

static void measuring_is_preparation_and_no_part_of_the_plan(void **state)
{
	(void)state;
	if (!small_scene_backend_runs())
		skip();
	struct stage stage;
	const struct gz_picture_cost *cost = &stage.cost;
	set_up(&stage);
	stage.scene.foveation.acuity_step_error = 1;
	longest_step(&stage); /* all else is prepared */
	stage.scene.foveation.acuity_step_error = 0.01;
	longest_step(&stage);
	assert_true(cost->stats.prepare_within_ms > 0);
	assert_true(cost->stats.prepare_ms >= cost->stats.prepare_within_ms);
	assert_true(cost->plan_ms + cost->stats.prepare_within_ms + cost->stats.cast_ms <=
		    cost->total_ms);
	longest_step(&stage);
	assert_true(cost->stats.prepare_within_ms == 0);
	take_down(&stage);
}

TEST_SUITE(step_errors)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(measure_agrees_with_pictures),
		cmocka_unit_test(errors_rise_with_length_and_depend_on_the_background),
		cmocka_unit_test(longest_steps_are_those_of_the_limit),
		cmocka_unit_test(nearest_values_know_none_between),
		cmocka_unit_test(flat_volumes_are_measured),
		cmocka_unit_test(steps_grow_where_data_and_function_are_smooth),
		cmocka_unit_test(steps_follow_new_data),
		cmocka_unit_test(measuring_is_preparation_and_no_part_of_the_plan),
	};
	return cmocka_run_group_tests_name("step_errors", tests, NULL, NULL);
}
