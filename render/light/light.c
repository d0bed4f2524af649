#include "render/light/light.h"
#include "base/vector.h"

#include <math.h>

static const char *const light_frame_names[] = { "camera", "world", NULL };

#define AT(field) offsetof(struct gz_light, field)

const struct gz_option gz_light_options[] = {
	{ "light.direction", GZ_OPTION_DOUBLE, AT(direction), -1e6, 1e6, .count = 3,
	  .preset = "-0.3 0.5 1", .help = "direction towards the light, any length" },
	{ "light.frame", GZ_OPTION_CHOICE, AT(frame), .choices = light_frame_names,
	  .preset = "camera",
	  .help = "axes of light.direction: camera (right, up, towards the viewer) or world" },
	{ "light.ambient", GZ_OPTION_DOUBLE, AT(ambient), 0, 1, .preset = "0.35",
	  .help = "ambient light, the share that comes from all directions" },
	{ "light.diffuse", GZ_OPTION_DOUBLE, AT(diffuse), 0, 1, .preset = "0.65",
	  .help = "diffuse reflection, the share that depends on the angle of the surface" },
	{ "light.specular", GZ_OPTION_DOUBLE, AT(specular), 0, 1, .preset = "0.25",
	  .help = "strength of highlights" },
	{ "light.shininess", GZ_OPTION_DOUBLE, AT(shininess), 1, 1000, .preset = "24",
	  .help = "exponent of highlights; larger is smaller and sharper" },
	{ "light.reflection", GZ_OPTION_DOUBLE, AT(reflection), 0, 1, .preset = "0",
	  .help = "share of the surroundings that surfaces mirror when looked at straight; 0 = "
		  "off" },
	{ "light.occlusion", GZ_OPTION_DOUBLE, AT(occlusion), 0, 1, .preset = "0",
	  .help = "ambient occlusion, the share of ambient light that surroundings can block" },
	{ "light.occlusion_radius", GZ_OPTION_DOUBLE, AT(occlusion_radius), 2, 64, .preset = "8",
	  .help = "radius of ambient occlusion, voxel lengths" },
	{ "light.shadow_steps", GZ_OPTION_INT, AT(shadow_steps), 0, GZ_SHADOW_STEPS_MAX,
	  .preset = "0", .help = "soft shadows: steps towards the light; 0 = off" },
	{ "light.shadow_reach", GZ_OPTION_DOUBLE, AT(shadow_reach), 4, 1e5, .preset = "256",
	  .help = "how far the steps of shadows go at most, voxel lengths" },
};
const size_t gz_light_option_count = sizeof gz_light_options / sizeof gz_light_options[0];

bool gz_light_valid(const struct gz_light *light)
{
	const double *direction = light->direction;
	return gz_options_hold(gz_light_options, gz_light_option_count, light) &&
	       (direction[0] != 0 || direction[1] != 0 || direction[2] != 0);
}

/* Axes of the camera in world directions: right, up, towards the viewer. */
static void camera_axes(const struct gz_ray_frame *rays, double axes[3][3])
{
	double *right = axes[0], *up = axes[1], *back = axes[2];
	for (int i = 0; i < 3; i++) {
		/* one of the two terms is zero, depending on the projection */
		right[i] = rays->origin_dx[i] + rays->direction_dx[i];
		up[i] = -rays->origin_dy[i] - rays->direction_dy[i];
	}
	(void)gz_normalise3(right);
	(void)gz_normalise3(up);
	gz_cross3(right, up, back);
}

void gz_light_direction(const struct gz_light *light, const struct gz_ray_frame *rays,
			double out_direction[3])
{
	double given[3] = { light->direction[0], light->direction[1], light->direction[2] };
	double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	(void)gz_normalise3(given);
	if (light->frame == GZ_LIGHT_CAMERA)
		camera_axes(rays, axes);
	for (int i = 0; i < 3; i++)
		out_direction[i] =
			given[0] * axes[0][i] + given[1] * axes[1][i] + given[2] * axes[2][i];
	(void)gz_normalise3(out_direction);
}

void gz_light_seen(const struct gz_light *light, const struct gz_ray_frame *rays,
		   double out_seen[3])
{
	double axes[3][3], direction[3];
	camera_axes(rays, axes);
	gz_light_direction(light, rays, direction);
	for (int i = 0; i < 3; i++)
		out_seen[i] = gz_dot3(direction, axes[i]);
}

/* Steps in which a turned light's direction is stored: short numbers in scene files. */
static const double DIRECTION_STEPS = 1e5;

void gz_light_turn(struct gz_light *light, const struct gz_ray_frame *rays, double right_deg,
		   double down_deg)
{
	double axes[3][3], seen[3];
	const double a = right_deg * (M_PI / 180), b = down_deg * (M_PI / 180);
	camera_axes(rays, axes);
	gz_light_seen(light, rays, seen);
	/* Around the axis up, then around the axis right. */
	const double x = cos(a) * seen[0] + sin(a) * seen[2];
	const double z = cos(a) * seen[2] - sin(a) * seen[0];
	const double turned[3] = { x, cos(b) * seen[1] - sin(b) * z,
				   cos(b) * z + sin(b) * seen[1] };
	for (int i = 0; i < 3; i++) {
		double value = turned[i];
		if (light->frame == GZ_LIGHT_WORLD)
			value = turned[0] * axes[0][i] + turned[1] * axes[1][i] +
				turned[2] * axes[2][i];
		light->direction[i] = round(value * DIRECTION_STEPS) / DIRECTION_STEPS;
	}
}

void gz_light_gradient_scale(const struct gz_volume *volume, const struct gz_transfer_table *table,
			     double out_scale[3])
{
	const double finest =
		fmin(fmin(volume->spacing[0], volume->spacing[1]), volume->spacing[2]);
	for (int axis = 0; axis < 3; axis++)
		out_scale[axis] = table->value_per_stored * finest / (2 * volume->spacing[axis]);
}
