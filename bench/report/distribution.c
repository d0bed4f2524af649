#include "bench/report/distribution.h"

#include <math.h>
#include <stdlib.h>

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double gz_quantile(const double *sorted, size_t count, double share)
{
	if (count == 0)
		return NAN;
	const double place = share * (double)(count - 1);
	const size_t below = (size_t)place;
	const double fraction = place - (double)below;
	/* Nothing is added where nothing is wanted of the next, which may be infinite. */
	if (fraction == 0 || below + 1 >= count)
		return sorted[below];
	return sorted[below] + fraction * (sorted[below + 1] - sorted[below]);
}

static size_t keep_numbers(double *values, size_t count)
{
	size_t kept = 0;
	for (size_t i = 0; i < count; i++)
		if (!isnan(values[i]))
			values[kept++] = values[i];
	return kept;
}

struct gz_distribution gz_distribution_of(double *values, size_t count)
{
	count = keep_numbers(values, count);
	struct gz_distribution all = {
		count, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN,
	};
	if (count == 0)
		return all;
	qsort(values, count, sizeof values[0], compare);
	double sum = 0, squares = 0, deviations = 0;
	for (size_t i = 0; i < count; i++) {
		sum += values[i];
		squares += values[i] * values[i];
	}
	all.sum = sum;
	all.mean = sum / (double)count;
	for (size_t i = 0; i < count; i++)
		deviations += (values[i] - all.mean) * (values[i] - all.mean);
	all.variance = deviations / (double)count;
	all.least = values[0];
	all.p25 = gz_quantile(values, count, 0.25);
	all.median = gz_quantile(values, count, 0.5);
	all.p75 = gz_quantile(values, count, 0.75);
	all.p90 = gz_quantile(values, count, 0.9);
	all.p95 = gz_quantile(values, count, 0.95);
	all.p99 = gz_quantile(values, count, 0.99);
	all.greatest = values[count - 1];
	all.perceived = sum > 0 ? squares / sum : all.mean;
	return all;
}
