#include "filter/lid.h"

#include <math.h>

#include "base/clock.h"

/* Over which a change is measured. Chosen: most of the time in which a lid closes. */
static const int64_t WINDOW_NS = 24 * GZ_NS_PER_MS;

/* At low rates it is from sample to sample, but not over more than this. Chosen: a sample at 30 Hz,
 * in which a pupil changes by 6 %. After a longer time the lid may be opening. */
static const int64_t STEP_MAX_NS = 40 * GZ_NS_PER_MS;

/* The lid rests, or has opened, once it was not seen to move for this time. Chosen. */
static const int64_t REST_NS = 20 * GZ_NS_PER_MS;

/* What is covered for longer is a smaller pupil. Chosen: the longest blink, as blink_max_ms. */
static const int64_t COVERED_MAX_NS = 500 * GZ_NS_PER_MS;

/* A change must be this multiple of the usual one: four standard deviations. */
static const double NOISE_FACTOR = 6;

/* Time constant of what is usual, s. Chosen: far longer than a blink. */
static const double USUAL_S = 2;

/* A greater movement across than up and down, above this, is the eye's. */
static const double ACROSS_DEG = 1;

/* A confidence means something else with each tracker, so it must change by this factor more. */
static const double CONFIDENCE_FACTOR = 2;

static const double DEG_PER_RAD = 57.295779513082320877;

static struct gz_lid_entry *lid_entry(struct gz_lid_state *state, uint64_t index)
{
	return &state->ring[index % GZ_LID_RING];
}

static double least_change(const struct gz_lid_state *state, const struct gz_lid_params *params,
			   int measure)
{
	double factor = measure < GZ_EYE_COUNT ? 1 : CONFIDENCE_FACTOR;
	return fmax(factor * params->change, NOISE_FACTOR * state->noise[measure].value);
}

/* The change between two samples as a part of the usual size, of the measure in which it is
 * greatest in comparison with its least change: 1 is that. 0: nothing is measured in both. */
static double change_between(const struct gz_lid_state *state, const struct gz_lid_params *params,
			     const struct gz_lid_entry *a, const struct gz_lid_entry *b)
{
	double greatest = 0;
	for (int m = 0; m < GZ_LID_MEASURES; m++) {
		if (state->usual[m].count == 0)
			continue;
		double change = (b->size[m] - a->size[m]) / state->usual[m].value;
		double part = change / least_change(state, params, m);
		if (fabs(part) > fabs(greatest)) /* false for NaN */
			greatest = part;
	}
	return greatest;
}

/* Whether something is smaller than usual by its least change. */
static bool is_smaller(const struct gz_lid_state *state, const struct gz_lid_params *params,
		       const struct gz_lid_entry *entry)
{
	for (int m = 0; m < GZ_LID_MEASURES; m++)
		if (state->usual[m].count > 0 &&
		    entry->size[m] < state->usual[m].value * (1 - least_change(state, params, m)))
			return true;
	return false;
}

/* Whether the point has moved across rather than up or down. */
static bool moves_across(const struct gz_display *display, const struct gz_lid_entry *a,
			 const struct gz_lid_entry *b)
{
	double deg_per_mm = DEG_PER_RAD / display->distance_mm;
	double across = fabs((double)b->point.x - (double)a->point.x) * display->mm[0] * deg_per_mm;
	double down = fabs((double)b->point.y - (double)a->point.y) * display->mm[1] * deg_per_mm;
	return across > ACROSS_DEG && across > down;
}

/* The oldest sample within the window of the newest one, or the one before it at low rates; the
 * newest one itself if there is none. */
static uint64_t window_begin(struct gz_lid_state *state)
{
	const uint64_t newest = state->count - 1;
	const int64_t now_ns = lid_entry(state, newest)->time_ns;
	if (state->count > state->oldest + GZ_LID_RING)
		state->oldest = state->count - GZ_LID_RING;
	while (now_ns - lid_entry(state, state->oldest)->time_ns > WINDOW_NS)
		state->oldest++;
	const bool alone = state->oldest == newest && newest > 0;
	if (alone && now_ns - lid_entry(state, newest - 1)->time_ns <= STEP_MAX_NS)
		return newest - 1;
	return state->oldest;
}

/* When the change to the newest sample began: after the last sample that is as the first of the
 * window, within a quarter of what counts. */
static int64_t change_begin_ns(struct gz_lid_state *state, const struct gz_lid_params *params,
			       uint64_t first)
{
	uint64_t at = state->count - 1;
	while (at > first + 1 && fabs(change_between(state, params, lid_entry(state, first),
						     lid_entry(state, at - 1))) > 0.25)
		at--;
	return lid_entry(state, at)->time_ns;
}

/* Learn what is usual from an open eye. */
static void learn_usual(struct gz_lid_state *state, const struct gz_lid_entry *first,
			const struct gz_lid_entry *now, int64_t step_ns)
{
	double gain = gz_ns_to_s(step_ns) / USUAL_S;
	for (int m = 0; m < GZ_LID_MEASURES; m++) {
		gz_median_follow(&state->usual[m], now->size[m], gain);
		gz_median_follow(&state->noise[m],
				 fabs(now->size[m] - first->size[m]) / state->usual[m].value, gain);
	}
}

static bool take_measures(const struct gz_sample *sample, struct gz_point point, float confidence,
			  struct gz_lid_entry *out)
{
	bool any = confidence > 0;
	*out = (struct gz_lid_entry) { .time_ns = sample->host_ns, .point = point };
	out->size[GZ_EYE_COUNT] = any ? (double)confidence : NAN;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		double size = (double)sample->eye[i].pupil_mm;
		bool measured = isfinite(size) && size > 0;
		out->size[i] = measured ? size : NAN;
		any |= measured;
	}
	return any && isfinite(point.x) && isfinite(point.y);
}

struct gz_lid_output gz_lid_step(struct gz_lid_state *state, const struct gz_lid_params *params,
				 const struct gz_display *display, const struct gz_sample *sample,
				 struct gz_point point, float confidence)
{
	struct gz_lid_entry entry;
	struct gz_lid_output out = { .covers = false };
	if (params->change <= 0 || !take_measures(sample, point, confidence, &entry))
		return out;
	const int64_t now_ns = entry.time_ns, step_ns = now_ns - state->measured_ns;
	const bool after_loss = state->count > 0 && step_ns > STEP_MAX_NS;
	state->measured_ns = now_ns;
	*lid_entry(state, state->count++) = entry;
	const uint64_t begin = window_begin(state);
	const struct gz_lid_entry *first = lid_entry(state, begin);
	const bool small = is_smaller(state, params, &entry);
	const bool moves = fabs(change_between(state, params, first, &entry)) >= 1 &&
			   !moves_across(display, first, &entry);
	out.since_ns = moves ? change_begin_ns(state, params, begin) : now_ns;
	if (moves || (after_loss && small && step_ns < COVERED_MAX_NS)) {
		state->moved_ns = now_ns;
		state->covers = true;
	} else if (now_ns - state->moved_ns > COVERED_MAX_NS ||
		   (!small && now_ns - state->moved_ns > REST_NS)) {
		state->covers = false;
	}
	if (!state->covers)
		learn_usual(state, first, &entry, step_ns > STEP_MAX_NS ? STEP_MAX_NS : step_ns);
	out.covers = state->covers;
	return out;
}
