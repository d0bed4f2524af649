#include "bench/answers/psychometric.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "view/experiment/quest.h"

/* The normal distribution's 97.5 % point, and half of chi-squared's 95 % point. */
#define NORMAL_95     1.959964
#define LIKELIHOOD_95 1.920729

/* The grid. Chosen: far finer than any interval of so few answers. */
enum { THRESHOLDS = 401, SLOPES = 49 };
#define SLOPE_LEAST 0.5
#define SLOPE_MOST  20.0

struct gz_interval gz_share_interval(int right, int trials)
{
	if (trials <= 0)
		return (struct gz_interval) { NAN, NAN };
	const double n = trials, share = right / n, z2 = NORMAL_95 * NORMAL_95;
	const double centre = (share + z2 / (2 * n)) / (1 + z2 / n);
	const double half =
		NORMAL_95 / (1 + z2 / n) * sqrt(share * (1 - share) / n + z2 / (4 * n * n));
	return (struct gz_interval) { fmax(0, centre - half), fmin(1, centre + half) };
}

/* The function with a threshold and a slope. */
static struct gz_quest_params quest_params_of(const struct gz_psychometric *fit,
					      const struct gz_psychometric_params *params)
{
	return (struct gz_quest_params) {
		.from = fit->threshold / 2,
		.to = fit->threshold * 2,
		.start = fit->threshold,
		.sd = 1,
		.falling = fit->falling,
		.beta = fit->beta,
		.delta = params->delta,
		.gamma = params->gamma,
		.target = params->target,
	};
}

double gz_psychometric_share(const struct gz_psychometric *fit,
			     const struct gz_psychometric_params *params, double value)
{
	const struct gz_quest_params quest = quest_params_of(fit, params);
	return gz_quest_share(&quest, fit->threshold, value);
}

static double log_likelihood(const struct gz_value_count *counts, size_t count,
			     const struct gz_psychometric_params *params,
			     const struct gz_psychometric *fit)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++) {
		const double share = gz_psychometric_share(fit, params, counts[i].value);
		sum += counts[i].right * log(fmax(share, 1e-300)) +
		       (counts[i].trials - counts[i].right) * log(fmax(1 - share, 1e-300));
	}
	return sum;
}

/* The grid of one direction, and its best point. */
struct grid {
	const struct gz_value_count *counts;
	size_t count;
	const struct gz_psychometric_params *params;
	double first, last;         /* log10 of thresholds */
	double profile[THRESHOLDS]; /* greatest likelihood over all slopes */
	struct gz_psychometric best;
	double greatest;
};

static double threshold_at(const struct grid *grid, int i)
{
	return pow(10, grid->first + (grid->last - grid->first) * i / (THRESHOLDS - 1));
}

static void search_grid(struct grid *grid, bool falling)
{
	grid->greatest = -HUGE_VAL;
	for (int i = 0; i < THRESHOLDS; i++) {
		grid->profile[i] = -HUGE_VAL;
		for (int k = 0; k < SLOPES; k++) {
			const struct gz_psychometric fit = {
				.threshold = threshold_at(grid, i),
				.falling = falling,
				.beta = SLOPE_LEAST *
					pow(SLOPE_MOST / SLOPE_LEAST, k / (SLOPES - 1.0)),
			};
			const double here =
				log_likelihood(grid->counts, grid->count, grid->params, &fit);
			grid->profile[i] = fmax(grid->profile[i], here);
			if (here <= grid->greatest)
				continue;
			grid->greatest = here;
			grid->best = fit;
		}
	}
}

/* An end that lies on the grid's is not bounded by the answers. */
static void find_interval(struct grid *grid)
{
	int low = 0, high = THRESHOLDS - 1;
	const double least = grid->greatest - LIKELIHOOD_95;
	while (grid->profile[low] < least)
		low++;
	while (grid->profile[high] < least)
		high--;
	grid->best.interval.low = low > 0 ? threshold_at(grid, low) : NAN;
	grid->best.interval.high = high < THRESHOLDS - 1 ? threshold_at(grid, high) : NAN;
}

static bool find_range(struct grid *grid)
{
	if (grid->count < 2)
		return false;
	double least = HUGE_VAL, most = DBL_MIN;
	for (size_t i = 0; i < grid->count; i++) {
		if (!(grid->counts[i].value > 0))
			return false;
		least = fmin(least, grid->counts[i].value);
		most = fmax(most, grid->counts[i].value);
	}
	grid->first = log10(least) - 1;
	grid->last = log10(most) + 1;
	return most > least;
}

enum gz_result gz_psychometric_fit(const struct gz_value_count *counts, size_t count,
				   const struct gz_psychometric_params *params,
				   struct gz_psychometric *out_fit)
{
	const struct gz_psychometric example = { .threshold = 1, .beta = 1 };
	const struct gz_quest_params quest = quest_params_of(&example, params);
	if (!gz_quest_params_valid(&quest))
		return GZ_ERR_INVAL;
	struct grid *grids = calloc(2, sizeof *grids);
	if (!grids)
		return GZ_ERR_NO_MEM;
	enum gz_result result = GZ_OK;
	for (int i = 0; i < 2 && result == GZ_OK; i++) {
		grids[i].counts = counts;
		grids[i].count = count;
		grids[i].params = params;
		result = find_range(&grids[i]) ? GZ_OK : GZ_ERR_INVAL;
		if (result == GZ_OK)
			search_grid(&grids[i], i == 1);
	}
	if (result == GZ_OK) {
		struct grid *best = &grids[grids[1].greatest > grids[0].greatest];
		find_interval(best);
		*out_fit = best->best;
	}
	free(grids);
	return result;
}
