/**
 * @file
 * A SUB socket that follows one publisher through its death and return: what the latest channel
 * and the stream reader share. Internal; applications use client.h and stream.h.
 */
#ifndef GZ_CLIENT_SUBSCRIBER_H
#define GZ_CLIENT_SUBSCRIBER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "client/handshake.h"
#include "client/keys.h"
#include "protocol/endpoint.h"

/** What gz_subscriber_open() is to do. */
struct gz_subscriber_params {
	const char *endpoint;       /**< NULL finds the local daemon's channel @p channel */
	const char *channel;        /**< "latest" or "stream" */
	const char *const *topics;  /**< prefixes, NULL-terminated; NULL for everything */
	const struct gz_keys *keys; /**< copied; NULL: none */
	bool find_keys;             /**< as gz_keys_find() has them, where @p keys is NULL */
	bool conflate;              /**< hold the newest message only; one-frame channels only */
};

/** A connection. One thread at a time. All zero is a closed one. */
struct gz_subscriber {
	void *context; /**< ZeroMQ context, its own */
	void *socket;  /**< SUB */
	void *monitor; /**< PAIR: what happens to the connection */
	const struct gz_log *log;
	char endpoint[GZ_ENDPOINT_SIZE];
	bool has_keys;
	struct gz_keys keys;
	enum gz_handshake_fault told; /**< the fault logged last */
	struct gz_ratelimit telling;
	int hang_ups; /**< in handshakes, since the last connection */
	bool connected;
	uint64_t connections; /**< times that a publisher was found */
	int64_t retry_ns;     /**< when to connect anew if there is no connection until then */
};

/** How often gz_subscriber_take_events() must be called for a connection to be kept up, ms. */
enum { GZ_SUBSCRIBER_EVENTS_MS = 500 };

/**
 * Open and start to connect; succeeds also while nobody publishes.
 *
 * @param[out] subscriber  filled; closed by gz_subscriber_close(), also after a failure
 * @retval GZ_ERR_INVAL   the endpoint or a topic is refused; logged
 * @retval GZ_ERR_NO_MEM  no room for context, sockets or monitor; logged
 * @return else as gz_keys_find() and gz_endpoint_find(); logged
 */
enum gz_result gz_subscriber_open(struct gz_subscriber *subscriber,
				  const struct gz_subscriber_params *params,
				  const struct gz_log *log);

/**
 * Take in what happened to the connection since the last call, and renew it where libzmq has given
 * it up: it does not reconnect to a publisher that sent something it must refuse. Never blocks.
 */
void gz_subscriber_take_events(struct gz_subscriber *subscriber);

/** Close all that is open; returns at once. */
void gz_subscriber_close(struct gz_subscriber *subscriber);

#endif
