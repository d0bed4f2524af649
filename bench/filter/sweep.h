/**
 * @file
 * Jitter over lag: filters swept over the one setting that trades the one for the other.
 */
#ifndef GZ_BENCH_FILTER_SWEEP_H
#define GZ_BENCH_FILTER_SWEEP_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/filter/stillness.h"
#include "bench/filter/track.h"

#define GZ_SWEEP_MAX 40 /**< most points of a curve */

/** A point of a curve. */
struct gz_sweep_point {
	double setting;
	bool as_given; /**< of a pipeline: pass_deg as its settings have it */
	struct gz_stillness stillness;
};

/** A curve, by its setting. */
struct gz_sweep {
	struct gz_sweep_point point[GZ_SWEEP_MAX];
	size_t count;
};

/** The pipeline, by smooth.pass_deg: from where on a saccade passes unsmoothed, degrees. Its own
 *  value in @p params is among them, and is marked. */
struct gz_sweep gz_sweep_pipeline(struct gz_gaze_track *tracks, size_t count,
				  const struct gz_pipeline_params *params);

/** The 1 euro filter, by beta: from a cutoff that hardly rises to one that lets everything pass. */
struct gz_sweep gz_sweep_one_euro(struct gz_gaze_track *tracks, size_t count);

/** Least jitter that a curve gives for a lag, by straight lines between its points; infinite where
 *  it gives none. Points without jitter or lag do not count. */
double gz_sweep_jitter_at(const struct gz_sweep *sweep, double lag_ms);

/**
 * The least lag from @p first_ms to @p last_ms, in steps of @p step_ms, at which @p ours does not
 * have less jitter than @p theirs. NaN where it has less at each.
 */
double gz_sweep_first_not_below(const struct gz_sweep *ours, const struct gz_sweep *theirs,
				double first_ms, double last_ms, double step_ms);

#endif
