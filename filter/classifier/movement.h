/**
 * @file
 * Numbers that describe how an eye moves, for the forests that label its movement (forest.h): one
 * row of features for each sample, from this sample and earlier ones.
 *
 * Every window is a time, so the features mean the same at 30 and at 2000 Hz. Between samples the
 * eye is taken to move along a straight line; samples that are closer than SMOOTH_US
 * (movement.c) are averaged. Sums over windows are differences of running integer sums, which are
 * exact however long the recording is. The rest uses only + - * / and sqrt, which round in the same
 * way on every machine.
 */
#ifndef GZ_FILTER_CLASSIFIER_MOVEMENT_H
#define GZ_FILTER_CLASSIFIER_MOVEMENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/display.h"

/** Samples that are kept: the longest window at 2000 Hz. At a higher rate it becomes shorter. A
 *  power of two. */
#define GZ_MOVEMENT_RING 1024

/** Number of times to which the features look back. */
#define GZ_MOVEMENT_LOOKS 12

/** Number of features of a sample. */
#define GZ_MOVEMENT_FEATURES 101

/** Names of the features, in their order, with the unit where there is one. */
extern const char *const gz_movement_feature_names[GZ_MOVEMENT_FEATURES];

/** One sample, and the running sums up to it. Sums are modulo 2^64; only differences are used. */
struct gz_movement_entry {
	int64_t time_us;     /**< since the first sample */
	bool valid;          /**< whether place was measured */
	int64_t measured[2]; /**< as measured, units of 1e-4 degrees, right and down */
	int64_t place[2];    /**< averaged over SMOOTH_US; the last one if nothing was measured */
	uint64_t count;      /**< measured samples */
	uint64_t sum[2];     /**< of their places */
	uint64_t squares;    /**< of their places' squares, both axes */
	uint64_t time_sum, time_squares; /**< of their times */
	uint64_t time_place[2];          /**< of the products of time and place */
	uint64_t path;                   /**< length of the way, 1e-4 degrees */
	uint64_t lost_us;                /**< time without a measurement */
};

/** Fast movement: a saccade, or a lid. */
struct gz_movement_burst {
	bool any;         /**< whether the other fields are set */
	int64_t start_us; /**< of its first fast sample */
	int64_t end_us;   /**< of its newest fast sample */
	int64_t peak_us;
	double peak_deg_s;
	double heading[2]; /**< direction at the peak, unit vector */
	double from[2];    /**< place at its start, degrees */
	double to[2];      /**< place at its newest fast sample, degrees */
};

/** Slow movement since a burst or loss. */
struct gz_movement_stretch {
	bool any;            /**< whether it has begun: the ringing after a burst is over */
	uint64_t first;      /**< its first sample */
	double slope[2];     /**< velocity of the straight line through its samples, deg/s */
	double residual_deg; /**< root mean square distance from that line */
	double lasted_ms;    /**< time between its first and newest sample, within the window */
};

/** Running mean over the last seconds. */
struct gz_movement_mean {
	double lost;       /**< fraction of time without a measurement */
	double bursts_s;   /**< bursts per second */
	double slow_deg_s; /**< speed of the slow movement */
};

/** Running means with two time constants. */
enum { GZ_MOVEMENT_MEANS = 2 };

/** Where slow movement has been going lately, across the fast ones: its mean velocity. What goes to
 *  and fro is nothing. */
struct gz_movement_flow {
	double slow_deg_s[2];
};

/** Flows with two time constants. */
enum { GZ_MOVEMENT_FLOWS = 2 };

/** State. Zero-initialised is the start state. Plain data. */
struct gz_movement {
	struct gz_movement_entry ring[GZ_MOVEMENT_RING];
	uint64_t count;   /**< samples taken; sample i is ring[i % GZ_MOVEMENT_RING] */
	int64_t start_ns; /**< time of the first sample */
	bool any_valid;
	int64_t valid_us;               /**< time of the newest measured sample */
	int64_t lost_us;                /**< time of the newest sample that was not measured */
	int64_t loss_begin_us, loss_ms; /**< begin and duration of the newest loss */
	bool any_lost, losing;
	uint64_t cursor[GZ_MOVEMENT_LOOKS]; /**< newest sample at least so long ago */
	double noise_deg_s;                 /**< running median of the speed outside bursts */
	double noise_count;                 /**< numbers in that median */
	struct gz_movement_burst burst;
	struct gz_movement_stretch stretch;
	struct gz_movement_stretch last_stretch; /**< the one before the newest burst */
	struct gz_movement_mean mean[GZ_MOVEMENT_MEANS];
	struct gz_movement_flow flow[GZ_MOVEMENT_FLOWS];
};

/** One sample. */
struct gz_movement_input {
	int64_t time_ns;       /**< newer than that of the last sample */
	bool valid;            /**< whether point was measured and is plausible */
	struct gz_point point; /**< ignored unless valid */
};

/**
 * Take one sample.
 *
 * @param display  passes gz_display_valid()
 * @param[out] out_features  GZ_MOVEMENT_FEATURES of them, all finite; all zero before the first
 *                           valid sample. NULL: not wanted
 * @return whether there was a valid sample so far
 *
 * Does not allocate.
 */
bool gz_movement_step(struct gz_movement *state, const struct gz_display *display,
		      const struct gz_movement_input *input, float *out_features);

#endif
