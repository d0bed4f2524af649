#include "client/gazectl/inspect/log_summary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/order.h"
#include "filter/pipeline.h"

#define GZ_LOG_MODULE "pipeline"

/* The settings with which the log was recorded, as far as this version knows them. */
static struct gz_pipeline_params recorded_params(const struct gz_gaze_log_header *header,
						 const struct gz_log *log)
{
	struct gz_pipeline_params params = gz_pipeline_unnamed_params(header);
	const struct gz_option_binding binding = {
		.options = gz_pipeline_options,
		.count = gz_pipeline_option_count,
		.target = &params,
	};
	for (size_t i = 0; i < header->setting_count; i++) {
		char key[GZ_NAME_SIZE + 16], message[256] = "unknown";
		if (strcmp(header->settings[i].key, GZ_PIPELINE_FORESTS_KEY) == 0)
			continue;
		snprintf(key, sizeof key, "pipeline.%s", header->settings[i].key);
		const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
		if (!option || gz_option_parse(option, header->settings[i].value, &params, message,
					       sizeof message) != GZ_OK)
			gz_warn(log, "%s %s: %s; using the default", key, header->settings[i].value,
				message);
	}
	char reason[256];
	if (gz_pipeline_check_params(&params, reason, sizeof reason) != GZ_OK) {
		gz_warn(log, "%s; using the default", reason);
		params.correct = gz_pipeline_default_params().correct;
	}
	(void)gz_pipeline_other_forests(header, &params, "the log", log);
	return params;
}

void gz_log_pipeline_init(struct gz_pipeline *pipeline, const struct gz_gaze_log_header *header,
			  const struct gz_log *log)
{
	struct gz_pipeline_params params = recorded_params(header, log);
	struct gz_display display = gz_display_default(1920, 1080);
	if (header->has_display)
		display = header->display;
	gz_pipeline_init(pipeline, &params, &display);
}

const double gz_log_summary_bin_ends[GZ_LOG_SUMMARY_BINS - 1] = { 0.5, 0.75, 0.9, 1.1, 1.25,
								  1.5, 2.5,  4.5, 10.5 };

/* Room for intervals at first; it is doubled when it is full. Chosen: an hour at 1200 Hz takes 12
 * steps. */
enum { INTERVALS_FIRST = 1024 };

struct summarizer {
	struct gz_log_summary summary;
	struct gz_pipeline pipeline;
	int64_t *intervals_ns;
	size_t interval_count, interval_room;
};

static enum gz_result keep_interval(struct summarizer *s, int64_t interval_ns)
{
	if (s->interval_count == s->interval_room) {
		size_t room = s->interval_room ? 2 * s->interval_room : INTERVALS_FIRST;
		int64_t *larger = realloc(s->intervals_ns, room * sizeof *larger);
		if (!larger)
			return GZ_ERR_NO_MEM;
		s->intervals_ns = larger;
		s->interval_room = room;
	}
	s->intervals_ns[s->interval_count++] = interval_ns;
	return GZ_OK;
}

static enum gz_result add_time(struct summarizer *s, int64_t host_ns)
{
	struct gz_log_summary *summary = &s->summary;
	if (summary->samples == 0) {
		summary->first_ns = summary->last_ns = host_ns;
		return GZ_OK;
	}
	int64_t interval_ns;
	if (__builtin_sub_overflow(host_ns, summary->last_ns, &interval_ns) || interval_ns <= 0) {
		summary->intervals.backward++;
		return GZ_OK;
	}
	summary->last_ns = host_ns;
	return keep_interval(s, interval_ns);
}

static void add_validity(struct gz_log_summary *summary, const struct gz_sample *sample)
{
	bool valid = sample->valid;
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		const struct gz_eye_sample *eye = &sample->eye[i];
		summary->eye_measured[i] |= eye->valid || isfinite(eye->point.x);
		summary->eye_valid[i] += eye->valid;
		valid |= eye->valid;
	}
	summary->valid += valid;
}

static void add_to_pipeline(struct summarizer *s, const struct gz_sample *sample)
{
	struct gz_pipeline_output output;
	gz_pipeline_step(&s->pipeline, sample, &output);
	s->summary.rejected[output.rejection]++;
	for (size_t i = 0; i < output.fixation_count; i++)
		s->summary.fixations += output.fixations[i].final;
	s->summary.saccades += output.saccade_count;
	for (size_t i = 0; i < output.blink_count; i++)
		s->summary.blinks += output.blinks[i].onset;
}

static void add_mark(struct gz_log_summary *summary, const struct gz_gaze_log_record *record)
{
	if (summary->mark_count < GZ_LOG_SUMMARY_MARKS) {
		struct gz_log_summary_mark *mark = &summary->marks[summary->mark_count];
		mark->host_ns = record->host_ns;
		memcpy(mark->text, record->text, sizeof mark->text);
	}
	summary->mark_count++;
}

static enum gz_result summarise_record(struct summarizer *s,
				       const struct gz_gaze_log_record *record)
{
	enum gz_result result;
	switch (record->kind) {
	case GZ_GAZE_LOG_SAMPLE:
		result = add_time(s, record->sample.host_ns);
		if (result != GZ_OK)
			return result;
		s->summary.samples++;
		add_validity(&s->summary, &record->sample);
		add_to_pipeline(s, &record->sample);
		return GZ_OK;
	case GZ_GAZE_LOG_GAP:
		s->summary.gaps++;
		s->summary.missing += record->missing;
		return GZ_OK;
	case GZ_GAZE_LOG_MARK:
		add_mark(&s->summary, record);
		return GZ_OK;
	case GZ_GAZE_LOG_WINDOW:
		s->summary.windows++;
		memcpy(s->summary.window_px, record->window_px, sizeof record->window_px);
		return GZ_OK;
	case GZ_GAZE_LOG_SCENE: /* the samples have it, too */
		return GZ_OK;
	}
	return GZ_OK;
}

static size_t bin_of(double medians)
{
	size_t bin = 0;
	while (bin < GZ_LOG_SUMMARY_BINS - 1 && medians >= gz_log_summary_bin_ends[bin])
		bin++;
	return bin;
}

static void sort_intervals(struct summarizer *s)
{
	struct gz_log_intervals *intervals = &s->summary.intervals;
	size_t n = s->interval_count;
	intervals->count = n;
	if (n == 0)
		return;
	qsort(s->intervals_ns, n, sizeof s->intervals_ns[0], gz_compare_int64s);
	intervals->min_ns = s->intervals_ns[0];
	intervals->median_ns = s->intervals_ns[n / 2];
	intervals->p99_ns = s->intervals_ns[(n * 99 + 99) / 100 - 1];
	intervals->max_ns = s->intervals_ns[n - 1];
	for (size_t i = 0; i < n; i++)
		intervals
			->bins[bin_of((double)s->intervals_ns[i] / (double)intervals->median_ns)]++;
}

static void finish_summary(struct summarizer *s)
{
	struct gz_log_summary *summary = &s->summary;
	sort_intervals(s);
	/* Unsigned, because a damaged log may hold any times. */
	uint64_t duration_ns = (uint64_t)summary->last_ns - (uint64_t)summary->first_ns;
	summary->duration_s = (double)duration_ns * 1e-9;
	if (duration_ns > 0)
		summary->rate_hz =
			(double)(summary->intervals.count + summary->missing) / summary->duration_s;
	summary->noise_deg = gz_pipeline_noise_deg(&s->pipeline);
}

static enum gz_result summarise_records(struct summarizer *s, struct gz_gaze_log_reader *reader)
{
	for (;;) {
		struct gz_gaze_log_record record;
		enum gz_result result = gz_gaze_log_read(reader, &record);
		if (result == GZ_ERR_END)
			return GZ_OK;
		if (result == GZ_ERR_FORMAT) {
			s->summary.malformed++;
			continue;
		}
		if (result == GZ_OK)
			result = summarise_record(s, &record);
		if (result != GZ_OK)
			return result;
	}
}

enum gz_result gz_log_summarize(struct gz_gaze_log_reader *reader, const struct gz_log *log,
				struct gz_log_summary *out_summary)
{
	struct summarizer *s = calloc(1, sizeof *s);
	if (!s)
		return GZ_ERR_NO_MEM;
	gz_log_pipeline_init(&s->pipeline, gz_gaze_log_header(reader), log);
	enum gz_result result = summarise_records(s, reader);
	if (result == GZ_OK) {
		finish_summary(s);
		s->summary.ending = gz_gaze_log_ending(reader);
		*out_summary = s->summary;
	}
	free(s->intervals_ns);
	free(s);
	return result;
}
