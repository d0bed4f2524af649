/**
 * @file
 * QUEST, a staircase that places each trial at the most probable threshold. Watson and Pelli,
 * "QUEST: A Bayesian adaptive psychometric method", Perception & Psychophysics 33(2), 113-120,
 * 1983. A pure function of its parameters and of the answers in their order.
 *
 * The share of right answers at a value is a Weibull function of its logarithm x:
 *
 *     P(x) = delta gamma + (1 - delta) (1 - (1 - gamma) exp(-10^(beta (x - T + epsilon))))
 *
 * T is the threshold, where P is the target: epsilon is chosen so. The prior of T is a normal
 * distribution. Trials are placed at the mode of the posterior, as in the paper. Estimates are its
 * mean, which varies less (King-Smith, Grigsby, Vingrys, Benes and Supowit, "Efficient and unbiased
 * modifications of the QUEST threshold method", Vision Research 34(7), 885-912, 1994), and its
 * central 95 %.
 */
#ifndef GZ_VIEW_EXPERIMENT_QUEST_H
#define GZ_VIEW_EXPERIMENT_QUEST_H

#include <stdbool.h>

#include "base/result.h"

/** Thresholds of the posterior, evenly spaced by their logarithm. Chosen: over two decades, 0.005
 *  of a decade apart, far less than any estimate's error. */
#define GZ_QUEST_POINTS 401

/** What a staircase assumes. */
struct gz_quest_params {
	double from, to; /**< values shown and thresholds considered; above 0, from < to */
	bool falling;    /**< smaller values are answered right more often */
	double start;    /**< guessed threshold, from..to */
	double sd;       /**< of that guess, decades, above 0 */
	double beta;     /**< slope of the Weibull function, above 0 */
	double delta;    /**< share of answers that are blind guesses, 0 to below 1 */
	double gamma;    /**< share of right answers by guessing, 0 to below 1 */
	double target;   /**< share of right answers at the threshold: more than guessing gives, and
			    less than delta leaves */
};

/** A staircase. Copied freely; holds no pointers. */
struct gz_quest {
	struct gz_quest_params params;
	double epsilon;
	int trials;                          /**< answers so far */
	double log_density[GZ_QUEST_POINTS]; /**< of the posterior, but for a constant */
};

/** What is known of the threshold. */
struct gz_quest_estimate {
	double threshold; /**< mean of the posterior */
	double low, high; /**< its central 95 % */
	double sd;        /**< of the posterior, decades */
};

/** Whether the parameters are in their ranges. */
bool gz_quest_params_valid(const struct gz_quest_params *params);

/** Start. @retval GZ_ERR_INVAL  gz_quest_params_valid() is false */
enum gz_result gz_quest_begin(struct gz_quest *quest, const struct gz_quest_params *params);

/** The value to show next. */
double gz_quest_next(const struct gz_quest *quest);

/** Take the answer to a value, which may be another than gz_quest_next() gave; above 0. */
void gz_quest_take(struct gz_quest *quest, double value, bool right);

/** The present estimate. */
struct gz_quest_estimate gz_quest_estimate(const struct gz_quest *quest);

/** Share of right answers to a value, were the threshold @p threshold. */
double gz_quest_share(const struct gz_quest_params *params, double threshold, double value);

#endif
