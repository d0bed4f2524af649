#include "bench/filter/track.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/order.h"
#include "filter/offline.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "filter"

static const double DEG = 57.29577951;

/* ---- baselines ---- */

static const double TWO_PI = 6.2831853071795865;

/** Share of the new in exponential smoothing: Casiez et al. 2012, equations 2 and 3. */
static double share_of(double cutoff_hz, double step_s)
{
	double constant_s = 1 / (TWO_PI * cutoff_hz);
	return 1 / (1 + constant_s / step_s);
}

double gz_one_euro_step(struct gz_one_euro *state, const struct gz_one_euro_params *params,
			double step_s, double number)
{
	if (!state->started) {
		*state = (struct gz_one_euro) { .started = true, .value = number };
		return number;
	}
	double slope = (number - state->value) / step_s;
	state->derivative +=
		share_of(params->derivative_cutoff_hz, step_s) * (slope - state->derivative);
	double cutoff_hz = params->min_cutoff_hz + params->beta * fabs(state->derivative);
	state->value += share_of(cutoff_hz, step_s) * (number - state->value);
	return state->value;
}

bool gz_is_saccade_by_velocity(double threshold_deg_s, double step_deg, double step_s)
{
	return step_deg > threshold_deg_s * step_s;
}

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

static enum gz_event event_by_people(int label)
{
	switch (label) {
	case GZ_HUMAN_FIXATION:
		return GZ_EVENT_FIXATION;
	case GZ_HUMAN_SACCADE:
		return GZ_EVENT_SACCADE;
	case GZ_HUMAN_PURSUIT:
		return GZ_EVENT_PURSUIT;
	case GZ_HUMAN_BLINK:
		return GZ_EVENT_BLINK;
	default:
		return GZ_EVENT_LOST;
	}
}

enum gz_result gz_gaze_track_take_labelled(const struct gz_labelled_recording *recording,
					   struct gz_gaze_track *out_track)
{
	const enum gz_result result =
		gz_gaze_track_start(recording->count, &recording->display, out_track);
	for (size_t i = 0; i < recording->count && result == GZ_OK; i++) {
		out_track->sample[i] = recording->sample[i];
		out_track->raw[i] = recording->sample[i].point;
		out_track->label[i] = event_by_people(recording->label[i]);
	}
	return result;
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
	qsort(step_ms, steps, sizeof *step_ms, gz_compare_doubles);
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

void gz_gaze_track_take_smoothing(const struct gz_gaze_track *track,
				  const struct gz_pipeline_params *params,
				  struct gz_smooth_input *out_inputs)
{
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, params, &track->display);
	for (size_t i = 0; i < track->count; i++) {
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &track->sample[i], &out);
		out_inputs[i] = (struct gz_smooth_input) { .time_ns = INT64_MIN };
		if (out.rejection == GZ_REJECT_TIME)
			continue;
		const struct gz_classify_entry *newest = gz_classify_newest(&pipeline.classify);
		out_inputs[i] = (struct gz_smooth_input) { out.gaze.event, newest->time_ns,
							   newest->valid, newest->point };
	}
}

void gz_gaze_track_smooth(struct gz_gaze_track *track, const struct gz_smooth_params *params,
			  const struct gz_smooth_input *inputs)
{
	struct gz_smooth_state state = { .started = false };
	struct gz_point point = { 0.5F, 0.5F };
	for (size_t i = 0; i < track->count; i++) {
		if (inputs[i].time_ns != INT64_MIN)
			point = gz_smooth_step(&state, params, &track->display, &inputs[i]);
		track->point[i] = point;
	}
}

void gz_gaze_track_run_one_euro(struct gz_gaze_track *track,
				const struct gz_one_euro_params *params)
{
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
			const double x = gz_one_euro_step(&axis[0], params, step_s, raw.x * deg[0]);
			const double y = gz_one_euro_step(&axis[1], params, step_s, raw.y * deg[1]);
			point = (struct gz_point) { (float)(x / deg[0]), (float)(y / deg[1]) };
			last = i;
		}
		track->point[i] = point;
	}
}
/* ---- gaze logs ---- */

/* Samples whose number is not known before they are read. */
struct samples {
	struct gz_sample *sample;
	struct gz_point *raw;
	size_t count, room;
};

static enum gz_result make_sample_room(struct samples *samples)
{
	if (samples->count < samples->room)
		return GZ_OK;
	const size_t room = samples->room ? 2 * samples->room : 4096;
	struct gz_sample *sample = realloc(samples->sample, room * sizeof *sample);
	if (sample)
		samples->sample = sample;
	struct gz_point *raw = realloc(samples->raw, room * sizeof *raw);
	if (raw)
		samples->raw = raw;
	if (!sample || !raw)
		return GZ_ERR_NO_MEM;
	samples->room = room;
	return GZ_OK;
}

/* A sample's raw point and whether its time counts are the pipeline's to say. */
static enum gz_result add_log_sample(struct samples *samples, struct gz_pipeline *pipeline,
				     const struct gz_sample *sample)
{
	const enum gz_result result = make_sample_room(samples);
	if (result != GZ_OK)
		return result;
	struct gz_pipeline_output output;
	struct gz_sample *kept = &samples->sample[samples->count];
	*kept = *sample;
	kept->seq = samples->count;
	gz_pipeline_step(pipeline, kept, &output);
	if (output.rejection == GZ_REJECT_TIME)
		return GZ_OK;
	samples->raw[samples->count++] = output.gaze.raw;
	return GZ_OK;
}

static enum gz_result read_samples(struct gz_gaze_log_reader *reader,
				   const struct gz_gaze_log_track *into, struct samples *samples)
{
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, &into->params, &into->track.display);
	struct gz_gaze_log_record *record = malloc(sizeof *record);
	enum gz_result result = record ? GZ_OK : GZ_ERR_NO_MEM;
	while (result == GZ_OK) {
		result = gz_gaze_log_read(reader, record);
		if (result ==
		    GZ_ERR_FORMAT) /* logged; reading continues after the damaged record */
			result = GZ_OK;
		else if (result == GZ_OK && record->kind == GZ_GAZE_LOG_SAMPLE)
			result = add_log_sample(samples, &pipeline, &record->sample);
	}
	free(record);
	return result == GZ_ERR_END ? GZ_OK : result;
}

/* Label all samples with the whole recording in view. */
static enum gz_result label_offline(struct gz_gaze_track *track,
				    const struct gz_pipeline_params *params)
{
	static const enum gz_event events[GZ_OFFLINE_LABELS] = {
		[GZ_OFFLINE_FIXATION] = GZ_EVENT_FIXATION, [GZ_OFFLINE_SACCADE] = GZ_EVENT_SACCADE,
		[GZ_OFFLINE_OSCILLATION] = GZ_EVENT_LOST, /* neither a fixation nor a saccade */
		[GZ_OFFLINE_PURSUIT] = GZ_EVENT_PURSUIT,   [GZ_OFFLINE_BLINK] = GZ_EVENT_BLINK,
		[GZ_OFFLINE_LOST] = GZ_EVENT_LOST,
	};
	struct gz_offline *offline = NULL;
	struct gz_offline_labels labels = { .count = 0 };
	enum gz_result result = gz_offline_create(params, &track->display, &offline);
	for (size_t i = 0; i < track->count && result == GZ_OK; i++)
		result = gz_offline_add(offline, &track->sample[i]);
	if (result == GZ_OK)
		result = gz_offline_finish(offline, &labels);
	for (size_t i = 0; i < labels.count; i++)
		track->label[i] = events[labels.label[i]];
	gz_offline_labels_free(&labels);
	gz_offline_destroy(&offline);
	return result;
}

/* Takes over the samples. */
static enum gz_result take_samples(struct samples *samples, struct gz_gaze_log_track *log)
{
	struct gz_gaze_track *track = &log->track;
	const struct gz_display display = track->display;
	enum gz_result result = gz_gaze_track_start(samples->count, &display, track);
	if (result != GZ_OK)
		return result;
	free(track->sample);
	free(track->raw);
	track->sample = samples->sample;
	track->raw = samples->raw;
	*samples = (struct samples) { .count = 0 };
	result = label_offline(track, &log->params);
	if (result != GZ_OK)
		gz_gaze_track_free(track);
	return result;
}

static enum gz_result read_log(struct gz_gaze_log_reader *reader, const char *path,
			       const struct gz_log *log, struct samples *samples,
			       struct gz_gaze_log_track *into)
{
	const struct gz_gaze_log_header *header = gz_gaze_log_header(reader);
	enum gz_result result = gz_pipeline_recorded_params(header, path, log, &into->params);
	if (result != GZ_OK)
		return result;
	into->display_known = header->has_display && gz_display_valid(&header->display);
	/* Only its angles matter here, and those of the default are the same at any size. */
	into->track.display =
		into->display_known ? header->display : gz_display_default(1920, 1080);
	result = read_samples(reader, into, samples);
	if (result == GZ_OK && samples->count == 0) {
		gz_err(log, "%s: holds no sample; record for longer, or give another log", path);
		return GZ_ERR_FORMAT;
	}
	if (result == GZ_OK)
		result = take_samples(samples, into);
	if (result == GZ_ERR_NO_MEM)
		gz_err(log, "%s: too long for this machine's memory; give a part of it", path);
	return result;
}

enum gz_result gz_gaze_track_read_log(const char *path, const struct gz_log *log,
				      struct gz_gaze_log_track *out_log)
{
	struct gz_gaze_log_reader *reader = NULL;
	struct samples samples = { .count = 0 };
	struct gz_gaze_log_track made = { .display_known = false };
	enum gz_result result = gz_gaze_log_open(path, log, &reader);
	if (result == GZ_OK)
		result = read_log(reader, path, log, &samples, &made);
	gz_gaze_log_close(&reader);
	free(samples.sample);
	free(samples.raw);
	if (result == GZ_OK)
		*out_log = made;
	return result;
}
