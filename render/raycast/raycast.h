/**
 * @file
 * The technique `raycast`: the volume ray caster.
 */
#ifndef GZ_RENDER_RAYCAST_RAYCAST_H
#define GZ_RENDER_RAYCAST_RAYCAST_H

#include "render/technique/technique.h"

/** Its settings are a struct gz_ray_params. It shows one volume with its transfer function. */
extern const struct gz_technique gz_raycast_technique;

#endif
