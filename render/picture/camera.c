#include "render/picture/camera.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

#define RAD_PER_DEG (3.14159265358979323846 / 180.0)

/* Chosen: an orbit stops this far before the poles, where up and the view would be parallel. */
#define POLE_MARGIN_DEG 1.0

/* Up counts as parallel to the view if the sine of the angle between them is below this (chosen:
 * well above rounding errors, well below any angle that a user sets). */
#define PARALLEL_SINE 1e-6

static bool is_finite3(const double v[3])
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* Right-handed: right x up = backward. */
struct view_axes {
	double forward[3], right[3], up[3];
};

static void least_parallel_axis(const double v[3], double out[3])
{
	int least = 0;
	for (int i = 1; i < 3; i++)
		least = fabs(v[i]) < fabs(v[least]) ? i : least;
	for (int i = 0; i < 3; i++)
		out[i] = i == least;
}

static bool forward_of(const struct gz_camera *camera, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = camera->look_at[i] - camera->eye[i];
	return gz_normalise3(out);
}

/* The direction to the right of the view; its length is the sine of the angle between view and up.
 * False if up has no direction or is parallel to the view. */
static bool right_by_up(const struct gz_camera *camera, const double forward[3], double out[3])
{
	double up[3] = { camera->up[0], camera->up[1], camera->up[2] };
	if (!gz_normalise3(up))
		return false;
	gz_cross3(forward, up, out);
	return gz_length3(out) >= PARALLEL_SINE;
}

bool gz_camera_up_counts(const struct gz_camera *camera)
{
	double forward[3], right[3];
	return forward_of(camera, forward) && right_by_up(camera, forward, right);
}

static bool view_axes_make(const struct gz_camera *camera, struct view_axes *out)
{
	double other[3];
	if (!forward_of(camera, out->forward))
		return false;
	if (!right_by_up(camera, out->forward, out->right)) {
		least_parallel_axis(out->forward, other);
		gz_cross3(out->forward, other, out->right);
	}
	gz_normalise3(out->right);
	gz_cross3(out->right, out->forward, out->up);
	return true;
}

static bool camera_valid(const struct gz_camera *camera)
{
	if (!is_finite3(camera->eye) || !is_finite3(camera->look_at) || !is_finite3(camera->up))
		return false;
	if (camera->projection == GZ_PROJECTION_PERSPECTIVE)
		return camera->fov_deg > 0 && camera->fov_deg < 180;
	return camera->projection == GZ_PROJECTION_ORTHOGRAPHIC && camera->height > 0 &&
	       isfinite(camera->height);
}

/* Height of the picture, world units; in perspective, at distance 1 from the eye. */
static double picture_height(const struct gz_camera *camera)
{
	if (camera->projection == GZ_PROJECTION_ORTHOGRAPHIC)
		return camera->height;
	return 2 * tan(0.5 * camera->fov_deg * RAD_PER_DEG);
}

/* The plane of a picture: the centre of pixel (x, y) is at00 + x dx + y dy. */
struct picture_plane {
	double at00[3], dx[3], dy[3];
};

/* The picture plane whose middle is @p centre, with square pixels of edge @p pixel. */
static struct picture_plane picture_plane_at(const struct view_axes *axes, const double centre[3],
					     double pixel, int width, int height)
{
	struct picture_plane plane;
	for (int i = 0; i < 3; i++) {
		plane.dx[i] = pixel * axes->right[i];
		plane.dy[i] = -pixel * axes->up[i];
		plane.at00[i] = centre[i] + 0.5 * (1 - width) * plane.dx[i] +
				0.5 * (1 - height) * plane.dy[i];
	}
	return plane;
}

enum gz_result gz_camera_rays(const struct gz_camera *camera, int width, int height,
			      struct gz_ray_frame *out_rays)
{
	struct view_axes axes;
	if (width < 1 || height < 1 || !camera_valid(camera) || !view_axes_make(camera, &axes))
		return GZ_ERR_INVAL;

	struct gz_ray_frame rays = { 0 };
	const bool perspective = camera->projection == GZ_PROJECTION_PERSPECTIVE;
	const struct picture_plane plane =
		picture_plane_at(&axes, perspective ? axes.forward : camera->eye,
				 picture_height(camera) / height, width, height);
	memcpy(perspective ? rays.direction00 : rays.origin00, plane.at00, sizeof plane.at00);
	memcpy(perspective ? rays.direction_dx : rays.origin_dx, plane.dx, sizeof plane.dx);
	memcpy(perspective ? rays.direction_dy : rays.origin_dy, plane.dy, sizeof plane.dy);
	if (perspective)
		memcpy(rays.origin00, camera->eye, sizeof rays.origin00);
	else
		memcpy(rays.direction00, axes.forward, sizeof rays.direction00);
	*out_rays = rays;
	return GZ_OK;
}

/* Perspective: P - origin = depth (x dx + y dy + d00). Orthographic: = x ox + y oy + depth d00.
 * Both are a matrix times a vector. */
bool gz_ray_inverse_make(const struct gz_ray_frame *rays, struct gz_ray_inverse *out_inverse)
{
	struct gz_ray_inverse inverse = {
		.orthographic = gz_dot3(rays->direction_dx, rays->direction_dx) == 0,
	};
	const double *x = inverse.orthographic ? rays->origin_dx : rays->direction_dx;
	const double *y = inverse.orthographic ? rays->origin_dy : rays->direction_dy;
	gz_cross3(y, rays->direction00, inverse.rows[0]);
	gz_cross3(rays->direction00, x, inverse.rows[1]);
	gz_cross3(x, y, inverse.rows[2]);
	const double determinant = gz_dot3(x, inverse.rows[0]);
	if (!(fabs(determinant) > 0) || !isfinite(1 / determinant))
		return false;
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++)
			inverse.rows[row][column] /= determinant;
	memcpy(inverse.origin, rays->origin00, sizeof inverse.origin);
	*out_inverse = inverse;
	return true;
}

void gz_ray_inverse_point(const struct gz_ray_inverse *inverse, const double world[3],
			  double out[4])
{
	double from[3];
	for (int axis = 0; axis < 3; axis++)
		from[axis] = world[axis] - inverse->origin[axis];
	out[0] = gz_dot3(inverse->rows[0], from);
	out[1] = gz_dot3(inverse->rows[1], from);
	out[3] = gz_dot3(inverse->rows[2], from);
	out[2] = inverse->orthographic ? 1 : out[3];
}

/* Rodrigues' rotation of v about the unit vector axis. */
static void rotate_vector(double v[3], const double axis[3], double angle_deg)
{
	double c = cos(angle_deg * RAD_PER_DEG), s = sin(angle_deg * RAD_PER_DEG);
	double side[3], along = gz_dot3(axis, v) * (1 - c);
	gz_cross3(axis, v, side);
	for (int i = 0; i < 3; i++)
		v[i] = v[i] * c + side[i] * s + axis[i] * along;
}

static void rotate_eye(struct gz_camera *camera, const double axis[3], double angle_deg)
{
	double arm[3];
	for (int i = 0; i < 3; i++)
		arm[i] = camera->eye[i] - camera->look_at[i];
	rotate_vector(arm, axis, angle_deg);
	for (int i = 0; i < 3; i++)
		camera->eye[i] = camera->look_at[i] + arm[i];
}

/* The axis that the eye turns about: the camera's up, or the picture's if up is zero. */
static bool turn_axis(const struct gz_camera *camera, double out[3])
{
	struct view_axes axes;
	for (int i = 0; i < 3; i++)
		out[i] = camera->up[i];
	if (gz_normalise3(out))
		return true;
	if (!view_axes_make(camera, &axes))
		return false;
	for (int i = 0; i < 3; i++)
		out[i] = axes.up[i];
	return true;
}

void gz_camera_turn(struct gz_camera *camera, double angle_deg)
{
	double axis[3];
	if (isfinite(angle_deg) && turn_axis(camera, axis))
		rotate_eye(camera, axis, angle_deg);
}

void gz_camera_orbit(struct gz_camera *camera, double right_deg, double down_deg)
{
	struct view_axes axes;
	double pole[3];
	if (!isfinite(right_deg) || !isfinite(down_deg) || !turn_axis(camera, pole))
		return;
	rotate_eye(camera, pole, -right_deg);
	if (!view_axes_make(camera, &axes))
		return;
	/* Dragging down tips the near side of the volume down: the eye rises towards the pole. */
	double from_pole_deg = acos(fmax(-1, fmin(1, -gz_dot3(axes.forward, pole)))) / RAD_PER_DEG;
	double wanted_deg = from_pole_deg - down_deg;
	wanted_deg = fmax(POLE_MARGIN_DEG, fmin(180 - POLE_MARGIN_DEG, wanted_deg));
	rotate_eye(camera, axes.right, wanted_deg - from_pole_deg);
}

void gz_camera_zoom(struct gz_camera *camera, double factor)
{
	if (!(factor > 0) || !isfinite(factor))
		return;
	if (camera->projection == GZ_PROJECTION_ORTHOGRAPHIC) {
		camera->height *= factor;
		return;
	}
	for (int i = 0; i < 3; i++)
		camera->eye[i] =
			camera->look_at[i] + factor * (camera->eye[i] - camera->look_at[i]);
}

static double distance_of(const struct gz_camera *camera)
{
	double arm[3];
	for (int i = 0; i < 3; i++)
		arm[i] = camera->eye[i] - camera->look_at[i];
	return gz_length3(arm);
}

void gz_camera_pan(struct gz_camera *camera, double right_heights, double up_heights)
{
	struct view_axes axes;
	if (!isfinite(right_heights) || !isfinite(up_heights) || !camera_valid(camera) ||
	    !view_axes_make(camera, &axes))
		return;
	double height = picture_height(camera);
	if (camera->projection == GZ_PROJECTION_PERSPECTIVE)
		height *= distance_of(camera);
	for (int i = 0; i < 3; i++) {
		const double way =
			height * (right_heights * axes.right[i] + up_heights * axes.up[i]);
		camera->eye[i] -= way;
		camera->look_at[i] -= way;
	}
}

void gz_camera_roll(struct gz_camera *camera, double angle_deg)
{
	struct view_axes axes;
	if (!isfinite(angle_deg) || !view_axes_make(camera, &axes))
		return;
	for (int i = 0; i < 3; i++)
		camera->up[i] = axes.up[i];
	/* Up turns clockwise seen from the eye, so the picture turns counter-clockwise. */
	rotate_vector(camera->up, axes.forward, angle_deg);
}

void gz_camera_set_projection(struct gz_camera *camera, enum gz_projection projection)
{
	const double distance = distance_of(camera);
	const double per_distance = 2 * tan(0.5 * camera->fov_deg * RAD_PER_DEG);
	if (projection == camera->projection)
		return;
	if (!(distance > 0) || !(per_distance > 0) || !isfinite(distance * per_distance))
		return;
	if (projection == GZ_PROJECTION_ORTHOGRAPHIC)
		camera->height = distance * per_distance;
	else
		for (int i = 0; i < 3; i++)
			camera->eye[i] =
				camera->look_at[i] + camera->height / per_distance / distance *
							     (camera->eye[i] - camera->look_at[i]);
	camera->projection = projection;
}

void gz_camera_look_along(struct gz_camera *camera, int axis, bool other)
{
	const double distance = distance_of(camera);
	if (axis < 0 || axis > 2 || !(distance > 0) || !isfinite(distance))
		return;
	for (int i = 0; i < 3; i++) {
		camera->eye[i] = camera->look_at[i];
		camera->up[i] = i == (axis == 2 ? 1 : 2);
	}
	camera->eye[axis] += other ? -distance : distance;
}

bool gz_camera_project(const struct gz_camera *camera, int width, int height, const double world[3],
		       struct gz_point *out_point)
{
	struct view_axes axes;
	double arm[3];
	if (width < 1 || height < 1 || !camera_valid(camera) || !view_axes_make(camera, &axes))
		return false;
	for (int i = 0; i < 3; i++)
		arm[i] = world[i] - camera->eye[i];
	double depth = gz_dot3(arm, axes.forward);
	if (!(depth > 0))
		return false;
	double extent = picture_height(camera);
	if (camera->projection == GZ_PROJECTION_PERSPECTIVE)
		extent *= depth;
	double pixels_per_unit = height / extent;
	out_point->x = (float)(0.5 + gz_dot3(arm, axes.right) * pixels_per_unit / width);
	out_point->y = (float)(0.5 - gz_dot3(arm, axes.up) * pixels_per_unit / height);
	return true;
}

static bool same_vector(const double a[3], const double b[3])
{
	return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

struct gz_ray_depths gz_camera_ray_depths(const struct gz_camera *camera)
{
	/* The world's box has no edge longer than 1, and its centre is the origin. */
	const double radius = 0.5 * sqrt(3);
	double forward[3], centre = sqrt(gz_dot3(camera->eye, camera->eye));
	if (camera->projection == GZ_PROJECTION_ORTHOGRAPHIC && forward_of(camera, forward))
		centre = -gz_dot3(camera->eye, forward);
	return (struct gz_ray_depths) { centre - radius, centre + radius };
}

bool gz_camera_same(const struct gz_camera *a, const struct gz_camera *b)
{
	return same_vector(a->eye, b->eye) && same_vector(a->look_at, b->look_at) &&
	       same_vector(a->up, b->up) && a->fov_deg == b->fov_deg && a->height == b->height &&
	       a->projection == b->projection;
}
