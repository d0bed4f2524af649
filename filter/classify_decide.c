/* The certain label of each sample, with the newer ones within the delay already known. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* How much of an interval's outcome enters the habit: chosen, the last four or so count. */
static const double HABIT_GAIN = 0.25;

/* Slow movement is believed in full once it rests on so much time: chosen. */
static const double SPAN_FULL_S = 0.08;

static double peak_threshold(const struct gz_classify_state *state,
			     const struct gz_classify_params *params, int64_t time_ns)
{
	const struct gz_classify_machine *machine = &state->machine;
	double threshold = fmax(params->min_peak_deg_s, params->peak_factor * state->noise_deg_s);
	double since_ms = gz_ns_to_ms(time_ns - machine->saccade_end_ns);
	if (machine->had_saccade && since_ms < params->glissade_ms)
		threshold = fmax(threshold, params->glissade_fraction * machine->peak_deg_s);
	return threshold;
}

static double onset_threshold(const struct gz_classify_state *state,
			      const struct gz_classify_params *params)
{
	return fmax(params->min_onset_deg_s, params->onset_factor * state->noise_deg_s);
}

/** Whether a saccade begins: faster than the onset threshold from here on up to a peak. */
static bool saccade_begins(struct gz_classify_state *state, const struct gz_classify_params *params,
			   uint64_t index)
{
	double onset = onset_threshold(state, params);
	double peak = peak_threshold(state, params, gz_classify_at(state, index)->time_ns);
	for (uint64_t i = index; i < state->measured; i++) {
		const struct gz_classify_entry *entry = gz_classify_at(state, i);
		if (i > index && entry->after_loss)
			return false;
		if (!entry->valid)
			continue;
		if (entry->fast_deg_s <= onset)
			return false;
		if (entry->fast_deg_s > peak)
			return true;
	}
	return false;
}

/** Whether the running saccade is over at this sample. */
static bool saccade_ends(struct gz_classify_state *state, const struct gz_classify_params *params,
			 uint64_t index)
{
	const struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	double speed = entry->fast_deg_s;
	if (speed <
	    fmax(onset_threshold(state, params), params->end_fraction * machine->peak_deg_s))
		return true;
	if (gz_ns_to_ms(entry->time_ns - machine->since_ns) > params->saccade_max_ms)
		return true;
	/* The first minimum after the peak: what follows is the eye's ringing, or another saccade.
	 */
	return speed < params->turn_fraction * machine->peak_deg_s && index + 1 < state->measured &&
	       gz_classify_at(state, index + 1)->valid &&
	       gz_classify_at(state, index + 1)->fast_deg_s > speed;
}

static enum gz_event interval_event(const struct gz_classify_machine *machine)
{
	return machine->pursuit > 0 ? GZ_EVENT_PURSUIT : GZ_EVENT_FIXATION;
}

/** The interval that ends now was a fixation or a pursuit: the next one is likely the same. */
static void learn_habit(struct gz_classify_machine *machine)
{
	if (machine->event != GZ_EVENT_FIXATION && machine->event != GZ_EVENT_PURSUIT)
		return;
	double outcome = machine->event == GZ_EVENT_PURSUIT ? 1 : -1;
	machine->habit += HABIT_GAIN * (outcome - machine->habit);
}

static void begin_interval(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	struct gz_classify_machine *machine = &state->machine;
	gz_classify_slow_restart(&state->slow);
	machine->pursuit = params->pursuit_habit * machine->habit - 1e-9;
	machine->event = interval_event(machine);
}

static void begin_saccade(struct gz_classify_state *state, const struct gz_classify_entry *entry)
{
	struct gz_classify_machine *machine = &state->machine;
	learn_habit(machine);
	machine->event = GZ_EVENT_SACCADE;
	machine->since_ns = entry->time_ns;
	machine->peak_deg_s = entry->fast_deg_s;
}

/** Weigh the slow movement: fixation or pursuit. */
static void weigh(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	struct gz_classify_machine *machine = &state->machine;
	double speed = gz_length3(state->slow.velocity_deg_s);
	double even = params->pursuit_velocity_deg_s;
	/* From -1 to 1, the tangens hyperbolicus of half the logarithm of speed / even. */
	double evidence = (speed - even) / (speed + even);
	double trust = fmin(1, state->slow.span_s / SPAN_FULL_S);
	machine->pursuit = trust * evidence + params->pursuit_habit * machine->habit;
	double needed = params->pursuit_hysteresis;
	if (machine->event == GZ_EVENT_FIXATION && machine->pursuit > needed)
		machine->event = GZ_EVENT_PURSUIT;
	else if (machine->event == GZ_EVENT_PURSUIT && machine->pursuit < -needed)
		machine->event = GZ_EVENT_FIXATION;
}

/** A sample between saccades. */
static void go_on_interval(struct gz_classify_state *state, const struct gz_classify_params *params,
			   const struct gz_classify_entry *entry)
{
	double gain = state->period_ns / (params->noise_memory_s * 1e9);
	state->noise_deg_s =
		gz_follow_median(state->noise_deg_s, entry->fast_deg_s + 1e-3, fmin(gain, 0.1));
	if (gz_classify_slow_step(&state->slow, params, entry))
		weigh(state, params);
}

static void decide_good(struct gz_classify_state *state, const struct gz_classify_params *params,
			uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	bool anew = entry->after_loss || machine->event == GZ_EVENT_BLINK ||
		    machine->event == GZ_EVENT_LOST;
	if (anew) {
		learn_habit(machine);
		machine->had_saccade = false;
		memset(state->slow.velocity_deg_s, 0, sizeof state->slow.velocity_deg_s);
		begin_interval(state, params);
	}
	if (machine->event == GZ_EVENT_SACCADE) {
		machine->peak_deg_s = fmax(machine->peak_deg_s, entry->fast_deg_s);
		if (!saccade_ends(state, params, index))
			return;
		machine->had_saccade = true;
		machine->saccade_end_ns = entry->time_ns;
		begin_interval(state, params);
		go_on_interval(state, params, entry);
	} else if (saccade_begins(state, params, index)) {
		begin_saccade(state, entry);
	} else {
		go_on_interval(state, params, entry);
	}
}

/** Whether a sample without measurement belongs to a blink or loss rather than a short dropout. */
static bool within_loss(struct gz_classify_state *state, const struct gz_classify_params *params,
			uint64_t index)
{
	if (!state->machine.any_valid)
		return true;
	for (uint64_t i = index + 1; i < state->count; i++) {
		const struct gz_classify_entry *entry = gz_classify_at(state, i);
		if (entry->valid)
			return entry->after_loss;
	}
	int64_t newest_ns = gz_classify_at(state, state->count - 1)->time_ns;
	return (double)(newest_ns - state->machine.valid_ns) >
	       gz_classify_dropout_ns(state, params);
}

static void decide_missing(struct gz_classify_state *state, const struct gz_classify_params *params,
			   uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	if (!within_loss(state, params, index))
		return; /* goes on as before */
	learn_habit(machine);
	double since_ms = gz_ns_to_ms(gz_classify_at(state, index)->time_ns - machine->valid_ns);
	bool blink = machine->any_valid && since_ms <= params->blink_max_ms;
	machine->event = blink ? GZ_EVENT_BLINK : GZ_EVENT_LOST;
}

enum gz_event gz_classify_decide(struct gz_classify_state *state,
				 const struct gz_classify_params *params, uint64_t index)
{
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	if (!entry->valid) {
		decide_missing(state, params, index);
		return state->machine.event;
	}
	decide_good(state, params, index);
	state->machine.any_valid = true;
	state->machine.valid_ns = entry->time_ns;
	return state->machine.event;
}
