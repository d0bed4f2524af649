#include "filter/smooth.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Time constant of the short mean that notices a movement: chosen, so that one stray sample does
 * not count for much. */
static const double NOTICE_S = 0.01;

/* Time constant of the usual distance: chosen, some fixations long. */
static const double USUAL_S = 1.0;

/* Of white noise, a distance from the mean is this part of a distance between two samples: one
 * deviation against that of a difference. */
static const double STEP_PART = 0.70710678118654752;

/** Begin anew at a point. */
static void place_at(struct gz_smooth_state *state, struct gz_point point)
{
	state->place[0] = point.x;
	state->place[1] = point.y;
	state->velocity[0] = state->velocity[1] = 0;
	state->offset[0] = state->offset[1] = 0;
	state->window_s = 0;
}

/** Begin anew at a point, and let what is given glide there. */
static void glide_to(struct gz_smooth_state *state, struct gz_point point)
{
	state->glide[0] += state->place[0] - point.x;
	state->glide[1] += state->place[1] - point.y;
	place_at(state, point);
}

/** Begin anew at a point at once. */
static void jump_to(struct gz_smooth_state *state, struct gz_point point)
{
	state->glide[0] = state->glide[1] = 0;
	place_at(state, point);
}

static double offset_deg(const struct gz_display *display, const double offset[2])
{
	double x_mm = offset[0] * display->mm[0], y_mm = offset[1] * display->mm[1];
	return sqrt(x_mm * x_mm + y_mm * y_mm) / display->distance_mm * GZ_DEG_PER_RAD;
}

/** Follow how far the measured points are from the place, and what of it is noise. */
static void measure_offset(struct gz_smooth_state *state, const struct gz_display *display,
			   double step_s, struct gz_point point)
{
	double now[2] = { point.x - state->place[0], point.y - state->place[1] };
	double gain = step_s / (step_s + NOTICE_S);
	for (int axis = 0; axis < 2; axis++)
		state->offset[axis] += gain * (now[axis] - state->offset[axis]);
	/* From step to step, so that a slow movement does not pass for noise. */
	double step[2] = { point.x - state->measured[0], point.y - state->measured[1] };
	gz_median_follow(&state->usual_deg, STEP_PART * offset_deg(display, step),
			 step_s / (step_s + USUAL_S));
}

/** The mean of a window that has grown since the eye came to rest, and is shorter the more the
 *  place lags behind. */
static void smooth_fixation(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			    const struct gz_display *display, double step_s, struct gz_point point)
{
	measure_offset(state, display, step_s, point);
	double limit_deg = fmax(params->drift_deg, params->drift_factor * state->usual_deg.value);
	double lag = offset_deg(display, state->offset) / limit_deg;
	state->window_s = fmin(state->window_s + step_s, params->window_ms * 1e-3);
	double window_s = fmax(state->window_s / (1 + lag * lag), params->start_ms * 1e-3);
	double gain = step_s / (window_s + step_s);
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

/** Follow a saccade: one that is still small, and may be noise, by gliding, so that the place goes
 *  on should the eye come back; a larger one at once. */
static void follow_saccade(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			   const struct gz_display *display, double step_s, struct gz_point point)
{
	double away[2] = { point.x - state->place[0], point.y - state->place[1] };
	if (state->mode != GZ_EVENT_SACCADE)
		state->passing = false;
	if (offset_deg(display, away) > params->pass_deg)
		state->passing = true;
	if (state->passing) {
		jump_to(state, point);
		return;
	}
	double constant_s = params->glide_ms * 1e-3;
	for (int axis = 0; axis < 2; axis++)
		state->glide[axis] += step_s / constant_s * away[axis]; /* glide() does the rest */
}

/** @return how it was smoothed */
static enum gz_event smooth_by_mode(struct gz_smooth_state *state,
				    const struct gz_smooth_params *params,
				    const struct gz_display *display, enum gz_event event,
				    double step_s, struct gz_point point)
{
	switch (event) {
	case GZ_EVENT_FIXATION:
		smooth_fixation(state, params, display, step_s, point);
		state->velocity[0] = state->velocity[1] = 0;
		break;
	case GZ_EVENT_PURSUIT:
		if (state->mode == GZ_EVENT_FIXATION)
			glide_to(state, point);
		else
			smooth_pursuit(state, params, step_s, point);
		break;
	case GZ_EVENT_SACCADE:
		if (state->mode == GZ_EVENT_FIXATION &&
		    has_not_left(state, params, display, point)) {
			smooth_fixation(state, params, display, step_s, point);
			return GZ_EVENT_FIXATION;
		}
		follow_saccade(state, params, display, step_s, point);
		break;
	default:
		jump_to(state, point);
		break;
	}
	return event;
}

/** What is left of the glide after a step. */
static void glide(struct gz_smooth_state *state, const struct gz_smooth_params *params,
		  double step_s)
{
	double constant_s = params->glide_ms * 1e-3;
	for (int axis = 0; axis < 2; axis++)
		state->glide[axis] *= constant_s / (constant_s + step_s);
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
	if (!state->started || step_ns <= 0 || step_ns > GZ_SMOOTH_GAP_NS ||
	    state->mode == GZ_EVENT_BLINK || state->mode == GZ_EVENT_LOST) {
		jump_to(state, point);
	} else {
		event = smooth_by_mode(state, params, display, event, gz_ns_to_s(step_ns), point);
		glide(state, params, gz_ns_to_s(step_ns));
	}
	state->started = true;
	state->mode = event;
	state->time_ns = time_ns;
	state->measured[0] = point.x;
	state->measured[1] = point.y;
	state->point = (struct gz_point) { (float)(state->place[0] + state->glide[0]),
					   (float)(state->place[1] + state->glide[1]) };
	return state->point;
}
