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
	/* An address in brackets; names are looked up as ever. */
	if (set && strchr(subscriber->endpoint, '['))
		set = set_int(socket, ZMQ_IPV6, 1);
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

static bool open_monitor(struct gz_subscriber *subscriber)
{
	subscriber->monitor = gz_handshake_open_monitor(
		subscriber->context, subscriber->socket, subscriber->endpoint,
		ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED);
	return subscriber->monitor != NULL;
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
	enum gz_result result =
		gz_endpoint_find(params->channel, subscriber->log, text, GZ_ENDPOINT_SIZE);
	if (result != GZ_ERR_FULL)
		return result;
	gz_err(subscriber->log, "the runtime directory's path is too long for a socket: "
				"set GAZECAST_RUNTIME_DIR to a shorter one");
	return GZ_ERR_INVAL;
}

static enum gz_result find_keys(struct gz_subscriber *subscriber,
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
	enum gz_result result = find_endpoint(subscriber, params);
	if (result == GZ_OK)
		result = find_keys(subscriber, params);
	if (result != GZ_OK)
		return result;
	subscriber->context = zmq_ctx_new();
	if (subscriber->context)
		subscriber->socket = zmq_socket(subscriber->context, ZMQ_SUB);
	if (!subscriber->socket || !set_options(subscriber, params->conflate) ||
	    !gz_handshake_use_keys(subscriber->socket,
				   subscriber->has_keys ? &subscriber->keys : NULL) ||
	    !subscribe(subscriber->socket, params->topics) || !open_monitor(subscriber)) {
		gz_err(log, "cannot make a socket for %s: %s", subscriber->endpoint,
		       zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	return connect_socket(subscriber);
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

/* The same fault is told once a minute: libzmq tries again and again. */
static void tell(struct gz_subscriber *subscriber, enum gz_handshake_fault fault)
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

void gz_subscriber_take_events(struct gz_subscriber *subscriber)
{
	for (;;) {
		struct gz_monitor_event event = gz_handshake_next_event(subscriber->monitor);
		enum gz_handshake_fault fault = gz_handshake_fault_of(&event, subscriber->has_keys);
		if (event.number == 0)
			break;
		if (fault != GZ_HANDSHAKE_FINE) {
			tell(subscriber, fault);
			continue;
		}
		bool connected = event.number == ZMQ_EVENT_HANDSHAKE_SUCCEEDED;
		if (connected) {
			subscriber->told = GZ_HANDSHAKE_FINE;
			subscriber->hang_ups = 0;
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
	explicit_bzero(&subscriber->keys, sizeof subscriber->keys);
	*subscriber = (struct gz_subscriber) { 0 };
}
