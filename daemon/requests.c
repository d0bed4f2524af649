#include "daemon/requests.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "daemon/inlet.h"
#include "daemon/recorder.h"
#include "daemon/remote.h"
#include "daemon/service.h"

#define GZ_LOG_MODULE "control"

/* Longest request accepted, bytes; libzmq closes the connection of a client that sends more. */
static const int64_t REQUEST_SIZE_MAX = 65536;

/* Requests and answers that libzmq keeps of one client; it reads no more from a client with that
 * many requests, and drops further answers to one that does not read. Chosen: more answers than
 * requests, because libzmq may be late to send them. */
enum { REQUEST_QUEUE = 64, ANSWER_QUEUE = 256 };

/* Room for an answer with its NUL: a path and a sentence. */
enum { ANSWER_SIZE = GZ_PATH_SIZE + 256 };

/* Most messages from clients that are passed on before the next request is served. */
enum { MESSAGES_AT_ONCE = 32 };

/* Shortest time between two warnings that a viewer's pointer has no use. Chosen: a viewer sends it
 * sixty times a second. */
#define UNREAD_POINTER_NS (60 * GZ_NS_PER_S)

/* Most frames before a request's text: the client's identity, one for each proxy between, and the
 * empty one. Chosen. */
enum { ENVELOPE_MAX = 8 };

/* Most bytes of each: a client's identity has no more (zmq_setsockopt(3), ZMQ_ROUTING_ID). */
enum { ENVELOPE_FRAME_MAX = 255 };

/* What the next answer waits for. */
enum pending {
	PENDING_NONE,
	PENDING_CORRECT, /* that the service has reloaded the correction */
	PENDING_START,   /* that the service has begun the recording */
	PENDING_STOP,    /* that the service has asked the recorder to end the recording */
	PENDING_FINISH,  /* that the recorder has ended the recording */
	PENDING_RESTART, /* the same, before the next recording can begin */
};

struct gz_requests {
	struct gz_requests_parts parts;
	/* ROUTER: a REP socket loses the next client's answer when a client sends a message without
	 * the empty frame and leaves (libzmq 4.3.4: router_t::rollback() forgets _more_out). */
	void *control;
	void *commands; /* PAIR, to the service */
	struct gz_inlet *inlet;
	struct gz_inlet_message message;          /* the message being served; large */
	const struct gz_connections *connections; /* of control */
	int port;
	int stream_port;
	int latest_port;
	enum pending pending;
	bool owed; /* a client waits for an answer; otherwise a notification asked */
	zmq_msg_t envelope[ENVELOPE_MAX]; /* of that answer */
	int envelope_count;
	uint32_t number; /* of the newest command to the service */
	int pending_fd;
	char pending_path[GZ_PATH_SIZE];
	char pending_name[GZ_REMOTE_REQUEST_SIZE];
	int64_t deadline_ns;
	/* What a notification asked for while something was pending; done next. */
	enum gz_remote_notice deferred;
	char deferred_name[GZ_SESSION_NAME_SIZE];
	struct gz_ratelimit unread_pointer;
	bool ended;             /* the replay is over */
	enum gz_result failure; /* why the service had to stop */
};

static void drop_envelope(struct gz_requests *requests)
{
	while (requests->envelope_count > 0)
		zmq_msg_close(&requests->envelope[--requests->envelope_count]);
}

/* Receive a frame of the envelope. @param is_first  libzmq has added it. @return whether there was
 * one */
static bool receive_envelope_frame(struct gz_requests *requests, zmq_msg_t *frame, bool is_first)
{
	bool received = zmq_msg_recv(frame, requests->control, ZMQ_DONTWAIT) >= 0;
	if (received && !is_first)
		gz_connections_took(requests->connections, frame);
	else if (!received)
		gz_connections_emptied(requests->connections);
	return received;
}

/* Receive the frames up to the empty one, which the answer repeats. A message that has none, or too
 * many or too long ones before it, is dropped: nobody waits for its answer.
 * @return whether a request follows */
static bool receive_envelope(struct gz_requests *requests)
{
	bool more = true, bottom = false, is_short = true;
	drop_envelope(requests);
	while (more && !bottom && is_short && requests->envelope_count < ENVELOPE_MAX) {
		zmq_msg_t *frame = &requests->envelope[requests->envelope_count];
		zmq_msg_init(frame);
		requests->envelope_count++;
		if (!receive_envelope_frame(requests, frame, requests->envelope_count == 1)) {
			drop_envelope(requests);
			return false;
		}
		more = zmq_msg_more(frame) != 0;
		bottom = zmq_msg_size(frame) == 0;
		is_short = zmq_msg_size(frame) <= ENVELOPE_FRAME_MAX;
	}
	if (bottom && more)
		return true;
	drop_envelope(requests);
	while (more) {
		zmq_msg_t rest;
		zmq_msg_init(&rest);
		more = receive_envelope_frame(requests, &rest, false) && zmq_msg_more(&rest);
		zmq_msg_close(&rest);
	}
	return false;
}

/* The frames of the envelope, then the text. libzmq drops the answer to a client that has left. */
static bool send_answer(struct gz_requests *requests, const char *text)
{
	for (int i = 0; i < requests->envelope_count; i++) {
		if (zmq_msg_send(&requests->envelope[i], requests->control,
				 ZMQ_SNDMORE | ZMQ_DONTWAIT) < 0)
			return false;
	}
	return zmq_send(requests->control, text, strlen(text), ZMQ_DONTWAIT) >= 0;
}

static void reply(struct gz_requests *requests, const char *text)
{
	requests->pending = PENDING_NONE;
	if (!requests->owed) {
		/* Nobody waits for it: a notification has no answer, so a refusal is logged. */
		if (strcmp(text, "OK") != 0)
			gz_warn(requests->parts.log, "a notification was not followed: %s", text);
		return;
	}
	requests->owed = false;
	if (!send_answer(requests, text))
		gz_debug(requests->parts.log, "cannot send an answer: %s", zmq_strerror(errno));
	drop_envelope(requests);
}

static void reply_port(struct gz_requests *requests, int port, const char *channel)
{
	char text[ANSWER_SIZE];
	if (port > 0)
		snprintf(text, sizeof text, "%d", port);
	else
		snprintf(text, sizeof text, "TCP is off; use ipc://%s/%s",
			 requests->parts.directory, channel);
	reply(requests, text);
}

static bool send_command(struct gz_requests *requests, const struct gz_command *command)
{
	return zmq_send(requests->commands, command, sizeof *command, ZMQ_DONTWAIT) ==
	       (int)sizeof *command;
}

static void await_service(struct gz_requests *requests, enum pending pending)
{
	requests->pending = pending;
	requests->deadline_ns = gz_clock_now_ns() + GZ_REQUESTS_PATIENCE_MS * GZ_NS_PER_MS;
}

static void start_recording(struct gz_requests *requests, const char *name)
{
	char directory[GZ_PATH_SIZE], text[ANSWER_SIZE];
	struct gz_command command = { .kind = GZ_COMMAND_RECORD, .number = ++requests->number };
	struct gz_recorder_status status;
	gz_recorder_get_status(requests->parts.recorder, &status);
	if (status.finishing) {
		snprintf(requests->pending_name, sizeof requests->pending_name, "%s", name);
		await_service(requests, PENDING_RESTART);
		return;
	}
	if (status.state == GZ_RECORDING_ON) {
		reply(requests, "a recording is running; end it first (gazectl stop, or r)");
		return;
	}
	if (gz_config_recording_directory(requests->parts.config, requests->parts.log, directory,
					  sizeof directory) != GZ_OK) {
		reply(requests, "there is no directory for recordings; set recording.directory");
		return;
	}
	if (gz_recording_create(directory, name, &command.fd, command.path, text, sizeof text) !=
	    GZ_OK) {
		gz_warn(requests->parts.log, "cannot record: %s", text);
		reply(requests, text);
		return;
	}
	if (!send_command(requests, &command)) {
		close(command.fd);
		unlink(command.path);
		reply(requests, "the daemon is busy; try again");
		return;
	}
	requests->pending_fd = command.fd;
	memcpy(requests->pending_path, command.path, sizeof requests->pending_path);
	await_service(requests, PENDING_START);
}

static void stop_recording(struct gz_requests *requests)
{
	struct gz_command command = { .kind = GZ_COMMAND_STOP, .number = ++requests->number };
	struct gz_recorder_status status;
	gz_recorder_get_status(requests->parts.recorder, &status);
	if (status.state != GZ_RECORDING_ON)
		reply(requests, "no recording is running");
	else if (!send_command(requests, &command))
		reply(requests, "the daemon is busy; try again");
	else
		await_service(requests, PENDING_STOP);
}

/* Send a message to all readers of the stream, and its mark, if it has one, to the gaze log.
 * @return whether there was room for it in the queue to the service: samples have priority */
static bool forward_message(struct gz_requests *requests, const struct gz_command *command,
			    const void *body, size_t size)
{
	/* What is sent with ZMQ_SNDMORE has room for its last frame too. */
	return zmq_send(requests->commands, command, sizeof *command, ZMQ_SNDMORE | ZMQ_DONTWAIT) >=
		       0 &&
	       zmq_send(requests->commands, body, size, ZMQ_DONTWAIT) >= 0;
}

/* Send a message of the daemon's own to all readers. */
static void send_to_readers(struct gz_requests *requests, const char *topic,
			    const struct gz_wire_message *message)
{
	struct gz_command command = { .kind = GZ_COMMAND_SEND };
	snprintf(command.topic, sizeof command.topic, "%s", topic);
	if (!forward_message(requests, &command, message->bytes, message->size))
		gz_warn(requests->parts.log, "%s is not sent: the daemon is busy", topic);
}

static const char no_calibration[] = "this tracker is calibrated by its own software, not by gazed";

/* A client that asked for a calibration may wait for its end. */
static void send_calibration_failed(struct gz_requests *requests)
{
	struct gz_wire_message message;
	if (gz_wire_encode_calibration_failed(no_calibration, gz_clock_now_ns(), &message) == GZ_OK)
		send_to_readers(requests, GZ_TOPIC_NOTIFY GZ_SUBJECT_CALIBRATION_FAILED, &message);
}

static void send_doc(struct gz_requests *requests)
{
	struct gz_wire_message message;
	if (gz_wire_encode_doc("gazed", gz_remote_doc(), &message) == GZ_OK)
		send_to_readers(requests, GZ_TOPIC_NOTIFY GZ_SUBJECT_DOC, &message);
}

/* Make the service read the stored correction again; its file may have changed. */
static void reload_correction(struct gz_requests *requests)
{
	struct gz_command command = { .kind = GZ_COMMAND_CORRECT, .number = ++requests->number };
	if (!send_command(requests, &command))
		reply(requests, "the daemon is busy; try again");
	else
		await_service(requests, PENDING_CORRECT);
}

static void serve_request(struct gz_requests *requests, const struct gz_remote_request *request)
{
	char text[ANSWER_SIZE];
	switch (request->kind) {
	case GZ_REMOTE_RECORD:
		start_recording(requests, request->name);
		return;
	case GZ_REMOTE_STOP:
		stop_recording(requests);
		return;
	case GZ_REMOTE_TIME:
		snprintf(text, sizeof text, "%.9f", gz_ns_to_s(gz_clock_now_ns()));
		reply(requests, text);
		return;
	case GZ_REMOTE_SET_TIME:
		reply(requests, "the time is this machine's monotonic clock, which cannot be set; "
				"read it with t and keep the difference");
		return;
	case GZ_REMOTE_VERSION:
		reply(requests, GAZECAST_VERSION);
		return;
	case GZ_REMOTE_STREAM_PORT:
		reply_port(requests, requests->stream_port, "stream");
		return;
	case GZ_REMOTE_LATEST_PORT:
		reply_port(requests, requests->latest_port, "latest");
		return;
	case GZ_REMOTE_INLET_PORT:
		reply_port(requests, gz_inlet_port(requests->inlet), "inlet");
		return;
	case GZ_REMOTE_CORRECTION:
		reload_correction(requests);
		return;
	case GZ_REMOTE_CALIBRATE:
		reply(requests, no_calibration);
		send_calibration_failed(requests);
		return;
	case GZ_REMOTE_CALIBRATION_STOP:
		reply(requests, no_calibration);
		return;
	case GZ_REMOTE_UNKNOWN:
		reply(requests, "unknown command");
		return;
	}
}

/* The service has answered the newest command. */
static void take_service_answer(struct gz_requests *requests, enum gz_result result)
{
	char text[ANSWER_SIZE];
	if (requests->pending == PENDING_STOP) {
		requests->pending = PENDING_FINISH;
		return;
	}
	if (result == GZ_OK) {
		if (requests->pending == PENDING_START || requests->pending == PENDING_CORRECT)
			reply(requests, "OK");
		return;
	}
	/* The service refused to record: remove the file that will not be written. */
	close(requests->pending_fd);
	unlink(requests->pending_path);
	snprintf(text, sizeof text, "not recording: %s", gz_result_text(result));
	if (requests->pending == PENDING_START)
		reply(requests, text);
}

static void take_notices(struct gz_requests *requests)
{
	struct gz_notice notice;
	while (zmq_recv(requests->commands, &notice, sizeof notice, ZMQ_DONTWAIT) ==
	       (int)sizeof notice) {
		if (notice.kind == GZ_NOTICE_ENDED)
			requests->ended = true;
		else if (notice.kind == GZ_NOTICE_FAILED)
			requests->failure = notice.result;
		else if (notice.number == requests->number)
			take_service_answer(requests, notice.result);
	}
}

/* Answer a request to end a recording once the recording has ended, so that its file is complete by
 * then. */
static void check_finished(struct gz_requests *requests)
{
	char text[ANSWER_SIZE];
	struct gz_recorder_status status;
	if (requests->pending != PENDING_FINISH && requests->pending != PENDING_RESTART)
		return;
	gz_recorder_get_status(requests->parts.recorder, &status);
	if (status.state == GZ_RECORDING_ON)
		return;
	if (requests->pending == PENDING_RESTART) {
		start_recording(requests, requests->pending_name);
	} else if (status.state == GZ_RECORDING_OFF) {
		reply(requests, "OK");
	} else {
		snprintf(text, sizeof text, "failed: %s", status.error);
		reply(requests, text);
	}
}

/* Time until the pending answer is due, ms; -1 if none is pending. An overdue answer is sent now:
 * the action is under way, and the status shows when it is done. */
static long milliseconds_left(struct gz_requests *requests)
{
	if (requests->pending == PENDING_NONE)
		return -1;
	int64_t left_ns = requests->deadline_ns - gz_clock_now_ns();
	if (left_ns > 0)
		return (long)(left_ns / GZ_NS_PER_MS) + 1;
	reply(requests, requests->pending == PENDING_RESTART
				? "the previous recording is still being written; try again"
				: "OK");
	return 0;
}

/* Do what a notification asked for, once nothing else is pending. */
static void act_on_deferred(struct gz_requests *requests)
{
	enum gz_remote_notice notice = requests->deferred;
	if (requests->pending != PENDING_NONE)
		return;
	requests->deferred = GZ_REMOTE_NOTICE_OTHER;
	if (notice == GZ_REMOTE_NOTICE_RECORD)
		start_recording(requests, requests->deferred_name);
	else if (notice == GZ_REMOTE_NOTICE_STOP)
		stop_recording(requests);
}

static void act_on_notification(struct gz_requests *requests,
				const struct gz_notification *notification)
{
	enum gz_remote_notice notice = gz_remote_notice(notification->subject);
	switch (notice) {
	case GZ_REMOTE_NOTICE_RECORD:
	case GZ_REMOTE_NOTICE_STOP:
		if (requests->deferred != GZ_REMOTE_NOTICE_OTHER) {
			gz_warn(requests->parts.log,
				"%s: ignored, because an earlier notification is still waiting",
				notification->subject);
			return;
		}
		requests->deferred = notice;
		memcpy(requests->deferred_name, notification->session_name,
		       sizeof requests->deferred_name);
		act_on_deferred(requests);
		return;
	case GZ_REMOTE_NOTICE_CALIBRATE:
		send_calibration_failed(requests);
		return;
	case GZ_REMOTE_NOTICE_DOC:
		send_doc(requests);
		return;
	case GZ_REMOTE_NOTICE_OTHER:
		return;
	}
}

/* Hand the pointer's position to the driver "pointer" or to the simulated viewer, who looks there.
 * It is not sent to readers: they get the gaze that the driver makes of it. */
static void feed_pointer_driver(struct gz_requests *requests,
				const struct gz_viewer_pointer *pointer)
{
	const struct gz_requests_parts *parts = &requests->parts;
	uint64_t held_back;
	int64_t now_ns = gz_clock_now_ns();
	struct gz_pointer_report report = gz_viewer_report(pointer, now_ns);
	const char *driver = parts->config->driver;
	if (strcmp(driver, "pointer") == 0 || strcmp(driver, "sim") == 0)
		gz_pointer_feed_put(parts->pointer, &report);
	else if (gz_ratelimit_pass(&requests->unread_pointer, now_ns, UNREAD_POINTER_NS,
				   &held_back))
		gz_warn(parts->log,
			"a viewer sends its pointer, but the driver is %s, which ignores it; to "
			"use "
			"the mouse as gaze, start gazed with --driver pointer",
			parts->config->driver);
}

static void report_window(struct gz_requests *requests, const struct gz_viewer_window *window)
{
	struct gz_command command = {
		.kind = GZ_COMMAND_WINDOW,
		.host_ns = gz_viewer_time_ns(window->has_time, window->time_ns, gz_clock_now_ns()),
		.window = *window,
	};
	send_command(requests, &command);
}

/* Pass a client's message on to all readers, and into the gaze log if it is an annotation or a
 * window. @return whether there was room for it; if not, nothing has happened */
static bool pass_on(struct gz_requests *requests, const struct gz_inlet_message *message)
{
	struct gz_command command = { .kind = GZ_COMMAND_SEND,
				      .host_ns = message->mark_ns,
				      .has_mark = message->is_mark };
	if (message->is_pointer) {
		feed_pointer_driver(requests, &message->pointer);
		return true;
	}
	memcpy(command.topic, message->topic, sizeof command.topic);
	if (message->is_mark) {
		command.duration_ns = message->mark_duration_ns;
		memcpy(command.text, message->mark, sizeof command.text);
		memcpy(command.keys, message->mark_keys, sizeof command.keys);
	}
	if (!forward_message(requests, &command, message->body, message->size))
		return false;
	if (message->is_window) /* the viewer repeats it, so it may be dropped */
		report_window(requests, &message->window);
	return true;
}

static void pass_on_messages(struct gz_requests *requests)
{
	struct gz_inlet_message *message = &requests->message;
	gz_inlet_collect(requests->inlet);
	for (int i = 0; i < MESSAGES_AT_ONCE && gz_inlet_next(requests->inlet, message) == GZ_OK;
	     i++) {
		if (!pass_on(requests, message))
			return; /* it stays in the queue */
		gz_inlet_done(requests->inlet);
		if (message->is_notification)
			act_on_notification(requests, &message->notification);
	}
}

/* Whether a notification that asks for a recording gives a valid name, or none. */
static bool session_name_allowed(const struct gz_notification *notification)
{
	return gz_remote_notice(notification->subject) != GZ_REMOTE_NOTICE_RECORD ||
	       notification->session_name[0] == '\0' ||
	       gz_recording_name_valid(notification->session_name);
}

/* Serve a message of two frames on the control socket like one on the inlet, and confirm it. */
static void serve_client_message(struct gz_requests *requests, zmq_msg_t *topic, zmq_msg_t *body)
{
	struct gz_inlet_message *message = &requests->message;
	enum gz_result result =
		gz_inlet_judge(zmq_msg_data(topic), zmq_msg_size(topic), zmq_msg_data(body),
			       zmq_msg_size(body), gz_clock_now_ns(), message);
	struct gz_inlet_counts *counts = requests->parts.inlet_counts;
	if (result != GZ_OK) {
		atomic_fetch_add_explicit(&counts->refused, 1, memory_order_relaxed);
		reply(requests, gz_inlet_refusal(result));
		return;
	}
	if (message->is_notification && !session_name_allowed(&message->notification)) {
		reply(requests, "refused: this is not a valid name for a recording; allowed: 1 to "
				"64 of A-Z a-z 0-9 . _ -");
		return;
	}
	if (!pass_on(requests, message)) {
		atomic_fetch_add_explicit(&counts->overflow, 1, memory_order_relaxed);
		reply(requests, "the daemon is busy; try again");
		return;
	}
	reply(requests, message->is_notification ? "Notification received" : "Message forwarded.");
	if (message->is_notification)
		act_on_notification(requests, &message->notification);
}

/* Receive and serve one request: a frame of text, or a topic and a MessagePack map. */
static void receive_request(struct gz_requests *requests)
{
	zmq_msg_t frames[2];
	struct gz_remote_request request;
	if (!receive_envelope(requests))
		return;
	zmq_msg_init(&frames[0]);
	zmq_msg_init(&frames[1]);
	int count = gz_inlet_receive_frames(requests->control, requests->connections, frames);
	requests->owed = count > 0;
	if (count == 1) {
		gz_remote_parse(zmq_msg_data(&frames[0]), zmq_msg_size(&frames[0]), &request);
		serve_request(requests, &request);
	} else if (count == 2) {
		serve_client_message(requests, &frames[0], &frames[1]);
	} else if (count > 2) {
		reply(requests, gz_inlet_refusal(GZ_ERR_PROTOCOL));
	}
	zmq_msg_close(&frames[0]);
	zmq_msg_close(&frames[1]);
}

static void forget_event(int fd)
{
	uint64_t count;
	ssize_t n = read(fd, &count, sizeof count);
	(void)n;
}

enum gz_result gz_requests_run(struct gz_requests *requests, int signal_fd)
{
	zmq_pollitem_t items[] = {
		{ .fd = signal_fd, .events = ZMQ_POLLIN },
		{ .fd = gz_recorder_event_fd(requests->parts.recorder), .events = ZMQ_POLLIN },
		{ .socket = requests->commands, .events = ZMQ_POLLIN },
		{ .socket = gz_inlet_socket(requests->inlet), .events = ZMQ_POLLIN },
		{ .socket = requests->control, .events = ZMQ_POLLIN },
	};
	for (;;) {
		long timeout_ms = milliseconds_left(requests);
		bool waits = gz_inlet_waits(requests->inlet);
		items[2].events = (short)(ZMQ_POLLIN | (waits ? ZMQ_POLLOUT : 0));
		/* One request at a time: the next waits until this one is answered. */
		int count = requests->pending == PENDING_NONE ? 5 : 4;
		if (zmq_poll(items, count, timeout_ms) < 0 && errno != EINTR)
			return GZ_ERR_IO;
		if (items[0].revents)
			return GZ_OK;
		if (items[1].revents)
			forget_event(items[1].fd);
		take_notices(requests);
		check_finished(requests);
		act_on_deferred(requests);
		pass_on_messages(requests);
		bool leave = requests->ended && requests->parts.config->exit_at_end;
		if (leave || requests->failure != GZ_OK)
			return requests->failure;
		if (requests->pending == PENDING_NONE)
			receive_request(requests);
	}
}

void gz_requests_quit_service(struct gz_requests *requests)
{
	struct gz_command command = { .kind = GZ_COMMAND_QUIT };
	/* Waits if the queue is full; the service empties it. */
	zmq_send(requests->commands, &command, sizeof command, 0);
}

static enum gz_result open_request_sockets(struct gz_requests *requests)
{
	int linger = 0, control_linger = GZ_REQUESTS_PATIENCE_MS;
	requests->control = zmq_socket(requests->parts.context, ZMQ_ROUTER);
	requests->commands = zmq_socket(requests->parts.context, ZMQ_PAIR);
	const int request_queue = REQUEST_QUEUE, answer_queue = ANSWER_QUEUE;
	if (!requests->control || !requests->commands ||
	    zmq_setsockopt(requests->control, ZMQ_RCVHWM, &request_queue, sizeof request_queue) !=
		    0 ||
	    zmq_setsockopt(requests->control, ZMQ_SNDHWM, &answer_queue, sizeof answer_queue) !=
		    0 ||
	    zmq_setsockopt(requests->control, ZMQ_MAXMSGSIZE, &REQUEST_SIZE_MAX,
			   sizeof REQUEST_SIZE_MAX) != 0 ||
	    zmq_setsockopt(requests->control, ZMQ_LINGER, &control_linger, sizeof control_linger) !=
		    0 ||
	    zmq_setsockopt(requests->commands, ZMQ_LINGER, &linger, sizeof linger) != 0 ||
	    zmq_bind(requests->commands, GZ_COMMAND_ENDPOINT) != 0) {
		gz_err(requests->parts.log, "cannot open the control socket: %s",
		       zmq_strerror(errno));
		return GZ_ERR_IO;
	}
	return gz_network_bind(requests->parts.network, requests->control, "control",
			       requests->parts.config->control_endpoint, &requests->port,
			       &requests->connections);
}

enum gz_result gz_requests_create(const struct gz_requests_parts *parts,
				  struct gz_requests **out_requests)
{
	struct gz_requests *requests = calloc(1, sizeof *requests);
	if (!requests)
		return GZ_ERR_NO_MEM;
	requests->parts = *parts;
	requests->stream_port = gz_publisher_port(parts->publisher);
	requests->latest_port = gz_publisher_latest_port(parts->publisher);
	enum gz_result result = open_request_sockets(requests);
	if (result == GZ_OK)
		result = gz_inlet_create(parts->network, parts->inlet_counts, &requests->inlet);
	if (result != GZ_OK) {
		gz_requests_destroy(&requests);
		return result;
	}
	*out_requests = requests;
	return GZ_OK;
}

int gz_requests_port(const struct gz_requests *requests)
{
	return requests->port;
}

void gz_requests_destroy(struct gz_requests **requests)
{
	if (!requests || !*requests)
		return;
	gz_inlet_destroy(&(*requests)->inlet);
	drop_envelope(*requests);
	if ((*requests)->control) {
		zmq_socket_monitor((*requests)->control, NULL, 0);
		zmq_close((*requests)->control);
	}
	if ((*requests)->commands)
		zmq_close((*requests)->commands);
	free(*requests);
	*requests = NULL;
}
