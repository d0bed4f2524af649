/**
 * @file
 * Fourth step: what the eyes do. The step is causal: each sample gets an immediate label, and its
 * certain label comes with a later sample, at most final_delay_ms after it (at low rates with the
 * sample itself).
 *
 * Speed is the slope of a least-squares line over a short time window (the first derivative of
 * Savitzky and Golay 1964, of order 1 and 2, also for uneven sampling), less the slow movement of
 * the eye. A saccade is where the speed exceeds a threshold that adapts to the noise of the
 * recording: a multiple of the median speed (Engbert and Kliegl, "Microsaccades uncover the
 * orientation of covert attention", Vision Research 43, 2003, p. 1037), with a higher threshold for
 * the peak than for onset and end (Nyström and Holmqvist, "An adaptive algorithm for fixation,
 * saccade, and glissade detection in eyetracking data", Behavior Research Methods 42, 2010). A
 * saccade ends where the eye no longer moves in the direction that it had at the peak. So the
 * ringing of the eye, which first turns back, is not part of it.
 *
 * Between saccades, the slow movement distinguishes pursuit from fixation (classify_decide.c).
 * Samples without a good measurement are a blink up to blink_max_ms and lost after that, on sample
 * time.
 *
 * Instead of these rules, the labels can come from what was learned from recordings that people
 * labelled (classifier/forest.h). Its noise, such as a lid in front of the pupil, counts as a
 * sample without a good measurement. So does, with either, a lid that the pupil's size tells of
 * (lid.h): such a sample is a blink at once.
 */
#ifndef GZ_FILTER_CLASSIFY_H
#define GZ_FILTER_CLASSIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "filter/classifier/forest_lists.h"
#include "filter/classifier/movement.h"
#include "filter/median.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Where labels come from. */
enum gz_classify_source {
	GZ_CLASSIFY_RULES,   /**< thresholds and Bayes' rule, as above */
	GZ_CLASSIFY_LEARNED, /**< forests */
};

/** Settings. pipeline_options.c has the presets and their sources. */
struct gz_classify_params {
	double final_delay_ms;     /**< greatest delay of the certain label, ms */
	double velocity_window_ms; /**< width of the window for speed, certain label, ms */
	double quick_window_ms;  /**< width of the trailing window for speed, immediate label, ms */
	double noise_memory_s;   /**< time constant of the noise estimate, s */
	double peak_factor;      /**< factor of the noise in the peak threshold */
	double onset_factor;     /**< factor of the noise in the onset and end threshold */
	double peak_base_deg_s;  /**< peak threshold without noise, degrees per second */
	double onset_base_deg_s; /**< onset and end threshold without noise, degrees per second */
	double end_fraction;     /**< a saccade ends below this fraction of its peak velocity */
	double end_ms; /**< delay of the end after that, ms: the velocity's window extends beyond
			  the movement */
	double turn_fraction;       /**< it also ends if it accelerates again below this fraction */
	double saccade_max_ms;      /**< a longer saccade is ended, ms */
	double glissade_ms;         /**< for this time after a saccade, ms, ... */
	double glissade_fraction;   /**< ... only this fraction of its peak begins another one */
	double fixation_min_ms;     /**< shorter fixations are not announced, ms */
	double pursuit_window_ms;   /**< window for measuring slow movement, ms */
	double fixation_spread_deg; /**< standard deviation of the places in a fixation on an axis,
				       degrees */
	double fixation_drift_deg2_s; /**< growth of that variance, square degrees per second */
	double pursuit_speed_deg_s; /**< usual speed of a pursuit on an axis, degrees per second */
	double pursuit_factor_max;  /**< greatest effect of a stretch between saccades on the odds
				       after it */
	double pursuit_scenes; /**< fraction of scenes that contain something to follow, [0, 1] */
	double pursuit_begins; /**< in such scenes: how often pursuit follows a fixation, [0, 1] */
	double pursuit_hysteresis; /**< odds needed to change the label, 1 or more */
	double dropout_ms;         /**< shorter losses are not blinks, ms */
	double blink_max_ms;       /**< longer losses are not blinks but lost gaze, ms */
	int source;                /**< enum gz_classify_source */
	bool still_scene;          /**< nothing moves in any scene: there is no pursuit */
};

/** Samples that are kept: more than the final delay and half a window at 2000 Hz. A power of two.
 */
#define GZ_CLASSIFY_RING 128

/** Most bins over which slow movement is measured. A power of two. */
#define GZ_CLASSIFY_BINS 64

/** Number of states of eye and scene: each rests or moves. */
#define GZ_CLASSIFY_BELIEFS 4

/** One sample in the ring. */
struct gz_classify_entry {
	uint64_t seq;
	int64_t time_ns;
	double direction_deg[3]; /**< gz_direction_deg() */
	struct gz_point point;
	float confidence;
	bool valid;
	bool still_scene;             /**< nothing moves: it is no pursuit */
	bool lid;                     /**< a lid covers the pupil */
	bool after_loss;              /**< good, and the first after a blink, a loss or the start */
	enum gz_forest_class learned; /**< what the forests say: at once, then for certain */
	double velocity_deg_s[3];     /**< less the slow movement; set once measured */
	double fast_deg_s;            /**< length of velocity_deg_s */
};

/** State of the certain labels. */
struct gz_classify_machine {
	enum gz_event event;    /**< certain label of the newest sample that has one */
	int64_t valid_ns;       /**< time of the newest good sample with a certain label */
	bool any_valid;         /**< whether there was one */
	int64_t since_ns;       /**< when the running saccade began */
	int64_t saccade_end_ns; /**< when the last saccade ended */
	bool had_saccade;       /**< whether there was one since the last loss */
	double peak_deg_s;      /**< peak speed of the running or last saccade */
	bool slowed;            /**< the running saccade fell below its end threshold ... */
	int64_t slowed_ns;      /**< ... at this time */
	double heading[3];      /**< direction of the running saccade at its peak, unit vector */
	bool believes;          /**< whether belief and pursuit_factor are set */
	double belief[GZ_CLASSIFY_BELIEFS]; /**< probabilities of the states before the present
					       stretch */
	double pursuit_factor; /**< Bayes factor of pursuit against fixation in this stretch */
};

/** Mean direction over some milliseconds between saccades. */
struct gz_classify_bin {
	int64_t start_ns;
	double time_sum_s; /**< sum of times since start_ns */
	double direction_sum_deg[3];
	double count;
};

/** Slow movement since the last saccade or loss. */
struct gz_classify_slow {
	struct gz_classify_bin bins[GZ_CLASSIFY_BINS];
	uint64_t bin_count;       /**< bins since then; the last one is not full yet */
	double velocity_deg_s[3]; /**< slope over the window; until it is measured again, the one
				     from before the saccade */
	double span_s;            /**< time over which the slope was measured */
};

/** State of the immediate label. */
struct gz_classify_quick {
	bool saccade;
	struct gz_median noise_deg_s; /**< median of the trailing speed outside saccades */
	double peak_deg_s;            /**< of the running saccade */
	int64_t since_ns;
};

/** What a forest found out about the samples before. */
struct gz_classify_forest {
	struct gz_forest_memory labels;
	struct gz_forest_walks walks;
};

/** State of this step. Zero-initialised is the start state: lost, no sample yet. Plain data. */
struct gz_classify_state {
	struct gz_classify_entry ring[GZ_CLASSIFY_RING];
	uint64_t count;    /**< samples taken; sample i is ring[i % RING] */
	uint64_t measured; /**< samples whose speed is known */
	uint64_t certain;  /**< samples whose label is certain */
	bool decided; /**< the label of the next sample is certain too, and comes with the next step
		       */
	double period_ns;             /**< time between samples, measured; 0 before the second */
	int64_t valid_ns;             /**< time of the newest good sample */
	bool any_valid;               /**< whether there was one */
	int64_t measured_ns;          /**< time of the newest measured sample, good or not */
	bool lost;                    /**< whether there was a loss after the newest good sample */
	enum gz_event now;            /**< immediate label of the newest sample */
	struct gz_median noise_deg_s; /**< median of the speed outside saccades */
	struct gz_classify_quick quick;
	struct gz_classify_machine machine;
	struct gz_classify_slow slow;
	/* Used if the labels are learned: */
	struct gz_movement movement;
	struct gz_classify_forest at_once_forest, certain_forest;
	/* When the forests were asked last; set once a sample is there. */
	int64_t asked_ns, asked_certain_ns;
	int64_t lively_ns; /**< newest sample that was no slow movement */
};

/** The newest sample as the steps after this one get it; there must have been one. */
static inline const struct gz_classify_entry *gz_classify_newest(
	const struct gz_classify_state *state)
{
	return &state->ring[(state->count - 1) % GZ_CLASSIFY_RING];
}

/** One sample to label. */
struct gz_classify_input {
	uint64_t seq;
	int64_t time_ns;       /**< newer than that of the last sample */
	bool valid;            /**< whether point was measured and is plausible */
	struct gz_point point; /**< ignored unless valid */
	struct gz_point raw;   /**< the same before spikes were removed; ignored unless valid */
	float confidence;      /**< [0, 1] */
	bool lid;              /**< a lid covers the pupil: what was measured is not the eye */
	int64_t lid_since_ns;  /**< if so: and all samples since then; ignored otherwise */
	bool still_scene;      /**< nothing moves in the scene at this moment: it is no pursuit */
};

/** Most labels that one step makes certain. Chosen: except after a gap it is one. */
#define GZ_CLASSIFY_FINALS_MAX 16

/** A sample with its certain label. */
struct gz_classify_final {
	uint64_t seq;
	int64_t time_ns;
	enum gz_event event;
	bool valid;
	bool after_loss; /**< a blink, a loss or the start is between it and the sample before */
	struct gz_point point;
	float confidence;
	double peak_deg_s; /**< peak speed of the running or last saccade */
};

/** The result of one step. */
struct gz_classify_output {
	enum gz_event event;   /**< immediate label of this sample */
	double velocity_deg_s; /**< speed of the eye; finite, 0 or more */
	bool resumed;          /**< first good sample after a time without a measurement */
	int64_t last_valid_ns; /**< time of the good sample before that; during a blink, of the last
				  good one */
	size_t final_count; /**< number of entries in final[]: this and earlier samples, in order,
			       all with the same label. If more become certain at once, the others
			       come with the next steps. Each sample comes once */
	struct gz_classify_final final[GZ_CLASSIFY_FINALS_MAX];
};

/**
 * Label one sample.
 *
 * @param display   passes gz_display_valid()
 * @param[out] out  always filled, except final[] beyond final_count
 */
void gz_classify_step(struct gz_classify_state *state, const struct gz_classify_params *params,
		      const struct gz_display *display, const struct gz_classify_input *input,
		      struct gz_classify_output *out);

/**
 * Make labels certain that wait for later samples, because none will come. Call it until it gives
 * no more; then only zero-initialising the state starts again.
 *
 * @param[out] out  final_count and final as from a step; 0: every sample has its certain label. The
 *                  other fields are those of the newest sample, resumed false
 */
void gz_classify_flush(struct gz_classify_state *state, const struct gz_classify_params *params,
		       struct gz_classify_output *out);

#endif
