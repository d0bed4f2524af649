/* A gaze log as a track: its samples as they were, labelled by the pipeline that they ran through.
 */
#include "bench/filter/track.h"

#include <math.h>
#include <stdlib.h>

#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "filter"

/* Samples whose number is not known before they are read. */
struct samples {
	struct gz_sample *sample;
	struct gz_point *raw;
	size_t count, room;
};

static enum gz_result make_room(struct samples *samples)
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
static enum gz_result add(struct samples *samples, struct gz_pipeline *pipeline,
			  const struct gz_sample *sample)
{
	const enum gz_result result = make_room(samples);
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
		if (result == GZ_ERR_FORMAT) /* logged; it goes on behind the line */
			result = GZ_OK;
		else if (result == GZ_OK && record->kind == GZ_GAZE_LOG_SAMPLE)
			result = add(samples, &pipeline, &record->sample);
	}
	free(record);
	return result == GZ_ERR_END ? GZ_OK : result;
}

/* Takes over the samples. */
static enum gz_result take(struct samples *samples, struct gz_gaze_log_track *log)
{
	struct gz_gaze_track *track = &log->track;
	const struct gz_display display = track->display;
	const enum gz_result result = gz_gaze_track_start(samples->count, &display, track);
	if (result != GZ_OK)
		return result;
	free(track->sample);
	free(track->raw);
	track->sample = samples->sample;
	track->raw = samples->raw;
	*samples = (struct samples) { .count = 0 };
	gz_gaze_track_run_pipeline(track, &log->params, true);
	for (size_t i = 0; i < track->count; i++)
		track->label[i] = track->event[i];
	return GZ_OK;
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
		result = take(samples, into);
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
