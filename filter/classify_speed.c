/* Speed over short windows, and the slow movement between saccades. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classify_internal.h"

/* Width of a bin: chosen, as long as a certain label waits; 600 ms of them fit the ring. */
static const int64_t BIN_NS = 10 * GZ_NS_PER_MS;

/* Least time for a slope: chosen; less would take the eye's ringing for movement. */
static const double SLOPE_LEAST_S = 0.035;

/** Sums for the slope of a line. */
struct line {
	double count, t, tt;
	double p[3], tp[3];
};

static void line_add(struct line *line, double t, const double p[3])
{
	line->count++;
	line->t += t;
	line->tt += t * t;
	for (int i = 0; i < 3; i++) {
		line->p[i] += p[i];
		line->tp[i] += t * p[i];
	}
}

/** @return false, and a slope of 0, where there is none */
static bool line_slope(const struct line *line, double out_slope[3])
{
	double spread = line->tt - line->t * line->t / fmax(line->count, 1);
	bool has_slope = line->count >= 2 && spread > 1e-12;
	for (int i = 0; i < 3; i++) {
		double together = line->tp[i] - line->t * line->p[i] / fmax(line->count, 1);
		out_slope[i] = has_slope ? together / spread : 0;
	}
	return has_slope;
}

static void add_relative(struct line *line, const struct gz_classify_entry *entry,
			 const struct gz_classify_entry *centre)
{
	double away[3];
	for (int i = 0; i < 3; i++) /* small numbers, so that nothing is lost in the sums */
		away[i] = entry->direction_deg[i] - centre->direction_deg[i];
	line_add(line, gz_ns_to_s(entry->time_ns - centre->time_ns), away);
}

static void add_before(struct gz_classify_state *state, uint64_t index, double before_ns,
		       struct line *line)
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
		add_relative(line, entry, centre);
		neighbour = true;
	}
}

static void add_after(struct gz_classify_state *state, uint64_t index, double after_ns,
		      struct line *line)
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
		add_relative(line, entry, centre);
		neighbour = true;
	}
}

void gz_classify_velocity(struct gz_classify_state *state, uint64_t index,
			  struct gz_classify_window window, double out_deg_s[3])
{
	struct line line = { .count = 0 };
	const struct gz_classify_entry *centre = gz_classify_at(state, index);
	add_relative(&line, centre, centre);
	add_before(state, index, window.before_ns, &line);
	if (window.after_ns > 0)
		add_after(state, index, window.after_ns, &line);
	(void)line_slope(&line, out_deg_s);
}

void gz_classify_measure(struct gz_classify_state *state, const struct gz_classify_params *params,
			 uint64_t end, bool force)
{
	/* A quarter of a period more, so that jitter of the time stamps does not decide. */
	double half_ns = params->velocity_window_ms * 0.5e6 + state->period_ns * 0.25;
	int64_t newest_ns = gz_classify_at(state, state->count - 1)->time_ns;
	for (; state->measured < end; state->measured++) {
		struct gz_classify_entry *entry = gz_classify_at(state, state->measured);
		bool complete = (double)(newest_ns - entry->time_ns) >= half_ns - state->period_ns;
		if (!complete && !force)
			return;
		entry->fast_deg_s = 0;
		if (!entry->valid)
			continue;
		struct gz_classify_window window = { half_ns, half_ns };
		gz_classify_velocity(state, state->measured, window, entry->velocity_deg_s);
		for (int i = 0; i < 3; i++)
			entry->velocity_deg_s[i] -= state->slow.velocity_deg_s[i];
		entry->fast_deg_s = gz_length3(entry->velocity_deg_s);
	}
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

/** Slope through the bins' means over the window. */
static void measure_slope(struct gz_classify_slow *slow, double window_s, int64_t now_ns)
{
	struct line line = { .count = 0 };
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
		line_add(&line, -age_s, place);
		oldest_s = age_s;
		newest_s = k == 0 ? age_s : newest_s;
	}
	double slope[3];
	if (line.count >= 2 && oldest_s - newest_s >= SLOPE_LEAST_S && line_slope(&line, slope)) {
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
		measure_slope(slow, params->pursuit_window_ms * 1e-3, entry->time_ns);
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
