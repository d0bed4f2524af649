/* Step lengths: by distance from the gaze, or by what the eye resolves. */
#include <math.h>
#include <string.h>

#include "render/plan/plan_emit.h"

/* Spacings of the rungs: powers of two, and from 2 on the quincunx between them. Chosen: none
 * between 1 and 2, where the display, not the eye, is the limit and the picture shall equal the
 * full one. */
static const double acuity_spacings_px[GZ_ACUITY_RUNGS] = {
	1, 2, 2 * M_SQRT2, 4, 4 * M_SQRT2, 8, 8 * M_SQRT2, 16,
};

int gz_acuity_rung(double spacing_px)
{
	int rung = 0;
	while (rung + 1 < GZ_ACUITY_RUNGS && spacing_px >= acuity_spacings_px[rung + 1])
		rung++;
	return rung;
}

/* Multipliers of the distance rule: a geometric ladder from 1 to 1 / floor, so that one opacity
 * table a rung serves all tiles. A tile takes the rung below its exact multiplier: never coarser
 * than asked. */
static void make_distance_ladder(const struct gz_foveation *foveation, struct gz_plan *plan)
{
	const double top = 1 / foveation->step_floor;
	plan->step_count = top > 1 ? GZ_PLAN_STEPS_MAX : 1;
	for (int i = 0; i < plan->step_count; i++)
		plan->steps[i] = (float)pow(top, (double)i / (GZ_PLAN_STEPS_MAX - 1));
}

/* Steps by rung: docs/foveation.md. Chosen: a step may grow more slowly than the spacing, since
 * errors along a ray show as shape, not only as blur. */
static const float acuity_steps[GZ_ACUITY_RUNGS] = { 1, 1.5F, 1.75F, 2, 2.5F, 3, 3.5F, 4 };

static void make_acuity_ladder(struct gz_plan *plan)
{
	plan->step_count = GZ_ACUITY_RUNGS;
	memcpy(plan->steps, acuity_steps, sizeof acuity_steps);
}

void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan)
{
	switch (context->step_rule) {
	case GZ_STEP_DISTANCE:
		make_distance_ladder(context->foveation, plan);
		return;
	case GZ_STEP_ACUITY:
		make_acuity_ladder(plan);
		return;
	default:
		plan->step_count = 1;
		plan->steps[0] = 1;
		return;
	}
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

/* Bauer 2018, section 4.2.2: rate' = max(sf * rate, floor), sf = 1 - d / diagonal; unchanged within
 * 10 px of the gaze. */
static int distance_step(const struct gz_plan_context *context, const struct gz_plan *plan,
			 double d_px)
{
	enum { UNCHANGED_PX = 10 };
	if (d_px <= UNCHANGED_PX)
		return 0;
	const double diagonal = hypot(context->width, context->height);
	const double share = fmax(1 - d_px / diagonal, context->foveation->step_floor);
	int step = 0;
	while (step + 1 < plan->step_count && plan->steps[step + 1] <= 1 / share)
		step++;
	return step;
}

int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge)
{
	if (plan->step_count == 1)
		return 0;
	const double near_x = clamp(context->gaze_px[0], x, x + edge);
	const double near_y = clamp(context->gaze_px[1], y, y + edge);
	if (context->step_rule == GZ_STEP_ACUITY)
		return gz_acuity_rung(gz_plan_spacing_at(context, near_x, near_y));
	return distance_step(context, plan,
			     hypot(near_x - context->gaze_px[0], near_y - context->gaze_px[1]));
}
