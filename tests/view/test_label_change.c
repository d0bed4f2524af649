/* Surfaces of labels that are made again beside the frames, as the window does it. */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "made_frames.h"
#include "place.h"
#include "render/technique/technique.h"

/* A ball in two halves, labels 5 and 9. */
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

/* Ask until it is no longer being made, with a frame each time. */
static enum gz_frame_ready make_ready(struct made_frames *all, uint8_t out_pixels[BYTES])
{
	enum gz_frame_ready far;
	while ((far = gz_frame_prepare_labels(all->maker, &all->settings, NULL)) ==
	       GZ_FRAME_PREPARING) {
		draw_frame(all, out_pixels);
		assert_true(all->record.prepare_ms == 0);
	}
	return far;
}

static void surfaces_are_made_beside_the_frames(void **state)
{
	static uint8_t before[BYTES], during[BYTES], after[BYTES], again[BYTES];
	struct made_frames all = { 0 };
	(void)state;
	create_frames(&all, write_ball(), "cpu");
	if (gz_frame_maker_start(all.maker, &all.options, NULL) != GZ_OK) {
		gz_frame_maker_destroy(&all.maker);
		skip(); /* built without Embree */
	}
	draw_frame(&all, before);
	memcpy(during, before, BYTES);
	/* Frames show what they did until it is asked for, and then need not wait. */
	all.settings.labels.smoothing = 9;
	assert_int_equal(make_ready(&all, during), GZ_FRAME_READY);
	assert_memory_equal(before, during, BYTES);
	assert_int_equal(gz_frame_maker_scene(all.maker)->settings.labels.smoothing, 0);
	assert_int_equal(gz_frame_show_labels(all.maker), GZ_OK);
	assert_int_equal(gz_frame_maker_scene(all.maker)->settings.labels.smoothing, 9);
	draw_frame(&all, after);
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
	draw_frame(&all, again);
	assert_memory_equal(before, again, BYTES);
	/* A thread that runs is waited for at the end. */
	all.settings.labels.smoothing = 5;
	(void)gz_frame_prepare_labels(all.maker, &all.settings, NULL);
	gz_frame_maker_destroy(&all.maker);
}

static void what_cannot_be_made_is_told_once_and_changes_nothing(void **state)
{
	struct made_frames all = { 0 };
	(void)state;
	create_frames(&all, write_ball(), "cpu");
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
