/* The time of the last sample, found without reading the whole log. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/gaze_log.h"

static char path[] = "/tmp/gazecast-test-tail-XXXXXX";

static int make_file(void **state)
{
	(void)state;
	const int file = mkstemp(path);
	return file < 0 ? -1 : close(file);
}

static int remove_file(void **state)
{
	(void)state;
	return unlink(path);
}

static void append_record(FILE *out, const struct gz_gaze_log_record *record)
{
	char text[GZ_GAZE_LOG_LINE_SIZE];
	size_t length;
	assert_int_equal(gz_gaze_log_print_record(record, text, sizeof text, &length), GZ_OK);
	assert_int_equal(fwrite(text, 1, length, out), length);
}

/* Samples one millisecond apart, from 1 ms on. */
static FILE *begin(int samples)
{
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	fputs("#gazecast-log 1\n", out);
	for (int i = 1; i <= samples; i++) {
		struct gz_gaze_log_record record = { .sample = gz_sample_unmeasured() };
		record.sample.host_ns = i * INT64_C(1000000);
		append_record(out, &record);
	}
	return out;
}

static void found(int64_t wanted_ns)
{
	int64_t last_ns = -1;
	assert_int_equal(gz_gaze_log_find_last(path, &last_ns), GZ_OK);
	assert_int_equal(last_ns, wanted_ns);
}

static void last_sample_is_found_in_short_and_in_long_logs(void **state)
{
	(void)state;
	fclose(begin(1));
	found(1000000);
	fclose(begin(20000));
	found(INT64_C(20000000000));
}

static void marks_ends_and_cut_lines_after_it_are_skipped(void **state)
{
	(void)state;
	FILE *out = begin(100);
	const struct gz_gaze_log_record mark = { .kind = GZ_GAZE_LOG_MARK,
						 .host_ns = 5,
						 .text = "later" };
	append_record(out, &mark);
	fputs("#end 100 00000000\n", out);
	fputs("101\t999999", out);
	fclose(out);
	found(100000000);
}

static void nul_and_noise_do_not_hide_it(void **state)
{
	(void)state;
	FILE *out = begin(3);
	fwrite("a\0b\n\0\0\n\n", 1, 8, out);
	fclose(out);
	found(3000000);
}

static void file_without_a_sample_is_refused(void **state)
{
	(void)state;
	int64_t last_ns = 77;
	FILE *out = fopen(path, "wb");
	assert_non_null(out);
	fclose(out);
	assert_int_equal(gz_gaze_log_find_last(path, &last_ns), GZ_ERR_IO);
	fclose(begin(0));
	assert_int_equal(gz_gaze_log_find_last(path, &last_ns), GZ_ERR_FORMAT);
	assert_int_equal(gz_gaze_log_find_last("/nonexistent/log.gzl", &last_ns), GZ_ERR_NOT_FOUND);
	assert_int_equal(last_ns, 77);
}

TEST_SUITE(gaze_log_tail)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(last_sample_is_found_in_short_and_in_long_logs),
		cmocka_unit_test(marks_ends_and_cut_lines_after_it_are_skipped),
		cmocka_unit_test(nul_and_noise_do_not_hide_it),
		cmocka_unit_test(file_without_a_sample_is_refused),
	};
	return cmocka_run_group_tests(tests, make_file, remove_file);
}
