/**
 * @file
 * Fifth step: a point that rests while the eye rests. Within a fixation a recursive mean whose
 * window grows from start_ms to window_ms, and is shorter the more the eye has left it behind; a
 * saccade passes unsmoothed, once it is too large to be noise; pursuit by an alpha-beta tracker,
 * which follows constant velocity without lag. Between these the point glides.
 */
#ifndef GZ_FILTER_SMOOTH_H
#define GZ_FILTER_SMOOTH_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_smooth_params {
	double window_ms;    /**< longest window of the mean, ms */
	double start_ms;     /**< shortest window of the mean, ms */
	double pursuit_ms;   /**< time constant of the alpha-beta tracker, ms */
	double drift_factor; /**< the window is halved so many times the usual distance behind the
				eye */
	double leave_factor; /**< a saccade is followed from this multiple of the usual distance on
			      */
	double leave_deg;    /**< and from at least this far, degrees */
	double drift_deg;    /**< and at least so far behind it, degrees */
	double pass_deg;     /**< from so far on a saccade passes unsmoothed, degrees */
	double glide_ms;     /**< time constant of giving way to any other movement, ms */
};

/** After a longer time without a good sample smoothing begins anew, ns. Chosen: half of the
 * shortest blink. */
#define GZ_SMOOTH_GAP_NS INT64_C(50000000)

/** Zero-initialised is the start state. */
struct gz_smooth_state {
	bool started;               /**< whether the rest holds something */
	enum gz_event mode;         /**< how the last good sample was smoothed */
	int64_t time_ns;            /**< of the last good sample */
	double place[2];            /**< where the eye is thought to be, display sides */
	double glide[2];            /**< what was given, less that; display sides */
	bool passing;               /**< whether the running saccade passes unsmoothed */
	double velocity[2];         /**< display sides a second; pursuit only */
	double window_s;            /**< the mean's window so far */
	double offset[2];           /**< short mean of measured minus given place, display sides */
	double measured[2];         /**< the last good sample, display sides */
	struct gz_median usual_deg; /**< distance from a place that noise alone makes, degrees */
	struct gz_point point;      /**< what was given last */
};

/**
 * Smooth one point.
 *
 * @param event  the label given at once
 * @param valid  false: @p point is not looked at, and the last place is held
 * @return always finite; (0.5, 0.5) before the first good sample
 */
struct gz_point gz_smooth_step(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			       const struct gz_display *display, enum gz_event event,
			       int64_t time_ns, bool valid, struct gz_point point);

#endif
