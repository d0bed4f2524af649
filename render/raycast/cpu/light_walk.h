/**
 * @file
 * Steps towards the light on the processor: what the kernels read to find how much of it arrives at
 * a place, for either backend. struct gz_light has the formula.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_LIGHT_WALK_H
#define GZ_RENDER_RAYCAST_CPU_LIGHT_WALK_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/camera.h"
#include "render/raycast/cpu/cast.h"
#include "render/raycast/shared/lighting.h"
#include "render/raycast/shared/ray_params.h"

/** What the steps of one picture read. */
struct gz_light_walk {
	struct gz_cast cast; /**< of the full volume: its voxels, extinction and shadows alone */
	gz_cast_arriving_function *arriving;
	enum gz_voxel_type type;
	bool nearest;
};

/**
 * Fill in a walk.
 *
 * @param lighting  prepared for @p rays, which have shadows; with its volume and table
 * @param arriving  of one instruction set's kernels
 * @param ray_frame the picture's rays: the light may refer to the camera's axes
 * @param log       may be NULL
 * @param[out] out_walk  borrows what @p lighting holds, until it is prepared again
 * @retval GZ_ERR_UNSUPPORTED  the volume has more voxels than kernels can count; logged
 */
enum gz_result gz_light_walk_make(const struct gz_lighting *lighting,
				  gz_cast_arriving_function *arriving,
				  const struct gz_ray_params *rays,
				  const struct gz_ray_frame *ray_frame, const struct gz_log *log,
				  struct gz_light_walk *out_walk);

#endif
