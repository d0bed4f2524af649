#include "client/stream.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "client/connection.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "client"

struct gz_stream {
	struct gz_subscriber subscriber;
	zmq_msg_t payload;   /* of the last message read */
	bool counts_gaps;    /* every gaze topic is subscribed to */
	bool has_seq;        /* last_seq is set */
	uint64_t last_seq;   /* of the last gaze message */
	uint64_t seq_origin; /* gz_subscriber_origin() when it came */
	int64_t events_ns;   /* when the connection's events are looked at next */
	struct gz_stream_counters counters;
	struct gz_ratelimit malformed_limit;
};

/* The beginning of every gaze topic. */
#define GAZE_TOPICS_COMMON "gaze.3d."

static bool covers_gaze(const char *const *topics)
{
	if (!topics)
		return true;
	for (; *topics; topics++)
		if (strncmp(GAZE_TOPICS_COMMON, *topics, strlen(*topics)) == 0)
			return true;
	return false;
}

static enum gz_result create_stream(const struct gz_subscriber_params *params,
				    const struct gz_log *log, struct gz_stream **out_stream)
{
	struct gz_stream *stream = calloc(1, sizeof *stream);
	if (!stream)
		return GZ_ERR_NO_MEM;
	zmq_msg_init(&stream->payload);
	stream->counts_gaps = covers_gaze(params->topics);
	enum gz_result result = gz_subscriber_open(&stream->subscriber, params, log);
	if (result != GZ_OK) {
		gz_stream_close(&stream);
		return result;
	}
	*out_stream = stream;
	return GZ_OK;
}

enum gz_result gz_stream_open(const char *endpoint, const char *const *topics,
			      const struct gz_log *log, struct gz_stream **out_stream)
{
	const struct gz_subscriber_params params = {
		.endpoint = endpoint,
		.channel = "stream",
		.topics = topics && topics[0] ? topics : NULL,
		.find_keys = true,
	};
	return create_stream(&params, log, out_stream);
}

enum gz_result gz_stream_open_with_keys(const char *endpoint, const char *const *topics,
					const struct gz_keys *keys, const struct gz_log *log,
					struct gz_stream **out_stream)
{
	const struct gz_subscriber_params params = {
		.endpoint = endpoint,
		.channel = "stream",
		.topics = topics && topics[0] ? topics : NULL,
		.keys = keys,
	};
	return create_stream(&params, log, out_stream);
}

/* Receive one frame. @param[out] out_more  whether further frames of its message follow
 * @return whether there was one */
static bool receive_frame(struct gz_stream *stream, zmq_msg_t *frame, bool *out_more)
{
	if (zmq_msg_recv(frame, stream->subscriber.socket, ZMQ_DONTWAIT) < 0)
		return false;
	*out_more = zmq_msg_more(frame);
	return true;
}

/* Receive one message. @param[out] out_frames  its number of frames @return whether there was one
 */
static bool receive_frames(struct gz_stream *stream, zmq_msg_t *topic, int *out_frames)
{
	bool more = false;
	if (!receive_frame(stream, topic, &more))
		return false;
	int frames = 1;
	while (more && receive_frame(stream, &stream->payload, &more))
		frames++;
	*out_frames = frames;
	return true;
}

static enum gz_message_kind message_kind(const char *topic)
{
	if (strncmp(topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0)
		return GZ_MESSAGE_GAZE;
	if (strcmp(topic, GZ_TOPIC_FIXATIONS) == 0)
		return GZ_MESSAGE_FIXATION;
	if (strcmp(topic, GZ_TOPIC_BLINKS) == 0)
		return GZ_MESSAGE_BLINK;
	if (strcmp(topic, GZ_TOPIC_SACCADES) == 0)
		return GZ_MESSAGE_SACCADE;
	if (strcmp(topic, GZ_TOPIC_STATUS) == 0)
		return GZ_MESSAGE_STATUS;
	return GZ_MESSAGE_OTHER;
}

static enum gz_result decode_payload(struct gz_message *message)
{
	switch (message->kind) {
	case GZ_MESSAGE_GAZE:
		return gz_wire_decode_gaze(message->bytes, message->size, &message->gaze);
	case GZ_MESSAGE_FIXATION:
		return gz_wire_decode_fixation(message->bytes, message->size, &message->fixation);
	case GZ_MESSAGE_BLINK:
		return gz_wire_decode_blink(message->bytes, message->size, &message->blink);
	case GZ_MESSAGE_SACCADE:
		return gz_wire_decode_saccade(message->bytes, message->size, &message->saccade);
	case GZ_MESSAGE_STATUS:
		return gz_wire_decode_status(message->bytes, message->size, &message->status);
	case GZ_MESSAGE_OTHER:
		return gz_wire_check(message->bytes, message->size);
	}
	return GZ_ERR_PROTOCOL;
}

/* A message as it came, from the socket or from the board. */
struct raw_message {
	const void *topic;
	size_t topic_size;
	const void *body;
	size_t body_size;
};

/* Copy the topic; it must be short and without a NUL. */
static enum gz_result decode_topic(const struct raw_message *raw, struct gz_message *message)
{
	if (raw->topic_size >= sizeof message->topic || memchr(raw->topic, '\0', raw->topic_size))
		return GZ_ERR_PROTOCOL;
	memcpy(message->topic, raw->topic, raw->topic_size);
	message->topic[raw->topic_size] = '\0';
	return GZ_OK;
}

static enum gz_result decode_message(const struct raw_message *raw, struct gz_message *message)
{
	memset(message, 0, sizeof *message);
	if (decode_topic(raw, message) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	message->kind = message_kind(message->topic);
	message->bytes = raw->body;
	message->size = raw->body_size;
	message->received_ns = gz_clock_now_ns();
	return decode_payload(message);
}

/* Count the gaze messages missed before number @p seq. Messages sent while there was no connection
 * do not count: the daemon may be another one, with its own numbers. */
static uint64_t count_gap(struct gz_stream *stream, uint64_t seq)
{
	/* What is read from a board does not depend on events, and must stay valid. */
	if (gz_board_link_reads_socket(&stream->subscriber.board))
		gz_subscriber_take_events(&stream->subscriber);
	uint64_t origin = gz_subscriber_origin(&stream->subscriber);
	bool comparable = stream->counts_gaps && stream->has_seq && stream->seq_origin == origin;
	uint64_t lost = comparable && seq > stream->last_seq ? seq - stream->last_seq - 1 : 0;
	stream->has_seq = true;
	stream->last_seq = seq;
	stream->seq_origin = origin;
	stream->counters.lost += lost;
	return lost;
}

static void count_malformed_message(struct gz_stream *stream)
{
	uint64_t dropped;
	stream->counters.malformed++;
	if (gz_ratelimit_pass(&stream->malformed_limit, gz_clock_now_ns(), GZ_NS_PER_S, &dropped))
		gz_warn(stream->subscriber.log,
			"%s: a malformed message was dropped (%llu so far); is this a stream?",
			stream->subscriber.endpoint,
			(unsigned long long)stream->counters.malformed);
}

/* Receive a message from the socket into @p message, as receive_stream_message(). */
static enum gz_result receive_from_socket(struct gz_stream *stream, struct gz_message *message)
{
	zmq_msg_t topic;
	int frames;
	zmq_msg_init(&topic);
	enum gz_result result = GZ_ERR_TIMEOUT;
	if (receive_frames(stream, &topic, &frames)) {
		const struct raw_message raw = {
			.topic = zmq_msg_data(&topic),
			.topic_size = zmq_msg_size(&topic),
			.body = zmq_msg_data(&stream->payload),
			.body_size = zmq_msg_size(&stream->payload),
		};
		result = frames == 2 ? decode_message(&raw, message) : GZ_ERR_PROTOCOL;
	}
	zmq_msg_close(&topic);
	return result;
}

/* Receive a message that is subscribed to from the board, as receive_stream_message(). */
static enum gz_result receive_from_board(struct gz_stream *stream, struct gz_board_reader *reader,
					 struct gz_message *message)
{
	struct gz_board_link *board = &stream->subscriber.board;
	struct gz_board_record record;
	enum gz_result result;
	do
		result = gz_board_next(reader, &record);
	while (result == GZ_OK && !gz_board_link_wants(board, record.topic, record.topic_size));
	if (result == GZ_ERR_PROTOCOL)
		gz_board_link_give_up(board);
	if (result != GZ_OK)
		return result;
	const struct raw_message raw = { record.topic, record.topic_size, record.body,
					 record.body_size };
	return decode_message(&raw, message);
}

/* Receive a message without waiting. @retval GZ_ERR_PROTOCOL  it was malformed
 * @retval GZ_ERR_TIMEOUT  there is none */
static enum gz_result receive_stream_message(struct gz_stream *stream,
					     struct gz_message *out_message)
{
	struct gz_board_link *board = &stream->subscriber.board;
	struct gz_board_reader *reader = gz_board_link_reader(board);
	enum gz_result result = GZ_ERR_TIMEOUT;
	struct gz_message message;
	if (reader)
		result = receive_from_board(stream, reader, &message);
	else if (gz_board_link_reads_socket(board))
		result = receive_from_socket(stream, &message);
	if (result == GZ_ERR_PROTOCOL)
		count_malformed_message(stream);
	if (result != GZ_OK)
		return result;
	stream->counters.received++;
	if (message.kind == GZ_MESSAGE_GAZE)
		message.lost = count_gap(stream, message.gaze.seq);
	*out_message = message;
	return GZ_OK;
}

/* Wait at the socket, or for the daemon. @return false after a signal, which may ask the program to
 * end */
static bool wait_at_socket(struct gz_stream *stream, long timeout_ms)
{
	struct gz_subscriber *subscriber = &stream->subscriber;
	zmq_pollitem_t items[3] = { { .socket = subscriber->monitor, .events = ZMQ_POLLIN } };
	int count = 1;
	if (gz_board_link_reads_socket(&subscriber->board))
		items[count++] =
			(zmq_pollitem_t) { .socket = subscriber->socket, .events = ZMQ_POLLIN };
	if (gz_board_link_fd(&subscriber->board) >= 0) {
		items[count++] = (zmq_pollitem_t) { .fd = gz_board_link_fd(&subscriber->board),
						    .events = ZMQ_POLLIN };
		if (timeout_ms > GZ_BOARD_ANSWER_MS)
			timeout_ms = GZ_BOARD_ANSWER_MS;
	}
	if (zmq_poll(items, count, timeout_ms) < 0)
		return false;
	gz_subscriber_take_events(subscriber);
	return true;
}

/* How often the connection's events are looked at while the board is read, ms; they do not end the
 * wait. Chosen: an ended daemon is noticed soon, at ten wake-ups a second while no message comes.
 */
enum { BOARD_EVENTS_MS = 100 };

/* As wait_at_socket(). */
static bool wait_at_board(struct gz_stream *stream, struct gz_board_reader *reader, long timeout_ms)
{
	if (timeout_ms > BOARD_EVENTS_MS)
		timeout_ms = BOARD_EVENTS_MS;
	if (gz_board_wait(reader, timeout_ms * GZ_NS_PER_MS) == GZ_ERR_IO)
		return false;
	int64_t now_ns = gz_clock_now_ns();
	if (now_ns >= stream->events_ns) {
		stream->events_ns = now_ns + BOARD_EVENTS_MS * GZ_NS_PER_MS;
		gz_subscriber_take_events(&stream->subscriber);
	}
	return true;
}

/* Wait until something can be read, at most until @p deadline_ns. @return whether to try again */
static bool wait_for_message(struct gz_stream *stream, int64_t deadline_ns)
{
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns <= 0)
		return false;
	long timeout_ms = (long)((left_ns + GZ_NS_PER_MS - 1) / GZ_NS_PER_MS);
	if (timeout_ms > GZ_SUBSCRIBER_EVENTS_MS)
		timeout_ms = GZ_SUBSCRIBER_EVENTS_MS;
	struct gz_board_link *board = &stream->subscriber.board;
	struct gz_board_reader *reader = gz_board_link_reader(board);
	/* While the daemon is away, only its return is waited for. */
	return reader && board->source == GZ_BOARD_SOURCE_BOARD
		       ? wait_at_board(stream, reader, timeout_ms)
		       : wait_at_socket(stream, timeout_ms);
}

enum gz_result gz_stream_read(struct gz_stream *stream, int timeout_ms,
			      struct gz_message *out_message)
{
	if (timeout_ms < 0)
		return GZ_ERR_INVAL;
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	do {
		/* A flood of malformed messages must not delay the caller beyond the deadline. */
		enum gz_result result = receive_stream_message(stream, out_message);
		if (result == GZ_OK)
			return GZ_OK;
		if (result == GZ_ERR_PROTOCOL && gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	} while (wait_for_message(stream, deadline_ns));
	return GZ_ERR_TIMEOUT;
}

void gz_stream_get_counters(struct gz_stream *stream, struct gz_stream_counters *out_counters)
{
	gz_subscriber_take_events(&stream->subscriber);
	stream->counters.connected = stream->subscriber.connected;
	stream->counters.connections = stream->subscriber.connections;
	*out_counters = stream->counters;
}

const char *gz_stream_endpoint(const struct gz_stream *stream)
{
	return stream->subscriber.endpoint;
}

void gz_stream_close(struct gz_stream **stream)
{
	if (!*stream)
		return;
	zmq_msg_close(&(*stream)->payload);
	gz_subscriber_close(&(*stream)->subscriber);
	free(*stream);
	*stream = NULL;
}
