/* Step lengths: by distance from the gaze, or by what the eye resolves. */
#include <math.h>
#include <string.h>

#include "render/plan/plan_emit.h"

/* Powers of two, and from 2 on the quincunx between them. Chosen: none between 1 and 2, where the
 * display, not the eye, is the limit and the picture shall equal the full one. */
const double gz_ladder_px[GZ_LADDER_RUNGS] = {
	1, 2, 2 * M_SQRT2, 4, 4 * M_SQRT2, 8, 8 * M_SQRT2, 16, 16 * M_SQRT2, 32,
};

int gz_ladder_rung(double spacing_px)
{
	int rung = 0;
	while (rung + 1 < GZ_LADDER_RUNGS && spacing_px >= gz_ladder_px[rung + 1])
		rung++;
	return rung;
}

/* Multipliers of the distance rule and of tables: a geometric ladder from 1 to the longest, so that
 * one opacity table a rung serves all tiles. A tile takes the rung below its exact multiplier:
 * never coarser than asked. */
static void make_even_ladder(double top, struct gz_plan *plan)
{
	plan->step_count = top > 1 ? GZ_PLAN_STEPS_MAX : 1;
	for (int i = 0; i < plan->step_count; i++)
		plan->steps[i] = (float)pow(top, (double)i / (GZ_PLAN_STEPS_MAX - 1));
}

/* Steps by rung: docs/foveation.md. Chosen: a step may grow more slowly than the spacing, since
 * errors along a ray show as shape, not only as blur. */
static const float acuity_steps[GZ_LADDER_RUNGS] = {
	1, 2, 2.5F, 3, 3.5F, 4, 5, 6, 7, 8,
};

/* Past this a ray sees nothing of a volume. */
static const double step_max = 16;

static void make_acuity_ladder(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->step_count = GZ_LADDER_RUNGS;
	for (int i = 0; i < GZ_LADDER_RUNGS; i++) {
		const double most = fmax(1, context->steps_per_px * gz_ladder_px[i]);
		plan->steps[i] = (float)fmin((double)acuity_steps[i], most);
	}
}

static void make_table_ladder(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_plan_curve *step = &context->step;
	const double top =
		step->value[step->count - 1] * context->scale_all * context->scale_outside;
	make_even_ladder(fmin(top, step_max), plan);
}

void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->step_count = 1;
	plan->steps[0] = 1;
	switch (context->steps) {
	case GZ_STEPS_DISTANCE:
		make_even_ladder(1 / context->foveation->step_floor, plan);
		return;
	case GZ_STEPS_RUNG:
		make_acuity_ladder(context, plan);
		return;
	case GZ_STEPS_TABLE:
		make_table_ladder(context, plan);
		return;
	case GZ_STEPS_ONE:
		return;
	}
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

/* The longest step that is no longer than asked. */
static int rung_below(const struct gz_plan *plan, double step)
{
	int rung = 0;
	while (rung + 1 < plan->step_count && (double)plan->steps[rung + 1] <= step)
		rung++;
	return rung;
}

/* Bauer 2018, section 4.2.2: rate' = max(sf * rate, floor), sf = 1 - d / diagonal; unchanged within
 * 10 px of the gaze. */
static int distance_step(const struct gz_plan_context *context, const struct gz_plan *plan,
			 double d_px)
{
	enum { UNCHANGED_PX = 10 };
	if (d_px <= UNCHANGED_PX * context->rays_per_px)
		return 0;
	const double share = fmax(1 - d_px / context->diagonal_px, context->foveation->step_floor);
	return rung_below(plan, 1 / share);
}

int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge)
{
	if (plan->step_count == 1)
		return 0;
	const double near_x = clamp(context->gaze_px[0], x, x + edge);
	const double near_y = clamp(context->gaze_px[1], y, y + edge);
	if (context->steps == GZ_STEPS_TABLE)
		return rung_below(plan, gz_plan_table_step_at(context, near_x, near_y));
	if (context->steps == GZ_STEPS_RUNG)
		return gz_ladder_rung(gz_plan_spacing_at(context, near_x, near_y));
	/* A picture's sides are far from where squares overflow: hypot() costs three times a root.
	 */
	const double x_px = near_x - context->gaze_px[0], y_px = near_y - context->gaze_px[1];
	return distance_step(context, plan, sqrt(x_px * x_px + y_px * y_px));
}
