/* From targets and a stream of gaze to numbers; and the lines that gazeview prints. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "client/gazectl/validate/validation.h"
#include "client/gazectl/validate/viewer_process.h"

#define MS INT64_C(1000000)

static struct gz_validation validation;

static int setup(void **state)
{
	(void)state;
	memset(&validation, 0, sizeof validation);
	validation.status.display = (struct gz_display) { { 1000, 1000 }, { 1000, 1000 }, 1000 };
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	gz_gaze_trace_clear(&validation.trace);
	return 0;
}

static struct gz_gaze gaze_of(uint64_t seq, int64_t host_ms, float x, float y, enum gz_event event)
{
	struct gz_gaze gaze = { .seq = seq,
				.host_ns = host_ms * MS,
				.raw = { x, y },
				.point = { x, y },
				.event = event };
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		gaze.eye[i].point = gaze.raw;
		gaze.eye[i].valid = true;
	}
	return gaze;
}

static void add(uint64_t seq, int64_t host_ms, float x, float y, enum gz_event event)
{
	struct gz_gaze gaze = gaze_of(seq, host_ms, x, y, event);
	assert_int_equal(gz_gaze_trace_add(&validation.trace, &gaze), GZ_OK);
}

static void add_target(float x, float y, int64_t shown_ms, int64_t hidden_ms)
{
	validation.target[validation.target_count++] = (struct gz_validation_target) {
		.point = { x, y },
		.shown_ns = shown_ms * MS,
		.hidden_ns = hidden_ms * MS,
	};
}

static void certain_label_reaches_the_sample_that_it_is_for(void **state)
{
	(void)state;
	add(1, 10, 0.5f, 0.5f, GZ_EVENT_FIXATION);
	add(2, 20, 0.6f, 0.5f, GZ_EVENT_FIXATION);
	struct gz_gaze gaze = gaze_of(3, 30, 0.7f, 0.5f, GZ_EVENT_SACCADE);
	gaze.final_known = true;
	gaze.final_seq = 2;
	gaze.final_event = GZ_EVENT_SACCADE;
	assert_int_equal(gz_gaze_trace_add(&validation.trace, &gaze), GZ_OK);
	const struct gz_gaze_trace_sample *items = validation.trace.items;
	assert_true(items[0].sample.fixating && !items[1].sample.fixating);
	assert_int_equal(items[1].event, GZ_EVENT_SACCADE);
}

static void sample_that_is_not_newer_is_left_out(void **state)
{
	(void)state;
	add(1, 10, 0.5f, 0.5f, GZ_EVENT_FIXATION);
	add(2, 10, 0.5f, 0.5f, GZ_EVENT_FIXATION);
	add(3, 5, 0.5f, 0.5f, GZ_EVENT_FIXATION);
	assert_int_equal(validation.trace.count, 1);
}

static void eye_that_is_not_valid_has_no_place(void **state)
{
	(void)state;
	struct gz_gaze gaze = gaze_of(1, 10, 0.5f, 0.5f, GZ_EVENT_FIXATION);
	gaze.eye[GZ_EYE_LEFT].valid = false;
	assert_int_equal(gz_gaze_trace_add(&validation.trace, &gaze), GZ_OK);
	const struct gz_quality_sample *sample = &validation.trace.items[0].sample;
	assert_true(isnan(sample->point[GZ_TRACE_LEFT].x));
	assert_true(sample->point[GZ_TRACE_RIGHT].x == 0.5f);
	assert_true(sample->point[GZ_TRACE_BOTH].x == 0.5f);
}

/* 100 Hz: looks at the last target until 250 ms after the next one appears, jumps there, and rests.
 * */
static void look(uint64_t *seq, int64_t shown_ms, int64_t hidden_ms, int64_t lands_ms,
		 struct gz_point from, struct gz_point to)
{
	for (int64_t ms = shown_ms; ms < hidden_ms; ms += 10) {
		bool before = ms < lands_ms - 30, moves = !before && ms < lands_ms;
		struct gz_point at = before ? from : to;
		add((*seq)++, ms, at.x, at.y, moves ? GZ_EVENT_SACCADE : GZ_EVENT_FIXATION);
	}
}

static void samples_count_from_the_landing_and_not_before_the_eye_has_settled(void **state)
{
	(void)state;
	uint64_t seq = 0;
	struct gz_point a = { 0.2f, 0.2f }, b = { 0.8f, 0.2f }, c = { 0.8f, 0.8f };
	add_target(b.x, b.y, 1000, 3000);
	add_target(c.x, c.y, 3000, 5000);
	look(&seq, 1000, 3000, 1300, a,
	     b); /* lands early: samples count from 800 ms after it appeared */
	look(&seq, 3000, 5000, 4100, b, c); /* lands late */
	assert_int_equal(gz_validation_evaluate(&validation), GZ_OK);
	assert_int_equal(validation.target[0].begin_ns, 1800 * MS);
	assert_int_equal(validation.target[1].begin_ns, 4100 * MS);
	for (int i = 0; i < 2; i++) {
		const struct gz_quality *quality = &validation.target[i].quality[GZ_TRACE_BOTH];
		assert_int_equal(quality->used, i == 0 ? 120 : 90);
		assert_int_equal(quality->expected, quality->used);
		assert_true(quality->accuracy_deg < 1e-4);
		assert_true(quality->loss == 0);
	}
	assert_int_equal(validation.summary[GZ_TRACE_BOTH].targets, 2);
	assert_int_equal(validation.fit.model, GZ_FIT_NONE);
}

static void target_that_was_never_looked_at_has_no_samples(void **state)
{
	(void)state;
	add_target(0.5f, 0.5f, 1000, 3000);
	for (int i = 0; i < 300; i++)
		add((uint64_t)i, 10 * (i + 1), 0.5f, 0.5f, GZ_EVENT_LOST);
	assert_int_equal(gz_validation_evaluate(&validation), GZ_OK);
	assert_int_equal(validation.target[0].quality[GZ_TRACE_BOTH].used, 0);
	assert_int_equal(validation.summary[GZ_TRACE_BOTH].targets, 0);
	assert_true(isnan(validation.summary[GZ_TRACE_BOTH].accuracy_deg));
}

static void nothing_at_all_is_evaluated_too(void **state)
{
	(void)state;
	assert_int_equal(gz_validation_evaluate(&validation), GZ_OK);
	add_target(0.5f, 0.5f, 1000, 1000); /* shown and hidden at once */
	assert_int_equal(gz_validation_evaluate(&validation), GZ_OK);
	assert_int_equal(validation.target[0].count, 0);
	validation.status.display.distance_mm = 0;
	assert_int_equal(gz_validation_evaluate(&validation), GZ_ERR_INVAL);
}

static void lines_of_gazeview_are_understood(void **state)
{
	(void)state;
	struct gz_viewer_event event;
	assert_int_equal(gz_viewer_event_parse("screen 1920 1080 -1280 40 1.25", &event), GZ_OK);
	assert_int_equal(event.kind, GZ_VIEWER_SCREEN);
	assert_true(event.monitor.px[0] == 1920 && event.monitor.px[1] == 1080);
	assert_true(event.monitor.at[0] == -1280 && event.monitor.at[1] == 40);
	assert_true(event.monitor.scale == 1.25);
	assert_int_equal(gz_viewer_event_parse("shown 3 9 0.1 0.9 123456789", &event), GZ_OK);
	assert_int_equal(event.kind, GZ_VIEWER_SHOWN);
	assert_true(event.index == 3 && event.count == 9 && event.time_ns == 123456789);
	assert_true(event.point.x == 0.1f && event.point.y == 0.9f);
	assert_int_equal(gz_viewer_event_parse("hidden 3 123", &event), GZ_OK);
	assert_int_equal(event.kind, GZ_VIEWER_HIDDEN);
	assert_int_equal(gz_viewer_event_parse("finished 5", &event), GZ_OK);
	assert_int_equal(event.kind, GZ_VIEWER_FINISHED);
	assert_int_equal(gz_viewer_event_parse("cancelled 5", &event), GZ_OK);
	assert_int_equal(event.kind, GZ_VIEWER_CANCELLED);
}

static void other_lines_are_refused(void **state)
{
	(void)state;
	static const char *const lines[] = {
		"",
		" ",
		"shown",
		"screen 1920 1080",
		"screen 1920 -1 0 0 1",
		"screen 1920 1080 0 9999999 1",
		"screen 1920 1080 0 0 -1",
		"screen 1920 1080 0 0 101",
		"shown 9 9 0.1 0.9 1",
		"shown 0 9 nan 0.9 1",
		"shown 0 9 0.1 inf 1",
		"shown 0 9 1e39 0.5 1",
		"shown 0 9 0.1 0.9 -1",
		"shown -1 9 0.1 0.9 1",
		"shown 0 9 0.1 0.9 1 1",
		"shown 0 9 0.1 0.9 99999999999999999999",
		"hidden 1",
		"screen 1920",
		"screen -1 5",
		"screen 99999 5",
		"finished now",
		"finish 1",
	};
	for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
		struct gz_viewer_event event;
		if (gz_viewer_event_parse(lines[i], &event) != GZ_ERR_FORMAT)
			fail_msg("\"%s\" was understood", lines[i]);
	}
	char text[2 * GZ_VIEWER_LINE_SIZE];
	struct gz_viewer_event event;
	memset(text, '1', sizeof text);
	text[sizeof text - 1] = '\0';
	assert_int_equal(gz_viewer_event_parse(text, &event), GZ_ERR_FORMAT);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

TEST_SUITE(validation)
{
	static const struct CMUnitTest tests[] = {
		TEST(certain_label_reaches_the_sample_that_it_is_for),
		TEST(sample_that_is_not_newer_is_left_out),
		TEST(eye_that_is_not_valid_has_no_place),
		TEST(samples_count_from_the_landing_and_not_before_the_eye_has_settled),
		TEST(target_that_was_never_looked_at_has_no_samples),
		TEST(nothing_at_all_is_evaluated_too),
		TEST(lines_of_gazeview_are_understood),
		TEST(other_lines_are_refused),
	};
	return cmocka_run_group_tests_name("client.validation", tests, NULL, NULL);
}
