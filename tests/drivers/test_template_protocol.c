#include "suite.h"

#include <math.h>
#include <string.h>

#include "template_made.h"

static const struct gz_template_report sample = {
	.counter = 0x01020304,
	.clock_us = 0xfffffff0,
	.found = { true, false },
	.point = { { 0.25f, 0.75f }, { -1.5f, 2.0f } },
};

static void template_report_has_the_documented_layout(void **state)
{
	(void)state;
	static const unsigned char expected[GZ_TEMPLATE_REPORT_SIZE] = {
		'G',  'T',  1,    1, /* right eye, version 1 */
		0x04, 0x03, 0x02, 0x01, 0xf0, 0xff, 0xff, 0xff, 0x00, 0x00, 0x80, 0x3e, 0x00, 0x00,
		0x40, 0x3f, 0x00, 0x00, 0xc0, 0xbf, 0x00, 0x00, 0x00, 0x40, 0x90, 0x07, 0x00, 0x00,
	};
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	template_made_report(&sample, bytes);
	assert_memory_equal(bytes, expected, sizeof bytes);
}

static void template_report_survives_a_round_trip(void **state)
{
	(void)state;
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	struct gz_template_report read;
	template_made_report(&sample, bytes);
	assert_int_equal(gz_template_parse(bytes, sizeof bytes, &read), GZ_OK);
	assert_int_equal(read.counter, sample.counter);
	assert_int_equal(read.clock_us, sample.clock_us);
	assert_true(read.found[0] && !read.found[1]);
	assert_memory_equal(read.point, sample.point, sizeof read.point);
}

static void template_any_changed_byte_is_refused(void **state)
{
	(void)state;
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	struct gz_template_report untouched = { .counter = 77 };
	for (size_t i = 0; i < sizeof bytes; i++) {
		template_made_report(&sample, bytes);
		bytes[i] ^= 0x10;
		assert_int_equal(gz_template_parse(bytes, sizeof bytes, &untouched),
				 GZ_ERR_PROTOCOL);
		assert_int_equal(untouched.counter, 77);
	}
}

static void template_short_report_is_refused(void **state)
{
	(void)state;
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	struct gz_template_report read;
	template_made_report(&sample, bytes);
	for (size_t size = 0; size < sizeof bytes; size++)
		assert_int_equal(gz_template_parse(bytes, size, &read), GZ_ERR_PROTOCOL);
}

TEST_SUITE(template_protocol)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(template_report_has_the_documented_layout),
		cmocka_unit_test(template_report_survives_a_round_trip),
		cmocka_unit_test(template_any_changed_byte_is_refused),
		cmocka_unit_test(template_short_report_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
