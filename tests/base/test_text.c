/* Numbers are printed with the fewest digits that read back to the same value. */
#include "suite.h"

#include <float.h>
#include <math.h>

#include "base/text.h"

static void printed_number_is_the_shortest_that_reads_back(void **state)
{
	(void)state;
	static const struct {
		double value;
		const char *text;
	} numbers[] = {
		{ 0.8, "0.8" },
		{ 1.0 / 3, "0.3333333333333333" },
		{ 600, "600" },
		{ -1e-5, "-1e-05" },
		{ 0, "0" },
		{ 0.1 + 0.2, "0.30000000000000004" },
		{ DBL_MAX, "1.7976931348623157e+308" },
		{ -DBL_TRUE_MIN, "-5e-324" },
	};
	for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
		char text[GZ_NUMBER_SIZE];
		double back;
		gz_number_print(numbers[i].value, text);
		assert_string_equal(text, numbers[i].text);
		assert_true(gz_number_parse(text, &back) && back == numbers[i].value);
	}
}

static void decimal_of_a_float_is_that_float_again(void **state)
{
	(void)state;
	assert_true(gz_number_of_float(0.1F) == 0.1);
	assert_true(gz_number_of_float(0.8F) == 0.8);
	assert_true(gz_number_of_float(-3) == -3);
	for (int i = 1; i < 2000; i++) {
		const float value = ldexpf((float)i / 1999, i % 40 - 20);
		const double decimal = gz_number_of_float(value);
		if ((float)decimal != value)
			fail_msg("%.17g is not %.9g", decimal, (double)value);
	}
}

TEST_SUITE(text)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(printed_number_is_the_shortest_that_reads_back),
		cmocka_unit_test(decimal_of_a_float_is_that_float_again),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
