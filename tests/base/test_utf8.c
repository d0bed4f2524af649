#include "suite.h"

#include "base/utf8.h"

#include <stdio.h>
#include <string.h>

static void length_is_that_of_rfc_3629(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		size_t length;
	} cases[] = {
		{ "a", 1 },
		{ "\xc3\xa4", 2 },
		{ "\xe2\x82\xac", 3 },
		{ "\xf0\x9f\x91\x81", 4 },
		{ "\x80", 0 },             /* a continuation byte */
		{ "\xff", 0 },             /* never occurs in UTF-8 */
		{ "\xc3", 0 },             /* cut off */
		{ "\xe2\x82", 0 },         /* cut off */
		{ "\xc0\xaf", 0 },         /* overlong */
		{ "\xe0\x80\xaf", 0 },     /* overlong */
		{ "\xf0\x80\x80\xaf", 0 }, /* overlong */
		{ "\xed\xa0\x80", 0 },     /* half a surrogate pair */
		{ "\xf4\x90\x80\x80", 0 }, /* beyond the last code point */
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		size_t length = gz_utf8_length(cases[i].text, strlen(cases[i].text));
		if (length != cases[i].length)
			fail_msg("case %zu: %zu bytes instead of %zu", i, length, cases[i].length);
	}
}

static void length_reads_no_further_than_it_may(void **state)
{
	(void)state;
	assert_int_equal(gz_utf8_length("\xf0\x9f\x91\x81", 3), 0);
	assert_int_equal(gz_utf8_length("\xc3\xa4", 1), 0);
}

static void clean_text_has_no_control_characters(void **state)
{
	(void)state;
	static const char *const cases[][2] = {
		{ "", "" },
		{ "br\xc3\xa4in \xe2\x82\xac", "br\xc3\xa4in \xe2\x82\xac" },
		{ "\033[31mred\033]0;title\a", "?[31mred?]0;title?" }, /* colours, window title */
		{ "two\nlines\r\tand a tab", "two?lines??and a tab" },
		{ "\xc2\x9b"
		  "31m",
		  "??31m" }, /* U+009B, the other way to begin such a sequence */
		{ "\x89PNG", "?PNG" },
		{ "cut \xe2\x82", "cut ??" },
		{ "\x7f", "?" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char text[64];
		snprintf(text, sizeof text, "%s", cases[i][0]);
		gz_utf8_clean(text);
		assert_string_equal(text, cases[i][1]);
	}
}

TEST_SUITE(utf8)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(length_is_that_of_rfc_3629),
		cmocka_unit_test(length_reads_no_further_than_it_may),
		cmocka_unit_test(clean_text_has_no_control_characters),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
