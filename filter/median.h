/**
 * @file
 * The median of a stream of positive numbers, followed without keeping them.
 */
#ifndef GZ_FILTER_MEDIAN_H
#define GZ_FILTER_MEDIAN_H

#include <math.h>

/** Zero-initialised is the start state: nothing known. */
struct gz_median {
	double value; /**< 0 while nothing is known */
	double count; /**< of numbers so far */
};

/**
 * Go up by a part of the value where @p number is above, down where it is below, so that as many
 * lie above as below; a single large number counts no more than any other. The stochastic
 * approximation of Robbins and Monro, Annals of Mathematical Statistics 22, 1951, on a log scale,
 * with large steps at first.
 *
 * @param number  0 or less is not counted
 * @param gain    the part, in the long run: time between numbers over the time constant
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
