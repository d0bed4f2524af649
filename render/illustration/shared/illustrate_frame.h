/**
 * @file
 * How surfaces become tones in a picture, and how these are composed: the settings of all objects,
 * resolved, in the form that rays and shaders take.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_FRAME_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_FRAME_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/shading_parameters.h"
#include "render/illustration/shading_settings.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/illustration/shared/illustrate_shot.h"

/** Weights of the surface parameters, 0 or more. */
struct gz_illustrate_weights {
	float main_light, plateau_light, grazing_light, surface_shape, curvature, plain_light;
	float flat; /**< the tone if all of them are 0, [0, 1] */
};

/** How a surface becomes a tone. */
struct gz_illustrate_look {
	struct gz_illustrate_weights weights;
	int main_level; /**< of the normals under the main light */
	struct gz_grazing_light grazing;
};

/** The frame. Lengths are in mm, in the frame of struct gz_mesh. Zero-initialised has no room yet;
 *  keep it from picture to picture. */
struct gz_illustrate_frame {
	bool clipped;
	float clip_least[3], clip_greatest[3]; /**< only what lies between shows */
	float clip_plane[4];                   /**< struct gz_clip_bounds */
	float lamp[3];                         /**< unit vector towards the lamp of plain light */
	float near_mm, far_mm;                 /**< of the scene along the ray in the middle */
	/** Of objects without templates; weights of the picture's steps are the greatest of all
	 *  objects. */
	struct gz_shading_settings settings;
	struct gz_illustrate_look *looks;   /**< by template */
	struct gz_shading_weights *weights; /**< of object 1 to the scene's id_count */
	size_t look_room, weight_room;
};

/**
 * Make the frame of a shot.
 *
 * @param scene   prepared for the shot
 * @param camera  the rays of the view's pixels, world units
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_illustrate_frame_make(const struct gz_illustrate_scene *scene,
					const struct gz_illustrate_shot *shot,
					const struct gz_ray_frame *camera,
					struct gz_illustrate_frame *frame);

/** Free its room and zero it. */
void gz_illustrate_frame_free(struct gz_illustrate_frame *frame);

#endif
