/**
 * @file
 * Holding a frame against what is wanted, ray by ray: a pixel that a ray was cast for shows what
 * `standard` shows there with the same step, and pixels between rays nothing beyond those around
 * them. Not for users of bench/stability/.
 */
#ifndef GZ_BENCH_STABILITY_STABILITY_RAYS_H
#define GZ_BENCH_STABILITY_STABILITY_RAYS_H

#include "bench/stability/stability_bench.h"

/** One frame to check. */
struct gz_stability_check {
	const struct gz_stability_scene *scene;
	struct gz_stability_view view;
	struct gz_foveation foveation;
	struct gz_point gaze;
	const char *name; /**< of what is rendered, for reports */
	/** Hold all against one picture at this sampling rate, whatever step they were cast with;
	 *  0 = each against that of its own step. */
	double fine_rate;
	bool between; /**< those between rays too; only with fine_rate */
};

/**
 * Check a frame. Number 0 takes by how many grey levels a pixel is off, in the worst of all or, of
 * the gl backend or a scene of the user's, of 99.9 % of them: the share in which kernels may round
 * to either side. Number 1, where the outcome has it, takes the pixels that are brighter or darker
 * than all that is around them.
 */
enum gz_result gz_stability_check_rays(struct gz_stability_bench *bench,
				       const struct gz_stability_check *check,
				       struct gz_stability_outcome *outcome);

/** By every step rule in turn. */
enum gz_result gz_stability_check_rules(struct gz_stability_bench *bench,
					const struct gz_stability_check *check,
					struct gz_stability_outcome *outcome);

#endif
