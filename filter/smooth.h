/**
 * @file
 * Fifth step: a point that rests while the eye rests.
 *
 * In a fixation it is a recursive mean whose window grows from start_ms to window_ms. It becomes
 * shorter with the fourth power of how far the eye is from the mean: within drift_deg the point
 * rests, beyond it the point follows quickly. A saccade passes unsmoothed once it is too large to
 * be noise. In a pursuit an alpha-beta tracker follows constant velocity without lag. Between these
 * modes the point glides. A sample that is labelled saccade or noise, but lies where the eye
 * rested, counts as part of the fixation.
 */
#ifndef GZ_FILTER_SMOOTH_H
#define GZ_FILTER_SMOOTH_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Settings. pipeline_options.c has the presets and their sources. */
struct gz_smooth_params {
	double window_ms;    /**< longest window of the mean, ms */
	double start_ms;     /**< window of the mean at the beginning of a fixation, ms */
	double pursuit_ms;   /**< time constant of the alpha-beta tracker, ms */
	double drift_factor; /**< the window is halved when the mean is this multiple of the usual
				distance behind the eye */
	double leave_factor; /**< the point follows a saccade beyond this multiple of the usual
				distance */
	double leave_deg;    /**< and not below this distance, degrees */
	double drift_deg;    /**< least distance at which the window is halved, degrees */
	double pass_deg;     /**< a saccade beyond this distance passes unsmoothed, degrees */
	double glide_ms;     /**< time constant of the glide after any other movement, ms */
};

/** After a longer time without a good sample smoothing starts again, ns. Chosen: half of the
 * shortest blink. */
#define GZ_SMOOTH_GAP_NS INT64_C(50000000)

/** State of this step. Zero-initialised is the start state. */
struct gz_smooth_state {
	bool started;       /**< whether the other fields are set */
	enum gz_event mode; /**< how the last good sample was smoothed */
	int64_t time_ns;    /**< of the last good sample */
	double place[2];    /**< the estimated place of the eye, display sides */
	double glide[2];    /**< the returned point less place, display sides */
	bool passing;       /**< whether the running saccade passes unsmoothed */
	double velocity[2]; /**< display sides a second; pursuit only */
	double window_s;    /**< present window of the mean */
	double offset[2];   /**< short mean of measured less estimated place, display sides */
	double measured[2]; /**< the last good sample, display sides */
	struct gz_median usual_deg; /**< distance from the place that noise alone causes, degrees */
	struct gz_point point;      /**< the last returned point */
};

/** One sample to smooth. */
struct gz_smooth_input {
	enum gz_event event; /**< the immediate label */
	int64_t time_ns;
	bool valid;            /**< whether point was measured */
	struct gz_point point; /**< ignored unless valid */
};

/**
 * Smooth one point. If it is not valid, the last point is returned again.
 *
 * @return always finite; (0.5, 0.5) before the first good sample
 */
struct gz_point gz_smooth_step(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			       const struct gz_display *display,
			       const struct gz_smooth_input *input);

#endif
