#include "filter/despike.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Time constant of the usual step. Chosen: a few fixations. */
static const double USUAL_S = 1.0;

/* Two samples may be a spike, and not a movement, if their distance is less than this fraction of
 * their distance from where they came from; chosen. */
static const double TOGETHER = 0.5;

static void difference_mm(const struct gz_display *display, struct gz_point from,
			  struct gz_point to, double out_mm[2])
{
	out_mm[0] = ((double)to.x - from.x) * display->mm[0];
	out_mm[1] = ((double)to.y - from.y) * display->mm[1];
}

static double small_angle_deg(const struct gz_display *display, const double mm[2])
{
	/* Small-angle formula for straight ahead: the error is below 20 % on usual displays, and
	 * the results are only compared. */
	return sqrt(mm[0] * mm[0] + mm[1] * mm[1]) / display->distance_mm * GZ_DEG_PER_RAD;
}

/* Whether a step departs from the line of the last step by more than noise. */
static bool departs_from_line(const struct gz_despike_state *state,
			      const struct gz_despike_params *params,
			      const struct gz_display *display, const double step_mm[2])
{
	double limit_deg =
		fmax(params->threshold_deg, params->noise_factor * state->step_deg.value);
	if (small_angle_deg(display, step_mm) <= limit_deg)
		return false;
	if (!state->stepped)
		return true;
	/* A movement speeds up and slows down: the component along the last step, up to three times
	 * that step, is not a departure. */
	double last = state->step_mm[0] * state->step_mm[0] + state->step_mm[1] * state->step_mm[1];
	double along = step_mm[0] * state->step_mm[0] + step_mm[1] * state->step_mm[1];
	double times = last > 0 ? fmax(0, fmin(3, along / last)) : 0;
	double rest_mm[2] = { step_mm[0] - times * state->step_mm[0],
			      step_mm[1] - times * state->step_mm[1] };
	return small_angle_deg(display, rest_mm) > limit_deg;
}

static struct gz_point accept_point(struct gz_despike_state *state,
				    const struct gz_display *display, double step_s,
				    struct gz_point point)
{
	difference_mm(display, state->clean, point, state->step_mm);
	state->stepped = true;
	gz_median_follow(&state->step_deg, small_angle_deg(display, state->step_mm),
			 step_s / (step_s + USUAL_S));
	state->clean = point;
	state->held = 0;
	return point;
}

static struct gz_point hold_point(struct gz_despike_state *state, struct gz_point point)
{
	state->held++;
	state->spike = point;
	return state->clean;
}

/* Whether @p point came back, which makes the held samples a spike. */
static bool has_come_back(const struct gz_despike_state *state, const struct gz_display *display,
			  struct gz_point point)
{
	double away_mm[2], back_mm[2];
	difference_mm(display, state->clean, state->spike, away_mm);
	difference_mm(display, state->clean, point, back_mm);
	return small_angle_deg(display, back_mm) < 0.5 * small_angle_deg(display, away_mm);
}

/* Whether @p point stays with the held one, so that both may be a spike of two samples.
 */
static bool stays_with_held(const struct gz_despike_state *state, const struct gz_display *display,
			    struct gz_point point)
{
	double away_mm[2], further_mm[2];
	difference_mm(display, state->clean, state->spike, away_mm);
	difference_mm(display, state->spike, point, further_mm);
	return small_angle_deg(display, further_mm) < TOGETHER * small_angle_deg(display, away_mm);
}

static struct gz_point restart_despike(struct gz_despike_state *state, int64_t time_ns,
				       struct gz_point point)
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
		return restart_despike(state, time_ns, point);
	int64_t step_ns = time_ns - state->time_ns;
	double step_s = gz_ns_to_s(step_ns), max_delay_ns = params->max_delay_ms * 1e6;
	state->time_ns = time_ns;
	if (state->held == 0) {
		double step_mm[2];
		difference_mm(display, state->clean, point, step_mm);
		state->held_ns = time_ns;
		if ((double)step_ns > max_delay_ns ||
		    !departs_from_line(state, params, display, step_mm))
			return accept_point(state, display, step_s, point);
		return hold_point(state, point);
	}
	if (has_come_back(state, display, point)) {
		state->dropped_count += (uint64_t)state->held;
		return accept_point(state, display, step_s, point);
	}
	/* If this sample is held too, the decision comes one step later. */
	bool time_left = (double)(time_ns - state->held_ns + step_ns) <= max_delay_ns;
	if (state->held == 1 && time_left && stays_with_held(state, display, point))
		return hold_point(state, point);
	return accept_point(state, display, step_s, point);
}
