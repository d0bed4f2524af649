#include "bench/filter/baselines.h"

#include <math.h>

static const double TWO_PI = 6.2831853071795865;

/** Share of the new in exponential smoothing: Casiez et al. 2012, equations 2 and 3. */
static double share_of(double cutoff_hz, double step_s)
{
	double constant_s = 1 / (TWO_PI * cutoff_hz);
	return 1 / (1 + constant_s / step_s);
}

double gz_one_euro_step(struct gz_one_euro *state, const struct gz_one_euro_params *params,
			double step_s, double number)
{
	if (!state->started) {
		*state = (struct gz_one_euro) { .started = true, .value = number };
		return number;
	}
	double slope = (number - state->value) / step_s;
	state->derivative +=
		share_of(params->derivative_cutoff_hz, step_s) * (slope - state->derivative);
	double cutoff_hz = params->min_cutoff_hz + params->beta * fabs(state->derivative);
	state->value += share_of(cutoff_hz, step_s) * (number - state->value);
	return state->value;
}

bool gz_is_saccade_by_velocity(double threshold_deg_s, double step_deg, double step_s)
{
	return step_deg > threshold_deg_s * step_s;
}
