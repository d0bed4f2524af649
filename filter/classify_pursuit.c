/*
 * Fixation or pursuit? The way that the eye has come tells, and what it did before.
 *
 * Bayes' rule over two hypotheses. An eye at rest drifts: how far it is from where it was spreads
 * as that of a random walk does, with a variance of spread^2 + drift t on each axis. An eye that
 * follows something has a speed, of which nothing is known but its usual size: the variance grows
 * by (speed t)^2. The quotient of the two densities of the way, both of them normal in the plane,
 * is the Bayes factor (Kass and Raftery, "Bayes factors", Journal of the American Statistical
 * Association 90, 1995). It is bounded, since a fixation may slip, by a small saccade that was not
 * noticed or by the tracker, and what is followed may stand still; but not where the eye went
 * farther than any fixation slips, and less where it hardly went anywhere.
 *
 * Its prior odds come from what the eye did between the saccades before, by a Markov chain with a
 * step at each saccade (forward algorithm: Rabiner, "A tutorial on hidden Markov models", Proc.
 * IEEE 77, 1989, section III.A). In front of a scene at rest there is nothing to follow; in front
 * of one that moves, pursuit begets pursuit. Which scene it is, is not known either.
 */
#include <math.h>
#include <string.h>

#include "filter/angle.h"
#include "filter/classify_internal.h"

/* States of the chain: the scene rests or moves, the eye rests or follows. */
enum { REST_REST, REST_FOLLOW, MOVE_REST, MOVE_FOLLOW, STATES };

_Static_assert(STATES == GZ_CLASSIFY_BELIEFS, "the header's room fits");

/* In front of a moving scene: how often pursuit has ended after a saccade, and how often the first
 * look follows something. Chosen, as the next two; agreement hardly depends on them. */
static const double FOLLOW_ENDS = 0.05;
static const double FOLLOW_FIRST = 0.2;

/* In front of a scene at rest: what is taken for pursuit nevertheless. */
static const double FOLLOW_AT_REST = 0.05;

/* How often a scene may change at a saccade. */
static const double SCENE_CHANGES = 0.02;

/* How far a fixation slips, on an axis. Chosen: below a degree, as small saccades are. */
static const double SLIP_DEG = 0.8;

/* No movement is surer than this: chosen, so that the odds stay numbers. */
static const double FACTOR_MAX = 1e6;

/* Smaller densities are not told apart: beyond any way on a display. */
static const double EXPONENT_MAX = 300;

/** e^-x for 0 and more, within 1 % up to EXPONENT_MAX, by operations that give the same bits
 *  everywhere. */
static double fading(double x)
{
	double y = fmin(x, EXPONENT_MAX) / 4096;
	double e = 1 + y * (1 + y / 2 * (1 + y / 3));
	for (int i = 0; i < 12; i++)
		e *= e;
	return 1 / e;
}

/** A normal density in the plane, with this variance on each axis, at a way from its centre: of
 * what it is at the centre. */
static double faded(double way_deg, double variance_deg2)
{
	return fading(way_deg * way_deg / (2 * variance_deg2));
}

/**
 * What noise alone adds to the variance of the way on each axis, square degrees.
 *
 * The slope through n samples dt apart has the deviation s sqrt(12 / (n (n^2 - 1))) / dt for
 * samples of the deviation s. That gives s from the usual speed over the short window, whose median
 * is sqrt(2 ln 2) of the deviation of an axis (Rayleigh), and from s that of the long slope.
 */
static double way_noise_deg2(const struct gz_classify_state *state,
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

/** What the way says: how many times likelier it is in pursuit than in fixation. */
struct factors {
	double here, next; /**< in this stretch; for those after it */
};

static struct factors bayes_factors(const struct gz_classify_state *state,
				    const struct gz_classify_params *params)
{
	double span_s = state->slow.span_s;
	double way_deg = gz_length3(state->slow.velocity_deg_s) * span_s;
	double pursuit_deg = params->pursuit_speed_deg_s * span_s;
	double at_rest = params->fixation_spread_deg * params->fixation_spread_deg +
			 params->fixation_drift_deg2_s * span_s + way_noise_deg2(state, params);
	double following = at_rest + pursuit_deg * pursuit_deg;
	double slipping = at_rest + SLIP_DEG * SLIP_DEG;
	double factor = at_rest / following * faded(way_deg, following) / faded(way_deg, at_rest);
	double max = params->pursuit_factor_max;
	double bounded = fmax(1 / max, fmin(factor, max));
	/* Not the whole densities: that slips lie wide apart makes none of them a pursuit. */
	double sure = faded(way_deg, following) / faded(way_deg, slipping);
	double here =
		sure > max ? fmin(sure, FACTOR_MAX) : fmax(1 / (max * max), fmin(factor, max));
	return (struct factors) { here, bounded };
}

static void scale(double belief[STATES])
{
	double sum = 0;
	for (int i = 0; i < STATES; i++)
		sum += belief[i];
	for (int i = 0; i < STATES; i++)
		belief[i] /= sum;
}

/** Before anything was seen. */
static void first_belief(const struct gz_classify_params *params, double out[STATES])
{
	double moving = params->pursuit_scenes;
	out[REST_REST] = (1 - moving) * (1 - FOLLOW_AT_REST);
	out[REST_FOLLOW] = (1 - moving) * FOLLOW_AT_REST;
	out[MOVE_REST] = moving * (1 - FOLLOW_FIRST);
	out[MOVE_FOLLOW] = moving * FOLLOW_FIRST;
}

/** One step of the chain. */
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

/** Odds of pursuit against fixation before the running stretch. */
static double odds_before(const struct gz_classify_machine *machine)
{
	const double *belief = machine->belief;
	return (belief[REST_FOLLOW] + belief[MOVE_FOLLOW]) /
	       (belief[REST_REST] + belief[MOVE_REST]);
}

void gz_classify_begin_interval(struct gz_classify_state *state,
				const struct gz_classify_params *params, bool forget)
{
	struct gz_classify_machine *machine = &state->machine;
	gz_classify_slow_restart(&state->slow);
	if (forget || !machine->believes) {
		first_belief(params, machine->belief);
	} else {
		machine->belief[REST_FOLLOW] *= machine->pursuit_factor;
		machine->belief[MOVE_FOLLOW] *= machine->pursuit_factor;
		scale(machine->belief);
		step_belief(params, machine->belief);
	}
	machine->believes = true;
	machine->pursuit_factor = 1;
	machine->event = odds_before(machine) > 1 ? GZ_EVENT_PURSUIT : GZ_EVENT_FIXATION;
}

void gz_classify_weigh(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	struct gz_classify_machine *machine = &state->machine;
	if (state->slow.span_s <= 0)
		return;
	struct factors factors = bayes_factors(state, params);
	machine->pursuit_factor = factors.next;
	double odds = factors.here * odds_before(machine), needed = params->pursuit_hysteresis;
	if (machine->event == GZ_EVENT_FIXATION && odds > needed)
		machine->event = GZ_EVENT_PURSUIT;
	else if (machine->event == GZ_EVENT_PURSUIT && odds * needed < 1)
		machine->event = GZ_EVENT_FIXATION;
}
