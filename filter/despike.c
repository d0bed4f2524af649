#include "filter/despike.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Time constant of the usual step: chosen, some fixations long. */
static const double USUAL_S = 1.0;

/* A pair of samples is a two-sample spike, not a movement, while they lie this much closer to each
 * other than to where they came from: chosen. */
static const double TOGETHER = 0.5;

static void difference_mm(const struct gz_display *display, struct gz_point from,
			  struct gz_point to, double out_mm[2])
{
	out_mm[0] = ((double)to.x - from.x) * display->mm[0];
	out_mm[1] = ((double)to.y - from.y) * display->mm[1];
}

static double length_deg(const struct gz_display *display, const double mm[2])
{
	/* Small angle, straight ahead: within 20 % on any usual display, and only compared. */
	return sqrt(mm[0] * mm[0] + mm[1] * mm[1]) / display->distance_mm * GZ_DEG_PER_RAD;
}

/** Whether @p step leaves the line of the last step by more than noise. */
static bool departs(const struct gz_despike_state *state, const struct gz_despike_params *params,
		    const struct gz_display *display, const double step_mm[2])
{
	double limit_deg =
		fmax(params->threshold_deg, params->noise_factor * state->step_deg.value);
	if (length_deg(display, step_mm) <= limit_deg)
		return false;
	if (!state->stepped)
		return true;
	/* A movement speeds up and slows down: the part of the step that the last one foretells,
	 * up to three times of it, is no departure. */
	double last = state->step_mm[0] * state->step_mm[0] + state->step_mm[1] * state->step_mm[1];
	double along = step_mm[0] * state->step_mm[0] + step_mm[1] * state->step_mm[1];
	double times = last > 0 ? fmax(0, fmin(3, along / last)) : 0;
	double rest_mm[2] = { step_mm[0] - times * state->step_mm[0],
			      step_mm[1] - times * state->step_mm[1] };
	return length_deg(display, rest_mm) > limit_deg;
}

static struct gz_point accept(struct gz_despike_state *state, const struct gz_display *display,
			      double step_s, struct gz_point point)
{
	difference_mm(display, state->clean, point, state->step_mm);
	state->stepped = true;
	gz_median_follow(&state->step_deg, length_deg(display, state->step_mm),
			 step_s / (step_s + USUAL_S));
	state->clean = point;
	state->held = 0;
	return point;
}

static struct gz_point hold(struct gz_despike_state *state, struct gz_point point)
{
	state->held++;
	state->spike = point;
	return state->clean;
}

/** Whether the held samples turn out to be a spike, now that @p point came back. */
static bool came_back(const struct gz_despike_state *state, const struct gz_display *display,
		      struct gz_point point)
{
	double away_mm[2], back_mm[2];
	difference_mm(display, state->clean, state->spike, away_mm);
	difference_mm(display, state->clean, point, back_mm);
	return length_deg(display, back_mm) < 0.5 * length_deg(display, away_mm);
}

/** Whether @p point stays with the held one, so that both may be a two-sample spike. */
static bool stays(const struct gz_despike_state *state, const struct gz_display *display,
		  struct gz_point point)
{
	double away_mm[2], further_mm[2];
	difference_mm(display, state->clean, state->spike, away_mm);
	difference_mm(display, state->spike, point, further_mm);
	return length_deg(display, further_mm) < TOGETHER * length_deg(display, away_mm);
}

static struct gz_point begin(struct gz_despike_state *state, int64_t time_ns, struct gz_point point)
{
	*state = (struct gz_despike_state) {
		.started = true,
		.time_ns = time_ns,
		.clean = point,
		.step_deg = state->step_deg,
		.dropped_count = state->dropped_count,
	};
	return point;
}

struct gz_point gz_despike_step(struct gz_despike_state *state,
				const struct gz_despike_params *params,
				const struct gz_display *display, int64_t time_ns,
				struct gz_point point, bool restart)
{
	if (!state->started || restart)
		return begin(state, time_ns, point);
	int64_t step_ns = time_ns - state->time_ns;
	double step_s = gz_ns_to_s(step_ns), max_delay_ns = params->max_delay_ms * 1e6;
	state->time_ns = time_ns;
	if (state->held == 0) {
		double step_mm[2];
		difference_mm(display, state->clean, point, step_mm);
		state->held_ns = time_ns;
		if ((double)step_ns > max_delay_ns || !departs(state, params, display, step_mm))
			return accept(state, display, step_s, point);
		return hold(state, point);
	}
	if (came_back(state, display, point)) {
		state->dropped_count += (uint64_t)state->held;
		return accept(state, display, step_s, point);
	}
	/* Held once more, the next sample may come one step later. */
	bool time_left = (double)(time_ns - state->held_ns + step_ns) <= max_delay_ns;
	if (state->held == 1 && time_left && stays(state, display, point))
		return hold(state, point);
	return accept(state, display, step_s, point);
}
