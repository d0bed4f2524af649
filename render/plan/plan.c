#include "render/plan/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/image.h"
#include "render/plan/plan_emit.h"

/* The table is the one place that knows the ranges. */
static bool parameters_valid(const struct gz_foveation *foveation)
{
	for (size_t i = 0; i < gz_foveation_option_count; i++)
		if (!gz_option_holds(&gz_foveation_options[i], foveation))
			return false;
	return foveation->method != GZ_METHOD_TABLE || gz_spacing_table_valid(&foveation->table);
}

static bool request_valid(const struct gz_plan_request *request)
{
	if (request->width < 1 || request->height < 1 || request->width > GZ_IMAGE_SIDE_MAX ||
	    request->height > GZ_IMAGE_SIDE_MAX)
		return false;
	return request->rays_per_px >= 0.0625 && request->rays_per_px <= 16 &&
	       request->scale >= 1 && request->scale <= GZ_PLAN_SCALE_MAX && request->widen >= 0 &&
	       request->widen <= 1 && request->steps_per_px >= 0 && request->steps_per_px <= 1 &&
	       gz_display_valid(request->display) && parameters_valid(request->foveation);
}

/* Plans that do not ask where someone looks. */
static bool ignores_gaze(const struct gz_foveation *foveation)
{
	return (foveation->method == GZ_METHOD_STANDARD ||
		foveation->method == GZ_METHOD_UNIFORM) &&
	       (foveation->step_rule == GZ_STEP_METHOD || foveation->step_rule == GZ_STEP_NONE);
}

/* Bits, not values: a NaN equals itself and two zeros differ, neither of which does harm. Padding
 * that differs costs a plan made anew. */
static bool same_point(struct gz_point a, struct gz_point b)
{
	return memcmp(&a, &b, sizeof a) == 0;
}

static bool is_made_for(const struct gz_plan *plan, const struct gz_plan_request *request)
{
	const struct gz_plan_request *made = &plan->made_for.request;
	return plan->serial != 0 && plan->made_for.valid && made->width == request->width &&
	       made->height == request->height && made->rays_per_px == request->rays_per_px &&
	       made->scale == request->scale && made->widen == request->widen &&
	       made->steps_per_px == request->steps_per_px &&
	       (same_point(made->gaze, request->gaze) || ignores_gaze(request->foveation)) &&
	       memcmp(&plan->made_for.display, request->display, sizeof *request->display) == 0 &&
	       memcmp(&plan->made_for.foveation, request->foveation, sizeof *request->foveation) ==
		       0;
}

static void remember(struct gz_plan *plan, const struct gz_plan_request *request)
{
	plan->made_for.request = *request;
	memcpy(&plan->made_for.foveation, request->foveation, sizeof *request->foveation);
	memcpy(&plan->made_for.display, request->display, sizeof *request->display);
	plan->made_for.valid = true;
}

static enum gz_result make_tiles(const struct gz_plan_request *request, struct gz_plan *plan)
{
	struct gz_plan_context context;
	gz_plan_context_make(request, &context);
	plan->width = request->width;
	plan->height = request->height;
	plan->filter = (enum gz_filter)request->foveation->filter;
	plan->tile_count = 0;
	plan->layer_count = 0;
	plan->ray_count = 0;
	gz_plan_make_steps(&context, plan);
	if (request->foveation->method == GZ_METHOD_ACUITY ||
	    request->foveation->method == GZ_METHOD_TABLE)
		return gz_plan_ladder(&context, plan);
	return gz_plan_regions(&context, plan);
}

/* Also where the tiles do not depend on it: bricks are fetched by the focus, and the view may have
 * been shifted since. */
static void aim(const struct gz_plan_request *request, struct gz_plan *plan)
{
	const bool known = isfinite(request->gaze.x) && isfinite(request->gaze.y);
	plan->view = (struct gz_plan_view) { request->width, request->height, { 0, 0 } };
	plan->focus_px[0] = (known ? (double)request->gaze.x : 0.5) * request->width - 0.5;
	plan->focus_px[1] = (known ? (double)request->gaze.y : 0.5) * request->height - 0.5;
}

enum gz_result gz_plan_update(const struct gz_plan_request *request, struct gz_plan *plan)
{
	if (!request_valid(request))
		return GZ_ERR_INVAL;
	aim(request, plan);
	if (is_made_for(plan, request))
		return GZ_OK;
	plan->made_for.valid = false;
	plan->serial++;
	const enum gz_result result = make_tiles(request, plan);
	if (result == GZ_OK)
		remember(plan, request);
	return result;
}

struct gz_plan_request gz_plan_request_make(const struct gz_foveation *foveation,
					    const struct gz_display *display, struct gz_point gaze,
					    int width, int height)
{
	return (struct gz_plan_request) {
		.foveation = foveation,
		.display = display,
		.gaze = gaze,
		.width = width,
		.height = height,
		.rays_per_px = 1,
		.scale = 1,
		.steps_per_px = 1,
	};
}

enum gz_result gz_plan_make(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, int width, int height, struct gz_plan *plan)
{
	const struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, width, height);
	return gz_plan_update(&request, plan);
}

void gz_plan_free(struct gz_plan *plan)
{
	free(plan->tiles);
	*plan = (struct gz_plan) { 0 };
}
