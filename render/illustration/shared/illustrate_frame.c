#include "render/illustration/shared/illustrate_frame.h"

#include <math.h>
#include <stdlib.h>

#include "base/vector.h"
#include "render/illustration/shading_picture.h"

/* Towards the lamp of plain light. Chosen: the way that photographs are lit. */
static const double plain_lamp[3] = { -0.5, 0.5, 1 };

static void fill_illustrate_clip(const struct gz_illustrate_scene *scene,
				 const struct gz_clip_region *clip,
				 struct gz_illustrate_frame *frame)
{
	const struct gz_volume *volume = scene->meshes.items[0].object.volume;
	struct gz_clip_bounds bounds;
	double edges[3], corner[3];
	frame->clipped = gz_clip_region_cuts(clip);
	for (int axis = 0; axis < 3; axis++) {
		edges[axis] = volume->dims[axis] * volume->spacing[axis];
		corner[axis] = -edges[axis] / 2;
	}
	gz_clip_region_place(clip, volume, edges, corner, &bounds);
	for (int i = 0; i < 4; i++)
		frame->clip_plane[i] = (float)bounds.plane[i];
	for (int axis = 0; axis < 3; axis++) {
		frame->clip_least[axis] = (float)bounds.least[axis];
		frame->clip_greatest[axis] = (float)bounds.greatest[axis];
	}
}

/* Turn a direction from the frame of the picture (right, up, towards the viewer) into that of the
 * meshes. Rows of pixels run downwards. */
static void turn_light(const struct gz_ray_frame *camera, const double direction[3],
		       float out_light[3])
{
	double right[3], up[3], viewer[3], light[3];
	for (int axis = 0; axis < 3; axis++) {
		right[axis] = camera->origin_dx[axis] + camera->direction_dx[axis];
		up[axis] = -camera->origin_dy[axis] - camera->direction_dy[axis];
	}
	(void)gz_normalise3(right);
	(void)gz_normalise3(up);
	gz_cross3(right, up, viewer);
	for (int axis = 0; axis < 3; axis++)
		light[axis] = direction[0] * right[axis] + direction[1] * up[axis] +
			      direction[2] * viewer[axis];
	const bool any = gz_normalise3(light);
	for (int axis = 0; axis < 3; axis++)
		out_light[axis] = (float)(any ? light[axis] : viewer[axis]);
}

/* The look of surfaces by settings. */
static struct gz_illustrate_look look_of(const struct gz_shading_settings *settings,
					 const struct gz_ray_frame *camera)
{
	struct gz_illustrate_look look = {
		.weights = {
			.main_light = (float)settings->main_light,
			.plateau_light = (float)settings->plateau_light,
			.grazing_light = (float)settings->grazing_light,
			.surface_shape = (float)settings->surface_shape,
			.curvature = (float)settings->curvature,
			.plain_light = (float)settings->plain_light,
			.flat = (float)settings->flat,
		},
		.main_level = settings->main_light_smoothing,
		.grazing = {
			.exaggeration = (float)settings->exaggeration,
			.levels = GZ_SHADING_LEVELS,
		},
	};
	gz_grazing_weights(GZ_SHADING_LEVELS, settings->detail_frequency, look.grazing.weights);
	turn_light(camera, settings->light_direction, look.grazing.light);
	return look;
}

/* Room for at least @p count elements of @p size bytes. */
static enum gz_result make_room(void **room, size_t *have, size_t count, size_t size)
{
	if (*have >= count)
		return GZ_OK;
	free(*room);
	*have = 0;
	*room = calloc(count, size);
	if (!*room)
		return GZ_ERR_NO_MEM;
	*have = count;
	return GZ_OK;
}

/* Steps of the picture are done if any object asks for them. */
static void join_weights(const struct gz_shading_settings *more, struct gz_shading_settings *all)
{
	all->edge_light = fmax(all->edge_light, more->edge_light);
	all->overlap_shadow = fmax(all->overlap_shadow, more->overlap_shadow);
	all->haze = fmax(all->haze, more->haze);
	all->lines = fmax(all->lines, more->lines);
}

/* Resolve the looks of all templates, and the weights of all objects. */
static enum gz_result fill_illustrate_looks(const struct gz_illustrate_scene *scene,
					    const struct gz_illustration_look *look,
					    const struct gz_ray_frame *camera,
					    struct gz_illustrate_frame *frame)
{
	enum gz_result result = make_room((void **)&frame->looks, &frame->look_room,
					  scene->template_count, sizeof *frame->looks);
	if (result == GZ_OK)
		result = make_room((void **)&frame->weights, &frame->weight_room, scene->id_count,
				   sizeof *frame->weights);
	if (result != GZ_OK)
		return result;
	gz_illustration_look_resolve(look, NULL, &frame->settings);
	for (size_t k = 0; k < scene->template_count; k++) {
		struct gz_shading_settings settings;
		gz_illustration_look_resolve(look, scene->templates[k].said, &settings);
		frame->looks[k] = look_of(&settings, camera);
		const struct gz_shading_weights weights = gz_shading_weights_of(&settings);
		for (size_t i = 0; i < scene->id_count; i++)
			if (scene->looks[i] == k)
				frame->weights[i] = weights;
		join_weights(&settings, &frame->settings);
	}
	return GZ_OK;
}

/* The scene's nearest and farthest distance from where rays begin, along the ray in the middle. */
static void find_depth_range(const struct gz_illustrate_scene *scene,
			     const struct gz_ray_frame *camera, const struct gz_plan_view *view,
			     struct gz_illustrate_frame *frame)
{
	const double world_mm = scene->meshes.world_mm;
	const double x = view->width / 2.0, y = view->height / 2.0;
	double direction[3], to_centre[3];
	for (int axis = 0; axis < 3; axis++) {
		const double origin = camera->origin00[axis] + x * camera->origin_dx[axis] +
				      y * camera->origin_dy[axis];
		direction[axis] = camera->direction00[axis] + x * camera->direction_dx[axis] +
				  y * camera->direction_dy[axis];
		to_centre[axis] = scene->centre_mm[axis] - origin * world_mm;
	}
	(void)gz_normalise3(direction);
	const double middle = gz_dot3(direction, to_centre), radius = scene->radius_mm;
	frame->near_mm = (float)fmax(middle - radius, 0);
	frame->far_mm =
		(float)fmax(middle + radius, (double)frame->near_mm * 1.001 + 1e-6 * radius);
}

enum gz_result gz_illustrate_frame_make(const struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					const struct gz_ray_frame *camera,
					struct gz_illustrate_frame *frame)
{
	const enum gz_result result = fill_illustrate_looks(scene, shot->look, camera, frame);
	if (result != GZ_OK)
		return result;
	fill_illustrate_clip(scene, shot->clip ? shot->clip : &gz_clip_whole, frame);
	turn_light(camera, plain_lamp, frame->lamp);
	find_depth_range(scene, camera, &shot->plan->view, frame);
	return GZ_OK;
}

void gz_illustrate_frame_free(struct gz_illustrate_frame *frame)
{
	free(frame->looks);
	free(frame->weights);
	*frame = (struct gz_illustrate_frame) { 0 };
}
