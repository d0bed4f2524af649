#include "view/gaze/gaze_source.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "client/client.h"
#include "client/stream.h"
#include "filter/pipeline.h"
#include "protocol/endpoint.h"
#include "protocol/gaze_log.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "gazeview"

/* A point that the caller sets: once for "fixed", on every motion for "mouse". */
struct point_source {
	struct gz_gaze_source base;
	bool known;
	struct gz_point point;
};

static void point_read(struct gz_gaze_source *source, int64_t time_ns,
		       struct gz_gaze_reading *out_reading)
{
	(void)time_ns;
	const struct point_source *self = (const struct point_source *)source;
	*out_reading = (struct gz_gaze_reading) {
		.known = self->known,
		.point = self->point,
		.connected = true,
		.noise_deg = NAN,
	};
}

static void point_destroy(struct gz_gaze_source *source)
{
	free(source);
}

static const struct gz_gaze_source_ops fixed_ops = {
	.name = "fixed",
	.live = false,
	.read = point_read,
	.destroy = point_destroy,
};

static const struct gz_gaze_source_ops mouse_ops = {
	.name = "mouse",
	.live = true,
	.read = point_read,
	.destroy = point_destroy,
};

static enum gz_result point_create(const struct gz_gaze_source_ops *ops, bool known,
				   struct gz_point point, struct gz_gaze_source **out_source)
{
	struct point_source *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = ops;
	self->known = known;
	self->point = point;
	*out_source = &self->base;
	return GZ_OK;
}

enum gz_result gz_gaze_source_fixed(struct gz_point point, struct gz_gaze_source **out_source)
{
	return point_create(&fixed_ops, true, point, out_source);
}

enum gz_result gz_gaze_source_mouse(struct gz_gaze_source **out_source)
{
	return point_create(&mouse_ops, false, (struct gz_point) { 0.5f, 0.5f }, out_source);
}

void gz_gaze_source_move(struct gz_gaze_source *source, struct gz_point point)
{
	if (source->ops != &mouse_ops)
		return;
	struct point_source *self = (struct point_source *)source;
	self->known = true;
	self->point = point;
}

void gz_gaze_source_read(struct gz_gaze_source *source, int64_t time_ns,
			 struct gz_gaze_reading *out_reading)
{
	source->ops->read(source, time_ns, out_reading);
}

bool gz_gaze_source_display(struct gz_gaze_source *source, struct gz_display *out_display)
{
	return source->ops->display && source->ops->display(source, out_display);
}

const struct gz_status *gz_gaze_source_status(const struct gz_gaze_source *source)
{
	return source->ops->status ? source->ops->status(source) : NULL;
}

void gz_gaze_source_destroy(struct gz_gaze_source **source)
{
	if (!source || !*source)
		return;
	(*source)->ops->destroy(*source);
	*source = NULL;
}

/* How often the local daemon's endpoint is looked up while it is not connected. Chosen: the source
 * connects within a second of the daemon's start, and a lookup costs a few system calls. */
#define FIND_INTERVAL_NS GZ_NS_PER_S

struct latest_source {
	struct gz_gaze_source base;
	const struct gz_log *log;
	bool finds; /* no endpoint was named: look the local one up */
	char found[GZ_ENDPOINT_SIZE];
	int64_t find_ns; /* time of the next lookup */
	struct gz_client *client;
	struct gz_stream *status; /* NULL: the stream's endpoint is unknown */
	double noise_deg;         /* from the status; NaN: none yet */
	bool has_display;
	struct gz_display display;
	bool has_told; /* told is valid */
	struct gz_status told;
};

static const char *const status_topics[] = { GZ_TOPIC_STATUS, NULL };

static void take_status(struct latest_source *self)
{
	struct gz_message message;
	while (self->status && gz_stream_read(self->status, 0, &message) == GZ_OK) {
		if (message.kind != GZ_MESSAGE_STATUS)
			continue;
		self->noise_deg = message.status.noise_deg;
		self->told = message.status;
		self->has_told = true;
		if (!gz_display_valid(&message.status.display))
			continue;
		self->display = message.status.display;
		self->has_display = true;
	}
}

/* A daemon that starts later may bind other sockets: the system's or the user's. If no new client
 * can be opened, the old one is kept. */
static void find_again(struct latest_source *self)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	struct gz_client *client;
	struct gz_stream *status;
	const int64_t now_ns = gz_clock_now_ns();
	if (!self->finds || now_ns < self->find_ns)
		return;
	self->find_ns = now_ns + FIND_INTERVAL_NS;
	if (gz_endpoint_find("latest", NULL, endpoint, sizeof endpoint) != GZ_OK ||
	    strcmp(endpoint, self->found) == 0)
		return;
	memcpy(self->found, endpoint, sizeof endpoint);
	if (gz_client_open(NULL, self->log, &client) != GZ_OK)
		return;
	gz_client_close(&self->client);
	self->client = client;
	if (gz_stream_open(NULL, status_topics, self->log, &status) != GZ_OK)
		return;
	gz_stream_close(&self->status);
	self->status = status;
}

static void latest_read(struct gz_gaze_source *source, int64_t time_ns,
			struct gz_gaze_reading *out_reading)
{
	(void)time_ns;
	struct latest_source *self = (struct latest_source *)source;
	struct gz_gaze gaze;
	struct gz_client_counters counters;
	int64_t age_ns;
	struct gz_gaze_reading reading = { 0 };
	if (gz_client_latest(self->client, &gaze, &age_ns) == GZ_OK) {
		reading.known = true;
		reading.point = gaze.point;
		reading.has_age = true;
		reading.age_ns = age_ns;
		reading.has_event = true;
		reading.event = gaze.event;
		reading.landing = gaze.landing;
		reading.numbered = true;
		reading.seq = gaze.seq;
		reading.sample_ns = gaze.host_ns;
	}
	gz_client_get_counters(self->client, &counters);
	reading.connected = counters.connected;
	if (!reading.connected) {
		self->has_told = false; /* the next daemon may differ */
		find_again(self);
	}
	take_status(self);
	reading.noise_deg = self->noise_deg;
	*out_reading = reading;
}

static bool latest_display(struct gz_gaze_source *source, struct gz_display *out_display)
{
	const struct latest_source *self = (const struct latest_source *)source;
	if (self->has_display)
		*out_display = self->display;
	return self->has_display;
}

static const struct gz_status *latest_status(const struct gz_gaze_source *source)
{
	const struct latest_source *self = (const struct latest_source *)source;
	return self->has_told ? &self->told : NULL;
}

static void latest_destroy(struct gz_gaze_source *source)
{
	struct latest_source *self = (struct latest_source *)source;
	gz_client_close(&self->client);
	gz_stream_close(&self->status);
	free(self);
}

static const struct gz_gaze_source_ops latest_ops = {
	.name = "daemon",
	.live = true,
	.read = latest_read,
	.display = latest_display,
	.status = latest_status,
	.destroy = latest_destroy,
};

/* Without a display slot, callers do not wait for a status. */
static const struct gz_gaze_source_ops latest_alone_ops = {
	.name = "daemon",
	.live = true,
	.read = latest_read,
	.destroy = latest_destroy,
};

/* The endpoint of the stream: in the same folder as the latest channel. A TCP port does not give
 * the other one. */
static bool stream_beside(const char *latest, char *text, size_t size)
{
	static const char name[] = "/latest";
	size_t length = strlen(latest), tail = sizeof name - 1;
	if (strncmp(latest, "ipc://", 6) != 0 || length < tail ||
	    strcmp(latest + length - tail, name) != 0)
		return false;
	int written = snprintf(text, size, "%.*s/stream", (int)(length - tail), latest);
	return written > 0 && (size_t)written < size;
}

static enum gz_result open_status(struct latest_source *self, const char *endpoint,
				  const struct gz_log *log)
{
	char stream[GZ_ENDPOINT_SIZE];
	if (endpoint && !stream_beside(endpoint, stream, sizeof stream))
		return GZ_OK;
	self->base.ops = &latest_ops;
	return gz_stream_open(endpoint ? stream : NULL, status_topics, log, &self->status);
}

enum gz_result gz_gaze_source_latest(const char *endpoint, const struct gz_log *log,
				     struct gz_gaze_source **out_source)
{
	struct latest_source *self = calloc(1, sizeof *self);
	if (!self)
		return GZ_ERR_NO_MEM;
	self->base.ops = &latest_alone_ops;
	self->noise_deg = NAN;
	if (endpoint && !endpoint[0])
		endpoint = NULL;
	self->log = log;
	self->finds = !endpoint;
	/* If no endpoint is found, gz_client_open() logs the reason. */
	if (self->finds &&
	    gz_endpoint_find("latest", NULL, self->found, sizeof self->found) != GZ_OK)
		self->found[0] = '\0';
	enum gz_result r = gz_client_open(endpoint, log, &self->client);
	if (r == GZ_OK)
		r = open_status(self, endpoint, log);
	if (r != GZ_OK) {
		latest_destroy(&self->base);
		return r;
	}
	*out_source = &self->base;
	return GZ_OK;
}

struct log_source {
	struct gz_gaze_source base;
	const struct gz_log *log;
	struct gz_gaze_log_reader *reader;
	struct gz_pipeline pipeline;
	bool has_display; /* display is from the log, not the default */
	struct gz_display display;
	int64_t start_ns;         /* host_ns of the first sample */
	bool has_last;            /* last_ns is valid */
	int64_t last_ns;          /* host_ns of the last sample in the file */
	bool pending_known;       /* pending is valid */
	struct gz_sample pending; /* the next sample; its time has not come */
	struct gz_gaze_reading reading;
	int64_t shown_ns; /* host_ns of the sample in reading */
};

/* Read the next sample into pending; skip marks, gaps and unreadable lines. */
static void fetch_sample(struct log_source *self)
{
	struct gz_gaze_log_record record;
	self->pending_known = false;
	for (;;) {
		enum gz_result r = gz_gaze_log_read(self->reader, &record);
		if (r == GZ_ERR_FORMAT)
			continue; /* logged by the reader, which continues after the line */
		if (r != GZ_OK)
			return;
		if (record.kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		self->pending = record.sample;
		self->pending_known = true;
		return;
	}
}

static void step_log(struct log_source *self)
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
		.landing = output.gaze.landing,
		.noise_deg = gz_pipeline_noise_deg(&self->pipeline),
		.numbered = true,
		.seq = self->pending.seq,
		.sample_ns = self->pending.host_ns,
	};
	self->shown_ns = self->pending.host_ns;
	fetch_sample(self);
}

/* The times in a log may be any numbers: results saturate at INT64_MAX. */
static int64_t add_ns(int64_t time_ns, int64_t by_ns)
{
	int64_t sum;
	return __builtin_add_overflow(time_ns, by_ns, &sum) ? INT64_MAX : sum;
}

static int64_t elapsed_ns(int64_t from_ns, int64_t to_ns)
{
	int64_t difference;
	return __builtin_sub_overflow(to_ns, from_ns, &difference) ? INT64_MAX : difference;
}

static void log_read(struct gz_gaze_source *source, int64_t time_ns,
		     struct gz_gaze_reading *out_reading)
{
	struct log_source *self = (struct log_source *)source;
	int64_t now_ns = add_ns(self->start_ns, time_ns);
	while (self->pending_known && self->pending.host_ns <= now_ns)
		step_log(self);
	self->reading.age_ns = elapsed_ns(self->shown_ns, now_ns);
	*out_reading = self->reading;
}

bool gz_gaze_source_log_forward(struct gz_gaze_source *source, int64_t time_ns, int64_t budget_ns)
{
	/* Samples between reads of the clock. Chosen: some tens of microseconds of work. */
	enum { AT_ONCE = 64 };
	struct log_source *self = (struct log_source *)source;
	const int64_t until_ns = gz_clock_now_ns() + budget_ns;
	if (source->ops->read != log_read)
		return true;
	const int64_t now_ns = add_ns(self->start_ns, time_ns);
	do {
		for (int i = 0; i < AT_ONCE; i++) {
			if (!self->pending_known || self->pending.host_ns > now_ns)
				return true;
			step_log(self);
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
		.at_ns = elapsed_ns(self->start_ns, self->shown_ns),
		.length_ns = self->has_last ? elapsed_ns(self->start_ns, self->last_ns) : -1,
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

static enum gz_result prepare_log(struct log_source *self, const char *path)
{
	const struct gz_gaze_log_header *header = gz_gaze_log_header(self->reader);
	struct gz_pipeline_params params;
	enum gz_result r = gz_pipeline_recorded_params(header, path, self->log, &params);
	if (r != GZ_OK)
		return r;
	self->has_display = header->has_display && gz_display_valid(&header->display);
	/* Only angles matter here, and the default display has the same at any size. */
	self->display = self->has_display ? header->display : gz_display_default(1920, 1080);
	gz_pipeline_init(&self->pipeline, &params, &self->display);
	fetch_sample(self);
	if (!self->pending_known) {
		gz_err(self->log,
		       "%s: the log has no samples; record for longer or name another log", path);
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
		r = prepare_log(self, path);
	if (r != GZ_OK) {
		log_destroy(&self->base);
		return r;
	}
	*out_source = &self->base;
	return GZ_OK;
}
