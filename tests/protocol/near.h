/**
 * @file
 * Comparing doubles: cmocka before 1.1.6 cannot.
 */
#ifndef GZ_TESTS_PROTOCOL_NEAR_H
#define GZ_TESTS_PROTOCOL_NEAR_H

#include <math.h>

/** Fail unless both are numbers that differ by at most @p tolerance. */
#define assert_near(actual, expected, tolerance)                                     \
	do {                                                                         \
		double near_a = (actual), near_b = (expected);                       \
		if (!(fabs(near_a - near_b) <= (tolerance)))                         \
			fail_msg("%s is %.17g, not %.17g", #actual, near_a, near_b); \
	} while (0)

#endif
