/* Rays of earlier pictures: taking them saves casting and changes no bit, and whatever decides a
 * ray makes it be cast again. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/frame/picture_maker.h"
#include "render/plan/method.h"
#include "render/raycast/raycast.h"
#include "render/raycast/shared/ray_content.h"
#include "render/surface/isosurface_technique.h"
#include "small_scene.h"

enum { WIDTH = 280, HEIGHT = 200 };

/* One maker keeps rays, the other does not. */
enum { KEPT, BARE, MAKERS };

struct stage {
	struct small_scene scene;
	struct gz_display display;
	struct gz_object object;
	struct gz_temporal_params temporal;
	struct gz_picture_request request; /* of both */
	struct gz_picture_maker *makers[MAKERS];
	struct gz_plan plans[MAKERS];
	struct gz_image images[MAKERS];
	struct gz_picture_cost cost; /* of the last picture that kept rays */
	enum gz_result result;       /* of both */
};

static void show(struct stage *stage)
{
	for (int i = 0; i < MAKERS; i++)
		assert_int_equal(gz_picture_maker_show(stage->makers[i], &stage->object, 1), GZ_OK);
}

static void set_up(const struct gz_technique *technique, struct stage *stage)
{
	const struct gz_picture_maker_params params = { .backend = "cpu",
							.backend_params = { .threads = 2 } };
	*stage = (struct stage) { .scene = small_scene_waves(40, 48, 36, GZ_VOXEL_U8),
				  .display = gz_display_default(WIDTH, HEIGHT),
				  .temporal = gz_temporal_default() };
	stage->object = (struct gz_object) {
		.technique = technique,
		.id = 1,
		.volume = &stage->scene.volume,
		.transfer = &stage->scene.transfer,
	};
	stage->scene.rays.surface.isovalue = 100;
	/* So that a small picture has wide spacings and long steps. */
	stage->scene.foveation.acuity_slope = 0.1;
	stage->scene.foveation.acuity_far_share = 1;
	stage->request = (struct gz_picture_request) {
		.camera = &stage->scene.camera,
		.settings = &stage->scene.rays,
		.foveation = &stage->scene.foveation,
		.display = &stage->display,
		.focus = gz_focus_at(stage->scene.gaze),
		.width = WIDTH,
		.height = HEIGHT,
	};
	for (int i = 0; i < MAKERS; i++)
		assert_int_equal(gz_picture_maker_create(&params, NULL, &stage->makers[i]), GZ_OK);
	show(stage);
}

static void take_down(struct stage *stage)
{
	for (int i = 0; i < MAKERS; i++) {
		gz_picture_maker_destroy(&stage->makers[i]);
		gz_plan_free(&stage->plans[i]);
		gz_image_free(&stage->images[i]);
	}
	small_scene_free(&stage->scene);
}

/* Make the picture of the request with rays kept and without, and compare them. */
static void make_both(struct stage *stage, const char *what)
{
	for (int i = 0; i < MAKERS; i++) {
		struct gz_picture_request request = stage->request;
		struct gz_picture_cost cost = { 0 };
		struct gz_image *image = NULL;
		request.temporal = i == KEPT ? &stage->temporal : NULL;
		request.plan = &stage->plans[i];
		request.image = &stage->images[i];
		const enum gz_result result =
			gz_picture_make(stage->makers[i], &request, &image, &cost);
		if (i == KEPT) {
			stage->cost = cost;
			stage->result = result;
		} else {
			assert_int_equal(result, stage->result);
			assert_true(cost.stats.kept_rays == 0);
			assert_true(cost.stats.rays == stage->cost.stats.rays);
		}
	}
	if (stage->result != GZ_OK)
		return;
	const struct gz_image *kept = &stage->images[KEPT], *bare = &stage->images[BARE];
	int x = 0, y = 0;
	assert_true(stage->cost.stats.kept_rays <= stage->cost.stats.rays);
	if (memcmp(kept->pixels, bare->pixels, (size_t)kept->width * (size_t)kept->height * 4) != 0)
		fail_msg("%s: differs by %d at %d, %d", what, image_difference(kept, bare, &x, &y),
			 x, y);
}

/* Along a line, by a jump, back, outside, and lost. */
static const struct gz_point places[] = {
	{ 0.3F, 0.4F }, { 0.31F, 0.4F },  { 0.32F, 0.41F }, { 0.34F, 0.43F },
	{ 0.8F, 0.7F }, { 0.81F, 0.69F }, { 0.31F, 0.4F },  { 0.31F, 0.4F },
	{ 1.2F, 0.5F }, { NAN, 0.5F },    { 0.5F, 0.5F },   { 0.51F, 0.51F },
};

enum { PLACES = sizeof places / sizeof places[0] };

static void follow_places(struct stage *stage, const char *what)
{
	uint64_t kept = 0;
	for (int i = 0; i < PLACES; i++) {
		stage->request.focus = gz_focus_at(places[i]);
		make_both(stage, what);
		kept += stage->cost.stats.kept_rays;
		if (i == 0)
			assert_true(kept == 0); /* of the first picture */
	}
	if (kept == 0)
		fail_msg("%s: no ray was kept", what);
	/* The same place again. */
	make_both(stage, what);
	assert_true(stage->cost.stats.kept_rays == stage->cost.stats.rays);
	assert_true(stage->cost.stats.samples == 0);
}

static const struct gz_technique *const kept_by[] = { &gz_raycast_technique,
						      &gz_isosurface_technique };

enum { TECHNIQUES = sizeof kept_by / sizeof kept_by[0] };

static bool is_present(const struct gz_technique *technique)
{
	return technique->check("cpu", NULL, NULL) == GZ_OK;
}

static void pictures_are_the_same_wherever_the_gaze_goes(void **state)
{
	(void)state;
	for (int t = 0; t < TECHNIQUES; t++)
		for (int method = 0; method < GZ_METHOD_COUNT; method++) {
			struct stage stage;
			if (!is_present(kept_by[t]))
				continue;
			set_up(kept_by[t], &stage);
			stage.scene.foveation.method = method;
			follow_places(&stage, gz_method_names[method]);
			take_down(&stage);
		}
}

/* Light, interleaved steps, coarser levels, long steps, jitter, edges, pre-integration, shadows. */
static void pictures_are_the_same_with_all_that_rays_do(void **state)
{
	(void)state;
	for (int kind = 0; kind < 7; kind++) {
		struct stage stage;
		set_up(&gz_raycast_technique, &stage);
		struct gz_ray_params *rays = &stage.scene.rays;
		stage.scene.foveation.method = GZ_METHOD_ACUITY;
		if (kind == 0)
			rays->shading = GZ_SHADING_GRADIENT;
		else if (kind == 1)
			rays->levels = true, rays->ray_sampling_rate = 0.3;
		else if (kind == 2)
			stage.scene.foveation.step_phase = GZ_STEP_PHASE_INTERLEAVED;
		else if (kind == 3)
			rays->jitter = 7;
		else if (kind == 4)
			stage.scene.foveation.edge_contrast = 0.2;
		else if (kind == 5)
			rays->integration = GZ_INTEGRATION_PREINTEGRATED;
		else
			rays->light.shadow_steps = 8;
		follow_places(&stage, "kind of ray");
		take_down(&stage);
	}
}

static void turning_camera_keeps_nothing(void **state)
{
	(void)state;
	struct stage stage;
	set_up(&gz_raycast_technique, &stage);
	for (int i = 0; i < 4; i++) {
		make_both(&stage, "turn");
		assert_true(stage.cost.stats.kept_rays == 0);
		gz_camera_turn(&stage.scene.camera, 1);
	}
	make_both(&stage, "at rest"); /* seen for the first time */
	make_both(&stage, "at rest");
	assert_true(stage.cost.stats.kept_rays == 0);
	make_both(&stage, "at rest");
	assert_true(stage.cost.stats.kept_rays == stage.cost.stats.rays);
	take_down(&stage);
}

/* Another value of an option: the next choice, or a number nearby. Returns whether there is one.
 * still_growth is left out: it gives kept pictures more rays. */
static bool change_option(const struct gz_option *option, void *target)
{
	if (strcmp(option->key, "foveation.still_growth") == 0)
		return false;
	char *field = (char *)target + option->offset;
	double *number = (double *)(void *)field;
	int *whole = (int *)(void *)field;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		*(bool *)field = !*(bool *)field;
		return true;
	case GZ_OPTION_CHOICE:
		*whole = option->choices[*whole + 1] ? *whole + 1 : 0;
		return true;
	case GZ_OPTION_DOUBLE:
		*number += *number + 0.25 <= option->max ? 0.25 : -0.25;
		return *number >= option->min;
	case GZ_OPTION_INT:
		*whole += *whole + 1 <= option->max ? 1 : -1;
		return *whole >= option->min;
	case GZ_OPTION_STRING:
	case GZ_OPTION_SIZE:
		break;
	}
	return false;
}

/* Change each option of a table in turn, by itself. Returns how many of them changed the picture.
 */
static int change_options(struct stage *stage, const struct gz_option_binding *binding)
{
	int changed = 0;
	for (size_t i = 0; i < binding->count; i++) {
		const struct small_scene before = stage->scene;
		struct gz_image earlier = { 0 };
		make_both(stage, "before");
		make_both(stage, "before");
		make_both(stage, "before");
		assert_true(stage->cost.stats.kept_rays > 0);
		assert_int_equal(gz_image_resize(&earlier, WIDTH, HEIGHT), GZ_OK);
		memcpy(earlier.pixels, stage->images[KEPT].pixels, (size_t)WIDTH * HEIGHT * 4);
		if (change_option(&binding->options[i], binding->target)) {
			for (int k = 0; k < 3; k++)
				make_both(stage, binding->options[i].key);
			changed += stage->result == GZ_OK &&
				   memcmp(earlier.pixels, stage->images[KEPT].pixels,
					  (size_t)WIDTH * HEIGHT * 4) != 0;
		}
		stage->scene.rays = before.rays;
		stage->scene.foveation = before.foveation;
		gz_image_free(&earlier);
	}
	return changed;
}

/* The options of rays, one by one, on a scene that shows most of them. */
static void changed_setting_is_noticed(void **state)
{
	(void)state;
	for (int t = 0; t < TECHNIQUES; t++) {
		struct gz_option_binding bindings[GZ_TECHNIQUE_BINDINGS_MAX];
		struct stage stage;
		int changed = 0;
		if (!is_present(kept_by[t]))
			continue;
		set_up(kept_by[t], &stage);
		stage.scene.rays.shading = GZ_SHADING_GRADIENT;
		stage.scene.rays.environment.kind = GZ_SURROUNDINGS_SKY;
		stage.scene.foveation.method = GZ_METHOD_ACUITY;
		const size_t count =
			kept_by[t]->bind(&stage.scene.rays, bindings, GZ_TECHNIQUE_BINDINGS_MAX);
		for (size_t i = 0; i < count; i++)
			changed += change_options(&stage, &bindings[i]);
		assert_true(changed > 20);
		/* Whole pictures are kept as such. */
		stage.scene.foveation.method = GZ_METHOD_STANDARD;
		for (size_t i = 0; i < count; i++)
			changed += change_options(&stage, &bindings[i]);
		stage.scene.foveation.method = GZ_METHOD_ACUITY;
		const struct gz_option_binding foveation = {
			.options = gz_foveation_options,
			.count = gz_foveation_option_count,
			.target = &stage.scene.foveation,
		};
		assert_true(change_options(&stage, &foveation) > 2);
		take_down(&stage);
	}
}

static void rest(struct stage *stage)
{
	for (int i = 0; i < 3; i++)
		make_both(stage, "rest");
	assert_true(stage->cost.stats.kept_rays == stage->cost.stats.rays);
}

/* Camera, size, strip, rays a pixel, and what the revisions say. */
static void changed_view_is_noticed(void **state)
{
	(void)state;
	struct stage stage;
	set_up(&gz_raycast_technique, &stage);
	rest(&stage);
	stage.scene.camera.eye[0] += 0.01;
	rest(&stage);
	stage.scene.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	rest(&stage);
	stage.request.width -= 40;
	rest(&stage);
	stage.request.image_sampling_rate = 0.5;
	rest(&stage);
	stage.request.image_sampling_rate = 1;
	stage.request.strip.rows = 64;
	for (int i = 0; i < 2; i++) {
		stage.request.strip.top = 64 * i;
		rest(&stage);
	}
	stage.request.strip.rows = 0;
	rest(&stage);
	take_down(&stage);
}

static void changed_data_are_noticed(void **state)
{
	(void)state;
	struct stage stage;
	set_up(&gz_raycast_technique, &stage);
	rest(&stage);
	stage.scene.transfer.points[0].rgb[0] = 1;
	stage.scene.transfer.points[0].opacity = 0.9;
	stage.object.transfer_revision++;
	show(&stage);
	rest(&stage);
	uint8_t *voxels = (uint8_t *)stage.scene.volume.voxels;
	memset(voxels, 200, gz_volume_voxel_count(&stage.scene.volume) / 2);
	stage.object.data_revision++;
	show(&stage);
	rest(&stage);
	take_down(&stage);
}

/* Where pictures of the surroundings were found is no option, and what was found may change. */
static void revision_makes_another_content(void **state)
{
	(void)state;
	struct gz_ray_content content = { 0 };
	struct gz_ray_params rays = gz_ray_params_default();
	const struct gz_ray_frame frame = { 0 };
	const struct gz_plan plan = { 0 };
	const uint64_t first = gz_ray_content_follow(&content, &plan, &rays, &frame, NULL, 1);
	assert_true(first > 0);
	assert_true(gz_ray_content_follow(&content, &plan, &rays, &frame, NULL, 1) == first);
	strcpy(rays.environment.cube_path, "elsewhere");
	const uint64_t second = gz_ray_content_follow(&content, &plan, &rays, &frame, NULL, 2);
	assert_true(second != first);
	gz_ray_content_forget(&content);
	assert_true(gz_ray_content_follow(&content, &plan, &rays, &frame, NULL, 2) != second);
}

/* A method whose regions change their spacing every frame makes no shelves in vain. */
static void plans_that_change_their_layers_keep_nothing(void **state)
{
	(void)state;
	struct stage stage;
	set_up(&gz_raycast_technique, &stage);
	stage.scene.foveation.method = GZ_METHOD_UNIFORM;
	for (int i = 0; i < 6; i++) {
		stage.scene.foveation.uniform_spacing = 2 + i % 2;
		make_both(&stage, "spacing");
		assert_true(stage.cost.stats.kept_rays == 0);
	}
	make_both(&stage, "spacing"); /* the same as the last */
	make_both(&stage, "spacing");
	assert_true(stage.cost.stats.kept_rays == stage.cost.stats.rays);
	take_down(&stage);
}

/* Keeping stops and goes on; accumulated frames are of other rays. */
static void keeping_can_be_switched_off(void **state)
{
	(void)state;
	struct stage stage;
	set_up(&gz_raycast_technique, &stage);
	rest(&stage);
	stage.temporal.keep_rays = false;
	make_both(&stage, "off");
	assert_true(stage.cost.stats.kept_rays == 0);
	stage.temporal.keep_rays = true;
	rest(&stage);
	struct gz_image *image;
	struct gz_picture_request request = stage.request;
	stage.temporal.accumulate = true;
	request.temporal = &stage.temporal;
	for (int i = 0; i < 3; i++) {
		assert_int_equal(gz_picture_make(stage.makers[KEPT], &request, &image, &stage.cost),
				 GZ_OK);
		assert_true(stage.cost.stats.kept_rays == 0);
	}
	stage.temporal.accumulate = false;
	rest(&stage);
	take_down(&stage);
}

/* ---- plans that grow while only the gaze changes ---- */

static void make_growing(struct stage *stage)
{
	struct gz_picture_request request = stage->request;
	struct gz_image *image = NULL;
	request.temporal = &stage->temporal;
	request.plan = &stage->plans[KEPT];
	request.image = &stage->images[KEPT];
	assert_int_equal(gz_picture_make(stage->makers[KEPT], &request, &image, &stage->cost),
			 GZ_OK);
}

/* The picture with a ray for every pixel, by the other maker. */
static void make_standard(struct stage *stage)
{
	const struct gz_foveation full = gz_foveation_full();
	struct gz_picture_request request = stage->request;
	struct gz_image *image = NULL;
	request.foveation = &full;
	request.plan = &stage->plans[BARE];
	request.image = &stage->images[BARE];
	assert_int_equal(gz_picture_make(stage->makers[BARE], &request, &image, NULL), GZ_OK);
}

/* Sum of the differences from standard. */
static double error_of(const struct stage *stage)
{
	const struct gz_image *image = &stage->images[KEPT], *standard = &stage->images[BARE];
	double sum = 0;
	for (size_t i = 0; i < (size_t)image->width * (size_t)image->height * 4; i++)
		sum += abs(image->pixels[i] - standard->pixels[i]);
	return sum;
}

static const double growth = 0.5;

static void set_up_growing(const struct gz_technique *technique, int method, struct stage *stage)
{
	set_up(technique, stage);
	stage->scene.foveation.method = method;
	stage->scene.foveation.still_growth = growth;
	make_standard(stage);
}

/* Make pictures until one is whole; return how many. Each is nearer to standard than the one
 * before, and casts at most so many times the rays of the method. */
static int grow_until_whole(struct stage *stage, double most, const char *what)
{
	enum { PICTURES_MOST = 60 };
	double method_rays = 0, error_before = 0;
	int pictures = 0;
	do {
		make_growing(stage);
		const struct gz_frame_stats *stats = &stage->cost.stats;
		const double cast = (double)(stats->rays - stats->kept_rays);
		const double error = error_of(stage);
		if (pictures == 0)
			method_rays = (double)stats->rays;
		else if (error > 1.02 * error_before)
			fail_msg("%s: picture %d has error %g after %g", what, pictures, error,
				 error_before);
		if (cast > most * method_rays)
			fail_msg("%s: picture %d casts %g rays, the method %g", what, pictures,
				 cast, method_rays);
		error_before = error;
		if (++pictures > PICTURES_MOST)
			fail_msg("%s: not whole after %d pictures", what, pictures);
	} while (gz_picture_maker_settling(stage->makers[KEPT]));
	return pictures;
}

static void growing_plan_ends_as_standard(void **state)
{
	(void)state;
	static const int methods[] = { GZ_METHOD_ACUITY, GZ_METHOD_CONTRAST };
	/* Those of contrast are few, and the first plan of one round has all that it could need. */
	static const double most[] = { 1.1, 3 };
	for (int t = 0; t < TECHNIQUES; t++)
		for (int m = 0; m < 2; m++) {
			struct stage stage;
			if (!is_present(kept_by[t]))
				continue;
			set_up_growing(kept_by[t], methods[m], &stage);
			assert_true(grow_until_whole(&stage, most[m], gz_method_names[methods[m]]) >
				    4);
			assert_true(error_of(&stage) == 0);
			/* The whole picture is kept, wherever the gaze goes. */
			for (int i = 0; i < PLACES; i++) {
				stage.request.focus = gz_focus_at(places[i]);
				memset(stage.images[KEPT].pixels, 0, 64);
				make_growing(&stage);
				assert_true(stage.cost.stats.samples == 0);
				assert_true(stage.cost.stats.rays >= WIDTH * HEIGHT);
				assert_true(stage.cost.stats.kept_rays == stage.cost.stats.rays);
				assert_true(error_of(&stage) == 0);
			}
			take_down(&stage);
		}
}

/* Whatever else changes, the next picture is the method's own again. */
static void grown_plan_falls_back_at_once(void **state)
{
	(void)state;
	for (int change = 0; change < 5; change++) {
		struct stage stage;
		set_up_growing(&gz_raycast_technique, GZ_METHOD_ACUITY, &stage);
		make_growing(&stage);
		const uint64_t method_rays = stage.cost.stats.rays;
		for (int i = 0; i < 6 || (change % 2 && i < 60); i++)
			make_growing(&stage);
		assert_true(stage.cost.stats.rays > 2 * method_rays);
		if (change == 0) {
			gz_camera_turn(&stage.scene.camera, 1);
		} else if (change == 1) {
			stage.scene.rays.ray_sampling_rate *= 1.5;
		} else if (change == 2) {
			stage.scene.transfer.points[0].rgb[0] = 1;
			stage.object.transfer_revision++;
			show(&stage);
		} else if (change == 3) {
			stage.temporal.keep_rays = false;
		} else {
			gz_picture_maker_forget(stage.makers[KEPT]);
		}
		make_growing(&stage);
		assert_true(stage.cost.stats.rays == method_rays);
		make_both(&stage, "after a change");
		take_down(&stage);
	}
}

/* Regions, strips, steps and edges that finer plans would change, frames that accumulate, and
 * pictures whose camera moves. */
static void other_plans_do_not_grow(void **state)
{
	(void)state;
	for (int kind = 0; kind < 8; kind++) {
		struct stage stage;
		set_up_growing(&gz_raycast_technique, GZ_METHOD_ACUITY, &stage);
		if (kind == 5)
			stage.scene.foveation.step_rule = GZ_STEP_DISTANCE;
		else if (kind == 6)
			stage.scene.foveation.edge_contrast = 0.5;
		else if (kind == 7)
			stage.request.focus.finer = 1; /* a replay says so */
		else if (kind == 0)
			stage.scene.foveation.method = GZ_METHOD_DDC;
		else if (kind == 1)
			stage.request.strip.rows = HEIGHT / 2;
		else if (kind == 2)
			stage.temporal.accumulate = true;
		else if (kind == 3)
			stage.scene.foveation.still_growth = 0;
		make_growing(&stage);
		const uint64_t first = stage.cost.stats.rays;
		for (int i = 0; i < 8; i++) {
			if (kind == 4)
				gz_camera_turn(&stage.scene.camera, 1);
			make_growing(&stage);
			/* Lattices of frames that accumulate are shifted. */
			if ((double)stage.cost.stats.rays > 1.1 * (double)first)
				fail_msg("kind %d, picture %d: %llu rays instead of %llu", kind, i,
					 (unsigned long long)stage.cost.stats.rays,
					 (unsigned long long)first);
		}
		take_down(&stage);
	}
}

/* The plan of a lost gaze changes as a whole, so it is the method's; a whole picture stays. */
static void lost_gaze_pauses_growth(void **state)
{
	(void)state;
	struct stage stage;
	set_up_growing(&gz_raycast_technique, GZ_METHOD_ACUITY, &stage);
	for (int i = 0; i < 5; i++)
		make_growing(&stage);
	const uint64_t grown = stage.cost.stats.rays;
	stage.request.focus.widen = 1;
	make_growing(&stage);
	const uint64_t lost = stage.cost.stats.rays;
	assert_true(lost < grown);
	for (int i = 0; i < 5; i++) {
		make_growing(&stage);
		assert_true(stage.cost.stats.rays == lost);
		assert_false(gz_picture_maker_settling(stage.makers[KEPT]));
	}
	stage.request.focus.widen = 0;
	make_growing(&stage);
	assert_true(stage.cost.stats.rays >= grown);
	grow_until_whole(&stage, 1.1, "after a loss");
	stage.request.focus.widen = 1;
	make_growing(&stage);
	assert_true(error_of(&stage) == 0);
	take_down(&stage);
}

TEST_SUITE(kept_rays)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pictures_are_the_same_wherever_the_gaze_goes),
		cmocka_unit_test(pictures_are_the_same_with_all_that_rays_do),
		cmocka_unit_test(turning_camera_keeps_nothing),
		cmocka_unit_test(changed_setting_is_noticed),
		cmocka_unit_test(changed_view_is_noticed),
		cmocka_unit_test(changed_data_are_noticed),
		cmocka_unit_test(revision_makes_another_content),
		cmocka_unit_test(plans_that_change_their_layers_keep_nothing),
		cmocka_unit_test(keeping_can_be_switched_off),
		cmocka_unit_test(growing_plan_ends_as_standard),
		cmocka_unit_test(grown_plan_falls_back_at_once),
		cmocka_unit_test(other_plans_do_not_grow),
		cmocka_unit_test(lost_gaze_pauses_growth),
	};
	return cmocka_run_group_tests_name("kept_rays", tests, NULL, NULL);
}
