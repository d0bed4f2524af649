/**
 * @file
 * The subscriptions of the stream, counted for each connection. libzmq stores what a reader
 * subscribes to and tells the application, but limits nothing. No sockets here; the table is the
 * publisher's (publisher.h).
 */
#ifndef GZ_DAEMON_READERS_H
#define GZ_DAEMON_READERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Most subscriptions of one reader. Chosen: there are about ten kinds of message. */
#define GZ_READER_SUBSCRIPTIONS 256

/** Room for the topics of one reader, each with GZ_READER_TOPIC_EXTRA bytes. Chosen: enough for
 * that many short topics, or for 16 of the longest. */
#define GZ_READER_TOPICS_SIZE 4096

/** What a topic costs besides its bytes. */
#define GZ_READER_TOPIC_EXTRA 2

/** Most subscriptions of all readers, and room for their topics, counted like that. Chosen: 64
 * readers with all that one may have; libzmq makes about 8 MB of it. */
#define GZ_READERS_SUBSCRIPTIONS (64 * GZ_READER_SUBSCRIPTIONS)
#define GZ_READERS_TOPICS_SIZE   (64 * GZ_READER_TOPICS_SIZE)

/** The table. One thread at a time. */
struct gz_readers;

/** Sums over all readers. */
struct gz_readers_sums {
	uint32_t subscriptions; /**< each topic of each reader */
	uint32_t pupils;        /**< those of them that include pupil messages */
	uint32_t surfaces;      /**< those of them that include messages about surfaces */
	uint32_t remote;        /**< those of them of readers that do not read the board */
	uint32_t boards;        /**< readers of the board (board.h) */
	uint32_t topics_size;   /**< bytes, each topic with GZ_READER_TOPIC_EXTRA */
};

/**
 * Create an empty table.
 *
 * @param size  connections have file descriptors below this
 * @param[out] out_readers  owned by the caller: gz_readers_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_readers_create(int size, struct gz_readers **out_readers);

/**
 * Note a new subscription. One that the reader has already changes nothing.
 *
 * @param fd        its connection's
 * @param identity  the connection's, not 0; if it is not that of the last call with @p fd, the old
 *                  connection's subscriptions are forgotten
 * @param topic, size  any bytes
 * @retval GZ_OK        noted
 * @retval GZ_ERR_FULL  it is one too many for this reader, or for all; it is not noted
 * @retval GZ_ERR_ACCESS  this reader was told GZ_ERR_FULL before; nothing is noted any more
 * @retval GZ_ERR_INVAL  @p fd is negative or not below the size of the table
 *
 * Does not allocate.
 */
enum gz_result gz_readers_subscribe(struct gz_readers *readers, int fd, uint64_t identity,
				    const void *topic, size_t size);

/** Note the end of a subscription; ignored if there is no such one. Parameters as for
 *  gz_readers_subscribe(). */
void gz_readers_unsubscribe(struct gz_readers *readers, int fd, uint64_t identity,
			    const void *topic, size_t size);

/** Forget every reader whose connection has ended: whose descriptor has another identity by now.
 * @param identity_of  gz_connection_identity(), or a test's */
void gz_readers_sweep(struct gz_readers *readers, uint64_t (*identity_of)(int fd));

/** The sums. */
struct gz_readers_sums gz_readers_sums(const struct gz_readers *readers);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_readers_destroy(struct gz_readers **readers);

#endif
