/**
 * @file
 * One illustration, as every backend of the technique takes it.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_SHOT_H
#define GZ_RENDER_ILLUSTRATION_SHARED_ILLUSTRATE_SHOT_H

#include <stdint.h>

#include "render/data/clip_region.h"
#include "render/illustration/illustration_look.h"
#include "render/picture/camera.h"
#include "render/picture/plane.h"
#include "render/plan/plan.h"

/** Most number of an object. Lists are as long as the greatest number in a scene. Chosen: beyond
 * that of the last of GZ_LABELS_MAX labels (gz_scene_label_id()). */
#define GZ_ILLUSTRATE_ID_MAX 262143

/** One picture to draw. All pointers are borrowed. */
struct gz_illustrate_shot {
	const struct gz_camera *camera;
	const struct gz_plan *plan;
	const struct gz_illustration_look *look; /**< with its template found */
	const struct gz_clip_region *clip;       /**< only what lies in it shows; NULL: all */
	double isovalue;                         /**< of objects that are volumes */
	uint32_t chosen_id; /**< object from which distances count; 0: none. Used if
				 settings->object_distance is above 0 */
};

/** Planes of a picture, for who draws on; each may be NULL. */
struct gz_illustrate_planes {
	struct gz_plane *depth; /**< GZ_PLANE_VALUE, along the ray, mm; INFINITY: nothing */
	struct gz_plane *ids;   /**< GZ_PLANE_ID */
};

#endif
