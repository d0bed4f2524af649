#include "suite.h"

#include "filter/viewing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "sim/random.h"

static bool finite_point(struct gz_point p)
{
	return isfinite(p.x) && isfinite(p.y);
}

static void check_messages(const struct gz_pipeline_output *out)
{
	for (size_t i = 0; i < out->fixation_count; i++) {
		const struct gz_fixation *f = &out->fixations[i];
		assert_true(finite_point(f->point) && isfinite(f->dispersion_deg));
		CHECK_BETWEEN(f->confidence, 0, 1);
		assert_true(f->duration_ns >= 0 && f->onset_ns > 0);
	}
	for (size_t i = 0; i < out->saccade_count; i++) {
		const struct gz_saccade *s = &out->saccades[i];
		assert_true(finite_point(s->start) && finite_point(s->end));
		assert_true(isfinite(s->amplitude_deg) && isfinite(s->peak_velocity_deg_s));
		assert_true(s->duration_ns > 0);
	}
}

static void check_output(const struct viewing *viewing, int64_t last_ns)
{
	const struct gz_gaze *gaze = &viewing->out.gaze;
	assert_true(finite_point(gaze->point));
	assert_true(isfinite(gaze->velocity_deg_s) && gaze->velocity_deg_s >= 0);
	CHECK_BETWEEN(gaze->confidence, 0, 1);
	CHECK_BETWEEN(gaze->event, 0, GZ_EVENT_COUNT - 1);
	assert_true(gaze->host_ns >= last_ns);
	assert_int_equal(gaze->publish_ns, 0);
	assert_int_equal(isnan(gaze->raw.x) != 0, viewing->out.rejection != GZ_REJECT_NONE);
	check_messages(&viewing->out);
}

static void any_rate_gives_finite_numbers_and_time_forwards(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.loss = 0.02;
		params.eye_loss = 0.05;
		params.spikes = 0.01;
		params.noise_deg = 0.3;
		struct viewing viewing;
		viewing_open(&viewing, &params);
		int64_t last_ns = 0;
		for (int k = 0; k < 30 * (int)RATES_HZ[i]; k++) {
			viewing_step(&viewing);
			check_output(&viewing, last_ns);
			last_ns = viewing.out.gaze.host_ns;
		}
		viewing_close(&viewing);
	}
}

/* Random bytes as numbers: NaN, infinite, huge, far outside. */
static float wild_float(struct gz_random *random)
{
	static const float wild[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 1e-30f, 0, 0.5f, 1 };
	uint64_t bits = gz_random_bits(random);
	if (bits & 1)
		return (float)gz_random_between(random, -0.3, 1.3);
	return wild[(bits >> 8) % (sizeof wild / sizeof wild[0])];
}

static void wild_samples_give_finite_numbers(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(3, 3);
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &tested_params, &display);
	struct viewing viewing = { .tracker = NULL };
	int64_t time_ns = VIEWING_START_NS, last_ns = 0;
	for (uint64_t k = 0; k < 300000; k++) {
		struct gz_sample sample = gz_sample_unmeasured();
		uint64_t bits = gz_random_bits(&random);
		time_ns += (int64_t)(bits % 3000000) - (bits % 97 == 0 ? 5000000 : 0) +
			   (bits % 1009 == 0 ? 700000000 : 0);
		sample.seq = k;
		sample.host_ns = time_ns;
		sample.valid = bits & 1 << 20;
		sample.point = (struct gz_point) { wild_float(&random), wild_float(&random) };
		for (int i = 0; i < GZ_EYE_COUNT; i++) {
			sample.eye[i].valid = bits & 1 << (21 + i);
			sample.eye[i].confidence = wild_float(&random);
			sample.eye[i].point =
				(struct gz_point) { wild_float(&random), wild_float(&random) };
		}
		gz_pipeline_step(&pipeline, &sample, &viewing.out);
		check_output(&viewing, last_ns);
		last_ns = viewing.out.gaze.host_ns;
	}
}

static void before_any_good_sample_gaze_is_lost_at_the_centre(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &tested_params, &display);
	for (uint64_t k = 0; k < 100; k++) {
		struct gz_sample sample = gz_sample_unmeasured();
		sample.seq = k;
		sample.host_ns = VIEWING_START_NS + (int64_t)k * 10000000;
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &sample, &out);
		assert_true(out.gaze.point.x == 0.5f && out.gaze.point.y == 0.5f);
		assert_int_equal(out.gaze.event, GZ_EVENT_LOST);
		assert_true(out.gaze.confidence == 0);
		assert_int_equal(out.rejection, GZ_REJECT_TRACKER);
		assert_int_equal(out.blink_count + out.fixation_count + out.saccade_count, 0);
	}
	assert_true(isnan(gz_pipeline_noise_deg(&pipeline)));
}

static void sample_not_newer_changes_nothing(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	struct viewing viewing;
	viewing_open(&viewing, &params);
	for (int k = 0; k < 700; k++)
		viewing_step(&viewing);
	struct gz_pipeline before = viewing.pipeline;
	struct gz_gaze gaze = viewing.out.gaze;
	struct gz_sample old = viewing.in.sample;
	gz_pipeline_step(&viewing.pipeline, &old, &viewing.out);
	assert_int_equal(viewing.out.rejection, GZ_REJECT_TIME);
	old.host_ns -= 100;
	gz_pipeline_step(&viewing.pipeline, &old, &viewing.out);
	assert_int_equal(viewing.out.rejection, GZ_REJECT_TIME);
	assert_memory_equal(&before, &viewing.pipeline, sizeof before);
	assert_true(viewing.out.gaze.host_ns == gaze.host_ns);
	assert_true(viewing.out.gaze.point.x == gaze.point.x && viewing.out.gaze.confidence == 0);
	assert_int_equal(viewing.out.gaze.event, gaze.event);
	viewing_close(&viewing);
}

static void damaged_times_never_bring_time_back(void **state)
{
	(void)state;
	static const int64_t damaged_ns[] = { INT64_MAX,         INT64_MIN,     -1, 0,
					      INT64_MAX / 2 + 1, INT64_MIN + 1, 1 };
	struct gz_sim_params params = sim_params(500);
	struct viewing viewing;
	viewing_open(&viewing, &params);
	int64_t last_ns = 0;
	for (int k = 0; k < 700; k++) {
		gz_sim_tracker_next(viewing.tracker, &viewing.in);
		struct gz_sample damaged = viewing.in.sample;
		damaged.host_ns = damaged_ns[k % 7];
		if (k % 7 != 3 || k > 10) { /* 0 is valid as the first time */
			gz_pipeline_step(&viewing.pipeline, &damaged, &viewing.out);
			assert_int_equal(viewing.out.rejection, GZ_REJECT_TIME);
			check_output(&viewing, last_ns);
			last_ns = viewing.out.gaze.host_ns;
		}
		gz_pipeline_step(&viewing.pipeline, &viewing.in.sample, &viewing.out);
		assert_int_not_equal(viewing.out.rejection, GZ_REJECT_TIME);
		check_output(&viewing, last_ns);
		last_ns = viewing.out.gaze.host_ns;
	}
	viewing_close(&viewing);
}

static void copied_state_goes_on_in_the_same_way(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	struct viewing viewing;
	viewing_open(&viewing, &params);
	for (int k = 0; k < 3000; k++)
		viewing_step(&viewing);
	struct gz_pipeline copy = viewing.pipeline;
	for (int k = 0; k < 3000; k++) {
		viewing_step(&viewing);
		struct gz_pipeline_output out;
		gz_pipeline_step(&copy, &viewing.in.sample, &out);
		assert_true(out.gaze.point.x == viewing.out.gaze.point.x);
		assert_int_equal(out.gaze.event, viewing.out.gaze.event);
		assert_int_equal(out.gaze.final_seq, viewing.out.gaze.final_seq);
	}
	viewing_close(&viewing);
}

static void certain_labels_come_in_order_within_10_ms(void **state)
{
	(void)state;
	enum { SAMPLES = 40000 };
	int64_t *times_ns = calloc(SAMPLES, sizeof *times_ns);
	assert_non_null(times_ns);
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.loss = 0;
		struct viewing viewing;
		viewing_open(&viewing, &params);
		uint64_t next = 0;
		int count = 20 * (int)RATES_HZ[i];
		for (int k = 0; k < count; k++) {
			viewing_step(&viewing);
			times_ns[k] = viewing.in.sample.host_ns;
			if (!viewing.out.gaze.final_known)
				continue;
			uint64_t seq = viewing.out.gaze.final_seq;
			assert_int_equal(seq - viewing.out.gaze.final_span, next);
			double age_ms = gz_ns_to_ms(times_ns[k] - times_ns[seq]);
			CHECK_BETWEEN(age_ms, 0, 10.0001);
			if (k > 20) /* the rate is known by then */
				assert_int_equal(viewing.out.gaze.final_span, 0);
			next = seq + 1;
		}
		CHECK_BETWEEN((double)count - (double)next, 0, 20);
		viewing_close(&viewing);
	}
	free(times_ns);
}

static void labels_that_wait_longer_are_the_same(void **state)
{
	(void)state;
	enum { COUNT = 5000 };
	static enum gz_event event[2][COUNT];
	for (int i = 0; i < 2; i++) {
		static struct gz_pipeline pipeline;
		struct gz_sim_params params = sim_params(250);
		struct gz_pipeline_params settings = gz_pipeline_default_params();
		params.viewer.blinks_per_min = params.loss = params.eye_loss = 0;
		settings.classify.final_delay_ms = i == 0 ? 10 : 20;
		struct gz_sim_tracker *tracker = NULL;
		assert_int_equal(gz_sim_tracker_create(&params, VIEWING_START_NS, NULL, &tracker),
				 GZ_OK);
		const struct gz_display display = gz_sim_tracker_display(tracker);
		gz_pipeline_init(&pipeline, &settings, &display);
		for (uint64_t k = 0; k < COUNT; k++) {
			struct gz_sim_sample sample;
			struct gz_pipeline_output out;
			gz_sim_tracker_next(tracker, &sample);
			sample.sample.seq = k;
			gz_pipeline_step(&pipeline, &sample.sample, &out);
			for (uint64_t n = 0; out.gaze.final_known && n <= out.gaze.final_span; n++)
				event[i][out.gaze.final_seq - n] = out.gaze.final_event;
		}
		gz_sim_tracker_destroy(&tracker);
	}
	int different = 0;
	for (int k = 10; k < COUNT - 10; k++)
		different += event[0][k] != event[1][k];
	CHECK_BETWEEN(different, 0, COUNT / 200); /* where short losses are judged */
}

static void each_sample_gets_one_certain_label_whatever_the_gaps(void **state)
{
	(void)state;
	static const double rates_hz[] = { 60, 250, 500, 2000 };
	for (size_t i = 0; i < sizeof rates_hz / sizeof rates_hz[0]; i++) {
		struct gz_sim_params params = sim_params(rates_hz[i]);
		struct viewing viewing;
		viewing_open(&viewing, &params);
		struct gz_random random = gz_random_seeded(3, i);
		uint64_t given = 0, next = 0, backlog = 0, spans = 0;
		for (int k = 0; k < 40000; k++) {
			gz_sim_tracker_next(viewing.tracker, &viewing.in);
			if (gz_random_uniform(&random) < 0.1) /* lost on the way */
				continue;
			viewing.in.sample.seq = given++;
			gz_pipeline_step(&viewing.pipeline, &viewing.in.sample, &viewing.out);
			const struct gz_gaze *gaze = &viewing.out.gaze;
			if (gaze->final_known) {
				assert_int_equal(gaze->final_seq - gaze->final_span, next);
				next = gaze->final_seq + 1;
				spans += gaze->final_span > 0;
			}
			backlog = given - next > backlog ? given - next : backlog;
		}
		if (rates_hz[i] > 200)
			assert_true(spans > 100);
		/* 10 ms, and labels that a gap leaves over */
		CHECK_BETWEEN((double)backlog, 0, 10 * rates_hz[i] * 1e-3 + 4);
		viewing_close(&viewing);
	}
}

static void an_eye_dropping_out_does_not_move_the_point(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.noise_deg = params.loss = params.spikes = 0;
		params.viewer.blinks_per_min = params.viewer.pursuits_per_min = 0;
		params.viewer.microsaccades_per_s = 0;
		params.offset_deg = 1;
		params.eye_loss = 0.3;
		params.seed = 5 + i;
		struct viewing viewing;
		viewing_open(&viewing, &params);
		viewing_step(&viewing);
		struct gz_sim_sample last = viewing.in;
		struct gz_gaze before = viewing.out.gaze;
		int changes = 0;
		for (int k = 0; k < 30 * (int)RATES_HZ[i]; k++) {
			viewing_step(&viewing);
			bool rested = viewing.in.truth.event == GZ_EVENT_FIXATION &&
				      viewing.in.truth.fixation == last.truth.fixation &&
				      viewing.in.sample.valid && last.sample.valid;
			bool change = viewing.in.sample.eye[0].valid != last.sample.eye[0].valid ||
				      viewing.in.sample.eye[1].valid != last.sample.eye[1].valid;
			if (rested && change) {
				CHECK_BETWEEN(angle_deg(&viewing, viewing.out.gaze.raw, before.raw),
					      0, 0.2);
				changes++;
			}
			last = viewing.in;
			before = viewing.out.gaze;
		}
		assert_true(changes > 10);
		viewing_close(&viewing);
	}
}

/* Fraction of true saccade samples that are labelled so, and of labelled ones that are true. */
static void saccades_are_found_at_any_rate(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		for (int combined = 0; combined < 2; combined++) {
			struct gz_sim_params params = sim_params(RATES_HZ[i]);
			params.combined_only = combined;
			params.loss = 0;
			struct viewing viewing;
			viewing_open(&viewing, &params);
			int count = 40 * (int)RATES_HZ[i];
			enum gz_event *truth = calloc((size_t)count, sizeof *truth);
			assert_non_null(truth);
			double hits = 0, truths = 0, ours = 0;
			for (int k = 0; k < count; k++) {
				viewing_step(&viewing);
				truth[k] = viewing.in.truth.event;
				truths += truth[k] == GZ_EVENT_SACCADE;
				if (!viewing.out.gaze.final_known ||
				    viewing.out.gaze.final_event != GZ_EVENT_SACCADE)
					continue;
				ours++;
				hits += truth[viewing.out.gaze.final_seq] == GZ_EVENT_SACCADE;
			}
			double found = 2 * hits / (truths + ours); /* F1 score */
			CHECK_BETWEEN(found, RATES_HZ[i] < 100 ? 0.5 : 0.8, 1);
			free(truth);
			viewing_close(&viewing);
		}
	}
}

/* The events of a viewer who follows something half of the time. */
static void watch_pursuits(bool still_scene, size_t counts[GZ_EVENT_COUNT])
{
	struct gz_sim_params params = sim_params(250);
	struct viewing viewing;
	params.viewer.pursuits_per_min = 30;
	viewing_open(&viewing, &params);
	viewing.pipeline.params.classify.still_scene = still_scene;
	for (int k = 0; k < 20 * 250; k++) {
		viewing_step(&viewing);
		counts[viewing.out.gaze.event]++;
		if (viewing.out.gaze.final_known)
			counts[viewing.out.gaze.final_event]++;
	}
	viewing_close(&viewing);
}

static void in_a_still_scene_there_is_no_pursuit(void **state)
{
	(void)state;
	size_t moving[GZ_EVENT_COUNT] = { 0 }, still[GZ_EVENT_COUNT] = { 0 };
	watch_pursuits(false, moving);
	watch_pursuits(true, still);
	assert_true(moving[GZ_EVENT_PURSUIT] > 1000);
	assert_int_equal(still[GZ_EVENT_PURSUIT], 0);
	assert_true(still[GZ_EVENT_FIXATION] > moving[GZ_EVENT_FIXATION] + 1000);
}

/* The scene is still in every second stretch of two seconds. Sample by sample: whether it was when
 * the label was given, and when the sample that got a certain label was measured. */
static void watch_changing_scene(int source, size_t pursuits[2][2])
{
	enum { RATE_HZ = 250, STRETCH = 2 * RATE_HZ, SECONDS = 40 };
	struct gz_sim_params params = sim_params(RATE_HZ);
	struct viewing viewing;
	params.viewer.pursuits_per_min = 30;
	params.loss = 0; /* so that the numbers of samples have no gaps */
	viewing_open(&viewing, &params);
	viewing.pipeline.params.classify.source = source;
	for (int k = 0; k < SECONDS * RATE_HZ; k++) {
		viewing.still_scene = k / STRETCH % 2;
		viewing_step(&viewing);
		const struct gz_gaze *gaze = &viewing.out.gaze;
		assert_int_equal(gaze->seq, k);
		pursuits[0][viewing.still_scene] += gaze->event == GZ_EVENT_PURSUIT;
		for (uint64_t seq = gaze->final_seq - gaze->final_span;
		     gaze->final_known && seq <= gaze->final_seq; seq++)
			pursuits[1][seq / STRETCH % 2] += gaze->final_event == GZ_EVENT_PURSUIT;
	}
	viewing_close(&viewing);
}

static void scene_may_become_still_and_move_again_in_mid_stream(void **state)
{
	(void)state;
	static const int sources[] = { GZ_CLASSIFY_LEARNED, GZ_CLASSIFY_RULES };
	for (size_t i = 0; i < 2; i++) {
		size_t pursuits[2][2] = { { 0 } };
		watch_changing_scene(sources[i], pursuits);
		assert_int_equal(pursuits[0][true], 0);
		assert_int_equal(pursuits[1][true], 0);
		assert_true(pursuits[0][false] > 500);
		assert_true(pursuits[1][false] > 500);
	}
}

static void a_resting_eye_gives_a_resting_point(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		if (RATES_HZ[i] < 200)
			continue;
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.offset_deg = 0;
		struct viewing viewing;
		viewing_open(&viewing, &params);
		struct gz_sim_sample last = { .arrival_ns = 0 };
		struct gz_gaze before = { .seq = 0 };
		double raw2 = 0, smooth2 = 0, raw_off2 = 0, smooth_off2 = 0;
		for (int k = 0; k < 30 * (int)RATES_HZ[i]; k++) {
			viewing_step(&viewing);
			const struct gz_gaze *now = &viewing.out.gaze;
			bool rests = k > 0 && viewing.in.truth.event == GZ_EVENT_FIXATION &&
				     last.truth.event == GZ_EVENT_FIXATION && !isnan(now->raw.x) &&
				     !isnan(before.raw.x);
			if (rests) {
				raw2 += pow(angle_deg(&viewing, now->raw, before.raw), 2);
				smooth2 += pow(angle_deg(&viewing, now->point, before.point), 2);
				struct gz_point truth = viewing.in.truth.point;
				raw_off2 += pow(angle_deg(&viewing, now->raw, truth), 2);
				smooth_off2 += pow(angle_deg(&viewing, now->point, truth), 2);
			}
			last = viewing.in;
			before = *now;
		}
		CHECK_BETWEEN(sqrt(smooth2 / raw2), 0, 0.2);
		CHECK_BETWEEN(sqrt(smooth_off2 / raw_off2), 0, 0.8);
		CHECK_BETWEEN(gz_pipeline_noise_deg(&viewing.pipeline), 0.05, 0.3);
		viewing_close(&viewing);
	}
}

/* As when the computer is busy: the device goes on, and nothing is known of a blink. */
static void a_pause_of_the_device_is_no_blink(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	struct viewing viewing;
	int hidden = 0, pauses = 0;
	params.viewer.blinks_per_min = 0;
	params.viewer.pursuits_per_min = 0;
	viewing_open(&viewing, &params);
	for (int i = 0; i < 20000; i++) {
		gz_sim_tracker_next(viewing.tracker, &viewing.in);
		pauses += i % 500 == 0;
		if (i % 500 >= 45) { /* a pause of 90 ms in each second */
			gz_pipeline_step(&viewing.pipeline, &viewing.in.sample, &viewing.out);
			hidden += i > 500 && !(viewing.out.gaze.confidence > 0);
		}
	}
	viewing_close(&viewing);
	assert_true(hidden < pauses); /* of 455 samples behind each */
}

static void a_step_costs_a_few_microseconds(void **state)
{
	(void)state;
	enum { SAMPLES = 40000 };
	struct gz_sim_params params = sim_params(1200);
	struct viewing viewing;
	viewing_open(&viewing, &params);
	struct gz_sample *samples = calloc(SAMPLES, sizeof *samples);
	assert_non_null(samples);
	for (int k = 0; k < SAMPLES; k++) {
		gz_sim_tracker_next(viewing.tracker, &viewing.in);
		samples[k] = viewing.in.sample;
	}
	clock_t begin = clock();
	for (int k = 0; k < SAMPLES; k++)
		gz_pipeline_step(&viewing.pipeline, &samples[k], &viewing.out);
	double step_us = (double)(clock() - begin) / CLOCKS_PER_SEC * 1e6 / SAMPLES;
	print_message("%.2f us a step at 1200 Hz\n", step_us);
	CHECK_BETWEEN(step_us, 0, 50); /* also holds with sanitizers on a busy machine */
	free(samples);
	viewing_close(&viewing);
}

static void every_preset_parses_and_prints_the_same(void **state)
{
	(void)state;
	struct gz_pipeline_params params;
	size_t covered = 0;
	for (size_t i = 0; i < gz_pipeline_option_count; i++) {
		const struct gz_option *option = &gz_pipeline_options[i];
		char message[256] = "", text[64];
		assert_int_equal(strncmp(option->key, "pipeline.", 9), 0);
		if (gz_option_parse(option, option->preset, &params, message, sizeof message) !=
		    GZ_OK)
			fail_msg("%s: %s", option->key, message);
		assert_int_equal(gz_option_format(option, &params, text, sizeof text), GZ_OK);
		assert_string_equal(text, option->preset);
		if (option->type == GZ_OPTION_DOUBLE)
			covered += sizeof(double) * (size_t)(option->count ? option->count : 1);
		else if (option->type != GZ_OPTION_BOOL) /* which lies in the padding of an int */
			covered += sizeof(double);       /* an int and the padding after it */
	}
	/* Every field has an option: the table covers the whole struct. */
	assert_int_equal(covered, sizeof params);
}

/* The source of labels in a replay of a log with one setting, or with none. */
static enum gz_classify_source recorded_source(const char *key, const char *value)
{
	struct gz_gaze_log_header *header = calloc(1, sizeof *header);
	struct gz_pipeline_params params;
	assert_non_null(header);
	header->setting_count = key ? 1 : 0;
	if (key) {
		strcpy(header->settings[0].key, key);
		strcpy(header->settings[0].value, value);
	}
	assert_int_equal(gz_pipeline_recorded_params(header, "a.gzl", NULL, &params), GZ_OK);
	free(header);
	return params.classify.source;
}

static void logs_older_than_the_forests_replay_with_rules(void **state)
{
	(void)state;
	assert_int_equal(recorded_source("dropout_ms", "10"), GZ_CLASSIFY_RULES);
	assert_int_equal(recorded_source("labels", "learned"), GZ_CLASSIFY_LEARNED);
	assert_int_equal(recorded_source("labels", "rules"), GZ_CLASSIFY_RULES);
	assert_int_equal(recorded_source(NULL, NULL), GZ_CLASSIFY_LEARNED);
}

TEST_SUITE(pipeline)
{
	if (!read_tested_params(argc, argv))
		return 2;
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_rate_gives_finite_numbers_and_time_forwards),
		cmocka_unit_test(wild_samples_give_finite_numbers),
		cmocka_unit_test(before_any_good_sample_gaze_is_lost_at_the_centre),
		cmocka_unit_test(sample_not_newer_changes_nothing),
		cmocka_unit_test(damaged_times_never_bring_time_back),
		cmocka_unit_test(copied_state_goes_on_in_the_same_way),
		cmocka_unit_test(certain_labels_come_in_order_within_10_ms),
		cmocka_unit_test(labels_that_wait_longer_are_the_same),
		cmocka_unit_test(each_sample_gets_one_certain_label_whatever_the_gaps),
		cmocka_unit_test(an_eye_dropping_out_does_not_move_the_point),
		cmocka_unit_test(saccades_are_found_at_any_rate),
		cmocka_unit_test(in_a_still_scene_there_is_no_pursuit),
		cmocka_unit_test(scene_may_become_still_and_move_again_in_mid_stream),
		cmocka_unit_test(a_resting_eye_gives_a_resting_point),
		cmocka_unit_test(a_pause_of_the_device_is_no_blink),
		cmocka_unit_test(a_step_costs_a_few_microseconds),
		cmocka_unit_test(every_preset_parses_and_prints_the_same),
		cmocka_unit_test(logs_older_than_the_forests_replay_with_rules),
	};
	return cmocka_run_group_tests_name("filter.pipeline", tests, NULL, NULL);
}
