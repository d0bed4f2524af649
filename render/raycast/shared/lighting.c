#include "render/raycast/shared/lighting.h"

#include <string.h>

#include "render/light/light.h"

#define GZ_LOG_MODULE "render"

void gz_lighting_forget(struct gz_lighting *lighting)
{
	lighting->current = false;
}

static bool wants_occlusion(const struct gz_ray_params *rays)
{
	return rays->shading == GZ_SHADING_GRADIENT && rays->light.occlusion > 0 &&
	       rays->light.ambient > 0;
}

enum gz_result gz_lighting_prepare(struct gz_lighting *lighting, const struct gz_volume *volume,
				   const struct gz_transfer_table *table,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log)
{
	const double radius = rays->light.occlusion_radius;
	lighting->volume = volume;
	lighting->table = table;
	if (!wants_occlusion(rays))
		return GZ_OK;
	if (volume->bricks) {
		gz_err(log, "ambient occlusion reads all voxels, but a volume of bricks is not "
			    "wholly in memory: set light.occlusion to 0");
		return GZ_ERR_UNSUPPORTED;
	}
	if (lighting->current && lighting->radius == radius &&
	    gz_clip_box_same(&lighting->clip, &rays->clip))
		return GZ_OK;
	lighting->current = false;
	const enum gz_result result = gz_occlusion_make(volume, table, radius, &rays->clip, workers,
							&lighting->occlusion);
	if (result != GZ_OK) {
		gz_err(log, "no memory for ambient occlusion: set light.occlusion to 0");
		return result;
	}
	lighting->radius = radius;
	lighting->clip = rays->clip;
	lighting->current = true;
	return GZ_OK;
}

static void fill_occlusion(const struct gz_occlusion *occlusion, const int factor[3],
			   struct gz_cast_light *light)
{
	const int *dims = occlusion->dims;
	const int32_t strides[3] = { 1, dims[0], dims[0] * dims[1] };
	light->cells = occlusion->cells;
	for (int axis = 0; axis < 3; axis++) {
		/* The first datum lies half a voxel in, the first cell's middle half a cell. */
		const double scale = (double)factor[axis] / occlusion->edge[axis];
		light->cell_scale[axis] = (float)scale;
		light->cell_bias[axis] = (float)(0.5 * scale - 0.5);
		light->cell_greatest[axis] = (float)(dims[axis] - 1);
		light->cell_last[axis] = dims[axis] > 1 ? dims[axis] - 2 : 0;
		light->cell_stride[axis] = dims[axis] > 1 ? strides[axis] : 0;
	}
}

void gz_lighting_fill(const struct gz_lighting *lighting, const int factor[3],
		      const struct gz_ray_params *rays, const struct gz_ray_frame *ray_frame,
		      struct gz_cast_light *out_light)
{
	const struct gz_light *light = &rays->light;
	double towards[3], scale[3];
	gz_light_direction(light, ray_frame, towards);
	gz_light_gradient_scale(lighting->volume, lighting->table, scale);
	*out_light = (struct gz_cast_light) {
		.on = rays->shading == GZ_SHADING_GRADIENT,
		.ambient = (float)light->ambient,
		.diffuse = (float)light->diffuse,
		.specular = (float)light->specular,
		.shininess = (float)light->shininess,
		.occlusion = (float)light->occlusion,
	};
	for (int axis = 0; axis < 3; axis++) {
		out_light->towards[axis] = (float)towards[axis];
		out_light->gradient_scale[axis] = (float)(scale[axis] / factor[axis]);
	}
	if (wants_occlusion(rays))
		fill_occlusion(&lighting->occlusion, factor, out_light);
}

void gz_lighting_free(struct gz_lighting *lighting)
{
	gz_occlusion_free(&lighting->occlusion);
	*lighting = (struct gz_lighting) { 0 };
}
