/**
 * @file
 * How much the gaze trembles in fixations, by the measures of the literature, and what a filter
 * costs: its lag when the eye leaves, and in a pursuit.
 *
 * The two measures of precision are RMS-S2S, the root mean square of the angles from sample to
 * sample, and STD, the standard deviation of the places: Holmqvist, Nyström and Mulvey, "Eye
 * tracker data quality: what it is and how to measure it", ETRA 2012. STD is taken here about a
 * straight line in each window, fitted by least squares, so that slow drift, which is movement of
 * the eye, does not count.
 *
 * A fixation is cut into windows of about GZ_PRECISION_WINDOW_MS. A measure is given twice: over
 * all windows together, where a few with a microsaccade or the end of a saccade weigh most, and as
 * the median of the windows, which is what ETDQualitizer takes (Niehorster et al.,
 * precision_using_moving_window).
 */
#ifndef GZ_BENCH_FILTER_PRECISION_H
#define GZ_BENCH_FILTER_PRECISION_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/filter/track.h"

/** Length of a window, ms; as in the literature. */
#define GZ_PRECISION_WINDOW_MS 200

/** What the inner part of a fixation leaves out, ms: where the eye may ring after the saccade
 *  before it, and where the next one may have begun. */
#define GZ_PRECISION_LANDING_MS 40
#define GZ_PRECISION_LEAVING_MS 20

/** Which samples of a fixation count. */
enum gz_precision_part { GZ_PRECISION_WHOLE, GZ_PRECISION_INNER, GZ_PRECISION_PARTS };

/** Precision of a signal, degrees; NaN without a window. */
struct gz_precision {
	size_t windows;
	double step_deg;          /**< RMS-S2S over all windows */
	double spread_deg;        /**< STD about lines over all windows */
	double step_median_deg;   /**< RMS-S2S, the median of the windows */
	double spread_median_deg; /**< STD about lines, the median of the windows */
};

/**
 * Measure fixations by @p label.
 *
 * @param raw  of the raw signal, else of @p point
 * @param[out] out  written on success
 * @return false without memory
 */
bool gz_precision_of(const struct gz_gaze_track *tracks, size_t count, bool raw,
		     enum gz_precision_part part, struct gz_precision *out);

/** Lags behind the raw signal, in samples of a track; NaN without a saccade or pursuit. */
struct gz_lags {
	size_t saccades;
	double onset_median;  /**< of saccades, see gz_lags_of() */
	double onset_mean;    /**< of saccades, at most GZ_LAG_MOST_MS each */
	double onset_90;      /**< 90 % of saccades have no more */
	double overshoot_deg; /**< how far the point goes beyond the raw signal's farthest place
				 along a saccade, the most of all saccades from
				 half of the way on, degrees */
	double pursuit_ms;    /**< in pursuits by label, ms */
};

/**
 * Measure the lags of @p point. The lag at the onset of a saccade is how much later than the raw
 * signal @p point has done a fifth of its way, between samples too; of saccades above
 * GZ_LAG_LEAST_DEG without a lost sample. The lag in pursuits is the delay with which the raw
 * signal's speed explains the distance between both best, by least squares.
 *
 * @param[out] out  written on success
 * @return false without memory
 */
bool gz_lags_of(const struct gz_gaze_track *tracks, size_t count, struct gz_lags *out);

#endif
