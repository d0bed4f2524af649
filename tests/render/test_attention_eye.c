/* The attention on what a tracker makes of a simulated eye, whose truth is known. */
#include "check.h"

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
		.noise_deg = gz_pipeline_noise_deg(&watch->pipeline),
	};
	return gz_attention_step(&watch->attention, &gaze, &watch->display, watch->now_ns);
}

/* What became of the plan in the fixations of a minute. */
struct tally {
	int fixations; /* long enough to be looked at */
	int still;     /* in which the plan did not change from the settling on */
	int changes;   /* in all of them */
	double worst_deg;
	double sum_deg; /* from the plan's place to the eye's, at the fixations' ends */
};

/* The plan may settle for as long as the daemon needs to be certain of the landing. */
#define SETTLE_NS (50 * GZ_NS_PER_MS)

static struct tally tally_fixations(double noise_deg, int seed)
{
	struct watch watch;
	struct tally tally = { 0 };
	struct gz_sim_params params = quiet_params(noise_deg);
	params.seed = seed;
	begin(&watch, &params);
	struct gz_focus before = frame(&watch), last = before;
	uint64_t fixation = watch.truth.fixation;
	int64_t start_ns = 0;
	int changes = 0;
	bool settled = false;
	while (watch.now_ns < MINUTES_NS) {
		before = last;
		last = frame(&watch);
		if (watch.truth.event != GZ_EVENT_FIXATION || watch.truth.fixation != fixation) {
			if (settled && watch.now_ns > 2 * GZ_NS_PER_S) {
				tally.fixations++;
				tally.still += changes == 0;
				tally.changes += changes;
			}
			settled = false;
			changes = 0;
			fixation = watch.truth.fixation;
			start_ns = watch.now_ns;
			continue;
		}
		if (watch.now_ns - start_ns < SETTLE_NS)
			continue;
		changes += settled && !gz_focus_same(&before, &last);
		settled = true;
		double deg = gz_display_angle_deg(&watch.display, last.point, watch.truth.point);
		tally.worst_deg = fmax(tally.worst_deg, deg);
	}
	end(&watch);
	return tally;
}

static void still_eye_sees_a_still_plan_whatever_the_noise(void **state)
{
	(void)state;
	static const double noises_deg[] = { 0.05, 0.1, 0.2, 0.3, 0.5 };
	for (size_t i = 0; i < sizeof noises_deg / sizeof noises_deg[0]; i++) {
		struct tally tally = tally_fixations(noises_deg[i], 1 + (int)i);
		print_message("noise %g: %d fixations, %d still, %d changes, worst %g deg\n",
			      noises_deg[i], tally.fixations, tally.still, tally.changes,
			      tally.worst_deg);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(still_eye_sees_a_still_plan_whatever_the_noise),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
