/**
 * @file
 * The polygon in which a plane crosses a box. Pure geometry, in double precision.
 */
#ifndef GZ_RENDER_DATA_BOX_POLYGON_H
#define GZ_RENDER_DATA_BOX_POLYGON_H

/** Most corners of a polygon in which a plane crosses a box. */
#define GZ_BOX_POLYGON_MAX 6

/**
 * Find the polygon in which the plane of one level crosses a box.
 *
 * @param corners  of the box: two coordinates that tell the polygon's corners apart, a third, and
 * the corner's level; all of them change evenly along edges. Bit i of a corner's number chooses the
 * upper end along axis i
 * @param level    of the plane
 * @param[out] out_polygon  its corners in order around it, in the same coordinates
 * @return their number: 0, or 3 to GZ_BOX_POLYGON_MAX
 */
int gz_box_polygon(const double corners[8][4], double level,
		   double out_polygon[GZ_BOX_POLYGON_MAX][4]);

#endif
