/**
 * @file
 * The last picture with a ray for every pixel. While nothing but the gaze changes, the next such
 * picture is the same, so it is copied instead of being made of kept tiles.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_KEPT_PICTURE_H
#define GZ_RENDER_RECONSTRUCT_CPU_KEPT_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/workers.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"

/** Zero-initialised is empty. */
struct gz_kept_picture {
	struct gz_image image;
	uint64_t content; /**< number of what decides its rays besides the plan; 0: no picture */
};

/**
 * Copy the kept picture.
 *
 * @param content    as of gz_kept_tiles_begin()
 * @param[out] image of the plan's size; written on success only
 * @return whether the plan's picture is the kept one
 */
bool gz_kept_picture_take(const struct gz_kept_picture *kept, const struct gz_plan *plan,
			  uint64_t content, struct gz_workers *workers, struct gz_image *image);

/** Keep a picture if its plan has a ray of the scene's own step for every pixel. Without memory for
 *  it, nothing is kept. */
void gz_kept_picture_store(struct gz_kept_picture *kept, const struct gz_plan *plan,
			   uint64_t content, struct gz_workers *workers,
			   const struct gz_image *image);

/** Free the picture and zero the struct. */
void gz_kept_picture_free(struct gz_kept_picture *kept);

#endif
