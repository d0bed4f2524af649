#include "render/plan/method.h"

#include <math.h>
#include <string.h>

#include "render/plan/plan_context.h"

const char *const gz_method_names[] = {
	[GZ_METHOD_STANDARD] = "standard", [GZ_METHOD_MDC] = "mdc",
	[GZ_METHOD_DDC] = "ddc",           [GZ_METHOD_ACUITY] = "acuity",
	[GZ_METHOD_MDC3] = "mdc3",         [GZ_METHOD_UNIFORM] = "uniform",
	[GZ_METHOD_TABLE] = "table",       [GZ_METHOD_CONTRAST] = "contrast",
	[GZ_METHOD_COUNT] = NULL,
};

/* A layer that shows within a shape around the gaze. */
static void add_region(const struct gz_plan_context *context, struct gz_plan *plan, int spacing,
		       enum gz_region_shape shape, double half_x_px, double half_y_px)
{
	const double rays = context->rays_per_px;
	struct gz_region region = {
		.shape = shape,
		.centre_px = { context->gaze_px[0], context->gaze_px[1] },
		.half_px = { half_x_px * rays, half_y_px * rays },
	};
	if (shape != GZ_REGION_ALL)
		region.blend_px = fmin(context->foveation->blend_px * rays,
				       fmin(region.half_px[0], region.half_px[1]));
	plan->layers[plan->layer_count++] =
		gz_plan_layer_make(context->width, context->height, spacing, region);
}

static void add_everywhere(const struct gz_plan_context *context, struct gz_plan *plan, int spacing)
{
	add_region(context, plan, spacing, GZ_REGION_ALL, 1, 1);
}

static void add_square(const struct gz_plan_context *context, struct gz_plan *plan, int spacing,
		       double edge_px)
{
	add_region(context, plan, spacing, GZ_REGION_RECTANGLE, edge_px / 2, edge_px / 2);
}

static void add_ellipse(const struct gz_plan_context *context, struct gz_plan *plan, int spacing,
			const double half_px[2])
{
	add_region(context, plan, spacing, GZ_REGION_ELLIPSE, half_px[0], half_px[1]);
}

static void add_standard(const struct gz_plan_context *context, struct gz_plan *plan)
{
	add_everywhere(context, plan, 1);
}

static void add_uniform(const struct gz_plan_context *context, struct gz_plan *plan)
{
	add_everywhere(context, plan, context->foveation->uniform_spacing);
}

static void add_mdc(const struct gz_plan_context *context, struct gz_plan *plan)
{
	add_square(context, plan, 1, context->foveation->mdc_square_px);
	add_everywhere(context, plan, context->foveation->mdc_spacing);
}

static void add_mdc3(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_foveation *foveation = context->foveation;
	add_square(context, plan, 1, foveation->mdc_square_px);
	add_square(context, plan, foveation->mdc_spacing, foveation->mdc3_square_px);
	add_everywhere(context, plan, foveation->mdc3_spacing);
}

static void add_ddc(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_foveation *foveation = context->foveation;
	add_ellipse(context, plan, foveation->ddc_spacing[0], foveation->ddc_inner_px);
	add_ellipse(context, plan, foveation->ddc_spacing[1], foveation->ddc_middle_px);
	add_everywhere(context, plan, foveation->ddc_spacing[2]);
}

const struct gz_method gz_methods[GZ_METHOD_COUNT] = {
	[GZ_METHOD_STANDARD] = {
		.help = "a ray for every pixel",
		.sharp_at_gaze = true,
		.own_steps = GZ_STEPS_ONE,
		.add_regions = add_standard,
	},
	[GZ_METHOD_MDC] = {
		.help = "a fine square around the gaze, coarser outside (Bauer 2018, 3.2.4)",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.has_borders = true,
		.own_steps = GZ_STEPS_ONE,
		.add_regions = add_mdc,
	},
	[GZ_METHOD_DDC] = {
		.help = "three regions by two ellipses, each coarser (Bauer 2018, 3.2.5)",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.has_borders = true,
		.own_steps = GZ_STEPS_ONE,
		.add_regions = add_ddc,
	},
	[GZ_METHOD_ACUITY] = {
		.help = "rays as dense as the eye can resolve at each eccentricity",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.refines_edges = true,
		.is_pyramid = true,
		.own_steps = GZ_STEPS_RUNG,
		.set_curves = gz_plan_set_ray_curve,
	},
	[GZ_METHOD_MDC3] = {
		.help = "mdc with a third, coarsest region",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.has_borders = true,
		.own_steps = GZ_STEPS_ONE,
		.add_regions = add_mdc3,
	},
	[GZ_METHOD_UNIFORM] = {
		.help = "one spacing everywhere, independent of the gaze",
		.can_be_coarser = true,
		.own_steps = GZ_STEPS_ONE,
		.add_regions = add_uniform,
	},
	[GZ_METHOD_TABLE] = {
		.help = "spacings and steps by eccentricity, from a file",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.needs_table = true,
		.is_pyramid = true,
		.own_steps = GZ_STEPS_TABLE,
		.set_curves = gz_plan_set_table_curves,
	},
	[GZ_METHOD_CONTRAST] = {
		.help = "acuity's rays only where neighbouring rays differ visibly",
		.follows_gaze = true,
		.sharp_at_gaze = true,
		.can_be_coarser = true,
		.refines = true,
		.is_pyramid = true,
		.own_steps = GZ_STEPS_PLACE,
		.set_curves = gz_plan_set_ray_curve,
	},
};

const struct gz_method *gz_method_of(const struct gz_foveation *foveation)
{
	return &gz_methods[foveation->method];
}

const char *gz_method_name(const struct gz_foveation *foveation)
{
	return gz_method_names[foveation->method];
}

int gz_method_find(const char *name)
{
	for (int i = 0; i < GZ_METHOD_COUNT; i++)
		if (strcmp(gz_method_names[i], name) == 0)
			return i;
	return -1;
}

int gz_method_full(void)
{
	return GZ_METHOD_STANDARD;
}
