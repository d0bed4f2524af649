#include "check.h"

#include "client/gazectl/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What was written since @p memory was opened. */
static void assert_written(struct gz_json *json, char **text, const char *expected)
{
	assert_int_equal(fclose(json->out), 0);
	assert_string_equal(*text, expected);
	free(*text);
}

static void objects_and_lists_nest(void **state)
{
	(void)state;
	char *text;
	size_t size;
	struct gz_json json = { .out = open_memstream(&text, &size) };
	gz_json_begin(&json, NULL);
	gz_json_begin_list(&json, "a");
	gz_json_int(&json, NULL, -1);
	gz_json_uint(&json, NULL, UINT64_MAX);
	gz_json_end_list(&json);
	gz_json_begin(&json, "empty");
	gz_json_end(&json);
	gz_json_bool(&json, "yes", true);
	gz_json_bool(&json, "no", false);
	gz_json_end(&json);
	assert_written(&json, &text,
		       "{\n  \"a\": [\n    -1,\n    18446744073709551615\n  ],\n  \"empty\": {},\n"
		       "  \"yes\": true,\n  \"no\": false\n}\n");
}

static void numbers_that_json_does_not_know_become_null(void **state)
{
	(void)state;
	char *text;
	size_t size;
	struct gz_json json = { .out = open_memstream(&text, &size) };
	gz_json_begin_list(&json, NULL);
	gz_json_double(&json, NULL, 0.25);
	gz_json_double(&json, NULL, 1e300);
	gz_json_double(&json, NULL, NAN);
	gz_json_double(&json, NULL, -INFINITY);
	gz_json_end_list(&json);
	assert_written(&json, &text, "[\n  0.25,\n  1e+300,\n  null,\n  null\n]\n");
}

static void text_is_escaped(void **state)
{
	(void)state;
	static const char *const rows[][2] = {
		{ "plain", "plain" },
		{ "a\"b\\c", "a\\\"b\\\\c" },
		{ "tab\tline\n\x1b\x7f", "tab\\u0009line\\u000a\\u001b\\u007f" },
		{ "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80" },
		{ "cut \xc3", "cut \\ufffd" },
		{ "overlong \xc0\x80", "overlong \\ufffd\\ufffd" },
		{ "surrogate \xed\xa0\x80", "surrogate \\ufffd\\ufffd\\ufffd" },
		{ "beyond \xf4\x90\x80\x80", "beyond \\ufffd\\ufffd\\ufffd\\ufffd" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		char *text, expected[128];
		size_t size;
		struct gz_json json = { .out = open_memstream(&text, &size) };
		gz_json_text(&json, NULL, rows[i][0]);
		snprintf(expected, sizeof expected, "\"%s\"", rows[i][1]);
		assert_written(&json, &text, expected);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(objects_and_lists_nest),
		cmocka_unit_test(numbers_that_json_does_not_know_become_null),
		cmocka_unit_test(text_is_escaped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
