#include "filter/classifier/movement.h"

#include <math.h>
#include <string.h>

/* Unit of places. Chosen: far below the precision of any tracker, and small enough that sums of
 * squares over a window fit into 63 bits. */
static const double UNITS_PER_DEG = 1e4;
static const double DEG_PER_UNIT = 1e-4;

static const double DEG_PER_RAD = 57.295779513082320877;

/* Samples within this time are averaged, so that the noise of faster trackers is that of one at 250
 * Hz. Less than 4 ms, and no multiple of a usual period, so that jitter does not change what is
 * averaged. */
static const int64_t SMOOTH_US = 3250;

/* Time over which speed is measured: the period of most recordings that people labelled. */
static const int64_t TICK_US = 4000;
static const double TICKS_PER_S = 250;

/* Times to which the features look back, us. The first TICKS are whole ticks. */
enum { TICKS = 8 };
static const int64_t LOOK_US[GZ_MOVEMENT_LOOKS] = { 4000,  8000,  12000, 16000,  20000,  24000,
						    28000, 32000, 64000, 128000, 256000, 448000 };

/* Windows for distance, length of the way and spread: places in LOOK_US. */
enum { WINDOWS = 7, LONGEST = GZ_MOVEMENT_LOOKS - 1 };
static const int WINDOW_LOOK[WINDOWS] = { 1, 3, 7, 8, 9, 10, 11 };

/* Windows for turning: the movement over the first look back against that over the rest of the
 * second, which is twice as long. */
enum { TURNS = 6 };
static const int TURN_LOOK[TURNS][2] = {
	{ 0, 1 }, { 1, 3 }, { 3, 7 }, { 7, 8 }, { 8, 9 }, { 9, 10 }
};

/* A movement is fast above this speed and this multiple of the usual one. Chosen: 30 degrees per
 * second is the usual threshold of velocity-threshold identification. */
static const double FAST_DEG_S = 30;
static const double FAST_FACTOR = 4;

/* Fast samples closer than this belong to one burst, and its ringing lasts so long. Chosen. */
static const int64_t BURST_GAP_US = 12000;
static const int64_t RINGING_US = 20000;

/* How long the direction of a burst is a reference. Chosen: longer than a saccade and its ringing.
 */
static const int64_t HEADING_US = 200000;

/* Longer times are all the same. Chosen: beyond the longest window. */
static const double TIME_MAX_MS = 1000;

/* Time constant of the noise estimate, s, and of the running means. Chosen. */
static const double NOISE_S = 1;
static const double MEAN_S[GZ_MOVEMENT_MEANS] = { 2, 10 };

/* Time constants of the flows, s. Chosen: a pursuit and its catch-up saccades, and several. */
static const double FLOW_S[GZ_MOVEMENT_FLOWS] = { 0.5, 2 };

/* At the start of a recording the means are over what there is, but at least this time. Chosen. */
static const double MEAN_LEAST_S = 0.5;

/* Distances that are added below fraction bars, so that noise has no direction, degrees. */
static const double SMALL_DEG = 0.02;

const char *const gz_movement_feature_names[GZ_MOVEMENT_FEATURES] = {
	/* Speed over each of the last ticks, deg/s. */
	"speed_0",
	"speed_1",
	"speed_2",
	"speed_3",
	"speed_4",
	"speed_5",
	"speed_6",
	"speed_7",
	/* The part of it along the newest burst. */
	"along_0",
	"along_1",
	"along_2",
	"along_3",
	"along_4",
	/* For each window: distance, way, their ratio, spread, distance over that of noise, lost.
	 */
	"distance_8",
	"way_8",
	"straight_8",
	"spread_8",
	"signal_8",
	"lost_8",
	"distance_16",
	"way_16",
	"straight_16",
	"spread_16",
	"signal_16",
	"lost_16",
	"distance_32",
	"way_32",
	"straight_32",
	"spread_32",
	"signal_32",
	"lost_32",
	"distance_64",
	"way_64",
	"straight_64",
	"spread_64",
	"signal_64",
	"lost_64",
	"distance_128",
	"way_128",
	"straight_128",
	"spread_128",
	"signal_128",
	"lost_128",
	"distance_256",
	"way_256",
	"straight_256",
	"spread_256",
	"signal_256",
	"lost_256",
	"distance_448",
	"way_448",
	"straight_448",
	"spread_448",
	"signal_448",
	"lost_448",
	/* Horizontal distance without sign, and downward distance. */
	"across_8",
	"down_8",
	"across_16",
	"down_16",
	"across_64",
	"down_64",
	"across_256",
	"down_256",
	/* Cosine of the turn between two windows of equal length. */
	"turn_4",
	"turn_8",
	"turn_16",
	"turn_32",
	"turn_64",
	"turn_128",
	"noise",
	"since_fast_ms",
	"since_lost_ms",
	"lost_ms",
	"burst_peak",
	"burst_ms",
	"burst_deg",
	"burst_part",
	"burst_down",
	"since_peak_ms",
	/* The stretch since the burst. */
	"slope",
	"residual",
	"stretch_ms",
	"slope_down",
	"slope_ratio",
	"last_slope",
	"last_turn",
	"last_ms",
	"mean_lost_2",
	"mean_bursts_2",
	"mean_slow_2",
	"mean_lost_10",
	"mean_bursts_10",
	"mean_slow_10",
	"beyond_x",
	"beyond_y",
	"valid",
	/* How fast the slow movement has been on the whole, deg/s, and the newest burst against the
	 * slow movement after it, before it and lately: pursuit goes on where it went, and the
	 * saccades in it go the same way. */
	"flow_500",
	"flow_2000",
	"burst_slope",
	"burst_last",
	"burst_flow",
};

static struct gz_movement_entry *entry_at(struct gz_movement *state, uint64_t index)
{
	return &state->ring[index % GZ_MOVEMENT_RING];
}

static double length2(const double v[2])
{
	return sqrt(v[0] * v[0] + v[1] * v[1]);
}

/* As fmin() and fmax() for numbers that are not NaN, without a call. */
static inline double lesser(double a, double b)
{
	return a < b ? a : b;
}

static inline double greater(double a, double b)
{
	return a > b ? a : b;
}

/* Nearest integer. */
static int64_t nearest(double x)
{
	return (int64_t)floor(x + 0.5);
}

/*
 * The place of a point in degrees: the direction of gaze in an azimuthal equidistant projection, so
 * that distances from the display's centre are angles. With u = 1 - cos a, the factor a / sin a is
 * 1 + u/3 + 2u^2/15 + 2u^3/35 + 8u^4/315 + ..., within 1e-3 up to 60 degrees.
 */
static void place_of(const struct gz_display *display, struct gz_point point, double out_deg[2])
{
	double mm[3];
	gz_display_to_mm(display, point, mm);
	double length = sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	double u = 1 - mm[2] / length;
	double factor = 1 + u * (1. / 3 + u * (2. / 15 + u * (2. / 35 + u * (8. / 315))));
	out_deg[0] = DEG_PER_RAD * factor * mm[0] / length;
	out_deg[1] = DEG_PER_RAD * factor * mm[1] / length;
}

/*
 * The ring.
 */

/* Mean of the samples within SMOOTH_US, nothing beyond a loss. */
static void average_place(struct gz_movement *state, struct gz_movement_entry *entry)
{
	double sum[2] = { 0, 0 }, count = 0;
	uint64_t kept = state->count < GZ_MOVEMENT_RING ? state->count : GZ_MOVEMENT_RING;
	for (uint64_t back = 1; back <= kept; back++) {
		const struct gz_movement_entry *one = entry_at(state, state->count - back);
		if (!one->valid || entry->time_us - one->time_us >= SMOOTH_US)
			break;
		for (int i = 0; i < 2; i++)
			sum[i] += (double)one->measured[i];
		count++;
	}
	for (int i = 0; i < 2; i++)
		entry->place[i] = nearest(sum[i] / count);
}

static void add_to_sums(struct gz_movement_entry *entry)
{
	uint64_t t = (uint64_t)entry->time_us;
	entry->count++;
	entry->time_sum += t;
	entry->time_squares += t * t;
	for (int i = 0; i < 2; i++) {
		uint64_t p = (uint64_t)entry->place[i];
		entry->sum[i] += p;
		entry->squares += p * p;
		entry->time_place[i] += t * p;
	}
}

/* Advance the cursor of a look to the newest sample that is so long ago; to the oldest if none is.
 */
static void advance_cursor(struct gz_movement *state, int look)
{
	uint64_t newest = state->count - 1;
	uint64_t oldest = newest >= GZ_MOVEMENT_RING ? newest - GZ_MOVEMENT_RING + 1 : 0;
	uint64_t at = state->cursor[look] < oldest ? oldest : state->cursor[look];
	const int64_t until_us = entry_at(state, newest)->time_us - LOOK_US[look];
	while (at < newest && entry_at(state, at + 1)->time_us <= until_us)
		at++;
	state->cursor[look] = at;
}

/* Where the eye was a look back ago, degrees. */
static void place_ago(struct gz_movement *state, int look, double out_deg[2])
{
	uint64_t at = state->cursor[look], newest = state->count - 1;
	const struct gz_movement_entry *before = entry_at(state, at);
	int64_t time_us = entry_at(state, newest)->time_us - LOOK_US[look];
	double part = 0;
	const struct gz_movement_entry *after = before;
	if (at < newest && time_us > before->time_us) {
		after = entry_at(state, at + 1);
		part = (double)(time_us - before->time_us) /
		       (double)(after->time_us - before->time_us);
	}
	for (int i = 0; i < 2; i++) {
		double step = (double)(after->place[i] - before->place[i]);
		out_deg[i] = DEG_PER_UNIT * ((double)before->place[i] + part * step);
	}
}

/*
 * Sums over the samples after one up to the newest.
 */

/* Relative to the newest sample's time and place, so that they are small. */
struct window_sums {
	double count, t, tt;
	double p[2], tp[2];
	double squares;
};

/* Inlined, so that sums that a caller does not read are not computed. */
static inline __attribute__((always_inline)) struct window_sums sums_since(
	struct gz_movement *state, uint64_t index)
{
	const struct gz_movement_entry *a = entry_at(state, index);
	const struct gz_movement_entry *b = entry_at(state, state->count - 1);
	uint64_t n = b->count - a->count, t0 = (uint64_t)b->time_us;
	uint64_t t = b->time_sum - a->time_sum, tt = b->time_squares - a->time_squares;
	uint64_t squares = b->squares - a->squares;
	struct window_sums sums = { .count = (double)n };
	sums.t = (double)(int64_t)(t - n * t0);
	sums.tt = (double)(int64_t)(tt - 2 * t0 * t + n * t0 * t0);
	for (int i = 0; i < 2; i++) {
		uint64_t p0 = (uint64_t)b->place[i], p = b->sum[i] - a->sum[i];
		uint64_t tp = b->time_place[i] - a->time_place[i];
		sums.p[i] = (double)(int64_t)(p - n * p0);
		sums.tp[i] = (double)(int64_t)(tp - t0 * p - p0 * t + n * t0 * p0);
		squares += n * p0 * p0 - 2 * p0 * p;
	}
	sums.squares = (double)(int64_t)squares;
	return sums;
}

/* Root mean square distance from the mean, degrees. */
static double spread_of(const struct window_sums *sums)
{
	if (sums->count < 2)
		return 0;
	double mean2 = (sums->p[0] * sums->p[0] + sums->p[1] * sums->p[1]) / sums->count;
	return DEG_PER_UNIT * sqrt(greater(0, sums->squares - mean2) / sums->count);
}

/* The straight line through the samples. */
static void fit_line(const struct window_sums *sums, struct gz_movement_stretch *out)
{
	double n = sums->count, tt = n < 2 ? 0 : sums->tt - sums->t * sums->t / n;
	out->slope[0] = out->slope[1] = out->residual_deg = 0;
	if (!(tt > 0))
		return;
	double rest = sums->squares;
	for (int i = 0; i < 2; i++) {
		double tp = sums->tp[i] - sums->t * sums->p[i] / n;
		out->slope[i] = DEG_PER_UNIT * 1e6 * tp / tt;
		rest -= sums->p[i] * sums->p[i] / n + tp * tp / tt;
	}
	out->residual_deg = DEG_PER_UNIT * sqrt(greater(0, rest) / n);
}

/*
 * The step.
 */

/* A time without samples is no loss: the recordings that the forests learned from have samples that
 * tell of every blink, and what follows a pause of the device is not what follows a lid. */
static void note_loss(struct gz_movement *state, const struct gz_movement_entry *entry,
		      int64_t step_us)
{
	if (!state->losing && !entry->valid) {
		state->losing = state->any_lost = true;
		state->loss_begin_us = entry->time_us - step_us;
	}
	if (!state->losing)
		return;
	state->lost_us = entry->time_us;
	state->loss_ms = (entry->time_us - state->loss_begin_us) / 1000;
	state->losing = !entry->valid;
}

static struct gz_movement_entry *add_movement_entry(struct gz_movement *state,
						    const struct gz_display *display,
						    const struct gz_movement_input *input,
						    double *out_step_s)
{
	struct gz_movement_entry entry = { .time_us = 0 };
	if (state->count > 0)
		entry = *entry_at(state, state->count - 1);
	else
		state->start_ns = input->time_ns;
	int64_t last_us = entry.time_us;
	entry.time_us = (input->time_ns - state->start_ns) / 1000;
	/* The times of two samples may be equal in us. */
	if (state->count > 0 && entry.time_us <= last_us)
		entry.time_us = last_us + 1;
	int64_t step_us = state->count > 0 ? entry.time_us - last_us : 0;
	entry.valid = input->valid;
	note_loss(state, &entry, step_us);
	if (!input->valid)
		entry.lost_us += (uint64_t)step_us;
	struct gz_movement_entry *kept = entry_at(state, state->count++);
	*kept = entry;
	*out_step_s = (double)step_us * 1e-6;
	if (!input->valid)
		return kept;
	double deg[2];
	place_of(display, input->point, deg);
	for (int i = 0; i < 2; i++)
		kept->measured[i] = nearest(deg[i] * UNITS_PER_DEG);
	average_place(state, kept);
	if (!state->any_valid) /* what was before is nowhere: take it to be here */
		for (uint64_t k = 0; k < GZ_MOVEMENT_RING; k++)
			memcpy(state->ring[k].place, kept->place, sizeof kept->place);
	add_to_sums(kept);
	return kept;
}

/* Median of the speed. @see gz_median_follow() */
static void follow_noise(struct gz_movement *state, double speed_deg_s, double step_s)
{
	if (!(speed_deg_s > 0))
		return;
	state->noise_count++;
	double step = lesser(0.5, greater(step_s / NOISE_S, 2 / state->noise_count));
	if (state->noise_count < 2)
		state->noise_deg_s = speed_deg_s;
	else if (speed_deg_s > state->noise_deg_s)
		state->noise_deg_s *= 1 + step;
	else
		state->noise_deg_s /= 1 + step;
}

/* @return whether a burst begins */
static bool follow_burst(struct gz_movement *state, int64_t now_us, const double here[2],
			 const double before[2], double speed_deg_s)
{
	struct gz_movement_burst *burst = &state->burst;
	bool begins = !burst->any || now_us - burst->end_us > BURST_GAP_US;
	if (begins) {
		burst->any = true;
		burst->start_us = now_us;
		burst->peak_deg_s = 0;
		memcpy(burst->from, before, sizeof burst->from);
	}
	burst->end_us = now_us;
	memcpy(burst->to, here, sizeof burst->to);
	if (speed_deg_s > burst->peak_deg_s) {
		burst->peak_deg_s = speed_deg_s;
		burst->peak_us = now_us;
		for (int i = 0; i < 2; i++)
			burst->heading[i] = (here[i] - before[i]) * TICKS_PER_S / speed_deg_s;
	}
	return begins;
}

/* Follow the slow movement between bursts. */
static void follow_stretch(struct gz_movement *state, int64_t now_us, bool fast)
{
	struct gz_movement_stretch *stretch = &state->stretch;
	if (fast) {
		if (stretch->any && stretch->lasted_ms > 0)
			state->last_stretch = *stretch;
		*stretch = (struct gz_movement_stretch) { .any = false };
		return;
	}
	if (!stretch->any) {
		if (state->burst.any && now_us - state->burst.end_us < RINGING_US)
			return;
		*stretch = (struct gz_movement_stretch) { .any = true, .first = state->count - 1 };
	}
	uint64_t since =
		state->cursor[LONGEST] > stretch->first ? state->cursor[LONGEST] : stretch->first;
	struct window_sums sums = sums_since(state, since);
	fit_line(&sums, stretch);
	stretch->lasted_ms = (double)(now_us - entry_at(state, since)->time_us) * 1e-3;
}

/* Follow where slow movement goes, if this sample and the one before were measured. */
static void follow_flows(struct gz_movement *state, double step_s)
{
	if (state->count < 2 || !state->stretch.any)
		return;
	const struct gz_movement_entry *now = entry_at(state, state->count - 1);
	const struct gz_movement_entry *before = entry_at(state, state->count - 2);
	if (!now->valid || !before->valid)
		return;
	for (int k = 0; k < GZ_MOVEMENT_FLOWS; k++)
		for (int i = 0; i < 2; i++) {
			const double way_deg =
				DEG_PER_UNIT * (double)(now->place[i] - before->place[i]);
			double *slow = &state->flow[k].slow_deg_s[i];
			*slow += (way_deg - *slow * step_s) / (FLOW_S[k] + step_s);
		}
}

static void follow_means(struct gz_movement *state, bool lost, bool burst_begins, double step_s)
{
	double elapsed_s = (double)entry_at(state, state->count - 1)->time_us * 1e-6;
	for (int i = 0; i < GZ_MOVEMENT_MEANS; i++) {
		struct gz_movement_mean *mean = &state->mean[i];
		double over_s = lesser(MEAN_S[i], elapsed_s + MEAN_LEAST_S);
		double gain = step_s / (over_s + step_s);
		mean->lost += gain * ((lost ? 1 : 0) - mean->lost);
		mean->bursts_s -= gain * mean->bursts_s;
		mean->bursts_s += burst_begins ? 1 / over_s : 0;
		if (state->stretch.lasted_ms > 60)
			mean->slow_deg_s +=
				gain * (length2(state->stretch.slope) - mean->slow_deg_s);
	}
}

/*
 * The features.
 */

/* Where the next feature goes. */
struct feature_row {
	float *next;
};

static void put(struct feature_row *row, double value)
{
	*row->next++ = (float)value;
}

static double cosine_of(const double a[2], const double b[2], double small)
{
	return (a[0] * b[0] + a[1] * b[1]) / (length2(a) * length2(b) + small);
}

static double capped_ms(int64_t us)
{
	return lesser((double)us * 1e-3, TIME_MAX_MS);
}

/* Places at the times to which the features look back, degrees. */
struct places {
	double now[2];
	double ago[GZ_MOVEMENT_LOOKS][2];
};

static void put_ticks(struct gz_movement *state, const struct places *places,
		      struct feature_row *row)
{
	int64_t now_us = entry_at(state, state->count - 1)->time_us;
	const struct gz_movement_burst *burst = &state->burst;
	bool headed = burst->any && now_us - burst->end_us < HEADING_US;
	double along[TICKS];
	for (int k = 0; k < TICKS; k++) {
		const double *to = k == 0 ? places->now : places->ago[k - 1];
		double step[2] = { to[0] - places->ago[k][0], to[1] - places->ago[k][1] };
		put(row, length2(step) * TICKS_PER_S);
		along[k] = headed ? (step[0] * burst->heading[0] + step[1] * burst->heading[1]) *
					    TICKS_PER_S
				  : 0;
	}
	for (int k = 0; k < 5; k++)
		put(row, along[k]);
}

static void put_windows(struct gz_movement *state, const struct places *places,
			struct feature_row *row)
{
	const struct gz_movement_entry *newest = entry_at(state, state->count - 1);
	for (int w = 0; w < WINDOWS; w++) {
		int look = WINDOW_LOOK[w];
		const struct gz_movement_entry *first = entry_at(state, state->cursor[look]);
		double ticks = (double)LOOK_US[look] / (double)TICK_US;
		double away[2] = { places->now[0] - places->ago[look][0],
				   places->now[1] - places->ago[look][1] };
		double distance = length2(away);
		double way = DEG_PER_UNIT * (double)(newest->path - first->path);
		double noise = state->noise_deg_s / TICKS_PER_S * sqrt(ticks);
		struct window_sums sums = sums_since(state, state->cursor[look]);
		put(row, distance);
		put(row, way);
		put(row, distance / (way + SMALL_DEG));
		put(row, spread_of(&sums));
		put(row, distance / (noise + SMALL_DEG));
		put(row,
		    lesser(1, (double)(newest->lost_us - first->lost_us) / (double)LOOK_US[look]));
	}
	static const int looks[] = { 1, 3, 8, 10 };
	for (int k = 0; k < 4; k++) {
		put(row, fabs(places->now[0] - places->ago[looks[k]][0]));
		put(row, places->now[1] - places->ago[looks[k]][1]);
	}
}

static void put_turns(const struct places *places, struct feature_row *row)
{
	for (int k = 0; k < TURNS; k++) {
		const double *middle = places->ago[TURN_LOOK[k][0]];
		const double *first = places->ago[TURN_LOOK[k][1]];
		double a[2] = { places->now[0] - middle[0], places->now[1] - middle[1] };
		double b[2] = { middle[0] - first[0], middle[1] - first[1] };
		put(row, cosine_of(a, b, SMALL_DEG * SMALL_DEG));
	}
}

static void put_burst(struct gz_movement *state, double speed_deg_s, struct feature_row *row)
{
	int64_t now_us = entry_at(state, state->count - 1)->time_us;
	const struct gz_movement_burst *burst = &state->burst;
	put(row, state->noise_deg_s);
	put(row, burst->any ? capped_ms(now_us - burst->end_us) : TIME_MAX_MS);
	put(row, state->any_lost ? capped_ms(now_us - state->lost_us) : TIME_MAX_MS);
	put(row, state->any_lost ? lesser((double)state->loss_ms, TIME_MAX_MS) : 0);
	double away[2] = { burst->to[0] - burst->from[0], burst->to[1] - burst->from[1] };
	double distance = length2(away);
	put(row, burst->peak_deg_s);
	put(row, capped_ms(burst->end_us - burst->start_us));
	put(row, distance);
	put(row, burst->any ? speed_deg_s / burst->peak_deg_s : 0);
	put(row, away[1] / (distance + SMALL_DEG));
	put(row, burst->any ? capped_ms(now_us - burst->peak_us) : TIME_MAX_MS);
}

static void put_stretch(const struct gz_movement *state, struct feature_row *row)
{
	const struct gz_movement_stretch *now = &state->stretch, *last = &state->last_stretch;
	double speed = length2(now->slope);
	put(row, speed);
	put(row, now->residual_deg);
	put(row, now->lasted_ms);
	put(row, now->slope[1]);
	put(row, speed * now->lasted_ms * 1e-3 / (now->residual_deg + SMALL_DEG));
	put(row, length2(last->slope));
	put(row, cosine_of(now->slope, last->slope, 1));
	put(row, last->lasted_ms);
	for (int i = 0; i < GZ_MOVEMENT_MEANS; i++) {
		put(row, state->mean[i].lost);
		put(row, state->mean[i].bursts_s);
		put(row, state->mean[i].slow_deg_s);
	}
}

static void put_flows(const struct gz_movement *state, struct feature_row *row)
{
	const struct gz_movement_burst *burst = &state->burst;
	const double *longest = state->flow[GZ_MOVEMENT_FLOWS - 1].slow_deg_s;
	const double jump[2] = { burst->to[0] - burst->from[0], burst->to[1] - burst->from[1] };
	for (int k = 0; k < GZ_MOVEMENT_FLOWS; k++)
		put(row, length2(state->flow[k].slow_deg_s));
	put(row, cosine_of(jump, state->stretch.slope, 1));
	put(row, cosine_of(jump, state->last_stretch.slope, 1));
	put(row, cosine_of(jump, longest, 1));
}

/* How far beyond the display's edge, -3 to 3 degrees. */
static void put_edges(const struct gz_display *display, const double here[2],
		      struct feature_row *row)
{
	double corner[2];
	place_of(display, (struct gz_point) { 1, 0.5f }, corner);
	put(row, greater(-3, lesser(3, fabs(here[0]) - corner[0])));
	place_of(display, (struct gz_point) { 0.5f, 1 }, corner);
	put(row, greater(-3, lesser(3, fabs(here[1]) - corner[1])));
}

static void put_features(struct gz_movement *state, const struct gz_display *display,
			 const struct places *places, double speed_deg_s, float *out_features)
{
	struct feature_row row = { out_features };
	put_ticks(state, places, &row);
	put_windows(state, places, &row);
	put_turns(places, &row);
	put_burst(state, speed_deg_s, &row);
	put_stretch(state, &row);
	put_edges(display, places->now, &row);
	put(&row, entry_at(state, state->count - 1)->valid ? 1 : 0);
	put_flows(state, &row);
}

bool gz_movement_step(struct gz_movement *state, const struct gz_display *display,
		      const struct gz_movement_input *input, float *out_features)
{
	double step_s;
	if (out_features)
		memset(out_features, 0, GZ_MOVEMENT_FEATURES * sizeof out_features[0]);
	struct gz_movement_entry *entry = add_movement_entry(state, display, input, &step_s);
	state->any_valid = state->any_valid || input->valid;
	/* Without features, only these are needed; the others catch up later. */
	advance_cursor(state, 0);
	advance_cursor(state, LONGEST);
	if (!state->any_valid)
		return false;
	struct places places;
	for (int i = 0; i < 2; i++)
		places.now[i] = DEG_PER_UNIT * (double)entry->place[i];
	place_ago(state, 0, places.ago[0]);
	double tick[2] = { places.now[0] - places.ago[0][0], places.now[1] - places.ago[0][1] };
	double speed_deg_s = length2(tick) * TICKS_PER_S;
	entry->path += (uint64_t)nearest(speed_deg_s * step_s * UNITS_PER_DEG);
	bool fast = speed_deg_s > greater(FAST_DEG_S, FAST_FACTOR * state->noise_deg_s);
	bool begins =
		fast && follow_burst(state, entry->time_us, places.now, places.ago[0], speed_deg_s);
	if (!fast && input->valid)
		follow_noise(state, speed_deg_s, step_s);
	follow_stretch(state, entry->time_us, fast || !input->valid);
	follow_means(state, !input->valid, begins, step_s);
	follow_flows(state, step_s);
	if (!out_features)
		return true;
	for (int k = 1; k < GZ_MOVEMENT_LOOKS; k++) {
		advance_cursor(state, k);
		place_ago(state, k, places.ago[k]);
	}
	put_features(state, display, &places, speed_deg_s, out_features);
	return true;
}
