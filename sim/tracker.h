/**
 * @file
 * A synthetic eye tracker: it measures a synthetic viewer and gives samples as a driver would
 * deliver them, with noise, loss, latency and a clock of its own. The truth stands beside each
 * measurement.
 */
#ifndef GZ_SIM_TRACKER_H
#define GZ_SIM_TRACKER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "sim/random.h"
#include "sim/targets.h"
#include "sim/viewer.h"

/** Every setting of the simulator, described by the table gz_sim_options. */
struct gz_sim_params {
	int seed;                /**< equal seeds give equal samples, except for their start time */
	double rate_hz;          /**< 30 to 2000 */
	double noise_deg;        /**< standard deviation of each eye's point, each axis, degrees */
	double offset_deg;       /**< standard deviation of each eye's constant error, degrees */
	double calibration_x[3]; /**< a b c: a place is reported at x' = a + b x + c y, as by a
				    badly calibrated tracker */
	double calibration_y[3]; /**< a b c of y' = a + b x + c y, in the same way */
	double loss;             /**< fraction of samples that never arrive, [0, 1) */
	double eye_loss;         /**< fraction of samples in which one eye is not found, [0, 1) */
	double spikes;           /**< fraction of samples that jump for one sample, [0, 1) */
	double latency_ms;       /**< from exposure to delivery, ms */
	double latency_jitter_ms; /**< mean of the random time added to it, ms */
	double clock_offset_ms;   /**< device clock at the start, ms */
	double clock_skew_ppm; /**< how much faster the device clock runs than the host's, parts per
				  million */
	bool lids;             /**< whether the tracker sees lids close and open: the pupil becomes
				  smaller and its middle moves down before it is lost, as with a
				  camera; else a blink is a loss without warning */
	bool combined_only;    /**< whether to deliver one point for both eyes */
	bool realtime;         /**< for the driver: deliver in real time, not as fast as it reads */
	int display_px[2];
	double display_mm[2];
	double distance_mm;
	struct gz_viewer_params viewer;
	char targets[GZ_PATH_SIZE]; /**< path of a target list; empty: none */
	char picture[GZ_PATH_SIZE]; /**< path of a PNG file whose salient points are targets; empty:
				       none */
};

/** Options over struct gz_sim_params; the keys are "sim.<name>". */
extern const struct gz_option gz_sim_options[];
extern const size_t gz_sim_option_count;

/** The presets of gz_sim_options. */
struct gz_sim_params gz_sim_default_params(void);

/** One sample, with what a real tracker does not know. */
struct gz_sim_sample {
	struct gz_sample sample; /**< host_ns is the moment of exposure */
	int64_t arrival_ns; /**< when a driver would deliver it; never before an earlier sample */
	struct gz_viewer_truth truth; /**< at the moment of exposure */
};

/** A synthetic tracker. */
struct gz_sim_tracker;

/**
 * Make a tracker.
 *
 * @param params    copied; values outside the ranges of the table are refused
 * @param start_ns  exposure of the first sample, host time
 * @param log       for errors in settings, target list and picture; may be NULL
 * @param[out] out_tracker  owned by the caller: gz_sim_tracker_destroy()
 * @retval GZ_ERR_INVAL   a setting is out of range, or both targets and picture are given; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 * @return otherwise what gz_targets_load() or gz_targets_from_png() returns
 */
enum gz_result gz_sim_tracker_create(const struct gz_sim_params *params, int64_t start_ns,
				     const struct gz_log *log, struct gz_sim_tracker **out_tracker);

/**
 * Get the next sample that arrives. Its lost_before counts the lost ones before it. Does not
 * allocate. Threads: one at a time per tracker.
 *
 * @param[out] out  always filled; seq counts from 0
 */
void gz_sim_tracker_next(struct gz_sim_tracker *tracker, struct gz_sim_sample *out);

/** Make the viewer look at one place; see gz_viewer_follow(). Threads: one at a time per tracker.
 */
void gz_sim_tracker_follow(struct gz_sim_tracker *tracker, const struct gz_point *point);

/** Give the viewer other places that attract it, from its next fixation on. From then on the
 * samples do not depend on the settings alone. @param targets  copied. Threads: one at a time per
 * tracker. */
void gz_sim_tracker_attract(struct gz_sim_tracker *tracker, const struct gz_targets *targets);

/** The display that the viewer looks at. */
struct gz_display gz_sim_tracker_display(const struct gz_sim_tracker *tracker);

/** The true state of the device's clock at the newest sample: tick DECLARED, sigma 0. */
struct gz_clock_status gz_sim_tracker_clock(const struct gz_sim_tracker *tracker);

/** Free the tracker and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_sim_tracker_destroy(struct gz_sim_tracker **tracker);

#endif
