/* Where the gaze goes in a study. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "bench/study/gaze_path.h"
#include "drivers/made_log.h"

static struct captured_log captured;

static int begin(void **state)
{
	(void)state;
	captured_log_init(&captured, "*:error");
	return 0;
}

static struct gz_gaze_path made(const struct gz_gaze_path_settings *settings)
{
	struct gz_gaze_path path = { 0 };
	if (gz_gaze_path_make(settings, &captured.log, &path) != GZ_OK)
		fail_msg("%s: %s", settings->text, captured.last);
	return path;
}

static struct gz_gaze_path path_of(const char *text)
{
	const struct gz_gaze_path_settings settings = { .text = text, .seed = 1 };
	return made(&settings);
}

static void is_at(const struct gz_gaze_path *path, size_t i, double x, double y)
{
	const struct gz_point gaze = path->points[i].gaze;
	if (!(fabs((double)gaze.x - x) < 1e-6 && fabs((double)gaze.y - y) < 1e-6))
		fail_msg("point %zu is %g %g, not %g %g", i, (double)gaze.x, (double)gaze.y, x, y);
}

static void sweep_is_the_mirrored_s(void **state)
{
	(void)state;
	struct gz_gaze_path path = path_of("sweep:s");
	assert_int_equal(path.count, 584);
	gz_gaze_path_free(&path);
	path = path_of("sweep:s:4"); /* t = 1/8, 3/8, 5/8, 7/8 */
	assert_int_equal(path.count, 4);
	is_at(&path, 0, 0.5 + 0.4 * sqrt(0.5), 0.05 + 0.9 / 8);
	is_at(&path, 1, 0.5 + 0.4 * sqrt(0.5), 0.05 + 2.7 / 8);
	is_at(&path, 2, 0.5 - 0.4 * sqrt(0.5), 0.05 + 4.5 / 8);
	is_at(&path, 3, 0.5 - 0.4 * sqrt(0.5), 0.05 + 6.3 / 8);
	gz_gaze_path_free(&path);
}

static void grid_takes_cell_centres_row_by_row(void **state)
{
	(void)state;
	struct gz_gaze_path path = path_of("grid:4x2");
	assert_int_equal(path.count, 8);
	is_at(&path, 0, 1.0 / 8, 1.0 / 4);
	is_at(&path, 3, 7.0 / 8, 1.0 / 4);
	is_at(&path, 4, 1.0 / 8, 3.0 / 4);
	gz_gaze_path_free(&path);
}

static void centre_and_x_y_are_one_point(void **state)
{
	(void)state;
	struct gz_gaze_path path = path_of("centre");
	assert_int_equal(path.count, 1);
	is_at(&path, 0, 0.5, 0.5);
	gz_gaze_path_free(&path);
	path = path_of("-0.25,1.5"); /* outside is a place too */
	assert_int_equal(path.count, 1);
	is_at(&path, 0, -0.25, 1.5);
	gz_gaze_path_free(&path);
}

static void random_places_are_those_of_the_seed_and_spread_over_the_picture(void **state)
{
	(void)state;
	struct gz_gaze_path_settings settings = { .text = "random:1000", .seed = 5 };
	struct gz_gaze_path one = made(&settings), same = made(&settings);
	settings.seed = 6;
	struct gz_gaze_path other = made(&settings);
	double mean = 0;
	assert_memory_equal(one.points, same.points, 1000 * sizeof *one.points);
	assert_memory_not_equal(one.points, other.points, 1000 * sizeof *one.points);
	for (size_t i = 0; i < 1000; i++) {
		const struct gz_point gaze = one.points[i].gaze;
		assert_true(gaze.x >= 0 && gaze.x <= 1 && gaze.y >= 0 && gaze.y <= 1);
		mean += (double)gaze.x / 1000;
	}
	if (!(fabs(mean - 0.5) < 0.05)) /* five deviations of such a mean */
		fail_msg("mean %g", mean);
	gz_gaze_path_free(&one);
	gz_gaze_path_free(&same);
	gz_gaze_path_free(&other);
}

static void points_take_random_cameras_in_turn(void **state)
{
	(void)state;
	const struct gz_gaze_path_settings settings = { .text = "random:5", .cameras = 3 };
	static const uint32_t expected[] = { 1, 2, 3, 1, 2 };
	struct gz_gaze_path path = made(&settings);
	for (size_t i = 0; i < 5; i++)
		assert_int_equal(path.points[i].camera, expected[i]);
	gz_gaze_path_free(&path);
}

static void points_nearer_than_min_move_are_left_out(void **state)
{
	(void)state;
	struct gz_gaze_path_settings settings = { .text = "sweep:s",
						  .min_move_px = 10,
						  .size = { 400, 300 } };
	struct gz_gaze_path path = made(&settings);
	assert_in_range(path.count, 50, 150); /* 270 px down and 640 to the sides */
	for (size_t i = 1; i < path.count; i++) {
		const struct gz_point a = path.points[i - 1].gaze, b = path.points[i].gaze;
		const double moved =
			hypot(400 * ((double)b.x - (double)a.x), 300 * ((double)b.y - (double)a.y));
		if (!(moved >= 10))
			fail_msg("point %zu is %g px from the one before", i, moved);
	}
	gz_gaze_path_free(&path);
}

static void per_cell_keeps_the_first_point_in_each(void **state)
{
	(void)state;
	struct gz_gaze_path_settings settings = { .text = "grid:30x30", .per_cell = true };
	struct gz_gaze_path path = made(&settings);
	assert_int_equal(path.count, 100);
	is_at(&path, 0, 0.5 / 30, 0.5 / 30);
	is_at(&path, 1, 3.5 / 30, 0.5 / 30);
	gz_gaze_path_free(&path);
	settings.text = "2,2";
	assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_INVAL);
	assert_non_null(strstr(captured.last, "--per-cell"));
}

static void unknown_path_is_refused(void **state)
{
	(void)state;
	static const char *const texts[] = { "",          "sweep",       "sweep:t",
					     "sweep:s:0", "sweep:s:1x",  "sweep:s:100001",
					     "grid:3",    "grid:0x3",    "grid:400x400",
					     "a.csv:",    "a.csv:64",    "a.csv:64x0",
					     "random:",   "random:-1",   "0.5,",
					     "nan,0.5",   "0.5,0.5,0.5", "1e3,0" };
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		const struct gz_gaze_path_settings settings = { .text = texts[i] };
		struct gz_gaze_path path = { 0 };
		assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_INVAL);
		assert_null(path.points);
		assert_non_null(strstr(captured.last, "sweep:s:N"));
	}
}

/* ---- recordings ---- */

static char log_file[] = "/tmp/gz_gaze_path_XXXXXX.gzl";

static void write_sample(struct made_log *made, int i, bool valid, struct gz_point point)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE,
					     .sample = gz_sample_unmeasured() };
	record.sample.seq = (uint64_t)i;
	record.sample.host_ns = INT64_C(1000000000) + i * INT64_C(2000000);
	record.sample.valid = valid;
	record.sample.point = point;
	made_log_record(made, &record);
}

/* Looks at one place, then, after a blink of 200 ms, at another: 500 Hz, half a second each. */
static void write_log(bool valid)
{
	struct made_log made_log;
	assert_true(made_log_begin(&made_log, log_file));
	for (int i = 0; i < 600; i++)
		write_sample(&made_log, i, valid && (i < 250 || i >= 350),
			     (struct gz_point) { i < 300 ? 0.25F : 0.75F, 0.5F });
	made_log_end(&made_log);
}

static void recording_gives_one_point_a_fixation(void **state)
{
	(void)state;
	write_log(true);
	struct gz_gaze_path path = path_of(log_file);
	assert_int_equal(path.count, 2);
	is_at(&path, 0, 0.25, 0.5);
	is_at(&path, 1, 0.75, 0.5);
	assert_true(path.has_display);
	const struct gz_display display = gz_display_default(1280, 1024);
	assert_true(gz_gaze_path_same_display(&path.display, &display));
	gz_gaze_path_free(&path);
}

static void recording_by_samples_leaves_out_where_gaze_is_lost(void **state)
{
	(void)state;
	char text[64];
	write_log(true);
	snprintf(text, sizeof text, "%s:samples", log_file);
	struct gz_gaze_path path = path_of(text);
	assert_in_range(path.count, 450, 500); /* the 100 of the blink are lost for sure */
	is_at(&path, 0, 0.25, 0.5);
	gz_gaze_path_free(&path);
}

static void recording_without_valid_gaze_is_refused(void **state)
{
	(void)state;
	char text[64];
	struct gz_gaze_path path = { 0 };
	struct gz_gaze_path_settings settings = { .text = log_file };
	write_log(false);
	assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "holds no fixation"));
	snprintf(text, sizeof text, "%s:samples", log_file);
	settings.text = text;
	assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "holds no valid gaze"));
}

static void missing_or_damaged_recording_is_refused(void **state)
{
	(void)state;
	struct gz_gaze_path path = { 0 };
	struct gz_gaze_path_settings settings = { .text = "/nowhere/log.gzl" };
	assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_NOT_FOUND);
	FILE *file = fopen(log_file, "w");
	fputs("a letter\n", file);
	fclose(file);
	settings.text = log_file;
	assert_int_equal(gz_gaze_path_make(&settings, &captured.log, &path), GZ_ERR_FORMAT);
}

/* The path of a table of this text. */
static enum gz_result table_path(const char *text, const char *size, struct gz_gaze_path *out_path)
{
	char name[] = "/tmp/gazecast-test-path-XXXXXX.csv", path[64];
	const int descriptor = mkstemps(name, 4);
	FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
	snprintf(path, sizeof path, "%s%s", name, size);
	const struct gz_gaze_path_settings settings = { .text = path };
	assert_int_equal(gz_gaze_path_check(path, &captured.log), GZ_OK);
	const enum gz_result result = gz_gaze_path_make(&settings, &captured.log, out_path);
	unlink(name);
	return result;
}

static void table_gives_a_point_a_line_in_shares_or_pixels(void **state)
{
	(void)state;
	struct gz_gaze_path path = { 0 };
	assert_int_equal(table_path("x_px,y_px\n\n320,90,1.5\n# a remark\n-640;360\r\n 0\t180",
				    ":640x360", &path),
			 GZ_OK);
	assert_int_equal(path.count, 3);
	is_at(&path, 0, 0.5, 0.25);
	is_at(&path, 1, -1, 1);
	is_at(&path, 2, 0, 0.5);
	gz_gaze_path_free(&path);
	assert_int_equal(table_path("0.25,0.75\n", "", &path), GZ_OK);
	assert_int_equal(path.count, 1);
	is_at(&path, 0, 0.25, 0.75);
	gz_gaze_path_free(&path);
}

static void table_that_is_none_is_refused_by_its_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *size, *says;
	} tables[] = {
		{ "x,y\n1,2\nhere,there\n", ":64x48", ".csv:3: not a place" },
		{ "1\n", ":64x48", ".csv:1: not a place" },
		{ "x,y\n", ":64x48", "holds no place" },
		{ "0.5,0.5\n1\n", "", ".csv:2: not a place" },
		{ "320,226\n", "", "FILE.csv:1920x1080" },
		{ "nan,1\n0.5,inf\n", "", ".csv:2: not a place" },
		{ "", "", "holds no place" },
	};
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
		struct gz_gaze_path path = { 0 };
		assert_int_equal(table_path(tables[i].text, tables[i].size, &path), GZ_ERR_FORMAT);
		if (!strstr(captured.last, tables[i].says))
			fail_msg("%s, not: %s", captured.last, tables[i].says);
	}
	const struct gz_gaze_path_settings missing = { .text = "/nowhere/path.csv:64x48" };
	struct gz_gaze_path path = { 0 };
	assert_int_equal(gz_gaze_path_make(&missing, &captured.log, &path), GZ_ERR_NOT_FOUND);
}

static void displays_are_the_same_by_their_angles(void **state)
{
	(void)state;
	struct gz_display a = gz_display_default(1920, 1080), b = gz_display_default(640, 360);
	assert_true(gz_gaze_path_same_display(&a, &b));
	b.distance_mm *= 1.02;
	assert_false(gz_gaze_path_same_display(&a, &b));
	b = gz_display_default(1024, 1024);
	assert_false(gz_gaze_path_same_display(&a, &b));
}

static int name_log(void **state)
{
	(void)state;
	const int file = mkstemps(log_file, 4);
	return file >= 0 ? close(file) : -1;
}

static int remove_log(void **state)
{
	(void)state;
	return unlink(log_file);
}

TEST_SUITE(gaze_path)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(sweep_is_the_mirrored_s, begin),
		cmocka_unit_test_setup(grid_takes_cell_centres_row_by_row, begin),
		cmocka_unit_test_setup(centre_and_x_y_are_one_point, begin),
		cmocka_unit_test_setup(
			random_places_are_those_of_the_seed_and_spread_over_the_picture, begin),
		cmocka_unit_test_setup(points_take_random_cameras_in_turn, begin),
		cmocka_unit_test_setup(points_nearer_than_min_move_are_left_out, begin),
		cmocka_unit_test_setup(per_cell_keeps_the_first_point_in_each, begin),
		cmocka_unit_test_setup(unknown_path_is_refused, begin),
		cmocka_unit_test_setup(recording_gives_one_point_a_fixation, begin),
		cmocka_unit_test_setup(recording_by_samples_leaves_out_where_gaze_is_lost, begin),
		cmocka_unit_test_setup(recording_without_valid_gaze_is_refused, begin),
		cmocka_unit_test_setup(missing_or_damaged_recording_is_refused, begin),
		cmocka_unit_test_setup(table_gives_a_point_a_line_in_shares_or_pixels, begin),
		cmocka_unit_test_setup(table_that_is_none_is_refused_by_its_line, begin),
		cmocka_unit_test_setup(displays_are_the_same_by_their_angles, begin),
	};
	return cmocka_run_group_tests(tests, name_log, remove_log);
}
