#include "daemon/inlet.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/endpoint.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "inlet"

/* Messages kept while the daemon is busy; libzmq drops further ones. */
enum { QUEUE = 256 };

struct gz_inlet {
	const struct gz_log *log;
	void *socket;
	int port;
	struct gz_ratelimit complaints;
};

static bool topic_begins_with(const char *text, const char *beginning)
{
	return strncmp(text, beginning, strlen(beginning)) == 0;
}

static bool is_own_topic(const char *topic)
{
	static const char *const own[] = { GZ_TOPIC_GAZE,   GZ_TOPIC_SURFACES, GZ_TOPIC_FIXATIONS,
					   GZ_TOPIC_BLINKS, GZ_TOPIC_SACCADES, GZ_TOPIC_STATUS,
					   "pupil." };
	for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
		if (topic_begins_with(topic, own[i]))
			return true;
	}
	return false;
}

static enum gz_result read_annotation(const void *body, size_t size, int64_t now_ns,
				      struct gz_inlet_message *out_message)
{
	struct gz_annotation annotation;
	enum gz_result result = gz_wire_decode_annotation(body, size, &annotation);
	if (result != GZ_OK)
		return result;
	out_message->is_mark = true;
	out_message->mark_ns = annotation.has_time ? annotation.time_ns : now_ns;
	if (annotation.duration_ns > 0)
		snprintf(out_message->mark, sizeof out_message->mark, "%s, duration %.9g s",
			 annotation.label, gz_ns_to_s(annotation.duration_ns));
	else
		snprintf(out_message->mark, sizeof out_message->mark, "%s", annotation.label);
	return GZ_OK;
}

static enum gz_result read_viewer_report(const char *topic, const void *body, size_t size,
					 struct gz_inlet_message *out_message)
{
	bool is_pointer = strcmp(topic, GZ_TOPIC_POINTER) == 0;
	bool is_window = strcmp(topic, GZ_TOPIC_WINDOW) == 0;
	enum gz_result result = GZ_OK;
	if (is_pointer)
		result = gz_wire_decode_pointer(body, size, &out_message->pointer);
	else if (is_window)
		result = gz_wire_decode_window(body, size, &out_message->window);
	if (result != GZ_OK)
		return result;
	out_message->is_pointer = is_pointer;
	out_message->is_window = is_window;
	return GZ_OK;
}

enum gz_result gz_inlet_judge(const void *topic, size_t topic_size, const void *body,
			      size_t body_size, int64_t now_ns,
			      struct gz_inlet_message *out_message)
{
	char text[GZ_INLET_TOPIC_SIZE];
	if (topic_size == 0 || topic_size >= sizeof text || memchr(topic, '\0', topic_size) ||
	    body_size > GZ_INLET_SIZE_MAX || gz_wire_check(body, body_size) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	memcpy(text, topic, topic_size);
	text[topic_size] = '\0';
	if (is_own_topic(text))
		return GZ_ERR_ACCESS;
	if (topic_begins_with(text, GZ_TOPIC_ANNOTATION)) {
		struct gz_inlet_message mark;
		if (read_annotation(body, body_size, now_ns, &mark) != GZ_OK)
			return GZ_ERR_PROTOCOL;
		out_message->mark_ns = mark.mark_ns;
		memcpy(out_message->mark, mark.mark, sizeof mark.mark);
	}
	bool is_notification = topic_begins_with(text, GZ_TOPIC_NOTIFY);
	if (is_notification &&
	    gz_wire_decode_notification(body, body_size, &out_message->notification) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	enum gz_result viewer = read_viewer_report(text, body, body_size, out_message);
	if (viewer != GZ_OK)
		return viewer;
	out_message->is_notification = is_notification;
	out_message->is_mark = topic_begins_with(text, GZ_TOPIC_ANNOTATION);
	memcpy(out_message->topic, text, sizeof text);
	memcpy(out_message->body, body, body_size);
	out_message->size = body_size;
	return GZ_OK;
}

const char *gz_inlet_refusal(enum gz_result result)
{
	return result == GZ_ERR_ACCESS ? "refused: this topic is reserved for the daemon"
				       : "refused: a message must be a topic and one MessagePack "
					 "map; an annotation "
					 "needs a label, a notification a subject";
}

static void warn_of_refusal(struct gz_inlet *inlet, enum gz_result result)
{
	uint64_t held_back;
	if (!gz_ratelimit_pass(&inlet->complaints, gz_clock_now_ns(), GZ_NS_PER_S, &held_back))
		return;
	gz_warn(inlet->log, "client bug: a message %s; dropped (%llu more since the last message)",
		result == GZ_ERR_ACCESS ? "has a topic that is reserved for the daemon"
					: "is not a topic and a MessagePack map",
		(unsigned long long)held_back);
}

int gz_inlet_receive_frames(void *socket, zmq_msg_t frames[2])
{
	int count = 0;
	bool more = true;
	while (more) {
		zmq_msg_t *frame = &frames[count == 0 ? 0 : 1];
		if (zmq_msg_recv(frame, socket, ZMQ_DONTWAIT) < 0)
			break;
		count++;
		more = zmq_msg_more(frame) != 0;
	}
	return count;
}

enum gz_result gz_inlet_receive(struct gz_inlet *inlet, struct gz_inlet_message *out_message)
{
	zmq_msg_t frame[2];
	zmq_msg_init(&frame[0]);
	zmq_msg_init(&frame[1]);
	enum gz_result result = GZ_ERR_TIMEOUT;
	/* Skip at most a queue full of refused messages in one call. */
	for (int i = 0; i < QUEUE && result != GZ_OK; i++) {
		int frames = gz_inlet_receive_frames(inlet->socket, frame);
		if (frames == 0)
			break;
		result = frames != 2
				 ? GZ_ERR_PROTOCOL
				 : gz_inlet_judge(zmq_msg_data(&frame[0]), zmq_msg_size(&frame[0]),
						  zmq_msg_data(&frame[1]), zmq_msg_size(&frame[1]),
						  gz_clock_now_ns(), out_message);
		if (result != GZ_OK)
			warn_of_refusal(inlet, result);
	}
	zmq_msg_close(&frame[0]);
	zmq_msg_close(&frame[1]);
	return result == GZ_OK ? GZ_OK : GZ_ERR_TIMEOUT;
}

static enum gz_result open_inlet_socket(struct gz_inlet *inlet, const struct gz_network *network)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	int queue = QUEUE, linger = 0;
	int64_t size_max = GZ_INLET_SIZE_MAX;
	inlet->socket = zmq_socket(network->context, ZMQ_SUB);
	if (!inlet->socket ||
	    zmq_setsockopt(inlet->socket, ZMQ_RCVHWM, &queue, sizeof queue) != 0 ||
	    zmq_setsockopt(inlet->socket, ZMQ_LINGER, &linger, sizeof linger) != 0 ||
	    zmq_setsockopt(inlet->socket, ZMQ_MAXMSGSIZE, &size_max, sizeof size_max) != 0 ||
	    zmq_setsockopt(inlet->socket, ZMQ_SUBSCRIBE, "", 0) != 0) {
		gz_err(inlet->log, "cannot open the inlet's socket: %s", zmq_strerror(errno));
		return GZ_ERR_IO;
	}
	gz_network_endpoint(network, network->config->inlet_port, endpoint);
	return gz_network_bind(network, inlet->socket, "inlet", endpoint, &inlet->port, NULL);
}

enum gz_result gz_inlet_create(const struct gz_network *network, struct gz_inlet **out_inlet)
{
	struct gz_inlet *inlet = calloc(1, sizeof *inlet);
	if (!inlet)
		return GZ_ERR_NO_MEM;
	inlet->log = network->log;
	enum gz_result result = open_inlet_socket(inlet, network);
	if (result != GZ_OK) {
		gz_inlet_destroy(&inlet);
		return result;
	}
	*out_inlet = inlet;
	return GZ_OK;
}

int gz_inlet_port(const struct gz_inlet *inlet)
{
	return inlet->port;
}

void *gz_inlet_socket(const struct gz_inlet *inlet)
{
	return inlet->socket;
}

void gz_inlet_destroy(struct gz_inlet **inlet)
{
	if (!inlet || !*inlet)
		return;
	if ((*inlet)->socket) {
		zmq_socket_monitor((*inlet)->socket, NULL, 0);
		zmq_close((*inlet)->socket);
	}
	free(*inlet);
	*inlet = NULL;
}

int64_t gz_viewer_time_ns(bool has_time, int64_t time_ns, int64_t now_ns)
{
	bool believable = has_time && time_ns <= now_ns && time_ns > now_ns - GZ_VIEWER_AGE_MAX_NS;
	return believable ? time_ns : now_ns;
}

struct gz_pointer_report gz_viewer_report(const struct gz_viewer_pointer *pointer, int64_t now_ns)
{
	return (struct gz_pointer_report) {
		.host_ns = gz_viewer_time_ns(pointer->has_time, pointer->time_ns, now_ns),
		.known = pointer->known,
		.point = pointer->point,
	};
}

static struct gz_gaze_log_record window_record(const int *rect_px, int64_t host_ns)
{
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_WINDOW, .host_ns = host_ns };
	memcpy(record.window_px, rect_px, sizeof record.window_px);
	return record;
}

bool gz_viewer_place_step(struct gz_viewer_place *place, const int *rect_px, int64_t host_ns,
			  struct gz_gaze_log_record *out_record)
{
	if (!rect_px) {
		place->known = false;
		return false;
	}
	bool same = place->known && host_ns - place->heard_ns <= GZ_VIEWER_WINDOW_NS &&
		    memcmp(place->rect_px, rect_px, sizeof place->rect_px) == 0;
	place->known = true;
	place->heard_ns = host_ns;
	memcpy(place->rect_px, rect_px, sizeof place->rect_px);
	if (!same)
		*out_record = window_record(rect_px, host_ns);
	return !same;
}

bool gz_viewer_place_at_start(const struct gz_viewer_place *place, int64_t now_ns,
			      struct gz_gaze_log_record *out_record)
{
	if (!place->known || now_ns - place->heard_ns > GZ_VIEWER_WINDOW_NS)
		return false;
	*out_record = window_record(place->rect_px, now_ns);
	return true;
}
