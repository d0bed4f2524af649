/* Silence of HID trackers, and what the pipeline makes of it. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "drivers/hid/hid_device.h"
#include "filter/pipeline.h"

static const int64_t BEGIN_NS = 1000 * GZ_NS_PER_S;

/* Note @p count samples at a rate, and the fillers that the driver would make between them. @return
 * host time of the last sample */
static int64_t stream_from(struct gz_hid_silence *silence, int64_t begin_ns, double rate_hz,
			   int count, int *out_fillers)
{
	int64_t ns = begin_ns;
	*out_fillers = 0;
	for (int i = 0; i < count; i++) {
		ns = begin_ns + (int64_t)(1e9 * i / rate_hz);
		int64_t arrival_ns = ns + 2 * GZ_NS_PER_MS;
		while (gz_hid_silence_due_ns(silence) < arrival_ns) {
			gz_hid_silence_fill(silence);
			++*out_fillers;
		}
		gz_hid_silence_sample(silence, ns, arrival_ns);
	}
	return ns;
}

static int64_t stream(struct gz_hid_silence *silence, double rate_hz, int count)
{
	int fillers;
	int64_t ns = stream_from(silence, BEGIN_NS, rate_hz, count, &fillers);
	assert_int_equal(fillers, 0);
	return ns;
}

static void nothing_is_filled_in_before_the_first_sample(void **state)
{
	(void)state;
	struct gz_hid_silence silence = { .nominal_ns = 1e7 };
	assert_int_equal(gz_hid_silence_due_ns(&silence), INT64_MAX);
}

static void silence_begins_after_three_periods_and_gets_a_filler_each_period(void **state)
{
	(void)state;
	const double rates_hz[] = { 30, 60, 250, 2000 };
	for (size_t r = 0; r < 4; r++) {
		struct gz_hid_silence silence = { 0 };
		int64_t last_ns = stream(&silence, rates_hz[r], 200);
		int64_t arrival_ns = last_ns + 2 * GZ_NS_PER_MS;
		double period_ns = 1e9 / rates_hz[r];
		for (int i = 1; i <= 50; i++) {
			double due_ns = arrival_ns + period_ns * (i < 2 ? 3 : i + 1);
			assert_true(fabs((double)gz_hid_silence_due_ns(&silence) - due_ns) < 1e4);
			int64_t host_ns = gz_hid_silence_fill(&silence);
			/* Each has the time of the missing sample and comes one period late. */
			assert_true(fabs((double)host_ns - last_ns - period_ns * i) < 1e4);
			assert_true(host_ns + period_ns <= due_ns + 1e4);
		}
	}
}

static void silence_is_judged_by_the_measured_rate_not_by_the_stated_one(void **state)
{
	(void)state;
	/* It states 100 Hz, as the reference driver always does. */
	const double rates_hz[] = { 30, 1000 };
	for (size_t r = 0; r < 2; r++) {
		struct gz_hid_silence silence = { .nominal_ns = 1e7 };
		int64_t last_ns = stream(&silence, rates_hz[r], 40);
		double wait_ns = (double)(gz_hid_silence_due_ns(&silence) - last_ns) - 2e6;
		assert_true(fabs(wait_ns - 3e9 / rates_hz[r]) < 0.1e9 / rates_hz[r]);
	}
	struct gz_hid_silence unknown = { 0 };
	stream(&unknown, 1000, 2);
	assert_true(fabs(gz_hid_silence_period_ns(&unknown) - 1e9 / 30) < 1);
}

static void slower_tracker_is_not_silent_once_its_rate_is_measured(void **state)
{
	(void)state;
	struct gz_hid_silence silence = { 0 };
	int fillers;
	int64_t ns = stream(&silence, 120, 200);
	/* From 120 to 30 Hz: for less than a second this looks like blinks. */
	ns = stream_from(&silence, ns + 33333333, 30, 30, &fillers);
	assert_true(fillers > 0);
	stream_from(&silence, ns + 33333333, 30, 60, &fillers);
	assert_int_equal(fillers, 0);
}

static void silence_and_lost_samples_do_not_stretch_the_period(void **state)
{
	(void)state;
	struct gz_hid_silence silence = { 0 };
	int64_t ns = stream(&silence, 100, 100);
	for (int i = 0; i < 5; i++)
		gz_hid_silence_fill(&silence);
	gz_hid_silence_sample(&silence, ns + GZ_NS_PER_S, ns + GZ_NS_PER_S);
	assert_true(fabs(gz_hid_silence_period_ns(&silence) - 1e7) < 1e4);
	gz_hid_silence_sample(&silence, ns + GZ_NS_PER_S + 3 * 10000000, ns + 2 * GZ_NS_PER_S);
	assert_true(gz_hid_silence_period_ns(&silence) < 1.1e7);
}

static void gaps_between_bursts_are_not_silence(void **state)
{
	(void)state;
	/* 250 Hz, four at a time. */
	struct gz_hid_silence silence = { 0 };
	int early = 0;
	for (int i = 0; i < 400; i++) {
		int64_t ns = BEGIN_NS + i * 4 * GZ_NS_PER_MS;
		int64_t arrival_ns = BEGIN_NS + (i / 4 + 1) * 16 * GZ_NS_PER_MS;
		early += i >= 20 && gz_hid_silence_due_ns(&silence) <= arrival_ns;
		gz_hid_silence_sample(&silence, ns, arrival_ns);
	}
	assert_int_equal(early, 0);
	assert_true(gz_hid_silence_due_ns(&silence) - silence.arrival_ns <= 21 * GZ_NS_PER_MS);
	/* A single stall is forgotten. */
	stream(&silence, 250, 1);
	gz_hid_silence_sample(&silence, BEGIN_NS + 4 * GZ_NS_PER_MS, BEGIN_NS + GZ_NS_PER_S);
	assert_true(gz_hid_silence_due_ns(&silence) - silence.arrival_ns > 40 * GZ_NS_PER_MS);
	for (int i = 2; i < 150; i++)
		gz_hid_silence_sample(&silence, BEGIN_NS + i * 4 * GZ_NS_PER_MS,
				      BEGIN_NS + GZ_NS_PER_S + i * 4 * GZ_NS_PER_MS);
	assert_true(gz_hid_silence_due_ns(&silence) - silence.arrival_ns < 13 * GZ_NS_PER_MS);
}

/* Check the events of the pipeline for a tracker that is silent for @p silent_ms. */
static void expect_events(double rate_hz, int silent_ms)
{
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output out;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_hid_silence silence = { 0 };
	struct gz_sample sample = gz_sample_unmeasured();
	int64_t ns = BEGIN_NS, blink_ns = 0, lost_ns = 0;
	gz_pipeline_init(&pipeline, NULL, &display);
	for (int i = 0; i < 100; i++) {
		ns = BEGIN_NS + (int64_t)(1e9 * i / rate_hz);
		gz_hid_silence_sample(&silence, ns, ns);
		sample.host_ns = ns;
		sample.point = (struct gz_point) { 0.5f, 0.5f };
		sample.valid = true;
		sample.seq = (uint64_t)i;
		gz_pipeline_step(&pipeline, &sample, &out);
	}
	assert_int_equal(out.gaze.event, GZ_EVENT_FIXATION);
	uint64_t seq = sample.seq;
	while (gz_hid_silence_due_ns(&silence) - ns < silent_ms * GZ_NS_PER_MS) {
		int64_t now_ns = gz_hid_silence_due_ns(&silence);
		sample = gz_sample_unmeasured();
		sample.host_ns = gz_hid_silence_fill(&silence);
		sample.seq = ++seq;
		gz_pipeline_step(&pipeline, &sample, &out);
		if (out.gaze.event == GZ_EVENT_BLINK && blink_ns == 0)
			blink_ns = now_ns;
		if (out.gaze.event == GZ_EVENT_LOST && lost_ns == 0)
			lost_ns = sample.host_ns;
	}
	/* After three periods; at high rates after 10 ms of sample time. */
	double period_ms = 1e3 / rate_hz;
	double latest_ms = fmax(3 * period_ms, 10 + 2 * period_ms) + 0.1;
	if (blink_ns == 0 || gz_ns_to_ms(blink_ns - ns) > latest_ms)
		fail_msg("%g Hz: a blink after %g ms", rate_hz, gz_ns_to_ms(blink_ns - ns));
	double lost_ms = gz_ns_to_ms(lost_ns - ns);
	if (lost_ns == 0 || lost_ms < 500 || lost_ms > 500 + 2 * period_ms)
		fail_msg("%g Hz: lost after %g ms", rate_hz, lost_ms);
}

static void silence_is_a_blink_after_three_periods_and_a_loss_after_half_a_second(void **state)
{
	(void)state;
	const double rates_hz[] = { 30, 60, 90, 250, 1200 };
	for (size_t r = 0; r < sizeof rates_hz / sizeof *rates_hz; r++)
		expect_events(rates_hz[r], 1000);
}

TEST_SUITE(hid_silence)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_is_filled_in_before_the_first_sample),
		cmocka_unit_test(silence_begins_after_three_periods_and_gets_a_filler_each_period),
		cmocka_unit_test(silence_is_judged_by_the_measured_rate_not_by_the_stated_one),
		cmocka_unit_test(gaps_between_bursts_are_not_silence),
		cmocka_unit_test(slower_tracker_is_not_silent_once_its_rate_is_measured),
		cmocka_unit_test(silence_and_lost_samples_do_not_stretch_the_period),
		cmocka_unit_test(
			silence_is_a_blink_after_three_periods_and_a_loss_after_half_a_second),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
