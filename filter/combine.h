/**
 * @file
 * Second step: one point from two eyes. The mean of both weighted by their noise; when one drops
 * out the other goes on with the offset learnt while both were there, so that the point does not
 * jump.
 */
#ifndef GZ_FILTER_COMBINE_H
#define GZ_FILTER_COMBINE_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "filter/validate.h"
#include "protocol/gaze.h"

/** Settings; presets and sources stand in pipeline_options.c. */
struct gz_combine_params {
	double offset_ms; /**< time constant of learning each eye's offset, ms */
	double noise_ms;  /**< time constant of learning each eye's noise, ms */
};

/** What is learnt of one eye. */
struct gz_combine_eye {
	bool seen;             /**< whether point and time_ns hold something */
	struct gz_point point; /**< its newest good point */
	int64_t time_ns;
	double offset[2];          /**< to add to its points, display sides */
	struct gz_median step_deg; /**< sample-to-sample step, degrees: its noise */
};

/** Zero-initialised is the start state. */
struct gz_combine_state {
	struct gz_combine_eye eye[GZ_EYE_COUNT];
};

/**
 * Join the good eyes of a sample.
 *
 * @param sample  passed gz_validate_step() with GZ_REJECT_NONE
 * @param valid   what it answered
 * @param[out] out_point  always finite; the common point where only that was measured
 * @param[out] out_confidence  mean of the used eyes' confidences; 1 where none is measured
 */
void gz_combine_step(struct gz_combine_state *state, const struct gz_combine_params *params,
		     const struct gz_display *display, const struct gz_sample *sample,
		     const struct gz_validate_output *valid, struct gz_point *out_point,
		     float *out_confidence);

#endif
