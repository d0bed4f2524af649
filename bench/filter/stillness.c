#include "bench/filter/stillness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"

/* Sums over fixations and over saccades. */
struct sums {
	double raw_step2, our_step2, raw_off2, our_off2, lag_ms;
	size_t fixations, saccades;
};

static double apart_deg(const struct gz_gaze_track *track, struct gz_point a, struct gz_point b)
{
	return gz_display_angle_deg(&track->display, a, b);
}

static bool good_at(const struct gz_gaze_track *track, size_t i)
{
	return isfinite(track->raw[i].x) && isfinite(track->raw[i].y);
}

/* Whether a sample follows the one before it without a gap. */
static bool follows(const struct gz_gaze_track *track, size_t i)
{
	return gz_gaze_track_elapsed_ms(track, i - 1, i) <= gz_ns_to_ms(GZ_SMOOTH_GAP_NS);
}

size_t gz_gaze_stretch_end(const struct gz_gaze_track *track, size_t begin)
{
	size_t end = begin + 1;
	while (end < track->count && track->label[end] == track->label[begin] &&
	       follows(track, end))
		end++;
	return end;
}

static double square_of(double x)
{
	return x * x;
}

static void add_steps(const struct gz_gaze_track *track, size_t begin, size_t end,
		      struct gz_point centre, struct sums *sums)
{
	for (size_t i = begin; i < end; i++) {
		if (!good_at(track, i))
			continue;
		sums->raw_off2 += square_of(apart_deg(track, track->raw[i], centre));
		sums->our_off2 += square_of(apart_deg(track, track->point[i], centre));
		if (i == begin || !good_at(track, i - 1))
			continue;
		sums->raw_step2 += square_of(apart_deg(track, track->raw[i], track->raw[i - 1]));
		sums->our_step2 +=
			square_of(apart_deg(track, track->point[i], track->point[i - 1]));
	}
}

static void add_fixation(const struct gz_gaze_track *track, size_t begin, size_t end,
			 struct sums *sums)
{
	double x = 0, y = 0, count = 0;
	for (size_t i = begin; i < end; i++) {
		if (!good_at(track, i))
			continue;
		x += track->raw[i].x;
		y += track->raw[i].y;
		count++;
	}
	if (count == 0)
		return;
	add_steps(track, begin, end, (struct gz_point) { (float)(x / count), (float)(y / count) },
		  sums);
	sums->fixations++;
}

double gz_saccade_along_deg(const struct gz_gaze_track *track, const struct gz_saccade_way *way,
			    struct gz_point point)
{
	const double from_deg = apart_deg(track, point, way->from);
	const double to_deg = apart_deg(track, point, way->to);
	return (square_of(from_deg) + square_of(way->deg) - square_of(to_deg)) / (2 * way->deg);
}

double gz_saccade_crossing_ms(const struct gz_gaze_track *track, const struct gz_point *path,
			      const struct gz_saccade_way *way, double share)
{
	double last_deg = 0;
	const double deg = share * way->deg;
	const size_t begin = way->begin, end = way->late;
	for (size_t i = begin; i < end; i++) {
		const double now_deg = gz_saccade_along_deg(track, way, path[i]);
		if (now_deg >= deg) {
			const double before =
				now_deg > last_deg && i > begin
					? (now_deg - deg) / (now_deg - last_deg) *
						  gz_gaze_track_elapsed_ms(track, i - 1, i)
					: 0;
			return gz_gaze_track_elapsed_ms(track, begin, i) - before;
		}
		last_deg = now_deg;
	}
	return gz_gaze_track_elapsed_ms(track, begin, end - 1) +
	       gz_gaze_track_elapsed_ms(track, end - 2, end - 1);
}

bool gz_saccade_way_of(const struct gz_gaze_track *track, size_t begin, size_t end,
		       struct gz_saccade_way *out)
{
	if (begin == 0 || track->label[begin] != GZ_EVENT_SACCADE || !follows(track, begin))
		return false;
	for (size_t i = begin - 1; i < end; i++)
		if (!good_at(track, i))
			return false;
	struct gz_saccade_way way = { track->raw[begin - 1], track->raw[end - 1], 0, begin - 1,
				      end };
	way.deg = apart_deg(track, way.from, way.to);
	while (way.late < track->count &&
	       gz_gaze_track_elapsed_ms(track, end - 1, way.late) <= GZ_LAG_MOST_MS)
		way.late++;
	*out = way;
	return way.deg >= GZ_LAG_LEAST_DEG;
}

/* Lag of a saccade, ms. */
static double lag_of(const struct gz_gaze_track *track, const struct gz_saccade_way *way)
{
	double sum_ms = 0;
	for (int part = 2; part <= 8; part += 3)
		sum_ms += gz_saccade_crossing_ms(track, track->point, way, part / 10.0) -
			  gz_saccade_crossing_ms(track, track->raw, way, part / 10.0);
	return sum_ms / 3;
}

static void add_track(const struct gz_gaze_track *track, struct sums *sums)
{
	for (size_t begin = 0, end; begin < track->count; begin = end) {
		end = gz_gaze_stretch_end(track, begin);
		if (track->label[begin] == GZ_EVENT_FIXATION)
			add_fixation(track, begin, end, sums);
		struct gz_saccade_way way;
		if (!gz_saccade_way_of(track, begin, end, &way))
			continue;
		sums->lag_ms += lag_of(track, &way);
		sums->saccades++;
	}
}

struct gz_stillness gz_stillness_of(const struct gz_gaze_track *tracks, size_t count)
{
	struct sums sums = { .lag_ms = 0 };
	for (size_t i = 0; i < count; i++)
		add_track(&tracks[i], &sums);
	return (struct gz_stillness) {
		.fixations = sums.fixations,
		.saccades = sums.saccades,
		.jitter = sums.raw_step2 > 0 ? sqrt(sums.our_step2 / sums.raw_step2) : NAN,
		.distance = sums.raw_off2 > 0 ? sqrt(sums.our_off2 / sums.raw_off2) : NAN,
		.lag_ms = sums.saccades > 0 ? sums.lag_ms / (double)sums.saccades : NAN,
	};
}

/* ---- sweeps ---- */

/* Amplitude from which a saccade passes unsmoothed, degrees: this trades lag for jitter. */
static const double PASSES_DEG[] = { 0, 0.3, 0.6, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 2 };

enum { PASSES = sizeof PASSES_DEG / sizeof PASSES_DEG[0] };

/* What the smoothing takes of every sample of every track. */
struct smoothed_tracks {
	struct gz_gaze_track *tracks;
	size_t count;
	struct gz_smooth_input *inputs;
	const struct gz_smooth_params *given;
};

static bool take_smoothing(struct smoothed_tracks *smoothed,
			   const struct gz_pipeline_params *params)
{
	size_t samples = 0;
	for (size_t i = 0; i < smoothed->count; i++)
		samples += smoothed->tracks[i].count;
	smoothed->inputs = malloc((samples + 1) * sizeof *smoothed->inputs);
	if (!smoothed->inputs)
		return false;
	struct gz_smooth_input *inputs = smoothed->inputs;
	for (size_t i = 0; i < smoothed->count; inputs += smoothed->tracks[i++].count)
		gz_gaze_track_take_smoothing(&smoothed->tracks[i], params, inputs);
	return true;
}

static void add_pipeline_point(const struct smoothed_tracks *smoothed, double pass_deg,
			       struct gz_sweep *sweep)
{
	struct gz_smooth_params params = *smoothed->given;
	params.pass_deg = pass_deg;
	const struct gz_smooth_input *inputs = smoothed->inputs;
	for (size_t i = 0; i < smoothed->count; inputs += smoothed->tracks[i++].count)
		gz_gaze_track_smooth(&smoothed->tracks[i], &params, inputs);
	sweep->point[sweep->count++] = (struct gz_sweep_point) {
		.pass_deg = pass_deg,
		.as_given = pass_deg == smoothed->given->pass_deg,
		.stillness = gz_stillness_of(smoothed->tracks, smoothed->count),
	};
}

struct gz_sweep gz_sweep_pipeline(struct gz_gaze_track *tracks, size_t count,
				  const struct gz_pipeline_params *params)
{
	struct gz_sweep sweep = { .count = 0 };
	struct smoothed_tracks smoothed = { tracks, count, NULL, &params->smooth };
	if (!take_smoothing(&smoothed, params))
		return sweep;
	const double given_deg = params->smooth.pass_deg;
	double last_deg = -INFINITY;
	for (size_t i = 0; i <= PASSES; i++) {
		const double next_deg = i < PASSES ? PASSES_DEG[i] : INFINITY;
		if (given_deg > last_deg && given_deg < next_deg)
			add_pipeline_point(&smoothed, given_deg, &sweep);
		if (i < PASSES)
			add_pipeline_point(&smoothed, next_deg, &sweep);
		last_deg = next_deg;
	}
	free(smoothed.inputs);
	return sweep;
}

/* Settings of the 1 euro filter that are combined. Chosen: the paper's first guess of 1 Hz and what
 * lies around it, up to cutoffs of the derivative at which it hardly smooths any more. */
static const double MIN_CUTOFFS_HZ[] = { 0.3, 1, 3, 10 };
static const double DERIVATIVE_CUTOFFS_HZ[] = { 1, 5, 20, 50, 200 };
static const double BETA_LEAST = 1e-3, BETA_STEP = 1.5;

enum {
	MIN_CUTOFFS = sizeof MIN_CUTOFFS_HZ / sizeof MIN_CUTOFFS_HZ[0],
	DERIVATIVE_CUTOFFS = sizeof DERIVATIVE_CUTOFFS_HZ / sizeof DERIVATIVE_CUTOFFS_HZ[0],
	BETAS = 30,
	COMBINATIONS = MIN_CUTOFFS * DERIVATIVE_CUTOFFS * BETAS,
};

static struct gz_one_euro_params combination(size_t i)
{
	return (struct gz_one_euro_params) {
		.min_cutoff_hz = MIN_CUTOFFS_HZ[i / BETAS % MIN_CUTOFFS],
		.derivative_cutoff_hz = DERIVATIVE_CUTOFFS_HZ[i / BETAS / MIN_CUTOFFS],
		.beta = BETA_LEAST * pow(BETA_STEP, (double)(i % BETAS)),
	};
}

/* NaN, as without a saccade, last. */
static int by_lag(const void *a, const void *b)
{
	const struct gz_stillness *left = &((const struct gz_sweep_point *)a)->stillness;
	const struct gz_stillness *right = &((const struct gz_sweep_point *)b)->stillness;
	if (left->lag_ms != right->lag_ms && !(isnan(left->lag_ms) && isnan(right->lag_ms)))
		return left->lag_ms < right->lag_ms || isnan(right->lag_ms) ? -1 : 1;
	return (left->jitter > right->jitter) - (left->jitter < right->jitter);
}

/* Keep those that no other one beats, of points by lag. @return how many stay */
static size_t keep_unbeaten(struct gz_sweep_point *points, size_t count)
{
	double least = INFINITY;
	size_t kept = 0;
	for (size_t i = 0; i < count; i++) {
		if (!(points[i].stillness.jitter < least))
			continue;
		least = points[i].stillness.jitter;
		points[kept++] = points[i];
	}
	return kept;
}

struct gz_sweep gz_sweep_one_euro(struct gz_gaze_track *tracks, size_t count)
{
	struct gz_sweep_point points[COMBINATIONS];
	for (size_t i = 0; i < COMBINATIONS; i++) {
		points[i] = (struct gz_sweep_point) { .one_euro = combination(i) };
		for (size_t track = 0; track < count; track++)
			gz_gaze_track_run_one_euro(&tracks[track], &points[i].one_euro);
		points[i].stillness = gz_stillness_of(tracks, count);
	}
	qsort(points, COMBINATIONS, sizeof points[0], by_lag);
	const size_t unbeaten = keep_unbeaten(points, COMBINATIONS);
	struct gz_sweep sweep = { .count = unbeaten < GZ_SWEEP_MAX ? unbeaten : GZ_SWEEP_MAX };
	for (size_t i = 0; i < sweep.count; i++)
		sweep.point[i] = points[(sweep.count - 1 - i) * (unbeaten - 1) /
					(sweep.count > 1 ? sweep.count - 1 : 1)];
	return sweep;
}

void gz_sweep_name_point(const struct gz_sweep_point *point, bool one_euro,
			 char out_name[GZ_SWEEP_NAME_SIZE])
{
	const struct gz_one_euro_params *params = &point->one_euro;
	if (one_euro)
		snprintf(out_name, GZ_SWEEP_NAME_SIZE, "1 euro, %.3g Hz, %.3g Hz, beta %.3g",
			 params->min_cutoff_hz, params->derivative_cutoff_hz, params->beta);
	else
		snprintf(out_name, GZ_SWEEP_NAME_SIZE, "pipeline, smooth_pass_deg %.4g",
			 point->pass_deg);
}

/* Jitter on the line between two points at a lag; infinite beside it. */
static double between(const struct gz_stillness *a, const struct gz_stillness *b, double lag_ms)
{
	const double span_ms = b->lag_ms - a->lag_ms, part = (lag_ms - a->lag_ms) / span_ms;
	if (!(fabs(span_ms) > 0) || !(part >= 0 && part <= 1))
		return INFINITY;
	return a->jitter + part * (b->jitter - a->jitter);
}

double gz_sweep_jitter_at(const struct gz_sweep *sweep, double lag_ms)
{
	double least = INFINITY;
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_stillness *here = &sweep->point[i].stillness;
		if (here->lag_ms <= lag_ms)
			least = fmin(least, here->jitter);
		if (i + 1 < sweep->count)
			least = fmin(least, between(here, &sweep->point[i + 1].stillness, lag_ms));
	}
	return least;
}

double gz_sweep_first_not_below(const struct gz_sweep *ours, const struct gz_sweep *theirs,
				double first_ms, double last_ms, double step_ms)
{
	const int steps = (int)floor((last_ms - first_ms) / step_ms + 1e-9);
	for (int i = 0; i <= steps; i++) {
		const double lag_ms = first_ms + i * step_ms;
		if (!(gz_sweep_jitter_at(ours, lag_ms) < gz_sweep_jitter_at(theirs, lag_ms)))
			return lag_ms;
	}
	return NAN;
}
