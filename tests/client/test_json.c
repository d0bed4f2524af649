#include "suite.h"

#include "client/gazectl/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* @p json, whose reference is released, is printed as @p expected. */
static void assert_printed(json_t *json, const char *expected)
{
	char *text;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	assert_int_equal(gz_output_json_print(json, out, NULL), GZ_OK);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, expected);
	free(text);
}

static void objects_and_lists_nest(void **state)
{
	(void)state;
	assert_printed(json_pack("{s[io] s{} sb sb}", "a", -1, gz_output_json_count(INT64_MAX),
				 "empty", "yes", true, "no", false),
		       "{\n  \"a\": [\n    -1,\n    9223372036854775807\n  ],\n  \"empty\": {},\n"
		       "  \"yes\": true,\n  \"no\": false\n}\n");
	assert_printed(json_pack("[o]", gz_output_json_count(UINT64_MAX)),
		       "[\n  1.84467440737e19\n]\n");
}

static void numbers_that_json_does_not_know_become_null(void **state)
{
	(void)state;
	static const double values[] = { 0.25, 200, -3, 1e300, NAN, -INFINITY };
	assert_printed(gz_output_json_numbers(values, sizeof values / sizeof *values),
		       "[\n  0.25,\n  200,\n  -3,\n  1e300,\n  null,\n  null\n]\n");
}

static void text_is_escaped(void **state)
{
	(void)state;
	static const char *const rows[][2] = {
		{ "plain", "plain" },
		{ "a\"b\\c", "a\\\"b\\\\c" },
		{ "tab\tline\n\x1b", "tab\\tline\\n\\u001B" },
		{ "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80" },
		{ "cut \xc3", "cut \xef\xbf\xbd" },
		{ "overlong \xc0\x80", "overlong \xef\xbf\xbd\xef\xbf\xbd" },
		{ "surrogate \xed\xa0\x80", "surrogate \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" },
		{ "beyond \xf4\x90\x80\x80",
		  "beyond \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		char expected[128];
		snprintf(expected, sizeof expected, "[\n  \"%s\"\n]\n", rows[i][1]);
		assert_printed(json_pack("[o]", gz_output_json_text(rows[i][0])), expected);
	}
}

static void value_that_could_not_be_made_is_a_failure(void **state)
{
	(void)state;
	char *text;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	assert_int_equal(gz_output_json_print(NULL, out, NULL), GZ_ERR_NO_MEM);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, "");
	free(text);
}

TEST_SUITE(json)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(objects_and_lists_nest),
		cmocka_unit_test(numbers_that_json_does_not_know_become_null),
		cmocka_unit_test(text_is_escaped),
		cmocka_unit_test(value_that_could_not_be_made_is_a_failure),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
