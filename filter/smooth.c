#include "filter/smooth.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Time constant of the short mean that detects a movement. Chosen so that a single stray sample has
 * little weight. */
static const double NOTICE_S = 0.01;

/* Time constant of the usual distance. Chosen: a few fixations. */
static const double USUAL_S = 1.0;

/* Shortest time constant with which the mean follows an eye that has moved away from it. Chosen: a
 * pursuit that is labelled as a fixation is not followed later than by a mean of 100 ms. */
static const double FOLLOW_S = 0.02;

/* For white noise, the distance of a sample from the mean is this fraction of the distance between
 * two samples: the ratio of their standard deviations. */
static const double STEP_PART = 0.70710678118654752;

/* Start again at a point. */
static void restart_at(struct gz_smooth_state *state, struct gz_point point)
{
	state->place[0] = point.x;
	state->place[1] = point.y;
	state->velocity[0] = state->velocity[1] = 0;
	state->offset[0] = state->offset[1] = 0;
	state->window_s = 0;
}

/* Start again at a point; the returned point glides there. */
static void glide_to(struct gz_smooth_state *state, struct gz_point point)
{
	state->glide[0] += state->place[0] - point.x;
	state->glide[1] += state->place[1] - point.y;
	restart_at(state, point);
}

/* Start again at a point; the returned point jumps there. */
static void jump_to(struct gz_smooth_state *state, struct gz_point point)
{
	state->glide[0] = state->glide[1] = 0;
	restart_at(state, point);
}

static double offset_deg(const struct gz_display *display, const double offset[2])
{
	double x_mm = offset[0] * display->mm[0], y_mm = offset[1] * display->mm[1];
	return sqrt(x_mm * x_mm + y_mm * y_mm) / display->distance_mm * GZ_DEG_PER_RAD;
}

/* Measure how far the points are from the place, and how much of that is noise. */
static void learn_distance(struct gz_smooth_state *state, const struct gz_display *display,
			   double step_s, struct gz_point point)
{
	double now[2] = { point.x - state->place[0], point.y - state->place[1] };
	double gain = step_s / (step_s + NOTICE_S);
	for (int axis = 0; axis < 2; axis++)
		state->offset[axis] += gain * (now[axis] - state->offset[axis]);
	/* Noise is measured from sample to sample, so that slow movement does not count as noise.
	 */
	double step[2] = { point.x - state->measured[0], point.y - state->measured[1] };
	gz_median_follow(&state->usual_deg, STEP_PART * offset_deg(display, step),
			 step_s / (step_s + USUAL_S));
}

/* The mean over a window that grows while the eye rests. Within the limit the mean hardly moves;
 * beyond it, the window becomes shorter with the fourth power of how far the mean is behind. */
static void smooth_fixation(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			    const struct gz_display *display, double step_s, struct gz_point point)
{
	learn_distance(state, display, step_s, point);
	double limit_deg = fmax(params->drift_deg, params->drift_factor * state->usual_deg.value);
	double lag = offset_deg(display, state->offset) / limit_deg, lag2 = lag * lag;
	double longest_s = params->window_ms * 1e-3, first_s = params->start_ms * 1e-3;
	state->window_s = fmin(fmax(state->window_s + step_s, first_s), longest_s);
	double window_s =
		fmax(state->window_s / (1 + lag2 * lag2), fmin(FOLLOW_S, state->window_s));
	double gain = step_s / (window_s + step_s);
	state->place[0] += gain * (point.x - state->place[0]);
	state->place[1] += gain * (point.y - state->place[1]);
}

static double away_deg(const struct gz_smooth_state *state, const struct gz_display *display,
		       struct gz_point point)
{
	const double away[2] = { point.x - state->place[0], point.y - state->place[1] };
	return offset_deg(display, away);
}

/* Whether the eye, which is labelled as in a saccade, is still within the noise of where it rested:
 * the label may be wrong. */
static bool has_not_left(const struct gz_smooth_state *state, const struct gz_smooth_params *params,
			 const struct gz_display *display, struct gz_point point)
{
	double limit_deg = fmax(params->leave_deg, params->leave_factor * state->usual_deg.value);
	return away_deg(state, display, point) < limit_deg;
}

/* Fading-memory filter of order one: Brookner, "Tracking and Kalman filtering made easy", 1998,
 * section 1.2.6: alpha = 1 - theta^2, beta = (1 - theta)^2. */
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
	state->window_s = constant_s; /* for a fixation that may follow */
	state->offset[0] = state->offset[1] = 0;
}

/* Let the returned point glide towards a point; the place stays. */
static void glide_after(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			double step_s, struct gz_point point)
{
	const double part = step_s / (params->glide_ms * 1e-3);
	state->glide[0] += part * (point.x - state->place[0]); /* glide_on() does the rest */
	state->glide[1] += part * (point.y - state->place[1]);
}

/* Follow a saccade. While it is small and may be noise the point glides after it and the place
 * stays, in case the eye comes back; a larger one is followed at once. */
static void smooth_saccade(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			   const struct gz_display *display, double step_s, struct gz_point point)
{
	if (state->mode != GZ_EVENT_SACCADE)
		state->passing = false;
	if (away_deg(state, display, point) > params->pass_deg)
		state->passing = true;
	if (state->passing)
		jump_to(state, point);
	else
		glide_after(state, params, step_s, point);
}

/* Smooth a point by its label. @return how it was smoothed */
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
		smooth_saccade(state, params, display, step_s, point);
		break;
	default:
		if (state->mode == GZ_EVENT_FIXATION &&
		    has_not_left(state, params, display, point)) {
			smooth_fixation(state, params, display, step_s, point);
			return GZ_EVENT_FIXATION;
		}
		jump_to(state, point);
		break;
	}
	return event;
}

/* Let the glide decay over a step. */
static void glide_on(struct gz_smooth_state *state, const struct gz_smooth_params *params,
		     double step_s)
{
	double constant_s = params->glide_ms * 1e-3;
	for (int axis = 0; axis < 2; axis++)
		state->glide[axis] *= constant_s / (constant_s + step_s);
}

struct gz_point gz_smooth_step(struct gz_smooth_state *state, const struct gz_smooth_params *params,
			       const struct gz_display *display,
			       const struct gz_smooth_input *input)
{
	struct gz_point point = input->point;
	enum gz_event event = input->event;
	if (!state->started && !input->valid)
		return (struct gz_point) { 0.5f, 0.5f };
	if (!input->valid)
		return state->point;
	int64_t step_ns = input->time_ns - state->time_ns;
	if (!state->started || step_ns <= 0 || step_ns > GZ_SMOOTH_GAP_NS ||
	    state->mode == GZ_EVENT_BLINK || state->mode == GZ_EVENT_LOST) {
		jump_to(state, point);
	} else {
		event = smooth_by_mode(state, params, display, event, gz_ns_to_s(step_ns), point);
		glide_on(state, params, gz_ns_to_s(step_ns));
	}
	state->started = true;
	state->mode = event;
	state->time_ns = input->time_ns;
	state->measured[0] = point.x;
	state->measured[1] = point.y;
	state->point = (struct gz_point) { (float)(state->place[0] + state->glide[0]),
					   (float)(state->place[1] + state->glide[1]) };
	return state->point;
}
