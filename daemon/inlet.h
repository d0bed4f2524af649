/**
 * @file
 * What clients may say to all readers of the stream, as over Pupil's PUB_PORT: messages of two
 * frames, topic and MessagePack map. Annotations also become marks in the log; a viewer's window
 * goes there, too, and its pointer to the driver of that name. Topics that are the
 * daemon's own are refused: nobody but a tracker says where somebody looks.
 */
#ifndef GZ_DAEMON_INLET_H
#define GZ_DAEMON_INLET_H

#include <stdbool.h>
#include <zmq.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/command.h"
#include "daemon/network.h"
#include "protocol/wire_notification.h"
#include "protocol/wire_viewer.h"

/** Largest message, bytes. Chosen: Pupil's notifications are far smaller. */
#define GZ_INLET_SIZE_MAX 16384

/** Longest topic with its NUL, bytes. */
#define GZ_INLET_TOPIC_SIZE 256

/** The inlet. One thread. */
struct gz_inlet;

/** A message that was let in. */
struct gz_inlet_message {
	char topic[GZ_INLET_TOPIC_SIZE];
	size_t size;
	unsigned char body[GZ_INLET_SIZE_MAX];
	bool is_mark; /**< the next two hold something */
	int64_t mark_ns;
	char mark[GZ_GAZE_LOG_TEXT_SIZE];
	bool is_notification; /**< the next one holds something */
	struct gz_notification notification;
	bool is_pointer; /**< the next one holds something */
	struct gz_viewer_pointer pointer;
	bool is_window; /**< the next one holds something */
	struct gz_viewer_window window;
};

/**
 * Bind the channel "inlet".
 *
 * @param network  how; its context, guard and log outlive the inlet
 * @return GZ_OK, GZ_ERR_IO, GZ_ERR_NO_MEM, or as gz_network_bind(); logged
 */
enum gz_result gz_inlet_create(const struct gz_network *network, struct gz_inlet **out_inlet);

/** The TCP port, 0 without TCP. */
int gz_inlet_port(const struct gz_inlet *inlet);

/** The ZeroMQ socket, to be polled for input. */
void *gz_inlet_socket(const struct gz_inlet *inlet);

/**
 * Judge one message.
 *
 * @param topic, topic_size  first frame, untrusted
 * @param body, body_size    second frame, untrusted
 * @param now_ns             host time: of a mark whose annotation has no time
 * @param[out] out_message   written on success only
 * @retval GZ_ERR_ACCESS    the topic is the daemon's own
 * @retval GZ_ERR_PROTOCOL  no topic, too long, or no MessagePack; an annotation without a label, a
 *                          notification without a subject, a pointer or window that cannot be
 */
enum gz_result gz_inlet_judge(const void *topic, size_t topic_size, const void *body,
			      size_t body_size, int64_t now_ns,
			      struct gz_inlet_message *out_message);

/** What to tell a client whose message was refused with @p result by gz_inlet_judge(); static text.
 */
const char *gz_inlet_refusal(enum gz_result result);

/**
 * Receive the frames of one message without waiting; of more than two the last one stays.
 *
 * @param socket  a ZeroMQ socket
 * @param frames  initialised; the caller's to close
 * @return how many there were, 0 if there is no message
 */
int gz_inlet_receive_frames(void *socket, zmq_msg_t frames[2]);

/**
 * Take one message that is let in; others are dropped, and told of once a second. Never waits.
 *
 * @retval GZ_ERR_TIMEOUT  there is none now
 */
enum gz_result gz_inlet_receive(struct gz_inlet *inlet, struct gz_inlet_message *out_message);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_inlet_destroy(struct gz_inlet **inlet);

#endif
