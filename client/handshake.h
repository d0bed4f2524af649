/**
 * @file
 * Keys on a socket, and what a socket's monitor says when a handshake fails. Internal; shared by
 * subscriptions and requests.
 */
#ifndef GZ_CLIENT_HANDSHAKE_H
#define GZ_CLIENT_HANDSHAKE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "client/keys.h"

/** What may be wrong, in words for people. */
enum gz_handshake_fault {
	GZ_HANDSHAKE_FINE,
	GZ_HANDSHAKE_ENDED,        /**< the other side hung up: a wrong server key, or it left */
	GZ_HANDSHAKE_REFUSED,      /**< our key is not authorised there */
	GZ_HANDSHAKE_SERVER_KEY,   /**< it does not have the secret half of the server key */
	GZ_HANDSHAKE_WANTS_KEYS,   /**< it wants keys and we have none */
	GZ_HANDSHAKE_WANTS_NO_KEYS /**< we have keys and it knows none */
};

/** An event of a monitor. */
struct gz_monitor_event {
	int number; /**< ZMQ_EVENT_...; 0: there is none */
	int value;
};

/** Make the next connections of @p socket use @p keys; nothing where they are NULL. @return whether
 *  libzmq takes them */
bool gz_handshake_use_keys(void *socket, const struct gz_keys *keys);

/** Times that the other side must hang up before we believe that it means us: once may be its end,
 * after which it returns. */
enum { GZ_HANDSHAKE_HANG_UPS = 3 };

/**
 * Open a monitor of @p socket, which connects to @p endpoint, for @p events and, where that is
 * tcp://, for failed handshakes: local sockets have no keys.
 *
 * @return the PAIR socket, or NULL: errno tells
 */
void *gz_handshake_open_monitor(void *context, void *socket, const char *endpoint, int events);

/** Take the next event of @p monitor. Never waits. */
struct gz_monitor_event gz_handshake_next_event(void *monitor);

/** The fault that @p event tells of. */
enum gz_handshake_fault gz_handshake_fault_of(const struct gz_monitor_event *event, bool has_keys);

/** Log what is wrong at @p endpoint and what to do. @p keys: in use, or NULL */
void gz_handshake_log(enum gz_handshake_fault fault, const char *endpoint,
		      const struct gz_keys *keys, const struct gz_log *log);

#endif
