#include "filter/combine.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Least noise that is assumed for an eye, degrees. Chosen: far below any tracker's noise, so that a
 * point that the tracker holds still does not get all the weight. */
static const double LEAST_STEP_DEG = 1e-3;

/* Longest time between two samples whose step counts as noise; chosen. */
static const int64_t STEP_MAX_NS = 50 * GZ_NS_PER_MS;

bool gz_correct_usable(const struct gz_correct_params *params)
{
	for (int i = 0; i < 3; i++)
		if (!isfinite(params->x[i]) || !isfinite(params->y[i]))
			return false;
	double area = params->x[1] * params->y[2] - params->x[2] * params->y[1];
	return isfinite(area) && fabs(area) >= GZ_CORRECT_LEAST_AREA;
}

struct gz_point gz_correct_point(const struct gz_correct_params *params, struct gz_point point)
{
	if (!isfinite(point.x) || !isfinite(point.y))
		return point;
	const double *x = params->x, *y = params->y;
	return (struct gz_point) { (float)(x[0] + x[1] * point.x + x[2] * point.y),
				   (float)(y[0] + y[1] * point.x + y[2] * point.y) };
}

void gz_correct_step(const struct gz_correct_params *params, struct gz_sample *sample)
{
	sample->point = gz_correct_point(params, sample->point);
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		sample->eye[i].point = gz_correct_point(params, sample->eye[i].point);
}

/* The weight of a new value after @p step_s, for a time constant of @p constant_ms. */
static double gain_after(double step_s, double constant_ms)
{
	double constant_s = constant_ms * 1e-3;
	return step_s / (step_s + constant_s);
}

static void learn_eye_noise(struct gz_combine_eye *eye, const struct gz_combine_params *params,
			    const struct gz_display *display, int64_t time_ns,
			    struct gz_point point)
{
	int64_t step_ns = time_ns - eye->time_ns;
	if (eye->seen && step_ns <= STEP_MAX_NS) {
		double step_deg = gz_chord_deg(display, eye->point, point);
		gz_median_follow(&eye->step_deg, fmax(step_deg, LEAST_STEP_DEG),
				 gain_after(gz_ns_to_s(step_ns), params->noise_ms));
	}
}

/* The weight of each good eye: the inverse of its variance. */
static void weigh_eyes(const struct gz_combine_state *state, const bool good[GZ_EYE_COUNT],
		       double out_share[GZ_EYE_COUNT])
{
	double noise[GZ_EYE_COUNT], sum = 0;
	bool known = true;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		noise[i] = state->eye[i].step_deg.value;
		known = known && noise[i] > 0;
	}
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		out_share[i] = !good[i] ? 0 : known ? 1 / (noise[i] * noise[i]) : 1;
		sum += out_share[i];
	}
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		out_share[i] /= sum;
}

/* Set the offset of an eye that is seen for the first time, beside one that was seen before, so
 * that the point stays where it is. */
static void set_first_offset(struct gz_combine_state *state, const struct gz_sample *sample,
			     int newcomer)
{
	struct gz_combine_eye *eye = &state->eye[newcomer];
	const struct gz_combine_eye *other = &state->eye[1 - newcomer];
	if (eye->seen || !other->seen)
		return;
	struct gz_point mine = sample->eye[newcomer].point;
	struct gz_point its = sample->eye[1 - newcomer].point;
	eye->offset[0] = its.x + other->offset[0] - mine.x;
	eye->offset[1] = its.y + other->offset[1] - mine.y;
}

/* Both eyes are there: move the offsets towards those that give the plain weighted mean. Their
 * weighted sum goes to zero, so the combined point soon is the plain mean; it is so at once if
 * nothing was learnt before. */
static void learn_eye_offsets(struct gz_combine_state *state,
			      const struct gz_combine_params *params,
			      const struct gz_sample *sample, const double share[GZ_EYE_COUNT])
{
	struct gz_point right = sample->eye[GZ_EYE_RIGHT].point;
	struct gz_point left = sample->eye[GZ_EYE_LEFT].point;
	double mean[2] = { share[GZ_EYE_RIGHT] * right.x + share[GZ_EYE_LEFT] * left.x,
			   share[GZ_EYE_RIGHT] * right.y + share[GZ_EYE_LEFT] * left.y };
	int64_t newest_ns = state->eye[0].time_ns > state->eye[1].time_ns ? state->eye[0].time_ns
									  : state->eye[1].time_ns;
	bool begun = state->eye[0].seen || state->eye[1].seen;
	double step_s = gz_ns_to_s(sample->host_ns - newest_ns);
	double gain = begun ? gain_after(step_s, params->offset_ms) : 1;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		struct gz_combine_eye *eye = &state->eye[i];
		struct gz_point point = sample->eye[i].point;
		eye->offset[0] += gain * (mean[0] - point.x - eye->offset[0]);
		eye->offset[1] += gain * (mean[1] - point.y - eye->offset[1]);
	}
}

static struct gz_point weighted_mean_point(const struct gz_combine_state *state,
					   const struct gz_sample *sample,
					   const bool good[GZ_EYE_COUNT],
					   const double share[GZ_EYE_COUNT])
{
	double x = 0, y = 0;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (!good[i])
			continue;
		x += share[i] * (sample->eye[i].point.x + state->eye[i].offset[0]);
		y += share[i] * (sample->eye[i].point.y + state->eye[i].offset[1]);
	}
	return (struct gz_point) { (float)x, (float)y };
}

static float mean_confidence(const struct gz_sample *sample, const bool good[GZ_EYE_COUNT])
{
	float sum = 0, count = 0;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		float confidence = sample->eye[i].confidence;
		if (!good[i] || isnan(confidence))
			continue;
		sum += confidence < 0 ? 0 : confidence > 1 ? 1 : confidence;
		count++;
	}
	return count > 0 ? sum / count : 1;
}

struct gz_combine_output gz_combine_step(struct gz_combine_state *state,
					 const struct gz_combine_params *params,
					 const struct gz_display *display,
					 const struct gz_sample *sample,
					 const struct gz_validate_output *valid)
{
	if (valid->combined)
		return (struct gz_combine_output) { .point = sample->point, .confidence = 1 };
	const bool *good = valid->eye_good;
	double share[GZ_EYE_COUNT];
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		if (good[i])
			learn_eye_noise(&state->eye[i], params, display, sample->host_ns,
					sample->eye[i].point);
	weigh_eyes(state, good, share);
	if (good[GZ_EYE_RIGHT] && good[GZ_EYE_LEFT]) {
		set_first_offset(state, sample, GZ_EYE_RIGHT);
		set_first_offset(state, sample, GZ_EYE_LEFT);
		learn_eye_offsets(state, params, sample, share);
	}
	struct gz_combine_output output = {
		.point = weighted_mean_point(state, sample, good, share),
		.confidence = mean_confidence(sample, good),
	};
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (!good[i])
			continue;
		state->eye[i].seen = true;
		state->eye[i].point = sample->eye[i].point;
		state->eye[i].time_ns = sample->host_ns;
	}
	return output;
}
