/**
 * @file
 * What connections may cost: how many there are, and what readers send. libzmq 4.3.4 limits
 * neither. It ends the program if no file descriptor is left for a connection at a local socket,
 * and it stores every subscription, however many a reader sends, in memory that is about thirty
 * times as large, while the stream waits.
 *
 * The kernel tells when a reader has sent something and how much, so a flood of subscriptions is
 * cut off before libzmq has read it.
 */
#ifndef GZ_DAEMON_QUOTA_H
#define GZ_DAEMON_QUOTA_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/*
 * Connections by their file descriptors, which belong to libzmq: it may close one at any time, and
 * the number may then mean another file. The identity tells.
 */

/** The identity of the socket that @p fd is now, never 0; 0 if it is none. Threads: any. */
uint64_t gz_connection_identity(int fd);

/**
 * End a connection and discard what it has sent and nobody has read. libzmq then closes it.
 *
 * @param identity  from gz_connection_identity(); nothing happens if @p fd is another file by now
 *
 * Threads: any.
 */
void gz_connection_end(int fd, uint64_t identity);

/*
 * The quota.
 */

/** Most connections, if there are enough file descriptors. Chosen: a laboratory has some tens; each
 * costs about 20 KB in libzmq. */
#define GZ_QUOTA_CONNECTIONS 4096

/** Connections have descriptors below this; one with a higher number is ended. Chosen: the daemon's
 * own files need far fewer numbers than connections do. */
#define GZ_QUOTA_DESCRIPTORS (2 * GZ_QUOTA_CONNECTIONS)

/** File descriptors that connections leave free. Chosen: the tracker, a recording and hot-plug need
 * about ten; the others are for connections that libzmq accepts before they are counted. */
#define GZ_QUOTA_FILES_RESERVED 48

/** Most bytes that a reader may send at once after the handshake, which has GZ_QUOTA_HANDSHAKE. A
 * reader sends its subscriptions and answers to heartbeats. Chosen: twice what the subscriptions
 * that are allowed (readers.h) need. */
#define GZ_QUOTA_READER_BYTES 16384

/** Bytes of a handshake, which do not count. Chosen: twice that of CURVE. */
#define GZ_QUOTA_HANDSHAKE 1024

/** Bytes that a reader may send each second without an end. Chosen: an answer to a heartbeat each
 * second, encrypted. */
#define GZ_QUOTA_READER_BYTES_PER_S 64

/** Most bytes that all present readers may have sent, each counted like that. Chosen: libzmq makes
 * about 32 MB of it. */
#define GZ_QUOTA_ALL_BYTES 1048576

/** How often all readers are looked at, ms. Chosen: a flood makes itself known, so this only bounds
 * what many slow readers send. */
#define GZ_QUOTA_CHECK_MS 1000

/** Why a connection was ended. */
enum gz_quota_reason {
	GZ_QUOTA_TOO_MANY,  /**< too many connections */
	GZ_QUOTA_TOO_LARGE, /**< a reader sends too much */
	GZ_QUOTA_REASON_COUNT,
};

/** A quota. One thread at a time, except for gz_quota_ended(). */
struct gz_quota;

/**
 * Create a quota without connections.
 *
 * @param connections  most connections at a time, 1 to GZ_QUOTA_CONNECTIONS. Over TCP, which
 * everybody may reach, at most three quarters of them, so that local programs still come in.
 * @param log          borrowed; may be NULL
 * @param[out] out_quota  owned by the caller: gz_quota_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no descriptor
 */
enum gz_result gz_quota_create(uint32_t connections, const struct gz_log *log,
			       struct gz_quota **out_quota);

/** How many connections this process can serve: its limit of open files, less those that are open
 * now and GZ_QUOTA_FILES_RESERVED; at least 4, at most GZ_QUOTA_CONNECTIONS. */
uint32_t gz_quota_connections_possible(void);

/**
 * A connection was accepted. If it is one too many, it is ended.
 *
 * @param socket     at which it came; any pointer that tells sockets apart
 * @param is_reader  it may only subscribe: what it sends is limited
 * @param now_ns     host time
 */
void gz_quota_arrived(struct gz_quota *quota, int fd, const void *socket, bool is_reader,
		      int64_t now_ns);

/** libzmq has closed a connection of @p socket. */
void gz_quota_left(struct gz_quota *quota, int fd, const void *socket);

/** A descriptor that becomes readable when a reader has sent something that libzmq has not read
 * yet: call gz_quota_check(). Owned by the quota. */
int gz_quota_fd(const struct gz_quota *quota);

/** End the connections of readers that have sent too much. Never waits. Call it every
 * GZ_QUOTA_CHECK_MS too: what libzmq has read at once does not make the descriptor readable. */
void gz_quota_check(struct gz_quota *quota, int64_t now_ns);

/** Present connections, without those that were ended. */
uint32_t gz_quota_count(const struct gz_quota *quota);

/** How many connections were ended for @p reason. Threads: any. */
uint64_t gz_quota_ended(const struct gz_quota *quota, enum gz_quota_reason reason);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_quota_destroy(struct gz_quota **quota);

#endif
