/**
 * @file
 * A synthetic eye tracker: turns a viewer into samples as a driver would deliver them, with noise,
 * loss, latency and a clock of its own, and keeps the truth beside the measurement.
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

/** Every setting of the simulator; one table describes it: gz_sim_options. */
struct gz_sim_params {
	int seed;          /**< the same seed gives the same samples, but for their start time */
	double rate_hz;    /**< 30 to 2000 */
	double noise_deg;  /**< standard deviation of each eye's point, each axis, degrees */
	double offset_deg; /**< standard deviation of each eye's constant error, degrees */
	double calibration_x[3]; /**< a b c: every place is told at x' = a + b x + c y instead of x,
				  */
	double calibration_y[3]; /**< and at y' likewise: a tracker that is calibrated badly */
	double loss;             /**< fraction of samples that never arrive, [0, 1) */
	double eye_loss;         /**< fraction of samples in which one eye is not found, [0, 1) */
	double spikes;           /**< fraction of samples that jump for one sample, [0, 1) */
	double latency_ms;       /**< from exposure to delivery, ms */
	double latency_jitter_ms; /**< mean of what is added to it at random, ms */
	double clock_offset_ms;   /**< device clock at the start, ms */
	double clock_skew_ppm;    /**< device clock over host clock, parts per million */
	bool combined_only;       /**< deliver one point for both eyes */
	bool realtime; /**< for the driver: deliver as time passes, not as fast as read */
	int display_px[2];
	double display_mm[2];
	double distance_mm;
	struct gz_viewer_params viewer;
	char targets[GZ_PATH_SIZE]; /**< file with a target list; empty: none */
	char picture[GZ_PATH_SIZE]; /**< PNG file whose salient points steer; empty: none */
};

/** Table over struct gz_sim_params; keys are "sim.<name>". */
extern const struct gz_option gz_sim_options[];
extern const size_t gz_sim_option_count;

/** The table's presets. */
struct gz_sim_params gz_sim_default_params(void);

/** One sample with all that is known of it. */
struct gz_sim_sample {
	struct gz_sample sample; /**< host_ns is the moment of exposure */
	int64_t arrival_ns;      /**< when a driver would deliver it: never before an earlier one */
	struct gz_viewer_truth truth; /**< at the moment of exposure */
};

/** A tracker. */
struct gz_sim_tracker;

/**
 * Make a tracker.
 *
 * @param params    copied; outside the table's ranges is refused
 * @param start_ns  exposure of the first sample, host time
 * @param log       for the target list's or picture's faults; may be NULL
 * @param[out] out_tracker  owned by the caller: gz_sim_tracker_destroy()
 * @retval GZ_ERR_INVAL   a setting is out of range, or both targets and picture are given; logged
 * @retval GZ_ERR_NO_MEM  nothing to free
 * @return else what gz_targets_load() or gz_targets_from_png() answers
 */
enum gz_result gz_sim_tracker_create(const struct gz_sim_params *params, int64_t start_ns,
				     const struct gz_log *log, struct gz_sim_tracker **out_tracker);

/**
 * The next sample that arrives. Lost ones are counted in its lost_before. Does not allocate.
 * Threads: one at a time per tracker.
 *
 * @param[out] out  always filled; seq counts from 0
 */
void gz_sim_tracker_next(struct gz_sim_tracker *tracker, struct gz_sim_sample *out);

/** Let the viewer look at one place; see gz_viewer_follow(). Threads: as gz_sim_tracker_next(). */
void gz_sim_tracker_follow(struct gz_sim_tracker *tracker, const struct gz_point *point);

/** The display that the viewer looks at. */
struct gz_display gz_sim_tracker_display(const struct gz_sim_tracker *tracker);

/** The device's clock as it truly is, at the newest sample: tick DECLARED, sigma 0. */
struct gz_clock_status gz_sim_tracker_clock(const struct gz_sim_tracker *tracker);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_sim_tracker_destroy(struct gz_sim_tracker **tracker);

#endif
