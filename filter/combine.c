#include "filter/combine.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* No eye is believed to be more steady than this, degrees: chosen, far below any tracker's noise,
 * so that a point held still by the tracker does not get all the weight. */
static const double LEAST_STEP_DEG = 1e-3;

/* A step is one between neighbouring samples, not across a loss: chosen. */
static const int64_t STEP_MAX_NS = 50 * GZ_NS_PER_MS;

/** How much of the new is taken after @p step_s with a time constant of @p constant_ms. */
static double gain_of(double step_s, double constant_ms)
{
	double constant_s = constant_ms * 1e-3;
	return step_s / (step_s + constant_s);
}

static void learn_noise(struct gz_combine_eye *eye, const struct gz_combine_params *params,
			const struct gz_display *display, int64_t time_ns, struct gz_point point)
{
	int64_t step_ns = time_ns - eye->time_ns;
	if (eye->seen && step_ns <= STEP_MAX_NS) {
		double step_deg = gz_chord_deg(display, eye->point, point);
		gz_median_follow(&eye->step_deg, fmax(step_deg, LEAST_STEP_DEG),
				 gain_of(gz_ns_to_s(step_ns), params->noise_ms));
	}
}

/** The share of each good eye: inverse variance. */
static void share_out(const struct gz_combine_state *state, const bool good[GZ_EYE_COUNT],
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

/** Give an eye that comes in for the first time, beside one that was there before, the offset that
 *  keeps the point where it is. */
static void welcome(struct gz_combine_state *state, const struct gz_sample *sample, int newcomer)
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

/**
 * With both eyes there, let the offsets go to where the plain weighted mean would put them. Their
 * weighted sum goes to zero by it: the joined point is the plain mean before long, and at once
 * where there was nothing before.
 */
static void learn_offsets(struct gz_combine_state *state, const struct gz_combine_params *params,
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
	double gain = begun ? gain_of(step_s, params->offset_ms) : 1;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		struct gz_combine_eye *eye = &state->eye[i];
		struct gz_point point = sample->eye[i].point;
		eye->offset[0] += gain * (mean[0] - point.x - eye->offset[0]);
		eye->offset[1] += gain * (mean[1] - point.y - eye->offset[1]);
	}
}

static struct gz_point join(const struct gz_combine_state *state, const struct gz_sample *sample,
			    const bool good[GZ_EYE_COUNT], const double share[GZ_EYE_COUNT])
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

void gz_combine_step(struct gz_combine_state *state, const struct gz_combine_params *params,
		     const struct gz_display *display, const struct gz_sample *sample,
		     const struct gz_validate_output *valid, struct gz_point *out_point,
		     float *out_confidence)
{
	if (valid->combined) {
		*out_point = sample->point;
		*out_confidence = 1;
		return;
	}
	const bool *good = valid->eye_good;
	double share[GZ_EYE_COUNT];
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		if (good[i])
			learn_noise(&state->eye[i], params, display, sample->host_ns,
				    sample->eye[i].point);
	share_out(state, good, share);
	if (good[GZ_EYE_RIGHT] && good[GZ_EYE_LEFT]) {
		welcome(state, sample, GZ_EYE_RIGHT);
		welcome(state, sample, GZ_EYE_LEFT);
		learn_offsets(state, params, sample, share);
	}
	*out_point = join(state, sample, good, share);
	*out_confidence = mean_confidence(sample, good);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (!good[i])
			continue;
		state->eye[i].seen = true;
		state->eye[i].point = sample->eye[i].point;
		state->eye[i].time_ns = sample->host_ns;
	}
}
