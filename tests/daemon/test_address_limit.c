#include "suite.h"

#include <stdio.h>

#include "base/clock.h"
#include "daemon/admission.h"

enum { KIND, OTHER_KIND };

static struct gz_address_limit limit;

static int set_up(void **state)
{
	(void)state;
	limit = (struct gz_address_limit) { 0 };
	return 0;
}

static void limit_lets_one_message_an_address_through_each_minute(void **state)
{
	(void)state;
	uint64_t dropped = 99;
	int64_t now_ns = 5 * GZ_NS_PER_S;
	assert_true(gz_address_limit_pass(&limit, "10.0.0.1", KIND, now_ns, &dropped));
	assert_int_equal(dropped, 0);
	for (int i = 0; i < 1000; i++)
		assert_false(gz_address_limit_pass(&limit, "10.0.0.1", KIND,
						   now_ns + i * 59 * GZ_NS_PER_MS, &dropped));
	assert_true(gz_address_limit_pass(&limit, "10.0.0.2", KIND, now_ns, &dropped));
	assert_true(gz_address_limit_pass(&limit, "10.0.0.1", OTHER_KIND, now_ns, &dropped));
	assert_true(gz_address_limit_pass(&limit, "10.0.0.1", KIND, now_ns + GZ_ADDRESS_LIMIT_NS,
					  &dropped));
	assert_int_equal(dropped, 1000);
}

/* An attacker with any number of addresses. */
static void limit_of_many_addresses_stays_bounded(void **state)
{
	(void)state;
	uint64_t dropped;
	int passed = 0;
	for (int i = 0; i < 100000; i++) {
		char address[32];
		snprintf(address, sizeof address, "fd00::%x:%x", i >> 16, i & 0xffff);
		passed += gz_address_limit_pass(&limit, address, KIND, (int64_t)i * 1000, &dropped);
	}
	assert_int_equal(passed, GZ_ADDRESS_LIMIT_COUNT + 1);
	/* A minute later entries are free again. */
	assert_true(
		gz_address_limit_pass(&limit, "10.0.0.1", KIND, 2 * GZ_ADDRESS_LIMIT_NS, &dropped));
	assert_false(
		gz_address_limit_pass(&limit, "10.0.0.1", KIND, 2 * GZ_ADDRESS_LIMIT_NS, &dropped));
}

static void limit_keeps_the_count_of_who_comes_steadily(void **state)
{
	(void)state;
	uint64_t dropped = 0;
	int64_t now_ns = 0;
	for (int i = 0; i < GZ_ADDRESS_LIMIT_COUNT - 1; i++) {
		char address[32];
		snprintf(address, sizeof address, "10.0.1.%d", i);
		assert_true(gz_address_limit_pass(&limit, address, KIND, now_ns + i, &dropped));
	}
	now_ns = GZ_NS_PER_S;
	assert_true(gz_address_limit_pass(&limit, "10.0.0.1", KIND, now_ns, &dropped));
	assert_false(gz_address_limit_pass(&limit, "10.0.0.1", KIND, now_ns + 1, &dropped));
	/* A new address replaces the oldest one, not the frequent one. */
	now_ns += GZ_ADDRESS_LIMIT_NS;
	assert_true(gz_address_limit_pass(&limit, "10.0.2.1", KIND, now_ns, &dropped));
	assert_true(gz_address_limit_pass(&limit, "10.0.0.1", KIND, now_ns, &dropped));
	assert_int_equal(dropped, 1);
}

static void limit_takes_addresses_of_any_length(void **state)
{
	(void)state;
	uint64_t dropped;
	char address[1000];
	for (size_t i = 0; i < sizeof address - 1; i++)
		address[i] = 'a';
	address[sizeof address - 1] = '\0';
	assert_true(gz_address_limit_pass(&limit, address, KIND, 0, &dropped));
	assert_false(gz_address_limit_pass(&limit, address, KIND, 0, &dropped));
	assert_true(gz_address_limit_pass(&limit, "", KIND, 0, &dropped));
	assert_false(gz_address_limit_pass(&limit, "", KIND, 0, &dropped));
}

TEST_SUITE(address_limit)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(limit_lets_one_message_an_address_through_each_minute,
				       set_up),
		cmocka_unit_test_setup(limit_of_many_addresses_stays_bounded, set_up),
		cmocka_unit_test_setup(limit_keeps_the_count_of_who_comes_steadily, set_up),
		cmocka_unit_test_setup(limit_takes_addresses_of_any_length, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
