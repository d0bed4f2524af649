/* Gaze sources: a log shows the last sample at or before each frame, as the pipeline saw it. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"
#include "view/gaze/gaze_source.h"

enum { SAMPLES = 400 };

/* 250 Hz, from a time that no frame hits by accident. */
#define START_NS  INT64_C(1000000007)
#define PERIOD_NS INT64_C(4000000)

static char folder[] = "/tmp/gazecast-test-source-XXXXXX";
static char path[80];

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof path, "%s/log.gzl", folder);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(folder);
}

/* Two fixations, 0.4 of the width apart, and a blink in the second. */
static struct gz_sample sample_at(int i)
{
	struct gz_sample sample = gz_sample_unmeasured();
	sample.seq = (uint64_t)i;
	sample.host_ns = START_NS + i * PERIOD_NS;
	float wobble = 0.001f * (float)(i % 5);
	sample.point = (struct gz_point) { (i < SAMPLES / 2 ? 0.3f : 0.7f) + wobble, 0.5f };
	sample.valid = i < 300 || i >= 325;
	if (!sample.valid)
		sample.point = (struct gz_point) { NAN, NAN };
	return sample;
}

static struct gz_gaze_log_header header_of_log(void)
{
	struct gz_gaze_log_header header = { .rate_hz = 250, .has_display = true };
	strcpy(header.tracker, "synthetic");
	header.display = (struct gz_display) { { 1000, 500 }, { 500, 250 }, 550 };
	return header;
}

static FILE *begin_log(const struct gz_gaze_log_header *header)
{
	static char text[65536];
	size_t length;
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	assert_int_equal(gz_gaze_log_print_header(header, text, sizeof text, &length), GZ_OK);
	fwrite(text, 1, length, out);
	return out;
}

static void write_log(const struct gz_gaze_log_header *header, int samples)
{
	static char text[65536];
	size_t length;
	FILE *out = begin_log(header);
	for (int i = 0; i < samples; i++) {
		struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
						     .sample = sample_at(i) };
		assert_int_equal(gz_gaze_log_print_record(&record, text, sizeof text, &length),
				 GZ_OK);
		fwrite(text, 1, length, out);
		if (i % 50 != 7)
			continue; /* marks and gaps between samples are skipped */
		record = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_MARK,
						       .host_ns = record.sample.host_ns };
		strcpy(record.text, "a mark");
		assert_int_equal(gz_gaze_log_print_record(&record, text, sizeof text, &length),
				 GZ_OK);
		fwrite(text, 1, length, out);
	}
	assert_int_equal(fclose(out), 0);
}

static void log_shows_the_last_sample_at_or_before_each_frame(void **state)
{
	(void)state;
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output output;
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *source = NULL;
	write_log(&header, SAMPLES);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	assert_false(source->ops->live);
	gz_pipeline_init(&pipeline, NULL, &header.display);
	int next = 0;
	for (int frame = 0; frame < 120; frame++) { /* 2 s at 60 Hz; the log ends after 1.6 s */
		int64_t time_ns = (int64_t)(frame * (1e9 / 60));
		struct gz_gaze_reading reading;
		while (next < SAMPLES && sample_at(next).host_ns <= START_NS + time_ns) {
			struct gz_sample sample = sample_at(next++);
			gz_pipeline_step(&pipeline, &sample, &output);
		}
		gz_gaze_source_read(source, time_ns, &reading);
		assert_true(reading.known && reading.has_age && reading.has_event);
		assert_true(reading.point.x == output.gaze.point.x);
		assert_true(reading.point.y == output.gaze.point.y);
		assert_int_equal(reading.event, output.gaze.event);
		assert_int_equal(reading.landing.known, output.gaze.landing.known);
		assert_true(reading.landing.point.x == output.gaze.landing.point.x);
		assert_true(reading.landing.time_ns == output.gaze.landing.time_ns);
		assert_int_equal(reading.age_ns, START_NS + time_ns - sample_at(next - 1).host_ns);
	}
	assert_int_equal(next, SAMPLES);
	gz_gaze_source_destroy(&source);
	assert_null(source);
}

static void log_at_the_exact_time_of_a_sample_shows_it(void **state)
{
	(void)state;
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading reading;
	write_log(&header, SAMPLES);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	gz_gaze_source_read(source, 0, &reading);
	assert_true(reading.known);
	assert_int_equal(reading.age_ns, 0);
	gz_gaze_source_read(source, PERIOD_NS - 1, &reading);
	assert_int_equal(reading.age_ns, PERIOD_NS - 1);
	gz_gaze_source_read(source, PERIOD_NS, &reading);
	assert_int_equal(reading.age_ns, 0);
	gz_gaze_source_destroy(&source);
}

static void log_holds_its_point_through_a_blink(void **state)
{
	(void)state;
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading before, within;
	write_log(&header, SAMPLES);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	gz_gaze_source_read(source, 299 * PERIOD_NS, &before);
	gz_gaze_source_read(source, 315 * PERIOD_NS, &within);
	assert_true(within.known);
	assert_true(fabsf(within.point.x - before.point.x) < 0.01f);
	assert_true(fabsf(within.point.y - before.point.y) < 0.01f);
	gz_gaze_source_destroy(&source);
}

static void log_with_extreme_times_is_read(void **state)
{
	(void)state;
	static const int64_t times_ns[] = { INT64_MAX - 30, INT64_MAX, INT64_MIN };
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading reading;
	FILE *out = begin_log(&header);
	for (int i = 0; i < 3; i++) {
		char text[4096];
		size_t length;
		struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
						     .sample = sample_at(i) };
		record.sample.host_ns = times_ns[i];
		assert_int_equal(gz_gaze_log_print_record(&record, text, sizeof text, &length),
				 GZ_OK);
		fwrite(text, 1, length, out);
	}
	assert_int_equal(fclose(out), 0);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	gz_gaze_source_read(source, 20, &reading);
	assert_true(reading.known && reading.age_ns == 20);
	gz_gaze_source_read(source, 40, &reading); /* all three are due; the last is the oldest */
	assert_true(reading.known && reading.age_ns == INT64_MAX);
	gz_gaze_source_destroy(&source);
}

static void log_brings_its_own_display(void **state)
{
	(void)state;
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *source = NULL;
	struct gz_display display = { .distance_mm = -1 };
	write_log(&header, 10);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	assert_true(gz_gaze_source_display(source, &display));
	assert_memory_equal(&display, &header.display, sizeof display);
	gz_gaze_source_destroy(&source);

	header.has_display = false;
	write_log(&header, 10);
	assert_int_equal(gz_gaze_source_log(path, NULL, &source), GZ_OK);
	assert_false(gz_gaze_source_display(source, &display));
	gz_gaze_source_destroy(&source);
}

/* Settings in a header: the first key of the pipeline's table, with @p value. */
static enum gz_result open_with_setting(const char *key, const char *value,
					struct captured_log *captured,
					struct gz_gaze_source **out_source)
{
	struct gz_gaze_log_header header = header_of_log();
	header.setting_count = 1;
	snprintf(header.settings[0].key, sizeof header.settings[0].key, "%s", key);
	snprintf(header.settings[0].value, sizeof header.settings[0].value, "%s", value);
	write_log(&header, 10);
	captured_log_init(captured, "gazeview:warn,pipeline:warn,*:error");
	return gz_gaze_source_log(path, &captured->log, out_source);
}

static void log_with_a_setting_the_pipeline_refuses_is_refused(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_gaze_source *source = NULL;
	const char *key = gz_pipeline_options[0].key + strlen("pipeline.");
	char good[128];
	struct gz_pipeline_params params = gz_pipeline_default_params();
	assert_int_equal(gz_option_format(&gz_pipeline_options[0], &params, good, sizeof good),
			 GZ_OK);
	assert_int_equal(open_with_setting(key, good, &captured, &source), GZ_OK);
	gz_gaze_source_destroy(&source);
	assert_int_equal(open_with_setting(key, "not a value", &captured, &source), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, key));
	assert_int_equal(captured.messages, 1);
	assert_null(source);
	assert_int_equal(open_with_setting("no_such_key", "1", &captured, &source), GZ_OK);
	assert_int_equal(captured.messages, 1);
	assert_int_equal(captured.level, GZ_LOG_WARN);
	assert_non_null(strstr(captured.last, "no_such_key"));
	gz_gaze_source_destroy(&source);
}

static void log_without_a_sample_is_refused(void **state)
{
	(void)state;
	struct captured_log captured;
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_log_header header = header_of_log();
	write_log(&header, 0);
	captured_log_init(&captured, "*:error");
	assert_int_equal(gz_gaze_source_log(path, &captured.log, &source), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "no sample"));
	assert_int_equal(gz_gaze_source_log("/no/such.gzl", &captured.log, &source),
			 GZ_ERR_NOT_FOUND);
	assert_null(source);
}

static void fixed_point_stays_and_has_no_age(void **state)
{
	(void)state;
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading reading;
	assert_int_equal(gz_gaze_source_fixed((struct gz_point) { 0.1f, 1.2f }, &source), GZ_OK);
	gz_gaze_source_move(source, (struct gz_point) { 0.5f, 0.5f }); /* not a mouse */
	gz_gaze_source_read(source, 12345, &reading);
	assert_true(reading.known && reading.connected);
	assert_false(reading.has_age);
	assert_true(reading.point.x == 0.1f && reading.point.y == 1.2f);
	struct gz_display display;
	assert_false(gz_gaze_source_display(source, &display));
	gz_gaze_source_destroy(&source);
}

static void mouse_is_unknown_until_it_moves(void **state)
{
	(void)state;
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading reading;
	assert_int_equal(gz_gaze_source_mouse(&source), GZ_OK);
	gz_gaze_source_read(source, 0, &reading);
	assert_false(reading.known);
	gz_gaze_source_move(source, (struct gz_point) { 0.9f, 0.1f });
	gz_gaze_source_read(source, 0, &reading);
	assert_true(reading.known);
	assert_true(reading.point.x == 0.9f && reading.point.y == 0.1f);
	gz_gaze_source_destroy(&source);
}

static void latest_without_a_daemon_is_unknown_and_not_connected(void **state)
{
	(void)state;
	char endpoint[120];
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_reading reading;
	struct gz_display display;
	snprintf(endpoint, sizeof endpoint, "ipc://%s/latest", folder);
	assert_int_equal(gz_gaze_source_latest(endpoint, NULL, &source), GZ_OK);
	assert_true(source->ops->live);
	gz_gaze_source_read(source, 0, &reading);
	assert_false(reading.known);
	assert_false(reading.connected);
	assert_false(gz_gaze_source_display(source, &display));
	gz_gaze_source_destroy(&source);
	assert_int_equal(gz_gaze_source_latest("tcp://", NULL, &source), GZ_ERR_INVAL);
	assert_null(source);
}

static void destroy_of_nothing_is_allowed(void **state)
{
	(void)state;
	struct gz_gaze_source *none = NULL;
	gz_gaze_source_destroy(&none);
	gz_gaze_source_destroy(NULL);
}

static void log_advanced_in_pieces_ends_like_reading(void **state)
{
	(void)state;
	struct gz_gaze_log_header header = header_of_log();
	struct gz_gaze_source *pieces = NULL, *whole = NULL;
	struct gz_gaze_reading piecewise, at_once;
	struct gz_gaze_log_place place;
	const int64_t time_ns = 350 * PERIOD_NS;
	write_log(&header, SAMPLES);
	assert_int_equal(gz_gaze_source_log(path, NULL, &pieces), GZ_OK);
	assert_int_equal(gz_gaze_source_log(path, NULL, &whole), GZ_OK);
	/* Even without time one step is made. */
	int turns = 1;
	while (!gz_gaze_source_log_forward(pieces, time_ns, 0))
		turns++;
	assert_in_range(turns, 2, SAMPLES);
	gz_gaze_source_read(pieces, time_ns, &piecewise);
	gz_gaze_source_read(whole, time_ns, &at_once);
	assert_true(piecewise.point.x == at_once.point.x && piecewise.seq == 350);
	assert_int_equal(piecewise.age_ns, at_once.age_ns);
	assert_true(gz_gaze_source_log_place(pieces, &place));
	assert_int_equal(place.at_ns, time_ns);
	assert_int_equal(place.length_ns, (SAMPLES - 1) * PERIOD_NS);
	assert_false(place.ended);
	gz_gaze_source_read(pieces, 2 * time_ns, &piecewise);
	assert_true(gz_gaze_source_log_place(pieces, &place) && place.ended);
	gz_gaze_source_destroy(&pieces);
	gz_gaze_source_destroy(&whole);
}

static void other_sources_have_no_place_and_need_no_advance(void **state)
{
	(void)state;
	struct gz_gaze_source *source = NULL;
	struct gz_gaze_log_place place;
	assert_int_equal(gz_gaze_source_mouse(&source), GZ_OK);
	assert_false(gz_gaze_source_log_place(source, &place));
	assert_true(gz_gaze_source_log_forward(source, 1000, 0));
	assert_null(gz_gaze_source_status(source));
	gz_gaze_source_destroy(&source);
}

TEST_SUITE(gaze_source)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(log_shows_the_last_sample_at_or_before_each_frame),
		cmocka_unit_test(log_at_the_exact_time_of_a_sample_shows_it),
		cmocka_unit_test(log_holds_its_point_through_a_blink),
		cmocka_unit_test(log_with_extreme_times_is_read),
		cmocka_unit_test(log_brings_its_own_display),
		cmocka_unit_test(log_with_a_setting_the_pipeline_refuses_is_refused),
		cmocka_unit_test(log_without_a_sample_is_refused),
		cmocka_unit_test(log_advanced_in_pieces_ends_like_reading),
		cmocka_unit_test(other_sources_have_no_place_and_need_no_advance),
		cmocka_unit_test(fixed_point_stays_and_has_no_age),
		cmocka_unit_test(mouse_is_unknown_until_it_moves),
		cmocka_unit_test(latest_without_a_daemon_is_unknown_and_not_connected),
		cmocka_unit_test(destroy_of_nothing_is_allowed),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
