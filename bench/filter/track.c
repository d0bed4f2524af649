#include "bench/filter/track.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "bench/filter/baselines.h"

static const double DEG = 57.29577951;

enum gz_result gz_gaze_track_start(size_t count, const struct gz_display *display,
				   struct gz_gaze_track *out_track)
{
	struct gz_gaze_track track = {
		.display = *display,
		.count = count,
		.sample = calloc(count, sizeof *track.sample),
		.raw = calloc(count, sizeof *track.raw),
		.label = calloc(count, sizeof *track.label),
		.point = calloc(count, sizeof *track.point),
		.event = calloc(count, sizeof *track.event),
	};
	if (!track.sample || !track.raw || !track.label || !track.point || !track.event) {
		gz_gaze_track_free(&track);
		return GZ_ERR_NO_MEM;
	}
	*out_track = track;
	return GZ_OK;
}

void gz_gaze_track_free(struct gz_gaze_track *track)
{
	free(track->sample);
	free(track->raw);
	free(track->label);
	free(track->point);
	free(track->event);
	*track = (struct gz_gaze_track) { .count = 0 };
}

double gz_gaze_track_elapsed_ms(const struct gz_gaze_track *track, size_t from, size_t to)
{
	int64_t elapsed_ns;
	if (__builtin_sub_overflow(track->sample[to].host_ns, track->sample[from].host_ns,
				   &elapsed_ns))
		return to > from ? INFINITY : -INFINITY;
	return gz_ns_to_s(elapsed_ns) * 1000;
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

double gz_gaze_track_interval_ms(const struct gz_gaze_track *track)
{
	if (track->count < 2)
		return NAN;
	const size_t steps = track->count - 1;
	double *step_ms = calloc(steps, sizeof *step_ms), sum_ms = 0;
	if (!step_ms)
		return NAN;
	for (size_t i = 0; i < steps; i++)
		step_ms[i] = gz_gaze_track_elapsed_ms(track, i, i + 1);
	qsort(step_ms, steps, sizeof *step_ms, by_value);
	size_t used = 0;
	while (used < steps && step_ms[used] <= 1.5 * step_ms[steps / 2])
		sum_ms += step_ms[used++];
	free(step_ms);
	return sum_ms / (double)used;
}

void gz_gaze_track_run_pipeline(struct gz_gaze_track *track,
				const struct gz_pipeline_params *params, bool certain)
{
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, params, &track->display);
	for (size_t i = 0; i < track->count; i++) {
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &track->sample[i], &out);
		track->point[i] = out.gaze.point;
		track->event[i] = out.gaze.event;
		if (!certain || !out.gaze.final_known)
			continue;
		for (uint64_t k = 0; k <= out.gaze.final_span; k++)
			track->event[out.gaze.final_seq - k] = out.gaze.final_event;
	}
}

void gz_gaze_track_run_one_euro(struct gz_gaze_track *track, double beta)
{
	const struct gz_one_euro_params params = { 1, 1, beta };
	const struct gz_display *display = &track->display;
	const double deg[2] = { display->mm[0] / display->distance_mm * DEG,
				display->mm[1] / display->distance_mm * DEG };
	struct gz_one_euro axis[2] = { { .started = false } };
	struct gz_point point = { 0.5f, 0.5f };
	size_t last = 0;
	for (size_t i = 0; i < track->count; i++) {
		const struct gz_point raw = track->raw[i];
		if (isfinite(raw.x) && isfinite(raw.y)) {
			const double step_s = gz_gaze_track_elapsed_ms(track, last, i) / 1000;
			const double x =
				gz_one_euro_step(&axis[0], &params, step_s, raw.x * deg[0]);
			const double y =
				gz_one_euro_step(&axis[1], &params, step_s, raw.y * deg[1]);
			point = (struct gz_point) { (float)(x / deg[0]), (float)(y / deg[1]) };
			last = i;
		}
		track->point[i] = point;
	}
}
