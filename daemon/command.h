/**
 * @file
 * What the thread that serves requests and the thread that serves samples tell each other, over a
 * pair of inproc sockets: each message is one of these structs, whole, within one process.
 */
#ifndef GZ_DAEMON_COMMAND_H
#define GZ_DAEMON_COMMAND_H

#include <stdbool.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"

/** The inproc endpoint of the pair; the requests' side binds it. */
#define GZ_COMMAND_ENDPOINT "inproc://command"

/** Asked of the thread that serves samples. */
enum gz_command_kind {
	GZ_COMMAND_RECORD,  /**< into fd and path */
	GZ_COMMAND_STOP,    /**< the recording */
	GZ_COMMAND_MARK,    /**< text into the log */
	GZ_COMMAND_CORRECT, /**< take up the stored correction, which may have changed */
	GZ_COMMAND_SEND,    /**< a message on the stream: topic in text, body behind this struct */
	GZ_COMMAND_WINDOW,  /**< where a viewer's window is, or that it is closed */
	GZ_COMMAND_QUIT,
};

/** A command. */
struct gz_command {
	enum gz_command_kind kind;
	uint32_t number;  /**< RECORD, STOP, CORRECT: repeated in the answer */
	int fd;           /**< RECORD: the taker's, but where it refuses */
	int64_t host_ns;  /**< MARK, WINDOW */
	bool has_window;  /**< WINDOW: false once it is closed */
	int window_px[4]; /**< WINDOW: x y w h */
	char path[GZ_PATH_SIZE];
	char text[GZ_GAZE_LOG_TEXT_SIZE];
};

/** Told to the thread that serves requests. */
enum gz_notice_kind {
	GZ_NOTICE_ANSWER, /**< to command number */
	GZ_NOTICE_FAILED, /**< the service cannot go on, and has ended; it was logged */
	GZ_NOTICE_ENDED,  /**< a replay is over and its recording, if any, is being finished */
};

/** A notice. */
struct gz_notice {
	enum gz_notice_kind kind;
	uint32_t number;
	enum gz_result result;
};

#endif
