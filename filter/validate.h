/**
 * @file
 * First step: decide which samples, and which eyes of a sample, are plausible. A pure step over a
 * state; the caller counts the reasons of rejections.
 */
#ifndef GZ_FILTER_VALIDATE_H
#define GZ_FILTER_VALIDATE_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Which eyes are used. If a tracker gives only a common point, that is used in any case. */
enum gz_validate_eyes {
	GZ_VALIDATE_EYES_BOTH,
	GZ_VALIDATE_EYES_LEFT,
	GZ_VALIDATE_EYES_RIGHT,
};

/** Settings. pipeline_options.c has the presets and their sources. */
struct gz_validate_params {
	double margin;             /**< how far outside [0, 1] a point may be, display sides */
	double max_velocity_deg_s; /**< greatest speed of an eye, degrees per second */
	double jump_deg; /**< a step up to this size, which may be noise, is never too fast, degrees
			  */
	double max_disparity_deg; /**< greatest angle between the eyes' points beyond their usual
				     one, degrees */
	double min_confidence;    /**< [0, 1]; an eye with less is not used */
	int eyes;                 /**< enum gz_validate_eyes */
};

/** Number of points that are judged: of the right eye, of the left eye, and the common one. */
enum { GZ_VALIDATE_PLACES = GZ_EYE_COUNT + 1 };

/** The newest good point of an eye, or the newest good common point. */
struct gz_validate_place {
	bool known; /**< whether the other fields are set */
	int64_t time_ns;
	struct gz_point point;
};

/** State of this step. Zero-initialised is the start state. */
struct gz_validate_state {
	bool started;           /**< whether time_ns is set */
	int64_t time_ns;        /**< of the newest sample, good or not */
	double disparity_mm[2]; /**< slow mean of left minus right point on the display, mm */
	struct gz_validate_place place[GZ_VALIDATE_PLACES];
};

/** What of a sample can be used. */
struct gz_validate_output {
	enum gz_rejection rejection; /**< NONE if an eye or the common point is good */
	bool combined;               /**< use the common point: the eyes were not measured */
	bool eye_good[GZ_EYE_COUNT]; /**< use this eye */
};

/**
 * Judge one sample.
 *
 * An eye is good if all of this holds: the tracker reports it as valid; its confidence is not below
 * the limit (a NaN, which was not measured, passes); its point is finite and within the margin
 * around the display; and its distance from the eye's last good point is at most what
 * max_velocity_deg_s allows for the time between, plus jump_deg. So after a real jump the eye is
 * good again within milliseconds.
 *
 * Two good eyes must not disagree by more than max_disparity_deg beyond their usual disparity. The
 * usual disparity is learnt over one second, also from samples that are rejected, so that a badly
 * calibrated tracker is not rejected for ever.
 *
 * If the tracker measured the point of neither eye, the common point is judged in the same way. An
 * eye that the settings exclude is treated as missing.
 *
 * The reason of a rejection is that of the eye that passed most checks. They are made in the order
 * tracker, confidence, not_finite, off_screen, velocity.
 *
 * @param state    unchanged if the sample's time is not newer than the last one's, before 0 or
 * after INT64_MAX / 2, which no clock reaches (GZ_REJECT_TIME)
 * @param display  passes gz_display_valid()
 */
struct gz_validate_output gz_validate_step(struct gz_validate_state *state,
					   const struct gz_validate_params *params,
					   const struct gz_display *display,
					   const struct gz_sample *sample);

#endif
