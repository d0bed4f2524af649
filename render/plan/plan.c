#include "render/plan/plan.h"

#include <stdlib.h>

#include "render/image.h"
#include "render/plan/plan_emit.h"

/* The table is the one place that knows the ranges. */
static bool parameters_valid(const struct gz_foveation *foveation)
{
	for (size_t i = 0; i < gz_foveation_option_count; i++)
		if (!gz_option_holds(&gz_foveation_options[i], foveation))
			return false;
	return true;
}

enum gz_result gz_plan_make(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, int width, int height, struct gz_plan *plan)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	if (!gz_display_valid(display) || !parameters_valid(foveation))
		return GZ_ERR_INVAL;

	const struct gz_plan_context context =
		gz_plan_context_make(foveation, display, gaze, width, height);
	plan->width = width;
	plan->height = height;
	plan->tile_count = 0;
	plan->layer_count = 0;
	gz_plan_make_steps(&context, plan);

	enum gz_result result = GZ_ERR_INVAL;
	switch ((enum gz_method)foveation->method) {
	case GZ_METHOD_STANDARD:
		result = gz_plan_standard(&context, plan);
		break;
	case GZ_METHOD_MDC:
		result = gz_plan_mdc(&context, plan);
		break;
	case GZ_METHOD_DDC:
		result = gz_plan_ddc(&context, plan);
		break;
	case GZ_METHOD_ACUITY:
		result = gz_plan_acuity(&context, plan);
		break;
	case GZ_METHOD_COUNT:
		break;
	}
	if (result == GZ_OK)
		gz_plan_count_rays(plan);
	return result;
}

void gz_plan_free(struct gz_plan *plan)
{
	free(plan->tiles);
	*plan = (struct gz_plan) { 0 };
}
