/**
 * @file
 * The measures of error that a study holds, and how they are averaged: as a cost that is 0 for
 * equal pictures and grows, never as decibels or as similarity.
 */
#ifndef GZ_BENCH_REPORT_MEASURES_H
#define GZ_BENCH_REPORT_MEASURES_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/study/study.h"

/** In the order in which a report shows them: nearest to what a person sees first. */
enum gz_error_measure {
	GZ_PERCEIVED_FLIP,
	GZ_FOVEAL_FLIP,
	GZ_WHOLE_FLIP,
	GZ_PERCEIVED_SSIM,
	GZ_FOVEAL_SSIM,
	GZ_WHOLE_SSIM,
	GZ_PERCEIVED_PSNR,
	GZ_FOVEAL_PSNR,
	GZ_WHOLE_PSNR,
	GZ_ERROR_MEASURES,
};

/** References of errors. */
enum gz_error_reference {
	GZ_AGAINST_CONVERGED,
	GZ_AGAINST_STANDARD,
	GZ_ERROR_REFERENCES,
};

/** How a cost is computed. */
enum gz_error_kind {
	GZ_ERROR_FLIP, /**< cost = FLIP */
	GZ_ERROR_SSIM, /**< cost = 1 - SSIM */
	GZ_ERROR_PSNR, /**< cost = mean squared error of a signal of 1, 10^(-dB / 10) */
};

/** One measure. */
struct gz_error_metric {
	const char *key;   /**< "perceived_flip": column of frames.csv, value of --metric */
	const char *title; /**< "perceived FLIP" */
	enum gz_error_kind kind;
	size_t offset; /**< in struct gz_study_errors */
};

extern const struct gz_error_metric gz_error_metrics[GZ_ERROR_MEASURES];

/** Keys of gz_error_metrics, NULL behind the last: choices of an option. */
extern const char *const gz_error_metric_keys[GZ_ERROR_MEASURES + 1];

/** "converged", "standard", NULL: choices of an option. */
extern const char *const gz_error_reference_names[GZ_ERROR_REFERENCES + 1];

/** Its value in @p errors, in its own unit; NaN where it was not measured. */
double gz_error_value(enum gz_error_measure measure, const struct gz_study_errors *errors);

/** Cost of a value: 0 for equal pictures. NaN stays NaN. */
double gz_error_cost(enum gz_error_kind kind, double value);

/** The value that has this cost: infinite dB for none. */
double gz_error_of_cost(enum gz_error_kind kind, double cost);

/** Whether greater values mean a smaller error. */
bool gz_error_rises(enum gz_error_kind kind);

/** Statistics of the values that are not NaN; without any, every field but count is NaN. */
struct gz_distribution {
	size_t count;
	double mean;
	double variance; /**< of the values as a whole population: divided by their number */
	double least, p25, median, p75, p90, p95, p99, greatest;
	double sum;
	/** Time-weighted mean, sum of squares over sum: of frame times, the one on screen at a
	 *  moment picked at random, since long frames stay longer. */
	double perceived;
};

/**
 * The quantile @p share of sorted values, linear between the two nearest (type 7 of Hyndman and
 * Fan 1996, the default of numpy and R).
 *
 * @param share  0 to 1
 * @return NaN for none
 */
double gz_quantile(const double *sorted, size_t count, double share);

/** Sort @p values in place, NaN left out, and sum them up. */
struct gz_distribution gz_distribution_of(double *values, size_t count);

#endif
