#include "suite.h"

#include "client/gazectl/inspect/log_summary.h"
#include "log_text.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

static struct gz_log_summary summary; /* large: not for the stack */

static enum gz_result summarize(const struct log_text *text)
{
	struct gz_gaze_log_reader *reader = NULL;
	assert_int_equal(
		gz_gaze_log_open_memory("test.gzl", text->bytes, text->size, NULL, &reader), GZ_OK);
	enum gz_result result = gz_log_summarize(reader, NULL, &summary);
	gz_gaze_log_close(&reader);
	return result;
}

static void assert_near(double value, double expected, double tolerance)
{
	if (!(fabs(value - expected) <= tolerance))
		fail_msg("%.9g is not within %g of %.9g", value, tolerance, expected);
}

static void whole_log_tells_length_rate_and_validity(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(summary.samples, 2000);
	assert_near(summary.duration_s, 1.999, 1e-9);
	assert_near(summary.rate_hz, 1000, 1e-6);
	assert_int_equal(summary.valid, 2000);
	assert_int_equal(summary.eye_valid[GZ_EYE_RIGHT], 2000);
	assert_int_equal(summary.eye_valid[GZ_EYE_LEFT], 2000);
	assert_true(summary.eye_measured[GZ_EYE_RIGHT] && summary.eye_measured[GZ_EYE_LEFT]);
	assert_int_equal(summary.gaps, 0);
	assert_int_equal(summary.malformed, 0);
}

static void look_to_the_right_is_one_saccade(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.saccades, 1);
	/* The second one has not ended when the log does. */
	assert_in_range(summary.fixations, 1, 2);
	assert_int_equal(summary.blinks, 0);
}

static void noise_is_the_jitter_between_samples(void **state)
{
	(void)state;
	/* 0.0005 of a display 50.4 deg wide to the right, at the points looked at. */
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_point at = { 0.3f, 0.5f }, beside = { 0.3005f, 0.5f };
	double jitter_deg = gz_display_angle_deg(&display, at, beside);
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0.0005f);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	/* A fixation may contain the first step of the saccade, half a degree. */
	assert_near(summary.noise_deg, jitter_deg, 0.25 * jitter_deg);
}

static void gap_counts_toward_the_rate(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	for (int i = 0; i < 100; i++)
		log_text_sample(&text, i * GZ_NS_PER_MS, 0.5f, 0.5f);
	log_text_gap(&text, 100 * GZ_NS_PER_MS, 50);
	for (int i = 150; i < 250; i++)
		log_text_sample(&text, i * GZ_NS_PER_MS, 0.5f, 0.5f);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.samples, 200);
	assert_int_equal(summary.gaps, 1);
	assert_int_equal(summary.missing, 50);
	assert_near(summary.rate_hz, 1000, 1e-6);
	assert_int_equal(summary.intervals.max_ns, 51 * GZ_NS_PER_MS);
	assert_int_equal(summary.intervals.bins[GZ_LOG_SUMMARY_BINS - 1], 1);
}

static void intervals_fall_into_their_bins(void **state)
{
	(void)state;
	/* In medians of 10 ms: 4 of 1, one each of 0.4, 0.8, 1.2, 2, 3, 20; and a step back. */
	static const int steps_ms[] = { 10, 10, 4, 8, 10, 12, 20, 30, 10, 200 };
	static const uint64_t expected[GZ_LOG_SUMMARY_BINS] = { 1, 0, 1, 4, 1, 0, 1, 1, 0, 1 };
	struct log_text text;
	log_text_begin(&text);
	int64_t time_ns = 0;
	log_text_sample(&text, time_ns, 0.5f, 0.5f);
	for (size_t i = 0; i < sizeof steps_ms / sizeof steps_ms[0]; i++) {
		time_ns += steps_ms[i] * GZ_NS_PER_MS;
		log_text_sample(&text, time_ns, 0.5f, 0.5f);
	}
	log_text_sample(&text, time_ns, 0.5f, 0.5f);
	log_text_sample(&text, time_ns - 5, 0.5f, 0.5f);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.intervals.count, 10);
	assert_int_equal(summary.intervals.backward, 2);
	assert_int_equal(summary.intervals.min_ns, 4 * GZ_NS_PER_MS);
	assert_int_equal(summary.intervals.median_ns, 10 * GZ_NS_PER_MS);
	assert_int_equal(summary.intervals.p99_ns, 200 * GZ_NS_PER_MS);
	for (int i = 0; i < GZ_LOG_SUMMARY_BINS; i++)
		if (summary.intervals.bins[i] != expected[i])
			fail_msg("bin %d holds %llu, not %llu", i,
				 (unsigned long long)summary.intervals.bins[i],
				 (unsigned long long)expected[i]);
}

static void marks_are_kept_to_a_limit_and_counted_beyond(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	for (int i = 0; i < GZ_LOG_SUMMARY_MARKS + 5; i++)
		log_text_mark(&text, i, i == 3 ? "trial\t4" : "m");
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.mark_count, GZ_LOG_SUMMARY_MARKS + 5);
	assert_int_equal(summary.marks[3].host_ns, 3);
	assert_string_equal(summary.marks[3].text, "trial\t4");
	assert_int_equal(summary.samples, 0);
	assert_near(summary.rate_hz, 0, 0);
	assert_true(isnan(summary.noise_deg));
}

static void combined_only_log_has_no_eyes(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
					     .sample = gz_sample_unmeasured() };
	record.sample.point = (struct gz_point) { 0.5f, 0.5f };
	record.sample.valid = true;
	log_text_record(&text, &record);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.valid, 1);
	assert_false(summary.eye_measured[GZ_EYE_RIGHT] || summary.eye_measured[GZ_EYE_LEFT]);
}

static void cut_log_is_summarized_to_its_last_whole_line(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	text.size -= 7;
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.ending, GZ_GAZE_LOG_CUT);
	assert_int_equal(summary.samples, 1999);
}

static void changed_log_is_called_corrupted(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_look_right(&text, 0);
	log_text_end(&text);
	char *place = memmem(text.bytes, text.size, "0.300000012", 11);
	assert_non_null(place);
	place[2] = '2';
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.ending, GZ_GAZE_LOG_CORRUPTED);
	assert_int_equal(summary.samples, 2000);
}

static void malformed_lines_are_counted_and_left_out(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_sample(&text, 1, 0.5f, 0.5f);
	log_text_line(&text, "what is this\n");
	log_text_sample(&text, 2, 0.5f, 0.5f);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.malformed, 1);
	assert_int_equal(summary.samples, 2);
}

static void times_at_the_ends_of_their_range_overflow_nothing(void **state)
{
	(void)state;
	struct log_text text;
	log_text_begin(&text);
	log_text_sample(&text, INT64_MIN, 0.5f, 0.5f);
	log_text_sample(&text, -1, 0.5f, 0.5f);
	log_text_sample(&text, INT64_MAX, 0.5f, 0.5f);
	log_text_sample(&text, INT64_MIN, 0.5f, 0.5f);
	log_text_end(&text);
	assert_int_equal(summarize(&text), GZ_OK);
	log_text_free(&text);
	assert_int_equal(summary.samples, 4);
	assert_true(isfinite(summary.rate_hz) && summary.duration_s >= 0);
}

/* What finds the labels if the header has this one setting. */
static int source_of_labels(const char *key, const char *value)
{
	static struct gz_gaze_log_header header;
	static struct gz_pipeline pipeline;
	memset(&header, 0, sizeof header);
	header.setting_count = 1;
	strcpy(header.settings[0].key, key);
	strcpy(header.settings[0].value, value);
	gz_log_pipeline_init(&pipeline, &header, NULL);
	return pipeline.params.classify.source;
}

static void logs_older_than_the_forests_are_summarized_by_rules(void **state)
{
	(void)state;
	assert_int_equal(source_of_labels("dropout_ms", "10"), GZ_CLASSIFY_RULES);
	assert_int_equal(source_of_labels("labels", "learned"), GZ_CLASSIFY_LEARNED);
}

TEST_SUITE(log_summary)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whole_log_tells_length_rate_and_validity),
		cmocka_unit_test(look_to_the_right_is_one_saccade),
		cmocka_unit_test(noise_is_the_jitter_between_samples),
		cmocka_unit_test(gap_counts_toward_the_rate),
		cmocka_unit_test(intervals_fall_into_their_bins),
		cmocka_unit_test(marks_are_kept_to_a_limit_and_counted_beyond),
		cmocka_unit_test(combined_only_log_has_no_eyes),
		cmocka_unit_test(cut_log_is_summarized_to_its_last_whole_line),
		cmocka_unit_test(changed_log_is_called_corrupted),
		cmocka_unit_test(malformed_lines_are_counted_and_left_out),
		cmocka_unit_test(times_at_the_ends_of_their_range_overflow_nothing),
		cmocka_unit_test(logs_older_than_the_forests_are_summarized_by_rules),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
