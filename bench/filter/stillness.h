/**
 * @file
 * How still a filter holds the gaze while the eye rests, and how late it is when the eye moves.
 *
 * Jitter is the step-to-step RMS within fixations, of the raw signal's. Distance is that from the
 * fixation's centre, RMS, of the raw signal's. Lag is how much later than the raw signal a filtered
 * one has done 20, 50 and 80 % of a saccade's way, along its direction, from the sample before the
 * saccade to its last one: the mean over these and over all saccades of more than GZ_LAG_LEAST_DEG,
 * chosen because smaller ones drown in noise. A saccade with a sample that was not measured does
 * not count.
 */
#ifndef GZ_BENCH_FILTER_STILLNESS_H
#define GZ_BENCH_FILTER_STILLNESS_H

#include <stddef.h>

#include "bench/filter/track.h"

/** Least way of a saccade whose lag is measured, degrees. */
#define GZ_LAG_LEAST_DEG 2

/** How long after a saccade a filter may arrive, ms: one that is later counts as this late. Chosen:
 *  most fixations are over by then. */
#define GZ_LAG_MOST_MS 200

/** What a filter reaches. */
struct gz_stillness {
	size_t fixations; /**< that jitter and distance are of */
	size_t saccades;  /**< that lag is of */
	double jitter;    /**< NaN without a step within a fixation */
	double distance;  /**< NaN without a fixation */
	double lag_ms;    /**< NaN without a saccade */
};

/** Measure @p point of all tracks against @p raw, where @p label says what the eye does. */
struct gz_stillness gz_stillness_of(const struct gz_gaze_track *tracks, size_t count);

#endif
