/* A gaze log as a source: the reader and the pipeline step on as the frames' time does. */
#include "view/gaze/gaze_source.h"

#include <stdlib.h>

#include "base/clock.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

#define GZ_LOG_MODULE "gazeview"

struct log_source {
	struct gz_gaze_source base;
	const struct gz_log *log;
	struct gz_gaze_log_reader *reader;
	struct gz_pipeline pipeline;
	bool has_display; /* the log's own, not the default */
	struct gz_display display;
	int64_t start_ns;         /* host_ns of the first sample */
	bool has_last;            /* last_ns holds something */
	int64_t last_ns;          /* host_ns of the last sample, as the file's end has it */
	bool pending_known;       /* a sample has been read that its time has not come for */
	struct gz_sample pending; /* only then */
	struct gz_gaze_reading reading;
	int64_t shown_ns; /* host_ns of the sample in reading */
};

/* The next sample into pending; marks, gaps and unreadable lines are stepped over. */
static void fetch(struct log_source *self)
{
	struct gz_gaze_log_record record;
	self->pending_known = false;
	for (;;) {
		enum gz_result r = gz_gaze_log_read(self->reader, &record);
		if (r == GZ_ERR_FORMAT)
			continue; /* logged by the reader; it goes on behind the line */
		if (r != GZ_OK)
			return;
		if (record.kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		self->pending = record.sample;
		self->pending_known = true;
		return;
	}
}

static void step(struct log_source *self)
{
	struct gz_pipeline_output output;
	gz_pipeline_step(&self->pipeline, &self->pending, &output);
	self->reading = (struct gz_gaze_reading) {
		.known = true,
		.point = output.gaze.point,
		.has_age = true,
		.connected = true,
		.has_event = true,
		.event = output.gaze.event,
		.noise_deg = gz_pipeline_noise_deg(&self->pipeline),
		.numbered = true,
		.seq = self->pending.seq,
		.sample_ns = self->pending.host_ns,
	};
	self->shown_ns = self->pending.host_ns;
	fetch(self);
}

/* Times of a log are anybody's: what does not fit stays at the end of time. */
static int64_t later(int64_t time_ns, int64_t by_ns)
{
	int64_t sum;
	return __builtin_add_overflow(time_ns, by_ns, &sum) ? INT64_MAX : sum;
}

static int64_t elapsed(int64_t from_ns, int64_t to_ns)
{
	int64_t difference;
	return __builtin_sub_overflow(to_ns, from_ns, &difference) ? INT64_MAX : difference;
}

static void log_read(struct gz_gaze_source *source, int64_t time_ns,
		     struct gz_gaze_reading *out_reading)
{
	struct log_source *self = (struct log_source *)source;
	int64_t now_ns = later(self->start_ns, time_ns);
	while (self->pending_known && self->pending.host_ns <= now_ns)
		step(self);
	self->reading.age_ns = elapsed(self->shown_ns, now_ns);
	*out_reading = self->reading;
}

bool gz_gaze_source_log_forward(struct gz_gaze_source *source, int64_t time_ns, int64_t budget_ns)
{
	/* Samples between looks at the clock: chosen, some tens of microseconds. */
	enum { AT_ONCE = 64 };
	struct log_source *self = (struct log_source *)source;
	const int64_t until_ns = gz_clock_now_ns() + budget_ns;
	if (source->ops->read != log_read)
		return true;
	const int64_t now_ns = later(self->start_ns, time_ns);
	do {
		for (int i = 0; i < AT_ONCE; i++) {
			if (!self->pending_known || self->pending.host_ns > now_ns)
				return true;
			step(self);
		}
	} while (gz_clock_now_ns() < until_ns);
	return false;
}

bool gz_gaze_source_log_place(const struct gz_gaze_source *source,
			      struct gz_gaze_log_place *out_place)
{
	const struct log_source *self = (const struct log_source *)source;
	if (source->ops->read != log_read)
		return false;
	*out_place = (struct gz_gaze_log_place) {
		.at_ns = elapsed(self->start_ns, self->shown_ns),
		.length_ns = self->has_last ? elapsed(self->start_ns, self->last_ns) : -1,
		.ended = !self->pending_known,
	};
	return true;
}

static bool log_display(struct gz_gaze_source *source, struct gz_display *out_display)
{
	const struct log_source *self = (const struct log_source *)source;
	if (self->has_display)
		*out_display = self->display;
	return self->has_display;
}

static void log_destroy(struct gz_gaze_source *source)
{
	struct log_source *self = (struct log_source *)source;
	gz_gaze_log_close(&self->reader);
	free(self);
}

static const struct gz_gaze_source_ops log_ops = {
	.name = "log",
	.live = false,
	.read = log_read,
	.display = log_display,
	.destroy = log_destroy,
};

static enum gz_result prepare(struct log_source *self, const char *path)
{
	const struct gz_gaze_log_header *header = gz_gaze_log_header(self->reader);
	struct gz_pipeline_params params;
	enum gz_result r = gz_pipeline_recorded_params(header, path, self->log, &params);
	if (r != GZ_OK)
		return r;
	self->has_display = header->has_display && gz_display_valid(&header->display);
	/* Only its angles matter here, and those of the default are the same at any size. */
	self->display = self->has_display ? header->display : gz_display_default(1920, 1080);
	gz_pipeline_init(&self->pipeline, &params, &self->display);
	fetch(self);
	if (!self->pending_known) {
		gz_err(self->log, "%s: holds no sample; record for longer, or give another log",
		       path);
		return GZ_ERR_FORMAT;
	}
	self->start_ns = self->shown_ns = self->pending.host_ns;
	self->has_last = gz_gaze_log_find_last(path, &self->last_ns) == GZ_OK;
	return GZ_OK;
}

enum gz_result gz_gaze_source_log(const char *path, const struct gz_log *log,
				  struct gz_gaze_source **out_source)
{
	struct log_source *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &log_ops;
	self->log = log;
	enum gz_result r = gz_gaze_log_open(path, log, &self->reader);
	if (r == GZ_OK)
		r = prepare(self, path);
	if (r != GZ_OK) {
		log_destroy(&self->base);
		return r;
	}
	*out_source = &self->base;
	return GZ_OK;
}
