/**
 * @file
 * A synthetic viewer: where somebody looks at any moment, and what the eyes do. Continuous in time;
 * advanced from moment to moment, never backwards. The same seed, settings and display give the
 * same bits on every machine, whatever the steps it is advanced by.
 */
#ifndef GZ_SIM_VIEWER_H
#define GZ_SIM_VIEWER_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"
#include "sim/random.h"
#include "sim/targets.h"

/** Settings; presets and sources stand in sim_options.c. */
struct gz_viewer_params {
	double fixation_ms;         /**< mean duration of a fixation, ms */
	double saccade_deg;         /**< mean amplitude of a saccade without targets, degrees */
	double drift_deg_s;         /**< speed of the drift within fixations, degrees a second */
	double tremor_deg;          /**< amplitude of the tremor, degrees */
	double microsaccades_per_s; /**< within fixations */
	double pursuits_per_min;    /**< episodes of smooth pursuit */
	double pursuit_ms;          /**< mean duration of one, ms */
	double pursuit_deg_s;       /**< mean speed of one, degrees a second */
	double blinks_per_min;
	double blink_ms; /**< mean duration of a blink, ms */
};

/** The truth at one moment. */
struct gz_viewer_truth {
	int64_t time_ns;
	struct gz_point point; /**< where the eyes look, also behind closed lids */
	enum gz_event event;   /**< FIXATION, SACCADE, PURSUIT or BLINK */
	double velocity_deg_s; /**< of the eyes, without tremor */
	uint64_t fixation;     /**< counts fixations from 0: the one running, or the last one */
	bool microsaccade;     /**< a microsaccade runs; event is FIXATION */
};

/** A saccade: along a great circle. */
struct gz_viewer_saccade {
	double start[3], end[3]; /**< unit vectors */
	double amplitude_rad;
	double begin_s, duration_s;
};

/** Microsaccades of the running fixation, as offsets from its place to the right and down. */
struct gz_viewer_microsaccade {
	double from_deg[2], to_deg[2]; /**< before and after the newest one */
	double amplitude_deg;
	double begin_s, end_s;
	double next_s; /**< when the next one is due; infinite if none is */
};

/** Drift and tremor; the drift is renewed on a grid in time. */
struct gz_viewer_jitter {
	double grid_s;      /**< time of drift[axis][1] */
	double drift[2][2]; /**< per axis, one grid step before and at grid_s, degrees */
	double velocity[2]; /**< degrees a second */
	double phase[2];    /**< of the tremor, turns */
};

/** A viewer. Plain data but for targets, which is borrowed; gz_viewer_init() fills it. */
struct gz_viewer {
	struct gz_viewer_params params;
	struct gz_display display;
	const struct gz_targets *targets; /**< borrowed; NULL: free viewing */
	struct gz_random random;          /**< of the plan: what is done when */
	struct gz_random jitter_random;   /**< of the fixational movement */
	enum gz_event phase;              /**< FIXATION, SACCADE, PURSUIT or BLINK */
	double begin_s, end_s;            /**< of the phase, since the viewer's start */
	double now_s;
	int64_t start_ns;
	double place[3];     /**< unit vector: where the fixation or pursuit started */
	double direction[3]; /**< unit tangent: where the pursuit goes */
	double pursuit_rad_s;
	struct gz_viewer_saccade saccade; /**< running, or the last one */
	struct gz_viewer_microsaccade micro;
	struct gz_viewer_jitter jitter;
	double next_blink_s, next_pursuit_s; /**< when due; infinite if never */
	uint64_t fixation_count;
	bool follows;                      /**< looks at aim alone; see gz_viewer_follow() */
	double aim[3];                     /**< unit vector */
	double inhibition[GZ_TARGETS_MAX]; /**< per target, [0, 1]: just looked at */
};

/**
 * Start a viewer at @p start_ns, fixating the display's centre or the first target.
 *
 * @param params   in the ranges of the option table
 * @param display  valid
 * @param targets  borrowed for as long as the viewer is used; NULL or empty: free viewing
 */
void gz_viewer_init(struct gz_viewer *viewer, const struct gz_viewer_params *params,
		    const struct gz_display *display, const struct gz_targets *targets,
		    uint64_t seed, int64_t start_ns);

/**
 * Go on to @p time_ns and tell the truth there. A time before the last one tells the last again.
 * Does not allocate. Time of the call: in proportion to the time skipped.
 */
struct gz_viewer_truth gz_viewer_advance(struct gz_viewer *viewer, int64_t time_ns);

/**
 * Look at one place until told otherwise: after a reaction time the eye goes there, in one saccade
 * with the usual landing error and a second one that corrects it, and rests, with drift,
 * microsaccades and blinks. What is steered like this is no longer a matter of the seed alone.
 *
 * @param point  finite, on the display or beside it; NULL: as before
 */
void gz_viewer_follow(struct gz_viewer *viewer, const struct gz_point *point);

/**
 * Peak velocity of a saccade: V = 900 (1 - exp(-A / 11)), degrees a second.
 *
 * The main sequence's saturating form is Bahill, Clark and Stark, "The main sequence, a tool for
 * studying human eye movements", Mathematical Biosciences 24, 1975; 900 is the highest speed of
 * Bauer 2018, section 2.2; 11 degrees is chosen within the published spread (10 to 16), so that
 * peak over mean velocity stays between 1.7 and 2.5 with the durations below.
 */
double gz_main_sequence_peak_deg_s(double amplitude_deg);

/** Duration of a saccade: D = 2.2 A + 21, ms (Carpenter, "Movements of the Eyes", 1988). */
double gz_main_sequence_duration_ms(double amplitude_deg);

#endif
