/* Settings that follow what is seen: slowly, within limits, without jumps; and what is measured. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/illustration/illustration_automatic.h"

#define FRAME_NS (16 * GZ_NS_PER_MS)

/* What a picture may be like: nothing stands out. */
static const struct gz_shading_measures medium = {
	.covered = 0.3,
	.tone_spread = 0.2,
	.tone_fine = 0.03,
	.tone_wide = 0.1,
	.depth_middle = 0.3,
	.depth_spread = 0.25,
	.edges = 20,
};

static struct gz_illustration_look automatic_look(void)
{
	struct gz_illustration_look look;
	struct gz_option_binding bindings[GZ_ILLUSTRATION_BINDINGS];
	memset(&look, 0, sizeof look);
	gz_illustration_look_bind(&look, bindings);
	for (int i = 0; i < GZ_ILLUSTRATION_BINDINGS; i++)
		assert_int_equal(gz_options_preset(&bindings[i]), GZ_OK);
	look.automatic = true;
	return look;
}

static struct gz_illustration_automatic steps(struct gz_illustration_automatic state,
					      const struct gz_illustration_look *look,
					      const struct gz_shading_measures *measures, int count)
{
	for (int i = 0; i < count; i++)
		state = gz_illustration_automatic_step(state, look, measures,
						       state.now_ns + FRAME_NS);
	return state;
}

static struct gz_illustration_automatic begun(const struct gz_illustration_look *look)
{
	return steps((struct gz_illustration_automatic) { 0 }, look, NULL, 1);
}

static void a_medium_picture_changes_nothing(void **state)
{
	(void)state;
	static const struct gz_illustration_change none;
	const struct gz_illustration_look look = automatic_look();
	struct gz_illustration_automatic automatic = begun(&look);
	assert_true(automatic.moving); /* until the first frame is measured */
	automatic = steps(automatic, &look, &medium, 200);
	assert_true(gz_illustration_change_same(&automatic.change, &none));
	assert_false(automatic.moving);
}

static void each_setting_follows_its_measure(void **state)
{
	(void)state;
	const struct gz_illustration_look look = automatic_look();
	struct gz_shading_measures flat = medium, rough = medium, deep = medium, lined = medium;
	flat.tone_spread = 0;
	rough.tone_fine = 0.09;
	deep.depth_spread = 0.6;
	deep.depth_middle = 0.5;
	lined.edges = 200;
	assert_float_equal(steps(begun(&look), &look, &flat, 400).change.detail_amplitude,
			   GZ_AUTOMATIC_MOST, 0.005);
	assert_float_equal(steps(begun(&look), &look, &rough, 400).change.detail_frequency,
			   -GZ_AUTOMATIC_MOST, 0.005);
	const struct gz_illustration_change far = steps(begun(&look), &look, &deep, 400).change;
	assert_float_equal(far.spatial_effect, GZ_AUTOMATIC_MOST, 0.005);
	assert_float_equal(GZ_HAZE_NEAR_OF_FOREGROUND * (0.5 + far.foreground), 0.5, 0.005);
	assert_true(steps(begun(&look), &look, &lined, 400).change.edge_emphasis < -0.3);
}

static void settings_move_at_a_limited_speed_and_settle(void **state)
{
	(void)state;
	const struct gz_illustration_look look = automatic_look();
	struct gz_illustration_automatic before = begun(&look);
	struct gz_shading_measures flat = medium;
	flat.tone_spread = 0;
	int moved = 0;
	for (int i = 0; i < 400; i++) {
		const struct gz_illustration_automatic now = steps(before, &look, &flat, 1);
		const double step = now.change.detail_amplitude - before.change.detail_amplitude;
		assert_true(step >= 0 && step <= GZ_AUTOMATIC_SPEED * 0.016 + 1e-12);
		moved += now.moving;
		before = now;
	}
	assert_true(moved > 50 && moved < 200);
	assert_false(before.moving);
	/* After a pause of an hour it moves by no more than in a tenth of a second. */
	const struct gz_illustration_automatic woken = gz_illustration_automatic_step(
		before, &look, &medium, before.now_ns + 3600 * GZ_NS_PER_S);
	assert_true(before.change.detail_amplitude - woken.change.detail_amplitude <=
		    GZ_AUTOMATIC_SPEED * 0.1 + 1e-12);
	/* Time does not run back. */
	const struct gz_illustration_automatic back =
		gz_illustration_automatic_step(woken, &look, &medium, 5);
	assert_true(gz_illustration_change_same(&back.change, &woken.change));
	assert_true(back.now_ns == woken.now_ns);
}

/* A frame that shows another view says that more are to follow, and changes nothing itself. */
static void another_view_is_noticed_before_time_passes(void **state)
{
	(void)state;
	const struct gz_illustration_look look = automatic_look();
	const struct gz_illustration_automatic still = steps(begun(&look), &look, &medium, 200);
	struct gz_shading_measures flat = medium;
	flat.tone_spread = 0;
	const struct gz_illustration_automatic noticed =
		gz_illustration_automatic_step(still, &look, &flat, still.now_ns);
	assert_false(still.moving);
	assert_true(noticed.moving);
	assert_true(gz_illustration_change_same(&noticed.change, &still.change));
}

/* A picture that answers to the setting: the more amplitude, the wider its tones. */
static void a_picture_that_answers_settles_too(void **state)
{
	(void)state;
	const struct gz_illustration_look look = automatic_look();
	struct gz_illustration_automatic automatic = begun(&look);
	double last = 0;
	for (int i = 0; i < 500; i++) {
		struct gz_shading_measures answer = medium;
		answer.tone_spread = 0.05 + 0.5 * automatic.change.detail_amplitude;
		last = automatic.change.detail_amplitude;
		automatic = steps(automatic, &look, &answer, 1);
		assert_true(automatic.change.detail_amplitude >= last);
	}
	assert_false(automatic.moving);
	assert_true(last > 0.1 && last < 0.2);
}

static void nothing_jumps_by_whole_steps_and_all_stays_in_range(void **state)
{
	(void)state;
	struct gz_shading_measures measures = medium;
	for (int set = 0; set <= 40; set++)
		for (int end = 0; end < 2; end++) {
			struct gz_illustration_look look = automatic_look(), changed;
			struct gz_shading_settings plain, adapted;
			look.combined.edge_emphasis = look.combined.detail_amplitude = set / 40.0;
			look.combined.detail_frequency = look.combined.foreground = set / 40.0;
			look.combined.spatial_effect = set / 40.0;
			measures.edges = end ? 0 : 1000;
			measures.tone_spread = end ? 0 : 1;
			measures.depth_middle = measures.depth_spread = end ? 0 : 1;
			measures.tone_fine = end ? 0 : 1;
			const struct gz_illustration_automatic automatic =
				steps(begun(&look), &look, &measures, 400);
			assert_true(gz_illustration_change_valid(&automatic.change));
			changed = look;
			gz_illustration_adapt(&automatic.change, &changed);
			gz_illustration_look_resolve(&look, NULL, &plain);
			gz_illustration_look_resolve(&changed, NULL, &adapted);
			assert_true(gz_illustration_look_valid(&changed));
			assert_int_equal(adapted.line_width, plain.line_width);
			assert_int_equal(adapted.main_light_smoothing, plain.main_light_smoothing);
		}
}

static void looks_that_do_not_ask_stay_as_they_are(void **state)
{
	(void)state;
	const struct gz_illustration_change change = { -0.1, 0.2, 0.1, -0.2, 0.3 };
	struct gz_illustration_look off = automatic_look(), single = off, alone = off;
	struct gz_illustration_automatic moved = begun(&off);
	off.automatic = false;
	single.source = GZ_ILLUSTRATION_SINGLE;
	alone.show = GZ_SHOW_PLAIN;
	moved.change = change;
	const struct gz_illustration_look *const looks[] = { &off, &single, &alone };
	for (int i = 0; i < 3; i++) {
		struct gz_illustration_look same = *looks[i];
		gz_illustration_adapt(&change, &same);
		assert_true(gz_illustration_look_same(&same, looks[i]));
		assert_false(steps(moved, looks[i], &medium, 1).started);
	}
}

static void a_template_is_what_is_changed(void **state)
{
	(void)state;
	const struct gz_illustration_change change = { .detail_amplitude = 0.2 };
	struct gz_illustration_look look = automatic_look();
	snprintf(look.template_name, sizeof look.template_name, "organs");
	assert_int_equal(gz_shading_template_named("organs", &look.shading_template), GZ_OK);
	struct gz_illustration_settings set = look.combined;
	gz_shading_template_apply(&look.shading_template, &set);
	gz_illustration_adapt(&change, &look);
	assert_float_equal(look.combined.edge_emphasis, set.edge_emphasis, 0);
	assert_float_equal(look.combined.detail_amplitude, set.detail_amplitude + 0.2, 1e-12);
	assert_int_equal(look.template_name[0], '\0');
}

enum { WIDTH = 400, HEIGHT = 300 };

/* A frame of one slanted plane with tones that rise to the right, and a strip of another object. */
static void measures_are_those_of_the_frame(void **state)
{
	(void)state;
	float *tone = calloc(WIDTH * HEIGHT, sizeof *tone);
	float *depth = calloc(WIDTH * HEIGHT, sizeof *depth);
	uint32_t *ids = calloc(WIDTH * HEIGHT, sizeof *ids);
	const struct gz_shading_frame frame = { .width = WIDTH,
						.height = HEIGHT,
						.tone = tone,
						.depth = depth,
						.ids = ids,
						.near = 100,
						.far = 200 };
	struct gz_shading_measures measures;
	assert_true(tone && depth && ids);
	gz_shading_measure(&frame, &measures);
	assert_true(measures.covered == 0 && measures.edges == 0 && measures.tone_spread == 0);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 100; x < 300; x++) {
			const int at = y * WIDTH + x;
			ids[at] = x < 200 ? 1 : 2;
			tone[at] = (float)(x - 100) / 200;
			depth[at] = 110 + 40 * (float)(x - 100) / 200;
		}
	gz_shading_measure(&frame, &measures);
	assert_float_equal(measures.covered, 0.5, 0.01);
	assert_float_equal(measures.tone_spread, 0.8, 0.02);
	assert_float_equal(measures.depth_middle, 0.3, 0.01);
	assert_float_equal(measures.depth_spread, 0.32, 0.01);
	/* 1 and 8 pixels apart, of which half look along the tones. */
	assert_float_equal(measures.tone_fine, 1 / 200.0 / sqrt(2), 1e-3);
	assert_float_equal(measures.tone_wide, 8 / 200.0 / sqrt(2), 2e-3);
	/* The strip's end and the right rim, both vertical: 2 heights over 2 / 3 of a height. */
	assert_float_equal(measures.edges * 4 / M_PI, 3, 0.1);
	/* A step of depth is an edge, too. */
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		depth[i] += i % WIDTH >= 150 ? 10.0F : 0;
	const double before = measures.edges;
	gz_shading_measure(&frame, &measures);
	assert_float_equal((measures.edges - before) * 4 / M_PI, 1.5, 0.1);
	free(tone);
	free(depth);
	free(ids);
}

TEST_SUITE(illustration_automatic)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_medium_picture_changes_nothing),
		cmocka_unit_test(each_setting_follows_its_measure),
		cmocka_unit_test(settings_move_at_a_limited_speed_and_settle),
		cmocka_unit_test(another_view_is_noticed_before_time_passes),
		cmocka_unit_test(a_picture_that_answers_settles_too),
		cmocka_unit_test(nothing_jumps_by_whole_steps_and_all_stays_in_range),
		cmocka_unit_test(looks_that_do_not_ask_stay_as_they_are),
		cmocka_unit_test(a_template_is_what_is_changed),
		cmocka_unit_test(measures_are_those_of_the_frame),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
