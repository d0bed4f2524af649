/**
 * @file
 * Cuts a box into slices: polygons across the view, at even distances along it. Pure geometry, in
 * double precision.
 *
 * With P = origin + depth * direction for the ray of each pixel (struct gz_ray_frame), all points
 * of one depth lie in a plane across the view, in either projection.
 */
#ifndef GZ_RENDER_SLICES_GL_SLICE_CUT_H
#define GZ_RENDER_SLICES_GL_SLICE_CUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/clip_region.h"
#include "render/picture/camera.h"

/** A slice has at most so many corners: the clip plane can give it one more than a box does. */
#define GZ_SLICE_CORNERS_MAX (GZ_BOX_POLYGON_MAX + 1)

/** A corner of a slice. The vertex shader reads it. */
struct gz_slice_corner {
	float x, y;  /**< pixel, times w */
	float w;     /**< above 0; 1 in orthographic projection */
	float depth; /**< behind the first depth of the box, in lengths of the rays' directions */
};

/** What is cut. */
struct gz_slice_request {
	struct gz_ray_frame rays;    /**< of a picture, in world units */
	double half[3];              /**< half the edges of the box, whose centre is the origin */
	struct gz_clip_bounds shown; /**< the part that is shown, world units */
	int count;                   /**< slices of the whole box, at least 1 */
};

/** The slices of a box, nearest first. Zero-initialised is empty; keep it from frame to frame. */
struct gz_slice_cut {
	/** Triangles of all slices, three corners each, nearest slice first. */
	struct gz_slice_corner *corners;
	/** count + 1 numbers: the triangles of slice i are the corners from first[i] to
	 *  first[i + 1]. */
	int *first;
	int count;       /**< slices; 0 if the box lies behind the eye */
	double near;     /**< first depth of the box, or 0 if the eye is nearer */
	double distance; /**< from one slice to the next, in depth */
	struct gz_slice_request made_for;
	bool valid;        /**< made_for holds */
	uint64_t revision; /**< increased by every new cut */
};

/**
 * Cut a box, unless it has been cut for an equal request.
 *
 * The slices divide the box from its nearest to its farthest corner, or from the eye if that lies
 * within, into request->count layers of one thickness, and lie in the middle of each. What is cut
 * off has no triangles, and leaves the other slices where they are.
 *
 * @retval GZ_ERR_INVAL   the rays of different pixels are not apart; the cut is empty
 * @retval GZ_ERR_NO_MEM  out of memory; the cut is empty
 */
enum gz_result gz_slice_cut_make(const struct gz_slice_request *request, struct gz_slice_cut *cut);

/** Free and zero. */
void gz_slice_cut_free(struct gz_slice_cut *cut);

#endif
