/**
 * @file
 * Where points of meshes lie in a rasterised picture and in a shadow map. Pure geometry; places are
 * in mm, in the frame of struct gz_mesh.
 */
#ifndef GZ_RENDER_SURFACE_GL_RASTER_VIEW_H
#define GZ_RENDER_SURFACE_GL_RASTER_VIEW_H

#include <stdbool.h>

#include "render/picture/camera.h"

/** What lies nearer to the eye than this share of the farthest depth is not drawn. Chosen: depths
 *  in 24 bits then tell apart what lies a quarter of a thousandth of the picture's depth apart. */
#define GZ_RASTER_NEAREST (1.0 / 4096)

/** A box. Empty if least > greatest along an axis. */
struct gz_raster_box {
	double least[3], greatest[3]; /**< mm */
};

/** The picture: a point (x, y, z, 1) times the rows is pixel x times w, pixel y times w, OpenGL's
 *  clip coordinate z, and w. */
struct gz_raster_view {
	float rows[4][4];
};

/**
 * Make the view of what lies in a box.
 *
 * @param rays      of the picture's pixels, world units
 * @param world_mm  mm of a world unit
 * @return false if the box is empty or behind the eye, or the rays are not apart: nothing is seen
 */
bool gz_raster_view_make(const struct gz_ray_frame *rays, double world_mm,
			 const struct gz_raster_box *box, struct gz_raster_view *out_view);

/** Whether something of a box may lie in a rectangle of the picture. If not, nothing of it does.
 *  @param from, to  pixels */
bool gz_raster_view_shows(const struct gz_raster_view *view, const struct gz_raster_box *box,
			  const double from[2], const double to[2]);

/** Whether all of a box lies in a rectangle of the picture, and in front of the eye. @param from,
 * to pixels */
bool gz_raster_view_holds(const struct gz_raster_view *view, const struct gz_raster_box *box,
			  const double from[2], const double to[2]);

/** A shadow map: the box seen by a distant light. A point times the rows is its place in the map,
 *  [0, 1] along x and y, and its depth, 0 nearest to the light and 1 farthest. */
struct gz_raster_shadow {
	float rows[3][4];
	float texel_mm; /**< longer edge of a texel */
	float depth_mm; /**< depth from 0 to 1 */
};

/** Make the shadow map's view. @param towards  unit vector to the light  @param edge  texels @param
 *  box  not empty */
struct gz_raster_shadow gz_raster_shadow_make(const float towards[3],
					      const struct gz_raster_box *box, int edge);

#endif
