#include "render/raycast/shared/lighting.h"

#include <math.h>

#include "base/clock.h"
#include "base/vector.h"
#include "render/light/light.h"
#include "render/light/light_constants.h"

#define GZ_LOG_MODULE "render"

void gz_lighting_forget(struct gz_lighting *lighting)
{
	lighting->current = false;
	lighting->shadows_current = false;
}

bool gz_lighting_wants_occlusion(const struct gz_ray_params *rays)
{
	return rays->shading == GZ_SHADING_GRADIENT && rays->light.occlusion > 0 &&
	       rays->light.ambient > 0;
}

static enum gz_result prepare_occlusion(struct gz_lighting *lighting,
					const struct gz_ray_params *rays,
					struct gz_workers *workers, const struct gz_log *log)
{
	const double radius = rays->light.occlusion_radius;
	if (lighting->volume->bricks) {
		gz_err(log, "ambient occlusion reads all voxels, but a volume of bricks is not "
			    "wholly in memory: set light.occlusion to 0");
		return GZ_ERR_UNSUPPORTED;
	}
	if (lighting->current && lighting->radius == radius &&
	    gz_clip_region_same(&lighting->clip, &rays->clip))
		return GZ_OK;
	lighting->current = false;
	const int64_t start_ns = gz_clock_now_ns();
	const enum gz_result result = gz_occlusion_make(lighting->volume, lighting->table, radius,
							&rays->clip, workers, &lighting->occlusion);
	lighting->spent_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	if (result != GZ_OK) {
		gz_err(log, "no memory for ambient occlusion: set light.occlusion to 0");
		return result;
	}
	lighting->radius = radius;
	lighting->clip = rays->clip;
	lighting->current = true;
	lighting->serial++;
	return GZ_OK;
}

static enum gz_result prepare_shadows(struct gz_lighting *lighting,
				      const struct gz_ray_params *rays, struct gz_workers *workers,
				      const struct gz_log *log)
{
	if (lighting->volume->bricks) {
		gz_err(log, "shadows read all voxels, but a volume of bricks is not wholly in "
			    "memory: set light.shadow_steps to 0");
		return GZ_ERR_UNSUPPORTED;
	}
	if (lighting->shadows_current && gz_clip_region_same(&lighting->shadow_clip, &rays->clip))
		return GZ_OK;
	lighting->shadows_current = false;
	const int64_t start_ns = gz_clock_now_ns();
	const enum gz_result result = gz_shadow_cells_make(
		lighting->volume, lighting->table, &rays->clip, workers, &lighting->shadows);
	lighting->spent_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	if (result != GZ_OK) {
		gz_err(log, "no memory for shadows: set light.shadow_steps to 0");
		return result;
	}
	lighting->shadow_clip = rays->clip;
	lighting->shadows_current = true;
	lighting->shadow_serial++;
	return GZ_OK;
}

enum gz_result gz_lighting_prepare(struct gz_lighting *lighting, const struct gz_volume *volume,
				   const struct gz_transfer_table *table,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	lighting->volume = volume;
	lighting->table = table;
	if (gz_lighting_wants_occlusion(rays))
		result = prepare_occlusion(lighting, rays, workers, log);
	if (result == GZ_OK && rays->light.shadow_steps > 0)
		result = prepare_shadows(lighting, rays, workers, log);
	return result;
}

double gz_lighting_take_spent_ms(struct gz_lighting *lighting)
{
	const double spent_ms = lighting->spent_ms;
	lighting->spent_ms = 0;
	return spent_ms;
}

void gz_cast_cells_fill(const uint16_t *cells, const int dims[3], const int edge[3],
			const int factor[3], struct gz_cast_cells *out_cells)
{
	const int32_t strides[3] = { 1, dims[0], dims[0] * dims[1] };
	out_cells->cells = cells;
	for (int axis = 0; axis < 3; axis++) {
		/* The first datum lies half a voxel in, the first cell's middle half a cell. */
		const double scale = (double)factor[axis] / edge[axis];
		out_cells->scale[axis] = (float)scale;
		out_cells->bias[axis] = (float)(0.5 * scale - 0.5);
		out_cells->greatest[axis] = (float)(dims[axis] - 1);
		out_cells->last[axis] = dims[axis] > 1 ? dims[axis] - 2 : 0;
		out_cells->stride[axis] = dims[axis] > 1 ? strides[axis] : 0;
	}
}

static void fill_shadow_levels(const struct gz_shadow_cells *shadows, const int factor[3],
			       struct gz_cast_shadow *shadow)
{
	shadow->levels = shadows->count;
	for (int i = 0; i < shadows->count; i++) {
		const struct gz_shadow_level *level = &shadows->level[i];
		gz_cast_cells_fill(shadows->cells + level->first, level->dims, level->edge, factor,
				   &shadow->level[i]);
		shadow->kept_per_length[i] = 1.0F / (float)(GZ_SHADOW_UNIT * (2 << i));
	}
}

/* Where they leave the kept side of the clip plane, for one voxel length towards the light. A light
 * in the plane, but for rounding, is in front of no place. */
static void fill_exit_plane(const struct gz_clip_bounds *clip, const double step[3],
			    struct gz_cast_shadow *shadow)
{
	const double nearing = gz_dot3(clip->plane, step);
	const bool faces = nearing > 1e-9;
	for (int i = 0; i < 4; i++)
		shadow->exit_plane[i] = faces ? (float)(clip->plane[i] / nearing) : 0;
	if (!faces)
		shadow->exit_plane[3] = 3e38F;
}

/* Where steps towards the light go, for a light's direction in the world. */
static void fill_shadow(const struct gz_volume *volume, const int factor[3],
			const struct gz_ray_params *rays, const double towards[3],
			struct gz_cast_shadow *shadow)
{
	static const double first_datum[3] = { -0.5, -0.5, -0.5 };
	double half[3], box[3], steps[3], through = INFINITY;
	const double voxel_length = gz_volume_voxel_length(volume);
	struct gz_clip_bounds clip;
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++)
		box[axis] = (double)volume->dims[axis] / factor[axis];
	gz_clip_region_place(&rays->clip, volume, box, first_datum, &clip);
	for (int axis = 0; axis < 3; axis++) {
		const double raw = towards[axis] * voxel_length * box[axis] / (2 * half[axis]);
		const double step = fabs(raw) < 1e-9 ? 1e-9 : raw;
		steps[axis] = raw;
		shadow->towards[axis] = (float)step;
		shadow->inverse[axis] = (float)(1 / step);
		shadow->exit[axis] = (float)(step > 0 ? clip.greatest : clip.least)[axis];
		through = fmin(through, box[axis] / fabs(step));
	}
	fill_exit_plane(&clip, steps, shadow);
	shadow->steps = rays->light.shadow_steps;
	shadow->reach =
		(float)fmax(fmin(rays->light.shadow_reach, through), (double)GZ_SHADOW_START);
}

void gz_cast_light_polish(double shininess, struct gz_cast_light *out_light)
{
	out_light->shininess = (float)shininess;
	out_light->whole_shininess = shininess == floor(shininess) ? (int)shininess : 0;
	/* A power of 2^-64 is no denormal number, which would be slow. */
	out_light->least_cosine = (float)exp2(-64 / shininess);
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
		.on = gz_ray_params_lit(rays),
		.gradient = rays->shading == GZ_SHADING_GRADIENT,
		.ambient = (float)light->ambient,
		.diffuse = (float)light->diffuse,
		.specular = (float)light->specular,
		.reflection = (float)light->reflection,
		.occlusion = (float)light->occlusion,
	};
	gz_cast_light_polish(light->shininess, out_light);
	for (int axis = 0; axis < 3; axis++) {
		out_light->towards[axis] = (float)towards[axis];
		out_light->gradient_scale[axis] = (float)(scale[axis] / factor[axis]);
	}
	if (gz_lighting_wants_occlusion(rays))
		gz_cast_cells_fill(lighting->occlusion.cells, lighting->occlusion.dims,
				   lighting->occlusion.edge, factor, &out_light->occluded);
	if (light->shadow_steps > 0) {
		fill_shadow(lighting->volume, factor, rays, towards, &out_light->shadow);
		fill_shadow_levels(&lighting->shadows, factor, &out_light->shadow);
	}
}

void gz_lighting_free(struct gz_lighting *lighting)
{
	gz_occlusion_free(&lighting->occlusion);
	gz_shadow_cells_free(&lighting->shadows);
	*lighting = (struct gz_lighting) { 0 };
}
