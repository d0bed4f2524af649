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
 *
 * Sweeps chart jitter over lag: a filter runs with one value after the other of the setting that
 * trades the one for the other.
 */
#ifndef GZ_BENCH_FILTER_STILLNESS_H
#define GZ_BENCH_FILTER_STILLNESS_H

#include <stdbool.h>
#include <stddef.h>

#include "bench/filter/track.h"

/** Least way of a saccade whose lag is measured, degrees. */
#define GZ_LAG_LEAST_DEG 2

/** How long after a saccade a filter may arrive, ms: one that is later counts as this late. Chosen:
 *  most fixations are over by then. */
#define GZ_LAG_MOST_MS 200

/** Result of a filter. */
struct gz_stillness {
	size_t fixations; /**< that jitter and distance are of */
	size_t saccades;  /**< that lag is of */
	double jitter;    /**< NaN without a step within a fixation */
	double distance;  /**< NaN without a fixation */
	double lag_ms;    /**< NaN without a saccade */
};

/** Measure @p point of all tracks against @p raw, where @p label says what the eye does. */
struct gz_stillness gz_stillness_of(const struct gz_gaze_track *tracks, size_t count);

/** One past the last sample of the stretch of equal labels, without a gap of more than
 *  GZ_SMOOTH_GAP_NS, that sample @p begin is in. */
size_t gz_gaze_stretch_end(const struct gz_gaze_track *track, size_t begin);

/** The way of a saccade. */
struct gz_saccade_way {
	struct gz_point from, to; /**< of the raw signal */
	double deg;               /**< between both */
	size_t begin;             /**< the sample before the saccade */
	size_t late;              /**< one past the last sample at which a filter may arrive */
};

/**
 * The way of the saccade whose samples are @p begin to @p end, without @p end.
 *
 * @param[out] out  written on success
 * @return false if this is no saccade, one that is too small, or one that is not measured whole
 */
bool gz_saccade_way_of(const struct gz_gaze_track *track, size_t begin, size_t end,
		       struct gz_saccade_way *out);

/** How far along the way a point is, degrees; negative where it has not begun. The law of cosines
 *  in the plane, which angles of eye movements are small enough for. */
double gz_saccade_along_deg(const struct gz_gaze_track *track, const struct gz_saccade_way *way,
			    struct gz_point point);

/**
 * When a path has first done a share of a way, in ms from sample way->begin on, between samples
 * too; a step behind the last sample if it never has.
 *
 * @param path  @p raw or @p point of @p track
 */
double gz_saccade_crossing_ms(const struct gz_gaze_track *track, const struct gz_point *path,
			      const struct gz_saccade_way *way, double share);

#define GZ_SWEEP_MAX 40 /**< most points of a curve */

/** A point of a curve. */
struct gz_sweep_point {
	double pass_deg;                    /**< of a pipeline */
	bool as_given;                      /**< of a pipeline: pass_deg as its settings have it */
	struct gz_one_euro_params one_euro; /**< of a 1 euro filter */
	struct gz_stillness stillness;
};

/** A curve: of a pipeline by pass_deg, of a 1 euro filter from the greatest lag to the least. */
struct gz_sweep {
	struct gz_sweep_point point[GZ_SWEEP_MAX];
	size_t count;
};

/** The pipeline, by smooth.pass_deg: from where on a saccade passes unsmoothed, degrees. Its own
 *  value in @p params is among them, and is marked. */
struct gz_sweep gz_sweep_pipeline(struct gz_gaze_track *tracks, size_t count,
				  const struct gz_pipeline_params *params);

/**
 * The 1 euro filter at its best: beta, from a cutoff that hardly rises to one that lets everything
 * pass, and both cutoffs, from 0.3 to 10 Hz and from 1 to 200 Hz, are combined. Settings for which
 * another one has less jitter at no more lag are left out, and so are some between others when
 * there are more than GZ_SWEEP_MAX.
 */
struct gz_sweep gz_sweep_one_euro(struct gz_gaze_track *tracks, size_t count);

enum { GZ_SWEEP_NAME_SIZE = 64 };

/** Name a point of a curve by its settings, for a line of text. @param one_euro  of a 1 euro
 * filter, else of a pipeline */
void gz_sweep_name_point(const struct gz_sweep_point *point, bool one_euro,
			 char out_name[GZ_SWEEP_NAME_SIZE]);

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
