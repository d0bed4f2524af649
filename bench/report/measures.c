#include "bench/report/measures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"

#define AT(field) offsetof(struct gz_study_errors, field)

const struct gz_error_metric gz_error_metrics[GZ_ERROR_MEASURES] = {
	[GZ_PERCEIVED_FLIP] = { "perceived_flip", "perceived FLIP", GZ_ERROR_FLIP,
				AT(perceived_flip) },
	[GZ_FOVEAL_FLIP] = { "foveal_flip", "foveal FLIP", GZ_ERROR_FLIP, AT(foveal_flip) },
	[GZ_WHOLE_FLIP] = { "flip", "FLIP", GZ_ERROR_FLIP, AT(flip) },
	[GZ_PERCEIVED_SSIM] = { "perceived_ssim", "perceived SSIM", GZ_ERROR_SSIM,
				AT(perceived_ssim) },
	[GZ_FOVEAL_SSIM] = { "foveal_ssim", "foveal SSIM", GZ_ERROR_SSIM, AT(foveal_ssim) },
	[GZ_WHOLE_SSIM] = { "ssim", "SSIM", GZ_ERROR_SSIM, AT(ssim) },
	[GZ_PERCEIVED_PSNR] = { "perceived_psnr_db", "perceived PSNR", GZ_ERROR_PSNR,
				AT(perceived_psnr_db) },
	[GZ_FOVEAL_PSNR] = { "foveal_psnr_db", "foveal PSNR", GZ_ERROR_PSNR, AT(foveal_psnr_db) },
	[GZ_WHOLE_PSNR] = { "psnr_db", "PSNR", GZ_ERROR_PSNR, AT(psnr_db) },
};

const char *const gz_error_metric_keys[GZ_ERROR_MEASURES + 1] = {
	[GZ_PERCEIVED_FLIP] = "perceived_flip",
	[GZ_FOVEAL_FLIP] = "foveal_flip",
	[GZ_WHOLE_FLIP] = "flip",
	[GZ_PERCEIVED_SSIM] = "perceived_ssim",
	[GZ_FOVEAL_SSIM] = "foveal_ssim",
	[GZ_WHOLE_SSIM] = "ssim",
	[GZ_PERCEIVED_PSNR] = "perceived_psnr_db",
	[GZ_FOVEAL_PSNR] = "foveal_psnr_db",
	[GZ_WHOLE_PSNR] = "psnr_db",
	[GZ_ERROR_MEASURES] = NULL,
};

const char *const gz_error_reference_names[GZ_ERROR_REFERENCES + 1] = {
	[GZ_AGAINST_CONVERGED] = "converged",
	[GZ_AGAINST_STANDARD] = "standard",
	[GZ_ERROR_REFERENCES] = NULL,
};

double gz_error_value(enum gz_error_measure measure, const struct gz_study_errors *errors)
{
	double value;
	memcpy(&value, (const char *)errors + gz_error_metrics[measure].offset, sizeof value);
	return value;
}

double gz_error_cost(enum gz_error_kind kind, double value)
{
	switch (kind) {
	case GZ_ERROR_FLIP:
		return value;
	case GZ_ERROR_SSIM:
		return 1 - value;
	case GZ_ERROR_PSNR:
		return pow(10, -value / 10);
	}
	return NAN;
}

double gz_error_of_cost(enum gz_error_kind kind, double cost)
{
	switch (kind) {
	case GZ_ERROR_FLIP:
		return cost;
	case GZ_ERROR_SSIM:
		return 1 - cost;
	case GZ_ERROR_PSNR:
		return cost > 0 ? -10 * log10(cost) : cost == 0 ? INFINITY : NAN;
	}
	return NAN;
}

bool gz_error_rises(enum gz_error_kind kind)
{
	return kind != GZ_ERROR_FLIP;
}

/* ---- distributions ---- */

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
	qsort(values, count, sizeof values[0], gz_compare_doubles);
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
