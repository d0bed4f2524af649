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

struct gz_camera {
	double eye[3];
	double look_at[3];
	double up[3];
	double fov_deg; /**< vertical, above 0 and below 180; perspective */
	double height;  /**< of the view, world units, above 0; orthographic */
	enum gz_projection projection;
};

/**
 * A camera made ready for a picture: the ray of pixel (x, y), row 0 on top, through its centre, is
 *   origin    = origin00    + x * origin_dx    + y * origin_dy
 *   direction = direction00 + x * direction_dx + y * direction_dy   (not normalised)
 * where one of the two differences is zero, by projection.
 */
struct gz_ray_frame {
	double origin00[3], origin_dx[3], origin_dy[3];
	double direction00[3], direction_dx[3], direction_dy[3];
};

/**
 * Prepare rays for a picture. An up vector parallel to the view (or zero) is replaced by the axis
 * least parallel to it.
 *
 * @retval GZ_ERR_INVAL  eye equals look_at, something is not finite, or a value is out of range
 */
enum gz_result gz_camera_rays(const struct gz_camera *camera, int width, int height,
			      struct gz_ray_frame *out_rays);

/** Whether up has a direction other than the view's, so that it is not replaced. */
bool gz_camera_up_counts(const struct gz_camera *camera);

/** Turn the eye about the up axis through look_at, degrees; positive turns counter-clockwise seen
 * from the tip of up. */
void gz_camera_turn(struct gz_camera *camera, double angle_deg);

/** Orbit for a mouse drag: about up, and about the view's right axis, stopping short of the poles.
 */
void gz_camera_orbit(struct gz_camera *camera, double right_deg, double down_deg);

/** Multiply the distance to look_at (perspective) or the height (orthographic) by @p factor > 0. */
void gz_camera_zoom(struct gz_camera *camera, double factor);

/** Move what is in the picture by shares of the picture's height: in perspective, what is as far as
 * look_at. Eye and look_at go the other way. */
void gz_camera_pan(struct gz_camera *camera, double right_heights, double up_heights);

/** Turn the picture about its centre, counter-clockwise; up becomes what the picture has on top. */
void gz_camera_roll(struct gz_camera *camera, double angle_deg);

/** Change the projection so that what is at look_at keeps its size: by the height or, in
 * perspective, by the distance. Nothing where that is out of reach. */
void gz_camera_set_projection(struct gz_camera *camera, enum gz_projection projection);

/**
 * Look along an axis of the world at look_at, from as far as before: from +x, +y or +z, which of a
 * volume that tells its sides are right, front and above. On top is z, along z itself y.
 *
 * @param axis   0 to 2; nothing for others
 * @param other  from the other side
 */
void gz_camera_look_along(struct gz_camera *camera, int axis, bool other);

/** Whether two cameras hold equal values. */
bool gz_camera_same(const struct gz_camera *a, const struct gz_camera *b);

/** Where a world point appears: normalised picture coordinates. False if it is behind the eye. */
bool gz_camera_project(const struct gz_camera *camera, int width, int height, const double world[3],
		       struct gz_point *out_point);

#endif
