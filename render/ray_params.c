#include "render/ray_params.h"

#include <stdint.h>

#include "render/cast_constants.h"

static const char *const interpolation_names[] = { "trilinear", "nearest", NULL };
static const char *const integration_names[] = { "sampled", "preintegrated", NULL };
static const char *const shading_names[] = { "none", "gradient", NULL };
static const char *const light_frame_names[] = { "camera", "world", NULL };

#define AT(field) offsetof(struct gz_ray_params, field)

const struct gz_option gz_ray_options[] = {
	{ "render.background", GZ_OPTION_DOUBLE, AT(background), 0, 1, .count = 3,
	  .preset = "0 0 0", .help = "red, green, blue" },
	{ "render.ray_sampling_rate", GZ_OPTION_DOUBLE, AT(ray_sampling_rate),
	  GZ_RAY_SAMPLING_RATE_MIN, GZ_RAY_SAMPLING_RATE_MAX, .preset = "1.5",
	  .help = "samples per voxel length" },
	{ "render.interpolation", GZ_OPTION_CHOICE, AT(interpolation),
	  .choices = interpolation_names, .preset = "trilinear", .help = "between voxels" },
	{ "render.integration", GZ_OPTION_CHOICE, AT(integration), .choices = integration_names,
	  .preset = "sampled",
	  .help = "preintegrated takes in all values between two samples, so that no thin layer is "
		  "stepped over" },
	{ "render.shading", GZ_OPTION_CHOICE, AT(shading), .choices = shading_names,
	  .preset = "none", .help = "how light falls: gradient takes section [light]" },
	{ "render.levels", GZ_OPTION_BOOL, AT(levels), .preset = "no",
	  .help = "sample a coarser level of the volume where rays and steps are wide" },
	{ "render.jitter", GZ_OPTION_INT, AT(jitter), 0, 2147483647, .preset = "0",
	  .help = "seed of a shift of each ray's samples, which turns rings into noise; 0 = none" },
	{ "render.early_termination", GZ_OPTION_BOOL, AT(early_termination), .preset = "yes",
	  .help = "end rays that next to no light comes through; no is slower, for comparison" },
	{ "light.direction", GZ_OPTION_DOUBLE, AT(light.direction), -1e6, 1e6, .count = 3,
	  .preset = "-0.3 0.5 1", .help = "towards the light" },
	{ "light.frame", GZ_OPTION_CHOICE, AT(light.frame), .choices = light_frame_names,
	  .preset = "camera",
	  .help = "whose axes: camera (right, up, towards the viewer) or world" },
	{ "light.ambient", GZ_OPTION_DOUBLE, AT(light.ambient), 0, 1, .preset = "0.35",
	  .help = "share of light that comes from everywhere" },
	{ "light.diffuse", GZ_OPTION_DOUBLE, AT(light.diffuse), 0, 1, .preset = "0.65",
	  .help = "share that goes with the angle of the surface" },
	{ "light.specular", GZ_OPTION_DOUBLE, AT(light.specular), 0, 1, .preset = "0.25",
	  .help = "strength of highlights" },
	{ "light.shininess", GZ_OPTION_DOUBLE, AT(light.shininess), 1, 1000, .preset = "24",
	  .help = "how small highlights are" },
	{ "light.occlusion", GZ_OPTION_DOUBLE, AT(light.occlusion), 0, 1, .preset = "0",
	  .help = "how much of the ambient light what lies around may take" },
	{ "light.occlusion_radius", GZ_OPTION_DOUBLE, AT(light.occlusion_radius), 2, 64,
	  .preset = "8", .help = "how far around, voxel lengths" },
	{ "clip.least", GZ_OPTION_DOUBLE, AT(clip.least), 0, 1, .count = 3, .preset = "0 0 0",
	  .help = "where the part that is shown begins: shares of the box along x, y, z" },
	{ "clip.greatest", GZ_OPTION_DOUBLE, AT(clip.greatest), 0, 1, .count = 3, .preset = "1 1 1",
	  .help = "where it ends" },
};
const size_t gz_ray_option_count = sizeof gz_ray_options / sizeof gz_ray_options[0];

struct gz_ray_params gz_ray_params_default(void)
{
	struct gz_ray_params rays = { 0 };
	const struct gz_option_binding binding = {
		.options = gz_ray_options,
		.count = gz_ray_option_count,
		.target = &rays,
	};
	gz_options_preset(&binding);
	return rays;
}

bool gz_ray_params_valid(const struct gz_ray_params *rays)
{
	for (size_t i = 0; i < gz_ray_option_count; i++)
		if (!gz_option_holds(&gz_ray_options[i], rays))
			return false;
	for (int axis = 0; axis < 3; axis++)
		if (!(rays->clip.least[axis] < rays->clip.greatest[axis]))
			return false;
	const double *direction = rays->light.direction;
	return direction[0] != 0 || direction[1] != 0 || direction[2] != 0;
}

float gz_ray_end_transmittance(const struct gz_ray_params *rays)
{
	return rays->early_termination ? GZ_TRANSMITTANCE_END : 0;
}

float gz_ray_jitter(int x, int y, int seed)
{
	if (seed == 0)
		return 0;
	uint32_t a = (uint32_t)x * GZ_JITTER_MULTIPLIER + GZ_JITTER_INCREMENT;
	uint32_t b = (uint32_t)y * GZ_JITTER_MULTIPLIER + GZ_JITTER_INCREMENT;
	uint32_t c = (uint32_t)seed * GZ_JITTER_MULTIPLIER + GZ_JITTER_INCREMENT;
	a += b * c;
	b += c * a;
	c += a * b;
	a ^= a >> 16;
	b ^= b >> 16;
	c ^= c >> 16;
	a += b * c;
	return (float)(a >> 8) * 0x1p-24F;
}
