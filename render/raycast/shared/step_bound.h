/**
 * @file
 * How far steps along rays may grow away from the gaze: what longer steps change of one volume and
 * its transfer function (step_errors.h), measured when a plan first asks for it, and kept.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_STEP_BOUND_H
#define GZ_RENDER_RAYCAST_SHARED_STEP_BOUND_H

#include <stdbool.h>

#include "base/log.h"
#include "render/data/volume.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/raycast/shared/step_errors.h"
#include "render/transfer/transfer.h"

/** What was measured, and of what. Zero-initialised is nothing. */
struct gz_step_bound {
	struct gz_ray_values values; /**< of the volume; may be empty */
	bool values_nearest;
	struct gz_step_errors errors;
	bool errors_hold;            /**< for the values and this function: */
	struct gz_transfer function; /**< without emphasis */
};

/** There is another volume, or its data have changed. */
void gz_step_bound_forget_volume(struct gz_step_bound *bound);

/** Take @p function, copied. What it emphasises does not count: steps would change while that
 *  fades. */
void gz_step_bound_set_function(struct gz_step_bound *bound, const struct gz_transfer *function);

/**
 * Let a plan take longer steps only where they change little: set its step_growth. It stays as it
 * is where steps do not grow by what the eye resolves, where foveation.acuity_step_error is 1, for
 * volumes of bricks or of more than 4 GiB, and where too few rays see something.
 *
 * @param volume  the one of the last call, unless gz_step_bound_forget_volume() was called
 * @param log     gets a warning if memory to measure is missing
 * @return        time that it took to measure, ms; 0 where it was known
 *
 * Threads: one at a time for each @p bound.
 */
double gz_step_bound_plan(struct gz_step_bound *bound, const struct gz_volume *volume,
			  const struct gz_ray_params *rays, const struct gz_log *log,
			  struct gz_plan_request *request);

/** Free and zero. */
void gz_step_bound_free(struct gz_step_bound *bound);

#endif
