#include "filter/classify.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classifier/forest_lists.h"
#include "filter/classify_internal.h"

/* The measured period moves by this fraction towards each new one, and by at most half of itself,
 * so that a gap does not count as a lower rate. Chosen. */
static const double PERIOD_GAIN = 1.0 / 16;

/* A label waits for whole samples. This fraction of a sample is reserved for jitter in the time
 * stamps; chosen. */
static const double DELAY_SLACK = 0.15;

/* At any rate one missing sample is not a blink; the half period is for jitter. */
static const double DROPOUT_PERIODS = 1.5;

double gz_classify_dropout_ns(const struct gz_classify_state *state,
			      const struct gz_classify_params *params)
{
	/* No longer than a label waits: otherwise the first samples of a blink would get another
	 * label. */
	double wait_ns = (double)gz_classify_delay(state, params) * state->period_ns;
	double allowed_ns = fmin(params->dropout_ms * 1e6, wait_ns);
	return fmax(allowed_ns, DROPOUT_PERIODS * state->period_ns);
}

static uint64_t samples_within(const struct gz_classify_state *state, double delay_ms)
{
	if (state->period_ns <= 0)
		return 0;
	double samples = delay_ms * 1e6 / state->period_ns - DELAY_SLACK;
	return samples < 0                      ? 0
	       : samples > GZ_CLASSIFY_RING / 2 ? GZ_CLASSIFY_RING / 2
						: (uint64_t)samples;
}

uint64_t gz_classify_delay(const struct gz_classify_state *state,
			   const struct gz_classify_params *params)
{
	return samples_within(state, params->final_delay_ms);
}

/* The whole samples within this time are the GZ_FOREST_CERTAIN_MS that the forest looks ahead, at
 * any rate that it learned from. Chosen: the preset of final_delay_ms. A label that waits for
 * longer is of the same moment, and one that waits for less is that of the sample itself. */
static const double CERTAIN_WITHIN_MS = 10;

static void learn_sample_period(struct gz_classify_state *state, int64_t step_ns)
{
	if (state->period_ns <= 0) {
		state->period_ns = (double)step_ns;
		return;
	}
	double change_ns = (double)step_ns - state->period_ns;
	double limit_ns = 0.5 * state->period_ns;
	state->period_ns += PERIOD_GAIN * fmax(-limit_ns, fmin(limit_ns, change_ns));
}

/* Add the sample to the ring. */
static struct gz_classify_entry *add_entry(struct gz_classify_state *state,
					   const struct gz_classify_params *params,
					   const struct gz_display *display,
					   const struct gz_classify_input *input)
{
	if (state->count > 0)
		learn_sample_period(
			state, input->time_ns - gz_classify_at(state, state->count - 1)->time_ns);
	double dropout_ns = gz_classify_dropout_ns(state, params) + state->period_ns;
	bool gap = !state->any_valid || (double)(input->time_ns - state->valid_ns) > dropout_ns;
	if (input->valid) {
		state->lost =
			state->lost || (double)(input->time_ns - state->measured_ns) > dropout_ns;
		state->measured_ns = input->time_ns;
	}
	struct gz_classify_entry *entry = gz_classify_at(state, state->count++);
	*entry = (struct gz_classify_entry) {
		.seq = input->seq,
		.time_ns = input->time_ns,
		.point = input->point,
		.confidence = input->confidence,
		.valid = input->valid,
		.lid = input->valid && input->lid,
		.still_scene = params->still_scene || input->still_scene,
		.after_loss = input->valid && gap,
	};
	if (input->valid)
		gz_direction_deg(display, input->point, entry->direction_deg);
	return entry;
}

/* Whether it was the lid that moved is known only after it has moved. */
static void mark_covered_samples(struct gz_classify_state *state, int64_t since_ns)
{
	uint64_t first = state->count > GZ_CLASSIFY_RING ? state->count - GZ_CLASSIFY_RING : 0;
	first = state->certain > first ? state->certain : first;
	for (uint64_t i = state->count; i > first; i--) {
		struct gz_classify_entry *entry = gz_classify_at(state, i - 1);
		if (entry->time_ns < since_ns)
			return;
		entry->lid = entry->valid;
	}
}

/*
 * Speed over short windows, and the slow movement between saccades.
 */

/* Width of a bin. Chosen: as long as a certain label waits; the ring holds 600 ms of bins. */
static const int64_t BIN_NS = 10 * GZ_NS_PER_MS;

/* Shortest time for a slope. Chosen: a shorter one would count the eye's ringing as movement. */
static const double SLOPE_LEAST_S = 0.035;

/* Sums for the slope of a least-squares line. */
struct slope_sums {
	double count, t, tt;
	double p[3], tp[3];
};

static inline void add_to_slope(struct slope_sums *line, double t, const double p[3])
{
	line->count++;
	line->t += t;
	line->tt += t * t;
	for (int i = 0; i < 3; i++) {
		line->p[i] += p[i];
		line->tp[i] += t * p[i];
	}
}

/* @return whether the line has a slope; if not, the output is 0 */
static bool slope_of(const struct slope_sums *line, double out_slope[3])
{
	double spread = line->tt - line->t * line->t / fmax(line->count, 1);
	bool has_slope = line->count >= 2 && spread > 1e-12;
	for (int i = 0; i < 3; i++) {
		double together = line->tp[i] - line->t * line->p[i] / fmax(line->count, 1);
		out_slope[i] = has_slope ? together / spread : 0;
	}
	return has_slope;
}

static void add_relative_sample(struct slope_sums *line, const struct gz_classify_entry *entry,
				const struct gz_classify_entry *centre)
{
	double away[3];
	for (int i = 0; i < 3; i++) /* small numbers, which keep their precision in the sums */
		away[i] = entry->direction_deg[i] - centre->direction_deg[i];
	add_to_slope(line, gz_ns_to_s(entry->time_ns - centre->time_ns), away);
}

static void add_samples_before(struct gz_classify_state *state, uint64_t index, double before_ns,
			       struct slope_sums *line)
{
	const struct gz_classify_entry *centre = gz_classify_at(state, index);
	uint64_t oldest = state->count > GZ_CLASSIFY_RING ? state->count - GZ_CLASSIFY_RING : 0;
	bool neighbour = false;
	for (uint64_t i = index; i > oldest && !gz_classify_at(state, i)->after_loss; i--) {
		const struct gz_classify_entry *entry = gz_classify_at(state, i - 1);
		bool inside = (double)(centre->time_ns - entry->time_ns) <= before_ns;
		if (!inside && neighbour)
			return;
		if (!entry->valid)
			continue;
		add_relative_sample(line, entry, centre);
		neighbour = true;
	}
}

static void add_samples_after(struct gz_classify_state *state, uint64_t index, double after_ns,
			      struct slope_sums *line)
{
	const struct gz_classify_entry *centre = gz_classify_at(state, index);
	bool neighbour = false;
	for (uint64_t i = index + 1; i < state->count; i++) {
		const struct gz_classify_entry *entry = gz_classify_at(state, i);
		bool inside = (double)(entry->time_ns - centre->time_ns) <= after_ns;
		if (entry->after_loss || (!inside && neighbour))
			return;
		if (!entry->valid)
			continue;
		add_relative_sample(line, entry, centre);
		neighbour = true;
	}
}

/* A stretch of time around a sample, ns. */
struct time_window {
	double before_ns, after_ns;
};

/* The velocity at sample @p index: the slope of the least-squares line through the good samples of
 * the window. It includes at least the neighbours but nothing beyond a loss. 0 if there is no
 * neighbour. */
static void velocity_at(struct gz_classify_state *state, uint64_t index, struct time_window window,
			double out_deg_s[3])
{
	struct slope_sums line = { .count = 0 };
	const struct gz_classify_entry *centre = gz_classify_at(state, index);
	add_relative_sample(&line, centre, centre);
	add_samples_before(state, index, window.before_ns, &line);
	if (window.after_ns > 0)
		add_samples_after(state, index, window.after_ns, &line);
	(void)slope_of(&line, out_deg_s);
}

/* Measure the speed of sample @p index, less the slow movement. */
static void measure_speed(struct gz_classify_state *state, double half_ns, uint64_t index)
{
	struct gz_classify_entry *entry = gz_classify_at(state, index);
	entry->fast_deg_s = 0;
	if (!entry->valid)
		return;
	struct time_window window = { half_ns, half_ns };
	velocity_at(state, index, window, entry->velocity_deg_s);
	for (int i = 0; i < 3; i++)
		entry->velocity_deg_s[i] -= state->slow.velocity_deg_s[i];
	entry->fast_deg_s = gz_length3(entry->velocity_deg_s);
}

/* Half of the window over which speed is measured. A quarter of a period is added because of jitter
 * in the time stamps. */
static double half_speed_window_ns(const struct gz_classify_state *state,
				   const struct gz_classify_params *params)
{
	return params->velocity_window_ms * 0.5e6 + state->period_ns * 0.25;
}

/* Measure the speed of all samples up to @p end whose window is complete; of all of them if @p
 * force.
 */
static void measure_speeds(struct gz_classify_state *state, const struct gz_classify_params *params,
			   uint64_t end, bool force)
{
	double half_ns = half_speed_window_ns(state, params);
	int64_t newest_ns = gz_classify_at(state, state->count - 1)->time_ns;
	for (; state->measured < end; state->measured++) {
		int64_t time_ns = gz_classify_at(state, state->measured)->time_ns;
		bool complete = (double)(newest_ns - time_ns) >= half_ns - state->period_ns;
		if (!complete && !force)
			return;
		measure_speed(state, half_ns, state->measured);
	}
}

/* Measure what the decision about sample @p index needs. Learned labels need the speed of saccades
 * only, whose peak is told. */
static void measure_for_decision(struct gz_classify_state *state,
				 const struct gz_classify_params *params, uint64_t index)
{
	if (params->source != GZ_CLASSIFY_LEARNED)
		measure_speeds(state, params, index + 1, true);
	else if (gz_classify_at(state, index)->learned == GZ_FOREST_SACCADE)
		measure_speed(state, half_speed_window_ns(state, params), index);
}

void gz_classify_slow_restart(struct gz_classify_slow *slow)
{
	slow->bin_count = 0;
	slow->span_s = 0;
}

static struct gz_classify_bin *bin_at(struct gz_classify_slow *slow, uint64_t index)
{
	return &slow->bins[index % GZ_CLASSIFY_BINS];
}

/* Measure the slope through the means of the bins over the window. */
static void measure_slow_movement(struct gz_classify_slow *slow, double window_s, int64_t now_ns)
{
	struct slope_sums line = { .count = 0 };
	const struct gz_classify_bin *newest = bin_at(slow, slow->bin_count - 1);
	double oldest_s = 0, newest_s = 0;
	for (uint64_t k = 0; k < slow->bin_count && k < GZ_CLASSIFY_BINS; k++) {
		const struct gz_classify_bin *bin = bin_at(slow, slow->bin_count - 1 - k);
		double age_s = gz_ns_to_s(now_ns - bin->start_ns) - bin->time_sum_s / bin->count;
		if (age_s > window_s)
			break;
		double place[3];
		for (int i = 0; i < 3; i++)
			place[i] = bin->direction_sum_deg[i] / bin->count -
				   newest->direction_sum_deg[i] / newest->count;
		add_to_slope(&line, -age_s, place);
		oldest_s = age_s;
		newest_s = k == 0 ? age_s : newest_s;
	}
	double slope[3];
	if (line.count >= 2 && oldest_s - newest_s >= SLOPE_LEAST_S && slope_of(&line, slope)) {
		memcpy(slow->velocity_deg_s, slope, sizeof slope);
		slow->span_s = oldest_s - newest_s;
	}
}

bool gz_classify_slow_step(struct gz_classify_slow *slow, const struct gz_classify_params *params,
			   const struct gz_classify_entry *entry)
{
	struct gz_classify_bin *bin = slow->bin_count ? bin_at(slow, slow->bin_count - 1) : NULL;
	bool closed = bin && entry->time_ns - bin->start_ns >= BIN_NS;
	if (closed)
		measure_slow_movement(slow, params->pursuit_window_ms * 1e-3, entry->time_ns);
	if (!bin || closed) {
		bin = bin_at(slow, slow->bin_count++);
		*bin = (struct gz_classify_bin) { .start_ns = entry->time_ns };
	}
	bin->count++;
	bin->time_sum_s += gz_ns_to_s(entry->time_ns - bin->start_ns);
	for (int i = 0; i < 3; i++)
		bin->direction_sum_deg[i] += entry->direction_deg[i];
	return closed;
}

/*
 * The step, and the immediate label.
 */

/* Update from the trailing speed whether the immediate label is a saccade. */
static void update_quick_saccade(struct gz_classify_state *state,
				 const struct gz_classify_params *params,
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

/* The forests are asked no more often than this. Chosen: the period of the fastest recordings that
 * they learned from, less a quarter for jitter in the time stamps. The features are averages over
 * longer times (SMOOTH_US in classifier/movement.c), so in between they hardly change. */
static const int64_t ASK_NS = 1500 * GZ_NS_PER_US;

/* The forest for certain labels is asked more seldom while the eye has moved slowly for some time:
 * then its labels change between fixation and pursuit only. Chosen: longer than what follows a
 * saccade, and as long as such a label may be late. */
static const int64_t CALM_NS = 60 * GZ_NS_PER_MS;
static const int64_t ASK_CALM_NS = 6 * GZ_NS_PER_MS;

/* Label sample @p index by what a forest makes of the newest features; without them as the sample
 * before. */
static void label_by_forest(struct gz_classify_state *state, const struct gz_forest *forest,
			    struct gz_classify_forest *memory, const float *features,
			    uint64_t index)
{
	int32_t scores[GZ_FOREST_CLASSES];
	struct gz_classify_entry *entry = gz_classify_at(state, index);
	const struct gz_forest_lists *lists = gz_forest_lists_of(forest);
	if (entry->valid && !features) {
		entry->learned = memory->labels.last;
		return;
	}
	if (entry->valid && lists)
		gz_forest_lists_score(lists, &memory->walks, features, scores);
	else if (entry->valid)
		gz_forest_score(forest, features, scores);
	entry->learned =
		gz_forest_label(&memory->labels, entry->valid ? scores : NULL, entry->still_scene);
}

/* Whether the label of sample @p index cannot be that of the sample before. */
static bool needs_own_label(struct gz_classify_state *state, uint64_t index)
{
	if (index == 0)
		return true;
	const struct gz_classify_entry *one = gz_classify_at(state, index);
	const struct gz_classify_entry *before = gz_classify_at(state, index - 1);
	return one->valid != before->valid || one->still_scene != before->still_scene;
}

/* Ask the forests what the newest sample is, and what the one was whose certain label is due. */
static void ask_forests(struct gz_classify_state *state, const struct gz_classify_params *params,
			const struct gz_display *display, const struct gz_classify_input *input)
{
	float features[GZ_MOVEMENT_FEATURES], *asked = NULL, *asked_certain = NULL;
	const struct gz_movement_input measured = { input->time_ns, input->valid, input->raw };
	const uint64_t newest = state->count - 1;
	const uint64_t delay = samples_within(state, CERTAIN_WITHIN_MS);
	const bool certain =
		delay > 0 && delay <= newest && delay <= gz_classify_delay(state, params);
	const bool own_certain = certain && needs_own_label(state, newest - delay);
	if (input->time_ns - state->asked_ns >= ASK_NS || needs_own_label(state, newest) ||
	    own_certain) {
		state->asked_ns = input->time_ns;
		asked = features;
	}
	const bool calm = state->period_ns < (double)ASK_NS &&
			  input->time_ns - state->lively_ns > CALM_NS &&
			  input->time_ns - state->asked_certain_ns < ASK_CALM_NS;
	if (asked && (own_certain || !calm)) {
		state->asked_certain_ns = input->time_ns;
		asked_certain = features;
	}
	if (!gz_movement_step(&state->movement, display, &measured, asked))
		return;
	label_by_forest(state, &gz_forest_at_once, &state->at_once_forest, asked, newest);
	enum gz_forest_class now = gz_classify_at(state, newest)->learned;
	if (now != GZ_FOREST_FIXATION && now != GZ_FOREST_PURSUIT)
		state->lively_ns = input->time_ns;
	if (certain)
		label_by_forest(state, &gz_forest_certain, &state->certain_forest, asked_certain,
				newest - delay);
}

static enum gz_event immediate_label(const struct gz_classify_state *state,
				     const struct gz_classify_params *params,
				     const struct gz_classify_entry *entry)
{
	if (!gz_classify_is_good(params, entry)) {
		if (!state->any_valid)
			return GZ_EVENT_LOST;
		int64_t since_ns = entry->time_ns - state->valid_ns;
		if (!entry->lid && (double)since_ns <= gz_classify_dropout_ns(state, params))
			return state->now;
		return gz_ns_to_ms(since_ns) <= params->blink_max_ms ? GZ_EVENT_BLINK
								     : GZ_EVENT_LOST;
	}
	if (params->source == GZ_CLASSIFY_LEARNED)
		return gz_classify_event_of(entry->learned);
	if (state->quick.saccade)
		return GZ_EVENT_SACCADE;
	if (entry->after_loss || state->machine.event != GZ_EVENT_PURSUIT)
		return GZ_EVENT_FIXATION;
	return GZ_EVENT_PURSUIT;
}

/* The trailing speed of the newest sample, less the slow movement. *out_whole_deg_s includes the
 * slow movement. */
static double trailing_speed(struct gz_classify_state *state,
			     const struct gz_classify_params *params, double *out_whole_deg_s)
{
	struct time_window window = {
		.before_ns = params->quick_window_ms * 1e6 + 0.25 * state->period_ns,
	};
	double velocity[3];
	velocity_at(state, state->count - 1, window, velocity);
	*out_whole_deg_s = gz_length3(velocity);
	for (int i = 0; i < 3; i++)
		velocity[i] -= state->slow.velocity_deg_s[i];
	return gz_length3(velocity);
}

/* Whether the next certain label is due. */
static bool is_label_due(struct gz_classify_state *state, const struct gz_classify_params *params)
{
	if (state->decided)
		return true;
	int64_t now_ns = gz_classify_at(state, state->count - 1)->time_ns;
	int64_t time_ns = gz_classify_at(state, state->certain)->time_ns;
	return state->count - 1 - state->certain >= gz_classify_delay(state, params) ||
	       gz_ns_to_ms(now_ns - time_ns) > params->final_delay_ms;
}

/* Decide the certain labels that are due, or all, as long as they are equal. */
static void emit_certain_labels(struct gz_classify_state *state,
				const struct gz_classify_params *params, bool all,
				struct gz_classify_output *out)
{
	while (state->certain < state->count && out->final_count < GZ_CLASSIFY_FINALS_MAX &&
	       (all || is_label_due(state, params))) {
		const struct gz_classify_entry *entry = gz_classify_at(state, state->certain);
		if (!state->decided) {
			measure_for_decision(state, params, state->certain);
			gz_classify_decide(state, params, state->certain);
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
			.valid = gz_classify_is_good(params, entry),
			.after_loss = entry->after_loss,
			.point = entry->point,
			.confidence = entry->confidence,
			.peak_deg_s = state->machine.peak_deg_s,
		};
		state->certain++;
	}
}

void gz_classify_step(struct gz_classify_state *state, const struct gz_classify_params *params,
		      const struct gz_display *display, const struct gz_classify_input *input,
		      struct gz_classify_output *out)
{
	out->last_valid_ns = state->valid_ns;
	out->velocity_deg_s = 0;
	out->final_count = 0; /* entries beyond this are not read, so they stay unset */
	struct gz_classify_entry *entry = add_entry(state, params, display, input);
	if (entry->lid)
		mark_covered_samples(state, input->lid_since_ns);
	if (params->source == GZ_CLASSIFY_LEARNED)
		ask_forests(state, params, display, input);
	bool good = gz_classify_is_good(params, entry);
	entry->after_loss = entry->after_loss && good;
	out->resumed = entry->after_loss && state->any_valid && state->lost;
	if (good) {
		state->lost = false;
		double speed_deg_s = trailing_speed(state, params, &out->velocity_deg_s);
		update_quick_saccade(state, params, entry, speed_deg_s);
		state->any_valid = true;
		state->valid_ns = entry->time_ns;
	}
	if (params->source != GZ_CLASSIFY_LEARNED)
		measure_speeds(state, params, state->count, false);
	emit_certain_labels(state, params, false, out);
	state->now = immediate_label(state, params, entry);
	if (entry->still_scene && state->now == GZ_EVENT_PURSUIT)
		state->now = GZ_EVENT_FIXATION; /* the label before a dropout */
	if (out->final_count > 0 && out->final[out->final_count - 1].seq == entry->seq)
		state->now = out->final[out->final_count - 1].event;
	out->event = state->now;
}

void gz_classify_flush(struct gz_classify_state *state, const struct gz_classify_params *params,
		       struct gz_classify_output *out)
{
	out->event = state->now;
	out->velocity_deg_s = 0;
	out->resumed = false;
	out->last_valid_ns = state->valid_ns;
	out->final_count = 0;
	emit_certain_labels(state, params, true, out);
}
