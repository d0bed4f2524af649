#include "client/subscriber.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "client"

/* Chosen: libzmq waits this and up to as much again before each new attempt, so a daemon that
 * returns is found within 0.1 s at the cost of some twenty attempts a second while it is gone. */
enum { RECONNECT_MS = 50 };

/* Chosen: over TCP a peer can vanish without a word; three silent seconds end the connection. */
enum { HEARTBEAT_MS = 1000, HEARTBEAT_TIMEOUT_MS = 3000 };

/* Chosen: longer than any handshake takes. */
#define RETRY_NS (2 * GZ_NS_PER_S)

/* Chosen: our messages are at most 4 KiB, Pupil Capture's a few more; libzmq drops a connection
 * that announces a larger one. */
static const int64_t message_bytes_max = 65536;

/* Chosen: 3.4 s of a 1200 Hz tracker, some 6 MiB; what comes after that is dropped by the
 * publisher and seen as a gap. */
enum { RECEIVE_MESSAGES_MAX = 4096 };

static bool set_int(void *socket, int option, int value)
{
	return zmq_setsockopt(socket, option, &value, sizeof value) == 0;
}

static bool set_options(const struct gz_subscriber *subscriber, bool conflate)
{
	void *socket = subscriber->socket;
	bool set = set_int(socket, ZMQ_LINGER, 0) &&
		   set_int(socket, ZMQ_RECONNECT_IVL, RECONNECT_MS) &&
		   set_int(socket, ZMQ_RCVHWM, RECEIVE_MESSAGES_MAX) &&
		   zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &message_bytes_max,
				  sizeof message_bytes_max) == 0;
	if (set && conflate)
		set = set_int(socket, ZMQ_CONFLATE, 1);
	if (set && strncmp(subscriber->endpoint, "tcp:", 4) == 0)
		set = set_int(socket, ZMQ_HEARTBEAT_IVL, HEARTBEAT_MS) &&
		      set_int(socket, ZMQ_HEARTBEAT_TIMEOUT, HEARTBEAT_TIMEOUT_MS);
	return set;
}

static bool subscribe(void *socket, const char *const *topics)
{
	if (!topics)
		return zmq_setsockopt(socket, ZMQ_SUBSCRIBE, "", 0) == 0;
	for (; *topics; topics++)
		if (zmq_setsockopt(socket, ZMQ_SUBSCRIBE, *topics, strlen(*topics)) != 0)
			return false;
	return true;
}

/* The monitor tells of connections over a PAIR inside this process. Its queue has no limit: libzmq
 * would block its I/O thread at one, and only whole handshakes and their ends are written to it. */
static bool open_monitor(struct gz_subscriber *subscriber)
{
	char address[64];
	snprintf(address, sizeof address, "inproc://gazecast-monitor-%p",
		 (void *)subscriber->socket);
	if (zmq_socket_monitor(subscriber->socket, address,
			       ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED) != 0)
		return false;
	subscriber->monitor = zmq_socket(subscriber->context, ZMQ_PAIR);
	return subscriber->monitor && set_int(subscriber->monitor, ZMQ_LINGER, 0) &&
	       set_int(subscriber->monitor, ZMQ_RCVHWM, 0) &&
	       zmq_connect(subscriber->monitor, address) == 0;
}

static enum gz_result find_endpoint(struct gz_subscriber *subscriber,
				    const struct gz_subscriber_params *params)
{
	char *text = subscriber->endpoint;
	if (params->endpoint) {
		int length = snprintf(text, GZ_ENDPOINT_SIZE, "%s", params->endpoint);
		if (length > 0 && length < GZ_ENDPOINT_SIZE)
			return GZ_OK;
		gz_err(subscriber->log, "an endpoint has 1 to %d bytes, not %d",
		       GZ_ENDPOINT_SIZE - 1, length);
		return GZ_ERR_INVAL;
	}
	char directory[GZ_ENDPOINT_SIZE];
	if (gz_runtime_directory(directory, sizeof directory) != GZ_OK ||
	    gz_endpoint_ipc(directory, params->channel, text, GZ_ENDPOINT_SIZE) != GZ_OK) {
		gz_err(subscriber->log, "the runtime directory's path is too long for a socket: "
					"set GAZECAST_RUNTIME_DIR to a shorter one");
		return GZ_ERR_INVAL;
	}
	return GZ_OK;
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
	enum gz_result result = find_endpoint(subscriber, params);
	if (result != GZ_OK)
		return result;
	subscriber->context = zmq_ctx_new();
	if (subscriber->context)
		subscriber->socket = zmq_socket(subscriber->context, ZMQ_SUB);
	if (!subscriber->socket || !set_options(subscriber, params->conflate) ||
	    !subscribe(subscriber->socket, params->topics) || !open_monitor(subscriber)) {
		gz_err(log, "cannot make a socket for %s: %s", subscriber->endpoint,
		       zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	return connect_socket(subscriber);
}

/* Event number of the next monitor message, or 0 if there is none. */
static int next_event(void *monitor)
{
	unsigned char event[6]; /* 16 bits number, 32 bits value, in this machine's byte order */
	int size = zmq_recv(monitor, event, sizeof event, ZMQ_DONTWAIT);
	if (size < 0)
		return 0;
	char address[1];
	zmq_recv(monitor, address, sizeof address, ZMQ_DONTWAIT); /* second frame: the endpoint */
	uint16_t number = 0;
	if (size >= (int)sizeof number)
		memcpy(&number, event, sizeof number);
	return number;
}

/* libzmq ends a connection for good when the peer breaks the protocol or sends too much. */
static void renew(struct gz_subscriber *subscriber)
{
	if (subscriber->connected) {
		subscriber->retry_ns = 0;
	} else if (subscriber->retry_ns == 0) {
		subscriber->retry_ns = gz_clock_now_ns() + RETRY_NS;
	} else if (gz_clock_now_ns() >= subscriber->retry_ns) {
		/* Fails where libzmq has ended that connection already. */
		zmq_disconnect(subscriber->socket, subscriber->endpoint);
		connect_socket(subscriber);
	}
}

void gz_subscriber_take_events(struct gz_subscriber *subscriber)
{
	int event;
	while ((event = next_event(subscriber->monitor)) != 0) {
		bool connected = event == ZMQ_EVENT_HANDSHAKE_SUCCEEDED;
		if (connected) {
			subscriber->connections++;
			if (subscriber->connections > 1)
				gz_info(subscriber->log, "%s is back", subscriber->endpoint);
		} else if (subscriber->connected) {
			gz_info(subscriber->log, "lost %s: waiting for it to return",
				subscriber->endpoint);
		}
		subscriber->connected = connected;
	}
	renew(subscriber);
}

void gz_subscriber_close(struct gz_subscriber *subscriber)
{
	if (subscriber->socket)
		zmq_socket_monitor(subscriber->socket, NULL, 0);
	if (subscriber->monitor)
		zmq_close(subscriber->monitor);
	if (subscriber->socket)
		zmq_close(subscriber->socket);
	if (subscriber->context)
		zmq_ctx_term(subscriber->context);
	*subscriber = (struct gz_subscriber) { 0 };
}
