#include "suite.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/transfer/transfer.h"
#include "volume_files.h"

#define CLOSE(a, b) assert_float_equal((float)(a), (float)(b), 1e-6f)

static struct gz_transfer parsed(const char *text)
{
	struct gz_transfer t;
	struct captured_log log;
	captured_log_init(&log, NULL);
	if (gz_transfer_parse("t.tf", text, strlen(text), &log.log, &t) != GZ_OK)
		fail_msg("refused: %s", log.last);
	assert_int_equal(log.messages, 0);
	return t;
}

static double opacity_at(const struct gz_transfer *t, double value)
{
	double rgba[4];
	gz_transfer_evaluate(t, value, rgba);
	return rgba[3];
}

static void file_with_every_word_is_read(void **state)
{
	(void)state;
	struct gz_transfer t = parsed("# head\n\n range -1000 2000.5 # HU\r\n"
				      "interpolation quadratic\n0 0 0 0 0\n"
				      "\t0.5 .1 2e-1 0.3 0.4 # middle\n1 1 1 1 1");
	assert_int_equal(t.count, 3);
	assert_true(t.has_range && t.range[0] == -1000 && t.range[1] == 2000.5);
	assert_int_equal(t.interpolation, GZ_TRANSFER_QUADRATIC);
	assert_true(t.points[1].value == 0.5 && t.points[1].rgb[0] == 0.1);
	assert_true(t.points[1].rgb[1] == 0.2 && t.points[1].rgb[2] == 0.3);
	assert_true(t.points[1].opacity == 0.4);
	assert_true(t.points[2].opacity == 1);
}

static void functions_are_the_same_where_points_interpolation_and_range_are(void **state)
{
	(void)state;
	const struct gz_transfer one = parsed("0 0 0 0 0\n1 1 1 1 1\n");
	const struct gz_transfer others[] = {
		parsed("0 0 0 0 0\n1 1 1 1 0.5\n"),
		parsed("0 0 0 0 0\n1 1 0.5 1 1\n"),
		parsed("0 0 0 0 0\n0.5 1 1 1 1\n"),
		parsed("0 0 0 0 0\n"),
		parsed("range 0 1\n0 0 0 0 0\n1 1 1 1 1\n"),
		parsed("interpolation quadratic\n0 0 0 0 0\n1 1 1 1 1\n"),
	};
	struct gz_transfer same = one;
	same.range[0] = 7; /* of no meaning without has_range */
	same.points[2].value = 7;
	assert_true(gz_transfer_same(&one, &same));
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (gz_transfer_same(&one, &others[i]))
			fail_msg("function %zu is told as the first", i);
}

static void without_range_and_interpolation_it_is_linear_over_the_data(void **state)
{
	(void)state;
	struct gz_transfer t = parsed("0 0 0 0 0\n1 1 1 1 1\n");
	assert_false(t.has_range);
	assert_int_equal(t.interpolation, GZ_TRANSFER_LINEAR);
}

static void numbers_are_read_alike_in_every_locale(void **state)
{
	(void)state;
	if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "fr_FR.UTF-8"))
		print_message("no locale with a decimal comma here: only the C locale is tried\n");
	struct gz_transfer t = parsed("0.25 0.5 0.5 0.5 0.75\n");
	setlocale(LC_ALL, "C");
	assert_true(t.points[0].value == 0.25 && t.points[0].opacity == 0.75);
}

struct refusal {
	const char *text, *message;
};

static const struct refusal refusals[] = {
	{ "", "t.tf: no control point; write at least one line \"value r g b a\"" },
	{ "# only a comment\n",
	  "t.tf: no control point; write at least one line \"value r g b a\"" },
	{ "0 0 0 0 0\ncolour 1\n", "t.tf:2: colour: unknown word; write a point \"value r g b a\", "
				   "range or interpolation" },
	{ "0 0 0 0\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "0 0 0 0 0 0\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "0 0 0 0 0x\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "0 0 nan 0 0\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "0 0 0 0 inf\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "0 0,5 0 0 0\n", "t.tf:1: point: write five numbers from 0 to 1: value r g b a" },
	{ "nan 0 0 0 0\n", "t.tf:1: nan: unknown word; write a point \"value r g b a\", range or "
			   "interpolation" },
	{ "1.1 0 0 0 0\n", "t.tf:1: value: out of range; allowed: 0 to 1" },
	{ "-0.1 0 0 0 0\n", "t.tf:1: value: out of range; allowed: 0 to 1" },
	{ "0 2 0 0 0\n", "t.tf:1: red: out of range; allowed: 0 to 1" },
	{ "0 0 0 -1 0\n", "t.tf:1: blue: out of range; allowed: 0 to 1" },
	{ "0 0 0 0 255\n", "t.tf:1: opacity: out of range; allowed: 0 to 1" },
	{ "0.5 0 0 0 0\n\n0.4 0 0 0 0\n",
	  "t.tf:3: value: below that of the point above; let values rise" },
	{ "0.5 0 0 0 0\n0.5 0 0 0 0\n0.5 0 0 0 0\n",
	  "t.tf:3: value: given a third time; two points make a step" },
	{ "range 0\n0 0 0 0 0\n", "t.tf:1: range: write two finite numbers, the lower first" },
	{ "range 1 0\n", "t.tf:1: range: write two finite numbers, the lower first" },
	{ "range 1 1\n", "t.tf:1: range: write two finite numbers, the lower first" },
	{ "range 0 nan\n", "t.tf:1: range: write two finite numbers, the lower first" },
	{ "range 0 1 2\n", "t.tf:1: range: write two finite numbers, the lower first" },
	{ "range 0 1\nrange 0 1\n", "t.tf:2: range: given twice; keep one" },
	{ "interpolation\n", "t.tf:1: interpolation: write linear or quadratic" },
	{ "interpolation cubic\n", "t.tf:1: cubic: unknown; write linear or quadratic" },
	{ "interpolation linear linear\n", "t.tf:1: interpolation: write linear or quadratic" },
	{ "interpolation linear\ninterpolation linear\n",
	  "t.tf:2: interpolation: given twice; keep one" },
};

static void each_refusal_names_line_and_remedy(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; i++) {
		struct gz_transfer t = { .count = 99 };
		struct captured_log log;
		captured_log_init(&log, NULL);
		const char *text = refusals[i].text;
		assert_int_equal(gz_transfer_parse("t.tf", text, strlen(text), &log.log, &t),
				 GZ_ERR_FORMAT);
		assert_int_equal(log.messages, 1);
		assert_string_equal(log.last, refusals[i].message);
		assert_int_equal(t.count, 99);
	}
}

static void too_many_points_are_refused(void **state)
{
	(void)state;
	char text[8192];
	size_t size = 0;
	struct gz_transfer t;
	for (int i = 0; i <= GZ_TRANSFER_POINTS_MAX; i++)
		size += (size_t)snprintf(text + size, sizeof text - size, "%.4f 0 0 0 0\n",
					 i / 300.0);
	assert_int_equal(gz_transfer_parse("t", text, size - 15, NULL, &t), GZ_OK);
	assert_int_equal(t.count, GZ_TRANSFER_POINTS_MAX);
	assert_int_equal(gz_transfer_parse("t", text, size, NULL, &t), GZ_ERR_FORMAT);
}

static void bytes_that_are_no_text_are_refused(void **state)
{
	(void)state;
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_transfer t;
	assert_int_equal(gz_transfer_parse("t", "0 0 0\0 0 0\n", 11, &log.log, &t), GZ_ERR_FORMAT);
	assert_string_equal(log.last, "t:1: line: has a NUL byte; is this a text file?");
	char line[600];
	memset(line, '0', sizeof line);
	assert_int_equal(gz_transfer_parse("t", line, sizeof line, &log.log, &t), GZ_ERR_FORMAT);
	assert_string_equal(log.last, "t:1: line: longer than 255 bytes; shorten it");
	memcpy(line, "0 0 0 0 0 #", 11);
	assert_int_equal(gz_transfer_parse("t", line, sizeof line, &log.log, &t), GZ_OK);
}

static void value_is_interpolated_and_clamped_at_the_ends(void **state)
{
	(void)state;
	struct gz_transfer t = parsed("0.2 1 0 0 0.1\n0.6 0 1 0.5 0.3\n");
	double rgba[4];
	gz_transfer_evaluate(&t, 0.3, rgba);
	CLOSE(rgba[0], 0.75);
	CLOSE(rgba[1], 0.25);
	CLOSE(rgba[2], 0.125);
	CLOSE(rgba[3], 0.15);
	CLOSE(opacity_at(&t, 0), 0.1);
	CLOSE(opacity_at(&t, -5), 0.1);
	CLOSE(opacity_at(&t, 0.6), 0.3);
	CLOSE(opacity_at(&t, 1), 0.3);
	CLOSE(opacity_at(&t, NAN), 0.1);
}

static void two_points_of_one_value_make_a_step(void **state)
{
	(void)state;
	struct gz_transfer t = parsed("0 0 0 0 0\n0.5 0 0 0 0\n0.5 0 0 0 1\n1 0 0 0 1\n");
	assert_true(opacity_at(&t, 0.5 - 1e-12) == 0);
	assert_true(opacity_at(&t, 0.5) == 1);
	assert_true(opacity_at(&t, 0.7) == 1);
}

static void quadratic_eases_in_and_out(void **state)
{
	(void)state;
	struct gz_transfer t = parsed("interpolation quadratic\n0 0 0 0 0\n1 1 1 1 1\n");
	CLOSE(opacity_at(&t, 0.25), 0.125);
	CLOSE(opacity_at(&t, 0.5), 0.5);
	CLOSE(opacity_at(&t, 0.75), 0.875);
	assert_true(opacity_at(&t, 0) == 0 && opacity_at(&t, 1) == 1);
	double slope = (opacity_at(&t, 1e-4) - opacity_at(&t, 0)) / 1e-4;
	assert_true(slope < 1e-3);
}

static void opacity_over_two_halves_is_that_over_the_whole(void **state)
{
	(void)state;
	for (double a = 0; a <= 1; a += 0.125) {
		double half = gz_transfer_opacity_over(a, 0.5);
		CLOSE(1 - (1 - half) * (1 - half), a);
		CLOSE(gz_transfer_opacity_over(a, 1), a);
	}
	CLOSE(gz_transfer_opacity_over(0.3, 0), 0);
	CLOSE(gz_transfer_opacity_over(1, 0.01), 1);
}

static void file_is_loaded_and_a_missing_one_named(void **state)
{
	(void)state;
	struct gz_transfer t;
	struct captured_log log;
	captured_log_init(&log, NULL);
	const char *path = files_write_text("a.tf", "0 0 0 0 0\n1 1 1 1 1\n", NULL, 0);
	assert_int_equal(gz_transfer_load(path, &log.log, &t), GZ_OK);
	assert_int_equal(t.count, 2);
	assert_int_equal(gz_transfer_load(files_path("none.tf"), &log.log, &t), GZ_ERR_NOT_FOUND);
	assert_non_null(
		strstr(log.last, "none.tf: cannot open the transfer function: No such file"));
	assert_int_equal(gz_transfer_load(files_folder(), &log.log, &t), GZ_ERR_IO);
	assert_int_equal(log.messages, 2);
}

static void written_file_reads_back_bit_for_bit(void **state)
{
	(void)state;
	const char *path = files_path("written.tf");
	struct gz_transfer t = {
		.count = 3,
		.points = { { 0, { 0.1, 1.0 / 3, 1 }, 0 },
			    { 0.1 + 0.2, { 5e-324, 0.7, 1e-9 }, 2.0 / 3 },
			    { 0.1 + 0.2, { 1, 1, 0.1 }, 1 } },
		.interpolation = GZ_TRANSFER_QUADRATIC,
		.has_range = true,
		.range = { -1024.1, 1e300 },
	};
	for (int turn = 0; turn < 2; turn++) {
		struct gz_transfer read;
		struct captured_log log;
		captured_log_init(&log, NULL);
		if (gz_transfer_write(&t, path, &log.log) != GZ_OK ||
		    gz_transfer_load(path, &log.log, &read) != GZ_OK)
			fail_msg("%s", log.last);
		assert_int_equal(read.count, t.count);
		assert_memory_equal(read.points, t.points, 3 * sizeof t.points[0]);
		assert_int_equal(read.interpolation, t.interpolation);
		assert_int_equal(read.has_range, t.has_range);
		assert_true(!t.has_range || memcmp(read.range, t.range, sizeof t.range) == 0);
		t.has_range = false;
		t.interpolation = GZ_TRANSFER_LINEAR;
	}
}

static void transfer_that_no_file_can_hold_is_not_written(void **state)
{
	(void)state;
	struct gz_transfer t = { .count = 1, .points = { { .value = NAN } } };
	struct captured_log log;
	captured_log_init(&log, NULL);
	const char *path = files_path("refused.tf");
	assert_int_equal(gz_transfer_write(&t, path, &log.log), GZ_ERR_INVAL);
	t.count = 0;
	assert_int_equal(gz_transfer_write(&t, path, &log.log), GZ_ERR_INVAL);
	t.count = GZ_TRANSFER_POINTS_MAX + 1;
	assert_int_equal(gz_transfer_write(&t, path, &log.log), GZ_ERR_INVAL);
	assert_int_equal(log.messages, 3);
	assert_int_equal(gz_transfer_load(path, NULL, &t), GZ_ERR_NOT_FOUND);
	t = (struct gz_transfer) { .count = 1 };
	assert_int_equal(gz_transfer_write(&t, "/no/such/folder/a.tf", &log.log), GZ_ERR_IO);
}

static void it_shows_data_where_it_has_opacity(void **state)
{
	(void)state;
	const struct gz_transfer peak = {
		.count = 3,
		.points = { { .value = 0.4 }, { .value = 0.5, .opacity = 0.3 }, { .value = 0.6 } },
		.has_range = true,
		.range = { -100, 100 },
	};
	struct gz_transfer own = peak;
	own.has_range = false;
	assert_true(gz_transfer_shows(&peak, -5, 5));
	assert_true(gz_transfer_shows(&peak, 19, 300));     /* its last part */
	assert_true(gz_transfer_shows(&peak, -1000, 1000)); /* all of it lies between */
	assert_true(gz_transfer_shows(&peak, 3, 3));
	assert_false(gz_transfer_shows(&peak, 20, 300));
	assert_false(gz_transfer_shows(&peak, -1000, -20));
	assert_true(gz_transfer_shows(&own, 20, 300));
}

TEST_SUITE(transfer)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_with_every_word_is_read),
		cmocka_unit_test(it_shows_data_where_it_has_opacity),
		cmocka_unit_test(functions_are_the_same_where_points_interpolation_and_range_are),
		cmocka_unit_test(without_range_and_interpolation_it_is_linear_over_the_data),
		cmocka_unit_test(numbers_are_read_alike_in_every_locale),
		cmocka_unit_test(each_refusal_names_line_and_remedy),
		cmocka_unit_test(too_many_points_are_refused),
		cmocka_unit_test(bytes_that_are_no_text_are_refused),
		cmocka_unit_test(value_is_interpolated_and_clamped_at_the_ends),
		cmocka_unit_test(two_points_of_one_value_make_a_step),
		cmocka_unit_test(quadratic_eases_in_and_out),
		cmocka_unit_test(opacity_over_two_halves_is_that_over_the_whole),
		cmocka_unit_test(file_is_loaded_and_a_missing_one_named),
		cmocka_unit_test(written_file_reads_back_bit_for_bit),
		cmocka_unit_test(transfer_that_no_file_can_hold_is_not_written),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
