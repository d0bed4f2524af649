/**
 * @file
 * Where a saccade will land, and when, from its first samples.
 *
 * The size of a saccade can be told from its speed: Bahill, Clark and Stark, "The main sequence, a
 * tool for studying human eye movements", Mathematical Biosciences 24, 1975. So the distance that
 * is still to go is a weighted sum of the way so far, the present and the greatest speed, and their
 * square roots, with weights for each GZ_LANDING_BIN_MS since the saccade was noticed; so is the
 * time. bench/probes/gaze_landing.c fits the weights to labelled recordings. People differ: how
 * much farther or less far than predicted the last saccades went scales the next prediction.
 *
 * Pure steps over a state: only + - * / and sqrt, which round in the same way on every machine.
 */
#ifndef GZ_FILTER_LANDING_H
#define GZ_FILTER_LANDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Points that are kept: 28 ms, from before the saccade was noticed, at 2000 Hz. A power of two. */
#define GZ_LANDING_RING 64

/** Times since the saccade was noticed that have weights of their own, and how long each is, ms. */
#define GZ_LANDING_BINS   12
#define GZ_LANDING_BIN_MS 4

/** Numbers that are weighted: 1, way, speed, greatest speed, and the square roots of these three.
 */
#define GZ_LANDING_TERMS 7

/** Most that a saccade goes on, degrees and ms. Chosen: beyond what a display allows. */
#define GZ_LANDING_DEG_MAX 40
#define GZ_LANDING_MS_MAX  150

/** What is known of a running saccade. Directions are as in gz_direction_deg() (filter/angle.h). */
struct gz_landing_look {
	double elapsed_ms;  /**< since it was noticed */
	double interval_ms; /**< between the newest two points */
	double way_deg;     /**< from where it began */
	double speed_deg_s; /**< over the last 4 ms, or the last interval if that is longer */
	double peak_deg_s;  /**< greatest speed since it was noticed */
	double place_deg[3];
	double heading[3]; /**< unit vector between the way so far and the present direction */
};

/** Weights for one time since the saccade was noticed. */
struct gz_landing_weights {
	double deg[GZ_LANDING_TERMS]; /**< of the distance that is still to go */
	double ms[GZ_LANDING_TERMS];  /**< of the time */
	double sigma[2]; /**< 68 % of landings are within sigma[0] + sigma[1] * distance, degrees */
};

/** Weights for trackers of more than 160 Hz, whose samples tell the speed, and for slower ones. */
struct gz_landing_model {
	struct gz_landing_weights fast[GZ_LANDING_BINS], slow[GZ_LANDING_BINS];
};

/** The fitted weights. */
extern const struct gz_landing_model gz_landing_model;

/** A point and its time. */
struct gz_landing_place {
	int64_t time_ns;
	double deg[3];
};

/** State of the prediction. Zero-initialised is the start state. */
struct gz_landing_state {
	struct gz_landing_place ring[GZ_LANDING_RING];
	uint64_t count; /**< points so far; the newest is at (count - 1) % GZ_LANDING_RING */
	bool running;   /**< a saccade runs, and it is known where it began */
	bool waiting;   /**< a saccade runs, and it is not known */
	int64_t begin_ns;
	double start_deg[3];
	struct gz_landing_look look;       /**< set if running */
	double whole_deg[GZ_LANDING_BINS]; /**< size that was predicted at each time; 0: it was not
					    */
	double longer[GZ_LANDING_BINS];    /**< by this share the person's saccades go farther */
};

/** One sample. */
struct gz_landing_input {
	enum gz_event event; /**< its label at once */
	int64_t time_ns;
	bool valid;            /**< whether point was measured */
	struct gz_point point; /**< without spikes, not smoothed */
};

/**
 * Take one sample.
 *
 * @return known if a saccade runs and this sample is good. Does not allocate
 */
struct gz_landing gz_landing_step(struct gz_landing_state *state,
				  const struct gz_landing_model *model,
				  const struct gz_display *display,
				  const struct gz_landing_input *input);

/** The numbers that are weighted, from what is known of a saccade. */
void gz_landing_terms(const struct gz_landing_look *look, double out_terms[GZ_LANDING_TERMS]);

/** The place among the weights for a time since the saccade was noticed. */
size_t gz_landing_bin(double elapsed_ms);

/** Whether the weights for slow trackers count. */
bool gz_landing_is_slow(double interval_ms);

#endif
