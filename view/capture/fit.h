/**
 * @file
 * Pictures of one size made to fit another, as a video needs of a window that is resized.
 */
#ifndef GZ_VIEW_CAPTURE_FIT_H
#define GZ_VIEW_CAPTURE_FIT_H

#include "base/result.h"
#include "render/picture/image.h"

/** Room for gz_image_fit(), kept from picture to picture; zero-initialised is empty. */
struct gz_image_fit {
	struct gz_image scaled;
};

/**
 * Copy @p source into @p target, whose size stays: as it is where the sizes are the same, else
 * scaled as far as it fits, its shape kept, in the middle of black.
 *
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_image_fit(struct gz_image_fit *fit, const struct gz_image *source,
			    struct gz_image *target);

/** Free what it holds and zero it. */
void gz_image_fit_free(struct gz_image_fit *fit);

#endif
