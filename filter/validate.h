/**
 * @file
 * First step: which samples, and which eyes of a sample, may be believed. A pure step over a state;
 * the caller counts the reasons.
 */
#ifndef GZ_FILTER_VALIDATE_H
#define GZ_FILTER_VALIDATE_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Which eyes are used. A tracker that gives only a common point is used with any. */
enum gz_validate_eyes {
	GZ_VALIDATE_EYES_BOTH,
	GZ_VALIDATE_EYES_LEFT,
	GZ_VALIDATE_EYES_RIGHT,
};

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_validate_params {
	double margin;             /**< how far outside [0, 1] a point may lie, display sides */
	double max_velocity_deg_s; /**< faster than an eye turns, degrees a second */
	double jump_deg;           /**< a step this small is never too fast: noise, degrees */
	double max_disparity_deg;  /**< greatest angle between the two eyes' points, degrees */
	double min_confidence;     /**< [0, 1]; below it an eye is not used */
	int eyes;                  /**< enum gz_validate_eyes */
};

/** What validity is judged against: the right eye, the left eye, the common point. */
enum { GZ_VALIDATE_PLACES = GZ_EYE_COUNT + 1 };

/** Newest good place of an eye or of the common point. */
struct gz_validate_place {
	bool known; /**< whether the rest holds something */
	int64_t time_ns;
	struct gz_point point;
};

/** Zero-initialised is the start state. */
struct gz_validate_state {
	bool started;           /**< whether time_ns holds something */
	int64_t time_ns;        /**< of the newest sample, good or not */
	double disparity_mm[2]; /**< slow mean of left minus right on the display, mm */
	struct gz_validate_place place[GZ_VALIDATE_PLACES];
};

/** What may be used of a sample. */
struct gz_validate_output {
	enum gz_rejection rejection; /**< NONE if at least one eye or the common point is good */
	bool combined;               /**< use the common point; the eyes were not measured */
	bool eye_good[GZ_EYE_COUNT]; /**< use this eye */
};

/**
 * Judge one sample.
 *
 * An eye is good if the tracker says so, its confidence is not below the limit (NaN is not
 * measured, and passes), its point is finite and on the display but for the margin, and not farther
 * from its last good one than max_velocity_deg_s allows for the time between, plus jump_deg: after
 * a real jump it is believed again within milliseconds. Two good eyes must not disagree by more
 * than max_disparity_deg beyond their usual disparity, which is learnt over a second also where it
 * is too large, so that a badly calibrated tracker is not refused for ever. Where neither eye's
 * point was measured the common point is judged in the same way.
 *
 * An eye that is not to be used is as one that is not there.
 *
 * The reason told is of the eye that came farthest in the order tracker, confidence, not_finite,
 * off_screen, velocity.
 *
 * @param state    a sample not newer than the last, before 0 or after INT64_MAX / 2, which no clock
 *                 reaches (GZ_REJECT_TIME), leaves it as it was
 * @param display  valid
 */
struct gz_validate_output gz_validate_step(struct gz_validate_state *state,
					   const struct gz_validate_params *params,
					   const struct gz_display *display,
					   const struct gz_sample *sample);

#endif
