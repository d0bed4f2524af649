/* The certain label of each sample, with the newer ones within the delay already known. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* How long the eye rings after a saccade, when its movement says nothing of pursuit: chosen. */
static const int64_t RINGING_NS = 40 * GZ_NS_PER_MS;

static double peak_threshold(const struct gz_classify_state *state,
			     const struct gz_classify_params *params, int64_t time_ns)
{
	const struct gz_classify_machine *machine = &state->machine;
	double threshold = params->peak_base_deg_s + params->peak_factor * state->noise_deg_s.value;
	double since_ms = gz_ns_to_ms(time_ns - machine->saccade_end_ns);
	if (machine->had_saccade && since_ms < params->glissade_ms)
		threshold = fmax(threshold, params->glissade_fraction * machine->peak_deg_s);
	return threshold;
}

static double onset_threshold(const struct gz_classify_state *state,
			      const struct gz_classify_params *params)
{
	return params->onset_base_deg_s + params->onset_factor * state->noise_deg_s.value;
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

/** Speed in the direction that the running saccade had at its peak. */
static double along(const struct gz_classify_machine *machine,
		    const struct gz_classify_entry *entry)
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += machine->heading[i] * entry->velocity_deg_s[i];
	return sum;
}

/** Remember how fast the running saccade is, and where it goes, at its fastest. */
static void follow_peak(struct gz_classify_machine *machine, const struct gz_classify_entry *entry)
{
	if (entry->fast_deg_s <= machine->peak_deg_s)
		return;
	machine->peak_deg_s = entry->fast_deg_s;
	for (int i = 0; i < 3; i++)
		machine->heading[i] = entry->velocity_deg_s[i] / entry->fast_deg_s;
}

/** Whether the running saccade is over at this sample. */
static bool saccade_ends(struct gz_classify_state *state, const struct gz_classify_params *params,
			 uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	double speed = along(machine, entry);
	double end =
		fmax(onset_threshold(state, params), params->end_fraction * machine->peak_deg_s);
	if (speed < end && !machine->slowed) {
		machine->slowed = true;
		machine->slowed_ns = entry->time_ns;
	}
	double after_ns = (double)(entry->time_ns - machine->slowed_ns) + 0.5 * state->period_ns;
	if (machine->slowed && after_ns >= params->end_ms * 1e6)
		return true;
	if (gz_ns_to_ms(entry->time_ns - machine->since_ns) > params->saccade_max_ms)
		return true;
	/* The first minimum after the peak: what follows is the eye's ringing, or another saccade.
	 */
	return speed < params->turn_fraction * machine->peak_deg_s && index + 1 < state->measured &&
	       gz_classify_at(state, index + 1)->valid &&
	       along(machine, gz_classify_at(state, index + 1)) > speed;
}

static void begin_saccade(struct gz_classify_state *state, const struct gz_classify_entry *entry)
{
	struct gz_classify_machine *machine = &state->machine;
	machine->event = GZ_EVENT_SACCADE;
	machine->since_ns = entry->time_ns;
	machine->peak_deg_s = 0;
	machine->slowed = false;
	follow_peak(machine, entry);
}

/** A sample between saccades. */
static void go_on_interval(struct gz_classify_state *state, const struct gz_classify_params *params,
			   const struct gz_classify_entry *entry)
{
	double gain = state->period_ns / (params->noise_memory_s * 1e9);
	gz_median_follow(&state->noise_deg_s, entry->fast_deg_s, gain);
	const struct gz_classify_machine *machine = &state->machine;
	bool ringing =
		machine->had_saccade && entry->time_ns - machine->saccade_end_ns < RINGING_NS;
	bool steady = entry->fast_deg_s < peak_threshold(state, params, entry->time_ns) / 2;
	if (!ringing && steady && gz_classify_slow_step(&state->slow, params, entry))
		gz_classify_weigh(state, params);
}

static void decide_good(struct gz_classify_state *state, const struct gz_classify_params *params,
			uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	bool anew = entry->after_loss || machine->event == GZ_EVENT_BLINK ||
		    machine->event == GZ_EVENT_LOST;
	if (anew) {
		machine->had_saccade = false;
		memset(state->slow.velocity_deg_s, 0, sizeof state->slow.velocity_deg_s);
		gz_classify_begin_interval(state, params, machine->event == GZ_EVENT_LOST);
	}
	if (machine->event == GZ_EVENT_SACCADE) {
		follow_peak(machine, entry);
		if (!saccade_ends(state, params, index))
			return;
		machine->had_saccade = true;
		machine->saccade_end_ns = entry->time_ns;
		gz_classify_begin_interval(state, params, false);
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
