/* The statistics file is complete JSON at any time; the text line has the same values. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "view/frame/stats.h"

static char folder[] = "/tmp/gazecast-test-stats-XXXXXX";
static char path[64];

static const struct gz_frame_record frame = {
	.method = "acuity",
	.backend = "cpu",
	.width = 640,
	.height = 360,
	.rays = 12345,
	.kept_rays = 2345,
	.samples = 9876543210,
	.plan_ms = 0.25,
	.cast_ms = 10.5,
	.reconstruct_ms = 1.25,
	.total_ms = 12.125,
	.gaze_known = true,
	.gaze = { 0.25f, -0.5f },
	.age_known = true,
	.gaze_age_ms = 3.5,
	.attention = "fixation",
	.focus = { .point = { 0.25f, -0.5f }, .scale = 1.5, .widen = 0.25 },
	.budget_ms = 12,
	.budget = "over",
};

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof path, "%s/stats.json", folder);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(folder);
}

/* The file's text, in a buffer of the test. */
static const char *content(void)
{
	static char text[8192];
	FILE *in = fopen(path, "rb");
	assert_non_null(in);
	size_t size = fread(text, 1, sizeof text - 1, in);
	fclose(in);
	text[size] = '\0';
	return text;
}

static void assert_tail_closes(const char *text)
{
	size_t length = strlen(text);
	assert_true(length > 4);
	assert_string_equal(text + length - 4, "\n]}\n");
}

static void file_without_frames_is_complete(void **state)
{
	(void)state;
	struct gz_stats_file *file = NULL;
	assert_int_equal(gz_stats_open(path, NULL, &file), GZ_OK);
	assert_string_equal(content(), "{\"frames\": [\n]}\n");
	gz_stats_close(&file);
	assert_null(file);
}

static void file_is_complete_after_each_frame(void **state)
{
	(void)state;
	struct gz_stats_file *file = NULL;
	assert_int_equal(gz_stats_open(path, NULL, &file), GZ_OK);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(gz_stats_add(file, &frame), GZ_OK);
		assert_tail_closes(content()); /* while it is still open */
	}
	gz_stats_close(&file);
	const char *text = content();
	int entries = 0;
	for (const char *at = text; (at = strstr(at, "{\"method\"")) != NULL; at++)
		entries++;
	assert_int_equal(entries, 3);
	assert_non_null(strstr(
		text, "{\"method\": \"acuity\", \"backend\": \"cpu\", \"width\": 640, \"height\": "
		      "360, \"rays\": 12345, \"kept_rays\": 2345, \"samples\": 9876543210, "
		      "\"plan_ms\": 0.25, "
		      "\"cast_ms\": 10.5, \"reconstruct_ms\": 1.25, \"total_ms\": 12.125, "
		      "\"gaze\": [0.25, -0.5], \"gaze_age_ms\": 3.5, \"attention\": "
		      "\"fixation\", \"focus\": [0.25, -0.5], \"scale\": 1.5, \"widen\": 0.25, "
		      "\"budget_ms\": 12.0, \"budget\": \"over\"}"));
}

static void unknown_values_are_null(void **state)
{
	(void)state;
	struct gz_stats_file *file = NULL;
	struct gz_frame_record blind = frame;
	blind.gaze_known = blind.age_known = false;
	blind.focus.point = (struct gz_point) { NAN, NAN };
	blind.budget_ms = 0;
	blind.budget = "off";
	blind.cast_ms = NAN;
	blind.total_ms = INFINITY;
	assert_int_equal(gz_stats_open(path, NULL, &file), GZ_OK);
	assert_int_equal(gz_stats_add(file, &blind), GZ_OK);
	gz_stats_close(&file);
	const char *text = content();
	assert_non_null(strstr(text, "\"gaze\": null, \"gaze_age_ms\": null, "));
	assert_non_null(strstr(text, "\"focus\": null, \"scale\": 1.5"));
	assert_non_null(strstr(text, "\"budget_ms\": null, \"budget\": \"off\"}"));
	assert_non_null(strstr(text, "\"cast_ms\": null"));
	assert_non_null(strstr(text, "\"total_ms\": null"));
	assert_null(strstr(text, "nan"));
	assert_null(strstr(text, "inf"));
}

static void older_file_is_replaced(void **state)
{
	(void)state;
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	for (int i = 0; i < 1000; i++)
		fputs("old ", out);
	fclose(out);
	struct gz_stats_file *file = NULL;
	assert_int_equal(gz_stats_open(path, NULL, &file), GZ_OK);
	gz_stats_close(&file);
	assert_string_equal(content(), "{\"frames\": [\n]}\n");
}

static void unwritable_file_is_refused(void **state)
{
	(void)state;
	const char *const bad[] = { "/no/such/folder/s.json", "/tmp", "/dev/null", "" };
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		struct captured_log captured;
		struct gz_stats_file *file = NULL;
		captured_log_init(&captured, "*:debug");
		assert_int_equal(gz_stats_open(bad[i], &captured.log, &file), GZ_ERR_IO);
		assert_null(file);
		assert_int_equal(captured.messages, 1);
		assert_non_null(strstr(captured.last, bad[i]));
	}
}

static void line_has_the_values_of_the_file(void **state)
{
	(void)state;
	char line[512];
	gz_frame_record_print(&frame, line, sizeof line);
	assert_string_equal(line,
			    "acuity 640x360 rays 12345 kept 2345 samples 9876543210 plan 0.25 cast "
			    "10.50 reconstruct 1.25 total 12.12 ms gaze age 3.5 ms");
	struct gz_frame_record blind = frame;
	blind.age_known = false;
	gz_frame_record_print(&blind, line, sizeof line);
	assert_non_null(strstr(line, "gaze age -"));
}

static void close_of_nothing_is_allowed(void **state)
{
	(void)state;
	struct gz_stats_file *none = NULL;
	gz_stats_close(&none);
	gz_stats_close(NULL);
}

TEST_SUITE(stats)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_without_frames_is_complete),
		cmocka_unit_test(file_is_complete_after_each_frame),
		cmocka_unit_test(unknown_values_are_null),
		cmocka_unit_test(older_file_is_replaced),
		cmocka_unit_test(unwritable_file_is_refused),
		cmocka_unit_test(line_has_the_values_of_the_file),
		cmocka_unit_test(close_of_nothing_is_allowed),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
