#include "render/raycast/shared/ray_params.h"

#include <stdint.h>
#include <string.h>

#include "render/raycast/shared/cast_constants.h"

static const char *const interpolation_names[] = { "trilinear", "nearest", "auto", NULL };
static const char *const integration_names[] = { "sampled", "preintegrated", NULL };
static const char *const shading_names[] = { "none", "gradient", NULL };

#define AT(field) offsetof(struct gz_ray_params, field)

const struct gz_option gz_ray_options[] = {
	{ "render.background", GZ_OPTION_DOUBLE, AT(background), 0, 1, .count = 3,
	  .preset = "0 0 0", .help = "red, green and blue of the background" },
	{ "render.ray_sampling_rate", GZ_OPTION_DOUBLE, AT(ray_sampling_rate),
	  GZ_RAY_SAMPLING_RATE_MIN, GZ_RAY_SAMPLING_RATE_MAX, .preset = "1.5",
	  .help = "samples per voxel length" },
	{ "render.interpolation", GZ_OPTION_CHOICE, AT(interpolation),
	  .choices = interpolation_names, .preset = "auto",
	  .help = "how values between voxels are made; auto: nearest for labels, else "
		  "trilinear" },
	{ "render.integration", GZ_OPTION_CHOICE, AT(integration), .choices = integration_names,
	  .preset = "sampled",
	  .help = "preintegrated: a step takes in all values between its ends, so that no thin "
		  "layer is missed" },
	{ "render.shading", GZ_OPTION_CHOICE, AT(shading), .choices = shading_names,
	  .preset = "none", .help = "lighting; gradient: by the keys of [light]" },
	{ "render.levels", GZ_OPTION_BOOL, AT(levels), .preset = "no",
	  .help = "sample a coarser level of the volume where rays and steps are wide" },
	{ "render.jitter", GZ_OPTION_INT, AT(jitter), 0, 2147483647, .preset = "0",
	  .help = "random seed that shifts each ray's samples, so that rings become noise; 0 = "
		  "off" },
	{ "render.early_termination", GZ_OPTION_BOOL, AT(early_termination), .preset = "yes",
	  .help = "stop rays once nearly opaque; no is slower" },
};
const size_t gz_ray_option_count = sizeof gz_ray_options / sizeof gz_ray_options[0];

void gz_ray_params_bind(struct gz_ray_params *rays,
			struct gz_option_binding out_bindings[GZ_RAY_BINDINGS])
{
	const struct gz_option_binding bindings[GZ_RAY_BINDINGS] = {
		[GZ_RAY_BINDING_RENDER] = { gz_ray_options, gz_ray_option_count, rays, NULL },
		[GZ_RAY_BINDING_LIGHT] = { gz_light_options, gz_light_option_count, &rays->light,
					   NULL },
		[GZ_RAY_BINDING_CLIP] = { gz_clip_options, gz_clip_option_count, &rays->clip,
					  NULL },
		[GZ_RAY_BINDING_SURFACE] = { gz_surface_look_options, gz_surface_look_option_count,
					     &rays->surface, NULL },
		[GZ_RAY_BINDING_ENVIRONMENT] = { gz_environment_options,
						 gz_environment_option_count, &rays->environment,
						 NULL },
		[GZ_RAY_BINDING_SLICES] = { gz_slicing_options, gz_slicing_option_count,
					    &rays->slicing, NULL },
	};
	memcpy(out_bindings, bindings, sizeof bindings);
	gz_illustration_look_bind(&rays->illustration, &out_bindings[GZ_RAY_BINDING_ILLUSTRATION]);
}

struct gz_ray_params gz_ray_params_default(void)
{
	struct gz_ray_params rays = { 0 };
	struct gz_option_binding bindings[GZ_RAY_BINDINGS];
	gz_ray_params_bind(&rays, bindings);
	for (size_t i = 0; i < GZ_RAY_BINDINGS; i++)
		gz_options_preset(&bindings[i]);
	return rays;
}

bool gz_ray_params_valid(const struct gz_ray_params *rays)
{
	return gz_options_hold(gz_ray_options, gz_ray_option_count, rays) &&
	       gz_light_valid(&rays->light) && gz_clip_region_valid(&rays->clip) &&
	       gz_options_hold(gz_surface_look_options, gz_surface_look_option_count,
			       &rays->surface) &&
	       gz_environment_valid(&rays->environment) &&
	       gz_options_hold(gz_slicing_options, gz_slicing_option_count, &rays->slicing) &&
	       gz_illustration_look_valid(&rays->illustration);
}

bool gz_ray_params_lit(const struct gz_ray_params *rays)
{
	return rays->shading == GZ_SHADING_GRADIENT || rays->light.shadow_steps > 0;
}

void gz_ray_params_surroundings(const struct gz_ray_params *rays, const struct gz_volume *volume,
				const struct gz_cube *cube, const float towards[3],
				double lengths_a_unit, struct gz_seen_surroundings *out_seen)
{
	double half[3];
	gz_volume_half_extent(volume, half);
	const struct gz_surroundings_request request = {
		.environment = &rays->environment,
		.cube = cube,
		.light = &rays->light,
		.background = rays->background,
		.half = half,
		.towards = towards,
		.lengths_a_unit = lengths_a_unit,
	};
	gz_seen_surroundings_make(&request, out_seen);
}

bool gz_ray_params_same(const struct gz_ray_params *a, const struct gz_ray_params *b)
{
	return gz_options_same(gz_ray_options, gz_ray_option_count, a, b) &&
	       gz_options_same(gz_light_options, gz_light_option_count, &a->light, &b->light) &&
	       gz_clip_region_same(&a->clip, &b->clip) &&
	       gz_options_same(gz_surface_look_options, gz_surface_look_option_count, &a->surface,
			       &b->surface) &&
	       gz_options_same(gz_environment_options, gz_environment_option_count, &a->environment,
			       &b->environment) &&
	       gz_options_same(gz_slicing_options, gz_slicing_option_count, &a->slicing,
			       &b->slicing) &&
	       gz_illustration_look_same(&a->illustration, &b->illustration);
}

bool gz_ray_samples_nearest(const struct gz_ray_params *rays, const struct gz_volume *volume)
{
	return rays->interpolation == GZ_INTERPOLATION_NEAREST ||
	       (rays->interpolation == GZ_INTERPOLATION_AUTO && volume->labels);
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

void gz_voxel_rays_make(const struct gz_volume *volume, const int factor[3],
			const struct gz_ray_frame *world, struct gz_voxel_rays *out_rays)
{
	double half[3];
	gz_volume_half_extent(volume, half);
	for (int axis = 0; axis < 3; axis++) {
		const double per_world = volume->dims[axis] / (2 * half[axis]);
		struct gz_ray_frame *frame = &out_rays->frame;
		out_rays->world_per_voxel[axis] = 1 / per_world;
		frame->origin00[axis] =
			(world->origin00[axis] + half[axis]) * per_world / factor[axis];
		frame->origin_dx[axis] = world->origin_dx[axis] * per_world / factor[axis];
		frame->origin_dy[axis] = world->origin_dy[axis] * per_world / factor[axis];
		frame->direction00[axis] = world->direction00[axis] * per_world / factor[axis];
		frame->direction_dx[axis] = world->direction_dx[axis] * per_world / factor[axis];
		frame->direction_dy[axis] = world->direction_dy[axis] * per_world / factor[axis];
	}
}
