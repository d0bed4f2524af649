#include "filter/classify.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* The measured period follows one sixteenth of each new one, and no more than half of itself, so
 * that a gap does not count as a slower rate. Chosen. */
static const double PERIOD_GAIN = 1.0 / 16;

/* A label waits for whole samples; this part of one is kept back for jitter of time stamps. */
static const double DELAY_SLACK = 0.15;

/* At any rate one sample may be missing without a blink; half a period is for jitter. */
static const double DROPOUT_PERIODS = 1.5;

double gz_classify_dropout_ns(const struct gz_classify_state *state,
			      const struct gz_classify_params *params)
{
	/* No longer than a label waits, or the first samples of a blink would be called otherwise.
	 */
	double wait_ns = (double)gz_classify_delay(state, params) * state->period_ns;
	double allowed_ns = fmin(params->dropout_ms * 1e6, wait_ns);
	return fmax(allowed_ns, DROPOUT_PERIODS * state->period_ns);
}

uint64_t gz_classify_delay(const struct gz_classify_state *state,
			   const struct gz_classify_params *params)
{
	if (state->period_ns <= 0)
		return 0;
	double samples = params->final_delay_ms * 1e6 / state->period_ns - DELAY_SLACK;
	return samples < 0                      ? 0
	       : samples > GZ_CLASSIFY_RING / 2 ? GZ_CLASSIFY_RING / 2
						: (uint64_t)samples;
}

static void learn_period(struct gz_classify_state *state, int64_t step_ns)
{
	if (state->period_ns <= 0) {
		state->period_ns = (double)step_ns;
		return;
	}
	double change_ns = (double)step_ns - state->period_ns;
	double limit_ns = 0.5 * state->period_ns;
	state->period_ns += PERIOD_GAIN * fmax(-limit_ns, fmin(limit_ns, change_ns));
}

/** Put the sample into the ring. */
static struct gz_classify_entry *take(struct gz_classify_state *state,
				      const struct gz_classify_params *params,
				      const struct gz_display *display,
				      const struct gz_classify_input *input)
{
	if (state->count > 0)
		learn_period(state,
			     input->time_ns - gz_classify_at(state, state->count - 1)->time_ns);
	bool gap = !state->any_valid ||
		   (double)(input->time_ns - state->valid_ns) >
			   gz_classify_dropout_ns(state, params) + state->period_ns;
	struct gz_classify_entry *entry = gz_classify_at(state, state->count++);
	*entry = (struct gz_classify_entry) {
		.seq = input->seq,
		.time_ns = input->time_ns,
		.point = input->point,
		.confidence = input->confidence,
		.valid = input->valid,
		.after_loss = input->valid && gap,
	};
	if (input->valid)
		gz_direction_deg(display, input->point, entry->direction_deg);
	return entry;
}

/** Follow the trailing speed: is it a saccade, as far as can be told at once? */
static void look_quickly(struct gz_classify_state *state, const struct gz_classify_params *params,
			 const struct gz_classify_entry *entry, double speed_deg_s)
{
	struct gz_classify_quick *quick = &state->quick;
	double peak = params->peak_base_deg_s + params->peak_factor * quick->noise_deg_s.value;
	double end = params->onset_base_deg_s + params->onset_factor * quick->noise_deg_s.value;
	if (entry->after_loss)
		quick->saccade = false;
	if (quick->saccade) {
		quick->peak_deg_s = fmax(quick->peak_deg_s, speed_deg_s);
		bool slow = speed_deg_s < fmax(end, params->end_fraction * quick->peak_deg_s);
		bool late = gz_ns_to_ms(entry->time_ns - quick->since_ns) > params->saccade_max_ms;
		quick->saccade = !slow && !late;
		return;
	}
	if (speed_deg_s > peak) {
		quick->saccade = true;
		quick->peak_deg_s = speed_deg_s;
		quick->since_ns = entry->time_ns;
		return;
	}
	double gain = state->period_ns / (params->noise_memory_s * 1e9);
	gz_median_follow(&quick->noise_deg_s, speed_deg_s, gain);
}

static enum gz_event quick_event(const struct gz_classify_state *state,
				 const struct gz_classify_params *params,
				 const struct gz_classify_entry *entry)
{
	if (!entry->valid) {
		if (!state->any_valid)
			return GZ_EVENT_LOST;
		int64_t since_ns = entry->time_ns - state->valid_ns;
		if ((double)since_ns <= gz_classify_dropout_ns(state, params))
			return state->now;
		return gz_ns_to_ms(since_ns) <= params->blink_max_ms ? GZ_EVENT_BLINK
								     : GZ_EVENT_LOST;
	}
	if (state->quick.saccade)
		return GZ_EVENT_SACCADE;
	if (entry->after_loss || state->machine.event != GZ_EVENT_PURSUIT)
		return GZ_EVENT_FIXATION;
	return GZ_EVENT_PURSUIT;
}

/** Trailing speed of the newest sample, relative to the slow movement; 0 without measurement. */
static double trailing_speed(struct gz_classify_state *state,
			     const struct gz_classify_params *params, double *out_whole_deg_s)
{
	struct gz_classify_window window = {
		.before_ns = params->quick_window_ms * 1e6 + 0.25 * state->period_ns,
	};
	double velocity[3];
	gz_classify_velocity(state, state->count - 1, window, velocity);
	*out_whole_deg_s = gz_length3(velocity);
	for (int i = 0; i < 3; i++)
		velocity[i] -= state->slow.velocity_deg_s[i];
	return gz_length3(velocity);
}

/** Whether the next label has waited long enough. */
static bool is_due(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	if (state->decided)
		return true;
	int64_t now_ns = gz_classify_at(state, state->count - 1)->time_ns;
	int64_t time_ns = gz_classify_at(state, state->certain)->time_ns;
	return state->count - 1 - state->certain >= gz_classify_delay(state, params) ||
	       gz_ns_to_ms(now_ns - time_ns) > params->final_delay_ms;
}

/** Make labels certain that are due, as long as they are the same. */
static void finish(struct gz_classify_state *state, const struct gz_classify_params *params,
		   struct gz_classify_output *out)
{
	while (state->certain < state->count && out->final_count < GZ_CLASSIFY_FINALS_MAX &&
	       is_due(state, params)) {
		const struct gz_classify_entry *entry = gz_classify_at(state, state->certain);
		if (!state->decided) {
			gz_classify_measure(state, params, state->certain + 1, true);
			(void)gz_classify_decide(state, params, state->certain);
		}
		enum gz_event event = state->machine.event;
		state->decided =
			out->final_count > 0 && (event != out->final[0].event || entry->after_loss);
		if (state->decided)
			return;
		out->final[out->final_count++] = (struct gz_classify_final) {
			.seq = entry->seq,
			.time_ns = entry->time_ns,
			.event = event,
			.valid = entry->valid,
			.after_loss = entry->after_loss,
			.point = entry->point,
			.confidence = entry->confidence,
			.peak_deg_s = state->machine.peak_deg_s,
		};
		state->certain++;
	}
}

struct gz_classify_output gz_classify_step(struct gz_classify_state *state,
					   const struct gz_classify_params *params,
					   const struct gz_display *display,
					   const struct gz_classify_input *input)
{
	struct gz_classify_output out;
	out.last_valid_ns = state->valid_ns;
	out.velocity_deg_s = 0;
	out.final_count = 0; /* what lies beyond is not looked at */
	const struct gz_classify_entry *entry = take(state, params, display, input);
	out.resumed = entry->after_loss && state->any_valid;
	if (entry->valid) {
		double speed_deg_s = trailing_speed(state, params, &out.velocity_deg_s);
		look_quickly(state, params, entry, speed_deg_s);
		state->any_valid = true;
		state->valid_ns = entry->time_ns;
	}
	gz_classify_measure(state, params, state->count, false);
	finish(state, params, &out);
	state->now = quick_event(state, params, entry);
	if (out.final_count > 0 && out.final[out.final_count - 1].seq == entry->seq)
		state->now = out.final[out.final_count - 1].event;
	out.event = state->now;
	return out;
}
