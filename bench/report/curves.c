/* What a group's series say together: fronts, curves, equal error, equal time, the cheapest. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/report/summary_parts.h"

/* Mean cost of a series; NaN where it was not measured. */
static double mean_cost(const struct gz_series *series, enum gz_error_reference reference,
			enum gz_error_measure measure)
{
	return gz_error_cost(gz_error_metrics[measure].kind,
			     series->errors[reference][measure].mean);
}

static bool on_front(const struct gz_group *group, size_t place, enum gz_error_reference reference,
		     enum gz_error_measure measure)
{
	const double ms = group->series[place].typical_ms;
	const double cost = mean_cost(&group->series[place], reference, measure);
	if (isnan(cost))
		return false;
	for (size_t i = 0; i < group->series_count; i++) {
		const double other_ms = group->series[i].typical_ms;
		const double other = mean_cost(&group->series[i], reference, measure);
		if (other_ms <= ms && other <= cost && (other_ms < ms || other < cost))
			return false;
	}
	return true;
}

void gz_group_find_fronts(struct gz_group *group)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++)
			for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
				group->series[i].front[reference][measure] =
					on_front(group, i, reference, measure);
}

static struct gz_curve *curve_of(struct gz_group *group, const char *method)
{
	for (size_t i = 0; i < group->curve_count; i++)
		if (group->curves[i].method && strcmp(group->curves[i].method, method) == 0)
			return &group->curves[i];
	return NULL;
}

/* Insert a series into a curve behind those that take more samples. */
static void insert(const struct gz_group *group, struct gz_curve *curve, size_t place)
{
	size_t at = curve->count++;
	for (; at > 0; at--) {
		if (group->series[curve->series[at - 1]].samples >= group->series[place].samples)
			break;
		curve->series[at] = curve->series[at - 1];
	}
	curve->series[at] = place;
}

enum gz_result gz_group_find_curves(const struct gz_study *study, struct gz_group *group)
{
	group->curves = calloc(group->series_count, sizeof group->curves[0]);
	if (!group->curves)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < group->series_count; i++) {
		const char *method = study->variants[group->series[i].variant].method;
		struct gz_curve *curve = curve_of(group, method);
		if (!curve) {
			size_t *room = calloc(group->series_count, sizeof room[0]);
			if (!room)
				return GZ_ERR_NO_MEM;
			curve = &group->curves[group->curve_count++];
			*curve = (struct gz_curve) { .method = method, .series = room };
		}
		insert(group, curve, i);
	}
	return GZ_OK;
}

enum gz_error_reference gz_group_reference(const struct gz_group *group)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
			if (group->series[i].errors[GZ_AGAINST_CONVERGED][measure].count > 0)
				return GZ_AGAINST_CONVERGED;
	return GZ_AGAINST_STANDARD;
}

/* A place on a curve, and the best one so far. */
struct place {
	double limited, wanted; /* what must be within a limit, what is to be least */
	size_t series;
};

static void take(struct place *best, double wanted, size_t series)
{
	if (isnan(best->wanted) || wanted < best->wanted) {
		best->wanted = wanted;
		best->series = series;
	}
}

/* The least "wanted" where "limited" is at most @p limit, along the line through @p places. */
static struct place least_within(const struct place *places, size_t count, double limit)
{
	struct place best = { NAN, NAN, GZ_SERIES_NONE };
	for (size_t i = 0; i < count; i++) {
		const struct place *here = &places[i], *next = here + 1;
		if (here->limited <= limit)
			take(&best, here->wanted, here->series);
		if (i + 1 == count || (here->limited <= limit) == (next->limited <= limit))
			continue;
		const double share = (limit - here->limited) / (next->limited - here->limited);
		take(&best, here->wanted + share * (next->wanted - here->wanted), here->series);
	}
	return best;
}

static double along(const struct gz_group *group, const struct gz_curve *curve,
		    enum gz_error_reference reference, enum gz_error_measure measure, double limit,
		    bool cost_is_limited, size_t *out_series)
{
	struct place *places = calloc(curve->count, sizeof places[0]);
	if (!places)
		return NAN;
	size_t count = 0;
	for (size_t i = 0; i < curve->count; i++) {
		const struct gz_series *series = &group->series[curve->series[i]];
		const double cost = mean_cost(series, reference, measure);
		if (isnan(cost))
			continue;
		places[count++] = (struct place) { cost_is_limited ? cost : series->typical_ms,
						   cost_is_limited ? series->typical_ms : cost,
						   curve->series[i] };
	}
	const struct place best = least_within(places, count, limit);
	free(places);
	*out_series = best.series;
	return best.wanted;
}

double gz_curve_time_at_cost(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double cost, size_t *out_series)
{
	return along(group, curve, reference, measure, cost, true, out_series);
}

double gz_curve_cost_at_time(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double limit_ms, size_t *out_series)
{
	return along(group, curve, reference, measure, limit_ms, false, out_series);
}

size_t gz_group_cheapest_within(const struct gz_group *group, enum gz_error_reference reference,
				enum gz_error_measure measure, double cost)
{
	size_t best = GZ_SERIES_NONE;
	for (size_t i = 0; i < group->series_count; i++) {
		const struct gz_series *series = &group->series[i];
		const struct gz_error_summary *errors = &series->errors[reference][measure];
		/* A point without an error says nothing about it. */
		if (errors->count < series->point_count ||
		    !(gz_error_cost(gz_error_metrics[measure].kind, errors->worst) <= cost))
			continue;
		if (best == GZ_SERIES_NONE || series->typical_ms < group->series[best].typical_ms)
			best = i;
	}
	return best;
}
