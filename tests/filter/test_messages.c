#include "suite.h"

#include "filter/viewing.h"

#include <stdlib.h>

/* Fixations and blinks in a run with blinks. */
struct blink_run {
	int64_t blink_begin_ns; /* of the present true blink; 0 if none */
	int truths, onsets, offsets, fixations;
	struct gz_point held;
	int64_t ended_ns[64]; /* ends and beginnings of the newest true blinks, for fixations */
	int64_t begun_ns[64];
};

static void check_no_fixation_across(const struct blink_run *run, const struct gz_fixation *f)
{
	for (int i = 0; i < 64; i++) {
		bool across = run->begun_ns[i] > 0 && f->onset_ns < run->begun_ns[i] &&
			      f->onset_ns + f->duration_ns > run->ended_ns[i];
		assert_false(across);
	}
}

static void follow_blinks(struct blink_run *run, const struct viewing *viewing, double rate_hz)
{
	const struct gz_gaze *gaze = &viewing->out.gaze;
	bool blinks = viewing->in.truth.event == GZ_EVENT_BLINK;
	int64_t now_ns = viewing->in.sample.host_ns;
	if (blinks && run->blink_begin_ns == 0) {
		run->blink_begin_ns = now_ns;
		run->truths++;
	}
	if (blinks) {
		double since_ms = gz_ns_to_ms(now_ns - run->blink_begin_ns);
		assert_true(gaze->confidence == 0);
		assert_true(gaze->point.x == run->held.x && gaze->point.y == run->held.y);
		if (since_ms > 10 + 1000 / rate_hz)
			assert_int_equal(gaze->event, GZ_EVENT_BLINK);
	} else if (run->blink_begin_ns != 0) {
		run->begun_ns[run->truths % 64] = run->blink_begin_ns;
		run->ended_ns[run->truths % 64] = now_ns;
		run->blink_begin_ns = 0;
	}
	run->held = gaze->point;
	for (size_t i = 0; i < viewing->out.blink_count; i++) {
		run->onsets += viewing->out.blinks[i].onset;
		run->offsets += !viewing->out.blinks[i].onset;
		assert_true(run->onsets - run->offsets == 0 || run->onsets - run->offsets == 1);
		assert_true(viewing->out.blinks[i].confidence == 1);
	}
	for (size_t i = 0; i < viewing->out.fixation_count; i++) {
		check_no_fixation_across(run, &viewing->out.fixations[i]);
		run->fixations++;
	}
}

static void no_fixation_lasts_across_a_blink(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.loss = params.eye_loss = params.spikes = 0;
		params.viewer.blinks_per_min = 40;
		struct viewing viewing;
		struct blink_run run = { .truths = 0 };
		viewing_open(&viewing, &params);
		for (int k = 0; k < 30 * (int)RATES_HZ[i]; k++) {
			viewing_step(&viewing);
			follow_blinks(&run, &viewing, RATES_HZ[i]);
		}
		CHECK_BETWEEN(run.truths, 10, 30);
		CHECK_BETWEEN(run.onsets, run.truths - 1, run.truths);
		CHECK_BETWEEN(run.offsets, run.truths - 1, run.truths);
		assert_true(run.fixations > 20);
		viewing_close(&viewing);
	}
}

static struct gz_sample steady_sample(uint64_t seq, int64_t time_ns, bool valid)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.seq = seq;
	sample.host_ns = time_ns;
	sample.valid = valid;
	if (valid) /* not quite still */
		sample.point = (struct gz_point) { 0.3f + 0.0002f * (float)(seq % 3),
						   0.6f + 0.0002f * (float)(seq % 5) };
	return sample;
}

/* Messages and events of a stretch of samples. */
struct tally {
	int onsets, offsets, finals, events[GZ_EVENT_COUNT];
	float offset_confidence;
	enum gz_event last;
};

static void feed(struct gz_pipeline *pipeline, uint64_t *seq, int64_t *time_ns, int count,
		 bool valid, struct tally *tally)
{
	*tally = (struct tally) { .onsets = 0 };
	for (int k = 0; k < count; k++) {
		struct gz_sample sample = steady_sample((*seq)++, *time_ns += 5000000, valid);
		struct gz_pipeline_output out;
		gz_pipeline_step(pipeline, &sample, &out);
		tally->events[out.gaze.event]++;
		tally->last = out.gaze.event;
		for (size_t i = 0; i < out.blink_count; i++) {
			tally->onsets += out.blinks[i].onset;
			tally->offsets += !out.blinks[i].onset;
			if (!out.blinks[i].onset)
				tally->offset_confidence = out.blinks[i].confidence;
		}
		for (size_t i = 0; i < out.fixation_count; i++)
			tally->finals += out.fixations[i].final;
	}
}

static void a_loss_over_500_ms_is_lost_gaze(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &tested_params, &display);
	uint64_t seq = 0;
	int64_t time_ns = VIEWING_START_NS;
	struct tally tally;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	assert_int_equal(tally.events[GZ_EVENT_FIXATION], 200);

	feed(&pipeline, &seq, &time_ns, 100, false, &tally); /* 500 ms after the last good one */
	assert_int_equal(tally.last, GZ_EVENT_BLINK);
	assert_int_equal(tally.onsets, 1);
	assert_int_equal(tally.offsets, 0);
	assert_int_equal(tally.finals, 1);
	CHECK_BETWEEN(tally.events[GZ_EVENT_FIXATION], 0, 2);

	feed(&pipeline, &seq, &time_ns, 100, false, &tally);
	assert_int_equal(tally.events[GZ_EVENT_LOST], 100);
	assert_int_equal(tally.offsets, 1); /* it was no blink */
	assert_true(tally.offset_confidence == 0);

	feed(&pipeline, &seq, &time_ns, 100, true, &tally);
	assert_int_equal(tally.events[GZ_EVENT_FIXATION], 100);
	assert_int_equal(tally.onsets + tally.offsets, 0);
}

static void a_gap_in_time_is_a_blink_up_to_500_ms(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &tested_params, &display);
	uint64_t seq = 0;
	int64_t time_ns = VIEWING_START_NS;
	struct tally tally;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	time_ns += 200 * GZ_NS_PER_MS;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	assert_int_equal(tally.onsets, 1);
	assert_int_equal(tally.offsets, 1);
	assert_int_equal(tally.finals, 1);
	time_ns += 2 * GZ_NS_PER_S;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	assert_int_equal(tally.onsets + tally.offsets, 0);
	assert_int_equal(tally.finals, 1);
}

static void a_dropout_of_few_ms_is_no_blink(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &tested_params, &display);
	uint64_t seq = 0;
	int64_t time_ns = VIEWING_START_NS;
	struct tally tally;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	for (int i = 0; i < 20; i++) {
		feed(&pipeline, &seq, &time_ns, 1, false, &tally);
		assert_int_equal(tally.last, GZ_EVENT_FIXATION);
		feed(&pipeline, &seq, &time_ns, 10, true, &tally);
		assert_int_equal(tally.events[GZ_EVENT_FIXATION], 10);
		assert_int_equal(tally.onsets + tally.finals, 0);
	}
}

/* One fixation, from its messages. */
struct told_fixation {
	bool open;
	struct gz_fixation last;
	int64_t sent_ns;
	int count;
};

static void follow_fixation(struct told_fixation *told, const struct gz_fixation *f, int64_t now_ns)
{
	if (!told->open) {
		assert_false(f->final);
		assert_true(f->duration_ns >= 40 * GZ_NS_PER_MS);
		assert_true(told->count == 0 || f->id > told->last.id);
		assert_true(told->count == 0 ||
			    f->onset_ns >= told->last.onset_ns + told->last.duration_ns);
		told->count++;
	} else {
		assert_int_equal(f->id, told->last.id);
		assert_int_equal(f->onset_ns, told->last.onset_ns);
		assert_true(f->duration_ns >= told->last.duration_ns);
		if (!f->final)
			assert_true(now_ns - told->sent_ns >= GZ_FIXATION_INTERVAL_NS);
	}
	CHECK_BETWEEN(f->dispersion_deg, 0, 10);
	told->open = !f->final;
	told->last = *f;
	told->sent_ns = now_ns;
}

static void fixations_are_reported_from_onset_to_end(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		struct viewing viewing;
		struct told_fixation told = { .open = false };
		viewing_open(&viewing, &params);
		int count = 30 * (int)RATES_HZ[i];
		int64_t *times_ns = calloc((size_t)count, sizeof *times_ns);
		assert_non_null(times_ns);
		for (int k = 0; k < count; k++) {
			viewing_step(&viewing);
			times_ns[k] = viewing.in.sample.host_ns;
			for (size_t n = 0; n < viewing.out.fixation_count; n++) {
				const struct gz_fixation *f = &viewing.out.fixations[n];
				follow_fixation(&told, f, times_ns[k]);
				assert_int_equal(times_ns[f->id], f->onset_ns);
			}
		}
		CHECK_BETWEEN(told.count, 30, 120);
		free(times_ns);
		viewing_close(&viewing);
	}
}

static void saccades_are_reported_as_they_were(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	params.viewer.blinks_per_min = params.viewer.microsaccades_per_s = 0;
	params.spikes = params.loss = 0;
	struct viewing viewing;
	viewing_open(&viewing, &params);
	struct gz_point start = { 0.5f, 0.5f };
	enum gz_event last = GZ_EVENT_FIXATION;
	double true_sum_deg = 0, told_sum_deg = 0;
	int truths = 0, told = 0, slow = 0;
	for (int k = 0; k < 60 * 500; k++) {
		viewing_step(&viewing);
		enum gz_event now = viewing.in.truth.event;
		if (now == GZ_EVENT_SACCADE && last != GZ_EVENT_SACCADE)
			start = viewing.in.truth.point;
		if (now != GZ_EVENT_SACCADE && last == GZ_EVENT_SACCADE) {
			truths++;
			true_sum_deg += angle_deg(&viewing, start, viewing.in.truth.point);
		}
		last = now;
		if (viewing.out.saccade_count == 0)
			continue;
		told++;
		told_sum_deg += viewing.out.saccades[0].amplitude_deg;
		slow += viewing.out.saccades[0].peak_velocity_deg_s < 20;
		CHECK_BETWEEN(viewing.out.saccades[0].peak_velocity_deg_s, 5, 1100);
		CHECK_BETWEEN(gz_ns_to_ms(viewing.out.saccades[0].duration_ns), 2, 210);
	}
	CHECK_BETWEEN((double)told / truths, 0.9, 1.15);
	CHECK_BETWEEN(slow, 0, 0.02 * told); /* noise that looks like a small saccade */
	CHECK_BETWEEN(told_sum_deg / true_sum_deg, 0.9, 1.1);
	viewing_close(&viewing);
}

TEST_SUITE(messages)
{
	if (!read_tested_params(argc, argv))
		return 2;
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_fixation_lasts_across_a_blink),
		cmocka_unit_test(a_loss_over_500_ms_is_lost_gaze),
		cmocka_unit_test(a_gap_in_time_is_a_blink_up_to_500_ms),
		cmocka_unit_test(a_dropout_of_few_ms_is_no_blink),
		cmocka_unit_test(fixations_are_reported_from_onset_to_end),
		cmocka_unit_test(saccades_are_reported_as_they_were),
	};
	return cmocka_run_group_tests_name("filter.messages", tests, NULL, NULL);
}
