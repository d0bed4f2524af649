#include "suite.h"

#include "base/result.h"

#include <ctype.h>
#include <string.h>

/* The last value of the enum. Change this when a value is added, so that it is checked below. */
enum { LAST = GZ_ERR_CHOICE };

static void result_text_each_value_has_its_own_phrase(void **state)
{
	(void)state;
	for (int a = GZ_OK; a >= LAST; a--) {
		const char *text = gz_result_text((enum gz_result)a);
		assert_non_null(text);
		assert_string_not_equal(text, "unknown result");
		for (int b = GZ_OK; b > a; b--)
			assert_string_not_equal(text, gz_result_text((enum gz_result)b));
	}
}

static void result_text_reads_as_a_phrase(void **state)
{
	(void)state;
	for (int a = GZ_OK; a >= LAST; a--) {
		const char *text = gz_result_text((enum gz_result)a);
		assert_true(islower((unsigned char)text[0]));
		assert_true(isalpha((unsigned char)text[strlen(text) - 1]));
	}
}

static void result_text_outside_the_enum_is_unknown(void **state)
{
	(void)state;
	const int outside[] = { 1, 1000, LAST - 1, -1000 };
	for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
		assert_string_equal(gz_result_text((enum gz_result)outside[i]), "unknown result");
	}
}

TEST_SUITE(result)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(result_text_each_value_has_its_own_phrase),
		cmocka_unit_test(result_text_reads_as_a_phrase),
		cmocka_unit_test(result_text_outside_the_enum_is_unknown),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
