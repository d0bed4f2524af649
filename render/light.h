/**
 * @file
 * What of a light holds for all samples of a frame: see struct gz_light for what it is for.
 */
#ifndef GZ_RENDER_LIGHT_H
#define GZ_RENDER_LIGHT_H

#include "render/camera.h"
#include "render/ray_params.h"
#include "render/transfer_table.h"
#include "render/volume/volume.h"

/** Unit vector towards the light, in world directions, for the camera that made @p rays. */
void gz_light_direction(const struct gz_light *light, const struct gz_ray_frame *rays,
			double out_direction[3]);

/** By what to multiply the difference between the stored values one voxel to either side, along
 *  each axis, to have the gradient of struct gz_light. */
void gz_light_gradient_scale(const struct gz_volume *volume, const struct gz_transfer_table *table,
			     double out_scale[3]);

#endif
