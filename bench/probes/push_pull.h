/**
 * @file
 * Push-pull reconstruction, to compare with: Gortler, Grzeszczuk, Szeliski and Cohen, "The
 * Lumigraph", 1996, section 5.3.
 */
#ifndef GZ_BENCH_PROBES_PUSH_PULL_H
#define GZ_BENCH_PROBES_PUSH_PULL_H

#include "base/workers.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"

/** Levels: the coarsest has one point for 64 pixels each way. */
#define GZ_PUSH_PULL_LEVELS 7

/** Zero-initialised is empty; keep it from picture to picture. */
struct gz_push_pull {
	struct gz_push_pull_level {
		int width, height;
		float (*points)[4]; /**< red, green, blue and how sure, [0, 1] */
	} levels[GZ_PUSH_PULL_LEVELS];
};

/** Make room and take the pixels of @p image that @p plan casts. GZ_ERR_NO_MEM. */
enum gz_result gz_push_pull_take(struct gz_push_pull *push_pull, const struct gz_plan *plan,
				 const struct gz_image *image);

/** Fill all other pixels of @p image: means of what is known, fine to coarse, then what is not
 *  known, coarse to fine, from the four nearest of the next coarser level. */
void gz_push_pull_fill(struct gz_push_pull *push_pull, struct gz_workers *workers,
		       struct gz_image *image);

/** Free and zero. */
void gz_push_pull_free(struct gz_push_pull *push_pull);

#endif
