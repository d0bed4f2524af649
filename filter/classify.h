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
 * detection in eyetracking data", Behavior Research Methods 42, 2010). Between saccades, the slow
 * movement tells pursuit from fixation. Samples without a good measurement are a blink up to
 * blink_max_ms, then lost, on sample time.
 */
#ifndef GZ_FILTER_CLASSIFY_H
#define GZ_FILTER_CLASSIFY_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_classify_params {
	double final_delay_ms;     /**< age at which a label becomes certain, ms */
	double velocity_window_ms; /**< width of the window for the certain label, ms */
	double fast_window_ms;     /**< width of the trailing window for the label at once, ms */
	double noise_memory_s;     /**< time constant of the noise estimate, s */
	double peak_factor;        /**< peak threshold over the noise, no unit */
	double onset_factor;       /**< onset and end threshold over the noise, no unit */
	double min_peak_deg_s;     /**< least peak threshold, degrees a second */
	double min_onset_deg_s;    /**< least onset and end threshold, degrees a second */
	double end_fraction;       /**< a saccade ends below this part of its peak velocity */
	double saccade_min_ms;     /**< shorter ones are not saccades, ms */
	double saccade_max_ms;     /**< longer ones are ended, ms */
	double glissade_ms;        /**< after a saccade, for so long, ms, ... */
	double glissade_fraction;  /**< ... only this part of its peak begins another */
	double fixation_min_ms;    /**< shorter ones are not announced, ms */
	double pursuit_window_ms;  /**< over which slow movement is measured, ms */
	double pursuit_velocity_deg_s; /**< where fixation and pursuit are equally likely */
	double dropout_ms;             /**< shorter losses are not blinks, ms */
	double blink_max_ms;           /**< longer ones are lost, ms */
};

/** Samples kept: final delay and half a window at 2000 Hz, and some. A power of two. */
#define GZ_CLASSIFY_RING 128

/** Slow movement is followed over bins of some milliseconds. A power of two. */
#define GZ_CLASSIFY_BINS 32

/** One sample in the ring. */
struct gz_classify_entry {
	uint64_t seq;
	int64_t time_ns;
	double direction_deg[3]; /**< unit vector from the eye, times 180/pi: differences are angles
				    in degrees */
	struct gz_point point;
	double speed_deg_s; /**< once known */
	bool valid;
	enum gz_event event; /**< the label given at once */
};

/** A saccade or the interval after it, as the certain labels see it. */
struct gz_classify_machine {
	enum gz_event event;    /**< the certain label of the newest certain sample */
	int64_t since_ns;       /**< when that label began */
	double peak_deg_s;      /**< of the running saccade, or of the last one */
	double last_deg_s;      /**< speed one sample ago */
	int64_t saccade_end_ns; /**< of the last saccade */
	bool had_saccade;
	double pursuit_odds; /**< log odds of pursuit against fixation */
	double habit_odds;   /**< what the intervals before were: where pursuit_odds starts */
};

/** Mean place over one bin. */
struct gz_classify_bin {
	int64_t time_ns;
	double direction_deg[3];
	double weight;
};

/** Zero-initialised is the start state: lost, no sample yet. Plain data. */
struct gz_classify_state {
	struct gz_classify_entry ring[GZ_CLASSIFY_RING];
	uint64_t count;      /**< samples taken; the newest is ring[(count - 1) % RING] */
	uint64_t certain;    /**< samples whose label is certain */
	double period_ns;    /**< time between samples, measured */
	int64_t valid_ns;    /**< of the newest good sample */
	bool any_valid;      /**< whether there ever was one */
	double noise_deg_s;  /**< median speed outside saccades */
	double noise_time_s; /**< how long it was learnt */
	bool fast_saccade;   /**< the label at once is saccade */
	double fast_peak_deg_s;
	int64_t fast_since_ns;
	enum gz_event now; /**< the newest label given at once */
	struct gz_classify_machine machine;
	struct gz_classify_bin bins[GZ_CLASSIFY_BINS];
	uint64_t bin_count;   /**< since the last saccade or loss */
	double slow_deg_s[3]; /**< slow movement of the eye */
};

/** What one sample brought about. */
struct gz_classify_output {
	enum gz_event event;   /**< of this sample, as known now */
	double velocity_deg_s; /**< of the eye, finite, 0 or more */
	bool final_known;      /**< whether the rest holds something */
	uint64_t final_seq;    /**< this or an earlier sample: its label is now certain; where a
				  step makes several certain, the newest; the others keep theirs */
	int64_t final_ns;
	enum gz_event final_event;
	bool final_valid;            /**< it was a good measurement */
	struct gz_point final_point; /**< where it was */
};

/**
 * Label one sample.
 *
 * @param seq, time_ns  of the sample; time_ns newer than that of the last
 * @param valid    whether @p point was measured and believed; else @p point is not looked at
 * @param display  valid
 */
struct gz_classify_output gz_classify_step(struct gz_classify_state *state,
					   const struct gz_classify_params *params,
					   const struct gz_display *display, uint64_t seq,
					   int64_t time_ns, bool valid, struct gz_point point);

#endif
