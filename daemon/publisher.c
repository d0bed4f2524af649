#include "daemon/publisher.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#define GZ_LOG_MODULE "publisher"

/* Readers send subscriptions alone: a topic's length, and some. */
static const int64_t SUBSCRIPTION_SIZE_MAX = 1024;

/* Looked at in one update, so that a reader that floods us with them does not stop the stream.
 * Chosen: more than one can send meanwhile, because libzmq keeps the others; it takes a
 * millisecond.
 */
enum { SUBSCRIPTIONS_AT_ONCE = 8192 };

/* A socket and who is connected to it. */
struct channel {
	void *socket;
	const struct gz_connections *connections;
};

struct gz_publisher {
	struct channel stream;
	struct channel latest;
	uint32_t subscriptions;
	uint64_t arrivals;
	uint32_t pupil_subscriptions; /* those of them that take pupil messages */
	int port;
	int latest_port;
};

static void set_int(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

static enum gz_result open_channel(const struct gz_network *network, struct channel *channel,
				   int type)
{
	channel->socket = zmq_socket(network->context, type);
	if (!channel->socket) {
		gz_err(network->log, "no socket: %s", zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	set_int(channel->socket, ZMQ_LINGER, GZ_STREAM_LINGER_MS);
	zmq_setsockopt(channel->socket, ZMQ_MAXMSGSIZE, &SUBSCRIPTION_SIZE_MAX,
		       sizeof SUBSCRIPTION_SIZE_MAX);
	return GZ_OK;
}

static enum gz_result bind_channel(const struct gz_network *network, struct channel *channel,
				   const char *name, int wanted_port, int *out_port)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	gz_network_endpoint(network, wanted_port, endpoint);
	return gz_network_bind(network, channel->socket, name, endpoint, out_port,
			       &channel->connections);
}

static enum gz_result open_both(struct gz_publisher *publisher, const struct gz_network *network)
{
	struct channel *stream = &publisher->stream, *latest = &publisher->latest;
	const struct gz_config *config = network->config;
	enum gz_result result = open_channel(network, stream, ZMQ_XPUB);
	if (result == GZ_OK)
		result = open_channel(network, latest, ZMQ_PUB);
	if (result != GZ_OK)
		return result;
	set_int(stream->socket, ZMQ_SNDHWM, GZ_STREAM_QUEUE);
	set_int(stream->socket, ZMQ_XPUB_VERBOSER, 1);
	set_int(latest->socket, ZMQ_CONFLATE, 1);
	result = bind_channel(network, stream, "stream", config->stream_port, &publisher->port);
	if (result == GZ_OK)
		result = bind_channel(network, latest, "latest", config->latest_port,
				      &publisher->latest_port);
	return result;
}

enum gz_result gz_publisher_create(const struct gz_network *network,
				   struct gz_publisher **out_publisher)
{
	struct gz_publisher *publisher = calloc(1, sizeof *publisher);
	if (!publisher)
		return GZ_ERR_NO_MEM;
	enum gz_result result = open_both(publisher, network);
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
	bool listened = gz_connections_count(publisher->stream.connections) > 0 ||
			publisher->subscriptions > 0;
	for (size_t i = 0; listened && i < batch->count; i++) {
		const struct gz_outgoing *item = &batch->item[i];
		gz_publisher_send_one(publisher, item->topic, item->body.bytes, item->body.size);
	}
	const struct gz_wire_message *gaze = &batch->item[0].body;
	if (publisher->pupil_subscriptions > 0)
		send_pupils(publisher, gaze);
	if (gz_connections_count(publisher->latest.connections) > 0)
		zmq_send(publisher->latest.socket, gaze->bytes, gaze->size, ZMQ_DONTWAIT);
}

/* A socket takes note of new connections when it is used: here, where nothing may be sent. */
static void notice_connections(void *socket)
{
	int events;
	size_t size = sizeof events;
	zmq_getsockopt(socket, ZMQ_EVENTS, &events, &size);
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
		publisher->arrivals += frame[0] == 1;
		if (takes_pupils(frame + 1, (size_t)size - 1))
			count(&publisher->pupil_subscriptions, frame[0] == 1);
	}
}

void gz_publisher_update(struct gz_publisher *publisher)
{
	notice_connections(publisher->stream.socket);
	notice_connections(publisher->latest.socket);
	update_subscriptions(publisher);
}

uint32_t gz_publisher_subscribers(const struct gz_publisher *publisher)
{
	return gz_connections_count(publisher->stream.connections) +
	       gz_connections_count(publisher->latest.connections);
}

uint32_t gz_publisher_subscriptions(const struct gz_publisher *publisher)
{
	return publisher->subscriptions;
}

uint64_t gz_publisher_arrivals(const struct gz_publisher *publisher)
{
	return publisher->arrivals;
}

static void close_channel(struct channel *channel)
{
	if (channel->socket) {
		zmq_socket_monitor(channel->socket, NULL, 0);
		zmq_close(channel->socket);
	}
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
