/* Stored corrections: what is written reads back, and impossible values are refused. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "protocol/correction_file.h"

static struct captured_log captured;
static char place[64], path[256];

static const struct gz_display display = { { 1920, 1080 }, { 564.677, 317.631 }, 600 };

static struct gz_correction_file sample_file(void)
{
	return (struct gz_correction_file) {
		.tracker = "Eye_Tracker_5",
		.serial = "A-12.3",
		.display_px = { 1920, 1080 },
		.display_mm = { 564.677, 317.631 },
		.distance_mm = 600,
		.x = { 1.0 / 3, 1.02, -0.003 },
		.y = { 0.004, 0.005, 0.98 },
		.measured = "2026-01-31T12:00:00Z",
		.before_deg = 1.25,
		.after_deg = 0.5,
	};
}

static int setup(void **state)
{
	(void)state;
	snprintf(place, sizeof place, "/tmp/gazecast-test-correction-XXXXXX");
	captured_log_init(&captured, "*:debug");
	if (!mkdtemp(place))
		return -1;
	snprintf(path, sizeof path, "%s/a/b/correction.ini", place);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	char command[128];
	snprintf(command, sizeof command, "rm -rf '%s'", place);
	return system(command);
}

static void write_text(const char *text)
{
	struct gz_correction_file file = sample_file();
	assert_int_equal(gz_correction_write(path, &file, &captured.log), GZ_OK);
	FILE *out = fopen(path, "w");
	assert_non_null(out);
	fputs(text, out);
	fclose(out);
}

static void what_is_written_is_read(void **state)
{
	(void)state;
	struct gz_correction_file file = sample_file(), back;
	memset(&back, 0, sizeof back);
	assert_int_equal(gz_correction_write(path, &file, &captured.log), GZ_OK);
	assert_int_equal(gz_correction_read(path, &captured.log, &back), GZ_OK);
	assert_string_equal(back.tracker, file.tracker);
	assert_string_equal(back.serial, file.serial);
	assert_string_equal(back.measured, file.measured);
	assert_memory_equal(back.x, file.x, sizeof back.x);
	assert_memory_equal(back.y, file.y, sizeof back.y);
	assert_memory_equal(back.display_mm, file.display_mm, sizeof back.display_mm);
	assert_true(back.before_deg == 1.25 && back.after_deg == 0.5);
	assert_true(gz_correction_fits(&back, "Eye Tracker 5", "A-12.3", &display));
	file.serial[0] = '\0'; /* a second one replaces it */
	assert_int_equal(gz_correction_write(path, &file, &captured.log), GZ_OK);
	assert_int_equal(gz_correction_read(path, &captured.log, &back), GZ_OK);
	assert_string_equal(back.serial, "");
	assert_int_equal(captured.messages, 0);
}

static void other_tracker_or_display_does_not_fit(void **state)
{
	(void)state;
	struct gz_correction_file file = sample_file();
	struct gz_display other = display;
	assert_false(gz_correction_fits(&file, "Eye Tracker 4", "A-12.3", &display));
	assert_false(gz_correction_fits(&file, "Eye Tracker 5", "", &display));
	other.distance_mm = 601;
	assert_false(gz_correction_fits(&file, "Eye Tracker 5", "A-12.3", &other));
	other = display;
	other.px[0] = 1280;
	assert_false(gz_correction_fits(&file, "Eye Tracker 5", "A-12.3", &other));
	other = display;
	other.mm[1] *= 1.001;
	assert_false(gz_correction_fits(&file, "Eye Tracker 5", "A-12.3", &other));
	other.mm[1] = display.mm[1] * (1 + 1e-9);
	assert_true(gz_correction_fits(&file, "Eye Tracker 5", "A-12.3", &other));
}

static void missing_file_is_no_news(void **state)
{
	(void)state;
	struct gz_correction_file back;
	assert_int_equal(gz_correction_read(path, &captured.log, &back), GZ_ERR_NOT_FOUND);
	assert_int_equal(captured.messages, 0);
}

static void file_without_a_key_or_with_nonsense_is_refused(void **state)
{
	(void)state;
	static const char *const texts[] = {
		"",
		"[correction]\nx = 0 1 0\n",
		"[correction]\nx = 0 1\n",
		"[correction]\nx = 0 1 nan\n",
		"[correction]\nx = 0 99 0\n",
		"[correction]\nunknown = 1\n",
		"\xff\xfe\x00garbage",
	};
	struct gz_correction_file back;
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		captured_log_init(&captured, "*:debug");
		write_text(texts[i]);
		if (gz_correction_read(path, &captured.log, &back) != GZ_ERR_FORMAT)
			fail_msg("\"%s\" was read", texts[i]);
		assert_int_equal(captured.messages, 1);
		assert_non_null(strstr(captured.last, "correction"));
	}
}

static void name_that_could_lead_elsewhere_is_made_plain(void **state)
{
	(void)state;
	char text[512];
	assert_int_equal(gz_correction_path("/d", "../../etc/x y;z", ".\xc3\xa9\n", &display, text,
					    sizeof text),
			 GZ_OK);
	assert_string_equal(text, "/d/_._.._etc_x_y_z-____-1920x1080-565x318mm-600mm.ini");
	assert_int_equal(gz_correction_path("/d", "sim", "", &display, text, sizeof text), GZ_OK);
	assert_string_equal(text, "/d/sim-1920x1080-565x318mm-600mm.ini");
	assert_int_equal(gz_correction_path("/d", "sim", "", &display, text, 20), GZ_ERR_FULL);
}

static void directory_follows_the_environment(void **state)
{
	(void)state;
	char text[256], home[256];
	snprintf(home, sizeof home, "%s", getenv("HOME") ? getenv("HOME") : "");
	setenv("XDG_CONFIG_HOME", "/c", 1);
	assert_int_equal(gz_correction_directory(text, sizeof text), GZ_OK);
	assert_string_equal(text, "/c/gazecast/corrections");
	setenv("XDG_CONFIG_HOME", "relative", 1);
	setenv("HOME", "/h", 1);
	assert_int_equal(gz_correction_directory(text, sizeof text), GZ_OK);
	assert_string_equal(text, "/h/.config/gazecast/corrections");
	unsetenv("XDG_CONFIG_HOME");
	unsetenv("HOME");
	assert_int_equal(gz_correction_directory(text, sizeof text), GZ_ERR_NOT_FOUND);
	setenv("HOME", home, 1);
}

static void place_that_cannot_be_written_is_told(void **state)
{
	(void)state;
	struct gz_correction_file file = sample_file();
	snprintf(path, sizeof path, "/proc/gazecast/correction.ini");
	assert_true(gz_correction_write(path, &file, &captured.log) != GZ_OK);
	assert_int_equal(captured.messages, 1);
	assert_non_null(strstr(captured.last, "/proc/gazecast/correction.ini"));
	assert_non_null(strstr(captured.last, "--corrections"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

TEST_SUITE(correction_file)
{
	static const struct CMUnitTest tests[] = {
		TEST(what_is_written_is_read),
		TEST(other_tracker_or_display_does_not_fit),
		TEST(missing_file_is_no_news),
		TEST(file_without_a_key_or_with_nonsense_is_refused),
		TEST(name_that_could_lead_elsewhere_is_made_plain),
		TEST(directory_follows_the_environment),
		TEST(place_that_cannot_be_written_is_told),
	};
	return cmocka_run_group_tests_name("protocol.correction_file", tests, NULL, NULL);
}
