/**
 * @file
 * Between validation and the joining of the eyes: an affine correction of where a tracker says that
 * someone looks, as a check of the calibration finds it. The same for each eye's point and for the
 * common point, in normalised display coordinates.
 */
#ifndef GZ_FILTER_CORRECT_H
#define GZ_FILTER_CORRECT_H

#include <stdbool.h>

#include "protocol/gaze.h"

/** Settings; the presets leave every point where it is. */
struct gz_correct_params {
	double x[3]; /**< a b c of x' = a + b x + c y; a in display sides, b and c without unit */
	double y[3]; /**< a b c of y' = a + b x + c y, the same */
};

/** Least area that a unit of area may keep. Chosen: a correction by a tenth in each direction is
 *  already a tracker to calibrate anew. */
#define GZ_CORRECT_LEAST_AREA 0.01

/** Whether every number is finite and the map keeps two dimensions: an area shrinks to no less than
 *  GZ_CORRECT_LEAST_AREA of itself. */
bool gz_correct_usable(const struct gz_correct_params *params);

/** Correct one point; one that is not finite stays as it is. Presets change no bit of it. */
struct gz_point gz_correct_point(const struct gz_correct_params *params, struct gz_point point);

/** Correct the common point and both eyes' points of a sample in place. */
void gz_correct_step(const struct gz_correct_params *params, struct gz_sample *sample);

#endif
