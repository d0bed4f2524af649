/**
 * @file
 * The inlet: messages from clients to all readers of the stream, as over Pupil's PUB_PORT. Each has
 * two frames, a topic and a MessagePack map. An annotation also becomes a mark in the gaze log, the
 * position of a viewer's window a window record, and a viewer's pointer goes to the driver
 * "pointer". The daemon's own topics are refused: only a tracker reports where someone looks.
 */
#ifndef GZ_DAEMON_INLET_H
#define GZ_DAEMON_INLET_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <zmq.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/network.h"
#include "drivers/pointer/pointer_driver.h"
#include "protocol/gaze_log.h"
#include "protocol/wire.h"

/** Largest message, bytes. Chosen: Pupil's notifications are far smaller. */
#define GZ_INLET_SIZE_MAX 16384

/** Longest topic with its NUL, bytes. */
#define GZ_INLET_TOPIC_SIZE 256

/** Room for messages that wait to be passed on, bytes. Chosen: some ten thousand annotations, so
 * that a program may send all of an experiment at once. */
#define GZ_INLET_QUEUE_SIZE (16 * 1024 * 1024)

/** How many messages of clients were dropped, at the inlet and the control socket. Threads: any may
 * read. */
struct gz_inlet_counts {
	_Atomic uint64_t refused;  /**< invalid, or of a topic that is reserved */
	_Atomic uint64_t overflow; /**< valid, but there was no room for them */
};

/** The inlet. One thread. */
struct gz_inlet;

/** A message that was accepted. */
struct gz_inlet_message {
	char topic[GZ_INLET_TOPIC_SIZE];
	size_t size;
	unsigned char body[GZ_INLET_SIZE_MAX];
	bool is_mark;                          /**< the fields mark_ and mark are set */
	int64_t mark_ns;                       /**< host time */
	int64_t mark_duration_ns;              /**< 0 for a moment */
	char mark[GZ_GAZE_LOG_TEXT_SIZE];      /**< text for the gaze log */
	char mark_keys[GZ_GAZE_LOG_KEYS_SIZE]; /**< further keys for the gaze log, JSON */
	bool is_notification;                  /**< notification is set */
	struct gz_notification notification;
	bool is_pointer; /**< pointer is set */
	struct gz_viewer_pointer pointer;
	bool is_window; /**< window is set */
	struct gz_viewer_window window;
};

/**
 * Create the inlet and bind the channel "inlet".
 *
 * @param network         how sockets are bound; its context, guard and log outlive the inlet
 * @param counts          borrowed; the inlet counts there
 * @param[out] out_inlet  owned by the caller: gz_inlet_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_IO      no socket; logged
 * @return else as gz_network_bind()
 */
enum gz_result gz_inlet_create(const struct gz_network *network, struct gz_inlet_counts *counts,
			       struct gz_inlet **out_inlet);

/** The TCP port, 0 without TCP. */
int gz_inlet_port(const struct gz_inlet *inlet);

/** The ZeroMQ socket, to poll for input. */
void *gz_inlet_socket(const struct gz_inlet *inlet);

/**
 * Check and decode one message.
 *
 * @param topic, topic_size  first frame, untrusted
 * @param body, body_size    second frame, untrusted
 * @param now_ns             host time, for a mark whose annotation has no time
 * @param[out] out_message   its topic, size and body are written on success only
 * @retval GZ_ERR_ACCESS    the topic, or a notification's subject, is reserved for what only the
 *                          daemon can know (docs/protocol.md)
 * @retval GZ_ERR_PROTOCOL  the topic is empty or a frame too long; the body is not MessagePack; an
 *                          annotation has no label, a notification no subject; a pointer or window
 *                          is invalid
 *
 * Threads: any.
 */
enum gz_result gz_inlet_judge(const void *topic, size_t topic_size, const void *body,
			      size_t body_size, int64_t now_ns,
			      struct gz_inlet_message *out_message);

/** The answer to a client whose message gz_inlet_judge() refused with @p result; static text. */
const char *gz_inlet_refusal(enum gz_result result);

/**
 * Receive the frames of one message without waiting. If there are more than two, the second place
 * holds the last one.
 *
 * @param socket  a ZeroMQ socket
 * @param connections  its connections, which are told what was taken
 * @param frames  initialised; the caller closes them
 * @return number of frames, 0 if there is no message
 */
int gz_inlet_receive_frames(void *socket, const struct gz_connections *connections,
			    zmq_msg_t frames[2]);

/**
 * Take what clients have sent into the queue. If that is full, the message is dropped, counted, and
 * logged at most once a second. Takes a limited number of messages; never waits.
 */
void gz_inlet_collect(struct gz_inlet *inlet);

/**
 * The oldest message of the queue that is accepted. Those before it are dropped, counted, and
 * logged at most once a second. The message stays the oldest until gz_inlet_done().
 *
 * @retval GZ_ERR_TIMEOUT  there is none
 */
enum gz_result gz_inlet_next(struct gz_inlet *inlet, struct gz_inlet_message *out_message);

/** Remove the oldest message from the queue. */
void gz_inlet_done(struct gz_inlet *inlet);

/** Whether messages wait in the queue. */
bool gz_inlet_waits(const struct gz_inlet *inlet);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_inlet_destroy(struct gz_inlet **inlet);

/*
 * What viewers report about themselves, on its way to the pointer driver and the gaze log. Pure: no
 * clock, no I/O.
 */

/** If a message's time is in the future or older than this, ns, it comes from another clock, and
 * the time of arrival counts instead. Chosen: no queue on one machine delays a message so long. */
#define GZ_VIEWER_AGE_MAX_NS INT64_C(1000000000)

/** If no message about a window came for this long, ns, its viewer is gone and its position is no
 * longer known. Chosen: three of gazeview's messages, which it sends once a second. */
#define GZ_VIEWER_WINDOW_NS INT64_C(3000000000)

/** The host time of a message: its own time if it has one and that is believable, else @p now_ns.
 */
int64_t gz_viewer_time_ns(bool has_time, int64_t time_ns, int64_t now_ns);

/** The report for the pointer driver from a message that arrived at @p now_ns. */
struct gz_pointer_report gz_viewer_report(const struct gz_viewer_pointer *pointer, int64_t now_ns);

/** What is known about the viewer's window. Zero-initialised: nothing. */
struct gz_viewer_place {
	bool known;
	int rect_px[4];   /**< x y w h on the display, px */
	int64_t heard_ns; /**< host time of the newest message */
};

/**
 * Take note of a message about the window.
 *
 * @param rect_px  x y w h; NULL if the window is closed
 * @param host_ns  its time, from gz_viewer_time_ns()
 * @param[out] out_record  a record for the gaze log; written only on true
 * @return whether the window's position is new and belongs into the log
 */
bool gz_viewer_place_step(struct gz_viewer_place *place, const int *rect_px, int64_t host_ns,
			  struct gz_gaze_log_record *out_record);

/**
 * The window's position for a recording that begins at @p now_ns.
 *
 * @param[out] out_record  the recording's first record; written only on true
 * @return whether the position is known
 */
bool gz_viewer_place_at_start(const struct gz_viewer_place *place, int64_t now_ns,
			      struct gz_gaze_log_record *out_record);

/** What viewers have said about their scenes. Zero-initialised: nothing. Viewers are not told
 * apart: a scene that moves counts against all that are still. */
struct gz_viewer_scenes {
	bool any_still, any_moving;
	int64_t still_ns;  /**< host time of the newest message of a viewer whose scene is still */
	int64_t moving_ns; /**< of one whose scene moves */
};

/**
 * Take note of a message about a window.
 *
 * @param window   a closed one takes back that a scene is still: other viewers repeat themselves
 *                 within a second
 * @param host_ns  its time, from gz_viewer_time_ns()
 */
void gz_viewer_scenes_step(struct gz_viewer_scenes *scenes, const struct gz_viewer_window *window,
			   int64_t host_ns);

/** Whether, at @p now_ns, a viewer's scene is still and none's moves. What was said counts for
 * GZ_VIEWER_WINDOW_NS. */
bool gz_viewer_scenes_still(const struct gz_viewer_scenes *scenes, int64_t now_ns);

#endif
