/**
 * @file
 * Who is at the door: a thread that answers libzmq's question whether a client may come in (ZeroMQ
 * RFC 27/ZAP), counts connections, and logs who was refused, once a minute per address.
 *
 * Clients with an unknown key are refused by the answer. Clients with a wrong server key, or with
 * none, never get that far: of those only the sockets' monitors tell.
 */
#ifndef GZ_DAEMON_GUARD_H
#define GZ_DAEMON_GUARD_H

#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Most sockets that are watched. */
#define GZ_GUARD_SOCKETS_MAX 4

/** The guard. */
struct gz_guard;

/** A watched socket's connections. */
struct gz_connections;

/**
 * Open. Where there are authorised keys, libzmq asks from now on; it waits for the answers until
 * gz_guard_start().
 *
 * @param context          a ZeroMQ context with one I/O thread; outlives the guard
 * @param authorized_keys  path of the list of clients' keys; NULL: nobody needs a key
 * @return GZ_OK, or a result after one logged line
 */
enum gz_result gz_guard_create(void *context, const char *authorized_keys, const struct gz_log *log,
			       struct gz_guard **out_guard);

/**
 * Watch a socket that is not bound yet. Before gz_guard_start().
 *
 * @param name  of the socket, for messages; static
 * @param[out] out_connections  valid until the guard is destroyed
 * @retval GZ_ERR_FULL  there are GZ_GUARD_SOCKETS_MAX already
 * @retval GZ_ERR_IO    logged
 */
enum gz_result gz_guard_watch(struct gz_guard *guard, void *socket, const char *name,
			      const struct gz_connections **out_connections);

/** Start the thread. GZ_ERR_NO_MEM is logged. */
enum gz_result gz_guard_start(struct gz_guard *guard);

/** How many there are now, of all kinds. Any thread. */
uint32_t gz_connections_count(const struct gz_connections *connections);

/** Stop the thread, close and set to NULL; after the watched sockets were closed. Accepts a pointer
 *  to NULL. */
void gz_guard_destroy(struct gz_guard **guard);

#endif
