/**
 * @file
 * Third step: remove spikes of one or two samples.
 *
 * Stampe, "Heuristic filtering and reliable calibration methods for video-based pupil-tracking
 * systems", Behavior Research Methods, Instruments & Computers 25(2), 1993, pp. 137-142, replaces a
 * sample (or a pair) that stands out against both its neighbours by the nearer neighbour. That
 * needs the neighbour after it.
 *
 * Here ordinary movement is not delayed. Only a sample that departs from the line of its
 * predecessors by more than the noise explains is held back: the point stays at the predecessor's
 * place until the next sample, or the next two, show whether the eye returns (a spike, which is
 * dropped) or not (a movement, which passes at once). So the delay is zero except for the first one
 * or two samples of a departure, and never longer than max_delay_ms. If a tracker's samples are
 * farther apart than that, all of them pass.
 */
#ifndef GZ_FILTER_DESPIKE_H
#define GZ_FILTER_DESPIKE_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"

/** Settings. pipeline_options.c has the presets and their sources. */
struct gz_despike_params {
	double max_delay_ms;  /**< longest time that a sample is held, ms; 0 switches this step off
			       */
	double threshold_deg; /**< smaller departures are never held, degrees */
	double noise_factor;  /**< nor are departures below this multiple of the usual step */
};

/** State of this step. Zero-initialised is the start state. */
struct gz_despike_state {
	int held;                  /**< number of samples being held: 0, 1 or 2 */
	bool started;              /**< whether clean and time_ns are set */
	bool stepped;              /**< whether step_mm is set */
	int64_t time_ns;           /**< of the newest sample */
	int64_t held_ns;           /**< of the first held sample */
	struct gz_point clean;     /**< newest point that is not a spike */
	struct gz_point spike;     /**< newest held point */
	double step_mm[2];         /**< last step between clean points, mm on the display */
	struct gz_median step_deg; /**< usual step, degrees */
	uint64_t dropped_count;    /**< number of samples that were spikes */
};

/**
 * Take one point and return the point for the next step.
 *
 * @param restart  the sample follows a gap: forget what came before
 * @return the point itself; its predecessor's place while it may be a spike
 */
struct gz_point gz_despike_step(struct gz_despike_state *state,
				const struct gz_despike_params *params,
				const struct gz_display *display, int64_t time_ns,
				struct gz_point point, bool restart);

#endif
