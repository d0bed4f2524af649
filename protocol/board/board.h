/**
 * @file
 * A notice board: the messages of the stream in memory that the daemon shares with readers of the
 * same machine. One process writes, any number read. A reader costs the writer nothing but its
 * wake-up, and one system call wakes all of them.
 *
 * The messages lie one after the other in a memory of fixed size; new ones overwrite the oldest. A
 * slow reader is overtaken: it goes on with the oldest message that is left. Readers cannot write
 * to the memory, so they disturb neither the writer nor each other; and the memory cannot shrink
 * under a reader. docs/protocol.md describes the bytes.
 */
#ifndef GZ_PROTOCOL_BOARD_BOARD_H
#define GZ_PROTOCOL_BOARD_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** The first bytes of a board; the last one is the version of the layout. */
#define GZ_BOARD_MAGIC "GZBOARD\2"

/** Where the messages begin, bytes. The header lies before them. */
#define GZ_BOARD_HEADER_SIZE 4096

/** Bytes of messages on the daemon's board. Chosen: about 4000 messages, as many as the client
 * library keeps of those that come over a socket; 2 s of gaze at 2000 Hz. */
#define GZ_BOARD_SIZE (4 << 20)

/** Fewest and most bytes of messages on any board; always a power of two. Chosen: the fewest are
 * twice the largest message. */
#define GZ_BOARD_SIZE_MIN (1 << 16)
#define GZ_BOARD_SIZE_MAX (1 << 30)

/** Longest topic, and largest body, bytes. Chosen: more than any message of the stream has. */
#define GZ_BOARD_TOPIC_MAX 255
#define GZ_BOARD_BODY_MAX  24576

/*
 * The subscriptions by which the daemon knows the readers of its board and what they want. No
 * message has such a topic, because the daemon accepts no topic with a NUL.
 */

/** A reader subscribes to this and one of its topics, in place of each topic, while it reads the
 * board. */
#define GZ_BOARD_TOPIC "\0board:"

/** Its length, with the first byte. */
#define GZ_BOARD_TOPIC_SIZE (sizeof GZ_BOARD_TOPIC - 1)

/*
 * Writing.
 */

/** A board to write on. One thread at a time. */
struct gz_board;

/**
 * Create an empty board.
 *
 * @param size  bytes of messages, a power of two, GZ_BOARD_SIZE_MIN to GZ_BOARD_SIZE_MAX
 * @param[out] out_board  owned by the caller: gz_board_destroy()
 * @retval GZ_ERR_INVAL        @p size is none of these
 * @retval GZ_ERR_NO_MEM       no memory
 * @retval GZ_ERR_UNSUPPORTED  the system cannot protect the memory from readers (before Linux 5.1)
 */
enum gz_result gz_board_create(size_t size, struct gz_board **out_board);

/** The file of the memory, to be given to readers. They can map it for reading only. Owned by the
 * board. */
int gz_board_fd(const struct gz_board *board);

/** A message to be written. */
struct gz_board_message {
	const char *topic;
	size_t topic_size;
	const void *body;
	size_t body_size;
	int64_t time_ns; /**< host time now; never earlier than that of the message before */
	bool is_gaze;    /**< readers of the newest gaze get its body */
};

/**
 * Write a message. Readers see it after the next gz_board_show(). A message that is longer than
 * GZ_BOARD_TOPIC_MAX or GZ_BOARD_BODY_MAX allow is left out.
 *
 * Does not allocate, makes no system call and never waits.
 *
 * @return whether it was written
 */
bool gz_board_write(struct gz_board *board, const struct gz_board_message *message);

/**
 * Show what was written to the readers.
 *
 * @param wake  whether readers may be waiting, which costs a system call
 *
 * Does not allocate and never waits.
 */
void gz_board_show(struct gz_board *board, bool wake);

/** Free and set to NULL. Accepts a pointer to NULL. Readers keep what they have mapped. */
void gz_board_destroy(struct gz_board **board);

/*
 * Reading. Whatever the memory holds is checked before it is used.
 */

/** A board that is read. One thread at a time. */
struct gz_board_reader;

/** A message that was read. */
struct gz_board_record {
	const char *topic; /**< not terminated */
	size_t topic_size;
	const void *body;
	size_t body_size;
	int64_t time_ns; /**< host time at which it was written */
};

/**
 * Map a board. The reader begins before the oldest message.
 *
 * @param fd  of the memory; stays open and is the caller's
 * @param[out] out_reader  owned by the caller: gz_board_close()
 * @retval GZ_ERR_UNSUPPORTED  it is another version, or its size or protection is not that of a
 *                             board: its memory could shrink, or others could write to it
 * @retval GZ_ERR_NO_MEM       no memory
 */
enum gz_result gz_board_open(int fd, struct gz_board_reader **out_reader);

/** Whether @p reader reads the board whose memory is @p fd. */
bool gz_board_is_same(const struct gz_board_reader *reader, int fd);

/** Go on with the first message that was not written before @p time_ns, host time. The present
 * newest gaze is not read either if it is older.
 * @return GZ_OK or GZ_ERR_PROTOCOL, as gz_board_next() */
enum gz_result gz_board_skip(struct gz_board_reader *reader, int64_t time_ns);

/**
 * Read the next message. Never waits. A reader that was overtaken goes on with the oldest message
 * that is left.
 *
 * @param[out] out_record  written only on GZ_OK; its pointers are valid until the next call
 * @retval GZ_OK            *out_record is filled
 * @retval GZ_ERR_TIMEOUT   no message is left
 * @retval GZ_ERR_PROTOCOL  the memory does not hold a board's messages; it cannot be read any more
 */
enum gz_result gz_board_next(struct gz_board_reader *reader, struct gz_board_record *out_record);

/**
 * Read the newest message of gaze. Never waits. It does not change what gz_board_next() reads.
 *
 * @param[out] out_record  as for gz_board_next()
 * @retval GZ_OK            *out_record is filled
 * @retval GZ_ERR_TIMEOUT   none has come since the last call
 * @retval GZ_ERR_PROTOCOL  as for gz_board_next()
 */
enum gz_result gz_board_newest(struct gz_board_reader *reader, struct gz_board_record *out_record);

/** Whether a message is left to read. */
bool gz_board_has_next(const struct gz_board_reader *reader);

/** How often the reader was overtaken. */
uint64_t gz_board_overtaken(const struct gz_board_reader *reader);

/**
 * Wait until there is a message to read.
 *
 * @param timeout_ns  longest wait, ns, not negative
 * @retval GZ_OK           there is one, or the wait ended early
 * @retval GZ_ERR_TIMEOUT  there was none in time
 * @retval GZ_ERR_IO       a signal arrived
 */
enum gz_result gz_board_wait(struct gz_board_reader *reader, int64_t timeout_ns);

/** Unmap and set to NULL. Accepts a pointer to NULL. */
void gz_board_close(struct gz_board_reader **reader);

#endif
