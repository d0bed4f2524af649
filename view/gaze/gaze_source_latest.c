/* A daemon's latest channel as a source; its status, on the stream beside it, tells the display. */
#include "view/gaze/gaze_source.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "client/client.h"
#include "client/stream.h"
#include "protocol/endpoint.h"
#include "protocol/wire.h"

/* Where the local daemon is found is looked at again so often while there is none (chosen: it is
 * there a second after it was started, and costs a few calls). */
#define FIND_INTERVAL_NS GZ_NS_PER_S

struct latest_source {
	struct gz_gaze_source base;
	const struct gz_log *log;
	bool finds; /* no endpoint was named */
	char found[GZ_ENDPOINT_SIZE];
	int64_t find_ns; /* when it is looked for again */
	struct gz_client *client;
	struct gz_stream *status; /* NULL where the stream's endpoint cannot be told */
	double noise_deg;         /* as status tells it; NaN before that */
	bool has_display;
	struct gz_display display;
	bool has_told; /* what follows */
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

/* A daemon that comes later may bind its sockets elsewhere: that of the system, or the user's. The
 * reader is kept where no other one can be had. */
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
		reading.numbered = true;
		reading.seq = gaze.seq;
		reading.sample_ns = gaze.host_ns;
	}
	gz_client_get_counters(self->client, &counters);
	reading.connected = counters.connected;
	if (!reading.connected) {
		self->has_told = false; /* the next one may be another */
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

/* Where no status can be had, none is waited for. */
static const struct gz_gaze_source_ops latest_alone_ops = {
	.name = "daemon",
	.live = true,
	.read = latest_read,
	.destroy = latest_destroy,
};

/* The stream beside a latest channel: the same folder. A TCP port says nothing about another. */
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
	/* Where it cannot be told, gz_client_open() says why. */
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
