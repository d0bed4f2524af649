/**
 * @file
 * Fourth step: what the eyes are doing. Causal: each sample gets a label at once, and the certain
 * one with a later sample at most final_delay_ms after it (at low rates: with the sample itself).
 *
 * Speed is the slope of a least-squares line over a short time window (the first derivative of
 * Savitzky and Golay 1964 of order 1 and 2, also for uneven sampling), with the slow movement of
 * the eye taken off. A saccade is where it exceeds a threshold that follows the recording's noise:
 * a multiple of the median speed (Engbert and Kliegl, "Microsaccades uncover the orientation of
 * covert attention", Vision Research 43, 2003, p. 1037), with a higher one for the peak than for
 * onset and end (Nyström and Holmqvist, "An adaptive algorithm for fixation, saccade, and glissade
 * detection in eyetracking data", Behavior Research Methods 42, 2010). It ends where the eye no
 * longer goes on in the direction that it had at the peak, so that the eye's ringing, which turns
 * back first, is no part of it. Between saccades, the slow movement tells pursuit from fixation
 * (classify_pursuit.c). Samples without a good measurement are a blink up to blink_max_ms, then
 * lost, on sample time.
 */
#ifndef GZ_FILTER_CLASSIFY_H
#define GZ_FILTER_CLASSIFY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_classify_params {
	double final_delay_ms;     /**< oldest age at which a label becomes certain, ms */
	double velocity_window_ms; /**< width of the window for the certain label, ms */
	double quick_window_ms;    /**< width of the trailing one for the label at once, ms */
	double noise_memory_s;     /**< time constant of the noise estimate, s */
	double peak_factor;        /**< of the noise in the peak threshold, no unit */
	double onset_factor;       /**< of the noise in the onset and end threshold, no unit */
	double peak_base_deg_s;    /**< peak threshold without noise, degrees a second */
	double onset_base_deg_s;   /**< onset and end threshold without noise, the same */
	double end_fraction;       /**< a saccade ends below this part of its peak velocity */
	double end_ms;         /**< and so long after it fell below, ms: the last of the movement,
				  which the velocity's window looks beyond */
	double turn_fraction;  /**< and where it gathers speed again below this part */
	double saccade_max_ms; /**< longer ones are ended, ms */
	double glissade_ms;    /**< after a saccade, for so long, ms, ... */
	double glissade_fraction;     /**< ... only this part of its peak begins another */
	double fixation_min_ms;       /**< shorter ones are not announced, ms */
	double pursuit_window_ms;     /**< over which slow movement is measured, ms */
	double fixation_spread_deg;   /**< deviation of a fixation's places on an axis, degrees */
	double fixation_drift_deg2_s; /**< what its variance grows by, square degrees a second */
	double pursuit_speed_deg_s;   /**< usual size of a pursuit's speed on an axis */
	double pursuit_factor_max; /**< most that one stretch between saccades tells of the next */
	double pursuit_scenes;     /**< part of scenes that have something to follow, [0, 1] */
	double pursuit_begins;     /**< there: how often pursuit follows on fixation, [0, 1] */
	double pursuit_hysteresis; /**< odds needed to change one's mind, 1 or more */
	double dropout_ms;         /**< shorter losses are not blinks, ms */
	double blink_max_ms;       /**< longer ones are lost, ms */
};

/** Samples kept: final delay and half a window at 2000 Hz, and some. A power of two. */
#define GZ_CLASSIFY_RING 128

/** Slow movement is followed over so many bins at most. A power of two. */
#define GZ_CLASSIFY_BINS 64

/** States of the eye and the scene: each rests or moves. */
#define GZ_CLASSIFY_BELIEFS 4

/** One sample in the ring. */
struct gz_classify_entry {
	uint64_t seq;
	int64_t time_ns;
	double direction_deg[3]; /**< gz_direction_deg() */
	struct gz_point point;
	float confidence;
	bool valid;
	bool after_loss; /**< good, and a blink, a loss or the beginning lies just before it */
	double velocity_deg_s[3]; /**< with the slow movement taken off, once measured */
	double fast_deg_s;        /**< its length */
};

/** What the certain labels go by. */
struct gz_classify_machine {
	enum gz_event event;    /**< of the newest certain sample */
	int64_t valid_ns;       /**< newest certain good sample */
	bool any_valid;         /**< whether there was one */
	int64_t since_ns;       /**< when the running saccade began */
	int64_t saccade_end_ns; /**< when the last saccade ended */
	bool had_saccade;       /**< since the last loss */
	double peak_deg_s;      /**< of the running saccade, or of the last one */
	bool slowed;            /**< the running saccade fell below its end threshold, ... */
	int64_t slowed_ns;      /**< ... at this time */
	double heading[3];      /**< unit vector along the running saccade's velocity at its peak */
	bool believes;          /**< whether the next two hold something */
	double belief[GZ_CLASSIFY_BELIEFS]; /**< probabilities before the running stretch */
	double pursuit_factor;              /**< Bayes factor of pursuit against fixation in it */
};

/** Mean place over some milliseconds between saccades. */
struct gz_classify_bin {
	int64_t start_ns;
	double time_sum_s; /**< of time since start_ns */
	double direction_sum_deg[3];
	double count;
};

/** Slow movement since the last saccade or loss. */
struct gz_classify_slow {
	struct gz_classify_bin bins[GZ_CLASSIFY_BINS];
	uint64_t bin_count;       /**< begun since then; the last one is still being filled */
	double velocity_deg_s[3]; /**< slope over the window; the one before the saccade until there
				     is a new one */
	double span_s;            /**< time that the slope rests on */
};

/** The label given at once. */
struct gz_classify_quick {
	bool saccade;
	struct gz_median noise_deg_s; /**< of the trailing speed outside saccades */
	double peak_deg_s;            /**< of the running saccade */
	int64_t since_ns;
};

/** Zero-initialised is the start state: lost, no sample yet. Plain data. */
struct gz_classify_state {
	struct gz_classify_entry ring[GZ_CLASSIFY_RING];
	uint64_t count;               /**< samples taken; sample i is ring[i % RING] */
	uint64_t measured;            /**< samples whose speed is known */
	uint64_t certain;             /**< samples whose label is certain */
	bool decided;                 /**< and that of the next one, which waits for another step */
	double period_ns;             /**< time between samples, measured; 0 before the second */
	int64_t valid_ns;             /**< newest good sample */
	bool any_valid;               /**< whether there was one */
	enum gz_event now;            /**< label given at once to the newest sample */
	struct gz_median noise_deg_s; /**< speed outside saccades */
	struct gz_classify_quick quick;
	struct gz_classify_machine machine;
	struct gz_classify_slow slow;
};

/** One sample to label. */
struct gz_classify_input {
	uint64_t seq;
	int64_t time_ns;       /**< newer than that of the last sample */
	bool valid;            /**< whether point was measured and believed */
	struct gz_point point; /**< not looked at unless valid */
	float confidence;      /**< [0, 1] */
};

/** Most labels that one step makes certain. Chosen: it is one but after a gap. */
#define GZ_CLASSIFY_FINALS_MAX 16

/** A sample whose label is now certain. */
struct gz_classify_final {
	uint64_t seq;
	int64_t time_ns;
	enum gz_event event;
	bool valid;
	bool after_loss; /**< a blink, a loss or the beginning lies between it and the one before */
	struct gz_point point;
	float confidence;
	double peak_deg_s; /**< of the running saccade, or of the last one */
};

/** What one sample brought about. */
struct gz_classify_output {
	enum gz_event event;   /**< of this sample, as known now */
	double velocity_deg_s; /**< of the eye, finite, 0 or more */
	bool resumed;          /**< first good sample after a blink or loss */
	int64_t last_valid_ns; /**< the good sample before that, or, while blinking, the last one */
	size_t final_count;    /**< final[] holds so many, in order, this or earlier samples: every
				  sample is in one step's, once. They have one label; where more
				  become certain at once, the rest come with the next samples */
	struct gz_classify_final final[GZ_CLASSIFY_FINALS_MAX];
};

/**
 * Label one sample.
 *
 * @param display  valid
 */
struct gz_classify_output gz_classify_step(struct gz_classify_state *state,
					   const struct gz_classify_params *params,
					   const struct gz_display *display,
					   const struct gz_classify_input *input);

#endif
