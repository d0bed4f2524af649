/**
 * @file
 * Camera: where rays start and go. World units are those of volume.h.
 */
#ifndef GZ_RENDER_PICTURE_CAMERA_H
#define GZ_RENDER_PICTURE_CAMERA_H

#include <stdbool.h>

#include "base/result.h"
#include "protocol/display.h"

enum gz_projection { GZ_PROJECTION_PERSPECTIVE, GZ_PROJECTION_ORTHOGRAPHIC };

/** A camera. Valid if everything is finite, eye and look_at differ, and fov_deg (perspective) or
 *  height (orthographic) is in range. */
struct gz_camera {
	double eye[3];
	double look_at[3];
	double up[3];   /**< any length; parallel to the view or zero: see gz_camera_rays() */
	double fov_deg; /**< perspective: vertical field of view, degrees, above 0 and below 180 */
	double height;  /**< orthographic: height of the view, world units, above 0 */
	enum gz_projection projection;
};

/**
 * The rays of a picture. The ray through the centre of pixel (x, y), row 0 on top, is
 *   origin    = origin00    + x * origin_dx    + y * origin_dy
 *   direction = direction00 + x * direction_dx + y * direction_dy   (not normalised)
 * The differences of origin are zero in perspective, those of direction in orthographic projection.
 */
struct gz_ray_frame {
	double origin00[3], origin_dx[3], origin_dy[3];
	double direction00[3], direction_dx[3], direction_dy[3];
};

/**
 * Make the rays of a picture. An up vector that is zero or parallel to the view is replaced by the
 * axis least parallel to the view.
 *
 * @param width, height  of the picture, px, at least 1
 * @retval GZ_ERR_INVAL  the camera is not valid, or a side is below 1; not logged
 */
enum gz_result gz_camera_rays(const struct gz_camera *camera, int width, int height,
			      struct gz_ray_frame *out_rays);

/** From a point of the world to its pixel: the inverse of a struct gz_ray_frame. */
struct gz_ray_inverse {
	double rows[3][3]; /**< of the matrix whose columns are the rays' differences */
	double origin[3];
	bool orthographic;
};

/** Invert the rays of a picture. Returns false if those of different pixels are not apart. */
bool gz_ray_inverse_make(const struct gz_ray_frame *rays, struct gz_ray_inverse *out_inverse);

/**
 * Project a point: with P = origin + depth * direction for the ray of pixel (x, y),
 *
 * @param[out] out  x w, y w, w, depth; w is the depth in perspective and 1 in orthographic
 *                  projection
 */
void gz_ray_inverse_point(const struct gz_ray_inverse *inverse, const double world[3],
			  double out[4]);

/** Whether up is used: it is not zero and not parallel to the view. */
bool gz_camera_up_counts(const struct gz_camera *camera);

/** Turn the eye about the axis up through look_at, degrees; positive angles turn counter-clockwise
 *  seen from the tip of up. Nothing happens if the angle is not finite. */
void gz_camera_turn(struct gz_camera *camera, double angle_deg);

/** Orbit for a mouse drag, degrees: to the right about up, and down about the view's right axis.
 *  The eye stops one degree before the poles. */
void gz_camera_orbit(struct gz_camera *camera, double right_deg, double down_deg);

/** Multiply the distance to look_at (perspective) or the height (orthographic) by @p factor, which
 *  must be above 0; otherwise nothing happens. */
void gz_camera_zoom(struct gz_camera *camera, double factor);

/** Move the picture's content to the right and up, as shares of the picture's height; in
 *  perspective the content at the distance of look_at. Eye and look_at move the other way. */
void gz_camera_pan(struct gz_camera *camera, double right_heights, double up_heights);

/** Turn the picture about its centre, degrees counter-clockwise. Up becomes the direction that is
 * on top of the picture. */
void gz_camera_roll(struct gz_camera *camera, double angle_deg);

/** Change the projection and keep the size of what is at look_at: sets the height, or, for
 *  perspective, the distance. Nothing happens if there is no such height or distance. */
void gz_camera_set_projection(struct gz_camera *camera, enum gz_projection projection);

/**
 * Look along an axis of the world at look_at, from the current distance: from +x, +y or +z, which
 * are right, front and above of an oriented volume. z is on top, or y if the view is along z.
 *
 * @param axis   0 to 2; nothing happens for others
 * @param other  look from the opposite side
 */
void gz_camera_look_along(struct gz_camera *camera, int axis, bool other);

/** Depths along rays, from where these begin, world units; nearest < farthest. */
struct gz_ray_depths {
	double nearest, farthest;
};

/** Depths at which a ray of the camera can meet the world's box (volume.h). Nearest may be below 0.
 *  Of a camera that is not valid: any range. */
struct gz_ray_depths gz_camera_ray_depths(const struct gz_camera *camera);

/** Whether two cameras hold equal values. */
bool gz_camera_same(const struct gz_camera *a, const struct gz_camera *b);

/**
 * Where a point of the world appears in the picture.
 *
 * @param width, height   of the picture, px
 * @param[out] out_point  normalised picture coordinates, 0 to 1 within the picture
 * @return false if the point is behind the eye or the camera is not valid
 */
bool gz_camera_project(const struct gz_camera *camera, int width, int height, const double world[3],
		       struct gz_point *out_point);

#endif
