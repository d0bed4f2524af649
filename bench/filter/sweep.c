#include "bench/filter/sweep.h"

#include <math.h>

/* From where on a saccade passes unsmoothed, degrees: this trades lag for jitter. */
static const double PASSES_DEG[] = { 0, 0.3, 0.6, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 2 };

enum { PASSES = sizeof PASSES_DEG / sizeof PASSES_DEG[0] };

static void add_pipeline(struct gz_gaze_track *tracks, size_t count,
			 const struct gz_pipeline_params *given, double pass_deg,
			 struct gz_sweep *sweep)
{
	struct gz_pipeline_params params = *given;
	params.smooth.pass_deg = pass_deg;
	for (size_t i = 0; i < count; i++)
		gz_gaze_track_run_pipeline(&tracks[i], &params, true);
	sweep->point[sweep->count++] = (struct gz_sweep_point) {
		.setting = pass_deg,
		.as_given = pass_deg == given->smooth.pass_deg,
		.stillness = gz_stillness_of(tracks, count),
	};
}

struct gz_sweep gz_sweep_pipeline(struct gz_gaze_track *tracks, size_t count,
				  const struct gz_pipeline_params *params)
{
	struct gz_sweep sweep = { .count = 0 };
	const double given_deg = params->smooth.pass_deg;
	double last_deg = -INFINITY;
	for (size_t i = 0; i <= PASSES; i++) {
		const double next_deg = i < PASSES ? PASSES_DEG[i] : INFINITY;
		if (given_deg > last_deg && given_deg < next_deg)
			add_pipeline(tracks, count, params, given_deg, &sweep);
		if (i < PASSES)
			add_pipeline(tracks, count, params, next_deg, &sweep);
		last_deg = next_deg;
	}
	return sweep;
}

struct gz_sweep gz_sweep_one_euro(struct gz_gaze_track *tracks, size_t count)
{
	struct gz_sweep sweep = { .count = 0 };
	double beta = 1e-4;
	for (; beta < 200 && sweep.count < GZ_SWEEP_MAX; beta *= 1.6) {
		for (size_t i = 0; i < count; i++)
			gz_gaze_track_run_one_euro(&tracks[i], beta);
		sweep.point[sweep.count++] = (struct gz_sweep_point) {
			.setting = beta,
			.stillness = gz_stillness_of(tracks, count),
		};
	}
	return sweep;
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
