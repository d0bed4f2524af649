/* Where saccades will land: on simulated viewers, whose eyes the weights were not fitted to. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/order.h"
#include "filter/pipeline.h"
#include "sim/tracker.h"

enum { SAMPLES = 30000 };

/* Predictions a certain time after saccades were noticed, and where the eye was then. */
struct errors {
	size_t count;
	double predicted_deg[SAMPLES], now_deg[SAMPLES], late_ms[SAMPLES];
};

static double median(double *numbers, size_t count)
{
	assert_true(count > 0);
	qsort(numbers, count, sizeof *numbers, gz_compare_doubles);
	return numbers[count / 2];
}

static void add_error(const struct gz_sim_sample *in, int at, int landed,
		      const struct gz_landing *landing, const struct gz_display *display,
		      struct errors *errors)
{
	const struct gz_point truth = in[landed].truth.point;
	errors->predicted_deg[errors->count] = gz_display_angle_deg(display, landing->point, truth);
	errors->now_deg[errors->count] = gz_display_angle_deg(display, in[at].truth.point, truth);
	errors->late_ms[errors->count++] =
		fabs(gz_ns_to_ms(landing->time_ns - in[landed].sample.host_ns));
}

/* Predictions @p elapsed_ms after each saccade of 5 degrees and more was noticed. */
static void predict(double rate_hz, double elapsed_ms, struct errors *errors)
{
	static struct gz_sim_sample in[SAMPLES];
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output out[SAMPLES];
	struct gz_sim_params params = gz_sim_default_params();
	struct gz_sim_tracker *tracker = NULL;
	params.rate_hz = rate_hz;
	params.viewer.microsaccades_per_s = 0;
	assert_int_equal(gz_sim_tracker_create(&params, GZ_NS_PER_S, NULL, &tracker), GZ_OK);
	const struct gz_display display = gz_sim_tracker_display(tracker);
	gz_pipeline_init(&pipeline, NULL, &display);
	for (int i = 0; i < SAMPLES; i++) {
		gz_sim_tracker_next(tracker, &in[i]);
		gz_pipeline_step(&pipeline, &in[i].sample, &out[i]);
		const struct gz_landing *landing = &out[i].gaze.landing;
		assert_true(!landing->known || out[i].gaze.event == GZ_EVENT_SACCADE);
		if (landing->known)
			assert_true(isfinite(landing->point.x) && isfinite(landing->point.y) &&
				    landing->sigma_deg > 0 &&
				    landing->time_ns >= in[i].sample.host_ns);
	}
	gz_sim_tracker_destroy(&tracker);
	errors->count = 0;
	int begin = 0;
	for (int i = 1; i < SAMPLES; i++) {
		if (out[i].gaze.landing.known && !out[i - 1].gaze.landing.known)
			begin = i;
		int landed = i;
		while (landed < SAMPLES && in[landed].truth.event == GZ_EVENT_SACCADE)
			landed++;
		const double since_ms =
			gz_ns_to_ms(in[i].sample.host_ns - in[begin].sample.host_ns);
		if (out[i].gaze.landing.known && landed > i && landed < SAMPLES &&
		    since_ms >= elapsed_ms && since_ms < elapsed_ms + 1e3 / rate_hz - 1e-3 &&
		    gz_display_angle_deg(&display, in[begin].truth.point, in[landed].truth.point) >
			    5)
			add_error(in, i, landed, &out[i].gaze.landing, &display, errors);
	}
}

/* At 60 Hz most of a saccade is over when it is noticed. */
static void prediction_is_nearer_to_the_landing_than_the_eye_is(void **state)
{
	(void)state;
	static const struct {
		double rate_hz;
		int elapsed_ms;
		double share; /* of the eye's distance */
	} cases[] = { { 60, 0, 0.75 }, { 250, 8, 0.5 }, { 500, 8, 0.5 }, { 500, 16, 0.5 } };
	static struct errors errors;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		predict(cases[i].rate_hz, cases[i].elapsed_ms, &errors);
		const double predicted = median(errors.predicted_deg, errors.count);
		const double now = median(errors.now_deg, errors.count);
		print_message("%4.0f Hz, %2d ms: %zu saccades, %.2f degrees off, the eye %.2f; "
			      "time %.1f ms off\n",
			      cases[i].rate_hz, cases[i].elapsed_ms, errors.count, predicted, now,
			      median(errors.late_ms, errors.count));
		assert_true(errors.count >= 20 && predicted < cases[i].share * now);
	}
}

static const struct gz_display DISPLAY = { { 1920, 1080 }, { 600, 340 }, 600 };

/* An eye that goes from one place to another along a curve of least jerk (Flash and Hogan 1985), at
 * 500 Hz, and rests. @return the prediction 12 ms after the saccade was noticed */
static struct gz_landing make_saccade(struct gz_landing_state *state, int64_t *time_ns, double from,
				      double to, double duration_ms)
{
	struct gz_landing at_12_ms = { .known = false };
	for (int i = -100; i < 100; i++) {
		const double share = fmax(0, fmin(1, 2 * i / duration_ms));
		const double done = share * share * share * (10 + share * (6 * share - 15));
		const struct gz_landing_input input = {
			i > 2 && share < 1 ? GZ_EVENT_SACCADE : GZ_EVENT_FIXATION,
			*time_ns,
			true,
			{ (float)(from + (to - from) * done), 0.5F },
		};
		const struct gz_landing landing =
			gz_landing_step(state, &gz_landing_model, &DISPLAY, &input);
		assert_int_equal(landing.known, input.event == GZ_EVENT_SACCADE);
		if (i == 3 + 6)
			at_12_ms = landing;
		*time_ns += 2 * GZ_NS_PER_MS;
	}
	return at_12_ms;
}

/* Slow for their size, so the first are predicted too short. */
static void person_whose_saccades_go_farther_is_followed(void **state)
{
	(void)state;
	static struct gz_landing_state landing;
	landing = (struct gz_landing_state) { .count = 0 };
	int64_t time_ns = GZ_NS_PER_S;
	double first_off = 0, last_off = 0;
	for (int i = 0; i < 40; i++) {
		const double from = i % 2 ? 0.65 : 0.35, to = 1 - from;
		const struct gz_landing at = make_saccade(&landing, &time_ns, from, to, 50);
		last_off = (to - (double)at.point.x) * (to > from ? 1 : -1);
		first_off = i == 0 ? last_off : first_off;
	}
	print_message("off by %.3f at first, %.3f at last\n", first_off, last_off);
	assert_true(first_off > 0.05 && fabs(last_off) < 0.7 * first_off);
}

/* After a gap nobody knows where the saccade began. */
static void saccade_without_a_beginning_is_not_predicted(void **state)
{
	(void)state;
	static struct gz_landing_state landing;
	landing = (struct gz_landing_state) { .count = 0 };
	for (int i = 0; i < 10; i++) {
		const struct gz_landing_input input = { GZ_EVENT_SACCADE,
							GZ_NS_PER_S + i * 2 * GZ_NS_PER_MS,
							true,
							{ 0.1F * (float)i, 0.5F } };
		assert_false(gz_landing_step(&landing, &gz_landing_model, &DISPLAY, &input).known);
	}
}

TEST_SUITE(landing)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(prediction_is_nearer_to_the_landing_than_the_eye_is),
		cmocka_unit_test(person_whose_saccades_go_farther_is_followed),
		cmocka_unit_test(saccade_without_a_beginning_is_not_predicted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
