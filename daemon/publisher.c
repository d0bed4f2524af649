#include "daemon/publisher.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "daemon/board_server.h"
#include "daemon/quota.h"
#include "daemon/readers.h"

#define GZ_LOG_MODULE "publisher"

void gz_message_maker_init(struct gz_message_maker *maker, const struct gz_config *config,
			   const struct gz_pipeline_params *params,
			   const struct gz_display *display)
{
	gz_pipeline_init(&maker->pipeline, params, display);
	maker->surface_count = config->surface_count;
	memcpy(maker->surface, config->surface, sizeof maker->surface);
	maker->without_surfaces = false;
}

void gz_message_maker_reset(struct gz_message_maker *maker)
{
	struct gz_pipeline_params params = maker->pipeline.params;
	struct gz_display display = maker->pipeline.display;
	gz_pipeline_init(&maker->pipeline, &params, &display);
}

/* Append a message with topic @p topic and @p name. @return its body, to be filled.
 * GZ_MESSAGES_MAX is enough for every step. */
static struct gz_wire_message *append_message(struct gz_outgoing_batch *batch, const char *topic,
					      const char *name)
{
	struct gz_outgoing *item = &batch->item[batch->count++];
	size_t topic_length = strlen(topic);
	size_t name_length = strlen(name);
	memcpy(item->topic, topic, topic_length);
	memcpy(item->topic + topic_length, name, name_length + 1);
	return &item->body;
}

_Static_assert(sizeof GZ_TOPIC_SURFACES - 1 + GZ_NAME_SIZE <= GZ_TOPIC_SIZE,
	       "GZ_TOPIC_SIZE is enough for every surface");

void gz_message_maker_step(struct gz_message_maker *maker, const struct gz_sample *sample,
			   int64_t publish_ns, struct gz_outgoing_batch *out)
{
	struct gz_pipeline_output *step = &out->step;
	gz_pipeline_step(&maker->pipeline, sample, step);
	step->gaze.publish_ns = publish_ns;
	out->count = 0;
	gz_wire_encode_gaze(&step->gaze, &maker->pipeline.display,
			    append_message(out, gz_wire_gaze_topic(&step->gaze), ""));
	for (size_t i = 0; i < step->fixation_count; i++)
		gz_wire_encode_fixation(&step->fixations[i],
					append_message(out, GZ_TOPIC_FIXATIONS, ""));
	/* After the messages to which they refer. */
	size_t surfaces = maker->without_surfaces ? 0 : maker->surface_count;
	for (size_t i = 0; i < surfaces; i++)
		gz_wire_encode_surface(&step->gaze, step->fixations, step->fixation_count,
				       maker->surface[i],
				       append_message(out, GZ_TOPIC_SURFACES, maker->surface[i]));
	for (size_t i = 0; i < step->blink_count; i++)
		gz_wire_encode_blink(&step->blinks[i], append_message(out, GZ_TOPIC_BLINKS, ""));
	for (size_t i = 0; i < step->saccade_count; i++)
		gz_wire_encode_saccade(&step->saccades[i],
				       append_message(out, GZ_TOPIC_SACCADES, ""));
}

bool gz_message_maker_flush(struct gz_message_maker *maker, struct gz_outgoing *out)
{
	struct gz_gaze gaze;
	if (!gz_pipeline_flush(&maker->pipeline, &gaze))
		return false;
	snprintf(out->topic, sizeof out->topic, "%s", GZ_TOPIC_EVENT_FINAL);
	return gz_wire_encode_event_final(&gaze, &out->body) == GZ_OK;
}

/* Longest message accepted from a reader, bytes. Readers send subscriptions only. Chosen: longer
 * than any topic. */
static const int64_t SUBSCRIPTION_SIZE_MAX = 1024;

/* Most subscriptions read in one update, so that a reader that floods us with them does not stop
 * the stream. Chosen: more than one reader can send between two updates, because libzmq queues the
 * rest; reading them takes a millisecond. */
enum { SUBSCRIPTIONS_AT_ONCE = 8192 };

/* Subscriptions that libzmq reads from one connection before the publisher looks at them. Chosen:
 * as many as one reader may have. */
enum { SUBSCRIPTION_QUEUE = GZ_READER_SUBSCRIPTIONS };

/* A message about a reader with too many subscriptions is logged once a minute. */
#define REFUSAL_NS (60 * GZ_NS_PER_S)

/* A socket and its connections. */
struct channel {
	void *socket;
	const struct gz_connections *connections;
};

struct gz_publisher {
	struct channel stream;
	struct channel latest;
	struct gz_board_server *board_server; /* NULL: the system offers none */
	struct gz_board *board;               /* the server's */
	const struct gz_log *log;
	struct gz_readers *readers;
	struct gz_readers_sums sums; /* at the last update */
	uint32_t settled;            /* connections to the stream at the last update */
	int64_t now_ns;              /* of what is being sent, host time */
	uint64_t arrivals;
	uint64_t refused; /* readers with too many subscriptions */
	struct gz_ratelimit complaints;
	int port;
	int latest_port;
};

static void set_channel_option(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

static enum gz_result open_channel(const struct gz_network *network, struct channel *channel,
				   int type)
{
	channel->socket = zmq_socket(network->context, type);
	if (!channel->socket) {
		gz_err(network->log, "cannot open a publishing socket: %s", zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	set_channel_option(channel->socket, ZMQ_LINGER, GZ_STREAM_LINGER_MS);
	set_channel_option(channel->socket, ZMQ_RCVHWM, SUBSCRIPTION_QUEUE);
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

static enum gz_result open_channels(struct gz_publisher *publisher,
				    const struct gz_network *network)
{
	struct channel *stream = &publisher->stream, *latest = &publisher->latest;
	const struct gz_config *config = network->config;
	enum gz_result result = open_channel(network, stream, ZMQ_XPUB);
	if (result == GZ_OK)
		result = open_channel(network, latest, ZMQ_PUB);
	if (result != GZ_OK)
		return result;
	set_channel_option(stream->socket, ZMQ_SNDHWM, GZ_STREAM_QUEUE);
	set_channel_option(stream->socket, ZMQ_XPUB_VERBOSER, 1);
	set_channel_option(latest->socket, ZMQ_CONFLATE, 1);
	result = bind_channel(network, stream, "stream", config->stream_port, &publisher->port);
	if (result == GZ_OK)
		result = bind_channel(network, latest, "latest", config->latest_port,
				      &publisher->latest_port);
	return result;
}

/* Readers do without the board where there is none. */
static void open_board(struct gz_publisher *publisher, const struct gz_network *network)
{
	enum gz_result result = gz_board_server_create(network->directory, network->handed,
						       &publisher->board_server);
	if (result == GZ_OK)
		publisher->board = gz_board_server_board(publisher->board_server);
	else
		gz_info(publisher->log, "no stream in shared memory: %s", gz_result_text(result));
}

enum gz_result gz_publisher_create(const struct gz_network *network,
				   struct gz_publisher **out_publisher)
{
	struct gz_publisher *publisher = calloc(1, sizeof *publisher);
	if (!publisher)
		return GZ_ERR_NO_MEM;
	publisher->log = network->log;
	enum gz_result result = gz_readers_create(GZ_QUOTA_DESCRIPTORS, &publisher->readers);
	if (result == GZ_OK)
		result = open_channels(publisher, network);
	if (result != GZ_OK) {
		gz_publisher_destroy(&publisher);
		return result;
	}
	open_board(publisher, network);
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

/* A subscription is seen at the next update, after its connection; until then a connection counts
 * as a reader of either kind. */
static uint32_t connected_readers(const struct gz_publisher *publisher)
{
	return gz_connections_count(publisher->stream.connections);
}

/* Whether the stream has readers that do not read the board. Without them, system calls are saved.
 */
static bool has_remote_readers(const struct gz_publisher *publisher)
{
	return connected_readers(publisher) > publisher->sums.boards || publisher->sums.remote > 0;
}

/* Whether readers have come that may not have been asked yet what they want. */
static bool has_new_readers(const struct gz_publisher *publisher)
{
	return connected_readers(publisher) != publisher->settled;
}

/* Whether readers may be waiting at the board. */
static bool has_board_readers(const struct gz_publisher *publisher)
{
	return publisher->sums.boards > 0 || has_new_readers(publisher);
}

static void write_board(struct gz_publisher *publisher, const char *topic, const void *bytes,
			size_t size)
{
	const struct gz_board_message message = {
		.topic = topic,
		.topic_size = strlen(topic),
		.body = bytes,
		.body_size = size,
		.time_ns = publisher->now_ns,
		.is_gaze = strncmp(topic, GZ_TOPIC_GAZE, sizeof GZ_TOPIC_GAZE - 1) == 0,
	};
	if (publisher->board)
		gz_board_write(publisher->board, &message);
}

static void show_board(struct gz_publisher *publisher)
{
	if (publisher->board)
		gz_board_show(publisher->board, has_board_readers(publisher));
}

static void send_remote(struct gz_publisher *publisher, const char *topic, const void *bytes,
			size_t size)
{
	/* A publishing socket never returns EAGAIN: it drops messages for slow readers. */
	zmq_send(publisher->stream.socket, topic, strlen(topic), ZMQ_SNDMORE | ZMQ_DONTWAIT);
	zmq_send(publisher->stream.socket, bytes, size, ZMQ_DONTWAIT);
}

void gz_publisher_send_one(struct gz_publisher *publisher, const char *topic, const void *bytes,
			   size_t size)
{
	publisher->now_ns = gz_clock_now_ns();
	write_board(publisher, topic, bytes, size);
	show_board(publisher);
	send_remote(publisher, topic, bytes, size);
}

/* How a message is sent: write_board() or send_remote(). */
typedef void send_way(struct gz_publisher *publisher, const char *topic, const void *bytes,
		      size_t size);

/* Send Pupil's "pupil." messages, which are parts of the gaze message. */
static void send_pupils(struct gz_publisher *publisher, const struct gz_wire_message *gaze,
			send_way *send)
{
	static const char *const topics[GZ_EYE_COUNT] = {
		[GZ_EYE_RIGHT] = GZ_TOPIC_PUPIL_RIGHT,
		[GZ_EYE_LEFT] = GZ_TOPIC_PUPIL_LEFT,
	};
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		if (gaze->pupil[i].size > 0)
			send(publisher, topics[i], gaze->bytes + gaze->pupil[i].at,
			     gaze->pupil[i].size);
	}
}

static void send_batch(struct gz_publisher *publisher, const struct gz_outgoing_batch *batch,
		       send_way *send)
{
	for (size_t i = 0; i < batch->count; i++) {
		const struct gz_outgoing *item = &batch->item[i];
		send(publisher, item->topic, item->body.bytes, item->body.size);
	}
	/* They are made only for readers that subscribed to them. */
	if (publisher->sums.pupils > 0)
		send_pupils(publisher, &batch->item[0].body, send);
}

void gz_publisher_send(struct gz_publisher *publisher, const struct gz_outgoing_batch *batch)
{
	const struct gz_wire_message *gaze = &batch->item[0].body;
	publisher->now_ns = batch->step.gaze.publish_ns;
	send_batch(publisher, batch, write_board);
	show_board(publisher);
	if (has_remote_readers(publisher))
		send_batch(publisher, batch, send_remote);
	if (gz_connections_listening(publisher->latest.connections) > 0)
		zmq_send(publisher->latest.socket, gaze->bytes, gaze->size, ZMQ_DONTWAIT);
}

/* libzmq accepts new connections when a socket is used. This uses it even if nothing is sent. */
static void accept_connections(void *socket)
{
	int events;
	size_t size = sizeof events;
	zmq_getsockopt(socket, ZMQ_EVENTS, &events, &size);
}

/* libzmq disconnects no reader by itself, however much the reader subscribes to. */
static void refuse_reader(struct gz_publisher *publisher, int fd, uint64_t identity)
{
	uint64_t more;
	gz_connection_end(fd, identity);
	publisher->refused++;
	if (gz_ratelimit_pass(&publisher->complaints, gz_clock_now_ns(), REFUSAL_NS, &more))
		gz_warn(publisher->log,
			"client bug: the connection of a reader is closed, because it has more "
			"than %d subscriptions, or all readers together more than %d (%llu more "
			"since the last message)",
			GZ_READER_SUBSCRIPTIONS, GZ_READERS_SUBSCRIPTIONS,
			(unsigned long long)more);
}

/* @p frame is the byte 1 and a topic for a new subscription, 0 and the topic for its end.
 * @param fd  of the connection; -1 if libzmq reports the end of a connection
 * @return whether a connection has ended */
static bool take_subscription(struct gz_publisher *publisher, const unsigned char *frame,
			      size_t size, int fd)
{
	if (size == 0 || frame[0] > 1)
		return false;
	publisher->arrivals += frame[0] == 1;
	uint64_t identity = gz_connection_identity(fd);
	if (identity == 0)
		return true;
	if (frame[0] == 0)
		gz_readers_unsubscribe(publisher->readers, fd, identity, frame + 1, size - 1);
	else if (gz_readers_subscribe(publisher->readers, fd, identity, frame + 1, size - 1) ==
		 GZ_ERR_FULL)
		refuse_reader(publisher, fd, identity);
	return false;
}

static void update_subscriptions(struct gz_publisher *publisher)
{
	bool some_left = false;
	zmq_msg_t frame;
	zmq_msg_init(&frame);
	for (int i = 0; i < SUBSCRIPTIONS_AT_ONCE; i++) {
		if (zmq_msg_recv(&frame, publisher->stream.socket, ZMQ_DONTWAIT) < 0)
			break;
		some_left |=
			take_subscription(publisher, zmq_msg_data(&frame), zmq_msg_size(&frame),
					  zmq_msg_get(&frame, ZMQ_SRCFD));
	}
	zmq_msg_close(&frame);
	if (some_left)
		gz_readers_sweep(publisher->readers, gz_connection_identity);
	publisher->sums = gz_readers_sums(publisher->readers);
}

void gz_publisher_update(struct gz_publisher *publisher)
{
	accept_connections(publisher->stream.socket);
	accept_connections(publisher->latest.socket);
	publisher->settled = connected_readers(publisher);
	update_subscriptions(publisher);
}

bool gz_publisher_wants_surfaces(const struct gz_publisher *publisher)
{
	return publisher->sums.surfaces > 0 || has_new_readers(publisher);
}

uint32_t gz_publisher_subscribers(const struct gz_publisher *publisher)
{
	return gz_connections_count(publisher->stream.connections) +
	       gz_connections_count(publisher->latest.connections);
}

uint32_t gz_publisher_subscriptions(const struct gz_publisher *publisher)
{
	return publisher->sums.subscriptions;
}

uint64_t gz_publisher_arrivals(const struct gz_publisher *publisher)
{
	return publisher->arrivals;
}

uint64_t gz_publisher_refused(const struct gz_publisher *publisher)
{
	return publisher->refused;
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
	gz_board_server_destroy(&(*publisher)->board_server);
	gz_readers_destroy(&(*publisher)->readers);
	free(*publisher);
	*publisher = NULL;
}
