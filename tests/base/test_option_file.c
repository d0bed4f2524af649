#include "suite.h"

#include "base/option.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "captured_log.h"
#include "option_sample.h"

static enum gz_result read_into(struct settings *s, bool *given, const char *text, size_t size,
				struct captured_log *captured)
{
	const struct gz_option_binding binding = sample_binding(s, given);
	captured_log_init(captured, "*:debug");
	return gz_options_read_text(&binding, 1, "gz.conf", text, size, &captured->log);
}

static void file_sets_values_and_marks_them_given(void **state)
{
	(void)state;
	static const char text[] = "\xef\xbb\xbf; a comment\r\n"
				   "# another\r\n"
				   "\r\n"
				   "[filter]\r\n"
				   "smoothing = 2.5 ; at rest\r\n"
				   "  [camera] ; indented\n"
				   "\teye=1 2 3\n"
				   "[publish]\n"
				   "port: 6000\n"
				   "name = a;b #c\n"
				   "[render]\n"
				   "method = ddc"; /* no newline at the end */
	struct settings s = { 0 };
	struct captured_log captured;
	bool given[SAMPLE_COUNT] = { false };
	assert_int_equal(read_into(&s, given, text, sizeof text - 1, &captured), GZ_OK);
	assert_int_equal(captured.messages, 0);
	assert_true(s.smoothing_hz == 2.5);
	assert_true(s.eye[0] == 1 && s.eye[1] == 2 && s.eye[2] == 3);
	assert_int_equal(s.port, 6000);
	assert_string_equal(s.name, "a;b #c");
	assert_int_equal(s.method, 2);
	for (int i = 0; i < SAMPLE_COUNT; i++)
		assert_int_equal(given[i], i != SIZE && i != CROSS);
}

static void file_without_anything_is_accepted(void **state)
{
	(void)state;
	const char *const texts[] = { "", "\n", "\n\n; only a comment", "[filter]\n" };
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		struct settings s = { .port = 1 };
		struct captured_log captured;
		assert_int_equal(read_into(&s, NULL, texts[i], strlen(texts[i]), &captured), GZ_OK);
		assert_int_equal(s.port, 1);
	}
}

static const char *const refusals[][2] = {
	{ "[filter]\n\nsmoothing = 500\n", "gz.conf:3: filter.smoothing: 500 is outside 0.1 to "
					   "100" },
	{ "[filter]\nsmoothing = nan\n",
	  "gz.conf:2: filter.smoothing: nan is not a number; allowed: 0.1 to 100" },
	{ "[filter]\nsmoothing = 1 # no\n",
	  "gz.conf:2: filter.smoothing: unexpected \"# no\" after 1 number" },
	{ "[publish]\nname =; none\n",
	  "gz.conf:2: a value cannot begin with ';'; put a blank before a comment" },
	{ "[filter]\nsmoothing =\n", "gz.conf:2: filter.smoothing: 1 number expected, 0 given" },
	{ "[filter]\nsmothing = 1\n",
	  "gz.conf:2: filter.smothing: unknown key; did you mean filter.smoothing?" },
	{ "[publish]\nsmoothing = 1\n",
	  "gz.conf:2: publish.smoothing: unknown key; did you mean filter.smoothing?" },
	{ "[filter]\ncolour = 1\n",
	  "gz.conf:2: filter.colour: unknown key; --help lists all keys" },
	{ "[filter]\nsmoothing = 1\n; c\n[filter]\nsmoothing = 2\n",
	  "gz.conf:5: filter.smoothing: given twice, first in line 2; keep one" },
	{ "[filter]\nsmoothing = 1\n  2\n",
	  "gz.conf:3: expected \"name = value\"; a comment begins with ;" },
	{ "[filter]\nsmoothing\n[camera]\neye = 1 2 3\n",
	  "gz.conf:2: expected \"name = value\"; a comment begins with ;" },
	{ "[filter]\nsmoothing", "gz.conf:2: expected \"name = value\"; a comment begins with ;" },
	{ "[filter\nsmoothing = 1\n", "gz.conf:1: section without ']'; write [name]" },
	{ "[filter] smoothing = 1\n", "gz.conf:1: text after ']'; put it on a line of its own" },
	{ "size = 1x1\n", "gz.conf:1: value before the first section; write [section] above it" },
	{ "[a123456789012345678901234567890123456789012345678]\nx = 1\n",
	  "gz.conf:2: a123456789012345678901234567890123456789012345678.x: unknown key; --help "
	  "lists all keys" },
	{ "[a1234567890123456789012345678901234567890123456789]\n",
	  "gz.conf:1: section name is longer than 49 bytes; shorten it" },
};

static void file_refusal_names_file_line_and_remedy(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct settings s = { 0 };
		struct captured_log captured;
		assert_int_equal(
			read_into(&s, NULL, refusals[i][0], strlen(refusals[i][0]), &captured),
			GZ_ERR_FORMAT);
		assert_string_equal(captured.last, refusals[i][1]);
		assert_int_equal(captured.messages, 1);
		assert_int_equal(captured.level, GZ_LOG_ERROR);
	}
}

static void file_values_before_a_refusal_stay_and_later_ones_are_not_set(void **state)
{
	(void)state;
	static const char text[] = "[publish]\nport = 2000\nname = \n[filter]\nsmoothing = x\n"
				   "[render]\nmethod = ddc\n";
	struct settings s = { .smoothing_hz = 7 };
	struct captured_log captured;
	assert_int_equal(read_into(&s, NULL, text, sizeof text - 1, &captured), GZ_ERR_FORMAT);
	assert_int_equal(s.port, 2000);
	assert_true(s.smoothing_hz == 7);
	assert_int_equal(s.method, 0);
}

static void file_line_of_199_bytes_is_read_and_of_200_refused(void **state)
{
	(void)state;
	for (size_t length = 199; length <= 200; length++) {
		char text[256];
		struct settings s = { 0 };
		struct captured_log captured;
		int head = snprintf(text, sizeof text, "[publish]\nport = 2000 ;");
		size_t line = strlen("port = 2000 ;");
		memset(text + head, 'x', length - line);
		text[(size_t)head + length - line] = '\0';
		enum gz_result result = read_into(&s, NULL, text, strlen(text), &captured);
		assert_int_equal(result, length == 199 ? GZ_OK : GZ_ERR_FORMAT);
		assert_int_equal(s.port, length == 199 ? 2000 : 0);
		assert_string_equal(
			captured.last,
			length == 199
				? ""
				: "gz.conf:2: the line has 200 bytes; at most 199 are allowed");
	}
}

static void file_with_a_zero_byte_is_refused(void **state)
{
	(void)state;
	static const char text[] = "[publish]\nport = 2000\0 1\n";
	struct settings s = { 0 };
	struct captured_log captured;
	assert_int_equal(read_into(&s, NULL, text, sizeof text - 1, &captured), GZ_ERR_FORMAT);
	assert_string_equal(captured.last,
			    "gz.conf:2: contains a zero byte; this is not a text file");
	assert_int_equal(s.port, 0);
}

static void file_given_again_in_another_file_is_no_duplicate(void **state)
{
	(void)state;
	struct settings s = { 0 };
	struct captured_log captured;
	assert_int_equal(read_into(&s, NULL, "[publish]\nport = 2000", 21, &captured), GZ_OK);
	assert_int_equal(read_into(&s, NULL, "[publish]\nport = 3000", 21, &captured), GZ_OK);
	assert_int_equal(s.port, 3000);
}

static void file_options_of_several_bindings_are_distinguished(void **state)
{
	(void)state;
	static const char text[] = "[publish]\nport = 2000\n[other]\nport = 7\n";
	struct settings s = { 0 };
	int other_port = 0;
	bool given[SAMPLE_COUNT] = { false }, other_given = false;
	const struct gz_option other = {
		.key = "other.port", .type = GZ_OPTION_INT, .max = 9, .help = ""
	};
	const struct gz_option_binding bindings[] = {
		sample_binding(&s, given),
		{ .options = &other, .count = 1, .target = &other_port, .given = &other_given },
	};
	assert_int_equal(gz_options_read_text(bindings, 2, "x", text, sizeof text - 1, NULL),
			 GZ_OK);
	assert_int_equal(s.port, 2000);
	assert_int_equal(other_port, 7);
	assert_true(given[PORT] && other_given);
}

static void file_on_disk_is_read(void **state)
{
	(void)state;
	char path[] = "/tmp/gz_option_XXXXXX";
	struct settings s = { 0 };
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, "[publish]\nport=2000\n", 20), 20);
	close(fd);
	enum gz_result result = gz_options_read_file(&binding, 1, path, NULL);
	unlink(path);
	assert_int_equal(result, GZ_OK);
	assert_int_equal(s.port, 2000);
}

static void missing_file_and_folder_are_refused_differently(void **state)
{
	(void)state;
	struct settings s = { 0 };
	struct captured_log captured;
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_options_read_file(&binding, 1, "/nonexistent/gz.conf", &captured.log),
			 GZ_ERR_NOT_FOUND);
	assert_string_equal(captured.last, "/nonexistent/gz.conf: no such file; check the path");
	assert_int_equal(gz_options_read_file(&binding, 1, "/tmp", &captured.log), GZ_ERR_IO);
	assert_string_equal(captured.last, "/tmp: cannot be read: Is a directory");
}

static void file_that_never_ends_is_refused(void **state)
{
	(void)state;
	struct settings s = { 0 };
	struct captured_log captured;
	const struct gz_option_binding binding = sample_binding(&s, NULL);
	captured_log_init(&captured, "*:debug");
	assert_int_equal(gz_options_read_file(&binding, 1, "/dev/zero", &captured.log),
			 GZ_ERR_FORMAT);
	assert_int_equal(captured.messages, 1);
}

TEST_SUITE(option_file)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(file_sets_values_and_marks_them_given),
		cmocka_unit_test(file_without_anything_is_accepted),
		cmocka_unit_test(file_refusal_names_file_line_and_remedy),
		cmocka_unit_test(file_values_before_a_refusal_stay_and_later_ones_are_not_set),
		cmocka_unit_test(file_line_of_199_bytes_is_read_and_of_200_refused),
		cmocka_unit_test(file_with_a_zero_byte_is_refused),
		cmocka_unit_test(file_given_again_in_another_file_is_no_duplicate),
		cmocka_unit_test(file_options_of_several_bindings_are_distinguished),
		cmocka_unit_test(file_on_disk_is_read),
		cmocka_unit_test(missing_file_and_folder_are_refused_differently),
		cmocka_unit_test(file_that_never_ends_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
