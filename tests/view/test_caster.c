/* What casts the frames: the backend asked for and, where it fails for good, cpu. */
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/gl/context_egl.h"
#include "render/lent_context.h"
#include "render/small_scene.h"
#include "view/caster.h"
#include "view/frame.h"

/* Keeps the messages. */
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

/* A caster over a small scene, with all it needs. */
struct set_up {
	struct small_scene small;
	struct gz_scene scene;
	struct gz_view_options options;
	struct gz_plan plan;
	struct heard heard;
	struct gz_log log;
	struct gz_caster caster;
};

static void set_up(struct set_up *all, const char *backend)
{
	memset(all, 0, sizeof *all);
	all->small = small_scene_waves(20, 24, 18, GZ_VOXEL_U8);
	all->scene.volume = all->small.volume;
	all->scene.transfer = all->small.transfer;
	all->scene.settings.camera = all->small.camera;
	all->scene.settings.rays = all->small.rays;
	snprintf(all->options.backend, sizeof all->options.backend, "%s", backend);
	snprintf(all->options.simd, sizeof all->options.simd, "auto");
	gz_log_init(&all->log, hear, &all->heard, "info");
	const struct gz_display display = gz_display_default(64, 48);
	assert_int_equal(
		gz_plan_make(&all->small.foveation, &display, all->small.gaze, 64, 48, &all->plan),
		GZ_OK);
}

static void take_down(struct set_up *all)
{
	gz_caster_free(&all->caster);
	gz_plan_free(&all->plan);
	small_scene_free(&all->small);
}

static void lost_context_costs_no_frame(void **state)
{
	(void)state;
	struct lent_context lent = lend_context();
	struct set_up all;
	struct gz_image before = { 0 }, after = { 0 };
	struct gz_frame_stats stats;
	set_up(&all, "gl");
	assert_int_equal(
		gz_caster_start(&all.caster, &all.options, &lent.base, &all.scene, &all.log),
		GZ_OK);
	assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan, false,
					  &before, &stats),
			 GZ_OK);
	assert_int_equal(
		gz_caster_render(&all.caster, &all.scene.settings, &all.plan, true, &after, &stats),
		GZ_OK);
	assert_true(all.caster.on_device);
	assert_null(after.pixels);
	lent.lost = true;
	for (int frame = 0; frame < 2; frame++) {
		assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan, true,
						  &after, &stats),
				 GZ_OK);
		assert_false(all.caster.on_device);
		assert_string_equal(all.caster.renderer->ops->name, "cpu");
		int x = 0, y = 0;
		assert_true(image_difference(&before, &after, &x, &y) <= 1);
	}
	if (!strstr(all.heard.text, "context") || !strstr(all.heard.text, "cpu backend"))
		fail_msg("'%s' tells neither loss nor remedy", all.heard.text);
	gz_image_free(&before);
	gz_image_free(&after);
	take_down(&all);
	gz_gl_context_destroy(&lent.egl);
}

/* A maker of frames over a scene made by formula. */
static struct gz_frame_maker *make_maker(struct set_up *all)
{
	static const char transfer[] = "0 0 0 0 0\n1 1 1 1 0.1\n";
	struct gz_frame_maker *maker = NULL;
	char folder[] = "/tmp/gz_casterXXXXXX", path[64];
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/a.tf", folder);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(transfer, file);
	fclose(file);
	snprintf(all->options.scene, sizeof all->options.scene, "%s/a.scene", folder);
	file = fopen(all->options.scene, "w");
	assert_non_null(file);
	fputs("[volume]\nprocedural = shells\ndims = 20 20 20\n[transfer]\nfile = a.tf\n", file);
	fclose(file);
	all->options.method = -1;
	const struct gz_frame_scene scene = gz_frame_scene_of_options(&all->options);
	if (gz_frame_maker_create(&all->options, &scene, NULL, &all->log, &maker) != GZ_OK)
		fail_msg("%s", all->heard.text);
	unlink(path);
	unlink(all->options.scene);
	rmdir(folder);
	return maker;
}

static void frame_returns_the_loss_of_a_context_to_who_asks_for_it(void **state)
{
	(void)state;
	struct set_up all;
	set_up(&all, "gl");
	struct gz_frame_maker *maker = make_maker(&all);
	const struct gz_display display = gz_display_default(64, 48);
	for (int callers = 0; callers < 2; callers++) {
		struct lent_context lent = lend_context();
		const struct gz_frame_request request = {
			.settings = &gz_frame_maker_scene(maker)->settings,
			.display = &display,
			.width = 64,
			.height = 48,
			.on_device = true,
			.loss_is_callers = callers,
		};
		struct gz_frame_record record;
		struct gz_image *image;
		assert_int_equal(gz_frame_maker_start(maker, &all.options, &lent.base), GZ_OK);
		assert_int_equal(gz_frame_make(maker, &request, &image, &record), GZ_OK);
		assert_string_equal(record.backend, "gl");
		lent.lost = true;
		const enum gz_result result = gz_frame_make(maker, &request, &image, &record);
		assert_int_equal(result, callers ? GZ_ERR_NO_DEVICE : GZ_OK);
		if (!callers)
			assert_string_equal(record.backend, "cpu");
		gz_frame_maker_stop(maker);
		gz_gl_context_destroy(&lent.egl);
	}
	gz_frame_maker_destroy(&maker);
	take_down(&all);
}

static void auto_takes_the_cpu_where_no_gpu_is_and_says_nothing(void **state)
{
	(void)state;
	struct set_up all;
	struct gz_image image = { 0 };
	struct gz_frame_stats stats;
	set_up(&all, "auto");
	assert_int_equal(gz_caster_start(&all.caster, &all.options, NULL, &all.scene, &all.log),
			 GZ_OK);
	assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan, false,
					  &image, &stats),
			 GZ_OK);
	assert_string_equal(all.heard.text, "");
	gz_image_free(&image);
	take_down(&all);
}

static void graphics_memory_too_small_for_the_volume_shows_bricks(void **state)
{
	(void)state;
	struct set_up all;
	struct gz_image whole = { 0 }, image = { 0 };
	struct gz_frame_stats stats;
	set_up(&all, "gl");
	small_scene_free(&all.small);
	all.small = small_scene_waves(160, 130, 120, GZ_VOXEL_U8);
	all.scene.volume = all.small.volume;
	assert_int_equal(gz_caster_start(&all.caster, &all.options, NULL, &all.scene, &all.log),
			 GZ_OK);
	assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan, false,
					  &whole, &stats),
			 GZ_OK);
	gz_caster_free(&all.caster);
	assert_string_equal(all.heard.text, "");
	all.options.gl_memory_mib = 1;
	assert_int_equal(gz_caster_start(&all.caster, &all.options, NULL, &all.scene, &all.log),
			 GZ_OK);
	do {
		assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan,
						  false, &image, &stats),
				 GZ_OK);
	} while (stats.bricks_coming > 0);
	assert_string_equal(all.caster.renderer->ops->name, "gl");
	assert_non_null(strstr(all.heard.text, "bricks"));
	long empty = 0, off = 0;
	for (int i = 0; i < 64 * 48 * 4; i++) {
		empty += i % 4 < 3 ? whole.pixels[i] : 0;
		off += labs((long)whole.pixels[i] - image.pixels[i]);
	}
	if (4 * off > empty)
		fail_msg("differs by %ld of %ld", off, empty);
	gz_image_free(&whole);
	gz_image_free(&image);
	take_down(&all);
}

static void wrong_request_is_no_reason_to_take_the_cpu(void **state)
{
	(void)state;
	struct set_up all;
	struct gz_image image = { 0 };
	struct gz_frame_stats stats;
	set_up(&all, "gl");
	assert_int_equal(gz_caster_start(&all.caster, &all.options, NULL, &all.scene, &all.log),
			 GZ_OK);
	all.scene.settings.camera.fov_deg = 0;
	assert_int_equal(gz_caster_render(&all.caster, &all.scene.settings, &all.plan, false,
					  &image, &stats),
			 GZ_ERR_INVAL);
	assert_string_equal(all.caster.renderer->ops->name, "gl");
	gz_image_free(&image);
	take_down(&all);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lost_context_costs_no_frame),
		cmocka_unit_test(frame_returns_the_loss_of_a_context_to_who_asks_for_it),
		cmocka_unit_test(auto_takes_the_cpu_where_no_gpu_is_and_says_nothing),
		cmocka_unit_test(graphics_memory_too_small_for_the_volume_shows_bricks),
		cmocka_unit_test(wrong_request_is_no_reason_to_take_the_cpu),
	};
	struct gz_gl_context *context = NULL;
	char reason[200];
	if (gz_gl_context_egl(false, &context, reason, sizeof reason) != GZ_OK) {
		fprintf(stderr, "skipped: %s\n", reason);
		return 77;
	}
	gz_gl_context_destroy(&context);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
