/* Answers of experiments: shares, thresholds, and the command that sums them up. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "base/text.h"
#include "bench/answers/answer_page.h"
#include "bench/answers/psychometric.h"

static const struct gz_psychometric_params usual = { 0.5, 0.01, 0.82 };

static void assert_within(const char *what, double value, double expected, double relative)
{
	if (!(fabs(value - expected) <= relative * fabs(expected) + 1e-9))
		fail_msg("%s is %.9g, not %.9g", what, value, expected);
}

/* Expected numbers: Wilson's formula in Python. */
static void share_has_the_score_interval(void **state)
{
	(void)state;
	const struct gz_interval some = gz_share_interval(15, 20);
	assert_within("low", some.low, 0.5312991206, 1e-6);
	assert_within("high", some.high, 0.8881382993, 1e-6);
	assert_within("none", gz_share_interval(0, 5).low, 0, 0);
	assert_within("all", gz_share_interval(5, 5).low, 0.5655175313, 1e-6);
	assert_true(isnan(gz_share_interval(0, 0).low));
}

/* Expected numbers: a grid of 3001 thresholds and 301 slopes in Python. */
static void fit_is_that_of_a_finer_grid(void **state)
{
	(void)state;
	static const struct gz_value_count counts[] = {
		{ 0.02, 20, 9 }, { 0.04, 20, 13 }, { 0.06, 20, 14 },
		{ 0.1, 20, 19 }, { 0.2, 20, 20 },
	};
	struct gz_psychometric fit;
	assert_int_equal(gz_psychometric_fit(counts, 5, &usual, &fit), GZ_OK);
	assert_false(fit.falling);
	assert_within("threshold", fit.threshold, 0.0734513868, 0.02);
	assert_within("slope", fit.beta, 2.62964426, 0.1);
	assert_within("low", fit.interval.low, 0.0562341325, 0.04);
	assert_within("high", fit.interval.high, 0.1, 0.04);
	assert_within("share", gz_psychometric_share(&fit, &usual, fit.threshold), 0.82, 1e-6);
}

static void falling_functions_are_found_by_themselves(void **state)
{
	(void)state;
	static const struct gz_value_count counts[] = {
		{ 0.2, 20, 20 },
		{ 0.4, 20, 19 },
		{ 0.8, 20, 11 },
		{ 1.6, 20, 9 },
	};
	struct gz_psychometric fit;
	assert_int_equal(gz_psychometric_fit(counts, 4, &usual, &fit), GZ_OK);
	assert_true(fit.falling);
	assert_true(fit.threshold > 0.3 && fit.threshold < 0.8);
}

static void answers_that_bound_nothing_say_so(void **state)
{
	(void)state;
	static const struct gz_value_count all[] = { { 0.1, 5, 5 }, { 0.2, 5, 5 } };
	static const struct gz_value_count one[] = { { 0.1, 5, 5 } };
	static const struct gz_value_count none[] = { { 0, 5, 5 }, { 1, 5, 5 } };
	const struct gz_psychometric_params impossible = { 0.9, 0, 0.8 };
	struct gz_psychometric fit;
	assert_int_equal(gz_psychometric_fit(all, 2, &usual, &fit), GZ_OK);
	assert_true(isnan(fit.interval.low) || isnan(fit.interval.high));
	assert_int_equal(gz_psychometric_fit(one, 1, &usual, &fit), GZ_ERR_INVAL);
	assert_int_equal(gz_psychometric_fit(none, 2, &usual, &fit), GZ_ERR_INVAL);
	assert_int_equal(gz_psychometric_fit(all, 2, &impossible, &fit), GZ_ERR_INVAL);
}

#define HEADER                                                                                   \
	"trial_type\tpractice\tcorrect\tresponse\tresponse_time\tscene_1\tsettings_1\tsettings_" \
	"2\t"                                                                                    \
	"staircase\tstaircase_value\n"

/* A file of answers for a test; its path. */
static const char *write_answers(const char *text)
{
	static char path[] = "/tmp/gazecast-answers-XXXXXX";
	snprintf(path, sizeof path, "/tmp/gazecast-answers-XXXXXX");
	const int fd = mkstemp(path);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, text, strlen(text)), strlen(text));
	close(fd);
	return path;
}

static struct captured_log captured;

static void rows_are_grouped_and_practice_does_not_count(void **state)
{
	(void)state;
	struct gz_answer_table table = { 0 };
	captured_log_init(&captured, "*:debug");
	const char *path =
		write_answers(HEADER "a\t0\t1\tfirst\t0.5\ts\tn/a\tk.x=0.2\tk.x\t0.2\n"
				     "a\t0\t0\tsecond\t0.9\ts\tn/a\tk.x=0.1\tk.x\t0.1\n"
				     "a\t0\t1\tsecond\t0.7\ts\tn/a\tk.x=0.2\tk.x\t0.2\n"
				     "b\t0\t1\tsecond\t0.7\tt\tk.xx=4 k.x=0.3\tn/a\tn/a\tn/a\n"
				     "b\t1\t1\tsecond\t0.7\tt\tn/a\tn/a\tn/a\tn/a\n"
				     "b\t0\t0\tn/a\tn/a\tt\tn/a\tn/a\tn/a\tn/a\n"
				     "b\t0\tn/a\tfirst\t1\tt\tn/a\tn/a\tn/a\tn/a\n");
	assert_int_equal(gz_answer_table_add(&table, path, "", &captured.log), GZ_OK);
	assert_int_equal(table.group_count, 2);
	assert_int_equal(table.groups[0].trials, 3);
	assert_int_equal(table.groups[0].right, 2);
	assert_int_equal(table.groups[0].count_count, 2);
	assert_true(table.groups[0].counts[1].value == 0.2 && table.groups[0].counts[1].right == 2);
	assert_within("median", gz_answer_group_median_s(&table.groups[0]), 0.7, 0);
	assert_int_equal(table.groups[1].trials, 1);
	assert_int_equal(table.groups[1].count_count, 0);
	assert_true(table.practice == 1 && table.late == 1 && table.unjudged == 1);
	gz_answer_table_free(&table);
	assert_int_equal(gz_answer_table_add(&table, path, "k.x", &captured.log), GZ_OK);
	assert_string_equal(table.groups[1].name, "t");
	assert_true(table.groups[1].counts[0].value == 0.3);
	gz_answer_table_free(&table);
	unlink(path);
}

static void page_draws_each_threshold(void **state)
{
	(void)state;
	struct gz_answer_table table = { 0 };
	struct gz_text page = { 0 };
	captured_log_init(&captured, "*:debug");
	const char *path = write_answers(HEADER "a<b\t0\t1\tfirst\t0.5\ts\tn/a\tn/a\tk.x\t0.2\n"
						"a<b\t0\t0\tfirst\t0.5\ts\tn/a\tn/a\tk.x\t0.1\n");
	assert_int_equal(gz_answer_table_add(&table, path, "", &captured.log), GZ_OK);
	assert_int_equal(gz_answer_page_write(&table, &usual, path, &captured.log), GZ_OK);
	assert_int_equal(gz_text_add_file(&page, path), GZ_OK);
	assert_non_null(strstr(page.bytes, "<h2>a&lt;b</h2>"));
	assert_non_null(strstr(page.bytes, "k.x: 82 % right at "));
	assert_non_null(strstr(page.bytes, "</svg>"));
	assert_null(strstr(page.bytes, "nan"));
	gz_text_free(&page);
	gz_answer_table_free(&table);
	unlink(path);
}

static void other_tables_are_refused_with_their_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *message;
	} cases[] = {
		{ "", ":0: empty" },
		{ "onset\n", ":1: no column trial_type" },
		{ HEADER "a\t0\n", ":2: not as many cells as columns" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_answer_table table = { 0 };
		captured_log_init(&captured, "*:debug");
		const char *path = write_answers(cases[i].text);
		assert_int_equal(gz_answer_table_add(&table, path, "", &captured.log),
				 GZ_ERR_FORMAT);
		if (!strstr(captured.last, cases[i].message))
			fail_msg("%s does not say %s", captured.last, cases[i].message);
		gz_answer_table_free(&table);
		unlink(path);
	}
}

TEST_SUITE(psychometric)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(share_has_the_score_interval),
		cmocka_unit_test(fit_is_that_of_a_finer_grid),
		cmocka_unit_test(falling_functions_are_found_by_themselves),
		cmocka_unit_test(answers_that_bound_nothing_say_so),
		cmocka_unit_test(rows_are_grouped_and_practice_does_not_count),
		cmocka_unit_test(page_draws_each_threshold),
		cmocka_unit_test(other_tables_are_refused_with_their_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
