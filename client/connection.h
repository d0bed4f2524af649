/**
 * @file
 * What subscriptions and requests share: finding the daemon's endpoint, keys on a socket, failed
 * handshakes; and the SUB socket of the latest channel and of the stream. Internal; applications
 * use client.h, stream.h and control.h.
 */
#ifndef GZ_CLIENT_CONNECTION_H
#define GZ_CLIENT_CONNECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "client/board_link.h"
#include "client/keys.h"
#include "protocol/endpoint.h"

/** Pause before libzmq tries to reconnect, ms; the pause is lengthened at random up to twofold.
 *  Chosen: a daemon that returns is found within 0.1 s, at the cost of some twenty attempts a
 * second while it is away. */
enum { GZ_RECONNECT_MS = 50 };

/**
 * Find the endpoint to connect to.
 *
 * @param endpoint   ZeroMQ endpoint; NULL: that of the local daemon's @p channel
 * @param channel    "latest", "stream" or "control"
 * @param[out] text  the endpoint
 * @retval GZ_ERR_INVAL  the endpoint is empty or too long; logged
 * @return else as gz_endpoint_find()
 */
enum gz_result gz_connection_endpoint(const char *endpoint, const char *channel,
				      const struct gz_log *log, char text[GZ_ENDPOINT_SIZE]);

/** Why a handshake failed. */
enum gz_handshake_fault {
	GZ_HANDSHAKE_FINE,
	GZ_HANDSHAKE_ENDED,        /**< the daemon closed the connection: it has another server key
				      than ours, or it has ended */
	GZ_HANDSHAKE_REFUSED,      /**< the daemon has not authorised our key */
	GZ_HANDSHAKE_SERVER_KEY,   /**< the daemon lacks the secret half of its server key */
	GZ_HANDSHAKE_WANTS_KEYS,   /**< the daemon requires keys and we have none */
	GZ_HANDSHAKE_WANTS_NO_KEYS /**< we use keys and the daemon does not */
};

/** An event from a socket's monitor. */
struct gz_monitor_event {
	int number; /**< ZMQ_EVENT_...; 0: no event */
	int value;
};

/** Make further connections of @p socket use @p keys, or none if they are NULL. @return whether
 *  libzmq accepts them */
bool gz_handshake_use_keys(void *socket, const struct gz_keys *keys);

/** How often the daemon must close the connection during the handshake before that counts as a
 * refusal: once may mean that it has ended and will return. */
enum { GZ_HANDSHAKE_HANG_UPS = 3 };

/**
 * Open a monitor of @p socket, which connects to @p endpoint. It reports @p events and, for tcp://
 * endpoints, failed handshakes; local sockets have no keys.
 *
 * @return a PAIR socket, closed by the caller; NULL on failure, with errno set
 */
void *gz_handshake_open_monitor(void *context, void *socket, const char *endpoint, int events);

/** Receive the next event from @p monitor. Never waits. */
struct gz_monitor_event gz_handshake_next_event(void *monitor);

/** The fault that @p event reports; GZ_HANDSHAKE_FINE if it reports none. */
enum gz_handshake_fault gz_handshake_fault_of(const struct gz_monitor_event *event, bool has_keys);

/** Log what is wrong at @p endpoint and what to do. @param keys  the keys in use, or NULL */
void gz_handshake_log(enum gz_handshake_fault fault, const char *endpoint,
		      const struct gz_keys *keys, const struct gz_log *log);

/*
 * A subscriber: a SUB socket that stays with one publisher while that ends and returns.
 */

/** Parameters of gz_subscriber_open(). */
struct gz_subscriber_params {
	const char *endpoint;       /**< NULL: the local daemon's channel @p channel */
	const char *channel;        /**< "latest" or "stream" */
	const char *const *topics;  /**< prefixes, NULL-terminated; NULL for everything */
	const struct gz_keys *keys; /**< copied; NULL: none */
	bool find_keys;             /**< if @p keys is NULL, look for keys by gz_keys_find() */
	bool conflate; /**< keep the newest message only; for one-frame channels only */
};

/** A subscriber. One thread at a time. All zero: closed. */
struct gz_subscriber {
	void *context;              /**< ZeroMQ context, its own */
	void *socket;               /**< SUB */
	void *monitor;              /**< PAIR: reports events of the connection */
	struct gz_board_link board; /**< from where messages come */
	const struct gz_log *log;
	char endpoint[GZ_ENDPOINT_SIZE];
	bool has_keys;
	struct gz_keys keys;
	enum gz_handshake_fault told; /**< the fault logged last */
	struct gz_ratelimit telling;
	int hang_ups; /**< times the publisher closed the connection during the handshake, since the
			 last complete one */
	bool connected;
	uint64_t connections; /**< connections established so far */
	int64_t retry_ns;     /**< when to reconnect if there is no connection by then; 0: unset */
};

/** Longest time between two calls of gz_subscriber_take_events() that keeps the connection up, ms.
 */
enum { GZ_SUBSCRIBER_EVENTS_MS = 500 };

/**
 * Open a subscriber and start to connect. Succeeds even if nobody publishes yet.
 *
 * @param[out] subscriber  filled; call gz_subscriber_close() even after a failure
 * @param log              borrowed; outlives the subscriber; may be NULL
 * @retval GZ_ERR_INVAL   the endpoint or a topic is refused; logged
 * @retval GZ_ERR_NO_MEM  no context, socket or monitor; logged
 * @return else as gz_keys_find() and gz_connection_endpoint(); logged
 */
enum gz_result gz_subscriber_open(struct gz_subscriber *subscriber,
				  const struct gz_subscriber_params *params,
				  const struct gz_log *log);

/** A number that changes when further messages may come from another daemon than earlier ones. */
uint64_t gz_subscriber_origin(const struct gz_subscriber *subscriber);

/**
 * Process the connection's events since the last call, and reconnect if libzmq has given up: it
 * does not reconnect to a publisher that sent something it had to refuse. Never blocks.
 */
void gz_subscriber_take_events(struct gz_subscriber *subscriber);

/** Close everything that is open and zero @p subscriber. Returns at once. */
void gz_subscriber_close(struct gz_subscriber *subscriber);

#endif
