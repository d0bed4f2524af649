#include "daemon/inlet.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "daemon/message_queue.h"
#include "protocol/endpoint.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "inlet"

/* Messages that libzmq keeps of one client until they are collected. It reads no more from that
 * client meanwhile, and the client's libzmq drops what it cannot send. */
enum { SOCKET_QUEUE = 256 };

/* Most messages collected at once, so that requests are answered in time. Chosen: a millisecond's.
 */
enum { COLLECTED_AT_ONCE = 1024 };

struct gz_inlet {
	const struct gz_log *log;
	void *socket;
	int port;
	const struct gz_connections *connections;
	struct gz_message_queue *queue;
	struct gz_inlet_counts *counts;
	struct gz_ratelimit complaints;
	struct gz_ratelimit overflows;
};

static bool topic_begins_with(const char *text, const char *beginning)
{
	return strncmp(text, beginning, strlen(beginning)) == 0;
}

static bool begins_with_one_of(const char *text, const char *const *beginnings, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (topic_begins_with(text, beginnings[i]))
			return true;
	}
	return false;
}

/* A reader subscribes to the beginning of a topic, so a client's topic must not begin with what
 * readers of the daemon's messages ask for: the first word, and that without its plural. */
static bool is_reserved_topic(const char *topic)
{
	static const char *const reserved[] = {
		"gaze",  "pupil",   "surface", "fixation",
		"blink", "saccade", "status",  GZ_TOPIC_EVENT_FINAL
	};
	return begins_with_one_of(topic, reserved, sizeof reserved / sizeof *reserved);
}

/* What the daemon, or Pupil Capture in its place, reports: how calibrations and recordings go. */
static bool is_reserved_subject(const char *subject)
{
	static const char *const reserved[] = {
		"calibration.started",        "calibration.stopped",
		"calibration.successful",     "calibration.failed",
		"calibration.setup",          "calibration.result",
		GZ_SUBJECT_RECORDING_STARTED, GZ_SUBJECT_RECORDING_STOPPED,
	};
	return begins_with_one_of(subject, reserved, sizeof reserved / sizeof *reserved);
}

static bool is_reserved(const char *topic)
{
	static const size_t prefix = sizeof GZ_TOPIC_NOTIFY - 1;
	return is_reserved_topic(topic) ||
	       (topic_begins_with(topic, GZ_TOPIC_NOTIFY) && is_reserved_subject(topic + prefix));
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
	out_message->mark_duration_ns = annotation.duration_ns;
	snprintf(out_message->mark, sizeof out_message->mark, "%s", annotation.label);
	snprintf(out_message->mark_keys, sizeof out_message->mark_keys, "%s", annotation.keys);
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
	if (is_reserved(text))
		return GZ_ERR_ACCESS;
	if (topic_begins_with(text, GZ_TOPIC_ANNOTATION)) {
		struct gz_inlet_message mark;
		if (read_annotation(body, body_size, now_ns, &mark) != GZ_OK)
			return GZ_ERR_PROTOCOL;
		out_message->mark_ns = mark.mark_ns;
		out_message->mark_duration_ns = mark.mark_duration_ns;
		memcpy(out_message->mark, mark.mark, sizeof mark.mark);
		memcpy(out_message->mark_keys, mark.mark_keys, sizeof mark.mark_keys);
	}
	bool is_notification = topic_begins_with(text, GZ_TOPIC_NOTIFY);
	if (is_notification &&
	    gz_wire_decode_notification(body, body_size, &out_message->notification) != GZ_OK)
		return GZ_ERR_PROTOCOL;
	if (is_notification && is_reserved_subject(out_message->notification.subject))
		return GZ_ERR_ACCESS;
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
	return result == GZ_ERR_ACCESS ? "refused: this topic or subject is reserved for the daemon"
				       : "refused: a message must be a topic and one MessagePack "
					 "map; an annotation "
					 "needs a label, a notification a subject";
}

static void note_refusal(struct gz_inlet *inlet, enum gz_result result)
{
	uint64_t held_back;
	atomic_fetch_add_explicit(&inlet->counts->refused, 1, memory_order_relaxed);
	if (!gz_ratelimit_pass(&inlet->complaints, gz_clock_now_ns(), GZ_NS_PER_S, &held_back))
		return;
	gz_warn(inlet->log, "client bug: a message %s; dropped (%llu more since the last message)",
		result == GZ_ERR_ACCESS ? "has a topic or subject that is reserved for the daemon"
					: "is not a topic and a MessagePack map",
		(unsigned long long)held_back);
}

static void note_overflow(struct gz_inlet *inlet)
{
	uint64_t held_back;
	atomic_fetch_add_explicit(&inlet->counts->overflow, 1, memory_order_relaxed);
	if (gz_ratelimit_pass(&inlet->overflows, gz_clock_now_ns(), GZ_NS_PER_S, &held_back))
		gz_warn(inlet->log,
			"clients publish faster than their messages can be passed on; one is "
			"dropped (%llu more since the last message)",
			(unsigned long long)held_back);
}

int gz_inlet_receive_frames(void *socket, const struct gz_connections *connections,
			    zmq_msg_t frames[2])
{
	int count = 0;
	bool more = true;
	while (more) {
		zmq_msg_t *frame = &frames[count == 0 ? 0 : 1];
		if (zmq_msg_recv(frame, socket, ZMQ_DONTWAIT) < 0)
			break;
		gz_connections_took(connections, frame);
		count++;
		more = zmq_msg_more(frame) != 0;
	}
	return count;
}

/* Put a message with two frames into the queue. */
static void queue_message(struct gz_inlet *inlet, zmq_msg_t frames[2])
{
	const struct gz_queued_message message = {
		.topic = zmq_msg_data(&frames[0]),
		.topic_size = zmq_msg_size(&frames[0]),
		.body = zmq_msg_data(&frames[1]),
		.body_size = zmq_msg_size(&frames[1]),
	};
	if (!gz_message_queue_push(inlet->queue, &message))
		note_overflow(inlet);
}

void gz_inlet_collect(struct gz_inlet *inlet)
{
	zmq_msg_t frames[2];
	zmq_msg_init(&frames[0]);
	zmq_msg_init(&frames[1]);
	int count = 1;
	for (int i = 0; i < COLLECTED_AT_ONCE && count > 0; i++) {
		count = gz_inlet_receive_frames(inlet->socket, inlet->connections, frames);
		if (count == 2)
			queue_message(inlet, frames);
		else if (count > 0)
			note_refusal(inlet, GZ_ERR_PROTOCOL);
	}
	if (count == 0)
		gz_connections_emptied(inlet->connections);
	zmq_msg_close(&frames[0]);
	zmq_msg_close(&frames[1]);
}

enum gz_result gz_inlet_next(struct gz_inlet *inlet, struct gz_inlet_message *out_message)
{
	struct gz_queued_message message;
	while (gz_message_queue_front(inlet->queue, &message)) {
		enum gz_result result =
			gz_inlet_judge(message.topic, message.topic_size, message.body,
				       message.body_size, gz_clock_now_ns(), out_message);
		if (result == GZ_OK)
			return GZ_OK;
		note_refusal(inlet, result);
		gz_message_queue_pop(inlet->queue);
	}
	return GZ_ERR_TIMEOUT;
}

void gz_inlet_done(struct gz_inlet *inlet)
{
	gz_message_queue_pop(inlet->queue);
}

bool gz_inlet_waits(const struct gz_inlet *inlet)
{
	struct gz_queued_message message;
	return gz_message_queue_front(inlet->queue, &message);
}

static enum gz_result open_inlet_socket(struct gz_inlet *inlet, const struct gz_network *network)
{
	char endpoint[GZ_ENDPOINT_SIZE];
	int queue = SOCKET_QUEUE, linger = 0;
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
	return gz_network_bind(network, inlet->socket, "inlet", endpoint, &inlet->port,
			       &inlet->connections);
}

enum gz_result gz_inlet_create(const struct gz_network *network, struct gz_inlet_counts *counts,
			       struct gz_inlet **out_inlet)
{
	struct gz_inlet *inlet = calloc(1, sizeof *inlet);
	if (!inlet)
		return GZ_ERR_NO_MEM;
	inlet->log = network->log;
	inlet->counts = counts;
	enum gz_result result = gz_message_queue_create(GZ_INLET_QUEUE_SIZE, &inlet->queue);
	if (result == GZ_OK)
		result = open_inlet_socket(inlet, network);
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
	gz_message_queue_destroy(&(*inlet)->queue);
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

void gz_viewer_scenes_step(struct gz_viewer_scenes *scenes, const struct gz_viewer_window *window,
			   int64_t host_ns)
{
	if (!window->known) {
		scenes->any_still = false;
	} else if (window->has_still && window->still_scene) {
		scenes->any_still = true;
		scenes->still_ns = host_ns;
	} else if (window->has_still) {
		scenes->any_moving = true;
		scenes->moving_ns = host_ns;
	}
}

bool gz_viewer_scenes_still(const struct gz_viewer_scenes *scenes, int64_t now_ns)
{
	bool moves = scenes->any_moving && now_ns - scenes->moving_ns <= GZ_VIEWER_WINDOW_NS;
	bool still = scenes->any_still && now_ns - scenes->still_ns <= GZ_VIEWER_WINDOW_NS;
	return still && !moves;
}
