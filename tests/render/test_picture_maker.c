/* The picture maker: its backend, and cpu in place of one that fails for good; strips,
 * revisions, accumulation and refusals. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lent_context.h"
#include "render/frame/picture_maker.h"
#include "render/opengl/gl_device.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "small_scene.h"

/* Collects the messages. */
struct heard {
	char text[1024];
};

static void hear(void *user, enum gz_log_level level, const char *module, const char *message)
{
	struct heard *heard = user;
	const size_t used = strlen(heard->text);
	(void)module;
	if (level >= GZ_LOG_INFO)
		snprintf(heard->text + used, sizeof heard->text - used, "%s\n", message);
}

enum { WIDTH = 64, HEIGHT = 48 };

/* A picture maker over a small scene, with all it needs. */
struct set_up {
	struct small_scene scene;
	struct gz_display display;
	struct gz_picture_request request;
	struct heard heard;
	struct gz_log log;
	struct gz_object object;
	struct gz_picture_maker *maker;
	struct gz_image *image; /* of the last picture; NULL: it stayed on the device */
	struct gz_picture_cost cost;
};

static void set_up(struct set_up *all)
{
	memset(all, 0, sizeof *all);
	all->scene = small_scene_waves(20, 24, 18, GZ_VOXEL_U8);
	all->display = gz_display_default(WIDTH, HEIGHT);
	all->request = (struct gz_picture_request) {
		.camera = &all->scene.camera,
		.settings = &all->scene.rays,
		.foveation = &all->scene.foveation,
		.display = &all->display,
		.focus = gz_focus_at(all->scene.gaze),
		.width = WIDTH,
		.height = HEIGHT,
	};
	all->object = (struct gz_object) {
		.technique = gz_techniques[0],
		.id = 1,
		.volume = &all->scene.volume,
		.transfer = &all->scene.transfer,
	};
	gz_log_init(&all->log, hear, &all->heard, "info");
}

static void take_down(struct set_up *all)
{
	gz_picture_maker_destroy(&all->maker);
	small_scene_free(&all->scene);
}

static enum gz_result show(struct set_up *all, const struct gz_picture_maker_params *params)
{
	assert_int_equal(gz_picture_maker_create(params, &all->log, &all->maker), GZ_OK);
	return gz_picture_maker_show(all->maker, &all->object, 1);
}

static enum gz_result make(struct set_up *all)
{
	return gz_picture_make(all->maker, &all->request, &all->image, &all->cost);
}

static struct gz_image copy_of(const struct gz_image *image)
{
	struct gz_image copy = { 0 };
	assert_int_equal(gz_image_resize(&copy, image->width, image->height), GZ_OK);
	memcpy(copy.pixels, image->pixels, (size_t)image->width * (size_t)image->height * 4);
	return copy;
}

/* Draw by gl on a lent context, and let cpu take over. */
static struct gz_picture_maker_params params_on(struct lent_context *lent)
{
	return (struct gz_picture_maker_params) {
		.backend = "gl",
		.backend_params = { .gl_context = &lent->base },
		.cpu_takes_over = true,
	};
}

static void cpu_takes_over_after_a_lost_context(void **state)
{
	(void)state;
	struct lent_context lent = lend_context();
	const struct gz_picture_maker_params params = params_on(&lent);
	struct set_up all;
	set_up(&all);
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	struct gz_image before = copy_of(all.image);
	all.request.on_device = true;
	assert_int_equal(make(&all), GZ_OK);
	assert_null(all.image);
	assert_true(gz_picture_maker_texture(all.maker) != 0);
	lent.lost = true;
	for (int picture = 0; picture < 2; picture++) {
		assert_int_equal(make(&all), GZ_OK);
		assert_non_null(all.image);
		assert_string_equal(gz_picture_maker_backend(all.maker), "cpu");
		int x = 0, y = 0;
		assert_true(image_difference(&before, all.image, &x, &y) <= 1);
	}
	if (!strstr(all.heard.text, "context") || !strstr(all.heard.text, "cpu backend"))
		fail_msg("'%s' tells neither loss nor remedy", all.heard.text);
	gz_image_free(&before);
	take_down(&all);
	gz_gl_context_destroy(&lent.egl);
}

static void lost_context_is_returned_if_the_request_says_so(void **state)
{
	(void)state;
	for (int returned = 0; returned < 2; returned++) {
		struct lent_context lent = lend_context();
		const struct gz_picture_maker_params params = params_on(&lent);
		struct set_up all;
		set_up(&all);
		all.request.on_device = true;
		all.request.loss_returned = returned;
		assert_int_equal(show(&all, &params), GZ_OK);
		assert_int_equal(make(&all), GZ_OK);
		assert_string_equal(gz_picture_maker_backend(all.maker), "gl");
		lent.lost = true;
		assert_int_equal(make(&all), returned ? GZ_ERR_NO_DEVICE : GZ_OK);
		if (!returned)
			assert_string_equal(gz_picture_maker_backend(all.maker), "cpu");
		take_down(&all);
		gz_gl_context_destroy(&lent.egl);
	}
}

/* A drawer whose pictures lack something. */
struct lacking_drawer {
	struct gz_drawer base;
	uint64_t coming; /* one fewer with each picture, but for the last */
	int drawn, printed;
};

static struct lacking_drawer lacking;

static enum gz_result lacking_show(struct gz_drawer *drawer, const struct gz_object *objects,
				   size_t count)
{
	(void)drawer, (void)objects, (void)count;
	return GZ_OK;
}

static enum gz_result lacking_draw(struct gz_drawer *drawer, const struct gz_shot *shot,
				   struct gz_image *image, struct gz_frame_stats *out_stats)
{
	struct lacking_drawer *self = (struct lacking_drawer *)drawer;
	self->drawn++;
	self->coming -= self->coming > 1;
	if (out_stats)
		*out_stats = (struct gz_frame_stats) { .bricks_coming = self->coming };
	return gz_image_resize(image, shot->plan->width, shot->plan->height);
}

static enum gz_result lacking_print(struct gz_drawer *drawer, const struct gz_print *print)
{
	(void)print;
	((struct lacking_drawer *)drawer)->printed++;
	return GZ_OK;
}

static bool lacking_keeps(const struct gz_drawer *drawer, const struct gz_shot *shot)
{
	(void)drawer, (void)shot;
	return false;
}

static unsigned lacking_texture(const struct gz_drawer *drawer)
{
	(void)drawer;
	return 0;
}

static const char *lacking_name(const struct gz_drawer *drawer)
{
	(void)drawer;
	return "cpu";
}

static void lacking_destroy(struct gz_drawer *drawer)
{
	(void)drawer;
}

static const struct gz_drawer_ops lacking_ops = {
	.show = lacking_show,
	.draw = lacking_draw,
	.print = lacking_print,
	.keeps_on_device = lacking_keeps,
	.picture_texture = lacking_texture,
	.backend = lacking_name,
	.describe = lacking_name,
	.destroy = lacking_destroy,
};

static enum gz_result lacking_check(const char *backend, const struct gz_backend_params *params,
				    const struct gz_log *log)
{
	(void)backend, (void)params, (void)log;
	return GZ_OK;
}

static enum gz_result lacking_create(const char *backend, const struct gz_backend_params *params,
				     const struct gz_log *log, struct gz_drawer **out_drawer)
{
	(void)backend, (void)params, (void)log;
	*out_drawer = &lacking.base;
	return GZ_OK;
}

/* Bricks that cannot be read never come; a print gives them up when nothing arrives any more. */
static void print_gives_up_what_does_not_arrive(void **state)
{
	(void)state;
	struct gz_technique technique = *gz_techniques[0];
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	const struct gz_print print = { "never.svg", 100, 300, 0.2 };
	struct set_up all;
	technique.check = lacking_check;
	technique.create = lacking_create;
	technique.bind = gz_techniques[0]->bind;
	lacking = (struct lacking_drawer) { .base = { &lacking_ops }, .coming = 30 };
	set_up(&all);
	all.object.technique = &technique;
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(gz_picture_print(all.maker, &all.request, &print), GZ_ERR_TIMEOUT);
	/* It waited as long as something arrived, 10 ms each, and then a fifth of a second. */
	assert_true(lacking.coming == 1 && lacking.drawn >= 30);
	assert_int_equal(lacking.printed, 0);
	assert_non_null(strstr(all.heard.text, "not printed"));
	lacking.coming = 0;
	assert_int_equal(gz_picture_print(all.maker, &all.request, &print), GZ_OK);
	assert_int_equal(lacking.printed, 1);
	take_down(&all);
}

static void auto_takes_the_cpu_without_a_gpu_and_logs_nothing(void **state)
{
	(void)state;
	const struct gz_picture_maker_params params = { .backend = "auto", .cpu_takes_over = true };
	struct set_up all;
	set_up(&all);
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	assert_string_equal(all.heard.text, "");
	take_down(&all);
}

static void graphics_memory_too_small_for_the_volume_shows_bricks(void **state)
{
	(void)state;
	struct gz_picture_maker_params params = { .backend = "gl", .cpu_takes_over = true };
	struct set_up all;
	set_up(&all);
	small_scene_free(&all.scene);
	all.scene = small_scene_waves(160, 130, 120, GZ_VOXEL_U8);
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	struct gz_image whole = copy_of(all.image);
	gz_picture_maker_destroy(&all.maker);
	assert_string_equal(all.heard.text, "");
	params.backend_params.gl_memory_bytes = (size_t)1 << 20;
	assert_int_equal(show(&all, &params), GZ_OK);
	do {
		assert_int_equal(make(&all), GZ_OK);
	} while (all.cost.stats.bricks_coming > 0);
	assert_string_equal(gz_picture_maker_backend(all.maker), "gl");
	assert_non_null(strstr(all.heard.text, "bricks"));
	long empty = 0, off = 0;
	for (int i = 0; i < WIDTH * HEIGHT * 4; i++) {
		empty += i % 4 < 3 ? whole.pixels[i] : 0;
		off += labs((long)whole.pixels[i] - all.image->pixels[i]);
	}
	if (4 * off > empty)
		fail_msg("differs by %ld of %ld", off, empty);
	gz_image_free(&whole);
	take_down(&all);
}

static void invalid_request_does_not_switch_to_the_cpu(void **state)
{
	(void)state;
	const struct gz_picture_maker_params params = { .backend = "gl", .cpu_takes_over = true };
	struct set_up all;
	set_up(&all);
	assert_int_equal(show(&all, &params), GZ_OK);
	all.scene.camera.fov_deg = 0;
	assert_int_equal(make(&all), GZ_ERR_INVAL);
	assert_string_equal(gz_picture_maker_backend(all.maker), "gl");
	take_down(&all);
}

static void strips_make_the_whole_picture(void **state)
{
	(void)state;
	enum { ROWS = 13 };
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct set_up all;
	set_up(&all);
	const struct gz_foveation full = gz_foveation_full();
	all.request.foveation = &full;
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	struct gz_image whole = copy_of(all.image);
	for (int top = 0; top < HEIGHT; top += ROWS) {
		const int rows = HEIGHT - top < ROWS ? HEIGHT - top : ROWS;
		all.request.strip.top = top;
		all.request.strip.rows = rows;
		assert_int_equal(make(&all), GZ_OK);
		assert_true(all.image->width == WIDTH && all.image->height == rows);
		assert_memory_equal(all.image->pixels, whole.pixels + (size_t)top * WIDTH * 4,
				    (size_t)rows * WIDTH * 4);
	}
	gz_image_free(&whole);
	take_down(&all);
}

static void objects_are_prepared_again_only_when_they_change(void **state)
{
	(void)state;
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct set_up all;
	set_up(&all);
	assert_int_equal(show(&all, &params), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	assert_true(all.cost.stats.prepare_ms > 0);
	struct gz_image before = copy_of(all.image);
	assert_int_equal(make(&all), GZ_OK);
	assert_true(all.cost.stats.prepare_ms == 0);
	/* unchanged by its revision: what it leads to is not looked at */
	all.scene.transfer.points[0].opacity = 0.9;
	all.scene.transfer.points[0].rgb[0] = 1;
	assert_int_equal(gz_picture_maker_show(all.maker, &all.object, 1), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	assert_memory_equal(before.pixels, all.image->pixels, (size_t)WIDTH * HEIGHT * 4);
	all.object.transfer_revision++;
	assert_int_equal(gz_picture_maker_show(all.maker, &all.object, 1), GZ_OK);
	assert_int_equal(make(&all), GZ_OK);
	assert_memory_not_equal(before.pixels, all.image->pixels, (size_t)WIDTH * HEIGHT * 4);
	gz_image_free(&before);
	take_down(&all);
}

/* Accumulated pictures are dropped when any setting but the camera changes. */
static void accumulation_starts_again_when_a_setting_changes(void **state)
{
	(void)state;
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	const struct gz_temporal_params temporal = { .accumulate = true, .weight = 0.9 };
	struct set_up all;
	set_up(&all);
	all.request.temporal = &temporal;
	assert_int_equal(show(&all, &params), GZ_OK);
	for (int change = 0; change < 4; change++) {
		assert_int_equal(make(&all), GZ_OK);
		assert_int_equal(make(&all), GZ_OK);
		assert_true(all.cost.kept);
		if (change == 0)
			all.scene.rays.background[0] = 0.5;
		else if (change == 1)
			all.scene.rays.clip.least[0] = 0.5;
		else if (change == 2)
			all.scene.foveation.acuity_slope *= 2;
		else
			all.scene.rays.light.ambient = 0.9;
		assert_int_equal(make(&all), GZ_OK);
		assert_false(all.cost.kept);
	}
	take_down(&all);
}

static void objects_that_no_technique_shows_are_refused(void **state)
{
	(void)state;
	const struct gz_picture_maker_params params = { .backend = "cpu" };
	struct gz_object objects[2];
	struct set_up all;
	set_up(&all);
	assert_int_equal(gz_picture_maker_create(&params, &all.log, &all.maker), GZ_OK);
	assert_int_equal(make(&all), GZ_ERR_INVAL); /* nothing is shown yet */
	assert_int_equal(gz_picture_maker_show(all.maker, &all.object, 0), GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(all.heard.text, "no object is visible; set visible = yes"));
	objects[0] = objects[1] = all.object;
	assert_int_equal(gz_picture_maker_show(all.maker, objects, 2), GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(all.heard.text, "at most 1 objects"));
	all.object.volume = NULL;
	assert_int_equal(gz_picture_maker_show(all.maker, &all.object, 1), GZ_ERR_UNSUPPORTED);
	assert_string_equal(gz_picture_maker_backend(all.maker), "");
	take_down(&all);
}

TEST_SUITE(picture_maker)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(strips_make_the_whole_picture),
		cmocka_unit_test(objects_are_prepared_again_only_when_they_change),
		cmocka_unit_test(accumulation_starts_again_when_a_setting_changes),
		cmocka_unit_test(objects_that_no_technique_shows_are_refused),
	};
	const struct CMUnitTest on_gl[] = {
		cmocka_unit_test(cpu_takes_over_after_a_lost_context),
		cmocka_unit_test(lost_context_is_returned_if_the_request_says_so),
		cmocka_unit_test(print_gives_up_what_does_not_arrive),
		cmocka_unit_test(auto_takes_the_cpu_without_a_gpu_and_logs_nothing),
		cmocka_unit_test(graphics_memory_too_small_for_the_volume_shows_bricks),
		cmocka_unit_test(invalid_request_does_not_switch_to_the_cpu),
	};
	struct gz_gl_context *context = NULL;
	char reason[200];
	if (cmocka_run_group_tests(tests, NULL, NULL) != 0)
		return 1;
	if (gz_gl_context_egl(false, &context, reason, sizeof reason) != GZ_OK) {
		fprintf(stderr, "skipped: %s\n", reason);
		return 77;
	}
	gz_gl_context_destroy(&context);
	return cmocka_run_group_tests(on_gl, NULL, NULL);
}
