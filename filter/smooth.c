#include "filter/smooth.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* How much of each new distance enters the short mean that notices a movement: chosen, so that one
 * stray sample does not, and two or three in a row do. */
static const double NOTICE = 0.5;

/* Time constant of the usual distance: chosen, some fixations long. */
static const double USUAL_S = 1.0;

static void place_at(struct gz_smooth_state *state, struct gz_point point)
{
	state->place[0] = point.x;
	state->place[1] = point.y;
	state->velocity[0] = state->velocity[1] = 0;
	state->offset[0] = state->offset[1] = 0;
	state->window_s = 0;
}

static double offset_deg(const struct gz_display *display, const double offset[2])
{
	double x_mm = offset[0] * display->mm[0], y_mm = offset[1] * display->mm[1];
	return sqrt(x_mm * x_mm + y_mm * y_mm) / display->distance_mm * GZ_DEG_PER_RAD;
}

/** Follow how far the measured points usually are, and notice when the eye has moved. */
static bool moved_away(struct gz_smooth_state *state, const struct gz_smooth_params *params,
		       const struct gz_display *display, double step_s, struct gz_point point)
{
	double now[2] = { point.x - state->place[0], point.y - state->place[1] };
	for (int axis = 0; axis < 2; axis++)
		state->offset[axis] += NOTICE * (now[axis] - state->offset[axis]);
	double limit_deg = fmax(params->drift_deg, params->drift_factor * state->usual_deg.value);
	bool moved = offset_deg(display, state->offset) > limit_deg;
	gz_median_follow(&state->usual_deg, offset_deg(display, now), step_s / (step_s + USUAL_S));
	return moved;
}

static void smooth_fixation(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			    const struct gz_display *display, double step_s, struct gz_point point)
{
	if (moved_away(state, params, display, step_s, point)) {
		place_at(state, point);
		return;
	}
	state->window_s = fmin(state->window_s + step_s, params->window_ms * 1e-3);
	double gain = step_s / (state->window_s + step_s);
	state->place[0] += gain * (point.x - state->place[0]);
	state->place[1] += gain * (point.y - state->place[1]);
}

/** Whether the eye, said to be in a saccade, is still within the noise of where it rested: a false
 *  alarm as far as one can see. */
static bool has_not_left(const struct gz_smooth_state *state, const struct gz_smooth_params *params,
			 const struct gz_display *display, struct gz_point point)
{
	double away[2] = { point.x - state->place[0], point.y - state->place[1] };
	double limit_deg = fmax(params->leave_deg, params->leave_factor * state->usual_deg.value);
	return offset_deg(display, away) < limit_deg;
}

/** Fading memory of order one: Brookner, "Tracking and Kalman filtering made easy", 1998, section
 *  1.2.6: alpha = 1 - theta^2, beta = (1 - theta)^2. */
static void smooth_pursuit(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			   double step_s, struct gz_point point)
{
	double constant_s = params->pursuit_ms * 1e-3;
	double theta = constant_s / (constant_s + step_s);
	double alpha = 1 - theta * theta, beta = (1 - theta) * (1 - theta);
	const double measured[2] = { point.x, point.y };
	for (int axis = 0; axis < 2; axis++) {
		double expected = state->place[axis] + state->velocity[axis] * step_s;
		double surprise = measured[axis] - expected;
		state->place[axis] = expected + alpha * surprise;
		state->velocity[axis] += beta / step_s * surprise;
	}
	state->window_s = constant_s; /* should a fixation follow */
	state->offset[0] = state->offset[1] = 0;
}

/** @return how it was smoothed */
static enum gz_event smooth_by_mode(struct gz_smooth_state *state,
				    const struct gz_smooth_params *params,
				    const struct gz_display *display, enum gz_event event,
				    double step_s, struct gz_point point)
{
	switch (event) {
	case GZ_EVENT_FIXATION:
		if (state->mode != GZ_EVENT_PURSUIT && state->mode != GZ_EVENT_FIXATION)
			place_at(state, point);
		else
			smooth_fixation(state, params, display, step_s, point);
		state->velocity[0] = state->velocity[1] = 0;
		break;
	case GZ_EVENT_PURSUIT:
		smooth_pursuit(state, params, step_s, point);
		break;
	case GZ_EVENT_SACCADE:
		if (state->mode == GZ_EVENT_FIXATION &&
		    has_not_left(state, params, display, point)) {
			smooth_fixation(state, params, display, step_s, point);
			return GZ_EVENT_FIXATION;
		}
		place_at(state, point);
		break;
	default:
		place_at(state, point);
		break;
	}
	return event;
}

struct gz_point gz_smooth_step(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			       const struct gz_display *display, enum gz_event event,
			       int64_t time_ns, bool valid, struct gz_point point)
{
	if (!state->started && !valid)
		return (struct gz_point) { 0.5f, 0.5f };
	if (!valid)
		return state->point;
	int64_t step_ns = time_ns - state->time_ns;
	if (!state->started || step_ns <= 0 || step_ns > GZ_SMOOTH_GAP_NS)
		place_at(state, point);
	else
		event = smooth_by_mode(state, params, display, event, gz_ns_to_s(step_ns), point);
	state->started = true;
	state->mode = event;
	state->time_ns = time_ns;
	state->point = (struct gz_point) { (float)state->place[0], (float)state->place[1] };
	return state->point;
}
