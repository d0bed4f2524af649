/* The certain label of each sample, with the newer ones within the delay already known. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* That the eye hardly moves says something once it was watched for so long: chosen. */
static const double SPAN_FULL_S = 0.1;

/* How long the eye rings after a saccade, when its movement says nothing of pursuit: chosen. */
static const int64_t RINGING_NS = 60 * GZ_NS_PER_MS;

/* The way of an eye counts as far as it is beyond so many deviations of noise: chosen. */
static const double NOISE_DEVIATIONS = 2;

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

static enum gz_event interval_event(const struct gz_classify_machine *machine)
{
	return machine->pursuit > 0 ? GZ_EVENT_PURSUIT : GZ_EVENT_FIXATION;
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
	machine->event = GZ_EVENT_SACCADE;
	machine->since_ns = entry->time_ns;
	machine->peak_deg_s = 0;
	machine->slowed = false;
	follow_peak(machine, entry);
}

/**
 * What noise alone makes of the way of an eye at rest: standard deviation of both axes together.
 *
 * The slope through n samples dt apart has the deviation s sqrt(12 / (n (n^2 - 1))) / dt for
 * samples of the deviation s. That gives s from the usual speed over the short window, whose median
 * is sqrt(2 ln 2) of the deviation of an axis (Rayleigh), and from s that of the long slope.
 */
static double way_noise_deg(const struct gz_classify_state *state,
			    const struct gz_classify_params *params)
{
	double period_s = state->period_ns * 1e-9;
	double half = floor(params->velocity_window_ms * 0.5e-3 / period_s + 0.25);
	double n = gz_classify_delay(state, params) > 0 ? 2 * fmax(half, 1) + 1 : 2;
	double many = fmax(2, state->slow.span_s / period_s);
	double axis_deg_s = state->noise_deg_s.value / 1.17741002;
	double axis_deg = axis_deg_s * period_s * sqrt(n * (n * n - 1) / many);
	return axis_deg * 1.41421356;
}

/**
 * What the slow movement says, -1 fixation to 1 pursuit. Drift wanders about a place however long a
 * fixation lasts; pursuit goes on and on: how far it has come tells more than how fast it is. This
 * is the tangens hyperbolicus of half the logarithm of the way over the even way.
 */
static double evidence_of(const struct gz_classify_state *state,
			  const struct gz_classify_params *params)
{
	double way_deg = gz_length3(state->slow.velocity_deg_s) * state->slow.span_s;
	double noise_deg = NOISE_DEVIATIONS * way_noise_deg(state, params);
	way_deg = sqrt(fmax(0, way_deg * way_deg - noise_deg * noise_deg));
	return (way_deg - params->pursuit_deg) / (way_deg + params->pursuit_deg);
}

/** What the eyes did in the last seconds, they are likely to do next. */
static void learn_habit(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	if (state->slow.span_s < SPAN_FULL_S)
		return;
	struct gz_classify_machine *machine = &state->machine;
	double gain = state->period_ns / (params->pursuit_habit_s * 1e9);
	machine->habit += fmin(gain, 1) * (evidence_of(state, params) - machine->habit);
}

/** Fixation or pursuit? */
static void weigh(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	struct gz_classify_machine *machine = &state->machine;
	double evidence = evidence_of(state, params);
	if (evidence < 0)
		evidence *= fmin(1, state->slow.span_s / SPAN_FULL_S);
	machine->pursuit = evidence + params->pursuit_habit * machine->habit;
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
	gz_median_follow(&state->noise_deg_s, entry->fast_deg_s, gain);
	const struct gz_classify_machine *machine = &state->machine;
	bool ringing =
		machine->had_saccade && entry->time_ns - machine->saccade_end_ns < RINGING_NS;
	bool steady = entry->fast_deg_s < peak_threshold(state, params, entry->time_ns) / 2;
	if (!ringing && steady && gz_classify_slow_step(&state->slow, params, entry))
		weigh(state, params);
	learn_habit(state, params);
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
		begin_interval(state, params);
	}
	if (machine->event == GZ_EVENT_SACCADE) {
		follow_peak(machine, entry);
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
