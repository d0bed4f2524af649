#include "render/raycast/shared/voxel_rays.h"

void gz_voxel_rays_make(const struct gz_volume *volume, const struct gz_ray_frame *world,
			struct gz_voxel_rays *out_rays)
{
	double half[3];
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++) {
		const double per_world = volume->dims[axis] / (2 * half[axis]);
		struct gz_ray_frame *frame = &out_rays->frame;
		out_rays->world_per_voxel[axis] = 1 / per_world;
		frame->origin00[axis] = (world->origin00[axis] + half[axis]) * per_world;
		frame->origin_dx[axis] = world->origin_dx[axis] * per_world;
		frame->origin_dy[axis] = world->origin_dy[axis] * per_world;
		frame->direction00[axis] = world->direction00[axis] * per_world;
		frame->direction_dx[axis] = world->direction_dx[axis] * per_world;
		frame->direction_dy[axis] = world->direction_dy[axis] * per_world;
	}
}
