/* The attention on what a tracker makes of a simulated eye, whose truth is known. */
#include "suite.h"

#include <math.h>

#include "base/clock.h"
#include "filter/pipeline.h"
#include "render/attention/attention.h"
#include "sim/tracker.h"

/* Frames of 120 a second; samples of 500. */
#define FRAME_NS   (GZ_NS_PER_S / 120)
#define RATE_HZ    500
#define MINUTES_NS (60 * GZ_NS_PER_S)

/* The eye through tracker, pipeline and attention. */
struct watch {
	struct gz_sim_tracker *tracker;
	struct gz_sim_sample next; /* not yet shown */
	struct gz_viewer_truth truth;
	struct gz_pipeline pipeline;
	struct gz_pipeline_output output;
	struct gz_attention attention;
	struct gz_display display;
	int64_t now_ns;
};

static struct gz_sim_params quiet_params(double noise_deg)
{
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = RATE_HZ;
	params.noise_deg = noise_deg;
	params.latency_ms = 0;
	params.latency_jitter_ms = 0;
	params.viewer.pursuits_per_min = 0;
	params.viewer.blinks_per_min = 0;
	return params;
}

static void begin(struct watch *watch, const struct gz_sim_params *params)
{
	const struct gz_attention_params attention = gz_attention_default();
	*watch = (struct watch) { .now_ns = 0 };
	assert_int_equal(gz_sim_tracker_create(params, 0, NULL, &watch->tracker), GZ_OK);
	watch->display = gz_sim_tracker_display(watch->tracker);
	gz_pipeline_init(&watch->pipeline, NULL, &watch->display);
	gz_attention_init(&watch->attention, &attention);
	gz_sim_tracker_next(watch->tracker, &watch->next);
}

static void end(struct watch *watch)
{
	gz_sim_tracker_destroy(&watch->tracker);
}

static struct gz_focus frame(struct watch *watch)
{
	watch->now_ns += FRAME_NS;
	while (watch->next.arrival_ns <= watch->now_ns) {
		gz_pipeline_step(&watch->pipeline, &watch->next.sample, &watch->output);
		watch->truth = watch->next.truth;
		gz_sim_tracker_next(watch->tracker, &watch->next);
	}
	const struct gz_attention_gaze gaze = {
		.known = true,
		.point = watch->output.gaze.point,
		.has_age = true,
		.age_ns = watch->now_ns - watch->output.gaze.host_ns,
		.has_event = true,
		.event = watch->output.gaze.event,
		.landing = watch->output.gaze.landing,
		.noise_deg = gz_pipeline_noise_deg(&watch->pipeline),
	};
	return gz_attention_step(&watch->attention, &gaze, &watch->display, watch->now_ns);
}

/* What became of the plan in the fixations of a minute. */
struct tally {
	int fixations;    /* long enough to be looked at */
	int still;        /* in which the plan did not change from the settling on */
	double worst_deg; /* from where the plan is sharp to where the eye looks */
};

/* The tracker is late to know of a landing, and the plan may settle for a while after it. */
#define SETTLE_NS (100 * GZ_NS_PER_MS)
/* Until then the pipeline gets to know the tracker's noise. */
#define WARM_NS (5 * GZ_NS_PER_S)

/* One fixation, from its settling on. */
struct fixation {
	uint64_t number;
	int64_t start_ns;
	bool settled;
	int changes;
};

static void tally_end(struct tally *tally, const struct fixation *fixation)
{
	if (!fixation->settled || fixation->start_ns < WARM_NS)
		return;
	tally->fixations++;
	tally->still += fixation->changes == 0;
}

static struct tally tally_fixations(double noise_deg, int seed)
{
	struct watch watch;
	struct tally tally = { 0 };
	struct gz_sim_params params = quiet_params(noise_deg);
	params.seed = seed;
	begin(&watch, &params);
	struct gz_focus last = frame(&watch);
	struct fixation fixation = { .number = watch.truth.fixation };
	while (watch.now_ns < MINUTES_NS) {
		struct gz_focus before = last;
		last = frame(&watch);
		if (watch.truth.event != GZ_EVENT_FIXATION ||
		    watch.truth.fixation != fixation.number) {
			tally_end(&tally, &fixation);
			fixation = (struct fixation) { .number = watch.truth.fixation,
						       .start_ns = watch.now_ns };
			continue;
		}
		if (watch.now_ns - fixation.start_ns < SETTLE_NS)
			continue;
		fixation.changes += fixation.settled && !gz_focus_same(&before, &last);
		fixation.settled = true;
		double deg = gz_display_angle_deg(&watch.display, last.point, watch.truth.point);
		if (watch.now_ns > WARM_NS)
			tally.worst_deg = fmax(tally.worst_deg, deg);
	}
	end(&watch);
	return tally;
}

static void still_eye_sees_a_still_plan_whatever_the_noise(void **state)
{
	(void)state;
	/* Of a hundred fixations so many; and what the dead band and the smoothing may add up to.
	 */
	static const struct {
		double noise_deg;
		int still;
		double worst_deg;
	} cases[] = {
		{ 0.05, 98, 1 }, { 0.1, 98, 1 }, { 0.2, 98, 1.2 }, { 0.3, 96, 2 }, { 0.5, 93, 2.5 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct tally tally = tally_fixations(cases[i].noise_deg, 1 + (int)i);
		if (tally.fixations < 100 || 100 * tally.still < cases[i].still * tally.fixations ||
		    tally.worst_deg > cases[i].worst_deg)
			fail_msg("noise %g: %d of %d fixations still, sharp %g degrees away",
				 cases[i].noise_deg, tally.still, tally.fixations, tally.worst_deg);
	}
}

/* The eye from one side to the other, again and again. */
#define SIDE_NS (800 * GZ_NS_PER_MS)

static void twenty_degrees_are_sharp_with_the_landing_and_soon_after_the_eye(void **state)
{
	(void)state;
	static const struct gz_point sides[] = { { 0.3f, 0.5f }, { 0.7f, 0.5f } };
	struct watch watch;
	struct gz_sim_params params = quiet_params(0.1);
	begin(&watch, &params);
	assert_true(gz_display_angle_deg(&watch.display, sides[0], sides[1]) > 20);
	int landings = 0, coarse = 0, late = 0, sharp = 0;
	enum gz_event before = GZ_EVENT_FIXATION;
	for (int i = 0; watch.now_ns < MINUTES_NS; i++) {
		const struct gz_point side = sides[watch.now_ns / SIDE_NS % 2];
		gz_sim_tracker_follow(watch.tracker, &side);
		struct gz_focus focus = frame(&watch);
		/* Noise within a saccade may be called a blink; the landing is after it. */
		enum gz_event event = watch.output.gaze.event == GZ_EVENT_BLINK
					      ? before
					      : watch.output.gaze.event;
		if (before == GZ_EVENT_SACCADE && event != GZ_EVENT_SACCADE) {
			landings++;
			assert_true(focus.scale == 1 && focus.widen == 0);
			if (watch.attention.landed_ns == watch.now_ns) {
				assert_true(focus.point.x == watch.output.gaze.point.x);
				assert_true(focus.point.y == watch.output.gaze.point.y);
			}
		}
		before = event;
		coarse += focus.scale > 1;
		/* 400 ms after the order the eye rests, in all but the slowest of reactions. */
		if (watch.now_ns % SIDE_NS < SIDE_NS / 2 || watch.now_ns < WARM_NS)
			continue;
		double deg = gz_display_angle_deg(&watch.display, focus.point, watch.truth.point);
		bool good = focus.scale == 1 && deg < 1;
		*(good ? &sharp : &late) += watch.truth.event == GZ_EVENT_FIXATION;
	}
	end(&watch);
	if (landings < 60 || coarse < 100 || late > sharp / 50)
		fail_msg("%d landings, %d coarse frames, %d frames late, %d sharp", landings,
			 coarse, late, sharp);
}

static void blinks_of_a_simulated_eye_hold_its_plan(void **state)
{
	(void)state;
	struct watch watch;
	struct gz_sim_params params = quiet_params(0.1);
	params.viewer.blinks_per_min = 30;
	params.viewer.blink_ms = 150;
	begin(&watch, &params);
	struct gz_focus last = frame(&watch);
	int blinking = 0;
	while (watch.now_ns < MINUTES_NS) {
		struct gz_focus before = last;
		last = frame(&watch);
		assert_true(last.widen == 0 || watch.now_ns < WARM_NS);
		if (watch.attention.state != GZ_ATTENTION_BLINK)
			continue;
		blinking++;
		assert_true(gz_focus_same(&last, &before));
	}
	end(&watch);
	assert_true(blinking > 200);
}

TEST_SUITE(attention_eye)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(still_eye_sees_a_still_plan_whatever_the_noise),
		cmocka_unit_test(twenty_degrees_are_sharp_with_the_landing_and_soon_after_the_eye),
		cmocka_unit_test(blinks_of_a_simulated_eye_hold_its_plan),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
