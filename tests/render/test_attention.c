/* How the plan follows the eye: each rule by a sequence made for it. */
#include "suite.h"

#include <math.h>

#include "base/clock.h"
#include "render/attention/attention.h"

/* One frame of 60 a second. */
#define FRAME_NS (GZ_NS_PER_S / 60)

/* A degree at the centre of this display is 1/50.4 of its width, nearly. */
static struct gz_display display;
static struct gz_attention attention;
static struct gz_attention_params params;
static int64_t now_ns;

static int begin(void **state)
{
	(void)state;
	display = gz_display_default(1920, 1080);
	params = gz_attention_default();
	gz_attention_init(&attention, &params);
	now_ns = INT64_C(77000000001);
	return 0;
}

/* A place so many degrees to the right of the display's centre. */
static struct gz_point at_deg(double deg)
{
	double mm = display.distance_mm * tan(deg * (3.141592653589793 / 180));
	return (struct gz_point) { (float)(0.5 + mm / display.mm[0]), 0.5f };
}

static struct gz_attention_gaze gaze_of(enum gz_event event, struct gz_point point)
{
	return (struct gz_attention_gaze) {
		.known = true,
		.point = point,
		.has_age = true,
		.age_ns = 3 * GZ_NS_PER_MS,
		.has_event = true,
		.event = event,
		.noise_deg = 0.1,
	};
}

static struct gz_focus step(const struct gz_attention_gaze *gaze)
{
	now_ns += FRAME_NS;
	return gz_attention_step(&attention, gaze, &display, now_ns);
}

static struct gz_focus step_event(enum gz_event event, double deg)
{
	const struct gz_attention_gaze gaze = gaze_of(event, at_deg(deg));
	return step(&gaze);
}

/* Repeats a frame for some ms; returns the focus of the last one. */
static struct gz_focus go_on(enum gz_event event, double deg, double ms)
{
	int64_t end_ns = now_ns + (int64_t)(ms * (double)GZ_NS_PER_MS);
	struct gz_focus focus = { .scale = NAN };
	while (now_ns + FRAME_NS <= end_ns)
		focus = step_event(event, deg);
	return focus;
}

static void assert_sharp_at(const struct gz_focus *focus, double deg)
{
	struct gz_point point = at_deg(deg);
	if (focus->point.x != point.x || focus->point.y != point.y || focus->scale != 1 ||
	    focus->widen != 0)
		fail_msg("sharp at %g %g, scale %g, widen %g; wanted at %g %g",
			 (double)focus->point.x, (double)focus->point.y, focus->scale, focus->widen,
			 (double)point.x, (double)point.y);
}

static void assert_same(const struct gz_focus *a, const struct gz_focus *b)
{
	if (!gz_focus_same(a, b))
		fail_msg("%g %g scale %g widen %g is not %g %g scale %g widen %g",
			 (double)a->point.x, (double)a->point.y, a->scale, a->widen,
			 (double)b->point.x, (double)b->point.y, b->scale, b->widen);
}

static void first_gaze_is_sharp_where_it_is(void **state)
{
	(void)state;
	struct gz_focus focus = step_event(GZ_EVENT_FIXATION, 7);
	assert_sharp_at(&focus, 7);
	assert_int_equal(attention.state, GZ_ATTENTION_FIXATION);
	assert_true(gz_attention_settled(&attention));
}

static void gaze_within_the_dead_band_changes_nothing(void **state)
{
	(void)state;
	struct gz_focus first = go_on(GZ_EVENT_FIXATION, 3, 100);
	for (int i = 0; i < 100; i++) {
		struct gz_focus focus =
			step_event(GZ_EVENT_FIXATION, 3 + 0.48 * sin(0.7 * (double)i));
		assert_same(&focus, &first);
	}
	struct gz_focus beyond = step_event(GZ_EVENT_FIXATION, 3.55);
	assert_sharp_at(&beyond, 3.55);
}

static void landing_is_followed_until_the_eye_could_see_it(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, -5, 200);
	for (int i = 0; i < 4; i++) { /* 0 to 50 ms after it */
		struct gz_focus focus = step_event(GZ_EVENT_FIXATION, 5 + 0.1 * (double)i);
		assert_sharp_at(&focus, 5 + 0.1 * (double)i);
	}
	step_event(GZ_EVENT_FIXATION, 5.3);
	for (int i = 0; i < 10; i++) {
		struct gz_focus focus = step_event(GZ_EVENT_FIXATION, 5.3 + 0.04 * (double)i);
		assert_sharp_at(&focus, 5.3);
	}
}

static void dead_band_grows_with_the_noise_up_to_a_limit(void **state)
{
	(void)state;
	const struct {
		double deg, by_noise, noise_deg, wanted_deg;
	} cases[] = {
		{ 0.5, 2, 0.1, 0.5 }, { 0.5, 2, 0.4, 0.8 }, { 0.5, 2, 5, 1.5 },
		{ 0.5, 2, NAN, 0.5 }, { 0.5, 0, 5, 0.5 },   { 3, 2, 2, 3 },
		{ 0, 0, 1, 0 },       { 0.5, 2, -1, 0.5 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_attention_params tried = params;
		tried.dead_band_deg = cases[i].deg;
		tried.dead_band_noise = cases[i].by_noise;
		double band_deg = gz_attention_dead_band_deg(&tried, cases[i].noise_deg);
		if (band_deg != cases[i].wanted_deg)
			fail_msg("case %zu: %g, not %g", i, band_deg, cases[i].wanted_deg);
	}
}

static void gaze_without_a_tracker_is_followed_by_the_pixel(void **state)
{
	(void)state;
	struct gz_attention_gaze mouse = { .known = true, .noise_deg = NAN };
	for (int i = 0; i < 20; i++) {
		mouse.point = at_deg(0.1 * (double)i);
		struct gz_focus focus = step(&mouse);
		assert_sharp_at(&focus, 0.1 * (double)i);
	}
	assert_true(gz_attention_settled(&attention));
}

static void saccade_is_coarse_on_its_way_and_sharp_with_the_landing_sample(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, -10, 300);
	for (int i = 1; i <= 4; i++) {
		struct gz_focus way = step_event(GZ_EVENT_SACCADE, -10 + 4.5 * i);
		struct gz_point point = at_deg(-10 + 4.5 * i);
		assert_true(way.point.x == point.x && way.point.y == point.y);
		assert_true(way.scale == params.saccade_scale && way.widen == 0);
		assert_false(gz_attention_settled(&attention));
	}
	struct gz_focus landing = step_event(GZ_EVENT_FIXATION, 10);
	assert_sharp_at(&landing, 10);
}

static void landing_within_the_dead_band_of_the_way_is_sharp_too(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, 0, 100);
	step_event(GZ_EVENT_SACCADE, 5);
	struct gz_focus landing = step_event(GZ_EVENT_FIXATION, 5.1);
	assert_sharp_at(&landing, 5.1);
	step_event(GZ_EVENT_SACCADE, 9);
	landing = step_event(GZ_EVENT_PURSUIT, 9.1); /* on something that moves */
	assert_sharp_at(&landing, 9.1);
}

static void saccade_between_two_frames_is_sharp_at_its_end(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, -4, 100);
	struct gz_focus landing = step_event(GZ_EVENT_FIXATION, 4);
	assert_sharp_at(&landing, 4);
}

static void saccade_that_goes_nowhere_changes_nothing(void **state)
{
	(void)state;
	struct gz_focus still = go_on(GZ_EVENT_FIXATION, 2, 100);
	for (int i = 0; i < 4; i++) {
		struct gz_focus focus = step_event(GZ_EVENT_SACCADE, 2 + 0.1 * (double)i);
		assert_same(&focus, &still);
	}
}

/* A sample of a saccade that is at @p deg and is predicted to land at @p landing_deg. */
static struct gz_focus step_to_landing(double deg, double landing_deg)
{
	struct gz_attention_gaze gaze = gaze_of(GZ_EVENT_SACCADE, at_deg(deg));
	gaze.landing =
		(struct gz_landing) { .known = true, .point = at_deg(landing_deg), .sigma_deg = 1 };
	return step(&gaze);
}

static void assert_in_saccade_at(const struct gz_focus *focus, double deg)
{
	struct gz_point point = at_deg(deg);
	if (focus->point.x != point.x || focus->point.y != point.y ||
	    focus->scale != params.saccade_scale)
		fail_msg("at %g, scale %g; wanted at %g", (double)focus->point.x, focus->scale,
			 (double)point.x);
}

static void large_saccade_is_met_where_it_will_land(void **state)
{
	(void)state;
	assert_true(params.landing_deg > 2 && params.landing_deg < 10);
	go_on(GZ_EVENT_FIXATION, 0, 100);
	struct gz_focus focus = step_to_landing(2, 10);
	assert_in_saccade_at(&focus, 10);
	focus = step_to_landing(7, 9.5); /* the size counts, not what is left */
	assert_in_saccade_at(&focus, 9.5);
	focus = step_event(GZ_EVENT_FIXATION, 9);
	assert_sharp_at(&focus, 9);
}

static void small_saccade_is_followed_and_so_is_any_without_a_landing(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, 0, 100);
	struct gz_focus focus = step_to_landing(2, params.landing_deg - 0.1);
	assert_in_saccade_at(&focus, 2);
	focus = step_to_landing(3, NAN);
	assert_in_saccade_at(&focus, 3);
	focus = step_event(GZ_EVENT_SACCADE, 4);
	assert_in_saccade_at(&focus, 4);
	struct gz_attention_params never = params;
	never.landing_deg = 0;
	gz_attention_set_params(&attention, &never);
	focus = step_to_landing(5, 20);
	assert_in_saccade_at(&focus, 5);
}

static void landing_says_nothing_where_the_start_of_the_saccade_is_not_known(void **state)
{
	(void)state;
	struct gz_focus focus = step_to_landing(2, 20); /* the first gaze of all */
	assert_in_saccade_at(&focus, 2);
	go_on(GZ_EVENT_FIXATION, 0, 100);
	step_event(GZ_EVENT_LOST, 0);
	focus = step_to_landing(5, 20);
	assert_in_saccade_at(&focus, 5);
}

static void saccade_that_lasts_too_long_is_ignored(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, 0, 100);
	struct gz_focus focus = go_on(GZ_EVENT_SACCADE, 12, 200);
	assert_true(focus.scale == params.saccade_scale);
	focus = go_on(GZ_EVENT_SACCADE, 12, 100);
	assert_sharp_at(&focus, 12);
	focus = step_to_landing(12, 30);
	assert_sharp_at(&focus, 12);
}

static void pursuit_is_followed_one_dead_band_behind(void **state)
{
	(void)state;
	struct gz_focus last = step_event(GZ_EVENT_FIXATION, 0);
	for (int i = 1; i <= 120; i++) { /* 10 degrees a second */
		double deg = (double)i / 6;
		struct gz_focus focus = step_event(GZ_EVENT_PURSUIT, deg);
		double behind = gz_display_angle_deg(&display, focus.point, at_deg(deg));
		double moved = gz_display_angle_deg(&display, focus.point, last.point);
		if (!(behind <= params.dead_band_deg + 0.02) || (i > 8 && !(moved <= 0.25)))
			fail_msg("step %d: %g degrees behind, moved by %g", i, behind, moved);
		last = focus;
	}
	for (int i = 0; i < 60; i++) { /* it stops: so does the plan, once it has come so far */
		struct gz_focus focus =
			step_event(GZ_EVENT_PURSUIT, 20 + (i < 8 ? 0.3 : 0.2) * sin((double)i));
		if (i >= 8)
			assert_same(&focus, &last);
		last = focus;
	}
}

static void blink_holds_the_plan(void **state)
{
	(void)state;
	struct gz_focus before = go_on(GZ_EVENT_FIXATION, -6, 200);
	for (int i = 0; i < 29; i++) { /* 483 ms; lids drag the point about */
		struct gz_focus focus = step_event(GZ_EVENT_BLINK, i % 2 ? 20.0 : -20.0);
		assert_same(&focus, &before);
		assert_int_equal(attention.state, GZ_ATTENTION_BLINK);
	}
	struct gz_focus same = step_event(GZ_EVENT_FIXATION, -6.2);
	assert_same(&same, &before);
	go_on(GZ_EVENT_BLINK, 0, 200);
	struct gz_focus elsewhere = step_event(GZ_EVENT_FIXATION, 6);
	assert_sharp_at(&elsewhere, 6);
}

/* From the frame that is told of the loss on: holds, widens, stays wide; sharp with the return. */
static void assert_loss_is_answered(struct gz_attention_gaze lost)
{
	struct gz_focus before = go_on(GZ_EVENT_FIXATION, 8, 200);
	int64_t start_ns = now_ns + FRAME_NS;
	double widest = 0;
	int rises = 0;
	for (int i = 0; i < 60; i++) {
		struct gz_focus focus = step(&lost);
		double ms = gz_ns_to_ms(now_ns - start_ns);
		assert_true(focus.point.x == before.point.x && focus.point.y == before.point.y);
		assert_true(focus.scale == 1);
		if (ms < params.hold_ms)
			assert_same(&focus, &before);
		else
			assert_true(focus.widen > 0);
		assert_true(focus.widen >= widest && focus.widen <= 1);
		rises += focus.widen > widest;
		widest = focus.widen;
		bool done = ms > params.hold_ms + params.widen_ms;
		assert_int_equal(gz_attention_settled(&attention), done || widest == 1);
		assert_int_equal(attention.state,
				 ms < params.hold_ms ? GZ_ATTENTION_HOLD : GZ_ATTENTION_WIDEN);
	}
	assert_true(widest == 1);
	assert_in_range(rises, 8, 16);
	struct gz_focus back = step_event(GZ_EVENT_FIXATION, 8.1); /* however near */
	assert_sharp_at(&back, 8.1);
}

static void lost_gaze_holds_then_widens_and_its_return_is_sharp(void **state)
{
	(void)state;
	assert_loss_is_answered(gaze_of(GZ_EVENT_LOST, at_deg(30)));
	struct gz_attention_gaze none = { .known = false, .noise_deg = NAN };
	assert_loss_is_answered(none);
}

static void gaze_of_nan_or_infinity_counts_as_lost(void **state)
{
	(void)state;
	const struct gz_point places[] = {
		{ NAN, 0.5f }, { 0.5f, NAN }, { INFINITY, 0.5f }, { 0.5f, -INFINITY }
	};
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		assert_loss_is_answered(gaze_of(GZ_EVENT_FIXATION, places[i]));
		assert_loss_is_answered(gaze_of(GZ_EVENT_SACCADE, places[i]));
		struct gz_attention_gaze untold = { .known = true, .point = places[i] };
		assert_loss_is_answered(untold);
	}
}

static void gaze_older_than_a_blink_counts_as_lost(void **state)
{
	(void)state;
	struct gz_attention_gaze old = gaze_of(GZ_EVENT_FIXATION, at_deg(8));
	old.age_ns = 501 * GZ_NS_PER_MS;
	assert_loss_is_answered(old);
	go_on(GZ_EVENT_FIXATION, 8, 50);
	old.age_ns = 499 * GZ_NS_PER_MS;
	for (int i = 0; i < 60; i++)
		step(&old);
	assert_int_equal(attention.state, GZ_ATTENTION_FIXATION);
}

static void blink_that_does_not_end_is_a_loss(void **state)
{
	(void)state;
	struct gz_focus before = go_on(GZ_EVENT_FIXATION, 8, 200);
	struct gz_focus held = go_on(GZ_EVENT_BLINK, 8, 640);
	assert_same(&held, &before);
	assert_int_equal(attention.state, GZ_ATTENTION_HOLD);
	struct gz_focus wide = go_on(GZ_EVENT_BLINK, 8, 600);
	assert_true(wide.widen == 1);
}

static void blink_then_loss_holds_for_as_long_again(void **state)
{
	(void)state;
	struct gz_focus before = go_on(GZ_EVENT_FIXATION, 8, 200);
	go_on(GZ_EVENT_BLINK, 8, 490);
	struct gz_focus held = go_on(GZ_EVENT_LOST, 8, 140);
	assert_same(&held, &before);
	struct gz_focus widening = go_on(GZ_EVENT_LOST, 8, 60);
	assert_true(widening.widen > 0 && widening.widen < 1);
}

static void loss_in_a_saccade_is_not_left_coarse(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, 0, 100);
	struct gz_focus way = step_event(GZ_EVENT_SACCADE, 6);
	assert_true(way.scale > 1);
	struct gz_focus lost = step_event(GZ_EVENT_LOST, 6);
	assert_true(lost.scale == 1 && lost.widen == 0);
}

static void no_gaze_at_all_is_the_centre_and_widens(void **state)
{
	(void)state;
	const struct gz_attention_gaze none = { .known = false, .noise_deg = NAN };
	struct gz_focus focus = step(&none);
	assert_true(isnan(focus.point.x) && isnan(focus.point.y) && focus.widen == 0);
	for (int i = 0; i < 60; i++)
		focus = step(&none);
	assert_true(isnan(focus.point.x) && focus.widen == 1);
}

static void widening_can_be_turned_off(void **state)
{
	(void)state;
	params.widen_ms = 0;
	gz_attention_set_params(&attention, &params);
	struct gz_focus before = go_on(GZ_EVENT_FIXATION, 8, 200);
	struct gz_focus after = go_on(GZ_EVENT_LOST, 8, 2000);
	assert_same(&after, &before);
	assert_true(gz_attention_settled(&attention));
}

static void time_that_runs_backwards_counts_as_standing_still(void **state)
{
	(void)state;
	go_on(GZ_EVENT_FIXATION, 8, 200);
	go_on(GZ_EVENT_LOST, 8, 300);
	const struct gz_attention_gaze lost = gaze_of(GZ_EVENT_LOST, at_deg(8));
	struct gz_focus last = gz_attention_step(&attention, &lost, &display, now_ns);
	struct gz_focus back = gz_attention_step(&attention, &lost, &display, INT64_MIN);
	assert_same(&back, &last);
	assert_true(last.widen > 0);
}

static void budget_makes_the_whole_plan_coarser_and_saccades_more_so(void **state)
{
	(void)state;
	params.budget_ms = 10;
	gz_attention_set_params(&attention, &params);
	for (int i = 0; i < 3; i++) {
		struct gz_focus focus = step_event(GZ_EVENT_FIXATION, 0);
		assert_true(focus.scale == 1);
		assert_false(gz_attention_spent(&attention, 20, false));
	}
	struct gz_focus still = step_event(GZ_EVENT_FIXATION, 0);
	assert_true(still.scale > 1.4 && still.scale < 4);
	struct gz_focus way = step_event(GZ_EVENT_SACCADE, 10);
	assert_true(way.scale == params.saccade_scale * still.scale);
	/* No other settings, no change. */
	gz_attention_set_params(&attention, &params);
	struct gz_focus landed = step_event(GZ_EVENT_FIXATION, 10);
	assert_true(landed.scale == still.scale);
	params.budget_ms = 0;
	gz_attention_set_params(&attention, &params);
	struct gz_focus free_again = step_event(GZ_EVENT_FIXATION, 10);
	assert_true(free_again.scale == 1);
}

/* With a budget of 10 ms, three slow frames make the plan coarser. Returns its scale. */
static double coarsen_by_slow_frames(void)
{
	params.budget_ms = 10;
	gz_attention_set_params(&attention, &params);
	for (int i = 0; i < 3; i++) {
		step_event(GZ_EVENT_FIXATION, 0);
		gz_attention_spent(&attention, 20, false);
	}
	return step_event(GZ_EVENT_FIXATION, 0).scale;
}

static void cheap_frames_of_saccades_do_not_make_the_plan_finer(void **state)
{
	(void)state;
	const double scale = coarsen_by_slow_frames();
	for (int i = 0; i < 200; i++) {
		double way = i % 4 ? 20 : -20;
		struct gz_focus focus =
			step_event(i % 4 ? GZ_EVENT_SACCADE : GZ_EVENT_FIXATION, way);
		gz_attention_spent(&attention, focus.scale > scale ? 1 : 9, false);
	}
	assert_true(step_event(GZ_EVENT_FIXATION, 0).scale == scale);
}

static void frames_with_kept_rays_do_not_make_the_plan_finer(void **state)
{
	(void)state;
	const double scale = coarsen_by_slow_frames();
	for (int i = 0; i < 200; i++)
		gz_attention_spent(&attention, 1, true);
	assert_true(step_event(GZ_EVENT_FIXATION, 0).scale == scale);
	/* Cast as a whole they do, and too slow they count in any case. */
	for (int i = 0; i < 200; i++)
		gz_attention_spent(&attention, 1, false);
	const double finer = step_event(GZ_EVENT_FIXATION, 0).scale;
	assert_true(finer < scale);
	for (int i = 0; i < 3; i++)
		gz_attention_spent(&attention, 40, true);
	assert_true(step_event(GZ_EVENT_FIXATION, 0).scale > finer);
}

static void rare_slow_frames_among_kept_ones_change_nothing(void **state)
{
	(void)state;
	params.budget_ms = 10;
	gz_attention_set_params(&attention, &params);
	for (int i = 0; i < 5000; i++) {
		step_event(GZ_EVENT_FIXATION, 0);
		assert_false(gz_attention_spent(&attention, i % 100 == 0 ? 40 : 1, true));
	}
	assert_true(step_event(GZ_EVENT_FIXATION, 0).scale == 1);
}

static void presets_parse_and_states_have_names(void **state)
{
	(void)state;
	for (size_t i = 0; i < gz_attention_option_count; i++)
		assert_true(gz_option_holds(&gz_attention_options[i], &params));
	assert_string_equal(gz_attention_state_name(GZ_ATTENTION_FIXATION), "fixation");
	assert_string_equal(gz_attention_state_name(GZ_ATTENTION_WIDEN), "widen");
}

TEST_SUITE(attention)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(first_gaze_is_sharp_where_it_is, begin),
		cmocka_unit_test_setup(gaze_within_the_dead_band_changes_nothing, begin),
		cmocka_unit_test_setup(landing_is_followed_until_the_eye_could_see_it, begin),
		cmocka_unit_test_setup(dead_band_grows_with_the_noise_up_to_a_limit, begin),
		cmocka_unit_test_setup(gaze_without_a_tracker_is_followed_by_the_pixel, begin),
		cmocka_unit_test_setup(
			saccade_is_coarse_on_its_way_and_sharp_with_the_landing_sample, begin),
		cmocka_unit_test_setup(landing_within_the_dead_band_of_the_way_is_sharp_too, begin),
		cmocka_unit_test_setup(saccade_between_two_frames_is_sharp_at_its_end, begin),
		cmocka_unit_test_setup(saccade_that_goes_nowhere_changes_nothing, begin),
		cmocka_unit_test_setup(large_saccade_is_met_where_it_will_land, begin),
		cmocka_unit_test_setup(small_saccade_is_followed_and_so_is_any_without_a_landing,
				       begin),
		cmocka_unit_test_setup(
			landing_says_nothing_where_the_start_of_the_saccade_is_not_known, begin),
		cmocka_unit_test_setup(saccade_that_lasts_too_long_is_ignored, begin),
		cmocka_unit_test_setup(pursuit_is_followed_one_dead_band_behind, begin),
		cmocka_unit_test_setup(blink_holds_the_plan, begin),
		cmocka_unit_test_setup(lost_gaze_holds_then_widens_and_its_return_is_sharp, begin),
		cmocka_unit_test_setup(gaze_of_nan_or_infinity_counts_as_lost, begin),
		cmocka_unit_test_setup(gaze_older_than_a_blink_counts_as_lost, begin),
		cmocka_unit_test_setup(blink_that_does_not_end_is_a_loss, begin),
		cmocka_unit_test_setup(blink_then_loss_holds_for_as_long_again, begin),
		cmocka_unit_test_setup(loss_in_a_saccade_is_not_left_coarse, begin),
		cmocka_unit_test_setup(no_gaze_at_all_is_the_centre_and_widens, begin),
		cmocka_unit_test_setup(widening_can_be_turned_off, begin),
		cmocka_unit_test_setup(time_that_runs_backwards_counts_as_standing_still, begin),
		cmocka_unit_test_setup(budget_makes_the_whole_plan_coarser_and_saccades_more_so,
				       begin),
		cmocka_unit_test_setup(cheap_frames_of_saccades_do_not_make_the_plan_finer, begin),
		cmocka_unit_test_setup(frames_with_kept_rays_do_not_make_the_plan_finer, begin),
		cmocka_unit_test_setup(rare_slow_frames_among_kept_ones_change_nothing, begin),
		cmocka_unit_test_setup(presets_parse_and_states_have_names, begin),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
