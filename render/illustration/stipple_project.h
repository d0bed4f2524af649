/**
 * @file
 * From places on a mesh to the picture: where a place appears, how large its surroundings appear,
 * and whether it is seen. For the sources of this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_PROJECT_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_PROJECT_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "render/illustration/stipple_view.h"

/** A view in the mesh's frame, mm. */
struct gz_stipple_projector {
	/** (x w, y w, depth) = rows * (place - origin); w is the depth in perspective, otherwise 1
	 */
	float rows[3][3];
	float origin[3];
	/** Of the rays: their difference from pixel to pixel, and the direction of that of pixel
	 *  (0, 0). In orthographic projection the differences are those of origins, mm. */
	float dx[3], dy[3], direction[3];
	float spread; /**< |determinant of rows|: px² per mm², at depth 1 mm in perspective */
	float pixel;  /**< edge of a pixel, mm, at depth 1 mm in perspective */
	float direction_scale; /**< length of direction */
	float ray_most;        /**< length of the longest ray of the picture */
	/** How much deeper than what is seen a place may lie at most and be seen, as edges of a
	 *  pixel at its depth: the tolerance, and how far a surface falls away within a pixel. */
	float tolerance_most;
	float world_per_mm;
	float fronts; /**< 1: only what is seen from outside is drawn; 0: both sides */
	bool orthographic;
	const struct gz_stipple_view *view;
};

/** A place in the picture. */
struct gz_stipple_spot {
	float x, y;        /**< px */
	float depth;       /**< mm, as multiples of the ray's direction */
	float distance_mm; /**< from the eye, in orthographic projection along the ray */
	float facing;      /**< cosine of the angle between normal and view, [0, 1] */
	float px2_per_mm2; /**< area in the picture for each area of the surface */
	float along;       /**< normal times the way from the eye, mm; for gz_stipple_spot_seen() */
};

/** The dot product. */
static inline float gz_stipple_dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Make the projector of a valid view. Returns false if its rays are not apart. */
bool gz_stipple_projector_make(const struct gz_stipple_view *view,
			       struct gz_stipple_projector *out_projector);

/** Project a place with its unit normal, mm. Returns false if it lies behind the eye, outside of
 *  the picture or is seen from a side that is not drawn. */
static inline bool gz_stipple_project(const struct gz_stipple_projector *projector,
				      const float place[3], const float normal[3],
				      struct gz_stipple_spot *out_spot)
{
	const struct gz_plane *tone = projector->view->tone;
	float from[3];
	for (int axis = 0; axis < 3; axis++)
		from[axis] = place[axis] - projector->origin[axis];
	const float depth = gz_stipple_dot(projector->rows[2], from);
	const float along =
		gz_stipple_dot(normal, projector->orthographic ? projector->direction : from);
	if (!(along * projector->fronts <= 0) || (!projector->orthographic && !(depth > 0)))
		return false;
	const float w = projector->orthographic ? 1 : depth;
	out_spot->x = gz_stipple_dot(projector->rows[0], from) / w;
	out_spot->y = gz_stipple_dot(projector->rows[1], from) / w;
	if (!(out_spot->x >= -0.5F && out_spot->y >= -0.5F &&
	      out_spot->x < (float)tone->width - 0.5F && out_spot->y < (float)tone->height - 0.5F))
		return false;
	out_spot->depth = depth;
	out_spot->along = along;
	const float way = projector->orthographic ? projector->direction_scale
						  : sqrtf(gz_stipple_dot(from, from));
	out_spot->distance_mm = projector->orthographic ? depth * way : way;
	out_spot->facing = fabsf(along) / way;
	out_spot->px2_per_mm2 = fabsf(along) * projector->spread / (w * w * w);
	return true;
}

/** The value of a plane of the view at the pixel nearest to a spot. */
static inline float gz_stipple_value_at(const struct gz_plane *plane,
					const struct gz_stipple_spot *spot)
{
	return gz_plane_value(plane, (int)(spot->x + 0.5F), (int)(spot->y + 0.5F));
}

/** How dark the shading map wants the drawing at a spot, [0, 1]. */
static inline float gz_stipple_ink_at(const struct gz_stipple_projector *projector,
				      const struct gz_stipple_spot *spot)
{
	const float ink = 1 - gz_stipple_value_at(projector->view->tone, spot);
	return !(ink > 0) ? 0 : ink > 1 ? 1 : ink;
}

/** Whether gz_stipple_spot_seen() may say yes: a quick look at the planes, which most hidden places
 *  do not pass. */
static inline bool gz_stipple_spot_near(const struct gz_stipple_projector *projector,
					const struct gz_stipple_spot *spot)
{
	const float edge = projector->pixel * (projector->orthographic ? 1 : spot->depth);
	const float seen = gz_stipple_value_at(projector->view->depth, spot);
	const float away = fabsf(seen - spot->distance_mm * projector->world_per_mm);
	return away <= edge * projector->world_per_mm * projector->tolerance_most + 1e-5F * seen;
}

/** Whether the planes say that a projected place is what is seen. */
bool gz_stipple_spot_seen(const struct gz_stipple_projector *projector, const float normal[3],
			  const struct gz_stipple_spot *spot);

#endif
