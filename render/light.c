#include "render/light.h"

#include <math.h>

static void normalise(double v[3])
{
	const double scale = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
	for (int i = 0; i < 3; i++)
		v[i] /= scale;
	const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
	for (int i = 0; i < 3; i++)
		v[i] /= length;
}

/* Right, up and towards the viewer, from how rays differ between pixels. */
static void camera_axes(const struct gz_ray_frame *rays, double axes[3][3])
{
	double *right = axes[0], *up = axes[1], *back = axes[2];
	for (int i = 0; i < 3; i++) {
		/* one of the two is zero, by projection */
		right[i] = rays->origin_dx[i] + rays->direction_dx[i];
		up[i] = -rays->origin_dy[i] - rays->direction_dy[i];
	}
	normalise(right);
	normalise(up);
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		back[i] = right[j] * up[k] - right[k] * up[j];
	}
}

void gz_light_direction(const struct gz_light *light, const struct gz_ray_frame *rays,
			double out_direction[3])
{
	double given[3] = { light->direction[0], light->direction[1], light->direction[2] };
	double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	normalise(given);
	if (light->frame == GZ_LIGHT_CAMERA)
		camera_axes(rays, axes);
	for (int i = 0; i < 3; i++)
		out_direction[i] =
			given[0] * axes[0][i] + given[1] * axes[1][i] + given[2] * axes[2][i];
	normalise(out_direction);
}

void gz_light_gradient_scale(const struct gz_volume *volume, const struct gz_transfer_table *table,
			     double out_scale[3])
{
	const double finest =
		fmin(fmin(volume->spacing[0], volume->spacing[1]), volume->spacing[2]);
	for (int axis = 0; axis < 3; axis++)
		out_scale[axis] = table->value_per_stored * finest / (2 * volume->spacing[axis]);
}
