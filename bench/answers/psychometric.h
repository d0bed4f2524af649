/**
 * @file
 * Shares of right answers and the psychometric function through them. Pure functions.
 */
#ifndef GZ_BENCH_ANSWERS_PSYCHOMETRIC_H
#define GZ_BENCH_ANSWERS_PSYCHOMETRIC_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

/** Answers to one value. */
struct gz_value_count {
	double value; /**< above 0 */
	int trials, right;
};

/** Ends of a range, 95 %. */
struct gz_interval {
	double low, high; /**< NaN: the answers do not bound it */
};

/** What the fit assumes; as in view/experiment/quest.h. */
struct gz_psychometric_params {
	double gamma;  /**< share of right answers by guessing, 0 to below 1 */
	double delta;  /**< share of blind guesses, 0 to below 1 */
	double target; /**< share of right answers at the threshold */
};

/** A fitted function. */
struct gz_psychometric {
	double threshold;
	struct gz_interval interval; /**< of the threshold */
	double beta;                 /**< slope over the logarithm of the value */
	bool falling;                /**< smaller values are answered right more often */
};

/** Range of a share: the score interval (Wilson, "Probable inference, the law of succession, and
 * statistical inference", Journal of the American Statistical Association 22, 209-212, 1927).
 * NaN without trials. */
struct gz_interval gz_share_interval(int right, int trials);

/**
 * Fit a Weibull function by maximum likelihood, with gamma and delta given (Wichmann and Hill, "The
 * psychometric function: I. Fitting, sampling, and goodness of fit", Perception & Psychophysics
 * 63(8), 1293-1313, 2001). The greatest likelihood is looked for on a grid of threshold (to a
 * decade beyond the values, 400 steps) and slope (0.5 to 20);
 * the threshold's interval holds those whose likelihood, over all slopes, is within that of the
 * 95 % point of chi-squared with one degree of freedom.
 *
 * @retval GZ_ERR_INVAL  less than two values, a value not above 0, or parameters out of range
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_psychometric_fit(const struct gz_value_count *counts, size_t count,
				   const struct gz_psychometric_params *params,
				   struct gz_psychometric *out_fit);

/** Share of right answers at a value. */
double gz_psychometric_share(const struct gz_psychometric *fit,
			     const struct gz_psychometric_params *params, double value);

#endif
