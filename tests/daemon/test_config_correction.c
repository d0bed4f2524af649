/* Which stored correction gazed uses, and which it ignores. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "daemon/config.h"
#include "protocol/correction_file.h"
#include "protocol/validated_file.h"

static struct gz_config config;
static struct captured_log captured;
static char place[64], path[512];

static const struct gz_display display = { { 1920, 1080 }, { 565, 318 }, 600 };
static const double stored_x[3] = { 0.125, 1.5, 0 }, stored_y[3] = { 0, 0.25, 0.75 };

static struct gz_device_info info_of(const char *name, const char *serial)
{
	struct gz_device_info info = { .recorded = NULL };
	snprintf(info.name, sizeof info.name, "%s", name);
	snprintf(info.serial, sizeof info.serial, "%s", serial);
	return info;
}

static void store(const double x[3], const double y[3])
{
	struct gz_correction_file file = {
		.tracker = "Eye_5",
		.serial = "S1",
		.display_px = { 1920, 1080 },
		.display_mm = { 565, 318 },
		.distance_mm = 600,
	};
	memcpy(file.x, x, sizeof file.x);
	memcpy(file.y, y, sizeof file.y);
	assert_int_equal(gz_correction_path(place, "Eye 5", "S1", &display, path, sizeof path),
			 GZ_OK);
	assert_int_equal(gz_correction_write(path, &file, NULL), GZ_OK);
}

/* Reads gazed's command line; up to two words. */
static void configure(const char *first, const char *second)
{
	char directory[128];
	snprintf(directory, sizeof directory, "--tracker.corrections=%s", place);
	char *argv[] = { (char *)"gazed", (char *)"--config=/dev/null",
			 directory,       (char *)first,
			 (char *)second,  NULL };
	int argc = first ? second ? 5 : 4 : 3;
	assert_int_equal(gz_config_read(argc, argv, NULL, &config), GZ_OK);
}

static int setup(void **state)
{
	(void)state;
	snprintf(place, sizeof place, "/tmp/gazecast-test-corrections-XXXXXX");
	captured_log_init(&captured, "*:debug");
	if (!mkdtemp(place))
		return -1;
	store(stored_x, stored_y);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(place);
}

static struct gz_correct_params correct_of(const struct gz_device_info *info,
					   const struct gz_display *shown)
{
	struct gz_pipeline_params params = config.pipeline;
	captured_log_init(&captured, "*:debug");
	gz_config_correction(&config, info, shown, &captured.log, &params);
	return params.correct;
}

static void check_is(const struct gz_correct_params *correct, const double x[3], const double y[3])
{
	for (int i = 0; i < 3; i++)
		if (correct->x[i] != x[i] || correct->y[i] != y[i])
			fail_msg("number %d is %g and %g, not %g and %g", i, correct->x[i],
				 correct->y[i], x[i], y[i]);
}

static const double same_x[3] = { 0, 1, 0 }, same_y[3] = { 0, 0, 1 };

static void correction_of_this_tracker_and_display_is_taken(void **state)
{
	(void)state;
	struct gz_device_info info = info_of("Eye 5", "S1");
	configure(NULL, NULL);
	struct gz_correct_params correct = correct_of(&info, &display);
	check_is(&correct, stored_x, stored_y);
	assert_non_null(strstr(captured.last, path));
}

static void correction_of_another_is_left(void **state)
{
	(void)state;
	struct gz_device_info other = info_of("Eye 5", "S2"), info = info_of("Eye 5", "S1");
	struct gz_display far = display;
	far.distance_mm = 650;
	configure(NULL, NULL);
	struct gz_correct_params correct = correct_of(&other, &display);
	check_is(&correct, same_x, same_y);
	correct = correct_of(&info, &far);
	check_is(&correct, same_x, same_y);
	assert_int_equal(captured.messages, 0);
}

static void recording_keeps_its_own(void **state)
{
	(void)state;
	static const struct gz_gaze_log_header header;
	struct gz_device_info info = info_of("Eye 5", "S1");
	info.recorded = &header;
	configure(NULL, NULL);
	struct gz_correct_params correct = correct_of(&info, &display);
	check_is(&correct, same_x, same_y);
}

static void command_line_has_the_last_word(void **state)
{
	(void)state;
	static const double given_x[3] = { 0.5, 1, 0 };
	struct gz_device_info info = info_of("Eye 5", "S1");
	configure("--pipeline.correction.x", "0.5 1 0");
	struct gz_correct_params correct = correct_of(&info, &display);
	check_is(&correct, given_x, same_y);
}

static void corrections_can_be_turned_off(void **state)
{
	(void)state;
	struct gz_device_info info = info_of("Eye 5", "S1");
	configure(NULL, NULL);
	snprintf(config.corrections, sizeof config.corrections, "none");
	struct gz_correct_params correct = correct_of(&info, &display);
	check_is(&correct, same_x, same_y);
}

static void file_of_another_display_under_this_name_is_refused(void **state)
{
	(void)state;
	struct gz_device_info info = info_of("Eye 5", "S1");
	struct gz_display wider = display;
	wider.mm[0] = 565.4; /* the same name, but not the same display */
	configure(NULL, NULL);
	struct gz_correct_params correct = correct_of(&info, &wider);
	check_is(&correct, same_x, same_y);
	assert_int_equal(captured.level, GZ_LOG_ERROR);
	assert_non_null(strstr(captured.last, "another tracker or display"));
	assert_non_null(strstr(captured.last, path));
}

static void map_without_area_is_refused(void **state)
{
	(void)state;
	static const double flat[3] = { 0, 0, 1 };
	struct gz_device_info info = info_of("Eye 5", "S1");
	store(flat, flat);
	configure(NULL, NULL);
	struct gz_correct_params correct = correct_of(&info, &display);
	check_is(&correct, same_x, same_y);
	assert_int_equal(captured.level, GZ_LOG_ERROR);
	assert_non_null(strstr(captured.last, "to a line or a point"));
}

static void validation_of_this_tracker_is_known(void **state)
{
	(void)state;
	static const struct gz_gaze_log_header header;
	char file[512];
	struct gz_device_info info = info_of("Eye 5", "S1"), other = info_of("Eye 5", "S2");
	struct gz_validated found,
		written = { .tracker = "Eye_5", .serial = "S1", .display = display };
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_validated_path(place, "Eye 5", "S1", file, sizeof file), GZ_OK);
	configure(NULL, NULL);
	assert_false(gz_config_validated(&config, &info, &captured.log, &found));
	assert_int_equal(gz_validated_write(file, &written, NULL), GZ_OK);
	assert_true(gz_config_validated(&config, &info, &captured.log, &found));
	assert_true(gz_display_same(&found.display, &display));
	assert_false(gz_config_validated(&config, &other, &captured.log, &found));
	info.recorded = &header;
	assert_false(gz_config_validated(&config, &info, &captured.log, &found));
	assert_int_equal(captured.messages, 0);
	/* Another tracker's under this one's name. */
	info.recorded = NULL;
	snprintf(written.serial, sizeof written.serial, "S3");
	assert_int_equal(gz_validated_write(file, &written, NULL), GZ_OK);
	assert_false(gz_config_validated(&config, &info, &captured.log, &found));
	assert_non_null(strstr(captured.last, "it is of another tracker"));
	unlink(file);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

TEST_SUITE(config_correction)
{
	static const struct CMUnitTest tests[] = {
		TEST(correction_of_this_tracker_and_display_is_taken),
		TEST(correction_of_another_is_left),
		TEST(recording_keeps_its_own),
		TEST(command_line_has_the_last_word),
		TEST(corrections_can_be_turned_off),
		TEST(validation_of_this_tracker_is_known),
		TEST(file_of_another_display_under_this_name_is_refused),
		TEST(map_without_area_is_refused),
	};
	return cmocka_run_group_tests_name("daemon.config_correction", tests, NULL, NULL);
}
