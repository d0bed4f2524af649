#include "filter/validate.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Time constant for learning the usual disparity. Chosen: longer than any movement of the eyes. */
static const double DISPARITY_S = 1.0;

enum { COMMON = GZ_EYE_COUNT };

/* One point to judge. */
struct measurement {
	struct gz_point point;
	bool valid;
	float confidence; /* NaN if there is none */
};

static bool is_within_margin(struct gz_point p, double margin)
{
	return p.x >= -margin && p.x <= 1 + margin && p.y >= -margin && p.y <= 1 + margin;
}

static bool is_too_fast(const struct gz_validate_place *last,
			const struct gz_validate_params *params, const struct gz_display *display,
			int64_t time_ns, struct gz_point point)
{
	if (!last->known)
		return false;
	double allowed_deg =
		params->max_velocity_deg_s * gz_ns_to_s(time_ns - last->time_ns) + params->jump_deg;
	return gz_chord_deg(display, last->point, point) > allowed_deg;
}

/* Judge one point. The order of the checks is the order of the reasons. */
static enum gz_rejection judge_point(const struct gz_validate_state *state, int index,
				     const struct gz_validate_params *params,
				     const struct gz_display *display, const struct measurement *m)
{
	if (!m->valid)
		return GZ_REJECT_TRACKER;
	if (m->confidence < params->min_confidence) /* false for NaN */
		return GZ_REJECT_CONFIDENCE;
	if (!isfinite(m->point.x) || !isfinite(m->point.y))
		return GZ_REJECT_NOT_FINITE;
	if (!is_within_margin(m->point, params->margin))
		return GZ_REJECT_OFF_SCREEN;
	if (is_too_fast(&state->place[index], params, display, state->time_ns, m->point))
		return GZ_REJECT_VELOCITY;
	return GZ_REJECT_NONE;
}

/* How many checks of judge_point() a point passed. */
static int checks_passed(enum gz_rejection rejection)
{
	switch (rejection) {
	case GZ_REJECT_NONE:
		return 5;
	case GZ_REJECT_VELOCITY:
		return 4;
	case GZ_REJECT_OFF_SCREEN:
		return 3;
	case GZ_REJECT_NOT_FINITE:
		return 2;
	case GZ_REJECT_CONFIDENCE:
		return 1;
	default:
		return 0;
	}
}

/* Whether the eyes disagree too much beyond their usual disparity, which is learnt here. */
static bool eyes_disagree(struct gz_validate_state *state, const struct gz_validate_params *params,
			  const struct gz_display *display, double step_s,
			  const struct gz_sample *sample)
{
	struct gz_point right = sample->eye[GZ_EYE_RIGHT].point;
	struct gz_point left = sample->eye[GZ_EYE_LEFT].point;
	double unusual[2] = { (left.x - right.x) * display->mm[0] - state->disparity_mm[0],
			      (left.y - right.y) * display->mm[1] - state->disparity_mm[1] };
	double gain = step_s < DISPARITY_S ? step_s / DISPARITY_S : 1;
	for (int axis = 0; axis < 2; axis++)
		state->disparity_mm[axis] += gain * unusual[axis];
	/* The small-angle formula overestimates towards the edges, where the disparity is larger
	 * too. */
	double deg = sqrt(unusual[0] * unusual[0] + unusual[1] * unusual[1]) /
		     display->distance_mm * GZ_DEG_PER_RAD;
	return deg > params->max_disparity_deg;
}

static void remember_good_point(struct gz_validate_state *state, int index, struct gz_point point)
{
	state->place[index] = (struct gz_validate_place) {
		.known = true,
		.time_ns = state->time_ns,
		.point = point,
	};
}

static struct gz_validate_output judge_common_point(struct gz_validate_state *state,
						    const struct gz_validate_params *params,
						    const struct gz_display *display,
						    const struct gz_sample *sample)
{
	struct measurement m = { sample->point, sample->valid, NAN };
	struct gz_validate_output out = { .combined = true };
	out.rejection = judge_point(state, COMMON, params, display, &m);
	if (out.rejection == GZ_REJECT_NONE)
		remember_good_point(state, COMMON, sample->point);
	return out;
}

static bool is_eye_enabled(const struct gz_validate_params *params, int eye)
{
	return params->eyes == GZ_VALIDATE_EYES_BOTH ||
	       (params->eyes == GZ_VALIDATE_EYES_LEFT) == (eye == GZ_EYE_LEFT);
}

static struct gz_validate_output judge_eyes(struct gz_validate_state *state,
					    const struct gz_validate_params *params,
					    const struct gz_display *display, double step_s,
					    const struct gz_sample *sample)
{
	struct gz_validate_output out = { .rejection = GZ_REJECT_TRACKER };
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (!is_eye_enabled(params, i))
			continue;
		const struct gz_eye_sample *eye = &sample->eye[i];
		struct measurement m = { eye->point, eye->valid, eye->confidence };
		enum gz_rejection rejection = judge_point(state, i, params, display, &m);
		out.eye_good[i] = rejection == GZ_REJECT_NONE;
		if (checks_passed(rejection) > checks_passed(out.rejection))
			out.rejection = rejection;
	}
	if (out.eye_good[GZ_EYE_RIGHT] && out.eye_good[GZ_EYE_LEFT] &&
	    eyes_disagree(state, params, display, step_s, sample)) {
		out.rejection = GZ_REJECT_DISPARITY;
		out.eye_good[GZ_EYE_RIGHT] = out.eye_good[GZ_EYE_LEFT] = false;
	}
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		if (out.eye_good[i])
			remember_good_point(state, i, sample->eye[i].point);
	return out;
}

static bool is_eye_point_measured(const struct gz_eye_sample *eye)
{
	return eye->valid || !isnan(eye->point.x) || !isnan(eye->point.y);
}

/* Whether a time is within limits. CLOCK_MONOTONIC begins at 0, and the upper limit is more than a
 * century, but a damaged log may contain any time. Within the limits neither the difference of two
 * times nor the sum of a few differences overflows. */
static bool time_is_usable(int64_t time_ns)
{
	return time_ns >= 0 && time_ns <= INT64_MAX / 2;
}

struct gz_validate_output gz_validate_step(struct gz_validate_state *state,
					   const struct gz_validate_params *params,
					   const struct gz_display *display,
					   const struct gz_sample *sample)
{
	if (!time_is_usable(sample->host_ns) ||
	    (state->started && sample->host_ns <= state->time_ns))
		return (struct gz_validate_output) { .rejection = GZ_REJECT_TIME };
	double step_s = state->started ? gz_ns_to_s(sample->host_ns - state->time_ns) : 0;
	state->started = true;
	state->time_ns = sample->host_ns;
	if (sample->valid && !is_eye_point_measured(&sample->eye[GZ_EYE_RIGHT]) &&
	    !is_eye_point_measured(&sample->eye[GZ_EYE_LEFT]))
		return judge_common_point(state, params, display, sample);
	return judge_eyes(state, params, display, step_s, sample);
}
