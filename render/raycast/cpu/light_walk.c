#include "render/raycast/cpu/light_walk.h"

#define GZ_LOG_MODULE "render"

enum gz_result gz_light_walk_make(const struct gz_lighting *lighting,
				  gz_cast_arriving_function *arriving,
				  const struct gz_ray_params *rays,
				  const struct gz_ray_frame *ray_frame, const struct gz_log *log,
				  struct gz_light_walk *out_walk)
{
	static const int full[3] = { 1, 1, 1 };
	const struct gz_volume *volume = lighting->volume;
	const struct gz_transfer_table *table = lighting->table;
	if (gz_volume_voxel_count(volume) > INT32_MAX) {
		gz_err(log,
		       "shadows in a volume of %d x %d x %d voxels are beyond the 2^31 that "
		       "processors count: set light.shadow_steps to 0",
		       volume->dims[0], volume->dims[1], volume->dims[2]);
		return GZ_ERR_UNSUPPORTED;
	}
	*out_walk = (struct gz_light_walk) {
		.arriving = arriving,
		.type = volume->type,
		.nearest = gz_ray_samples_nearest(rays, volume),
	};
	struct gz_cast *cast = &out_walk->cast;
	gz_cast_fill_voxels(volume, cast);
	gz_cast_fill_table(table, cast);
	gz_lighting_fill(lighting, full, rays, ray_frame, &cast->light);
	return GZ_OK;
}
