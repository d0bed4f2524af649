/**
 * @file
 * A synthetic viewer: where a person looks at any moment, and what the eyes do. Time is continuous
 * and never goes backwards. The same seed, settings and display give the same bits on every
 * machine, for any size of the time steps.
 */
#ifndef GZ_SIM_VIEWER_H
#define GZ_SIM_VIEWER_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"
#include "sim/random.h"
#include "sim/targets.h"

/** Settings. tracker.c has the presets and their sources. */
struct gz_viewer_params {
	double fixation_ms; /**< mean duration of a fixation, ms */
	double saccade_deg; /**< mean amplitude of a saccade if there are no targets, degrees */
	double drift_deg_s; /**< speed of the drift in fixations, degrees per second */
	double tremor_deg;  /**< amplitude of the tremor, degrees */
	double microsaccades_per_s; /**< rate in fixations, per second */
	double pursuits_per_min;    /**< episodes of smooth pursuit, per minute between them */
	double pursuit_ms;          /**< mean duration of an episode, ms */
	double pursuit_deg_s;       /**< mean speed of an episode, degrees per second */
	double blinks_per_min;      /**< per minute between them */
	double blink_ms;            /**< mean duration of a blink, ms */
};

/** The true state of the viewer at one moment. */
struct gz_viewer_truth {
	int64_t time_ns;
	struct gz_point point; /**< where the eyes look, also during a blink */
	enum gz_event event;   /**< FIXATION, SACCADE, PURSUIT or BLINK */
	double velocity_deg_s; /**< of the eyes, without tremor, degrees per second */
	uint64_t fixation;     /**< number of the running or last fixation, from 0 */
	bool microsaccade;     /**< whether a microsaccade is running; event is FIXATION */
	double lid;            /**< how far the lid has come down, [0, 1]: 0 is open, 1 closed */
};

/** A saccade along a great circle. */
struct gz_viewer_saccade {
	double start[3], end[3]; /**< unit vectors */
	double amplitude_rad;
	double begin_s, duration_s;
};

/** The microsaccades of the running fixation, as offsets from its place to the right and down. */
struct gz_viewer_microsaccade {
	double from_deg[2], to_deg[2]; /**< offset before and after the newest one */
	double amplitude_deg;
	double begin_s, end_s;
	double next_s; /**< when the next one begins; infinite if there is none */
};

/** Drift and tremor. The drift changes its velocity on a time grid. */
struct gz_viewer_jitter {
	double grid_s;      /**< time of drift[axis][1] */
	double drift[2][2]; /**< per axis: one grid step before grid_s, and at grid_s, degrees */
	double velocity[2]; /**< degrees per second */
	double phase[2];    /**< of the tremor, turns */
};

/** A viewer. Plain data, except for the borrowed targets; gz_viewer_init() fills it. */
struct gz_viewer {
	struct gz_viewer_params params;
	struct gz_display display;
	const struct gz_targets *targets; /**< borrowed; NULL: the viewer looks around freely */
	struct gz_random random;          /**< of the plan: fixations, saccades, pursuits, blinks */
	struct gz_random jitter_random;   /**< of drift and tremor */
	enum gz_event phase;              /**< FIXATION, SACCADE, PURSUIT or BLINK */
	double begin_s, end_s;            /**< of the phase; times in s count from start_ns */
	double now_s;
	int64_t start_ns;
	double place[3];     /**< unit vector: where the fixation or pursuit began */
	double direction[3]; /**< unit tangent: direction of the pursuit */
	double pursuit_rad_s;
	struct gz_viewer_saccade saccade; /**< the running or last one */
	struct gz_viewer_microsaccade micro;
	struct gz_viewer_jitter jitter;
	double next_blink_s, next_pursuit_s; /**< when they begin; infinite: never */
	uint64_t fixation_count;
	bool follows;                      /**< it looks only at aim; see gz_viewer_follow() */
	double aim[3];                     /**< unit vector */
	double inhibition[GZ_TARGETS_MAX]; /**< of each target, [0, 1]; 1: it was just looked at */
};

/**
 * Start a viewer at @p start_ns. It fixates the first target, or the centre of the display if there
 * are none.
 *
 * @param params   within the ranges of the option table
 * @param display  passes gz_display_valid()
 * @param targets  borrowed as long as the viewer is used; NULL or empty: the viewer looks around
 * freely
 */
void gz_viewer_init(struct gz_viewer *viewer, const struct gz_viewer_params *params,
		    const struct gz_display *display, const struct gz_targets *targets,
		    uint64_t seed, int64_t start_ns);

/**
 * Advance to @p time_ns and return the true state there. A time before the last one returns the
 * last state again. Does not allocate. The call takes time in proportion to the time skipped.
 */
struct gz_viewer_truth gz_viewer_advance(struct gz_viewer *viewer, int64_t time_ns);

/**
 * Look at one place until the next call. After a reaction time the eye moves there, by a saccade
 * with the usual landing error and a second one that corrects it, and rests there with drift,
 * microsaccades and blinks. From then on the samples do not depend on the seed alone.
 *
 * @param point  finite, on the display or beside it; NULL: look around as without this function
 */
void gz_viewer_follow(struct gz_viewer *viewer, const struct gz_point *point);

/**
 * Peak velocity of a saccade of A degrees: V = 900 (1 - exp(-A / 11)), degrees per second.
 *
 * The saturating form of the main sequence is from Bahill, Clark and Stark, "The main sequence, a
 * tool for studying human eye movements", Mathematical Biosciences 24, 1975; 900 is the highest
 * speed of Bauer 2018, section 2.2; 11 degrees is chosen within the published range (10 to 16), so
 * that with the durations below the ratio of peak to mean velocity stays between 1.7 and 2.5.
 */
double gz_main_sequence_peak_deg_s(double amplitude_deg);

/** Duration of a saccade of A degrees: D = 2.2 A + 21, ms (Carpenter, "Movements of the Eyes",
 * 1988). */
double gz_main_sequence_duration_ms(double amplitude_deg);

#endif
