/* The lid in front of the pupil: the guard alone, and in the pipeline with simulated viewers. */
#include "filter/viewing.h"

#include <math.h>
#include <stdlib.h>

#include "bench/filter/labelled_recording.h"
#include "filter/lid.h"

static const struct gz_display DISPLAY = { { 1920, 1080 }, { 564.677, 317.631 }, 600 };
static const struct gz_lid_params PARAMS = { .change = 0.12 };

/* A recording that is being made, at 500 Hz. */
struct strip {
	struct gz_lid_state state;
	int64_t time_ns;
	struct gz_lid_output out;
	int covered; /* samples so far */
};

static void feed_lid(struct strip *strip, double pupil_mm, float x, float y, float confidence)
{
	struct gz_sample sample = gz_sample_unmeasured();
	strip->time_ns += 2 * GZ_NS_PER_MS;
	sample.host_ns = strip->time_ns;
	sample.eye[GZ_EYE_LEFT].pupil_mm = (float)pupil_mm;
	strip->out = gz_lid_step(&strip->state, &PARAMS, &DISPLAY, &sample,
				 (struct gz_point) { x, y }, confidence);
	strip->covered += strip->out.covers;
}

static void feed_open_eye(struct strip *strip, int samples)
{
	for (int i = 0; i < samples; i++)
		feed_lid(strip, 3.5 + 0.02 * (i % 3), 0.5F, 0.5F, NAN);
}

static void a_pupil_that_shrinks_and_sinks_is_covered(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	feed_open_eye(&strip, 1000);
	assert_int_equal(strip.covered, 0);
	int64_t begin_ns = strip.time_ns;
	for (int i = 1; i <= 12; i++) /* to half within 24 ms */
		feed_lid(&strip, 3.5 - 0.15 * i, 0.5F, 0.5F + 0.03F * (float)i, NAN);
	assert_true(strip.out.covers);
	assert_true(strip.covered >= 8);
	CHECK_BETWEEN(gz_ns_to_ms(strip.out.since_ns - begin_ns), 2, 6);
	strip.time_ns += 60 * GZ_NS_PER_MS; /* nothing is measured */
	int covered = strip.covered;
	for (int i = 0; i < 25; i++) /* it opens again */
		feed_lid(&strip, 2.0 + 0.06 * i, 0.5F, 0.8F - 0.012F * (float)i, NAN);
	assert_true(strip.covered - covered >= 24);
	feed_open_eye(&strip, 30);
	assert_false(strip.out.covers);
}

static void what_a_pupil_can_do_is_no_lid(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	feed_open_eye(&strip, 1000);
	for (int i = 0; i < 200; i++) /* a bright light: 5.5 mm per second */
		feed_lid(&strip, 3.5 - 0.011 * i, 0.5F, 0.5F, NAN);
	for (int i = 0; i < 2000; i++) /* and slowly back */
		feed_lid(&strip, 1.3 + 0.0011 * i, 0.5F, 0.5F, NAN);
	assert_int_equal(strip.covered, 0);
	/* A saccade across, during which the pupil is measured badly. */
	for (int i = 0; i < 20; i++)
		feed_lid(&strip, 3.5 - 0.05 * i, 0.5F + 0.02F * (float)i, 0.5F, NAN);
	assert_int_equal(strip.covered, 0);
}

static void noise_is_no_lid(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	struct gz_random random = gz_random_seeded(3, 3);
	for (int i = 0; i < 20000; i++)
		feed_lid(&strip, 3.5 * (1 + 0.06 * gz_random_normal(&random)), 0.5F, 0.5F, NAN);
	assert_true(strip.covered < 20);
}

static void a_confidence_that_falls_tells_too(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	for (int i = 0; i < 1000; i++)
		feed_lid(&strip, NAN, 0.5F, 0.5F, 0.95F + 0.001F * (float)(i * 7 % 31));
	assert_int_equal(strip.covered, 0);
	for (int i = 1; i <= 8; i++)
		feed_lid(&strip, NAN, 0.5F, 0.5F + 0.02F * (float)i, 0.98F - 0.04F * (float)i);
	assert_true(strip.out.covers);
}

static void without_pupil_and_confidence_nothing_is_covered(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	for (int i = 0; i < 1000; i++)
		feed_lid(&strip, NAN, 0.5F, i % 100 < 50 ? 0.2F : 0.8F, NAN);
	assert_int_equal(strip.covered, 0);
}

static void a_pupil_that_stays_small_is_covered_for_the_longest_blink(void **state)
{
	(void)state;
	struct strip strip = { .time_ns = GZ_NS_PER_S };
	feed_open_eye(&strip, 1000);
	for (int i = 0; i < 1000; i++)
		feed_lid(&strip, 2, 0.5F, 0.6F, NAN);
	CHECK_BETWEEN(strip.covered, 240, 270);
}

/* Agreement about blinks at once, and how many samples in blinks are called saccade. */
struct lid_figures {
	double kappa;
	int saccades;
};

static struct lid_figures watch_lids(double rate_hz, double change)
{
	static struct viewing viewing;
	struct gz_sim_params params = sim_params(rate_hz);
	struct gz_agreement blink = { 0 };
	struct lid_figures figures = { 0 };
	params.lids = true;
	params.viewer.blinks_per_min = 30;
	viewing_open(&viewing, &params);
	viewing.pipeline.params.lid.change = change;
	for (int i = 0; i < 120 * (int)rate_hz; i++) {
		viewing_step(&viewing);
		bool truth = viewing.in.truth.event == GZ_EVENT_BLINK;
		enum gz_event ours = viewing.out.gaze.event;
		gz_agreement_add(&blink, ours == GZ_EVENT_BLINK || ours == GZ_EVENT_LOST, truth);
		figures.saccades += truth && ours == GZ_EVENT_SACCADE;
	}
	viewing_close(&viewing);
	figures.kappa = gz_agreement_kappa(&blink);
	return figures;
}

static void lids_of_simulated_viewers_are_seen(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		if (RATES_HZ[i] < 250) /* a lid closes between two samples */
			continue;
		struct lid_figures off = watch_lids(RATES_HZ[i], 0);
		struct lid_figures on = watch_lids(RATES_HZ[i], PARAMS.change);
		print_message(
			"%6g Hz: kappa of blinks %.3f without the guard, %.3f with it; called "
			"saccade in them %d and %d samples\n",
			RATES_HZ[i], off.kappa, on.kappa, off.saccades, on.saccades);
		assert_true(on.kappa > off.kappa + 0.01);
		assert_true(on.saccades <= 0.7 * off.saccades);
	}
}

/* Andersson et al. measured the pupil. Rules know nothing of lids, and forests learned about them
 * from these recordings, so the rules show what the guard does. */
static void lids_of_labelled_recordings_are_seen(void **state)
{
	(void)state;
	const char *data = getenv("GAZECAST_DATA");
	static struct gz_pipeline pipeline;
	double kappa[2];
	for (int on = 0; on < 2; on++) {
		struct gz_agreement blink = { 0 };
		struct gz_pipeline_params params = gz_pipeline_default_params();
		params.classify.source = GZ_CLASSIFY_RULES;
		params.lid.change = on ? params.lid.change : 0;
		for (size_t f = 0; f < GZ_LABELLED_FILES; f++) {
			struct gz_labelled_recording recording;
			if (!gz_labelled_recording_read(data, f, 0, &recording))
				skip();
			gz_pipeline_init(&pipeline, &params, &recording.display);
			for (size_t i = 0; i < recording.count; i++) {
				struct gz_pipeline_output out;
				gz_pipeline_step(&pipeline, &recording.sample[i], &out);
				bool ours = out.gaze.event == GZ_EVENT_BLINK ||
					    out.gaze.event == GZ_EVENT_LOST;
				gz_agreement_add(&blink, ours,
						 recording.label[i] == GZ_HUMAN_BLINK);
			}
			gz_labelled_recording_free(&recording);
		}
		kappa[on] = gz_agreement_kappa(&blink);
	}
	print_message("kappa of blinks by the rules: %.3f, with the guard %.3f\n", kappa[0],
		      kappa[1]);
	assert_true(kappa[1] > kappa[0] + 0.1);
}

TEST_SUITE(lid)
{
	if (!read_tested_params(argc, argv))
		return 2;
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_pupil_that_shrinks_and_sinks_is_covered),
		cmocka_unit_test(what_a_pupil_can_do_is_no_lid),
		cmocka_unit_test(noise_is_no_lid),
		cmocka_unit_test(a_confidence_that_falls_tells_too),
		cmocka_unit_test(without_pupil_and_confidence_nothing_is_covered),
		cmocka_unit_test(a_pupil_that_stays_small_is_covered_for_the_longest_blink),
		cmocka_unit_test(lids_of_simulated_viewers_are_seen),
		cmocka_unit_test(lids_of_labelled_recordings_are_seen),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
