/**
 * @file
 * How far measured times can be trusted: intervals of ratios, and the noise of the machine.
 */
#ifndef GZ_BENCH_REPORT_TRUST_H
#define GZ_BENCH_REPORT_TRUST_H

#include <stddef.h>
#include <stdint.h>

/** An interval; NaN where nothing is known. */
struct gz_interval {
	double low, high;
};

/** Share of the values that an interval of this header is to hold. */
#define GZ_CONFIDENCE 0.95

/** Share of standard's times that its noise leaves within. */
#define GZ_NOISE_SHARE 0.9

/**
 * Interval of the ratio of two sums, sum of @p over / sum of @p under, by the bootstrap over pairs:
 * pairs are drawn with replacement, as many as there are, 2000 times, and the interval holds the
 * middle GZ_CONFIDENCE of the ratios (percentile interval: Efron and Tibshirani, *An Introduction
 * to the Bootstrap*, 1993, chapter 13). The draws have a fixed seed, so the same pairs give the
 * same interval. It takes pairs for independent of each other.
 *
 * @param over, under  above 0, in pairs
 * @return NaN for fewer than two pairs, or if memory runs out
 */
struct gz_interval gz_ratio_interval(const double *over, const double *under, size_t count);

/** A time, and what it was measured of: times of one kind ought to be equal. */
struct gz_kind_time {
	uint32_t kind;
	double ms;
};

/**
 * Noise of times that ought to be equal: each over the median of its kind; half the width of what
 * holds the middle GZ_NOISE_SHARE of these. 0.03 stands for plus or minus 3 %. Kinds with a single
 * time say nothing.
 *
 * @param[in,out] times  sorted by kind and time when it returns
 * @return NaN if no kind has two times, or if memory runs out
 */
double gz_noise_of(struct gz_kind_time *times, size_t count);

#endif
