/**
 * @file
 * A study summed up: for each scene, size and backend (a group) each variant (a series), its times,
 * its gain over standard, its errors. Pure computation from rows.
 *
 * There are two kinds of time. Distributions count every frame. Methods are compared by their
 * typical time: the median of a point's frames, averaged over points, which single disturbed frames
 * do not change.
 */
#ifndef GZ_BENCH_REPORT_SUMMARY_H
#define GZ_BENCH_REPORT_SUMMARY_H

#include "base/result.h"
#include "bench/report/jod_table.h"
#include "bench/report/measures.h"
#include "bench/report/trust.h"
#include "bench/study/columns.h"
#include "bench/study/study.h"

/** Stands for "no such series". */
#define GZ_SERIES_NONE SIZE_MAX

/** An error over all points that were measured, in the metric's own unit. */
struct gz_error_summary {
	size_t count; /**< points; 0 and all below are NaN */
	double mean;  /**< of the cost, given as value */
	double p95;   /**< 95 of 100 points are no worse */
	double worst; /**< no point is worse */
};

/** One variant at one point. */
struct gz_series_point {
	uint32_t point;
	struct gz_point gaze;
	double frame_ms; /**< median over its frames */
	double cast_ms;  /**< likewise */
	double rays, samples;
	struct gz_study_errors errors[GZ_ERROR_REFERENCES];
	double flicker, turning_error, camera_path_error;
};

/** One variant of one group. */
struct gz_series {
	size_t variant; /**< place in the study's list */
	size_t row_count;
	struct gz_series_point *points;
	size_t point_count;
	/** Over all frames, of the columns that GZ_JOIN_FRAMES joins; the others are zero. */
	struct gz_distribution columns[GZ_STUDY_COLUMNS];
	/** What a frame takes besides casting: plan, reconstruction, hand-over. */
	struct gz_distribution overhead_ms;
	double typical_ms; /**< mean over points of their median frame times */
	/** Standard's time over this one's, by medians of points that both have; NaN where standard
	 *  was not measured. Of the means; the mean of each point's; the least of them. */
	double ratio_of_means, mean_ratio, least_ratio;
	/** Of the ratio of the means, from the points that both have. */
	struct gz_interval ratio_interval;
	double rays, samples; /**< mean of a frame */
	/** Rays over the acuity bound's rays at the same points; NaN without a bound. */
	double bound_share;
	/** How much of a frame's time nobody could save: a copy of the picture and the bound's rays
	 *  at the cost of standard's rays, over typical_ms. NaN without one of them. */
	double efficiency;
	struct gz_error_summary errors[GZ_ERROR_REFERENCES][GZ_ERROR_MEASURES];
	struct gz_distribution flicker, turning_error, camera_path_error; /**< over points */
	/** On the Pareto front: no other series is better in both time and mean error and none
	 *  is as good in one and better in the other. */
	bool front[GZ_ERROR_REFERENCES][GZ_ERROR_MEASURES];
};

/** The variants of one method, finest first: of more samples a frame, which, unlike time, are the
 *  same in every run. */
struct gz_curve {
	const char *method; /**< belongs to the study */
	size_t *series;     /**< places in the group's list */
	size_t count;
};

/** One scene with one transfer function, at one size, by one backend. */
struct gz_group {
	size_t scene, size, backend; /**< places in the study's lists */
	struct gz_series *series;    /**< variants with rows, in the study's order */
	size_t series_count;
	size_t standard; /**< place of standard, or GZ_SERIES_NONE */
	/** Noise of the machine (gz_noise_of()): standard's times of points with one camera, which
	 *  ought to be equal, because standard ignores the gaze. If each point has a camera of its
	 *  own, of the frames of a point. NaN where it is not known. */
	double noise;
	bool noise_of_frames;
	struct gz_curve *curves;
	size_t curve_count;
	double bound_share; /**< mean over measured points: of the pixels' rays; NaN without */
	/** Time of the bound's rays at the cost of standard's rays. */
	double bound_ms;
	/** PSNR of the converged picture against one of half its step, at the worst point: how far
	 *  errors against it can be trusted; NaN where it was not measured. */
	double reference_db;
};

/** Time against something that grows, t = a x^exponent, by least squares in logarithms. */
enum gz_scaling_kind { GZ_SCALING_PIXELS, GZ_SCALING_VOXELS, GZ_SCALING_THREADS };

/** One step of growth. */
struct gz_scaling_point {
	double x, ms;
};

/** How one variant's time grows. */
struct gz_scaling {
	enum gz_scaling_kind kind;
	size_t variant;
	size_t scene, size; /**< what stays the same: pixels: scene; voxels: size; threads: both */
	size_t backend;     /**< for threads, the first of them */
	double exponent, factor;         /**< t = factor * x^exponent, ms */
	double r2;                       /**< share of the logarithms' variance that it explains */
	struct gz_scaling_point *points; /**< by x */
	size_t point_count;
};

/** A study summed up. Points into the study, which must outlive it. */
struct gz_summary {
	const struct gz_study *study;
	struct gz_group *groups; /**< groups with rows */
	size_t group_count;
	struct gz_scaling *scalings;
	size_t scaling_count;
	const struct gz_jod_table *jods; /**< entered values; borrowed; NULL: none */
};

/**
 * Sum up a study.
 *
 * @param[out] out_summary  the caller frees it with gz_summary_free()
 * @retval GZ_ERR_END     it has no rows
 * @retval GZ_ERR_INVAL   a row points outside the study's lists, or rows are not sorted
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_summary_make(const struct gz_study *study, struct gz_summary *out_summary);

/** The entered JOD of a series; NULL if nobody has entered one. */
const struct gz_jod_value *gz_summary_jod(const struct gz_summary *summary,
					  const struct gz_group *group, size_t series);

/** Free what it holds and zero it. */
void gz_summary_free(struct gz_summary *summary);

/**
 * Of the other series whose error is within @p cost at every point: the nearest in time to
 * @p series, if their times are apart by less than the group's noise. Which of both is faster is
 * then not known.
 *
 * @return its place, or GZ_SERIES_NONE
 */
size_t gz_group_rival(const struct gz_group *group, size_t series,
		      enum gz_error_reference reference, enum gz_error_measure measure,
		      double cost);

/** The references that any series of @p group was compared with: converged if it was, else
 *  standard. */
enum gz_error_reference gz_group_reference(const struct gz_group *group);

/**
 * The least time at which a curve's mean error is no more than @p cost: linear in time and cost
 * between neighbours on the curve.
 *
 * @param[out] out_series  the one that already is, or the finer neighbour of the place
 * @return NaN where it is not reached
 */
double gz_curve_time_at_cost(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double cost, size_t *out_series);

/**
 * The least mean cost of a curve within @p limit_ms, by the same interpolation.
 *
 * @return NaN where even its cheapest takes longer, or has no such error
 */
double gz_curve_cost_at_time(const struct gz_group *group, const struct gz_curve *curve,
			     enum gz_error_reference reference, enum gz_error_measure measure,
			     double limit_ms, size_t *out_series);

/**
 * The cheapest series whose error is within @p cost at every point that was measured.
 *
 * @return its place, or GZ_SERIES_NONE
 */
size_t gz_group_cheapest_within(const struct gz_group *group, enum gz_error_reference reference,
				enum gz_error_measure measure, double cost);

/**
 * Fit t = factor * x^exponent by least squares in logarithms.
 *
 * @param points  at least two different x, all above 0
 * @return false if there are fewer; then nothing is written
 */
bool gz_scaling_fit(const struct gz_scaling_point *points, size_t count, double *out_exponent,
		    double *out_factor, double *out_r2);

#endif
