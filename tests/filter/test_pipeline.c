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

int main(void)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_rate_gives_finite_numbers_and_time_forwards),
		cmocka_unit_test(wild_samples_give_finite_numbers),
		cmocka_unit_test(before_any_good_sample_gaze_is_lost_at_the_centre),
		cmocka_unit_test(sample_not_newer_changes_nothing),
		cmocka_unit_test(copied_state_goes_on_in_the_same_way),
		cmocka_unit_test(certain_labels_come_in_order_within_10_ms),
	};
	return cmocka_run_group_tests_name("filter.pipeline", tests, NULL, NULL);
}
