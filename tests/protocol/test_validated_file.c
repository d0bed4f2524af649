/* What a tracker was validated on: what is written reads back, and each change is told. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "protocol/validated_file.h"

static struct captured_log captured;
static char place[64], path[128], changed[GZ_REASON_SIZE];

static struct gz_validated desk(void)
{
	return (struct gz_validated) {
		.tracker = "Eye_Tracker_5",
		.serial = "A-12.3",
		.display = { { 1920, 1080 }, { 520.5, 290.25 }, 600 },
		.monitor = { .at = { -1920, 40 }, .px = { 1920, 1080 }, .scale = 1.25 },
		.measured = "2026-01-31T12:00:00Z",
		.accuracy_deg = 0.75,
	};
}

static int set_up(void **state)
{
	(void)state;
	snprintf(place, sizeof place, "/tmp/gazecast-test-validated-XXXXXX");
	captured_log_init(&captured, NULL);
	if (!mkdtemp(place))
		return -1;
	snprintf(path, sizeof path, "%s/validated.ini", place);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(place);
}

static void validated_file_reads_back(void **state)
{
	(void)state;
	const struct gz_validated written = desk();
	struct gz_validated back;
	assert_int_equal(gz_validated_read(path, &captured.log, &back), GZ_ERR_NOT_FOUND);
	assert_int_equal(captured.messages, 0);
	assert_int_equal(gz_validated_write(path, &written, &captured.log), GZ_OK);
	assert_int_equal(gz_validated_read(path, &captured.log, &back), GZ_OK);
	assert_true(gz_validated_fits(&back, "Eye Tracker 5", "A-12.3"));
	assert_false(gz_validated_fits(&back, "Eye Tracker 5", ""));
	assert_false(gz_validated_fits(&back, "Eye Tracker 4", "A-12.3"));
	assert_true(gz_display_same(&back.display, &written.display));
	assert_memory_equal(&back.monitor, &written.monitor, sizeof back.monitor);
	assert_string_equal(back.measured, written.measured);
	assert_true(back.accuracy_deg == written.accuracy_deg);
}

static void validated_file_that_is_damaged_is_refused_with_a_remedy(void **state)
{
	(void)state;
	static const char *const texts[] = {
		"",
		"[validated]\ntracker = sim\n",
		"[validated]\nmonitor_at = 0 1e9\n",
		"[validated]\nmonitor_px = 1920\n",
		"[validated]\nmonitor_scale = -1\n",
		"[validated]\naccuracy_deg = nan\n",
		"[correction]\ntracker = sim\n",
	};
	struct gz_validated back = { .accuracy_deg = 77 };
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		captured_log_init(&captured, NULL);
		if (gz_validated_parse("file", texts[i], strlen(texts[i]), &captured.log, &back) !=
		    GZ_ERR_FORMAT)
			fail_msg("text %zu is not refused", i);
		assert_int_equal(captured.messages, 1);
		assert_non_null(strstr(captured.last, "file"));
	}
	assert_true(back.accuracy_deg == 77);
	(void)gz_validated_parse("file", texts[1], strlen(texts[1]), &captured.log, &back);
	assert_non_null(strstr(captured.last, "run gazectl validate again"));
}

static void validated_path_keeps_within_its_directory(void **state)
{
	(void)state;
	char text[128];
	assert_int_equal(gz_validated_path("/d", "../x y", ".", text, sizeof text), GZ_OK);
	assert_string_equal(text, "/d/validated-_._x_y-_.ini");
	assert_int_equal(gz_validated_path("/d", "sim", "", text, sizeof text), GZ_OK);
	assert_string_equal(text, "/d/validated-sim.ini");
	assert_int_equal(gz_validated_path("/d", "sim", "", text, 10), GZ_ERR_FULL);
}

static void assert_change(const struct gz_display *display, const struct gz_monitor_place *monitor,
			  const char *wanted)
{
	const struct gz_validated was = desk();
	bool told = gz_validated_changed(&was, display, monitor, changed);
	assert_string_equal(changed, wanted);
	assert_true(told == (wanted[0] != '\0'));
}

static void display_of_another_size_or_distance_is_told(void **state)
{
	(void)state;
	const struct gz_validated was = desk();
	struct gz_display now = was.display;
	assert_change(&now, &was.monitor, "");
	now.mm[0] += 1e-7; /* as a wire may change it */
	assert_change(&now, &was.monitor, "");
	now.distance_mm = 650;
	assert_change(&now, &was.monitor, "650 mm away, was 600 mm");
	now.mm[1] = 300;
	assert_change(&now, &was.monitor, "520.5x300 mm, was 520.5x290.25 mm");
	now.px[1] = 1200;
	assert_change(&now, &was.monitor, "1920x1200 px, was 1920x1080 px");
}

static void monitor_of_another_place_size_or_scale_is_told(void **state)
{
	(void)state;
	const struct gz_validated was = desk();
	struct gz_monitor_place now = was.monitor;
	now.at[0] = 0;
	assert_change(&was.display, &now, "monitor at 0 40 of the desktop, was at -1920 40");
	now.scale = 1;
	assert_change(&was.display, &now, "scale of the desktop 1, was 1.25");
	now.px[0] = 2560;
	assert_change(&was.display, &now, "monitor of 2560x1080 px, was 1920x1080 px");
}

static void monitor_that_is_unknown_has_not_changed(void **state)
{
	(void)state;
	struct gz_validated was = desk();
	struct gz_monitor_place now = { .scale = 3 };
	assert_change(&was.display, &now, "");
	now = was.monitor;
	now.scale = 0;
	assert_change(&was.display, &now, "");
	was.monitor = (struct gz_monitor_place) { .scale = 0 };
	now.at[0] = 5;
	assert_false(gz_validated_changed(&was, &was.display, &now, changed));
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(validated_file)
{
	const struct CMUnitTest tests[] = {
		TEST(validated_file_reads_back),
		TEST(validated_file_that_is_damaged_is_refused_with_a_remedy),
		TEST(validated_path_keeps_within_its_directory),
		TEST(display_of_another_size_or_distance_is_told),
		TEST(monitor_of_another_place_size_or_scale_is_told),
		TEST(monitor_that_is_unknown_has_not_changed),
	};
	return cmocka_run_group_tests_name("protocol.validated_file", tests, NULL, NULL);
}
