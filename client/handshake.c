#include "client/handshake.h"

#include <stdio.h>
#include <string.h>
#include <zmq.h>

#define GZ_LOG_MODULE "client"

bool gz_handshake_use_keys(void *socket, const struct gz_keys *keys)
{
	return !keys || (zmq_setsockopt(socket, ZMQ_CURVE_SERVERKEY, keys->server_key,
					GZ_KEYS_TEXT_SIZE) == 0 &&
			 zmq_setsockopt(socket, ZMQ_CURVE_PUBLICKEY, keys->public_key,
					GZ_KEYS_TEXT_SIZE) == 0 &&
			 zmq_setsockopt(socket, ZMQ_CURVE_SECRETKEY, keys->secret_key,
					GZ_KEYS_TEXT_SIZE) == 0);
}

/* The monitor tells over a PAIR inside this process. Its queue has no limit: libzmq would block its
 * I/O thread at one, and only handshakes and their ends are written to it. */
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
			       "%s hangs up on our greeting: most likely its server key is another "
			       "than ours, %s, or it has none; look there and mend known_servers",
			       endpoint, keys->server_key);
		else
			gz_err(log,
			       "%s hangs up on our greeting; a gazed with tcp = curve wants keys: "
			       "run "
			       "gazectl keygen --client, and put the line that gazectl keygen "
			       "--server printed there into known_servers",
			       endpoint);
		return;
	case GZ_HANDSHAKE_REFUSED:
		gz_err(log, "%s refuses our key; add this line to authorized_keys there: %s",
		       endpoint, keys ? keys->public_key : "(we have none: gazectl keygen)");
		return;
	case GZ_HANDSHAKE_SERVER_KEY:
		gz_err(log,
		       "%s cannot prove that it is the server that we know; if its key was "
		       "changed, mend known_servers, else somebody is playing it",
		       endpoint);
		return;
	case GZ_HANDSHAKE_WANTS_KEYS:
		gz_err(log,
		       "%s wants keys: run gazectl keygen --client, and put the line that gazectl "
		       "keygen --server printed there into known_servers",
		       endpoint);
		return;
	case GZ_HANDSHAKE_WANTS_NO_KEYS:
		gz_err(log,
		       "%s serves without keys, though we know its key: set tcp = curve there, or "
		       "take its host out of known_servers",
		       endpoint);
		return;
	}
}
