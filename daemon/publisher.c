#include "daemon/publisher.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#define GZ_LOG_MODULE "publisher"

/* Readers send subscriptions alone: a topic's length, and some. */
static const int64_t SUBSCRIPTION_SIZE_MAX = 1024;

/* Looked at in one update, so that a reader that floods us with them does not stop the stream. */
enum { SUBSCRIPTIONS_AT_ONCE = 256 };

/* A socket and who is connected to it. */
struct channel {
	void *socket;
	void *monitor;
	uint32_t connections;
};

struct gz_publisher {
	const struct gz_log *log;
	struct channel stream;
	struct channel latest;
	uint32_t subscriptions;
	uint32_t pupil_subscriptions; /* those of them that take pupil messages */
	int port;
	int latest_port;
};

static enum gz_result bind_endpoint(struct gz_publisher *publisher, void *socket,
				    const char *endpoint)
{
	if (zmq_bind(socket, endpoint) == 0)
		return GZ_OK;
	gz_err(publisher->log,
	       "cannot bind %s: %s; choose another GAZECAST_RUNTIME_DIR, or --tcp off", endpoint,
	       zmq_strerror(errno));
	return errno == EADDRINUSE ? GZ_ERR_BUSY : GZ_ERR_IO;
}

static enum gz_result bind_channel(struct gz_publisher *publisher, struct channel *channel,
				   const char *directory, const char *name, bool tcp)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	enum gz_result result = gz_endpoint_ipc(directory, name, endpoint, sizeof endpoint);
	if (result != GZ_OK) {
		gz_err(publisher->log,
		       "%s is too long for a socket's path; set GAZECAST_RUNTIME_DIR", directory);
		return result;
	}
	result = bind_endpoint(publisher, channel->socket, endpoint);
	if (result == GZ_OK && tcp)
		result = bind_endpoint(publisher, channel->socket, "tcp://127.0.0.1:*");
	return result;
}

static void set_int(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

/* A monitor tells of connections; it must listen before the socket is bound. */
static enum gz_result open_channel(void *context, struct channel *channel, int type,
				   const char *monitor_endpoint)
{
	channel->socket = zmq_socket(context, type);
	channel->monitor = zmq_socket(context, ZMQ_PAIR);
	if (!channel->socket || !channel->monitor)
		return GZ_ERR_NO_MEM;
	set_int(channel->socket, ZMQ_LINGER, GZ_STREAM_LINGER_MS);
	zmq_setsockopt(channel->socket, ZMQ_MAXMSGSIZE, &SUBSCRIPTION_SIZE_MAX,
		       sizeof SUBSCRIPTION_SIZE_MAX);
	set_int(channel->monitor, ZMQ_LINGER, 0);
	/* At a limit libzmq would block its I/O thread, and with it every reader. */
	set_int(channel->monitor, ZMQ_RCVHWM, 0);
	if (zmq_socket_monitor(channel->socket, monitor_endpoint,
			       ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED) != 0 ||
	    zmq_connect(channel->monitor, monitor_endpoint) != 0)
		return GZ_ERR_IO;
	return GZ_OK;
}

static int port_of(void *socket)
{
	char endpoint[GZ_ENDPOINT_SIZE] = "";
	size_t size = sizeof endpoint;
	if (zmq_getsockopt(socket, ZMQ_LAST_ENDPOINT, endpoint, &size) != 0)
		return 0;
	const char *colon = strrchr(endpoint, ':');
	return strncmp(endpoint, "tcp:", 4) == 0 && colon ? atoi(colon + 1) : 0;
}

static enum gz_result open_both(struct gz_publisher *publisher, void *context,
				const char *directory, bool tcp)
{
	struct channel *stream = &publisher->stream, *latest = &publisher->latest;
	enum gz_result result = open_channel(context, stream, ZMQ_XPUB, "inproc://monitor-stream");
	if (result == GZ_OK)
		result = open_channel(context, latest, ZMQ_PUB, "inproc://monitor-latest");
	if (result != GZ_OK) {
		gz_err(publisher->log, "no socket: %s", zmq_strerror(errno));
		return result;
	}
	set_int(stream->socket, ZMQ_SNDHWM, GZ_STREAM_QUEUE);
	set_int(stream->socket, ZMQ_XPUB_VERBOSER, 1);
	set_int(latest->socket, ZMQ_CONFLATE, 1);
	result = bind_channel(publisher, stream, directory, "stream", tcp);
	if (result == GZ_OK)
		result = bind_channel(publisher, latest, directory, "latest", tcp);
	publisher->port = tcp ? port_of(stream->socket) : 0;
	publisher->latest_port = tcp ? port_of(latest->socket) : 0;
	return result;
}

enum gz_result gz_publisher_create(void *context, const char *directory, bool tcp,
				   const struct gz_log *log, struct gz_publisher **out_publisher)
{
	struct gz_publisher *publisher = calloc(1, sizeof *publisher);
	if (!publisher)
		return GZ_ERR_NO_MEM;
	publisher->log = log;
	enum gz_result result = open_both(publisher, context, directory, tcp);
	if (result != GZ_OK) {
		gz_publisher_destroy(&publisher);
		return result;
	}
	*out_publisher = publisher;
	return GZ_OK;
}

int gz_publisher_port(const struct gz_publisher *publisher)
{
	return publisher->port;
}

int gz_publisher_latest_port(const struct gz_publisher *publisher)
{
	return publisher->latest_port;
}

void gz_publisher_send_one(struct gz_publisher *publisher, const char *topic, const void *bytes,
			   size_t size)
{
	/* A publishing socket never answers "again": it drops for the reader that is too slow. */
	zmq_send(publisher->stream.socket, topic, strlen(topic), ZMQ_SNDMORE | ZMQ_DONTWAIT);
	zmq_send(publisher->stream.socket, bytes, size, ZMQ_DONTWAIT);
}

/* Pupil's "pupil." messages: parts of the gaze message, sent on their own to who asks for them. */
static void send_pupils(struct gz_publisher *publisher, const struct gz_wire_message *gaze)
{
	static const char *const topics[GZ_EYE_COUNT] = {
		[GZ_EYE_RIGHT] = GZ_TOPIC_PUPIL_RIGHT,
		[GZ_EYE_LEFT] = GZ_TOPIC_PUPIL_LEFT,
	};
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (gaze->pupil[i].size > 0)
			gz_publisher_send_one(publisher, topics[i], gaze->bytes + gaze->pupil[i].at,
					      gaze->pupil[i].size);
	}
}

void gz_publisher_send(struct gz_publisher *publisher, const struct gz_outgoing_batch *batch)
{
	/* Sending to nobody costs system calls, too. Who has just come is seen at the next update;
	 * of a connection and its subscription either may be seen first. */
	bool listened = publisher->stream.connections > 0 || publisher->subscriptions > 0;
	for (size_t i = 0; listened && i < batch->count; i++) {
		const struct gz_outgoing *item = &batch->item[i];
		gz_publisher_send_one(publisher, item->topic, item->body.bytes, item->body.size);
	}
	const struct gz_wire_message *gaze = &batch->item[0].body;
	if (publisher->pupil_subscriptions > 0)
		send_pupils(publisher, gaze);
	if (publisher->latest.connections > 0)
		zmq_send(publisher->latest.socket, gaze->bytes, gaze->size, ZMQ_DONTWAIT);
}

/* A monitor's event: a frame of u16 event and u32 value, in the host's order, and one of the
 * address (zmq_socket_monitor(3)). */
static void update_connections(struct channel *channel)
{
	int events;
	size_t size = sizeof events;
	/* A socket takes note of new connections when it is used: here, where nothing is sent. */
	zmq_getsockopt(channel->socket, ZMQ_EVENTS, &events, &size);
	unsigned char frame[6];
	char address[GZ_ENDPOINT_SIZE];
	while (zmq_recv(channel->monitor, frame, sizeof frame, ZMQ_DONTWAIT) == sizeof frame) {
		uint16_t event;
		memcpy(&event, frame, sizeof event);
		zmq_recv(channel->monitor, address, sizeof address, ZMQ_DONTWAIT);
		if (event == ZMQ_EVENT_ACCEPTED)
			channel->connections++;
		else if (event == ZMQ_EVENT_DISCONNECTED && channel->connections > 0)
			channel->connections--;
	}
}

static bool takes_pupils(const unsigned char *topic, size_t size)
{
	return (size < sizeof GZ_TOPIC_PUPIL_RIGHT &&
		memcmp(topic, GZ_TOPIC_PUPIL_RIGHT, size) == 0) ||
	       (size < sizeof GZ_TOPIC_PUPIL_LEFT && memcmp(topic, GZ_TOPIC_PUPIL_LEFT, size) == 0);
}

static void count(uint32_t *counter, bool more)
{
	if (more)
		++*counter;
	else if (*counter > 0)
		--*counter;
}

/* A subscription's frame is 1 and the topic, the end of one 0 and the topic. */
static void update_subscriptions(struct gz_publisher *publisher)
{
	unsigned char frame[1 + sizeof GZ_TOPIC_PUPIL_RIGHT];
	for (int i = 0; i < SUBSCRIPTIONS_AT_ONCE; i++) {
		int size = zmq_recv(publisher->stream.socket, frame, sizeof frame, ZMQ_DONTWAIT);
		if (size < 0)
			return;
		if (size == 0 || frame[0] > 1)
			continue;
		count(&publisher->subscriptions, frame[0] == 1);
		if (takes_pupils(frame + 1, (size_t)size - 1))
			count(&publisher->pupil_subscriptions, frame[0] == 1);
	}
}

void gz_publisher_update(struct gz_publisher *publisher)
{
	update_connections(&publisher->stream);
	update_connections(&publisher->latest);
	update_subscriptions(publisher);
}

uint32_t gz_publisher_subscribers(const struct gz_publisher *publisher)
{
	return publisher->stream.connections + publisher->latest.connections;
}

uint32_t gz_publisher_subscriptions(const struct gz_publisher *publisher)
{
	return publisher->subscriptions;
}

static void close_channel(struct channel *channel)
{
	if (channel->socket) {
		zmq_socket_monitor(channel->socket, NULL, 0);
		zmq_close(channel->socket);
	}
	if (channel->monitor)
		zmq_close(channel->monitor);
}

void gz_publisher_destroy(struct gz_publisher **publisher)
{
	if (!publisher || !*publisher)
		return;
	close_channel(&(*publisher)->stream);
	close_channel(&(*publisher)->latest);
	free(*publisher);
	*publisher = NULL;
}
