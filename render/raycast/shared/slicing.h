/**
 * @file
 * How the technique slices cuts a volume: section [slices] of a scene.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_SLICING_H
#define GZ_RENDER_RAYCAST_SHARED_SLICING_H

#include <stddef.h>

#include "base/option.h"

/** Most slices of a volume. Chosen: four through each voxel of a volume of 1024, which is the limit
 *  up to which more of them still change pictures. */
#define GZ_SLICES_MAX 4096

/** How a volume is cut. What the slices show is chosen by struct gz_ray_params. */
struct gz_slicing {
	int count; /**< slices from the nearest to the farthest corner of the box, 1 to
		      GZ_SLICES_MAX */
};

/** Table over struct gz_slicing: "slices.…". */
extern const struct gz_option gz_slicing_options[];
extern const size_t gz_slicing_option_count;

#endif
