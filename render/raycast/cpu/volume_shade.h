/**
 * @file
 * What a volume keeps back of the light on its way to others in the picture, for either backend.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_VOLUME_SHADE_H
#define GZ_RENDER_RAYCAST_CPU_VOLUME_SHADE_H

#include "base/log.h"
#include "base/result.h"
#include "render/raycast/cpu/light_walk.h"
#include "render/technique/shade.h"

/** What the steps of a shade read. It stays where it is as long as the shade is used. */
struct gz_volume_shade {
	struct gz_light_walk walk;
	/** From the world to voxels counted from the first datum: at * scale + bias. */
	float scale[3], bias[3];
	struct gz_clip_bounds shown; /**< the clip region, counted from the first datum */
	float lengths_per_world;     /**< voxel lengths of a world unit */
};

/**
 * Make the shade of a volume: struct gz_light has the formula of the steps, which begin where the
 * way to the light enters the clip region, and no nearer than GZ_SHADOW_START.
 *
 * @param lighting, arriving, rays, ray_frame, log  as for gz_light_walk_make()
 * @param[out] shade      what @p out_shade reads; borrows what @p lighting holds
 * @param[out] out_shade  borrows @p shade
 * @return what gz_light_walk_make() returns
 */
enum gz_result gz_volume_shade_make(const struct gz_lighting *lighting,
				    gz_cast_arriving_function *arriving,
				    const struct gz_ray_params *rays,
				    const struct gz_ray_frame *ray_frame, const struct gz_log *log,
				    struct gz_volume_shade *shade, struct gz_shade *out_shade);

#endif
