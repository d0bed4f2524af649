/**
 * @file
 * Second step: one point from two eyes.
 *
 * First an affine correction of the points, as a check of the calibration finds it: the same for
 * each eye's point and for the common point, in normalised display coordinates.
 *
 * Then the mean of both eyes, weighted by their noise. If one eye drops out, the other continues
 * with the offset that was learnt while both were there, so that the point does not jump.
 */
#ifndef GZ_FILTER_COMBINE_H
#define GZ_FILTER_COMBINE_H

#include <stdbool.h>
#include <stdint.h>

#include "filter/median.h"
#include "filter/validate.h"
#include "protocol/gaze.h"

/** Settings of the correction. The presets change no point. */
struct gz_correct_params {
	double x[3]; /**< a b c of x' = a + b x + c y; a in display sides, b and c without unit */
	double y[3]; /**< a b c of y' = a + b x + c y, the same */
};

/** Least area that a correction may leave of a unit area. Chosen: a tracker that needs a correction
 *  by a tenth in each direction should be calibrated again. */
#define GZ_CORRECT_LEAST_AREA 0.01

/** Whether every number is finite and the map keeps two dimensions: it shrinks an area to no less
 *  than GZ_CORRECT_LEAST_AREA of it. */
bool gz_correct_usable(const struct gz_correct_params *params);

/** Correct one point. A point that is not finite stays as it is. The presets change no bit. */
struct gz_point gz_correct_point(const struct gz_correct_params *params, struct gz_point point);

/** Correct the common point and both eyes' points of a sample in place. */
void gz_correct_step(const struct gz_correct_params *params, struct gz_sample *sample);

/** Settings of the mean. pipeline_options.c has the presets and their sources. */
struct gz_combine_params {
	double offset_ms; /**< time constant for learning each eye's offset, ms */
	double noise_ms;  /**< time constant for learning each eye's noise, ms */
};

/** What has been learnt about one eye. */
struct gz_combine_eye {
	bool seen;             /**< whether point and time_ns are set */
	struct gz_point point; /**< its newest good point */
	int64_t time_ns;
	double offset[2];          /**< is added to its points, display sides */
	struct gz_median step_deg; /**< its noise: the sample-to-sample step, degrees */
};

/** State of this step. Zero-initialised is the start state. */
struct gz_combine_state {
	struct gz_combine_eye eye[GZ_EYE_COUNT];
};

/** The result of this step. */
struct gz_combine_output {
	struct gz_point point; /**< always finite; the common point if only that was measured */
	float confidence;      /**< mean of the used eyes' confidences; 1 if none was measured */
};

/**
 * Combine the good eyes of a sample.
 *
 * @param sample  gz_validate_step() answered GZ_REJECT_NONE
 * @param valid   the rest of its answer
 */
struct gz_combine_output gz_combine_step(struct gz_combine_state *state,
					 const struct gz_combine_params *params,
					 const struct gz_display *display,
					 const struct gz_sample *sample,
					 const struct gz_validate_output *valid);

#endif
