#include "render/illustration/stipple_project.h"

#include "base/vector.h"

/* The most that a surface falls away within a pixel, in edges of the pixel. Chosen: a slope of 83
 * degrees, beyond which the planes tell little. */
#define DEEPEST_PIXEL 8.0F

/* Steeper surfaces have no more tolerance. Chosen likewise. */
#define STEEPEST 8.0F

static void copy_floats(const double from[3], double scale, float to[3])
{
	for (int i = 0; i < 3; i++)
		to[i] = (float)(from[i] * scale);
}

/* In perspective the rays of the corners are the longest. */
static void find_longest_ray(struct gz_stipple_projector *projector)
{
	const float ends[2] = { (float)projector->view->tone->width,
				(float)projector->view->tone->height };
	projector->ray_most = projector->direction_scale;
	for (int corner = 0; corner < 4 && !projector->orthographic; corner++) {
		float ray[3];
		for (int axis = 0; axis < 3; axis++)
			ray[axis] = projector->direction[axis] +
				    (corner % 2 ? ends[0] : -1) * projector->dx[axis] +
				    (corner / 2 ? ends[1] : -1) * projector->dy[axis];
		projector->ray_most = fmaxf(projector->ray_most, sqrtf(gz_stipple_dot(ray, ray)));
	}
}

bool gz_stipple_projector_make(const struct gz_stipple_view *view,
			       struct gz_stipple_projector *out_projector)
{
	struct gz_ray_inverse inverse;
	if (!gz_ray_inverse_make(view->rays, &inverse))
		return false;
	const bool flat = inverse.orthographic;
	const double mm_per_world = 1 / view->world_per_mm;
	const double *dx = flat ? view->rays->origin_dx : view->rays->direction_dx;
	const double *dy = flat ? view->rays->origin_dy : view->rays->direction_dy;
	struct gz_stipple_projector projector = {
		.direction_scale = (float)gz_length3(view->rays->direction00),
		.world_per_mm = (float)view->world_per_mm,
		.fronts = view->backs ? 0 : 1,
		.orthographic = flat,
		.view = view,
	};
	const double step = flat ? mm_per_world : 1;
	for (int row = 0; row < 3; row++)
		copy_floats(inverse.rows[row], row < 2 && flat ? view->world_per_mm : 1,
			    projector.rows[row]);
	copy_floats(inverse.origin, mm_per_world, projector.origin);
	copy_floats(dx, step, projector.dx);
	copy_floats(dy, step, projector.dy);
	copy_floats(view->rays->direction00, 1, projector.direction);
	double across[3];
	gz_cross3(dx, dy, across);
	projector.spread =
		(float)(1 / (step * step * fabs(gz_dot3(across, view->rays->direction00))));
	projector.pixel = (float)(step * fmax(gz_length3(dx), gz_length3(dy)));
	find_longest_ray(&projector);
	projector.tolerance_most = (float)view->tolerance_px * sqrtf(STEEPEST) +
				   1.01F * DEEPEST_PIXEL * projector.ray_most; /* and rounding */
	*out_projector = projector;
	return true;
}

/* Depth of the tangent plane of a spot at the centre of its pixel, as a multiple of the spot's or,
 * in orthographic projection, as a difference to it; and the ray there. */
struct pixel_centre {
	float right, down; /* from the spot, px */
	float ray[3];
};

static struct pixel_centre find_centre(const struct gz_stipple_projector *projector,
				       const struct gz_stipple_spot *spot)
{
	struct pixel_centre centre = {
		.right = (float)(int)(spot->x + 0.5F) - spot->x,
		.down = (float)(int)(spot->y + 0.5F) - spot->y,
	};
	const float x = projector->orthographic ? 0 : spot->x + centre.right;
	const float y = projector->orthographic ? 0 : spot->y + centre.down;
	for (int axis = 0; axis < 3; axis++)
		centre.ray[axis] = projector->direction[axis] + x * projector->dx[axis] +
				   y * projector->dy[axis];
	return centre;
}

/* Depth of the tangent plane at the centre of the spot's pixel. */
static float tangent_depth(const struct gz_stipple_projector *projector, const float normal[3],
			   const struct gz_stipple_spot *spot, const struct pixel_centre *centre)
{
	const float offset = centre->right * gz_stipple_dot(normal, projector->dx) +
			     centre->down * gz_stipple_dot(normal, projector->dy);
	const float limit = DEEPEST_PIXEL * projector->pixel;
	if (projector->orthographic) {
		const float deeper = -offset / spot->along;
		return spot->depth + (fabsf(deeper) < limit ? deeper : copysignf(limit, deeper));
	}
	const float here = spot->along / spot->depth, ratio = here / (here + offset);
	const float deeper = spot->depth * (ratio - 1), most = limit * spot->depth;
	if (!(ratio > 0)) /* the plane is seen from its edge */
		return spot->depth;
	return spot->depth + (fabsf(deeper) < most ? deeper : copysignf(most, deeper));
}

bool gz_stipple_spot_seen(const struct gz_stipple_projector *projector, const float normal[3],
			  const struct gz_stipple_spot *spot)
{
	const struct gz_stipple_view *view = projector->view;
	const size_t pixel = (size_t)(int)(spot->y + 0.5F) * (size_t)view->tone->width +
			     (size_t)(int)(spot->x + 0.5F);
	if (view->ids && view->ids->words[pixel] != view->id)
		return false;
	float seen;
	memcpy(&seen, &view->depth->words[pixel], sizeof seen);
	const struct pixel_centre centre = find_centre(projector, spot);
	const float per_depth =
		projector->world_per_mm * sqrtf(gz_stipple_dot(centre.ray, centre.ray));
	const float depth = tangent_depth(projector, normal, spot, &centre);
	const float edge = projector->pixel * (projector->orthographic ? 1 : spot->depth) *
			   projector->world_per_mm;
	const float steep = fminf(1 / fmaxf(spot->facing, 0.05F), STEEPEST);
	return fabsf(seen - depth * per_depth) <= (float)view->tolerance_px * edge * sqrtf(steep);
}
