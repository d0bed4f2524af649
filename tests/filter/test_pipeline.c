#include "filter/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "filter/pipeline.h"
#include "sim/tracker.h"

static const int64_t START_NS = INT64_C(5000000000);

static const double RATES_HZ[] = { 30, 60, 120, 250, 300, 500, 1000, 1200, 2000 };
enum { RATE_COUNT = sizeof RATES_HZ / sizeof RATES_HZ[0] };

/** A simulator and a pipeline behind it. */
struct bench {
	struct gz_sim_tracker *tracker;
	struct gz_pipeline pipeline;
	struct gz_sim_sample in;
	struct gz_pipeline_output out;
};

static void bench_open(struct bench *bench, const struct gz_sim_params *params)
{
	*bench = (struct bench) { .tracker = NULL };
	assert_int_equal(gz_sim_tracker_create(params, START_NS, NULL, &bench->tracker), GZ_OK);
	struct gz_display display = gz_sim_tracker_display(bench->tracker);
	gz_pipeline_init(&bench->pipeline, NULL, &display);
}

static void bench_step(struct bench *bench)
{
	gz_sim_tracker_next(bench->tracker, &bench->in);
	gz_pipeline_step(&bench->pipeline, &bench->in.sample, &bench->out);
}

static void bench_close(struct bench *bench)
{
	gz_sim_tracker_destroy(&bench->tracker);
}

static struct gz_sim_params sim_params(double rate_hz)
{
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = rate_hz;
	return params;
}

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
		assert_true(s->duration_ns > 0 && !s->has_prediction);
	}
}

static void check_output(const struct bench *bench, int64_t last_ns)
{
	const struct gz_gaze *gaze = &bench->out.gaze;
	assert_true(finite_point(gaze->point));
	assert_true(isfinite(gaze->velocity_deg_s) && gaze->velocity_deg_s >= 0);
	CHECK_BETWEEN(gaze->confidence, 0, 1);
	CHECK_BETWEEN(gaze->event, 0, GZ_EVENT_COUNT - 1);
	assert_true(gaze->host_ns >= last_ns);
	assert_int_equal(gaze->publish_ns, 0);
	assert_int_equal(isnan(gaze->raw.x) != 0, bench->out.rejection != GZ_REJECT_NONE);
	check_messages(&bench->out);
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
		struct bench bench;
		bench_open(&bench, &params);
		int64_t last_ns = 0;
		for (int k = 0; k < 30 * (int)RATES_HZ[i]; k++) {
			bench_step(&bench);
			check_output(&bench, last_ns);
			last_ns = bench.out.gaze.host_ns;
		}
		bench_close(&bench);
	}
}

/** Random bytes as numbers: NaN, infinite, huge, far outside. */
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
	gz_pipeline_init(&pipeline, NULL, &display);
	struct bench bench = { .tracker = NULL };
	int64_t time_ns = START_NS, last_ns = 0;
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
		gz_pipeline_step(&pipeline, &sample, &bench.out);
		check_output(&bench, last_ns);
		last_ns = bench.out.gaze.host_ns;
	}
}

static void before_any_good_sample_gaze_is_lost_at_the_centre(void **state)
{
	(void)state;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, NULL, &display);
	for (uint64_t k = 0; k < 100; k++) {
		struct gz_sample sample = gz_sample_unmeasured();
		sample.seq = k;
		sample.host_ns = START_NS + (int64_t)k * 10000000;
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
	struct bench bench;
	bench_open(&bench, &params);
	for (int k = 0; k < 700; k++)
		bench_step(&bench);
	struct gz_pipeline before = bench.pipeline;
	struct gz_gaze gaze = bench.out.gaze;
	struct gz_sample old = bench.in.sample;
	gz_pipeline_step(&bench.pipeline, &old, &bench.out);
	assert_int_equal(bench.out.rejection, GZ_REJECT_TIME);
	old.host_ns -= 100;
	gz_pipeline_step(&bench.pipeline, &old, &bench.out);
	assert_int_equal(bench.out.rejection, GZ_REJECT_TIME);
	assert_memory_equal(&before, &bench.pipeline, sizeof before);
	assert_true(bench.out.gaze.host_ns == gaze.host_ns);
	assert_true(bench.out.gaze.point.x == gaze.point.x && bench.out.gaze.confidence == 0);
	assert_int_equal(bench.out.gaze.event, gaze.event);
	bench_close(&bench);
}

static void copied_state_goes_on_in_the_same_way(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	struct bench bench;
	bench_open(&bench, &params);
	for (int k = 0; k < 3000; k++)
		bench_step(&bench);
	struct gz_pipeline copy = bench.pipeline;
	for (int k = 0; k < 3000; k++) {
		bench_step(&bench);
		struct gz_pipeline_output out;
		gz_pipeline_step(&copy, &bench.in.sample, &out);
		assert_true(out.gaze.point.x == bench.out.gaze.point.x);
		assert_int_equal(out.gaze.event, bench.out.gaze.event);
		assert_int_equal(out.gaze.final_seq, bench.out.gaze.final_seq);
	}
	bench_close(&bench);
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
		struct bench bench;
		bench_open(&bench, &params);
		uint64_t next = 0;
		int count = 20 * (int)RATES_HZ[i];
		for (int k = 0; k < count; k++) {
			bench_step(&bench);
			times_ns[k] = bench.in.sample.host_ns;
			if (!bench.out.gaze.final_known)
				continue;
			uint64_t seq = bench.out.gaze.final_seq;
			double age_ms = gz_ns_to_ms(times_ns[k] - times_ns[seq]);
			CHECK_BETWEEN(age_ms, 0, 10.0001);
			if (k > 20) /* the rate is known by then */
				assert_int_equal(seq, next);
			next = seq + 1;
		}
		CHECK_BETWEEN((double)count - (double)next, 0, 20);
		bench_close(&bench);
	}
	free(times_ns);
}

static double angle_deg(const struct bench *bench, struct gz_point a, struct gz_point b)
{
	return gz_display_angle_deg(&bench->pipeline.display, a, b);
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
		struct bench bench;
		bench_open(&bench, &params);
		bench_step(&bench);
		struct gz_sim_sample last = bench.in;
		struct gz_gaze before = bench.out.gaze;
		int changes = 0;
		for (int k = 0; k < 60 * (int)RATES_HZ[i]; k++) {
			bench_step(&bench);
			bool rested = bench.in.truth.event == GZ_EVENT_FIXATION &&
				      bench.in.truth.fixation == last.truth.fixation &&
				      bench.in.sample.valid && last.sample.valid;
			bool change = bench.in.sample.eye[0].valid != last.sample.eye[0].valid ||
				      bench.in.sample.eye[1].valid != last.sample.eye[1].valid;
			if (rested && change) {
				CHECK_BETWEEN(angle_deg(&bench, bench.out.gaze.raw, before.raw), 0,
					      0.2);
				changes++;
			}
			last = bench.in;
			before = bench.out.gaze;
		}
		assert_true(changes > 20);
		bench_close(&bench);
	}
}

/** What is seen of fixations and blinks in a run with blinks. */
struct blink_run {
	int64_t blink_begin_ns; /**< of the running true blink; 0 if none */
	int truths, onsets, offsets, fixations;
	struct gz_point held;
	int64_t ended_ns[64]; /**< newest true blinks' ends and beginnings, for fixations */
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

static void follow_blinks(struct blink_run *run, const struct bench *bench, double rate_hz)
{
	const struct gz_gaze *gaze = &bench->out.gaze;
	bool blinks = bench->in.truth.event == GZ_EVENT_BLINK;
	int64_t now_ns = bench->in.sample.host_ns;
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
	for (size_t i = 0; i < bench->out.blink_count; i++) {
		run->onsets += bench->out.blinks[i].onset;
		run->offsets += !bench->out.blinks[i].onset;
		assert_true(run->onsets - run->offsets == 0 || run->onsets - run->offsets == 1);
		assert_true(bench->out.blinks[i].confidence == 1);
	}
	for (size_t i = 0; i < bench->out.fixation_count; i++) {
		check_no_fixation_across(run, &bench->out.fixations[i]);
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
		struct bench bench;
		struct blink_run run = { .truths = 0 };
		bench_open(&bench, &params);
		for (int k = 0; k < 60 * (int)RATES_HZ[i]; k++) {
			bench_step(&bench);
			follow_blinks(&run, &bench, RATES_HZ[i]);
		}
		CHECK_BETWEEN(run.truths, 20, 60);
		CHECK_BETWEEN(run.onsets, run.truths - 1, run.truths);
		CHECK_BETWEEN(run.offsets, run.truths - 1, run.truths);
		assert_true(run.fixations > 40);
		bench_close(&bench);
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

/** Messages and events of a stretch. */
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
	gz_pipeline_init(&pipeline, NULL, &display);
	uint64_t seq = 0;
	int64_t time_ns = START_NS;
	struct tally tally;
	feed(&pipeline, &seq, &time_ns, 200, true, &tally);
	assert_int_equal(tally.events[GZ_EVENT_FIXATION], 200);

	feed(&pipeline, &seq, &time_ns, 100, false, &tally); /* 500 ms to the last good one */
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
	gz_pipeline_init(&pipeline, NULL, &display);
	uint64_t seq = 0;
	int64_t time_ns = START_NS;
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
	gz_pipeline_init(&pipeline, NULL, &display);
	uint64_t seq = 0;
	int64_t time_ns = START_NS;
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

/** One fixation as its messages tell it. */
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

static void fixations_are_told_from_onset_to_end(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		struct bench bench;
		struct told_fixation told = { .open = false };
		bench_open(&bench, &params);
		int count = 60 * (int)RATES_HZ[i];
		int64_t *times_ns = calloc((size_t)count, sizeof *times_ns);
		assert_non_null(times_ns);
		for (int k = 0; k < count; k++) {
			bench_step(&bench);
			times_ns[k] = bench.in.sample.host_ns;
			for (size_t n = 0; n < bench.out.fixation_count; n++) {
				const struct gz_fixation *f = &bench.out.fixations[n];
				follow_fixation(&told, f, times_ns[k]);
				assert_int_equal(times_ns[f->id], f->onset_ns);
			}
		}
		CHECK_BETWEEN(told.count, 60, 240);
		free(times_ns);
		bench_close(&bench);
	}
}

static void saccades_are_told_as_they_were(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(500);
	params.viewer.blinks_per_min = params.viewer.microsaccades_per_s = 0;
	params.spikes = params.loss = 0;
	struct bench bench;
	bench_open(&bench, &params);
	struct gz_point start = { 0.5f, 0.5f };
	enum gz_event last = GZ_EVENT_FIXATION;
	double true_sum_deg = 0, told_sum_deg = 0;
	int truths = 0, told = 0;
	for (int k = 0; k < 60 * 500; k++) {
		bench_step(&bench);
		enum gz_event now = bench.in.truth.event;
		if (now == GZ_EVENT_SACCADE && last != GZ_EVENT_SACCADE)
			start = bench.in.truth.point;
		if (now != GZ_EVENT_SACCADE && last == GZ_EVENT_SACCADE) {
			truths++;
			true_sum_deg += angle_deg(&bench, start, bench.in.truth.point);
		}
		last = now;
		if (bench.out.saccade_count == 0)
			continue;
		told++;
		told_sum_deg += bench.out.saccades[0].amplitude_deg;
		CHECK_BETWEEN(bench.out.saccades[0].peak_velocity_deg_s, 20, 1100);
		CHECK_BETWEEN(gz_ns_to_ms(bench.out.saccades[0].duration_ns), 2, 210);
	}
	CHECK_BETWEEN((double)told / truths, 0.9, 1.15);
	CHECK_BETWEEN(told_sum_deg / true_sum_deg, 0.9, 1.1);
	bench_close(&bench);
}

/** Share of samples that are really saccades and are said to be, and the other way round. */
static void saccades_are_found_at_any_rate(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		for (int combined = 0; combined < 2; combined++) {
			struct gz_sim_params params = sim_params(RATES_HZ[i]);
			params.combined_only = combined;
			params.loss = 0;
			struct bench bench;
			bench_open(&bench, &params);
			int count = 120 * (int)RATES_HZ[i];
			enum gz_event *truth = calloc((size_t)count, sizeof *truth);
			assert_non_null(truth);
			double hits = 0, truths = 0, ours = 0;
			for (int k = 0; k < count; k++) {
				bench_step(&bench);
				truth[k] = bench.in.truth.event;
				truths += truth[k] == GZ_EVENT_SACCADE;
				if (!bench.out.gaze.final_known ||
				    bench.out.gaze.final_event != GZ_EVENT_SACCADE)
					continue;
				ours++;
				hits += truth[bench.out.gaze.final_seq] == GZ_EVENT_SACCADE;
			}
			double found = 2 * hits / (truths + ours); /* F1 score */
			CHECK_BETWEEN(found, RATES_HZ[i] < 100 ? 0.5 : 0.8, 1);
			free(truth);
			bench_close(&bench);
		}
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
		struct bench bench;
		bench_open(&bench, &params);
		struct gz_sim_sample last = { .arrival_ns = 0 };
		struct gz_gaze before = { .seq = 0 };
		double raw2 = 0, smooth2 = 0, raw_off2 = 0, smooth_off2 = 0;
		for (int k = 0; k < 60 * (int)RATES_HZ[i]; k++) {
			bench_step(&bench);
			const struct gz_gaze *now = &bench.out.gaze;
			bool rests = k > 0 && bench.in.truth.event == GZ_EVENT_FIXATION &&
				     last.truth.event == GZ_EVENT_FIXATION && !isnan(now->raw.x) &&
				     !isnan(before.raw.x);
			if (rests) {
				raw2 += pow(angle_deg(&bench, now->raw, before.raw), 2);
				smooth2 += pow(angle_deg(&bench, now->point, before.point), 2);
				struct gz_point truth = bench.in.truth.point;
				raw_off2 += pow(angle_deg(&bench, now->raw, truth), 2);
				smooth_off2 += pow(angle_deg(&bench, now->point, truth), 2);
			}
			last = bench.in;
			before = *now;
		}
		CHECK_BETWEEN(sqrt(smooth2 / raw2), 0, 0.2);
		CHECK_BETWEEN(sqrt(smooth_off2 / raw_off2), 0, 0.8);
		CHECK_BETWEEN(gz_pipeline_noise_deg(&bench.pipeline), 0.05, 0.3);
		bench_close(&bench);
	}
}

static void a_step_costs_about_a_microsecond(void **state)
{
	(void)state;
	enum { SAMPLES = 40000 };
	struct gz_sim_params params = sim_params(1200);
	struct bench bench;
	bench_open(&bench, &params);
	struct gz_sample *samples = calloc(SAMPLES, sizeof *samples);
	assert_non_null(samples);
	for (int k = 0; k < SAMPLES; k++) {
		gz_sim_tracker_next(bench.tracker, &bench.in);
		samples[k] = bench.in.sample;
	}
	clock_t begin = clock();
	for (int k = 0; k < SAMPLES; k++)
		gz_pipeline_step(&bench.pipeline, &samples[k], &bench.out);
	double step_us = (double)(clock() - begin) / CLOCKS_PER_SEC * 1e6 / SAMPLES;
	print_message("%.2f us a step at 1200 Hz\n", step_us);
	CHECK_BETWEEN(step_us, 0, 50); /* also with sanitizers, on a busy machine */
	free(samples);
	bench_close(&bench);
}

static void every_preset_parses_and_prints_the_same(void **state)
{
	(void)state;
	struct gz_pipeline_params params;
	for (size_t i = 0; i < gz_pipeline_option_count; i++) {
		const struct gz_option *option = &gz_pipeline_options[i];
		char message[256] = "", text[64];
		assert_int_equal(strncmp(option->key, "pipeline.", 9), 0);
		if (gz_option_parse(option, option->preset, &params, message, sizeof message) !=
		    GZ_OK)
			fail_msg("%s: %s", option->key, message);
		assert_int_equal(gz_option_format(option, &params, text, sizeof text), GZ_OK);
		assert_string_equal(text, option->preset);
	}
	/* Every field has its option: the table covers the whole struct. */
	assert_int_equal(gz_pipeline_option_count * sizeof(double), sizeof params);
}

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_rate_gives_finite_numbers_and_time_forwards),
		cmocka_unit_test(wild_samples_give_finite_numbers),
		cmocka_unit_test(before_any_good_sample_gaze_is_lost_at_the_centre),
		cmocka_unit_test(sample_not_newer_changes_nothing),
		cmocka_unit_test(copied_state_goes_on_in_the_same_way),
		cmocka_unit_test(certain_labels_come_in_order_within_10_ms),
		cmocka_unit_test(an_eye_dropping_out_does_not_move_the_point),
		cmocka_unit_test(no_fixation_lasts_across_a_blink),
		cmocka_unit_test(a_loss_over_500_ms_is_lost_gaze),
		cmocka_unit_test(a_gap_in_time_is_a_blink_up_to_500_ms),
		cmocka_unit_test(a_dropout_of_few_ms_is_no_blink),
		cmocka_unit_test(fixations_are_told_from_onset_to_end),
		cmocka_unit_test(saccades_are_told_as_they_were),
		cmocka_unit_test(saccades_are_found_at_any_rate),
		cmocka_unit_test(a_resting_eye_gives_a_resting_point),
		cmocka_unit_test(a_step_costs_about_a_microsecond),
		cmocka_unit_test(every_preset_parses_and_prints_the_same),
	};
	return cmocka_run_group_tests_name("filter.pipeline", tests, NULL, NULL);
}
