/**
 * @file
 * Third step: spikes of one or two samples. Stampe, "Heuristic filtering and reliable calibration
 * methods for video-based pupil-tracking systems", Behavior Research Methods, Instruments &
 * Computers 25(2), 1993, pp. 137-142, replaces a sample (or a pair) that stands out against both
 * its neighbours by the nearer neighbour, which needs the neighbour after it.
 *
 * Here nothing waits in ordinary movement: only a sample that departs from the line of its
 * predecessors by more than the noise explains is held back, at its predecessor's place, until the
 * next one (or two) tell whether it returns (a spike, dropped) or not (a movement, passed at once).
 * The delay is thus zero but at the first one or two samples of a departure, and never longer than
 * max_delay_ms: a tracker whose samples lie farther apart than that is passed through.
 */
#ifndef GZ_FILTER_DESPIKE_H
#define GZ_FILTER_DESPIKE_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_despike_params {
	double max_delay_ms;  /**< longest hold, ms; 0 switches the step off */
	double threshold_deg; /**< departures below this are never held, degrees */
	double noise_factor;  /**< nor those below this multiple of the usual step */
};

/** Zero-initialised is the start state. */
struct gz_despike_state {
	int held;                  /**< samples being held back: 0, 1 or 2 */
	bool started;              /**< whether clean and time_ns hold something */
	bool stepped;              /**< whether step_deg holds something */
	int64_t time_ns;           /**< of the newest sample */
	int64_t held_ns;           /**< of the first held sample */
	struct gz_point clean;     /**< newest point known not to be a spike */
	struct gz_point spike;     /**< newest held point */
	double step_mm[2];         /**< last step between clean points, mm on the display */
	struct gz_median step_deg; /**< usual step, degrees */
	uint64_t dropped_count;    /**< samples found to be spikes so far */
};

/**
 * Take one point and give the one to go on with.
 *
 * @param restart  the sample follows a gap: forget what was before
 * @return the point itself or, while it is in doubt, its predecessor's place
 */
struct gz_point gz_despike_step(struct gz_despike_state *state,
				const struct gz_despike_params *params,
				const struct gz_display *display, int64_t time_ns,
				struct gz_point point, bool restart);

#endif
