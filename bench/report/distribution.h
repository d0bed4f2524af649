/**
 * @file
 * What many measured values come to: moments, quantiles, and the mean that a viewer sees.
 */
#ifndef GZ_BENCH_REPORT_DISTRIBUTION_H
#define GZ_BENCH_REPORT_DISTRIBUTION_H

#include <stddef.h>

/** Of values that are numbers; every field but count is NaN where there are none. */
struct gz_distribution {
	size_t count;
	double mean;
	double variance; /**< of the values as a whole population: divided by their number */
	double least, p25, median, p75, p90, p95, p99, greatest;
	double sum;
	/** Time-weighted mean, sum of squares over sum: of frame times, what is on screen at a
	 *  moment picked at random, since long frames stay longer. */
	double perceived;
};

/**
 * The quantile @p share of sorted values, linear between the two nearest (type 7 of Hyndman and
 * Fan 1996, what numpy and R do unless told otherwise).
 *
 * @param share  0 to 1
 * @return NaN for none
 */
double gz_quantile(const double *sorted, size_t count, double share);

/** Sort @p values in place, NaN left out, and sum them up. */
struct gz_distribution gz_distribution_of(double *values, size_t count);

#endif
