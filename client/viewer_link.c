#include "client/viewer_link.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "client/connection.h"
#include "protocol/endpoint.h"

#define GZ_LOG_MODULE "viewer"

/* Messages kept for a busy daemon; further ones are dropped. Chosen: newer ones replace them. */
enum { QUEUE = 64 };

/* Longest wait at the end, ms. Chosen: enough for the last message to leave. */
enum { LINGER_MS = 100 };

struct gz_viewer_link {
	void *context;
	void *socket;
	struct gz_viewer_pointer pointer; /* as last sent */
	struct gz_viewer_window window;   /* as last sent */
	struct gz_monitor_place monitor;  /* for the next one */
	bool has_still, still_scene;      /* for the next one */
};

/* The inlet is in the same directory as the latest channel. */
static enum gz_result find_inlet(const char *latest, char *text, size_t size)
{
	static const char tail[] = "/latest";
	char directory[GZ_PATH_SIZE];
	if (!latest || !latest[0]) {
		enum gz_result r = gz_runtime_directory(directory, sizeof directory);
		return r == GZ_OK ? gz_endpoint_ipc(directory, "inlet", text, size) : r;
	}
	size_t length = strlen(latest);
	if (strncmp(latest, "ipc://", 6) != 0 || length < sizeof tail - 1 ||
	    strcmp(latest + length - (sizeof tail - 1), tail) != 0)
		return GZ_ERR_UNSUPPORTED;
	int written = snprintf(text, size, "%.*s/inlet", (int)(length - (sizeof tail - 1)), latest);
	return written > 0 && (size_t)written < size ? GZ_OK : GZ_ERR_FULL;
}

static enum gz_result connect_to_inlet(struct gz_viewer_link *link, const char *endpoint,
				       const struct gz_log *log)
{
	int queue = QUEUE, linger = LINGER_MS, reconnect = GZ_RECONNECT_MS;
	link->context = zmq_ctx_new();
	link->socket = link->context ? zmq_socket(link->context, ZMQ_PUB) : NULL;
	if (!link->socket || zmq_setsockopt(link->socket, ZMQ_SNDHWM, &queue, sizeof queue) != 0 ||
	    zmq_setsockopt(link->socket, ZMQ_LINGER, &linger, sizeof linger) != 0 ||
	    zmq_setsockopt(link->socket, ZMQ_RECONNECT_IVL, &reconnect, sizeof reconnect) != 0) {
		gz_err(log, "cannot open a socket to the daemon: %s", zmq_strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	if (zmq_connect(link->socket, endpoint) == 0)
		return GZ_OK;
	gz_err(log, "cannot connect to %s: %s", endpoint, zmq_strerror(errno));
	return GZ_ERR_INVAL;
}

enum gz_result gz_viewer_link_open(const char *latest, const struct gz_log *log,
				   struct gz_viewer_link **out_link)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	enum gz_result result = find_inlet(latest, endpoint, sizeof endpoint);
	if (result == GZ_ERR_FULL)
		gz_err(log, "the path of the runtime directory is too long for a socket: set "
			    "GAZECAST_RUNTIME_DIR to a shorter one");
	if (result != GZ_OK)
		return result;
	struct gz_viewer_link *link = calloc(1, sizeof *link);
	if (!link)
		return GZ_ERR_NO_MEM;
	result = connect_to_inlet(link, endpoint, log);
	if (result != GZ_OK) {
		gz_viewer_link_close(&link);
		return result;
	}
	*out_link = link;
	return GZ_OK;
}

static void send_to_inlet(struct gz_viewer_link *link, const char *topic,
			  const struct gz_wire_message *message)
{
	if (zmq_send(link->socket, topic, strlen(topic), ZMQ_SNDMORE | ZMQ_DONTWAIT) >= 0)
		zmq_send(link->socket, message->bytes, message->size, ZMQ_DONTWAIT);
}

void gz_viewer_link_pointer(struct gz_viewer_link *link, const struct gz_point *point,
			    int64_t now_ns)
{
	struct gz_wire_message message;
	struct gz_viewer_pointer *sent = &link->pointer;
	struct gz_viewer_pointer pointer = {
		.known = point != NULL,
		.point = point ? *point : (struct gz_point) { 0, 0 },
		.has_time = true,
		.time_ns = now_ns,
	};
	bool moved = pointer.known != sent->known || pointer.point.x != sent->point.x ||
		     pointer.point.y != sent->point.y;
	bool due = pointer.known && now_ns - sent->time_ns >= GZ_VIEWER_LINK_POINTER_NS;
	if (!moved && !due)
		return;
	link->pointer = pointer;
	if (gz_wire_encode_pointer(&pointer, &message) == GZ_OK)
		send_to_inlet(link, GZ_TOPIC_POINTER, &message);
}

static void send_viewer_window(struct gz_viewer_link *link, const struct gz_viewer_window *window)
{
	struct gz_wire_message message;
	link->window = *window;
	if (gz_wire_encode_window(window, &message) == GZ_OK)
		send_to_inlet(link, GZ_TOPIC_WINDOW, &message);
}

void gz_viewer_link_window(struct gz_viewer_link *link, const int rect_px[4], int64_t now_ns)
{
	const struct gz_viewer_window *sent = &link->window;
	struct gz_viewer_window window = {
		.known = true,
		.monitor = link->monitor,
		.has_still = link->has_still,
		.still_scene = link->still_scene,
		.has_time = true,
		.time_ns = now_ns,
	};
	memcpy(window.rect_px, rect_px, sizeof window.rect_px);
	bool same = sent->known && memcmp(sent->rect_px, rect_px, sizeof window.rect_px) == 0 &&
		    memcmp(&sent->monitor, &link->monitor, sizeof link->monitor) == 0 &&
		    sent->has_still == link->has_still && sent->still_scene == link->still_scene;
	if (!same || now_ns - sent->time_ns >= GZ_VIEWER_LINK_WINDOW_NS)
		send_viewer_window(link, &window);
}

void gz_viewer_link_monitor(struct gz_viewer_link *link, const struct gz_monitor_place *monitor)
{
	const struct gz_monitor_place unknown = { .scale = 0 };
	link->monitor = monitor ? *monitor : unknown;
}

void gz_viewer_link_scene(struct gz_viewer_link *link, bool still)
{
	link->has_still = true;
	link->still_scene = still;
}

void gz_viewer_link_annotate(struct gz_viewer_link *link, const char *label, int64_t time_ns)
{
	struct gz_wire_message message;
	struct gz_annotation annotation = { .has_time = true, .time_ns = time_ns };
	size_t length = strlen(label);
	if (length >= sizeof annotation.label)
		return;
	memcpy(annotation.label, label, length + 1);
	if (gz_wire_encode_annotation(&annotation, &message) == GZ_OK)
		send_to_inlet(link, GZ_TOPIC_ANNOTATION, &message);
}

void gz_viewer_link_close(struct gz_viewer_link **link)
{
	if (!link || !*link)
		return;
	struct gz_viewer_link *l = *link;
	const struct gz_viewer_window closed = { .known = false };
	if (l->socket && l->window.known)
		send_viewer_window(l, &closed);
	if (l->socket)
		zmq_close(l->socket);
	if (l->context)
		zmq_ctx_term(l->context);
	free(l);
	*link = NULL;
}
