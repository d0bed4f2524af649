/**
 * @file
 * Stippling: points that live on a surface, and which of them a picture shows.
 *
 * A point shows when its rank (mesh_points.h) is below the density of points that the tone asks for
 * times the area that the whole surface would have in the picture if all of it were as large there
 * as the surroundings of the point:
 *
 *   rank < gz_stipple_density(1 - tone) / (pi radius²) * px² per mm² * area of the surface, mm²
 *
 * Of the points of a place, the shown ones are thus always the first so many. Where the surface
 * grows in the picture and the tone stays, points are only added; where it shrinks, they are only
 * removed; none ever moves over the surface. Points have one size on the screen. Where the view is
 * so close that the mesh has too few points, all of them show and grow, so that the tone stays.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_POINTS_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_POINTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/illustration/stipple_sheet.h"
#include "render/illustration/stipple_view.h"
#include "render/mesh/mesh_points.h"

/** Points of one neighbourhood; those that cannot show are passed over together. */
struct gz_stipple_cluster {
	float centre[3], reach; /**< of a ball around its points, mm */
	float axis[3];          /**< unit vector, about the mean normal */
	float spread;           /**< cosine of the largest angle between a normal and axis */
	uint32_t first, count;  /**< points */
};

/** The points of a mesh, made ready for drawing. Zero-initialised is empty. Read-only once made;
 *  any number of threads may share it. */
struct gz_stipple_points {
	size_t count, cluster_count;
	float (*places)[3];  /**< mm */
	float (*normals)[3]; /**< of their triangles, of length 1 */
	uint32_t *ranks;     /**< rising within a cluster */
	struct gz_stipple_cluster *clusters;
	float centre[3], reach; /**< of a ball around all points, mm */
	double area_mm2;        /**< of the mesh */
};

/**
 * Make points ready.
 *
 * @param mesh    that the points were made for
 * @param[out] out_points  written on GZ_OK; the caller frees it with gz_stipple_points_free()
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_stipple_points_make(const struct gz_mesh *mesh,
				      const struct gz_mesh_points *points,
				      struct gz_stipple_points *out_points);

/** Discs of a picture. Zero-initialised is empty; keep it from frame to frame. */
struct gz_stipple_discs {
	size_t count, capacity;
	struct gz_stipple_disc *discs;
};

/**
 * Append the discs of a mesh to a picture. The same discs in the same order for any number of
 * threads. Start with discs->count = 0.
 *
 * @param workers  share the work; NULL for the calling thread alone
 * @retval GZ_ERR_INVAL   the view is not valid; nothing is appended
 * @retval GZ_ERR_NO_MEM  not logged; nothing is appended
 */
enum gz_result gz_stipple_choose(const struct gz_stipple_points *points,
				 const struct gz_stipple_view *view, struct gz_workers *workers,
				 struct gz_stipple_discs *discs);

/** Whether a single point shows, by the rule above and the planes of the view. @param number  of
 *  points->places. For tests and probes */
bool gz_stipple_shows(const struct gz_stipple_points *points, const struct gz_stipple_view *view,
		      size_t number);

/** Free what it holds and zero it. */
void gz_stipple_points_free(struct gz_stipple_points *points);

/** Free what it holds and zero it. */
void gz_stipple_discs_free(struct gz_stipple_discs *discs);

#endif
