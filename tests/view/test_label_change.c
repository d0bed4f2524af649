/* Surfaces of labels that are made again beside the frames, as the window does it. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "place.h"
#include "protocol/display.h"
#include "render/technique/technique.h"
#include "view/frame/frame.h"

enum { WIDTH = 64, HEIGHT = 48, BYTES = 4 * WIDTH * HEIGHT };

/* A frame maker over a ball in two halves, labels 5 and 9. */
struct changing {
	struct captured_log captured;
	struct gz_view_options options;
	struct gz_frame_maker *maker;
	struct gz_scene_settings settings;
	struct gz_frame_record record; /* of the last picture */
};

static const char *write_ball(void)
{
	enum { EDGE = 16 };
	FILE *file = fopen(write_in_place("ball.nrrd", ""), "wb");
	assert_non_null(file);
	fputs("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n\n", file);
	for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
		const int x = i % EDGE, y = i / EDGE % EDGE, z = i / EDGE / EDGE;
		const int a = 2 * x - 15, b = 2 * y - 15, c = 2 * z - 15;
		const int label = x < EDGE / 2 ? 5 : 9;
		fputc(a * a + b * b + c * c > 144 ? 0 : label, file);
	}
	fclose(file);
	return write_in_place("ball.scene",
			      "[object ball]\nlabels = ball.nrrd\ntechnique = isosurface\n"
			      "[labels]\nsmoothing = 0\n");
}

static void begin_changing(struct changing *all)
{
	const char *path = write_ball();
	captured_log_init(&all->captured, "*:warn");
	const char *const arguments[] = { "gazeview", "--headless", "--backend", "cpu",
					  "--size",   "64x48",      path,        NULL };
	assert_int_equal(gz_view_options_read(7, (char *const *)arguments, NULL, &all->options),
			 GZ_OK);
	const struct gz_frame_scene scene = gz_frame_scene_of_options(&all->options);
	assert_int_equal(
		gz_frame_maker_create(&all->options, &scene, NULL, &all->captured.log, &all->maker),
		GZ_OK);
	all->settings = gz_frame_maker_scene(all->maker)->settings;
}

static void make_frame(struct changing *all, uint8_t out_pixels[BYTES])
{
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	const struct gz_frame_request request = {
		.settings = &all->settings,
		.display = &display,
		.width = WIDTH,
		.height = HEIGHT,
	};
	struct gz_image *image = NULL;
	assert_int_equal(gz_frame_make(all->maker, &request, &image, &all->record), GZ_OK);
	memcpy(out_pixels, image->pixels, BYTES);
}

/* Ask until it is no longer being made, with a frame each time. */
static enum gz_frame_ready make_ready(struct changing *all, uint8_t out_pixels[BYTES])
{
	enum gz_frame_ready far;
	while ((far = gz_frame_prepare_labels(all->maker, &all->settings, NULL)) ==
	       GZ_FRAME_PREPARING) {
		make_frame(all, out_pixels);
		assert_true(all->record.prepare_ms == 0);
	}
	return far;
}

static void surfaces_are_made_beside_the_frames(void **state)
{
	static uint8_t before[BYTES], during[BYTES], after[BYTES], again[BYTES];
	struct changing all = { 0 };
	(void)state;
	begin_changing(&all);
	if (gz_frame_maker_start(all.maker, &all.options, NULL) != GZ_OK) {
		gz_frame_maker_destroy(&all.maker);
		skip(); /* built without Embree */
	}
	make_frame(&all, before);
	memcpy(during, before, BYTES);
	/* Frames show what they did until it is asked for, and then need not wait. */
	all.settings.labels.smoothing = 9;
	assert_int_equal(make_ready(&all, during), GZ_FRAME_READY);
	assert_memory_equal(before, during, BYTES);
	assert_int_equal(gz_frame_maker_scene(all.maker)->settings.labels.smoothing, 0);
	assert_int_equal(gz_frame_show_labels(all.maker), GZ_OK);
	assert_int_equal(gz_frame_maker_scene(all.maker)->settings.labels.smoothing, 9);
	make_frame(&all, after);
	assert_true(all.record.prepare_ms == 0);
	assert_memory_not_equal(before, after, BYTES);
	assert_int_equal(gz_frame_show_labels(all.maker), GZ_ERR_INVAL);
	/* One that is given up, and the one that counts. */
	all.settings.labels.smoothing = 30;
	assert_int_equal(gz_frame_prepare_labels(all.maker, &all.settings, NULL),
			 GZ_FRAME_PREPARING);
	all.settings.labels.smoothing = 0;
	assert_int_equal(make_ready(&all, during), GZ_FRAME_READY);
	assert_false(gz_frame_making_labels(all.maker));
	/* A renderer that starts anew shows what was made. */
	gz_frame_maker_stop(all.maker);
	assert_int_equal(gz_frame_maker_start(all.maker, &all.options, NULL), GZ_OK);
	assert_int_equal(gz_frame_show_labels(all.maker), GZ_OK);
	make_frame(&all, again);
	assert_memory_equal(before, again, BYTES);
	/* A thread that runs is waited for at the end. */
	all.settings.labels.smoothing = 5;
	(void)gz_frame_prepare_labels(all.maker, &all.settings, NULL);
	gz_frame_maker_destroy(&all.maker);
}

static void what_cannot_be_made_is_told_once_and_changes_nothing(void **state)
{
	struct changing all = { 0 };
	(void)state;
	begin_changing(&all);
	snprintf(all.settings.labels.names, sizeof all.settings.labels.names, "nowhere");
	enum gz_frame_ready far;
	while ((far = gz_frame_prepare_labels(all.maker, &all.settings, NULL)) ==
	       GZ_FRAME_PREPARING)
		;
	assert_int_equal(far, GZ_FRAME_CANNOT_WAIT);
	assert_int_equal(all.captured.messages, 1);
	assert_int_equal(gz_frame_show_labels(all.maker), GZ_ERR_INVAL);
	assert_string_equal(gz_frame_maker_scene(all.maker)->settings.labels.names, "");
	gz_frame_drop_labels(all.maker);
	gz_frame_maker_destroy(&all.maker);
}

static int open_place(void **state)
{
	(void)state;
	return create_place();
}

TEST_SUITE(label_change)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(surfaces_are_made_beside_the_frames),
		cmocka_unit_test(what_cannot_be_made_is_told_once_and_changes_nothing),
	};
	return cmocka_run_group_tests(tests, open_place, remove_place);
}
