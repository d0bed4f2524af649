#include "client/control.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "client/connection.h"
#include "protocol/endpoint.h"

#define GZ_LOG_MODULE "client"

struct gz_control {
	void *context;
	const struct gz_log *log;
	char endpoint[GZ_ENDPOINT_SIZE];
	bool has_keys;
	struct gz_keys keys;
};

/* Open a REQ socket. Each request has its own, because a socket without its reply is useless. */
static void *open_control_socket(struct gz_control *control, int timeout_ms)
{
	void *socket = zmq_socket(control->context, ZMQ_REQ);
	if (!socket)
		return NULL;
	const int zero = 0, ipv6 = strchr(control->endpoint, '[') != NULL;
	zmq_setsockopt(socket, ZMQ_IPV6, &ipv6, sizeof ipv6);
	zmq_setsockopt(socket, ZMQ_LINGER, &zero, sizeof zero);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_SNDTIMEO, &timeout_ms, sizeof timeout_ms);
	const int64_t bytes_max = GZ_CONTROL_REPLY_SIZE;
	zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &bytes_max, sizeof bytes_max);
	if (gz_handshake_use_keys(socket, gz_control_keys(control)))
		return socket;
	int error = errno;
	zmq_close(socket);
	errno = error;
	return NULL;
}

static enum gz_result check_endpoint(struct gz_control *control)
{
	void *socket = open_control_socket(control, 1);
	if (!socket || zmq_connect(socket, control->endpoint) != 0) {
		int error = errno;
		if (socket)
			zmq_close(socket);
		gz_err(control->log,
		       "%s: %s; an endpoint looks like ipc:///path or tcp://host:port",
		       control->endpoint, zmq_strerror(error));
		return error == ENOMEM || error == EMFILE ? GZ_ERR_NO_MEM : GZ_ERR_INVAL;
	}
	zmq_close(socket);
	return GZ_OK;
}

enum gz_result gz_control_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					 const struct gz_log *log, struct gz_control **out_control)
{
	struct gz_control *control = calloc(1, sizeof *control);
	if (!control)
		return GZ_ERR_NO_MEM;
	control->log = log;
	control->has_keys = keys != NULL;
	if (keys)
		control->keys = *keys;
	enum gz_result result = gz_connection_endpoint(endpoint, "control", log, control->endpoint);
	if (result == GZ_OK) {
		control->context = zmq_ctx_new();
		result = control->context ? check_endpoint(control) : GZ_ERR_NO_MEM;
	}
	if (result != GZ_OK) {
		gz_control_close(&control);
		return result;
	}
	*out_control = control;
	return GZ_OK;
}

enum gz_result gz_control_open(const char *endpoint, const struct gz_log *log,
			       struct gz_control **out_control)
{
	struct gz_keys keys;
	enum gz_result result = gz_keys_find(endpoint, NULL, NULL, log, &keys);
	if (result != GZ_OK && result != GZ_ERR_NOT_FOUND)
		return result;
	result = gz_control_open_with_keys(endpoint, result == GZ_OK ? &keys : NULL, log,
					   out_control);
	explicit_bzero(&keys, sizeof keys);
	return result;
}

static enum gz_result receive_reply(void *socket, char *out_reply)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	int size = zmq_recv(socket, reply, sizeof reply, ZMQ_DONTWAIT);
	if (size < 0)
		return GZ_ERR_TIMEOUT;
	int more = 0;
	size_t more_size = sizeof more;
	zmq_getsockopt(socket, ZMQ_RCVMORE, &more, &more_size);
	if (more || size >= (int)sizeof reply || memchr(reply, '\0', (size_t)size))
		return GZ_ERR_PROTOCOL;
	memcpy(out_reply, reply, (size_t)size);
	out_reply[size] = '\0';
	return GZ_OK;
}

/* A request that waits for its reply. */
struct wait {
	void *socket;
	void *monitor;
	enum gz_handshake_fault fault; /* the last one reported */
	int hang_ups;                  /* how often the daemon closed the connection */
};

/* Whether the monitor has reported that no reply will come. */
static bool handshake_failed_for_good(const struct gz_control *control, struct wait *wait)
{
	struct gz_monitor_event event;
	while ((event = gz_handshake_next_event(wait->monitor)).number != 0) {
		enum gz_handshake_fault fault = gz_handshake_fault_of(&event, control->has_keys);
		if (fault != GZ_HANDSHAKE_FINE)
			wait->fault = fault;
		wait->hang_ups += fault == GZ_HANDSHAKE_ENDED;
	}
	return wait->fault > GZ_HANDSHAKE_ENDED || wait->hang_ups >= GZ_HANDSHAKE_HANG_UPS;
}

static enum gz_result wait_reply(const struct gz_control *control, struct wait *wait,
				 int timeout_ms, char *out_reply)
{
	zmq_pollitem_t items[] = { { .socket = wait->socket, .events = ZMQ_POLLIN },
				   { .socket = wait->monitor, .events = ZMQ_POLLIN } };
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	while (!handshake_failed_for_good(control, wait)) {
		int64_t left_ns = deadline_ns - gz_clock_now_ns();
		if (left_ns <= 0 ||
		    (zmq_poll(items, 2, (long)(left_ns / GZ_NS_PER_MS) + 1) < 0 && errno != EINTR))
			break;
		if (items[0].revents)
			return receive_reply(wait->socket, out_reply);
	}
	if (wait->fault == GZ_HANDSHAKE_FINE)
		return GZ_ERR_TIMEOUT;
	gz_handshake_log(wait->fault, control->endpoint, gz_control_keys(control), control->log);
	return GZ_ERR_ACCESS;
}

enum gz_result gz_control_request(struct gz_control *control, const char *request, int timeout_ms,
				  char out_reply[GZ_CONTROL_REPLY_SIZE])
{
	if (timeout_ms < 1)
		return GZ_ERR_INVAL;
	void *socket = open_control_socket(control, timeout_ms);
	void *monitor =
		socket ? gz_handshake_open_monitor(control->context, socket, control->endpoint, 0)
		       : NULL;
	struct wait wait = { .socket = socket, .monitor = monitor };
	enum gz_result result = GZ_ERR_NO_MEM;
	if (monitor && zmq_connect(socket, control->endpoint) == 0)
		result = zmq_send(socket, request, strlen(request), 0) >= 0
				 ? wait_reply(control, &wait, timeout_ms, out_reply)
				 : GZ_ERR_TIMEOUT;
	if (socket)
		zmq_socket_monitor(socket, NULL, 0);
	if (monitor)
		zmq_close(monitor);
	if (socket)
		zmq_close(socket);
	return result;
}

/* The stream of "ipc:///run/user/1000/gazecast/control" is in the same directory. */
static enum gz_result stream_beside_control(const char *endpoint, char *text, size_t size)
{
	const char *slash = strrchr(endpoint, '/');
	int length =
		snprintf(text, size, "%.*s/stream", slash ? (int)(slash - endpoint) : 0, endpoint);
	return length < (int)size ? GZ_OK : GZ_ERR_FULL;
}

/* "tcp://127.0.0.1:50020" and the text "41231" give "tcp://127.0.0.1:41231". */
static enum gz_result endpoint_with_port(const char *endpoint, const char *port_text, char *text,
					 size_t size)
{
	char *end;
	long port = strtol(port_text, &end, 10);
	if (end == port_text || *end || port < 1 || port > 65535)
		return GZ_ERR_UNSUPPORTED;
	const char *colon = strrchr(endpoint, ':');
	int length = snprintf(text, size, "%.*s:%ld", colon ? (int)(colon - endpoint) : 0, endpoint,
			      port);
	return length < (int)size ? GZ_OK : GZ_ERR_FULL;
}

enum gz_result gz_control_stream_endpoint(struct gz_control *control, int timeout_ms, char *text,
					  size_t size)
{
	char found[GZ_ENDPOINT_SIZE];
	enum gz_result result;
	if (strncmp(control->endpoint, "ipc:", 4) == 0) {
		result = stream_beside_control(control->endpoint, found, sizeof found);
	} else {
		char reply[GZ_CONTROL_REPLY_SIZE];
		result = gz_control_request(control, "SUB_PORT", timeout_ms, reply);
		if (result == GZ_OK)
			result = endpoint_with_port(control->endpoint, reply, found, sizeof found);
	}
	if (result != GZ_OK)
		return result;
	if (strlen(found) >= size)
		return GZ_ERR_FULL;
	memcpy(text, found, strlen(found) + 1);
	return GZ_OK;
}

const struct gz_keys *gz_control_keys(const struct gz_control *control)
{
	return control->has_keys ? &control->keys : NULL;
}

const char *gz_control_endpoint(const struct gz_control *control)
{
	return control->endpoint;
}

void gz_control_close(struct gz_control **control)
{
	if (!*control)
		return;
	if ((*control)->context)
		zmq_ctx_term((*control)->context);
	explicit_bzero(&(*control)->keys, sizeof(*control)->keys);
	free(*control);
	*control = NULL;
}
