/**
 * @file
 * From where a subscriber's messages come: from the daemon's board in shared memory
 * (protocol/board/board.h) if the daemon is on this machine and offers one, otherwise from the
 * subscriber's socket. Internal; see connection.h.
 *
 * The socket stays connected while the board is read: it tells when the daemon ends and returns,
 * and the daemon counts its readers by their connections. It subscribes to topics without messages
 * then, which tell the daemon what is read. Until it is decided from where messages come, the
 * socket collects them, and nothing is read from it; so each message is read once, whatever is
 * decided.
 */
#ifndef GZ_CLIENT_BOARD_LINK_H
#define GZ_CLIENT_BOARD_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/board/board.h"
#include "protocol/endpoint.h"

/** Longest wait for the board when a subscriber is opened, ms, and later on, when nobody waits.
 * Chosen: a daemon that has time answers in a fraction of a millisecond. */
enum { GZ_BOARD_OPEN_MS = 20, GZ_BOARD_ANSWER_MS = 200 };

/** From where messages come. */
enum gz_board_source {
	GZ_BOARD_SOURCE_SOCKET, /**< from the socket, for good */
	GZ_BOARD_SOURCE_OPEN,   /**< decided when the socket is connected */
	GZ_BOARD_SOURCE_BOARD,
};

/** The link of one subscriber. One thread at a time. All zero: closed. */
struct gz_board_link {
	void *socket;     /**< SUB; the subscriber's */
	bool newest_only; /**< the newest gaze is read, on the channel "latest" */
	char *topics;     /**< a copy: each with its NUL, after GZ_BOARD_TOPIC */
	size_t topic_count;
	int64_t opened_ns;           /**< older messages are not read */
	char path[GZ_ENDPOINT_SIZE]; /**< of the socket at which boards are asked for */
	enum gz_board_source source;
	bool asking; /**< fd is open */
	int fd;
	int64_t until_ns; /**< asking: when to give up; otherwise: when to ask; 0: never */
	struct gz_board_reader *reader; /**< NULL: no board is read */
	struct gz_board_reader *next;   /**< read when @p reader is at its end */
	uint64_t boards;                /**< read so far, this one included */
};

/** Parameters of gz_board_link_open(). */
struct gz_board_link_params {
	void *socket;              /**< SUB, not connected yet */
	const char *endpoint;      /**< to which it will be connected */
	const char *channel;       /**< "stream" or "latest" */
	const char *const *topics; /**< prefixes, NULL-terminated; NULL for everything */
};

/**
 * Subscribe the socket to what it must be subscribed to, and look for a board. Waits
 * GZ_BOARD_OPEN_MS at most, and only for a daemon that is there.
 *
 * @param[out] link  filled; call gz_board_link_close() even after a failure
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_INVAL   libzmq refuses a topic
 */
enum gz_result gz_board_link_open(struct gz_board_link *link,
				  const struct gz_board_link_params *params);

/** The socket was connected. Never waits. */
void gz_board_link_connected(struct gz_board_link *link);

/** The socket's connection has ended. Never waits. */
void gz_board_link_disconnected(struct gz_board_link *link);

/** Take the answer of a daemon that was asked for its board. Never waits. */
void gz_board_link_step(struct gz_board_link *link);

/** The descriptor that becomes readable when gz_board_link_step() has something to do; -1: none. */
int gz_board_link_fd(const struct gz_board_link *link);

/**
 * The board to read now; NULL: none. Call it before each read; what was read before becomes
 * invalid.
 */
struct gz_board_reader *gz_board_link_reader(struct gz_board_link *link);

/** Whether messages are to be read from the socket; meaningful if there is no board to read. */
bool gz_board_link_reads_socket(const struct gz_board_link *link);

/** The board holds no messages that can be read: read the socket from now on. */
void gz_board_link_give_up(struct gz_board_link *link);

/** Whether messages of @p topic are wanted. */
bool gz_board_link_wants(const struct gz_board_link *link, const char *topic, size_t size);

/** Close everything but the socket and zero @p link. */
void gz_board_link_close(struct gz_board_link *link);

#endif
