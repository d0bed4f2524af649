/**
 * @file
 * One picture of surfaces, as every backend of the technique takes it.
 */
#ifndef GZ_RENDER_SURFACE_SHARED_SURFACE_SHOT_H
#define GZ_RENDER_SURFACE_SHARED_SURFACE_SHOT_H

#include <stddef.h>

#include "render/picture/camera.h"
#include "render/picture/plane.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/technique/ray_hits.h"
#include "render/technique/shade.h"

/** Planes beside the colours of a picture; NULL: not wanted. */
struct gz_surface_planes {
	/** GZ_PLANE_VALUE: distance from where the ray begins, along the ray, world units. */
	struct gz_plane *depth;
	struct gz_plane *ids; /**< GZ_PLANE_ID: numbers of objects */
};

/** One picture to draw. All pointers are borrowed. */
struct gz_surface_shot {
	const struct gz_camera *camera;
	const struct gz_ray_params *rays; /**< background, light, clip region and surface count */
	const struct gz_plan *plan;
	struct gz_plan *refined; /**< as in struct gz_shot; only rays refine it */
	bool keeps_rays;         /**< as in struct gz_shot; only rays are kept */
	/** Takes what lies nearer than what it has; NULL: not wanted. Only rays fill it. */
	struct gz_ray_hits *hits;
	/** What others in the picture keep back of the light. Only rays look it up. */
	const struct gz_shade *shades;
	size_t shade_count;
};

#endif
