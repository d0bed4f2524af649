#include "client/connection.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "client"

/* A peer can vanish from the network without a word: a connection over TCP is closed after three
 * seconds of silence. Chosen. */
enum { HEARTBEAT_MS = 1000, HEARTBEAT_TIMEOUT_MS = 3000 };

/* Longest wait for a connection before a new attempt. Chosen: longer than any handshake takes. */
#define RETRY_NS (2 * GZ_NS_PER_S)

/* Largest message accepted, bytes; libzmq closes a connection that announces a larger one. Chosen:
 * our messages are at most 4 KiB, those of Pupil Capture a few more. */
static const int64_t message_bytes_max = 65536;

/* Messages kept until they are read; the publisher drops further ones, which the reader sees as a
 * gap. Chosen: 3.4 s of a 1200 Hz tracker, some 6 MiB. */
enum { RECEIVE_MESSAGES_MAX = 4096 };

enum gz_result gz_connection_endpoint(const char *endpoint, const char *channel,
				      const struct gz_log *log, char text[GZ_ENDPOINT_SIZE])
{
	if (endpoint) {
		int length = snprintf(text, GZ_ENDPOINT_SIZE, "%s", endpoint);
		if (length > 0 && length < GZ_ENDPOINT_SIZE)
			return GZ_OK;
		gz_err(log, "an endpoint must have 1 to %d bytes, not %d", GZ_ENDPOINT_SIZE - 1,
		       length);
		return GZ_ERR_INVAL;
	}
	enum gz_result result = gz_endpoint_find(channel, log, text, GZ_ENDPOINT_SIZE);
	if (result != GZ_ERR_FULL)
		return result;
	gz_err(log, "the path of the runtime directory is too long for a socket: set "
		    "GAZECAST_RUNTIME_DIR to a shorter one");
	return GZ_ERR_INVAL;
}

bool gz_handshake_use_keys(void *socket, const struct gz_keys *keys)
{
	return !keys || (zmq_setsockopt(socket, ZMQ_CURVE_SERVERKEY, keys->server_key,
					GZ_KEYS_TEXT_SIZE) == 0 &&
			 zmq_setsockopt(socket, ZMQ_CURVE_PUBLICKEY, keys->public_key,
					GZ_KEYS_TEXT_SIZE) == 0 &&
			 zmq_setsockopt(socket, ZMQ_CURVE_SECRETKEY, keys->secret_key,
					GZ_KEYS_TEXT_SIZE) == 0);
}

/* The monitor reports over a PAIR socket inside this process. Its queue has no limit, because a
 * full queue would block libzmq's I/O thread. Only handshakes and their ends are written to it. */
void *gz_handshake_open_monitor(void *context, void *socket, const char *endpoint, int events)
{
	char address[64];
	const int zero = 0;
	snprintf(address, sizeof address, "inproc://gazecast-monitor-%p", socket);
	if (strncmp(endpoint, "tcp:", 4) == 0)
		events |= ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
			  ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
	if (zmq_socket_monitor(socket, address, events) != 0)
		return NULL;
	void *monitor = zmq_socket(context, ZMQ_PAIR);
	if (!monitor)
		return NULL;
	if (zmq_setsockopt(monitor, ZMQ_LINGER, &zero, sizeof zero) == 0 &&
	    zmq_setsockopt(monitor, ZMQ_RCVHWM, &zero, sizeof zero) == 0 &&
	    zmq_connect(monitor, address) == 0)
		return monitor;
	zmq_close(monitor);
	return NULL;
}

struct gz_monitor_event gz_handshake_next_event(void *monitor)
{
	unsigned char frame[6]; /* 16 bits number, 32 bits value, in this machine's byte order */
	char address[1];
	uint16_t number;
	int32_t value;
	if (zmq_recv(monitor, frame, sizeof frame, ZMQ_DONTWAIT) != sizeof frame)
		return (struct gz_monitor_event) { 0 };
	zmq_recv(monitor, address, sizeof address, ZMQ_DONTWAIT); /* second frame: the endpoint */
	memcpy(&number, frame, sizeof number);
	memcpy(&value, frame + sizeof number, sizeof value);
	return (struct gz_monitor_event) { number, value };
}

enum gz_handshake_fault gz_handshake_fault_of(const struct gz_monitor_event *event, bool has_keys)
{
	switch (event->number) {
	case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
		return GZ_HANDSHAKE_REFUSED;
	case ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL:
		return GZ_HANDSHAKE_ENDED;
	case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
		if (event->value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH)
			return has_keys ? GZ_HANDSHAKE_WANTS_NO_KEYS : GZ_HANDSHAKE_WANTS_KEYS;
		return GZ_HANDSHAKE_SERVER_KEY;
	default:
		return GZ_HANDSHAKE_FINE;
	}
}

void gz_handshake_log(enum gz_handshake_fault fault, const char *endpoint,
		      const struct gz_keys *keys, const struct gz_log *log)
{
	switch (fault) {
	case GZ_HANDSHAKE_FINE:
		return;
	case GZ_HANDSHAKE_ENDED:
		if (keys)
			gz_err(log,
			       "%s closes the connection during the handshake: most likely its "
			       "server "
			       "key is not the one in known_servers here, %s, or it has none; "
			       "compare "
			       "it and correct known_servers",
			       endpoint, keys->server_key);
		else
			gz_err(log,
			       "%s closes the connection during the handshake; a gazed with tcp = "
			       "curve requires keys: run gazectl keygen --client, and put the line "
			       "that gazectl keygen --server printed there into known_servers here",
			       endpoint);
		return;
	case GZ_HANDSHAKE_REFUSED:
		gz_err(log, "%s refuses our key; add this line to authorized_keys there: %s",
		       endpoint,
		       keys ? keys->public_key : "(no key yet: run gazectl keygen --client)");
		return;
	case GZ_HANDSHAKE_SERVER_KEY:
		gz_err(log,
		       "%s cannot prove that it is the server in known_servers; if its key was "
		       "changed, correct known_servers; otherwise somebody else answers in its "
		       "place",
		       endpoint);
		return;
	case GZ_HANDSHAKE_WANTS_KEYS:
		gz_err(log,
		       "%s requires keys: run gazectl keygen --client, and put the line that "
		       "gazectl keygen --server printed there into known_servers here",
		       endpoint);
		return;
	case GZ_HANDSHAKE_WANTS_NO_KEYS:
		gz_err(log,
		       "%s does not use keys, but known_servers has a key for it: set tcp = curve "
		       "there, or remove its host from known_servers",
		       endpoint);
		return;
	}
}

static bool set_subscriber_option(void *socket, int option, int value)
{
	return zmq_setsockopt(socket, option, &value, sizeof value) == 0;
}

static bool set_options(const struct gz_subscriber *subscriber, bool conflate)
{
	void *socket = subscriber->socket;
	bool set = set_subscriber_option(socket, ZMQ_LINGER, 0) &&
		   set_subscriber_option(socket, ZMQ_RECONNECT_IVL, GZ_RECONNECT_MS) &&
		   set_subscriber_option(socket, ZMQ_RCVHWM, RECEIVE_MESSAGES_MAX) &&
		   zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &message_bytes_max,
				  sizeof message_bytes_max) == 0;
	/* Only for an address in brackets: names are resolved to IPv4. */
	if (set && strchr(subscriber->endpoint, '['))
		set = set_subscriber_option(socket, ZMQ_IPV6, 1);
	if (set && conflate)
		set = set_subscriber_option(socket, ZMQ_CONFLATE, 1);
	if (set && strncmp(subscriber->endpoint, "tcp:", 4) == 0)
		set = set_subscriber_option(socket, ZMQ_HEARTBEAT_IVL, HEARTBEAT_MS) &&
		      set_subscriber_option(socket, ZMQ_HEARTBEAT_TIMEOUT, HEARTBEAT_TIMEOUT_MS);
	return set;
}

/* Subscribe to the topics, or find the daemon's board. */
static bool subscribe(struct gz_subscriber *subscriber, const struct gz_subscriber_params *params)
{
	const struct gz_board_link_params link = {
		.socket = subscriber->socket,
		.endpoint = subscriber->endpoint,
		.channel = params->channel,
		.topics = params->topics,
	};
	return gz_board_link_open(&subscriber->board, &link) == GZ_OK;
}

static bool open_subscriber_monitor(struct gz_subscriber *subscriber)
{
	subscriber->monitor = gz_handshake_open_monitor(
		subscriber->context, subscriber->socket, subscriber->endpoint,
		ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED);
	return subscriber->monitor != NULL;
}

static enum gz_result find_subscriber_keys(struct gz_subscriber *subscriber,
					   const struct gz_subscriber_params *params)
{
	if (params->keys) {
		subscriber->keys = *params->keys;
		subscriber->has_keys = true;
	}
	if (params->keys || !params->find_keys)
		return GZ_OK;
	enum gz_result result =
		gz_keys_find(subscriber->endpoint, NULL, NULL, subscriber->log, &subscriber->keys);
	subscriber->has_keys = result == GZ_OK;
	return result == GZ_ERR_NOT_FOUND ? GZ_OK : result;
}

static enum gz_result connect_socket(struct gz_subscriber *subscriber)
{
	subscriber->retry_ns = gz_clock_now_ns() + RETRY_NS;
	if (zmq_connect(subscriber->socket, subscriber->endpoint) == 0)
		return GZ_OK;
	gz_err(subscriber->log, "%s: %s; an endpoint looks like ipc:///path or tcp://host:port",
	       subscriber->endpoint, zmq_strerror(errno));
	return GZ_ERR_INVAL;
}

enum gz_result gz_subscriber_open(struct gz_subscriber *subscriber,
				  const struct gz_subscriber_params *params,
				  const struct gz_log *log)
{
	*subscriber = (struct gz_subscriber) { .log = log };
	enum gz_result result = gz_connection_endpoint(params->endpoint, params->channel, log,
						       subscriber->endpoint);
	if (result == GZ_OK)
		result = find_subscriber_keys(subscriber, params);
	if (result != GZ_OK)
		return result;
	subscriber->context = zmq_ctx_new();
	if (subscriber->context)
		subscriber->socket = zmq_socket(subscriber->context, ZMQ_SUB);
	if (!subscriber->socket || !set_options(subscriber, params->conflate) ||
	    !gz_handshake_use_keys(subscriber->socket,
				   subscriber->has_keys ? &subscriber->keys : NULL) ||
	    !subscribe(subscriber, params) || !open_subscriber_monitor(subscriber)) {
		gz_err(log, "cannot open a socket for %s: %s", subscriber->endpoint,
		       zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	return connect_socket(subscriber);
}

/* Connect again if there was no connection for RETRY_NS: libzmq ends a connection for good when the
 * peer breaks the protocol or sends too much. */
static void reconnect_if_due(struct gz_subscriber *subscriber)
{
	if (subscriber->connected) {
		subscriber->retry_ns = 0;
	} else if (subscriber->retry_ns == 0) {
		subscriber->retry_ns = gz_clock_now_ns() + RETRY_NS;
	} else if (gz_clock_now_ns() >= subscriber->retry_ns) {
		/* Fails if libzmq has ended that connection already. */
		zmq_disconnect(subscriber->socket, subscriber->endpoint);
		connect_socket(subscriber);
	}
}

/* Log a fault; the same one at most once a minute, because libzmq keeps trying. */
static void log_fault(struct gz_subscriber *subscriber, enum gz_handshake_fault fault)
{
	uint64_t dropped;
	if (fault == GZ_HANDSHAKE_ENDED && ++subscriber->hang_ups < GZ_HANDSHAKE_HANG_UPS)
		return;
	if (fault != subscriber->told)
		subscriber->telling = (struct gz_ratelimit) { 0 };
	subscriber->told = fault;
	if (gz_ratelimit_pass(&subscriber->telling, gz_clock_now_ns(), 60 * GZ_NS_PER_S, &dropped))
		gz_handshake_log(fault, subscriber->endpoint,
				 subscriber->has_keys ? &subscriber->keys : NULL, subscriber->log);
}

/* libzmq subscribes again after a reconnection, but only when the socket is used. While the board
 * is read, nothing is received from it. */
static void use_socket(struct gz_subscriber *subscriber)
{
	int events;
	size_t size = sizeof events;
	if (!gz_board_link_reads_socket(&subscriber->board))
		zmq_getsockopt(subscriber->socket, ZMQ_EVENTS, &events, &size);
}

uint64_t gz_subscriber_origin(const struct gz_subscriber *subscriber)
{
	const struct gz_board_link *board = &subscriber->board;
	return board->reader ? UINT64_MAX - board->boards : subscriber->connections;
}

void gz_subscriber_take_events(struct gz_subscriber *subscriber)
{
	use_socket(subscriber);
	for (;;) {
		struct gz_monitor_event event = gz_handshake_next_event(subscriber->monitor);
		enum gz_handshake_fault fault = gz_handshake_fault_of(&event, subscriber->has_keys);
		if (event.number == 0)
			break;
		if (fault != GZ_HANDSHAKE_FINE) {
			log_fault(subscriber, fault);
			continue;
		}
		bool connected = event.number == ZMQ_EVENT_HANDSHAKE_SUCCEEDED;
		if (connected) {
			subscriber->told = GZ_HANDSHAKE_FINE;
			subscriber->hang_ups = 0;
			subscriber->connections++;
			/* A retry that overtakes libzmq's own connects twice. */
			if (subscriber->connections > 1 && !subscriber->connected)
				gz_info(subscriber->log, "%s: connected again",
					subscriber->endpoint);
			gz_board_link_connected(&subscriber->board);
		} else if (subscriber->connected) {
			gz_info(subscriber->log, "%s: connection lost, waiting for it to return",
				subscriber->endpoint);
			gz_board_link_disconnected(&subscriber->board);
		}
		subscriber->connected = connected;
	}
	gz_board_link_step(&subscriber->board);
	reconnect_if_due(subscriber);
}

void gz_subscriber_close(struct gz_subscriber *subscriber)
{
	if (subscriber->socket)
		zmq_socket_monitor(subscriber->socket, NULL, 0);
	if (subscriber->monitor)
		zmq_close(subscriber->monitor);
	gz_board_link_close(&subscriber->board);
	if (subscriber->socket)
		zmq_close(subscriber->socket);
	if (subscriber->context)
		zmq_ctx_term(subscriber->context);
	explicit_bzero(&subscriber->keys, sizeof subscriber->keys);
	*subscriber = (struct gz_subscriber) { 0 };
}
