/**
 * @file
 * Checks of numbers that print the value on failure.
 */
#ifndef GZ_TESTS_FILTER_CHECK_H
#define GZ_TESTS_FILTER_CHECK_H

#include "suite.h"

#define CHECK_BETWEEN(got, low, high)                                                      \
	do {                                                                               \
		double g_ = (got), l_ = (low), h_ = (high);                                \
		if (!(g_ >= l_ && g_ <= h_))                                               \
			fail_msg("%s is %.9g, not within %.9g to %.9g", #got, g_, l_, h_); \
	} while (0)

#endif
