/**
 * @file
 * The authentication thread. It answers libzmq's question whether a client may connect (ZeroMQ
 * RFC 27/ZAP), counts connections, ends those beyond the quota (quota.h), and logs refused clients,
 * once a minute per address. It also has the doors (door.h) and logs whom they refuse.
 *
 * A client with an unknown key is refused by that answer. A client with a wrong server key, or
 * without keys, fails earlier, in the handshake: only the sockets' monitors report it.
 */
#ifndef GZ_DAEMON_GUARD_H
#define GZ_DAEMON_GUARD_H

#include <stdint.h>
#include <zmq.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/door.h"
#include "daemon/quota.h"

/** Most sockets that can be watched. */
#define GZ_GUARD_SOCKETS_MAX 4

/** The guard. */
struct gz_guard;

/** A watched socket's connections. */
struct gz_connections;

/**
 * Create a guard. With a list of authorised keys, libzmq asks about each client from now on, and
 * connections wait until gz_guard_start() starts the thread that answers.
 *
 * @param context          a ZeroMQ context with one I/O thread; outlives the guard
 * @param authorized_keys  path of the list of clients' keys; NULL: clients need no key
 * @param limits           of the doors, by enum gz_door_place; copied; NULL: the usual ones
 * @param log              borrowed; outlives the guard
 * @param[out] out_guard   owned by the caller: gz_guard_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no event descriptor
 * @retval GZ_ERR_IO      the authentication socket cannot be bound; logged
 * @return else as gz_authorized_keys_open()
 */
enum gz_result gz_guard_create(void *context, const char *authorized_keys,
			       const struct gz_door_limits limits[GZ_DOOR_PLACES],
			       const struct gz_log *log, struct gz_guard **out_guard);

/**
 * Watch the connections of a socket. Call it before the socket is bound and before
 * gz_guard_start(). What the clients of a publishing socket send is limited (quota.h).
 *
 * @param name  of the socket, for messages; static
 * @param[out] out_connections  valid until the guard is destroyed
 * @retval GZ_ERR_FULL  GZ_GUARD_SOCKETS_MAX sockets are watched already
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_IO    the socket cannot be monitored; logged
 */
enum gz_result gz_guard_watch(struct gz_guard *guard, void *socket, const char *name,
			      struct gz_connections **out_connections);

/**
 * Start the thread. How many connections it allows depends on the files that may still be opened:
 * see gz_quota_connections_possible().
 *
 * @retval GZ_ERR_NO_MEM  no memory, or no thread can be started; logged
 */
enum gz_result gz_guard_start(struct gz_guard *guard);

/** Let clients at a local TCP port of a socket come through a door of the guard (door.h):
 * publishing sockets share one, each other socket has its own. Call it when the port has just been
 * bound. The doors of two guards cannot be open at a time. */
void gz_guard_open_door(struct gz_connections *connections, int port);

/** The same for clients at the local socket with file @p path, which have doors of their own. Call
 * it before the socket is bound. */
void gz_guard_open_local_door(struct gz_connections *connections, const char *path);

/** Tell the doors a topic that the daemon sends. Call it before the doors are opened. */
void gz_guard_know_topic(struct gz_guard *guard, const char *topic);

/** A frame of a client's message was received from the socket, and counts no longer as held by
 * libzmq. Do not call it for frames that libzmq adds. Threads: any. */
void gz_connections_took(const struct gz_connections *connections, zmq_msg_t *frame);

/** The socket has no message. Threads: any. */
void gz_connections_emptied(const struct gz_connections *connections);

/** How many connections were ended or refused for @p reason since the start: TOO_LARGE those of
 * readers, TOO_MANY the others. Threads: any. */
uint64_t gz_guard_ended(const struct gz_guard *guard, enum gz_quota_reason reason);

/** How many connections the socket has now, local ones and those over TCP. Threads: any. */
uint32_t gz_connections_count(const struct gz_connections *connections);

/** How many of them may want messages from the socket: those of which it is not known that they
 * have subscribed to nothing, or to what they read at the board. Threads: any. */
uint32_t gz_connections_listening(const struct gz_connections *connections);

/** Stop the thread, free the guard and set *guard to NULL. Close the watched sockets first. Accepts
 *  a pointer to NULL. */
void gz_guard_destroy(struct gz_guard **guard);

#endif
