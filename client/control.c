#include "client/control.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "protocol/endpoint.h"

#define GZ_LOG_MODULE "client"

struct gz_control {
	void *context;
	const struct gz_log *log;
	char endpoint[GZ_ENDPOINT_SIZE];
};

static enum gz_result find_endpoint(struct gz_control *control, const char *endpoint)
{
	if (endpoint) {
		int length = snprintf(control->endpoint, GZ_ENDPOINT_SIZE, "%s", endpoint);
		return length > 0 && length < GZ_ENDPOINT_SIZE ? GZ_OK : GZ_ERR_INVAL;
	}
	char directory[GZ_ENDPOINT_SIZE];
	if (gz_runtime_directory(directory, sizeof directory) != GZ_OK)
		return GZ_ERR_INVAL;
	return gz_endpoint_ipc(directory, "control", control->endpoint, GZ_ENDPOINT_SIZE) == GZ_OK
		       ? GZ_OK
		       : GZ_ERR_INVAL;
}

/* A REQ socket of its own for each request: one whose reply never came can be used no more. */
static void *connect_socket(struct gz_control *control, int timeout_ms)
{
	void *socket = zmq_socket(control->context, ZMQ_REQ);
	if (!socket)
		return NULL;
	const int zero = 0;
	zmq_setsockopt(socket, ZMQ_LINGER, &zero, sizeof zero);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_SNDTIMEO, &timeout_ms, sizeof timeout_ms);
	const int64_t bytes_max = GZ_CONTROL_REPLY_SIZE;
	zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &bytes_max, sizeof bytes_max);
	if (zmq_connect(socket, control->endpoint) == 0)
		return socket;
	int error = errno;
	zmq_close(socket);
	errno = error;
	return NULL;
}

static enum gz_result check_endpoint(struct gz_control *control)
{
	void *socket = connect_socket(control, 1);
	if (!socket) {
		int error = errno;
		gz_err(control->log,
		       "%s: %s; an endpoint looks like ipc:///path or tcp://host:port",
		       control->endpoint, zmq_strerror(error));
		return error == ENOMEM || error == EMFILE ? GZ_ERR_NO_MEM : GZ_ERR_INVAL;
	}
	zmq_close(socket);
	return GZ_OK;
}

enum gz_result gz_control_open(const char *endpoint, const struct gz_log *log,
			       struct gz_control **out_control)
{
	struct gz_control *control = calloc(1, sizeof *control);
	if (!control)
		return GZ_ERR_NO_MEM;
	control->log = log;
	enum gz_result result = find_endpoint(control, endpoint);
	if (result != GZ_OK)
		gz_err(log, "an endpoint has 1 to %d bytes, and a local one at most 107",
		       GZ_ENDPOINT_SIZE - 1);
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

static enum gz_result receive_reply(void *socket, char *out_reply)
{
	char reply[GZ_CONTROL_REPLY_SIZE];
	int size = zmq_recv(socket, reply, sizeof reply, 0);
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

enum gz_result gz_control_request(struct gz_control *control, const char *request, int timeout_ms,
				  char out_reply[GZ_CONTROL_REPLY_SIZE])
{
	if (timeout_ms < 1)
		return GZ_ERR_INVAL;
	void *socket = connect_socket(control, timeout_ms);
	if (!socket)
		return GZ_ERR_NO_MEM;
	enum gz_result result = GZ_ERR_TIMEOUT;
	if (zmq_send(socket, request, strlen(request), 0) >= 0)
		result = receive_reply(socket, out_reply);
	zmq_close(socket);
	return result;
}

/* "ipc:///run/user/1000/gazecast/control" has its stream beside it. */
static enum gz_result neighbour(const char *endpoint, char *text, size_t size)
{
	const char *slash = strrchr(endpoint, '/');
	int length =
		snprintf(text, size, "%.*s/stream", slash ? (int)(slash - endpoint) : 0, endpoint);
	return length < (int)size ? GZ_OK : GZ_ERR_FULL;
}

/* "tcp://127.0.0.1:50020" and the text "41231" give "tcp://127.0.0.1:41231". */
static enum gz_result with_port(const char *endpoint, const char *port_text, char *text,
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
		result = neighbour(control->endpoint, found, sizeof found);
	} else {
		char reply[GZ_CONTROL_REPLY_SIZE];
		result = gz_control_request(control, "SUB_PORT", timeout_ms, reply);
		if (result == GZ_OK)
			result = with_port(control->endpoint, reply, found, sizeof found);
	}
	if (result != GZ_OK)
		return result;
	if (strlen(found) >= size)
		return GZ_ERR_FULL;
	memcpy(text, found, strlen(found) + 1);
	return GZ_OK;
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
	free(*control);
	*control = NULL;
}
