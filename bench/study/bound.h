/**
 * @file
 * The acuity bound: what share of a picture's pixels need a ray at all for the eye not to see the
 * difference.
 */
#ifndef GZ_BENCH_STUDY_BOUND_H
#define GZ_BENCH_STUDY_BOUND_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/study.h"

/**
 * The share of a picture's pixels: the mean of 1 / s^2, where s is the spacing that the eye
 * resolves, gz_acuity_spacing_px() with the default acuity, at least 1 px. The mean is taken over
 * places at most 1/256 of the picture apart.
 *
 * @param display  geometry of the picture, which fills it
 */
double gz_bound_rays(const struct gz_display *display, struct gz_point gaze, int width, int height);

/** Fill a study's bound_rays. GZ_ERR_NO_MEM: logged. */
enum gz_result gz_bound_rays_make(struct gz_study *study, const struct gz_log *log);

#endif
