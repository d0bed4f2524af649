/**
 * @file
 * Orders of numbers, for qsort() and bsearch(): ascending. Arguments point to the numbers.
 */
#ifndef GZ_BASE_ORDER_H
#define GZ_BASE_ORDER_H

#include <stdint.h>

/** Compare two doubles, neither of them NaN. */
static inline int gz_compare_doubles(const void *left, const void *right)
{
	const double a = *(const double *)left, b = *(const double *)right;
	return (a > b) - (a < b);
}

/** Compare two 64-bit integers, such as times in ns. */
static inline int gz_compare_int64s(const void *left, const void *right)
{
	const int64_t a = *(const int64_t *)left, b = *(const int64_t *)right;
	return (a > b) - (a < b);
}

#endif
