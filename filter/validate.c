#include "filter/validate.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* How fast the usual disparity is learnt: chosen, slower than any movement of the eyes. */
static const double DISPARITY_S = 1.0;

enum { COMMON = GZ_EYE_COUNT };

/** One place to judge. */
struct measurement {
	struct gz_point point;
	bool valid;
	float confidence; /**< NaN if there is none */
};

static bool on_display(struct gz_point p, double margin)
{
	return p.x >= -margin && p.x <= 1 + margin && p.y >= -margin && p.y <= 1 + margin;
}

static bool too_fast(const struct gz_validate_place *last, const struct gz_validate_params *params,
		     const struct gz_display *display, int64_t time_ns, struct gz_point point)
{
	if (!last->known)
		return false;
	double allowed_deg =
		params->max_velocity_deg_s * gz_ns_to_s(time_ns - last->time_ns) + params->jump_deg;
	return gz_chord_deg(display, last->point, point) > allowed_deg;
}

/** Judge a place alone; the order of the checks is the order of the reasons. */
static enum gz_rejection judge(const struct gz_validate_state *state, int index,
			       const struct gz_validate_params *params,
			       const struct gz_display *display, const struct measurement *m)
{
	if (!m->valid)
		return GZ_REJECT_TRACKER;
	if (m->confidence < params->min_confidence) /* false for NaN */
		return GZ_REJECT_CONFIDENCE;
	if (!isfinite(m->point.x) || !isfinite(m->point.y))
		return GZ_REJECT_NOT_FINITE;
	if (!on_display(m->point, params->margin))
		return GZ_REJECT_OFF_SCREEN;
	if (too_fast(&state->place[index], params, display, state->time_ns, m->point))
		return GZ_REJECT_VELOCITY;
	return GZ_REJECT_NONE;
}

/** How far a place came in judge(). */
static int progress(enum gz_rejection rejection)
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

/** Whether the eyes disagree more than usual; learns what is usual. */
static bool disagree(struct gz_validate_state *state, const struct gz_validate_params *params,
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
	/* Small angle: an overestimate towards the edges, where disparity is larger too. */
	double deg = sqrt(unusual[0] * unusual[0] + unusual[1] * unusual[1]) /
		     display->distance_mm * GZ_DEG_PER_RAD;
	return deg > params->max_disparity_deg;
}

static void remember(struct gz_validate_state *state, int index, struct gz_point point)
{
	state->place[index] = (struct gz_validate_place) {
		.known = true,
		.time_ns = state->time_ns,
		.point = point,
	};
}

static struct gz_validate_output judge_common(struct gz_validate_state *state,
					      const struct gz_validate_params *params,
					      const struct gz_display *display,
					      const struct gz_sample *sample)
{
	struct measurement m = { sample->point, sample->valid, NAN };
	struct gz_validate_output out = { .combined = true };
	out.rejection = judge(state, COMMON, params, display, &m);
	if (out.rejection == GZ_REJECT_NONE)
		remember(state, COMMON, sample->point);
	return out;
}

static bool wanted(const struct gz_validate_params *params, int eye)
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
		if (!wanted(params, i))
			continue;
		const struct gz_eye_sample *eye = &sample->eye[i];
		struct measurement m = { eye->point, eye->valid, eye->confidence };
		enum gz_rejection rejection = judge(state, i, params, display, &m);
		out.eye_good[i] = rejection == GZ_REJECT_NONE;
		if (progress(rejection) > progress(out.rejection))
			out.rejection = rejection;
	}
	if (out.eye_good[GZ_EYE_RIGHT] && out.eye_good[GZ_EYE_LEFT] &&
	    disagree(state, params, display, step_s, sample)) {
		out.rejection = GZ_REJECT_DISPARITY;
		out.eye_good[GZ_EYE_RIGHT] = out.eye_good[GZ_EYE_LEFT] = false;
	}
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		if (out.eye_good[i])
			remember(state, i, sample->eye[i].point);
	return out;
}

static bool eye_point_measured(const struct gz_eye_sample *eye)
{
	return eye->valid || !isnan(eye->point.x) || !isnan(eye->point.y);
}

/* CLOCK_MONOTONIC begins at 0. Times of a damaged log may be any; with these, no difference between
 * two of them, nor a few of those summed, overflows: a century and more. */
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
	if (sample->valid && !eye_point_measured(&sample->eye[GZ_EYE_RIGHT]) &&
	    !eye_point_measured(&sample->eye[GZ_EYE_LEFT]))
		return judge_common(state, params, display, sample);
	return judge_eyes(state, params, display, step_s, sample);
}
