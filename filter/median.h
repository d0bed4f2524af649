/**
 * @file
 * The running median of positive numbers, without storing them.
 */
#ifndef GZ_FILTER_MEDIAN_H
#define GZ_FILTER_MEDIAN_H

#include <math.h>

/** A running median. Zero-initialised is the start state. */
struct gz_median {
	double value; /**< the median so far; 0 before the first number */
	double count; /**< how many numbers so far */
};

/**
 * Take a number into the median. The median rises by a fraction of itself if the number is above it
 * and falls if it is below, so that as many numbers are above as below; a single large number has
 * no more weight than any other. This is the stochastic approximation of Robbins and Monro, Annals
 * of Mathematical Statistics 22, 1951, on a logarithmic scale, with large steps at first.
 *
 * @param number  ignored if it is 0, negative or NaN
 * @param gain    the fraction in the long run: the time between numbers over the time constant
 */
static inline void gz_median_follow(struct gz_median *median, double number, double gain)
{
	if (!(number > 0))
		return;
	median->count++;
	double step = fmin(0.5, fmax(gain, 2 / median->count));
	if (median->count < 2)
		median->value = number;
	else
		median->value = number > median->value ? median->value * (1 + step)
						       : median->value / (1 + step);
}

#endif
