/**
 * @file
 * What marks on surfaces are drawn for: a camera, the shading map, what is visible, and how large
 * marks are. Stipples (stipple_points.h) and hatches (hatch_lines.h) take the same view.
 */
#ifndef GZ_RENDER_ILLUSTRATION_STIPPLE_VIEW_H
#define GZ_RENDER_ILLUSTRATION_STIPPLE_VIEW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/display.h"
#include "render/picture/camera.h"
#include "render/picture/plane.h"
#include "render/plan/foveation.h"

/** Tolerance of visibility that suits planes with a value for each pixel. Chosen: surfaces that
 * bend within a pixel lose no marks, and those that lie two pixels deeper show none. */
#define GZ_STIPPLE_TOLERANCE_PX 1.5

/** How much larger marks are away from the gaze: a lattice over the picture, bilinear in between.
 *  Zero-initialised means 1 everywhere. */
struct gz_stipple_scale {
	int columns, rows;
	float *factors; /**< of the points (x, y) * GZ_STIPPLE_SCALE_STEP_PX; 1 or more */
	size_t capacity;
};

/** Distance of the lattice's points, px. Chosen: acuity changes by few per cent over it. */
#define GZ_STIPPLE_SCALE_STEP_PX 32

/** A picture to draw marks for. All pointers are borrowed. */
struct gz_stipple_view {
	const struct gz_ray_frame *rays; /**< of the picture's pixels, world units */
	double world_per_mm;             /**< world = mm of the mesh * world_per_mm; above 0 */
	/** The shading map: GZ_PLANE_VALUE, 0 black to 1 white; other values count as the nearer
	 *  end. Its size is the picture's, and that of the other planes. */
	const struct gz_plane *tone;
	/** GZ_PLANE_VALUE: distance of what is seen from where its ray begins, along the ray, world
	 *  units, as in struct gz_surface_planes. */
	const struct gz_plane *depth;
	const struct gz_plane *ids; /**< GZ_PLANE_ID; NULL: depth alone decides */
	uint32_t id;                /**< the mesh's number in ids */
	double size_px;             /**< radius of discs, or width of lines, px, 0.25 to 64 */
	double tolerance_px; /**< how much deeper than the plane a mark may lie, as edges of a pixel
				  at its place; above 0 */
	const struct gz_stipple_scale *scale; /**< NULL: 1 everywhere */
	bool backs; /**< also draw on what is seen from behind, as within a mesh with a border */
};

/** Whether a view is within the ranges that its struct states. */
bool gz_stipple_view_valid(const struct gz_stipple_view *view);

/**
 * Make marks grow as the eye's resolution falls: the factor is the spacing that the eye resolves
 * (gz_acuity_spacing_px()), in pixels, but at least 1. Tone is kept, because as marks grow fewer
 * are drawn.
 *
 * @param gaze           normalised place on the display, finite
 * @param width, height  of the picture that fills the display, px
 * @retval GZ_ERR_NO_MEM  not logged; the scale is unchanged
 */
enum gz_result gz_stipple_scale_make(const struct gz_foveation *foveation,
				     const struct gz_display *display, struct gz_point gaze,
				     int width, int height, struct gz_stipple_scale *scale);

/** The factor at a place of the picture, px. @param scale  may be NULL */
float gz_stipple_scale_at(const struct gz_stipple_scale *scale, float x, float y);

/** Free what it holds and zero it. */
void gz_stipple_scale_free(struct gz_stipple_scale *scale);

#endif
