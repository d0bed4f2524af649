#include "render/surface/shared/surface_frame.h"

#include <math.h>

/* How far above a surface its shadow rays begin, as a share of the distances in the picture.
 * Chosen: 40 times the error of places in single precision. */
#define LIFT_SHARE 2.5e-6

/* Least colour of glass, so that its logarithm is finite. Chosen: no pixel shows less. */
#define BLACKEST 1e-6

static void fill_clip(const struct gz_surface_meshes *meshes, const struct gz_clip_region *clip,
		      struct gz_surface_frame *frame)
{
	struct gz_clip_bounds bounds;
	double half[3], edges[3], corner[3];
	gz_volume_half_extent(meshes->items[0].object.volume, half);
	for (int axis = 0; axis < 3; axis++) {
		corner[axis] = -half[axis] * meshes->world_mm;
		edges[axis] = -2 * corner[axis];
	}
	gz_clip_region_place(clip, meshes->items[0].object.volume, edges, corner, &bounds);
	frame->clipped = gz_clip_region_cuts(clip);
	for (int i = 0; i < 4; i++)
		frame->clip_plane[i] = (float)bounds.plane[i];
	for (int axis = 0; axis < 3; axis++) {
		frame->clip_least[axis] = (float)bounds.least[axis];
		frame->clip_greatest[axis] = (float)bounds.greatest[axis];
	}
}

static void fill_rays(const struct gz_surface_meshes *meshes, const struct gz_ray_frame *camera,
		      struct gz_surface_frame *frame)
{
	double farthest = 1; /* world units from the centre */
	for (int axis = 0; axis < 3; axis++) {
		frame->origin00[axis] = (float)(camera->origin00[axis] * meshes->world_mm);
		frame->origin_dx[axis] = (float)(camera->origin_dx[axis] * meshes->world_mm);
		frame->origin_dy[axis] = (float)(camera->origin_dy[axis] * meshes->world_mm);
		frame->direction00[axis] = (float)camera->direction00[axis];
		frame->direction_dx[axis] = (float)camera->direction_dx[axis];
		frame->direction_dy[axis] = (float)camera->direction_dy[axis];
		farthest = fmax(farthest, fabs(camera->origin00[axis]));
	}
	frame->lift = (float)(LIFT_SHARE * farthest * meshes->world_mm);
	frame->world_per_mm = (float)(1 / meshes->world_mm);
}

static void fill_look(const struct gz_ray_params *rays, const struct gz_ray_frame *camera,
		      struct gz_surface_frame *frame)
{
	const struct gz_light *light = &rays->light;
	double towards[3];
	gz_light_direction(light, camera, towards);
	frame->light = (struct gz_cast_light) {
		.on = true,
		.ambient = (float)light->ambient,
		.diffuse = (float)light->diffuse,
		.specular = (float)light->specular,
		.reflection = (float)light->reflection,
	};
	gz_cast_light_polish(light->shininess, &frame->light);
	frame->background = UINT32_C(0xFF000000);
	for (int i = 0; i < 3; i++) {
		frame->light.towards[i] = (float)towards[i];
		frame->background |= (uint32_t)(rays->background[i] * 255 + 0.5) << (8 * i);
	}
	frame->shadows = rays->surface.shadows;
}

static void fill_glass(const struct gz_surface_meshes *meshes, const struct gz_surface_look *look,
		       struct gz_surface_frame *frame)
{
	const double root = (look->refractive_index - 1) / (look->refractive_index + 1);
	frame->bounces = look->material == GZ_MATERIAL_GLASS ? look->bounces : 0;
	frame->refractive_index = (float)look->refractive_index;
	frame->least_reflection = (float)(root * root);
	for (int i = 0; i < 3; i++)
		frame->absorbed_per_mm[i] =
			(float)(log2(fmax(look->colour[i], BLACKEST)) / meshes->world_mm);
}

void gz_surface_colour(const struct gz_surface_item *item, const struct gz_surface_look *look,
		       float out_colour[3])
{
	const float *own = item->object.colour;
	for (int i = 0; i < 3; i++)
		out_colour[i] = own ? own[i] : (float)look->colour[i];
}

struct gz_surface_frame gz_surface_frame_make(const struct gz_surface_meshes *meshes,
					      const struct gz_cube_pictures *cube,
					      const struct gz_ray_params *rays,
					      const struct gz_ray_frame *camera)
{
	struct gz_surface_frame frame = { 0 };
	fill_clip(meshes, &rays->clip, &frame);
	fill_rays(meshes, camera, &frame);
	fill_look(rays, camera, &frame);
	fill_glass(meshes, &rays->surface, &frame);
	gz_ray_params_surroundings(rays, meshes->items[0].object.volume, &cube->cube,
				   frame.light.towards, meshes->world_mm, &frame.around);
	return frame;
}
