/*
 * The certain label of each sample. The newer samples within the delay are already known.
 *
 * Fixation or pursuit is decided by the distance that the eye has covered, and by what it did
 * before.
 *
 * Bayes' rule is applied to two hypotheses. An eye at rest drifts: its distance from its start
 * spreads like that of a random walk, with a variance of spread^2 + drift t on each axis. An eye
 * that follows something has a speed, of which only the usual size is known: the variance grows by
 * (speed t)^2. The quotient of the two densities of the distance, both normal in the plane, is the
 * Bayes factor (Kass and Raftery, "Bayes factors", Journal of the American Statistical Association
 * 90, 1995). The factor is bounded, because a fixation may slip, by a small saccade that was not
 * detected or by the tracker, and because a followed object may stand still. It is not bounded if
 * the eye went farther than any fixation slips, and bounded less if the eye hardly moved.
 *
 * The prior odds come from what the eye did between the earlier saccades, by a Markov chain with a
 * step at each saccade (forward algorithm: Rabiner, "A tutorial on hidden Markov models", Proc.
 * IEEE 77, 1989, section III.A). In a scene at rest there is nothing to follow; in a moving scene,
 * pursuit makes further pursuit more likely. Which of the two the scene is, is not known either.
 */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* States of the Markov chain: the scene rests or moves, the eye rests or follows. */
enum { REST_REST, REST_FOLLOW, MOVE_REST, MOVE_FOLLOW, STATES };

_Static_assert(STATES == GZ_CLASSIFY_BELIEFS, "classify.h must have room for the states");

/* In a moving scene: how often pursuit ends at a saccade, and how often the first movement is
 * pursuit. These and the next two are chosen; the agreement with human coders hardly depends on
 * them. */
static const double FOLLOW_ENDS = 0.05;
static const double FOLLOW_FIRST = 0.2;

/* In a scene at rest: how often a movement looks like pursuit. */
static const double FOLLOW_AT_REST = 0.05;

/* How often the scene changes at a saccade. */
static const double SCENE_CHANGES = 0.02;

/* How far a fixation may slip on an axis. Chosen: below one degree, as small saccades are. */
static const double SLIP_DEG = 0.8;

/* Greatest Bayes factor. Chosen, so that the odds stay finite. */
static const double FACTOR_MAX = 1e6;

/* Greatest exponent. Larger ones need no distinction: no display is so large. */
static const double EXPONENT_MAX = 300;

/* e^-x for x of 0 or more, within 1 % up to EXPONENT_MAX, by operations that give the same bits on
 * every machine. */
static double negative_exp(double x)
{
	double y = fmin(x, EXPONENT_MAX) / 4096;
	double e = 1 + y * (1 + y / 2 * (1 + y / 3));
	for (int i = 0; i < 12; i++)
		e *= e;
	return 1 / e;
}

/* The density of a normal distribution in the plane at a distance from its centre, relative to that
 * at the centre; the variance is that of each axis. */
static double relative_density(double distance_deg, double variance_deg2)
{
	return negative_exp(distance_deg * distance_deg / (2 * variance_deg2));
}

/*
 * What noise alone adds to the variance of the distance on each axis, square degrees.
 *
 * The slope through n samples dt apart has the standard deviation s sqrt(12 / (n (n^2 - 1))) / dt
 * for samples of the standard deviation s. This gives s from the usual speed over the short window,
 * whose median is sqrt(2 ln 2) times the standard deviation of an axis (Rayleigh distribution); s
 * then gives the standard deviation of the long slope.
 */
static double distance_noise_deg2(const struct gz_classify_state *state,
				  const struct gz_classify_params *params)
{
	double period_s = state->period_ns * 1e-9;
	double half = floor(params->velocity_window_ms * 0.5e-3 / period_s + 0.25);
	double n = gz_classify_delay(state, params) > 0 ? 2 * fmax(half, 1) + 1 : 2;
	double many = fmax(2, state->slow.span_s / period_s);
	double axis_deg_s = state->noise_deg_s.value / 1.17741002;
	double axis_deg = axis_deg_s * period_s * sqrt(n * (n * n - 1) / many);
	return axis_deg * axis_deg;
}

/* How many times more likely the distance is in pursuit than in fixation. */
struct pursuit_factors {
	double here, next; /* for this stretch; for those after it */
};

static struct pursuit_factors pursuit_factors(const struct gz_classify_state *state,
					      const struct gz_classify_params *params)
{
	double span_s = state->slow.span_s;
	double distance_deg = gz_length3(state->slow.velocity_deg_s) * span_s;
	double pursuit_deg = params->pursuit_speed_deg_s * span_s;
	double at_rest = params->fixation_spread_deg * params->fixation_spread_deg +
			 params->fixation_drift_deg2_s * span_s +
			 distance_noise_deg2(state, params);
	double following = at_rest + pursuit_deg * pursuit_deg;
	double slipping = at_rest + SLIP_DEG * SLIP_DEG;
	double factor = at_rest / following * relative_density(distance_deg, following) /
			relative_density(distance_deg, at_rest);
	double max = params->pursuit_factor_max;
	double bounded = fmax(1 / max, fmin(factor, max));
	/* Without the factors before the exponentials: that slips are spread widely does not make
	 * one of them a pursuit. */
	double sure = relative_density(distance_deg, following) /
		      relative_density(distance_deg, slipping);
	double here =
		sure > max ? fmin(sure, FACTOR_MAX) : fmax(1 / (max * max), fmin(factor, max));
	return (struct pursuit_factors) { here, bounded };
}

static void normalise_belief(double belief[STATES])
{
	double sum = 0;
	for (int i = 0; i < STATES; i++)
		sum += belief[i];
	for (int i = 0; i < STATES; i++)
		belief[i] /= sum;
}

/* The belief before anything was seen. */
static void first_belief(const struct gz_classify_params *params, double out[STATES])
{
	double moving = params->pursuit_scenes;
	out[REST_REST] = (1 - moving) * (1 - FOLLOW_AT_REST);
	out[REST_FOLLOW] = (1 - moving) * FOLLOW_AT_REST;
	out[MOVE_REST] = moving * (1 - FOLLOW_FIRST);
	out[MOVE_FOLLOW] = moving * FOLLOW_FIRST;
}

/* Advance the belief by one step of the chain. */
static void step_belief(const struct gz_classify_params *params, double belief[STATES])
{
	double first[STATES], begins = params->pursuit_begins;
	double rest = belief[REST_REST] + belief[REST_FOLLOW];
	double following = belief[MOVE_REST] * begins + belief[MOVE_FOLLOW] * (1 - FOLLOW_ENDS);
	double next[STATES] = {
		rest * (1 - FOLLOW_AT_REST),
		rest * FOLLOW_AT_REST,
		belief[MOVE_REST] + belief[MOVE_FOLLOW] - following,
		following,
	};
	first_belief(params, first);
	for (int i = 0; i < STATES; i++)
		belief[i] = (1 - SCENE_CHANGES) * next[i] + SCENE_CHANGES * first[i];
}

/* Odds of pursuit against fixation before the present stretch. */
static double odds_before(const struct gz_classify_machine *machine)
{
	const double *belief = machine->belief;
	return (belief[REST_FOLLOW] + belief[MOVE_FOLLOW]) /
	       (belief[REST_REST] + belief[MOVE_REST]);
}

/* A stretch between saccades begins: take what the last one was into the belief, and label this one
 * by the belief alone. If @p forget, earlier stretches say nothing. */
static void begin_stretch(struct gz_classify_state *state, const struct gz_classify_params *params,
			  bool forget)
{
	struct gz_classify_machine *machine = &state->machine;
	gz_classify_slow_restart(&state->slow);
	if (forget || !machine->believes) {
		first_belief(params, machine->belief);
	} else {
		machine->belief[REST_FOLLOW] *= machine->pursuit_factor;
		machine->belief[MOVE_FOLLOW] *= machine->pursuit_factor;
		normalise_belief(machine->belief);
		step_belief(params, machine->belief);
	}
	machine->believes = true;
	machine->pursuit_factor = 1;
	machine->event = odds_before(machine) > 1 ? GZ_EVENT_PURSUIT : GZ_EVENT_FIXATION;
}

/* Decide between fixation and pursuit after the slow movement was measured again. */
static void weigh_pursuit(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	struct gz_classify_machine *machine = &state->machine;
	if (state->slow.span_s <= 0)
		return;
	struct pursuit_factors factors = pursuit_factors(state, params);
	machine->pursuit_factor = factors.next;
	double odds = factors.here * odds_before(machine), needed = params->pursuit_hysteresis;
	if (machine->event == GZ_EVENT_FIXATION && odds > needed)
		machine->event = GZ_EVENT_PURSUIT;
	else if (machine->event == GZ_EVENT_PURSUIT && odds * needed < 1)
		machine->event = GZ_EVENT_FIXATION;
}

/*
 * Saccades, blinks and losses.
 */

/* How long the eye rings after a saccade. Its movement then says nothing about pursuit. Chosen. */
static const int64_t RINGING_NS = 40 * GZ_NS_PER_MS;

static double saccade_peak_threshold(const struct gz_classify_state *state,
				     const struct gz_classify_params *params, int64_t time_ns)
{
	const struct gz_classify_machine *machine = &state->machine;
	double threshold = params->peak_base_deg_s + params->peak_factor * state->noise_deg_s.value;
	double since_ms = gz_ns_to_ms(time_ns - machine->saccade_end_ns);
	if (machine->had_saccade && since_ms < params->glissade_ms)
		threshold = fmax(threshold, params->glissade_fraction * machine->peak_deg_s);
	return threshold;
}

static double saccade_onset_threshold(const struct gz_classify_state *state,
				      const struct gz_classify_params *params)
{
	return params->onset_base_deg_s + params->onset_factor * state->noise_deg_s.value;
}

/* Whether a saccade begins: from here up to a peak the speed stays above the onset threshold. */
static bool has_saccade_begun(struct gz_classify_state *state,
			      const struct gz_classify_params *params, uint64_t index)
{
	double onset = saccade_onset_threshold(state, params);
	double peak = saccade_peak_threshold(state, params, gz_classify_at(state, index)->time_ns);
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

/* The speed in the direction that the running saccade had at its peak. */
static double speed_along_heading(const struct gz_classify_machine *machine,
				  const struct gz_classify_entry *entry)
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += machine->heading[i] * entry->velocity_deg_s[i];
	return sum;
}

/* Update the peak speed of the running saccade and its direction there. */
static void update_saccade_peak(struct gz_classify_machine *machine,
				const struct gz_classify_entry *entry)
{
	if (entry->fast_deg_s <= machine->peak_deg_s)
		return;
	machine->peak_deg_s = entry->fast_deg_s;
	for (int i = 0; i < 3; i++)
		machine->heading[i] = entry->velocity_deg_s[i] / entry->fast_deg_s;
}

/* Whether the running saccade has ended at this sample. */
static bool has_saccade_ended(struct gz_classify_state *state,
			      const struct gz_classify_params *params, uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	double speed = speed_along_heading(machine, entry);
	double end = fmax(saccade_onset_threshold(state, params),
			  params->end_fraction * machine->peak_deg_s);
	if (speed < end && !machine->slowed) {
		machine->slowed = true;
		machine->slowed_ns = entry->time_ns;
	}
	double after_ns = (double)(entry->time_ns - machine->slowed_ns) + 0.5 * state->period_ns;
	if (machine->slowed && after_ns >= params->end_ms * 1e6)
		return true;
	if (gz_ns_to_ms(entry->time_ns - machine->since_ns) > params->saccade_max_ms)
		return true;
	/* The first minimum after the peak: the eye's ringing or another saccade follows. */
	return speed < params->turn_fraction * machine->peak_deg_s && index + 1 < state->measured &&
	       gz_classify_at(state, index + 1)->valid &&
	       speed_along_heading(machine, gz_classify_at(state, index + 1)) > speed;
}

static void begin_certain_saccade(struct gz_classify_state *state,
				  const struct gz_classify_entry *entry)
{
	struct gz_classify_machine *machine = &state->machine;
	machine->event = GZ_EVENT_SACCADE;
	machine->since_ns = entry->time_ns;
	machine->peak_deg_s = 0;
	machine->slowed = false;
	update_saccade_peak(machine, entry);
}

/* Take a sample between saccades. */
static void take_between_saccades(struct gz_classify_state *state,
				  const struct gz_classify_params *params,
				  const struct gz_classify_entry *entry)
{
	double gain = state->period_ns / (params->noise_memory_s * 1e9);
	gz_median_follow(&state->noise_deg_s, entry->fast_deg_s, gain);
	const struct gz_classify_machine *machine = &state->machine;
	bool ringing =
		machine->had_saccade && entry->time_ns - machine->saccade_end_ns < RINGING_NS;
	bool steady = entry->fast_deg_s < saccade_peak_threshold(state, params, entry->time_ns) / 2;
	if (!ringing && steady && gz_classify_slow_step(&state->slow, params, entry) &&
	    !entry->still_scene)
		weigh_pursuit(state, params);
}

/* Take the learned label of a sample. */
static void take_learned_label(struct gz_classify_state *state,
			       const struct gz_classify_entry *entry)
{
	struct gz_classify_machine *machine = &state->machine;
	enum gz_event event = gz_classify_event_of(entry->learned);
	bool begins = machine->event != GZ_EVENT_SACCADE || entry->after_loss;
	if (event != GZ_EVENT_SACCADE)
		machine->event = event;
	else if (begins)
		begin_certain_saccade(state, entry);
	else
		update_saccade_peak(machine, entry);
}

static void decide_good_sample(struct gz_classify_state *state,
			       const struct gz_classify_params *params, uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	const struct gz_classify_entry *entry = gz_classify_at(state, index);
	bool anew = entry->after_loss || machine->event == GZ_EVENT_BLINK ||
		    machine->event == GZ_EVENT_LOST;
	if (anew) {
		machine->had_saccade = false;
		memset(state->slow.velocity_deg_s, 0, sizeof state->slow.velocity_deg_s);
		begin_stretch(state, params, machine->event == GZ_EVENT_LOST);
	}
	if (machine->event == GZ_EVENT_SACCADE) {
		update_saccade_peak(machine, entry);
		if (!has_saccade_ended(state, params, index))
			return;
		machine->had_saccade = true;
		machine->saccade_end_ns = entry->time_ns;
		begin_stretch(state, params, false);
		take_between_saccades(state, params, entry);
	} else if (has_saccade_begun(state, params, index)) {
		begin_certain_saccade(state, entry);
	} else {
		take_between_saccades(state, params, entry);
	}
}

/* Whether a good sample is the first one after a blink or loss. Learned labels need this anew: the
 * certain label may find that a sample shows the eye, or does not, after the immediate one said
 * otherwise. */
static bool ends_loss(const struct gz_classify_state *state,
		      const struct gz_classify_params *params,
		      const struct gz_classify_entry *entry)
{
	const struct gz_classify_machine *machine = &state->machine;
	return !machine->any_valid ||
	       (double)(entry->time_ns - machine->valid_ns) >
		       gz_classify_dropout_ns(state, params) + state->period_ns;
}

/* Whether a sample without a measurement belongs to a blink or loss, not to a short dropout. */
static bool is_within_loss(struct gz_classify_state *state, const struct gz_classify_params *params,
			   uint64_t index)
{
	if (!state->machine.any_valid)
		return true;
	for (uint64_t i = index + 1; i < state->count; i++) {
		const struct gz_classify_entry *entry = gz_classify_at(state, i);
		if (gz_classify_is_good(params, entry))
			return params->source == GZ_CLASSIFY_LEARNED
				       ? ends_loss(state, params, entry)
				       : entry->after_loss;
	}
	int64_t newest_ns = gz_classify_at(state, state->count - 1)->time_ns;
	return (double)(newest_ns - state->machine.valid_ns) >
	       gz_classify_dropout_ns(state, params);
}

static void decide_missing_sample(struct gz_classify_state *state,
				  const struct gz_classify_params *params, uint64_t index)
{
	struct gz_classify_machine *machine = &state->machine;
	if (!gz_classify_at(state, index)->lid && !is_within_loss(state, params, index))
		return; /* the label stays */
	double since_ms = gz_ns_to_ms(gz_classify_at(state, index)->time_ns - machine->valid_ns);
	bool blink = machine->any_valid && since_ms <= params->blink_max_ms;
	machine->event = blink ? GZ_EVENT_BLINK : GZ_EVENT_LOST;
}

static void decide_sample(struct gz_classify_state *state, const struct gz_classify_params *params,
			  uint64_t index)
{
	struct gz_classify_entry *entry = gz_classify_at(state, index);
	if (!gz_classify_is_good(params, entry)) {
		decide_missing_sample(state, params, index);
		return;
	}
	if (params->source == GZ_CLASSIFY_LEARNED) {
		entry->after_loss = ends_loss(state, params, entry);
		take_learned_label(state, entry);
	} else
		decide_good_sample(state, params, index);
	state->machine.any_valid = true;
	state->machine.valid_ns = entry->time_ns;
}

void gz_classify_decide(struct gz_classify_state *state, const struct gz_classify_params *params,
			uint64_t index)
{
	decide_sample(state, params, index);
	/* A pursuit that ran when the scene became still, or a belief in one, goes no further. */
	if (gz_classify_at(state, index)->still_scene && state->machine.event == GZ_EVENT_PURSUIT)
		state->machine.event = GZ_EVENT_FIXATION;
}
