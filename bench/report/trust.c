#include "bench/report/trust.h"

#include <math.h>
#include <stdlib.h>

#include "base/order.h"
#include "bench/report/measures.h"
#include "sim/random.h"

#define RESAMPLES 2000
#define SEED      95

static double resampled_ratio(const double *over, const double *under, size_t count,
			      struct gz_random *random)
{
	double sum_over = 0, sum_under = 0;
	for (size_t i = 0; i < count; i++) {
		const size_t drawn = (size_t)(gz_random_uniform(random) * (double)count);
		sum_over += over[drawn];
		sum_under += under[drawn];
	}
	return sum_over / sum_under;
}

struct gz_interval gz_ratio_interval(const double *over, const double *under, size_t count)
{
	struct gz_interval interval = { NAN, NAN };
	double *ratios = count < 2 ? NULL : calloc(RESAMPLES, sizeof ratios[0]);
	if (!ratios)
		return interval;
	struct gz_random random = gz_random_seeded(SEED, 0);
	for (size_t i = 0; i < RESAMPLES; i++)
		ratios[i] = resampled_ratio(over, under, count, &random);
	qsort(ratios, RESAMPLES, sizeof ratios[0], gz_compare_doubles);
	interval.low = gz_quantile(ratios, RESAMPLES, (1 - GZ_CONFIDENCE) / 2);
	interval.high = gz_quantile(ratios, RESAMPLES, (1 + GZ_CONFIDENCE) / 2);
	free(ratios);
	return interval;
}

static int compare_kind_times(const void *a, const void *b)
{
	const struct gz_kind_time *x = a, *y = b;
	if (x->kind != y->kind)
		return x->kind < y->kind ? -1 : 1;
	return (x->ms > y->ms) - (x->ms < y->ms);
}

double gz_noise_of(struct gz_kind_time *times, size_t count)
{
	double *shares = count > 0 ? calloc(count, sizeof shares[0]) : NULL;
	size_t found = 0;
	if (!shares)
		return NAN;
	qsort(times, count, sizeof times[0], compare_kind_times);
	for (size_t first = 0, end; first < count; first = end) {
		for (end = first + 1; end < count && times[end].kind == times[first].kind;)
			end++;
		const size_t middle = first + (end - first) / 2;
		const double median = (end - first) % 2 == 1
					      ? times[middle].ms
					      : (times[middle - 1].ms + times[middle].ms) / 2;
		for (size_t i = first; i < end && end - first > 1; i++)
			shares[found++] = times[i].ms / median;
	}
	qsort(shares, found, sizeof shares[0], gz_compare_doubles);
	const double noise = (gz_quantile(shares, found, (1 + GZ_NOISE_SHARE) / 2) -
			      gz_quantile(shares, found, (1 - GZ_NOISE_SHARE) / 2)) /
			     2;
	free(shares);
	return noise;
}
