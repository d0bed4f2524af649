#include "view/experiment/quest.h"

#include <math.h>

/* Ends of the central 95 % of a distribution. */
#define LOW_TAIL  0.025
#define HIGH_TAIL 0.975

/* Of all right answers, the share that is neither guessed blindly nor missed so: what is left of
 * the target for the Weibull function alone. */
static double weibull_target(const struct gz_quest_params *params)
{
	return (params->target - params->delta * params->gamma) / (1 - params->delta);
}

bool gz_quest_params_valid(const struct gz_quest_params *params)
{
	return params->from > 0 && params->to > params->from && isfinite(params->to) &&
	       params->start >= params->from && params->start <= params->to && params->sd > 0 &&
	       isfinite(params->sd) && params->beta > 0 && isfinite(params->beta) &&
	       params->delta >= 0 && params->delta < 1 && params->gamma >= 0 && params->gamma < 1 &&
	       weibull_target(params) > params->gamma && weibull_target(params) < 1;
}

/* Where P(T) is the target. */
static double epsilon_of(const struct gz_quest_params *params)
{
	const double missed = (1 - weibull_target(params)) / (1 - params->gamma);
	return log10(-log(missed)) / params->beta;
}

/* The logarithm of a value, so that greater is answered right more often. */
static double strength_of(const struct gz_quest_params *params, double value)
{
	return params->falling ? -log10(value) : log10(value);
}

static double value_of(const struct gz_quest_params *params, double strength)
{
	return pow(10, params->falling ? -strength : strength);
}

/* A point of the posterior, by its strength; fractions lie between points. */
static double strength_at(const struct gz_quest_params *params, double point)
{
	const double least = strength_of(params, params->falling ? params->to : params->from);
	const double span = log10(params->to / params->from);
	return least + span * point / (GZ_QUEST_POINTS - 1);
}

static double right_share(const struct gz_quest_params *params, double above)
{
	const double seen = 1 - (1 - params->gamma) * exp(-pow(10, params->beta * above));
	return params->delta * params->gamma + (1 - params->delta) * seen;
}

double gz_quest_share(const struct gz_quest_params *params, double threshold, double value)
{
	return right_share(params, strength_of(params, value) - strength_of(params, threshold) +
					   epsilon_of(params));
}

enum gz_result gz_quest_begin(struct gz_quest *quest, const struct gz_quest_params *params)
{
	if (!gz_quest_params_valid(params))
		return GZ_ERR_INVAL;
	*quest = (struct gz_quest) { .params = *params, .epsilon = epsilon_of(params) };
	for (int i = 0; i < GZ_QUEST_POINTS; i++) {
		const double off =
			(strength_at(params, i) - strength_of(params, params->start)) / params->sd;
		quest->log_density[i] = -off * off / 2;
	}
	return GZ_OK;
}

static int mode_of(const struct gz_quest *quest)
{
	int best = 0;
	for (int i = 1; i < GZ_QUEST_POINTS; i++)
		if (quest->log_density[i] > quest->log_density[best])
			best = i;
	return best;
}

double gz_quest_next(const struct gz_quest *quest)
{
	return value_of(&quest->params, strength_at(&quest->params, mode_of(quest)));
}

/* The logarithm of a share, which rounding may have made 0. */
static double log_share(double share)
{
	return log(fmax(share, 1e-300));
}

void gz_quest_take(struct gz_quest *quest, double value, bool right)
{
	const double strength = strength_of(&quest->params, value);
	for (int i = 0; i < GZ_QUEST_POINTS; i++) {
		const double above = strength - strength_at(&quest->params, i) + quest->epsilon;
		const double share = right_share(&quest->params, above);
		quest->log_density[i] += log_share(right ? share : 1 - share);
	}
	quest->trials++;
}

/* The point below which @p share of the posterior lies, each point's part lying around it. */
static double quantile_of(const double *density, double total, double share)
{
	double below = 0;
	for (int i = 0; i < GZ_QUEST_POINTS; i++) {
		if (below + density[i] >= share * total)
			return i - 0.5 + (share * total - below) / density[i];
		below += density[i];
	}
	return GZ_QUEST_POINTS - 1;
}

struct gz_quest_estimate gz_quest_estimate(const struct gz_quest *quest)
{
	const struct gz_quest_params *params = &quest->params;
	const double most = quest->log_density[mode_of(quest)];
	double density[GZ_QUEST_POINTS], total = 0, mean = 0, square = 0;
	for (int i = 0; i < GZ_QUEST_POINTS; i++) {
		density[i] = exp(quest->log_density[i] - most);
		total += density[i];
		mean += density[i] * strength_at(params, i);
	}
	mean /= total;
	for (int i = 0; i < GZ_QUEST_POINTS; i++)
		square += density[i] * pow(strength_at(params, i) - mean, 2);
	const double low = fmax(0, quantile_of(density, total, LOW_TAIL));
	const double high = fmin(GZ_QUEST_POINTS - 1, quantile_of(density, total, HIGH_TAIL));
	const double ends[2] = { value_of(params, strength_at(params, low)),
				 value_of(params, strength_at(params, high)) };
	return (struct gz_quest_estimate) {
		.threshold = value_of(params, mean),
		.low = fmin(ends[0], ends[1]),
		.high = fmax(ends[0], ends[1]),
		.sd = sqrt(square / total),
	};
}
