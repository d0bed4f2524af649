#include "suite.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "base/portable.h"
#include "sim/random.h"

#define CHECK_NEAR(got, wanted, tolerance)                                       \
	do {                                                                     \
		double g = (got), w = (wanted);                                  \
		if (!(fabs(g - w) <= (tolerance)))                               \
			fail_msg("%s is %.17g, not %.17g within %g", #got, g, w, \
				 (double)(tolerance));                           \
	} while (0)

static void bits_of_known_state_are_those_of_the_publication(void **state)
{
	(void)state;
	/* For the state 1, 2, 3, 4; computed by hand from the definition. */
	struct gz_random random = { .state = { 1, 2, 3, 4 } };
	assert_int_equal(gz_random_bits(&random), 11520);
	assert_int_equal(gz_random_bits(&random), 0);
	assert_int_equal(gz_random_bits(&random), 1509978240);
}

static void streams_of_one_seed_differ(void **state)
{
	(void)state;
	struct gz_random a = gz_random_seeded(1, 1), b = gz_random_seeded(1, 2);
	struct gz_random c = gz_random_seeded(2, 1), d = gz_random_seeded(1, 1);
	uint64_t first = gz_random_bits(&a);
	assert_int_not_equal(first, gz_random_bits(&b));
	assert_int_not_equal(first, gz_random_bits(&c));
	assert_int_equal(first, gz_random_bits(&d));
}

static void normals_have_mean_0_and_deviation_1(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(5, 0);
	double sum = 0, squares = 0, fourths = 0;
	const int count = 200000;
	for (int i = 0; i < count; i++) {
		double x = gz_random_normal(&random);
		sum += x;
		squares += x * x;
		fourths += x * x * x * x;
	}
	CHECK_NEAR(sum / count, 0, 0.01);
	CHECK_NEAR(squares / count, 1, 0.02);
	CHECK_NEAR(fourths / count, 3, 0.15);
}

static void gammas_have_mean_1_and_variance_of_their_shape(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(6, 0);
	for (int shape = 1; shape <= 4; shape++) {
		double sum = 0, squares = 0;
		const int count = 100000;
		for (int i = 0; i < count; i++) {
			double x = gz_random_gamma(&random, shape);
			assert_true(x >= 0);
			sum += x;
			squares += x * x;
		}
		double mean = sum / count;
		CHECK_NEAR(mean, 1, 0.02);
		CHECK_NEAR(squares / count - mean * mean, 1.0 / shape, 0.05);
	}
}

static void shuffle_gives_all_orders_equally_often(void **state)
{
	(void)state;
	enum { DRAWS = 6000 };
	struct gz_random random = gz_random_seeded(5, 0);
	int seen[3][3] = { { 0 } }; /* by the first and the second item */
	for (int i = 0; i < DRAWS; i++) {
		int items[] = { 0, 1, 2 };
		gz_random_shuffle(&random, items, 3, sizeof items[0]);
		assert_int_equal(items[0] + items[1] + items[2], 3);
		seen[items[0]][items[1]]++;
	}
	for (int first = 0; first < 3; first++)
		for (int second = 0; second < 3; second++)
			if (first != second)
				assert_in_range(seen[first][second], DRAWS / 6 - 150,
						DRAWS / 6 + 150);
}

static void portable_functions_agree_with_the_library(void **state)
{
	(void)state;
	struct gz_random random = gz_random_seeded(7, 0);
	for (int i = 0; i < 100000; i++) {
		double x = gz_random_between(&random, -50, 50);
		double y = gz_random_between(&random, -50, 50);
		double positive = gz_portable_exp(x);
		CHECK_NEAR(positive / exp(x), 1, 1e-13);
		CHECK_NEAR(gz_portable_log(positive), log(positive), 1e-13 * (1 + fabs(x)));
		CHECK_NEAR(gz_portable_sin(x), sin(x), 1e-10);
		CHECK_NEAR(gz_portable_cos(x), cos(x), 1e-10);
		CHECK_NEAR(gz_portable_atan2(y, x), atan2(y, x), 1e-12);
	}
}

static void angle_of_the_axes_is_exact(void **state)
{
	(void)state;
	CHECK_NEAR(gz_portable_atan2(0, 0), 0, 0);
	CHECK_NEAR(gz_portable_atan2(0, 1), 0, 0);
	CHECK_NEAR(gz_portable_atan2(1, 0), acos(-1) / 2, 1e-15);
	CHECK_NEAR(gz_portable_atan2(-1, 0), -acos(-1) / 2, 1e-15);
	CHECK_NEAR(gz_portable_atan2(0, -1), acos(-1), 1e-15);
}

TEST_SUITE(random)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(bits_of_known_state_are_those_of_the_publication),
		cmocka_unit_test(streams_of_one_seed_differ),
		cmocka_unit_test(normals_have_mean_0_and_deviation_1),
		cmocka_unit_test(gammas_have_mean_1_and_variance_of_their_shape),
		cmocka_unit_test(shuffle_gives_all_orders_equally_often),
		cmocka_unit_test(portable_functions_agree_with_the_library),
		cmocka_unit_test(angle_of_the_axes_is_exact),
	};
	return cmocka_run_group_tests_name("sim.random", tests, NULL, NULL);
}
