/**
 * @file
 * Rays in the coordinates that kernels take them in: voxel i along an axis spans [i, i + 1), its
 * datum sits at i + 1/2.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_VOXEL_RAYS_H
#define GZ_RENDER_RAYCAST_SHARED_VOXEL_RAYS_H

#include "render/data/volume.h"
#include "render/picture/camera.h"

/** A picture's rays through a volume. */
struct gz_voxel_rays {
	struct gz_ray_frame frame; /**< in voxel coordinates */
	double world_per_voxel[3]; /**< to measure lengths along them in world units */
};

/** Turn the rays of a camera into those of a volume. */
void gz_voxel_rays_make(const struct gz_volume *volume, const struct gz_ray_frame *world,
			struct gz_voxel_rays *out_rays);

#endif
